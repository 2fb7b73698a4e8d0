//! What the numbers of a model's lamps mean.

use std::f64::consts::PI;

use crate::choice::choices;

choices! {
    /// In what unit a glTF file has the intensity of its lights.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum LightUnit {
        /// Candela and lux, which are taken as radiometric units
        Gltf = "gltf",
        /// Those of Blender's exporter in its lighting mode Standard: 683 lumens a watt, taken back
        Blender = "blender",
        /// Those of its lighting mode "Unitless, raw": watts of points and spots, and a sun's strength
        Raw = "raw",
    }
}

/// Lumens of a watt at 555 nm, which Blender's exporter takes for any light.
const LUMENS_A_WATT: f64 = 683.0;

impl LightUnit {
    /// The unit that a file is written in, by what wrote it: for Blender's exporter its default.
    pub fn of_generator(generator: Option<&str>) -> Self {
        let is_blender = generator.is_some_and(|name| name.contains("Khronos glTF Blender I/O"));
        if is_blender { LightUnit::Blender } else { LightUnit::Gltf }
    }

    /// What an intensity is multiplied with, to be watts by steradian or by square metre.
    pub fn factor(self, is_directional: bool) -> f64 {
        match self {
            LightUnit::Gltf => 1.0,
            // The exporter writes 683 W / 4 pi of points and spots, and 683 times the strength of a sun.
            LightUnit::Blender => 1.0 / LUMENS_A_WATT,
            LightUnit::Raw if is_directional => 1.0,
            LightUnit::Raw => 1.0 / (4.0 * PI),
        }
    }
}
