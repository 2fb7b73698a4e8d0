//! What the cameras of a scene have beside pinholes: kernels are compiled for what some camera of the scene needs, and read its tables.

mod outline;
mod record;

use eyerays_shader::camera::FILTER_STEPS;
use eyerays_shader::data::Launch;

pub(crate) use self::outline::Outline;
pub(crate) use self::record::CameraRecord;
use crate::scene::{Camera, Lens, PixelFilter};

/// Of all cameras of a scene.
#[derive(Debug, Clone, Default)]
pub(crate) struct Optics {
    /// Of their projections, their eyes and what they do not see, see [`Launch`].
    cameras: u32,
    /// Of their lenses, each once.
    outlines: Vec<Outline>,
}

impl Optics {
    /// What these cameras need.
    pub fn of<'c>(cameras: impl IntoIterator<Item = &'c Camera>) -> Optics {
        let mut optics = Optics::default();
        for camera in cameras {
            optics.cameras |= camera.bits();
            let outline = camera.lens.filter(|lens| lens.radius > 0.0).map(|lens| Outline::of(&lens));
            optics.outlines.extend(outline.filter(|outline| !optics.outlines.contains(outline)));
        }
        optics
    }

    /// Bits of the constant of kernels, see [`Launch`].
    pub fn bits(&self) -> u32 {
        self.cameras | if self.outlines.is_empty() { 0 } else { Launch::LENS }
    }

    /// The first corner of a lens' outline among all and how many it has, if some camera has such a lens.
    pub fn corners(&self, lens: &Lens) -> Option<(u32, u32)> {
        let outline = Outline::of(lens);
        let number = self.outlines.iter().position(|own| *own == outline)?;
        let first = self.outlines[..number].iter().map(|outline| outline.corners() + 1).sum();
        Some((first, outline.corners()))
    }

    /// The tables that kernels read, see [`eyerays_shader::camera::ray`]; none where they would read none.
    pub fn words(&self, filter: PixelFilter) -> Vec<u32> {
        if filter == PixelFilter::Box && self.outlines.is_empty() {
            return Vec::new();
        }
        let outlines = self.outlines.iter().flat_map(Outline::points).flatten();
        filter.inverse(FILTER_STEPS).into_iter().chain(outlines).map(f32::to_bits).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::Projection;

    #[test]
    fn equal_outlines_are_kept_once_and_each_camera_finds_its_own() {
        let camera = |lens| {
            let projection = Projection::Perspective { fov: 40.0 };
            Camera { lens, ..Camera::new("", Vec3::Z, Vec3::ZERO, projection) }
        };
        let (round, six) = (Lens::round(0.5), Lens { blades: 6, ..Lens::round(0.1) });
        let cameras = [
            Some(round),
            Some(six),
            None,
            Some(Lens { radius: 3.0, ..round }),
            Some(Lens { radius: 0.0, blades: 5, ..round }),
        ];
        let optics = Optics::of(&cameras.map(camera));
        assert_eq!(optics.bits(), Launch::LENS);
        let (first, second) = (optics.corners(&round).unwrap(), optics.corners(&six).unwrap());
        assert_eq!((first.0, second), (0, (first.1 + 1, 252)));
        assert_eq!(optics.corners(&Lens { blades: 5, ..round }), None);
        let words = optics.words(PixelFilter::Box).len() as u32;
        assert_eq!(words, FILTER_STEPS + 1 + 2 * (first.1 + 1 + second.1 + 1));
        assert!(Optics::of(&[camera(None)]).words(PixelFilter::Box).is_empty());
    }
}
