//! Surroundings of what comes without light: a grey room with three lamps, so that even a mirror has a form.

use std::sync::{Arc, LazyLock};

use super::{Environment, Texels, Texture};

/// Its name where a scene file asks for an environment.
pub const NAME: &str = "studio";

const WIDTH: u32 = 64;
const HEIGHT: u32 = 32;
/// What a ray meets straight up, at the height of the eye and straight down; between them light is mixed by the angle.
const ROOM: [f32; 3] = [0.5, 0.28, 0.18];
/// Columns and rows of each lamp, and its light: the key to the left of who looks along the negative z axis, a fill to the right, and
/// a rim behind what is looked at. A matt white surface that faces up sends 0.93 of a screen's white, one that faces that eye 0.66.
const LAMPS: [([u32; 2], [u32; 2], f32); 3] =
    [([50, 58], [5, 11], 5.0), ([33, 41], [8, 16], 1.5), ([16, 24], [3, 7], 4.0)];

static TEXTURE: LazyLock<Arc<Texture>> = LazyLock::new(|| {
    let places = (0..HEIGHT).flat_map(|row| (0..WIDTH).map(move |column| (column, row)));
    let texels = places.map(|(column, row)| radiance(column, row)).map(|light| [light, light, light, 1.0]).collect();
    Arc::new(Texture { name: NAME.into(), width: WIDTH, height: HEIGHT, texels: Texels::Floats(texels) })
});

/// Its picture, one for all who ask.
pub fn texture() -> Arc<Texture> {
    TEXTURE.clone()
}

/// A picture of one texel.
pub fn blank() -> Arc<Texture> {
    static BLANK: LazyLock<Arc<Texture>> = LazyLock::new(|| {
        Arc::new(Texture { name: String::new(), width: 1, height: 1, texels: Texels::Bytes(vec![[255; 4]]) })
    });
    BLANK.clone()
}

/// The studio, which the camera does not see.
pub fn environment() -> Environment {
    Environment { texture: texture(), rotation: 0.0, scale: 1.0, visible: false }
}

fn radiance(column: u32, row: u32) -> f32 {
    let holds = |[from, to]: [u32; 2], place| (from..to).contains(&place);
    let lamp = LAMPS.iter().find(|(columns, rows, _)| holds(*columns, column) && holds(*rows, row));
    if let Some((.., light)) = lamp {
        return *light;
    }
    let down = 2.0 * (row as f32 + 0.5) / HEIGHT as f32;
    let [up, level, below] = ROOM;
    if down < 1.0 { up + (level - up) * down } else { level + (below - level) * (down - 1.0) }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use glam::DVec3;

    use super::*;

    /// What a matt white surface sends that faces a direction.
    fn sent(normal: DVec3) -> f64 {
        let (columns, rows) = (f64::from(WIDTH), f64::from(HEIGHT));
        let part = |column: u32, row: u32| {
            let (angle, height) =
                ((f64::from(column) + 0.5) / columns * TAU - PI, PI / 2.0 - (f64::from(row) + 0.5) / rows * PI);
            let direction = DVec3::new(angle.cos() * height.cos(), height.sin(), angle.sin() * height.cos());
            let solid_angle = TAU / columns * (PI / rows) * height.cos();
            f64::from(radiance(column, row)) * direction.dot(normal).max(0.0) * solid_angle / PI
        };
        (0..HEIGHT).flat_map(|row| (0..WIDTH).map(move |column| part(column, row))).sum()
    }

    #[test]
    fn what_faces_up_is_nearly_a_screens_white_and_no_side_is_dark() {
        assert!((sent(DVec3::Y) - 0.93).abs() < 0.01, "{}", sent(DVec3::Y));
        assert!((sent(DVec3::Z) - 0.66).abs() < 0.01, "{}", sent(DVec3::Z));
        let sides = [DVec3::X, DVec3::NEG_X, DVec3::NEG_Z, DVec3::NEG_Y].map(sent);
        assert!(sides.iter().all(|&light| (0.2..0.6).contains(&light)), "{sides:?}");
    }
}
