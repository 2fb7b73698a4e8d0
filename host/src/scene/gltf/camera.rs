//! Cameras.

use std::collections::HashSet;

use super::document::{Document, pick};
use super::light::View;
use super::node::Placed;
use super::notes::Notes;
use crate::scene::range::Range;
use crate::scene::{Camera, Unplaced};

/// The cameras of a scene so far, each with a name of its own.
#[derive(Default)]
pub struct Cameras {
    /// In the order of nodes.
    pub all: Vec<Camera>,
    names: HashSet<String>,
}

impl Cameras {
    /// Adds that of a node, if it has one that is drawn with.
    ///
    /// # Errors
    /// There is no such camera, or its field of view is out of range.
    pub fn add(&mut self, placed: &Placed, document: &Document, notes: &mut Notes) -> Unplaced<()> {
        let Some(number) = placed.node.camera else { return Ok(()) };
        let here = format!("nodes[{}].camera", placed.number);
        let of = pick(&document.cameras, number, &here, "camera")?;
        let Some(perspective) = &of.perspective else {
            notes.once("orthographic", "orthographic cameras are left out: only those with perspective are read");
            return Ok(());
        };
        let fov = perspective.yfov.to_degrees() as f32;
        if !Range::CONE.holds(fov) {
            let says = Range::CONE.says();
            return Err(format!("cameras[{number}].perspective.yfov: {fov} degrees must be {says}; repair it"));
        }
        let view = View::of(placed);
        let camera =
            view.map(|view| Camera { name: String::new(), eye: view.eye, target: view.target(), up: view.up, fov });
        let is_good = |camera: &Camera| {
            camera.eye.is_finite() && camera.target.is_finite() && camera.eye != camera.target && camera.is_upright()
        };
        let Some(camera) = camera.filter(is_good) else {
            notes.once("camera", &format!("{here}: it is left out, as its transform gives it no place or direction"));
            return Ok(());
        };
        let name = placed.node.name.as_deref().or(of.name.as_deref());
        let name = self.name(name.filter(|name| !name.is_empty()).unwrap_or("camera"));
        self.all.push(Camera { name, ..camera });
        Ok(())
    }

    /// The name, with a number if it is taken.
    fn name(&mut self, wish: &str) -> String {
        if self.names.insert(wish.to_owned()) {
            return wish.to_owned();
        }
        // As many as there are cameras make one of them free.
        let numbered = (2..self.all.len() + 3).map(|number| format!("{wish} {number}"));
        let free = numbered.into_iter().find(|name| !self.names.contains(name)).unwrap_or_else(|| wish.to_owned());
        self.names.insert(free.clone());
        free
    }
}
