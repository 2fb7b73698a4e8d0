//! Whether settings make sense, and what they leave out.

use crate::error::{Error, Result};
use crate::picture::Picture;
use crate::scene::{Integrator, Settings};

/// Refuses settings beyond the limits that memory is planned for.
///
/// # Errors
/// The first of them.
pub fn settings(settings: &Settings) -> Result<()> {
    let Settings { size: (width, height), samples, spp, bounces, min_contribution, transport, .. } = *settings;
    Picture::check_size(width, height)?;
    crate::error::within("samples", &[samples], 1..=Settings::MOST_SAMPLES)?;
    crate::error::within("bounces", &[bounces], 0..=Settings::MOST_BOUNCES)?;
    crate::error::within("min_contribution", &[min_contribution], 0.0..=1.0)?;
    crate::error::within("spp", &[spp], 0..=Settings::MOST_SPP)?;
    crate::error::within("clamp", &[transport.clamp], 0.0..=f32::MAX)?;
    crate::error::within("ao_distance", &[transport.ao_distance], f32::MIN_POSITIVE..=f32::INFINITY)?;
    settings.grid().map(|_| ())
}

/// Refuses to leave out light.
///
/// # Errors
/// The integrator draws no light that materials emit.
pub fn emission(emissive: Option<&str>, integrator: Integrator) -> Result<()> {
    match (emissive, integrator) {
        (Some(name), Integrator::Whitted) => Err(Error::new(format!(
            "the material {name:?} emits light, which the integrator whitted does not draw: choose path or distributed (--integrator path)"
        ))),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use eyerays_bvh::Quality;

    use super::*;
    use crate::device_scene::DeviceScene;
    use crate::method::Method;
    use crate::scene::Scene;

    fn whitted() -> Scene {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/whitted.toml");
        crate::scene::load(path.as_ref()).unwrap().0
    }

    fn refusal(scene: &Scene, settings: Settings) -> Option<String> {
        let packed = DeviceScene::new(scene, settings, Quality::Fast);
        packed.err().map(|error| error.message())
    }

    #[test]
    fn a_method_is_refused_whose_nodes_were_not_packed() {
        let scene = whitted();
        let packed = DeviceScene::new(&scene, scene.settings, Quality::Fast).unwrap();
        let refused = packed.check_walks(Method::Wide).expect_err("accepted").message();
        assert!(refused.ends_with("pack it by DeviceScene::with_wide_nodes"), "{refused}");
        assert!(packed.check_walks(Method::IfIf).is_ok());
        let packed = DeviceScene::with_wide_nodes(&scene, scene.settings, Quality::Fast).unwrap();
        assert!(packed.check_walks(Method::Wide).is_ok());
    }

    #[test]
    fn settings_beyond_their_limits_are_refused_when_they_are_taken_too() {
        let scene = whitted();
        let mut packed = DeviceScene::new(&scene, scene.settings, Quality::Fast).unwrap();
        for beyond in [
            Settings { size: (0, 4), ..scene.settings },
            Settings { samples: 0, ..scene.settings },
            Settings { bounces: u32::MAX, ..scene.settings },
            Settings { min_contribution: f32::NAN, ..scene.settings },
        ] {
            assert!(refusal(&scene, beyond).is_some(), "{beyond:?}");
            assert!(packed.set(beyond).is_err(), "{beyond:?}");
        }
        assert_eq!(*packed.settings(), scene.settings);
    }
}
