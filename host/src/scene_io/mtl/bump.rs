//! Pictures that a material file calls bumps: heights, or normals by an old name.

use std::path::Path;

use super::super::bump::{Bump, ReliefMap};
use super::super::map::Images;
use super::picture::{Picture, Said};
use crate::scene::Maps;

/// What it is called in messages, by whichever of its names it comes.
const KEY: &str = "bump";

impl Picture {
    /// Gives a material the normals of this picture if that is what it is of, and else tells its heights, in which `-bm` is what white
    /// is above black. A material that has normals of its own takes neither.
    pub fn bump(&self, maps: &mut Maps, images: &mut Images, file: &Path, said: &mut Said) -> Option<Bump> {
        if maps.normal.is_some() {
            said.beside.add(self.line, KEY);
            return None;
        }
        match images.relief(&self.path, self.placement) {
            Ok(ReliefMap::Normals(normals)) => {
                (maps.normal, maps.normal_scale) = (Some(normals), self.strength);
                None
            }
            Ok(ReliefMap::Heights(slopes)) => Some(Bump::new(slopes, self.strength, (KEY, file, self.line))),
            Err(fault) => {
                said.damaged.add(self.line, fault);
                None
            }
        }
    }
}
