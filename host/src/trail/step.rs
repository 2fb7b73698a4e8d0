//! What a ray did on its way, as records to read.

use serde::Serialize;

use crate::method::Method;
use crate::pick::Surface;
use crate::view::Region;

/// The way of one ray through the hierarchy by one method, in the order of its steps. Lengths are in the scene's units from where the
/// camera's ray starts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trail {
    /// How the ray was followed; never [`Method::Auto`].
    pub method: Method,
    /// The pixels whose rays were followed together with this one, of a method that follows packets.
    pub packet: Option<Region>,
    /// All that the ray, or its packet, did.
    pub steps: Vec<Step>,
    /// What the ray found in the end.
    pub hit: Option<Contact>,
}

impl Trail {
    /// How many nodes were visited: pairs of boxes, or nodes of eight.
    pub fn visits(&self) -> usize {
        self.steps.iter().filter(|step| matches!(step, Step::Visit(_))).count()
    }

    /// How many primitives were tested.
    pub fn tests(&self) -> usize {
        self.steps.iter().filter(|step| matches!(step, Step::Test(_))).count()
    }

    /// The depth of the deepest node that was visited; that of the root is 0.
    pub fn deepest(&self) -> u32 {
        let depth = |step: &Step| if let Step::Visit(visit) = step { visit.depth } else { 0 };
        self.steps.iter().map(depth).max().unwrap_or(0)
    }
}

/// One step of a ray.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "step", rename_all = "snake_case")]
pub enum Step {
    /// The boxes of a node's children were tested.
    Visit(Visit),
    /// A primitive was tested.
    Test(Test),
    /// What waited was left out, since it begins behind the closest hit.
    Drop {
        /// What it is.
        child: Target,
        /// Where the ray enters its box.
        near: f64,
    },
}

/// The visit of a node.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Visit {
    /// The node's number: that of its pair of children, or of the node of eight.
    pub node: u32,
    /// The copy of a mesh that it is in, by the number of its record.
    pub copy: Option<u32>,
    /// How many nodes are above it.
    pub depth: u32,
    /// How many rays made this step together.
    pub rays: u32,
    /// Its children in the order in which they lie in memory.
    pub children: Vec<Child>,
}

/// A child whose box was tested.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Child {
    /// What it is.
    pub child: Target,
    /// Where the ray enters its box, at least where the ray starts.
    pub near: f64,
    /// Where the ray leaves the box, or the closest hit so far if that is nearer. Less than `near` if the ray misses the box, or meets
    /// it behind that hit.
    pub far: f64,
    /// How many of the rays that made this step together meet the box.
    pub rays: u32,
    /// What becomes of it.
    pub fate: Fate,
}

/// What a reference in the hierarchy leads to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// A node by its number.
    Node(u32),
    /// A leaf.
    Leaf {
        /// The place of its first primitive in the order of leaves, or the number of its block among those of its kind.
        number: u32,
        /// How many primitives it has.
        primitives: u32,
    },
    /// A copy of a mesh, by the number of its record.
    Copy(u32),
}

/// What becomes of a child whose box was tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// No ray visits it.
    Missed,
    /// It is visited next.
    Next,
    /// It is pushed on the stack, to be visited later.
    Pushed,
    /// The rays that meet it leave the packet for it.
    Alone,
}

/// The test of a primitive.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Test {
    /// What was tested.
    pub surface: Surface,
    /// How many rays made this step together.
    pub rays: u32,
    /// What came of it for the ray.
    pub outcome: Outcome,
    /// Where the ray meets it, if it does.
    pub contact: Option<Place>,
}

/// What came of the test of a primitive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The ray does not meet it.
    Miss,
    /// It is the closest hit so far.
    Closest,
    /// The ray meets it, and something nearer, or the same again.
    Farther,
}

/// Where a ray meets a primitive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Place {
    /// How far from where the ray starts.
    pub t: f64,
    /// Where on the surface: the weight of a triangle's second vertex, or see [`coordinates`](eyerays_shader::traverse::leaf::coordinates).
    pub u: f32,
    /// The weight of its third vertex.
    pub v: f32,
}

/// What a ray found in the end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Contact {
    /// What it is.
    pub surface: Surface,
    /// Where the ray meets it.
    #[serde(flatten)]
    pub place: Place,
}
