//! `eyerays convert`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;

use super::choice::choice;
use super::options::Read;
use super::{console, plural, progress};
use crate::error::{Error, Result};
use crate::output::{self, Destination};
use eyerays::device_scene;
use eyerays::quality::Bvh;
use eyerays::scene;

pub(super) const EXAMPLES: &str = "\
Examples:
  eyerays convert hall.toml hall.eyerays
  eyerays convert hall.toml hall.eyerays --bvh high
  eyerays render hall.eyerays --camera view1 -o hall.png
The file holds all that the scene's files say and a hierarchy, and renders to the same picture without them.
It needs neither to be parsed nor, with a hierarchy of its quality, to be built; its hash is checked each time.";

#[derive(Args)]
pub(super) struct Convert {
    /// The scene: .toml, .obj or .eyerays
    scene: PathBuf,
    /// The file to write, .eyerays
    #[arg(value_name = "FILE.eyerays")]
    output: OsString,
    /// Quality of the hierarchy that it holds; renderings of another quality build their own
    #[arg(long, value_name = "QUALITY", value_parser = choice::<Bvh>(), default_value_t = Bvh::default())]
    bvh: Bvh,
    /// Leave the hierarchy out: a third of the bytes, built again by each command
    #[arg(long, conflicts_with = "bvh")]
    no_bvh: bool,
}

impl Convert {
    pub fn run(&self, quiet: bool) -> Result<ExitCode> {
        let path = Path::new(&self.output);
        if !path.extension().is_some_and(|end| end.eq_ignore_ascii_case(scene::ENDING)) {
            let ending = scene::ENDING;
            return Err(Error::file(path, format!("the ending chooses the form; end the name in .{ending}")));
        }
        let destination = Destination::File(path.to_owned());
        output::check_writable(&destination)?;
        let Read { scene, .. } = Read::scene(&self.scene, std::slice::from_ref(&destination), quiet)?;
        output::check_apart(std::slice::from_ref(&destination), [&self.scene])?;
        let build = || device_scene::hierarchy(&scene, self.bvh.quality()).map_err(|e| e.of(&self.scene));
        let bvh = if self.no_bvh { None } else { Some(progress::stage("building", quiet, build)?) };
        let hierarchy = bvh.as_ref().map(|bvh| (self.bvh, bvh));
        let write = || output::write_atomically(path, |out| Ok(scene::write(&scene, hierarchy, out)?));
        progress::stage("writing", quiet, write)?;
        if !quiet {
            let bytes = std::fs::metadata(path).map_or(0, |file| file.len());
            console::say(format_args!(
                "{}: {}, {bytes} bytes",
                path.display(),
                plural(scene.primitives(), "primitive")
            ));
        }
        Ok(ExitCode::SUCCESS)
    }
}
