//! Cameras as text: for a clipboard, and for a scene's file.

use std::fs;
use std::io::Write;
use std::path::Path;

use eyerays::error::{Error, Result};
use eyerays::scene::Camera;
use eyerays::scene_io;

/// What a camera is called that has no name.
const NAME: &str = "view";

/// A camera as a table of a TOML scene.
pub(crate) fn toml(camera: &Camera) -> String {
    scene_io::describe_camera(camera)
}

/// Adds a camera to a TOML scene under a name that no other has, and tells that.
///
/// # Errors
/// A file that is none, or that can't be read or written; it is as it was then.
pub(crate) fn add(path: &Path, camera: &Camera) -> Result<String> {
    if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) {
        let remedy = "make one of it by `eyerays convert` and open that";
        return Err(Error::file(path, format!("cameras are added to .toml scenes alone; {remedy}")));
    }
    let text = fs::read_to_string(path).map_err(|error| Error::file(path, format!("it can't be read: {error}")))?;
    let (scene, _) = scene_io::read_as(text.as_bytes(), path, scene_io::Loading::default())?;
    let is_taken = |name: &String| scene.cameras.iter().any(|other| other.name == *name);
    let stem = if camera.name.is_empty() { NAME } else { &camera.name };
    let name = (1u32..).map(|number| if number == 1 { stem.to_owned() } else { format!("{stem} {number}") });
    let name = name.into_iter().find(|name| !is_taken(name)).expect("numbers do not end");
    let added = toml(&Camera { name: name.clone(), ..camera.clone() });
    let text = format!("{}\n\n{added}", text.trim_end());
    // Where cameras are written in another way, the file would be one no more.
    scene_io::read_as(text.as_bytes(), path, scene_io::Loading::default())?;
    replace(path, &text).map_err(|error| Error::file(path, format!("it can't be written: {error}")))?;
    Ok(name)
}

/// Puts a text in the place of a file at once: a crash leaves one or the other.
fn replace(path: &Path, text: &str) -> std::io::Result<()> {
    // A link stays one.
    let path = fs::canonicalize(path)?;
    let mut file = tempfile::NamedTempFile::new_in(path.parent().unwrap_or(Path::new(".")))?;
    file.write_all(text.as_bytes())?;
    file.as_file().set_permissions(fs::metadata(&path)?.permissions())?;
    file.as_file().sync_all()?;
    file.persist(path).map(drop).map_err(|error| error.error)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/cornell.toml");

    fn copy() -> (tempfile::TempDir, std::path::PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        fs::copy(SCENE, &path).unwrap();
        (folder, path)
    }

    #[test]
    fn an_added_camera_is_there_when_the_scene_is_read_again_and_all_else_is_as_it_was() {
        let (_folder, path) = copy();
        let (before, _) = scene_io::load(&path).unwrap();
        let camera = Camera { eye: Vec3::new(1.5, 2.25, -3.125), name: String::new(), ..before.cameras[0].clone() };
        let names = [add(&path, &camera).unwrap(), add(&path, &camera).unwrap()];
        assert_eq!(names, ["view", "view 2"]);
        let (after, _) = scene_io::load(&path).unwrap();
        assert_eq!(after.cameras.len(), before.cameras.len() + 2);
        let added = &after.cameras[before.cameras.len()];
        assert_eq!(*added, Camera { name: "view".to_owned(), ..camera });
        assert_eq!((after.materials, after.lights), (before.materials, before.lights));
    }

    #[test]
    fn a_file_that_would_be_no_scene_any_more_stays_as_it_is() {
        let (_folder, path) = copy();
        let camera = scene_io::load(&path).unwrap().0.cameras[0].clone();
        for (text, fault) in
            [("camera = [{ eye = [0, 0, 5], target = [0, 0, 0] }]\n", "camera"), ("= no TOML", "unquoted keys")]
        {
            fs::write(&path, text).unwrap();
            let error = add(&path, &camera).unwrap_err().to_string();
            assert!(error.contains(fault) && error.contains("scene.toml"), "{error}");
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        let error = add("model.glb".as_ref(), &camera).unwrap_err().to_string();
        assert!(error.contains("eyerays convert"), "{error}");
    }
}
