//! Light from far away, by a picture of all directions.

use std::sync::Arc;

use super::Texture;

/// A picture of the surroundings by the angles of a sphere: its middle is seen along x, what is right of it along z, and its
/// upper edge straight up along y, as Blender and three.js have it.
#[derive(Debug, Clone)]
pub struct Environment {
    /// Linear light, or of 8 bits in sRGB.
    pub texture: Arc<Texture>,
    /// The angle by which it is turned around the y axis, from x towards z (clockwise seen from above), in degrees.
    pub rotation: f32,
    /// What its light is multiplied with, at least 0.
    pub scale: f32,
    /// Does the camera see it? Without, it sees the scene's background in its place.
    pub visible: bool,
}

/// Two are the same if they take the same picture, not an equal one.
impl PartialEq for Environment {
    fn eq(&self, other: &Environment) -> bool {
        let numbers = |e: &Environment| (e.rotation, e.scale, e.visible);
        Arc::ptr_eq(&self.texture, &other.texture) && numbers(self) == numbers(other)
    }
}
