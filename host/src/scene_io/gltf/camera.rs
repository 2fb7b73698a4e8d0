//! Cameras.

use std::collections::HashMap;

use super::document::{self, Document, pick};
use super::light::View;
use super::node::Placed;
use super::notes::Notes;
use crate::scene::Range;
use crate::scene::{Camera, Projection, Unplaced};

/// The cameras of a scene so far, each with a name of its own.
#[derive(Default)]
pub struct Cameras {
    /// In the order of nodes.
    pub all: Vec<Camera>,
    /// Width over height of the first one's picture, if it says so.
    pub aspect: Option<f64>,
    /// The number that the next of a name gets, if the name is taken.
    next: HashMap<String, u32>,
}

/// What a camera's image holds, and how many times it is as wide as high, if it says so.
fn projection(of: &document::Camera, number: usize) -> Unplaced<Option<(Projection, Option<f64>)>> {
    if let Some(perspective) = &of.perspective {
        let fov = perspective.yfov.to_degrees() as f32;
        if !Range::CONE.holds(fov) {
            let says = Range::CONE.says();
            return Err(format!("cameras[{number}].perspective.yfov: {fov} degrees must be {says}; repair it"));
        }
        return Ok(Some((Projection::Perspective { fov }, perspective.aspect_ratio)));
    }
    // Negative ones are of exporters that mirror the image; no reader does.
    let whole = |of: &document::Orthographic| (2.0 * of.xmag.abs(), 2.0 * of.ymag.abs());
    let (width, height) = of.orthographic.as_ref().map(whole).unwrap_or_default();
    let is_good = Range::LENGTH.holds(width as f32) && Range::LENGTH.holds(height as f32);
    Ok(is_good.then(|| (Projection::Orthographic { height: height as f32 }, Some(width / height))))
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
        let Some((projection, aspect)) = projection(of, number)? else {
            notes.left_out("camera", &format!("{here}: it is left out, as it has neither a field of view nor a size"));
            return Ok(());
        };
        let view = View::of(placed);
        let camera = view.map(|view| Camera { up: view.up, ..Camera::new("", view.eye, view.target(), projection) });
        let is_good = |camera: &Camera| {
            camera.eye.is_finite() && camera.target.is_finite() && camera.eye != camera.target && camera.is_upright()
        };
        let Some(camera) = camera.filter(is_good) else {
            notes.left_out(
                "camera",
                &format!("{here}: it is left out, as its transform gives it no place or direction"),
            );
            return Ok(());
        };
        let name = placed.node.name.as_deref().or(of.name.as_deref());
        let name = self.name(name.filter(|name| !name.trim().is_empty()).unwrap_or("camera"));
        if self.all.is_empty() {
            self.aspect = aspect.filter(|aspect| aspect.is_finite() && *aspect > 0.0);
        }
        self.all.push(Camera { name, ..camera });
        Ok(())
    }

    /// The name, with a number if it is taken.
    fn name(&mut self, wish: &str) -> String {
        let mut number = self.next.get(wish).copied().unwrap_or(1);
        loop {
            let name = if number == 1 { wish.to_owned() } else { format!("{wish} {number}") };
            number = number.saturating_add(1);
            if !self.next.contains_key(&name) {
                self.next.insert(name.clone(), 2);
                self.next.insert(wish.to_owned(), number);
                return name;
            }
        }
    }
}
