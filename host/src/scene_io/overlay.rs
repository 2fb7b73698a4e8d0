//! What goes before a scene's own tables.

use std::path::Path;

use super::budget::Budget;
use super::source::Source;
use super::{camera_table, document};
use crate::error::Result;
use crate::memory::Room;
use crate::scene::{self, Scene};

/// Lets the tables `[render]` and `[[camera]]` of a text go before a scene's own: of `render` the keys that it has, and its cameras instead of
/// all others. Errors call the text `name`.
///
/// # Errors
/// Those of [`load`](super::load) in these tables, or other tables.
pub fn overlay(scene: &mut Scene, name: &Path, text: &str) -> Result<()> {
    let mut table = Source::new(name, text).parse(&Budget::new(Room::now()))?;
    let (render, cameras) = (table.table("render")?, table.tables("camera")?);
    table.done()?;
    if let Some(render) = render {
        let before = scene.settings.transport.integrator;
        scene.settings = document::settings(render, scene.settings)?;
        let integrator = scene.settings.transport.integrator;
        if integrator != before {
            scene::without_spare_lamps(scene, integrator);
        }
    }
    if let Some(cameras) = cameras {
        scene.cameras = camera_table::cameras(cameras, 0.0)?.0;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Integrator;
    use crate::scene_io;

    fn cornell() -> Scene {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/cornell_path.toml");
        scene_io::load(path.as_ref()).unwrap().0
    }

    #[test]
    fn what_a_text_says_goes_before_the_scene_and_all_else_stays() {
        let own = cornell();
        let mut scene = cornell();
        let text = "[render]\nsize = [7, 5]\nspp = 3\n[[camera]]\nname = \"mine\"\neye = [0, 1, 9]\ntarget = [0, 1, 0]";
        overlay(&mut scene, "arguments".as_ref(), text).unwrap();
        assert_eq!((scene.settings.size, scene.settings.spp), ((7, 5), 3));
        assert_eq!(scene.settings.transport, own.settings.transport);
        assert_eq!(scene.settings.sampler, own.settings.sampler);
        assert_eq!(scene.cameras.iter().map(|camera| &*camera.name).collect::<Vec<_>>(), ["mine"]);
        overlay(&mut scene, "arguments".as_ref(), "[render]\nintegrator = \"ao\"\nsamples = 2").unwrap();
        assert_eq!(scene.settings.transport.integrator, Integrator::Ao);
        assert_eq!((scene.settings.samples_a_pixel(), scene.settings.size, scene.cameras.len()), (4, (7, 5), 1));
        overlay(&mut scene, "arguments".as_ref(), "").unwrap();
    }

    #[test]
    fn what_makes_no_sense_is_refused_by_its_line() {
        for (text, fault) in [
            ("[render]\nbouncs = 3", "arguments:2"),
            ("[render]\nspp = 0", "arguments:2"),
            ("[[mesh]]\nshape = \"quad\"", "arguments:1"),
            ("[[camera]]\nname = \"c\"\neye = [0, 0, 0]\ntarget = [0, 0, 0]", "arguments:4"),
        ] {
            let error = overlay(&mut cornell(), "arguments".as_ref(), text).unwrap_err().to_string();
            assert!(error.contains(fault), "{error}");
        }
    }
}
