//! How spots fade.

use crate::choice::choices;

choices! {
    /// How a spot fades from its inner cone to its rim.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
    pub enum Falloff {
        /// By a cubic of the cosine, without an edge on either side
        #[default]
        Smooth = "smooth",
        /// By the square of a ramp over the cosine, as KHR_lights_punctual has it
        Gltf = "gltf",
    }
}
