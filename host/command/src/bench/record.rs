//! What was measured.

use serde::Serialize;

use super::Kind;

/// One stream, traced one way on one device.
#[derive(Debug, Clone, Serialize)]
pub struct Record {
    /// The scene's name.
    pub scene: String,
    /// The camera's name.
    pub view: String,
    /// The kind of rays.
    pub kind: Kind,
    /// How they were followed.
    pub method: String,
    /// Is this what `auto` takes for the device and kind?
    pub auto: bool,
    /// How a GPU's subgroups came by them.
    pub scheduling: Option<String>,
    /// The order of pixels.
    pub order: String,
    /// How the hierarchy and its primitives lay in memory.
    pub layout: String,
    /// How a ray was tested against a triangle.
    pub triangle: String,
    /// The quality of the hierarchy.
    pub bvh: String,
    /// Nodes that wait when a packet of the stack methods parts.
    pub stack_max: u32,
    /// Percent of a packet below which rays of the cut methods part.
    pub cut: u32,
    /// `gpu` or `cpu`.
    pub processor: &'static str,
    /// The device's name.
    pub device: String,
    /// Its driver, or its threads.
    pub driver: String,
    /// `exact` or `fast`.
    pub precision: &'static str,
    /// Width of the image in pixels.
    pub width: u32,
    /// Height of the image in pixels.
    pub height: u32,
    /// Rays of the stream.
    pub rays: usize,
    /// Repetitions after the warm-up.
    pub repeat: u32,
    /// Their median time.
    pub median_seconds: f64,
    /// From the 10th to the 90th percentile of their times, as a share of the median.
    pub spread: f64,
    /// Millions of rays a second.
    pub mrays_per_s: f64,
    /// Images a second if these rays were all.
    pub frames_per_s: f64,
    /// Visits a ray, see [`super::counts::Counts::visits`].
    pub visits: f64,
    /// Box tests a ray.
    pub boxes: f64,
    /// Tests of primitives a ray.
    pub primitive_tests: f64,
    /// Share of a packet's lanes that hit the children it visits.
    pub simd_efficiency: Option<f64>,
    /// Of the answers.
    pub hash: String,
    /// Share of rays that met another primitive than in exact precision.
    pub differing: f64,
}

/// A scene: thesis table 7.1.
#[derive(Debug, Clone, Serialize)]
pub struct SceneRow {
    /// Its name.
    pub scene: String,
    /// Triangles, spheres and disks.
    pub primitives: usize,
    /// Primitives of leaves: a split triangle counts several times.
    pub references: usize,
    /// Inner nodes and leaves.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// The most edges from the root to a leaf.
    pub depth: u32,
    /// Nodes of the wide hierarchy.
    pub wide_nodes: usize,
    /// What building took.
    pub build_ms: f64,
    /// Length of ambient occlusion rays in world units.
    pub ao_length: f64,
}

/// A view and the answers of all its rays.
#[derive(Debug, Clone, Serialize)]
pub struct ViewRow {
    /// The scene's name.
    pub scene: String,
    /// The camera's name.
    pub view: String,
    /// The order of pixels, which is part of the hash.
    pub order: String,
    /// Share of primary rays that hit something.
    pub hit_share: f64,
    /// Rays of all kinds that were measured.
    pub rays: usize,
    /// Of all their answers.
    pub hash: String,
}

/// All that was measured.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Report {
    /// Where and how.
    pub setup: Vec<(String, String)>,
    /// Scenes.
    pub scenes: Vec<SceneRow>,
    /// Views.
    pub views: Vec<ViewRow>,
    /// Every measurement.
    pub records: Vec<Record>,
    /// What was left out, and why.
    pub notes: Vec<String>,
    /// What failed or differed in exact precision, where nothing may.
    pub faults: Vec<String>,
}

impl Report {
    /// Keeps a note once.
    pub(super) fn note(&mut self, note: String) {
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }
}
