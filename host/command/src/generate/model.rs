//! What a generator makes: pieces that triangles are dealt out to, and all that a picture of them needs.

use glam::DVec3;

use super::patch::{Leaves, Patch, Sink};

/// A room or a clearing, before it is cut into triangles.
pub struct Model {
    pieces: Vec<Piece>,
    /// In the order of the material file.
    pub materials: Vec<Material>,
    /// Point lights.
    pub lights: Vec<Light>,
    /// Eye and target of each view, and its field of view in degrees.
    pub views: [View; 5],
    /// Light that is everywhere.
    pub ambient: [f64; 3],
    /// A material whose checks only the scene file can name, their other colour and their size.
    pub checker: Option<(&'static str, [f64; 3], f64)>,
    /// Colours at the horizon and straight up, if there is a sky.
    pub sky: Option<[[f64; 3]; 2]>,
}

/// A camera's place.
#[derive(Clone, Copy)]
pub struct View {
    /// Where it is.
    pub eye: DVec3,
    /// Where it looks.
    pub target: DVec3,
    /// Vertical field of view in degrees.
    pub fov: f64,
}

/// A point light.
pub struct Light {
    /// Where it is.
    pub position: DVec3,
    /// Linear RGB times intensity.
    pub colour: [f64; 3],
}

/// How a surface looks.
#[derive(Clone, Copy)]
pub struct Material {
    /// Its name in the files.
    pub name: &'static str,
    /// Linear RGB.
    pub diffuse: [f64; 3],
    /// Grey of the highlight; of a mirror, the share it reflects.
    pub specular: f64,
    /// Phong's exponent.
    pub shininess: f64,
    /// What else it does with light.
    pub finish: Finish,
}

/// What a material does with rays.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Finish {
    /// Neither reflects nor refracts.
    Dull,
    /// Reflects.
    Mirror,
    /// Reflects and refracts.
    Glass,
}

/// A sheet or a heap of leaves.
pub struct Piece {
    /// The OBJ group.
    pub group: &'static str,
    /// The material's name.
    pub material: &'static str,
    shape: Shape,
    weight: f64,
}

enum Shape {
    Patch(Patch),
    Leaves(Leaves),
}

impl From<Patch> for Shape {
    fn from(patch: Patch) -> Self {
        Shape::Patch(patch)
    }
}

impl From<Leaves> for Shape {
    fn from(leaves: Leaves) -> Self {
        Shape::Leaves(leaves)
    }
}

impl Piece {
    fn fewest(&self) -> u64 {
        match &self.shape {
            Shape::Patch(patch) => patch.fewest(),
            Shape::Leaves(_) => 1,
        }
    }

    /// Only an even number of triangles closes a surface.
    fn step(&self) -> u64 {
        match &self.shape {
            Shape::Patch(patch) if patch.is_closed() => 2,
            _ => 1,
        }
    }

    /// Cuts it into exactly `count` triangles.
    pub fn cut(&self, count: u64, sink: &mut dyn Sink) {
        match &self.shape {
            Shape::Patch(patch) => patch.cut(count, sink),
            Shape::Leaves(leaves) => leaves.cut(count, sink),
        }
    }
}

impl Model {
    /// Nothing yet but five views.
    pub fn new(views: [View; 5], materials: &[Material]) -> Self {
        Model {
            pieces: Vec::new(),
            materials: materials.to_vec(),
            lights: Vec::new(),
            views,
            ambient: [0.0; 3],
            checker: None,
            sky: None,
        }
    }

    /// Adds a sheet. Triangles are dealt out by area times `density`, and planes take none.
    pub fn add(&mut self, group: &'static str, material: &'static str, density: f64, patch: Patch) {
        let weight = if patch.is_plane() { 0.0 } else { patch.area() * density };
        self.pieces.push(Piece { group, material, shape: patch.into(), weight });
    }

    /// Adds several sheets.
    pub fn add_all(
        &mut self,
        group: &'static str,
        material: &'static str,
        density: f64,
        patches: impl IntoIterator<Item = Patch>,
    ) {
        patches.into_iter().for_each(|patch| self.add(group, material, density, patch));
    }

    /// Adds leaves.
    pub fn scatter(&mut self, group: &'static str, material: &'static str, density: f64, leaves: Leaves) {
        let weight = leaves.area() * density;
        self.pieces.push(Piece { group, material, shape: leaves.into(), weight });
    }

    /// Gives a group this share of the triangles that are dealt out.
    pub fn share(&mut self, group: &str, share: f64) {
        let sum = |own: bool| self.pieces.iter().filter(|p| (p.group == group) == own).map(|p| p.weight).sum::<f64>();
        let factor = sum(false) / sum(true) * share / (1.0 - share);
        self.pieces.iter_mut().filter(|p| p.group == group).for_each(|p| p.weight *= factor);
    }

    /// Leaves out groups in this order until triangles remain to be dealt out.
    pub fn fit(&mut self, triangles: u64, least: &[&str]) {
        for group in least {
            if 5 * self.fewest() <= 4 * triangles {
                return;
            }
            self.pieces.retain(|piece| piece.group != *group);
        }
    }

    /// The fewest triangles that show every piece.
    pub fn fewest(&self) -> u64 {
        self.pieces.iter().map(Piece::fewest).sum()
    }

    /// Deals out exactly `triangles`, at least [`Model::fewest`]. The last piece with a weight takes what is left,
    /// so that it must not be a closed one.
    pub fn deal(&self, triangles: u64) -> impl Iterator<Item = (&Piece, u64)> {
        let spare = triangles.checked_sub(self.fewest()).expect("enough triangles for every piece");
        let total: f64 = self.pieces.iter().map(|p| p.weight).sum();
        let last = self.pieces.iter().rposition(|p| p.weight > 0.0);
        let (mut sum, mut used) = (0.0, 0);
        self.pieces.iter().enumerate().map(move |(i, piece)| {
            sum += piece.weight;
            let target = if Some(i) == last { spare } else { ((spare as f64 * (sum / total)) as u64).min(spare) };
            let more = if piece.weight > 0.0 { (target - used) / piece.step() * piece.step() } else { 0 };
            used += more;
            (piece, piece.fewest() + more)
        })
    }
}
