//! Lines over the picture: boxes of the hierarchy.

use eframe::egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, Vec2};
use eyerays::device_scene::NodeBox;
use eyerays::scene::Camera;
use glam::{DVec3, Vec3};

use crate::news::Told;

/// Boxes of one level.
const LEVEL: Color32 = Color32::from_rgb(90, 200, 255);
/// Those of leaves among them.
const LEAF: Color32 = Color32::from_rgb(120, 230, 120);
/// An edge that a camera bends, or that ends behind it, is drawn in so many pieces.
const PIECES: u32 = 16;

/// Draws boxes as a camera sees them over its picture, which has this place in the window and so many columns and rows.
pub(super) fn draw(painter: &Painter, (place, size): (Rect, (u32, u32)), camera: &Camera, told: &Told) {
    if camera.stereo.is_some() {
        // Which shows two eyes' images in the place of one.
        return;
    }
    let painter = painter.with_clip_rect(place);
    let seen = Seen { place, size, camera };
    let boxes = told.boxes.iter().map(|bounds| (bounds, if bounds.is_leaf { LEAF } else { LEVEL }));
    let entered = told.way.iter().flat_map(|way| &way.entered);
    let deepest = entered.clone().map(|(_, depth)| *depth).max().unwrap_or(0);
    let entered = entered.map(|(bounds, depth)| (bounds, warm(*depth, deepest)));
    for (bounds, colour) in boxes.chain(entered) {
        painter.extend(seen.edges(bounds).map(|ends| Shape::line_segment(ends, Stroke::new(1.0, colour))));
    }
}

/// From red for the root's children to yellow for the deepest.
fn warm(depth: u32, deepest: u32) -> Color32 {
    Color32::from_rgb(255, (255 * depth / deepest.max(1)).min(255) as u8, 60)
}

/// What a camera sees in a rectangle.
struct Seen<'a> {
    place: Rect,
    size: (u32, u32),
    camera: &'a Camera,
}

impl Seen<'_> {
    fn at(&self, place: DVec3) -> Option<Pos2> {
        let seen = self.camera.seen_at(place, self.size)?;
        let share = Vec2::new(seen.x as f32 / self.size.0 as f32, seen.y as f32 / self.size.1 as f32);
        Some(self.place.min + share * self.place.size())
    }

    /// The edges of a box, as far as they are before the camera.
    fn edges(&self, bounds: &NodeBox) -> impl Iterator<Item = [Pos2; 2]> {
        edges(bounds).flat_map(move |[start, end]| {
            let is_flat = self.camera.projection.is_flat();
            let is_straight = is_flat && self.at(start).is_some() && self.at(end).is_some();
            let pieces = if is_straight { 1 } else { PIECES };
            let at = move |piece: u32| self.at(start.lerp(end, f64::from(piece) / f64::from(pieces)));
            // An image of all around has its ends far apart.
            let is_whole = move |[a, b]: &[Pos2; 2]| is_flat || (*a - *b).length() < self.place.width() / 2.0;
            (0..pieces).filter_map(move |piece| Some([at(piece)?, at(piece + 1)?])).filter(is_whole)
        })
    }
}

/// The twelve edges of a box.
fn edges(bounds: &NodeBox) -> impl Iterator<Item = [DVec3; 2]> {
    let NodeBox { least, greatest, .. } = *bounds;
    let corner = move |bits: usize| {
        let side = |axis: usize| if bits >> axis & 1 == 0 { least[axis] } else { greatest[axis] };
        Vec3::new(side(0), side(1), side(2)).as_dvec3()
    };
    let of =
        move |axis: usize| (0..8).filter(move |bits| bits >> axis & 1 == 0).map(move |bits| [bits, bits | 1 << axis]);
    (0..3).flat_map(of).map(move |ends| ends.map(corner))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use eyerays::scene::Projection;

    use super::*;

    const UNIT: NodeBox = NodeBox { least: Vec3::ZERO, greatest: Vec3::ONE, is_leaf: true };

    #[test]
    fn a_box_has_twelve_edges_each_along_an_axis() {
        let edges: Vec<[DVec3; 2]> = edges(&UNIT).collect();
        assert_eq!(edges.len(), 12);
        let different: BTreeSet<String> = edges.iter().map(|ends| format!("{ends:?}")).collect();
        assert_eq!(different.len(), 12);
        assert!(edges.iter().all(|[start, end]| [DVec3::X, DVec3::Y, DVec3::Z].contains(&(*end - *start))));
    }

    #[test]
    fn edges_are_where_the_camera_sees_them_and_nothing_behind_it_is_drawn() {
        let perspective = Projection::Perspective { fov: 40.0 };
        let mut camera = Camera::new("", Vec3::new(0.5, 0.5, 4.0), Vec3::splat(0.5), perspective);
        let place = Rect::from_min_size(Pos2::new(10.0, 20.0), Vec2::new(200.0, 100.0));
        let count = |camera: &Camera| {
            let seen = Seen { place, size: (400, 200), camera };
            let edges: Vec<_> = seen.edges(&UNIT).collect();
            assert!(edges.iter().flatten().all(|end| end.x.is_finite() && end.y.is_finite()));
            edges
        };
        let edges = count(&camera);
        assert_eq!(edges.len(), 12);
        // It is right in the middle.
        let sum = edges.iter().flatten().fold(Vec2::ZERO, |sum, end| sum + end.to_vec2()) / 24.0;
        assert!((sum - place.center().to_vec2()).length() < 1e-3, "{sum:?}");
        camera.eye.z = 0.5;
        camera.target = Vec3::new(0.5, 0.5, -1.0);
        // Four edges behind, four before, and half of the others.
        assert_eq!(count(&camera).len(), 4 + 4 * PIECES as usize / 2 - 4);
        camera.target = Vec3::new(0.5, 0.5, 9.0);
        camera.eye.z = 4.0;
        assert_eq!(count(&camera), Vec::<[Pos2; 2]>::new());
    }
}
