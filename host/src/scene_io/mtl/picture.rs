//! Statements of material files that name pictures.

use std::path::{Path, PathBuf};

use super::super::lines;
use super::super::map::Images;
use super::super::tally::Tally;
use crate::scene::{Alpha, Map, Maps, Placement, Unplaced, Wrap};

/// What is said of pictures for which there is no use.
pub(super) const UNUSED: &str = "ignored: pictures are drawn of Kd, Ke, d, norm, bump, Pc, Pcr, and Pr and Pm together";
/// What is said of pictures of other kinds.
pub(super) const FOREIGN: &str =
    "is no .png, .jpg, .tga, .bmp, .tif, .exr or .hdr: surfaces are drawn without; convert it";
/// Endings of names of pictures that are read.
const ENDINGS: [&str; 9] = ["png", "jpg", "jpeg", "exr", "hdr", "tga", "bmp", "tif", "tiff"];

/// A picture that a statement names, and how it takes it.
#[derive(Clone, PartialEq)]
pub(super) struct Picture {
    pub path: PathBuf,
    pub placement: Placement,
    /// What slopes or heights are multiplied with (`-bm`).
    pub strength: f32,
    /// The statement's.
    pub line: usize,
}

/// The pictures of a material, by the statements' keys.
#[derive(Default)]
pub(super) struct Pictures {
    pub base: Option<Picture>,
    pub emission: Option<Picture>,
    pub opacity: Option<Picture>,
    pub normal: Option<Picture>,
    pub bump: Option<Picture>,
    pub roughness: Option<Picture>,
    pub metallic: Option<Picture>,
    pub coat: Option<Picture>,
    pub coat_roughness: Option<Picture>,
}

/// What is said of the pictures of a file.
#[derive(Default)]
pub(super) struct Said {
    /// Maps of roughness and metalness that are not one picture.
    pub apart: Tally,
    /// Pictures that cannot be read.
    pub damaged: Tally,
    /// Heights of what has normals.
    pub beside: Tally,
}

/// What a statement says: its options come before the name, which may hold blanks.
pub(super) struct Statement<'s> {
    pub name: &'s str,
    pub placement: Placement,
    pub strength: f32,
}

impl<'s> Statement<'s> {
    /// Takes a statement's rest apart.
    ///
    /// # Errors
    /// An option without its number, or one that leads out of single precision.
    pub fn parse(rest: &'s str) -> Unplaced<Self> {
        let (mut scale, mut offset) = ([1.0; 2], [0.0; 2]);
        let mut statement = Statement { name: rest.trim(), placement: Placement::default(), strength: 1.0 };
        while let Some((option, after)) = lines::split(statement.name) {
            statement.name = match option {
                "-s" => numbers(option, after, &mut scale)?,
                "-o" => numbers(option, after, &mut offset)?,
                "-t" => numbers(option, after, &mut [0.0; 2])?,
                "-bm" => {
                    let (strength, rest) = number(option, after)?;
                    statement.strength = strength;
                    rest
                }
                "-clamp" => {
                    let (word, rest) = lines::split(after).unwrap_or_default();
                    statement.placement.wrap = [if word == "on" { Wrap::Clamp } else { Wrap::Repeat }; 2];
                    rest
                }
                "-blendu" | "-blendv" | "-boost" | "-cc" | "-imfchan" | "-texres" | "-type" => skip(after, 1),
                "-mm" => skip(after, 2),
                _ => break,
            };
        }
        // The second coordinate is up in a file, down in a mesh.
        let transform = [[scale[0], 0.0, offset[0]], [0.0, scale[1], 1.0 - scale[1] - offset[1]]];
        if !transform.as_flattened().iter().all(|number| number.is_finite()) {
            return Err("-s and -o lead out of single precision; make them smaller".into());
        }
        statement.placement.transform = transform;
        Ok(statement)
    }
}

/// The rest after an option's numbers: one to three, of which those that are left out stay what they are.
fn numbers<'s>(option: &str, rest: &'s str, to: &mut [f32; 2]) -> Unplaced<&'s str> {
    let mut left;
    (to[0], left) = number(option, rest)?;
    // A third one is of textures with depth.
    for place in 1..3 {
        let word = lines::split(left).map_or("", |(word, _)| word);
        if word.parse::<f32>().is_err() {
            break;
        }
        let number;
        (number, left) = self::number(option, left)?;
        if let Some(to) = to.get_mut(place) {
            *to = number;
        }
    }
    Ok(left)
}

/// An option's number, and the rest.
fn number<'s>(option: &str, rest: &'s str) -> Unplaced<(f32, &'s str)> {
    let (word, rest) = lines::split(rest).unwrap_or_default();
    Ok((lines::number(option, word)?, rest))
}

fn skip(rest: &str, words: usize) -> &str {
    (0..words).fold(rest, |rest, _| lines::split(rest).unwrap_or_default().1)
}

/// Does the picture's name end as one of those that are read?
pub(super) fn is_known(path: &Path) -> bool {
    path.extension().is_some_and(|end| ENDINGS.iter().any(|known| end.eq_ignore_ascii_case(known)))
}

impl Pictures {
    /// The maps of them, and the alpha of one whose opacity is its base's; is there a coat without a picture of it?
    pub fn maps(self, has_coat: bool, images: &mut Images, said: &mut Said) -> (Maps, Option<Alpha>) {
        let Said { apart, damaged, .. } = said;
        let mut map = |picture: &Picture| match images.at(&picture.path) {
            Ok(texture) => Some(Map { texture, placement: picture.placement }),
            Err(fault) => {
                damaged.add(picture.line, fault);
                None
            }
        };
        let mut maps = Maps {
            base: self.base.as_ref().and_then(&mut map),
            emission: self.emission.as_ref().and_then(&mut map),
            normal: self.normal.as_ref().and_then(&mut map),
            normal_scale: self.normal.as_ref().map_or(0.0, |normal| normal.strength),
            ..Maps::default()
        };
        maps.finish.coat = self.coat.as_ref().and_then(&mut map);
        // Roughness alone makes no coat.
        let has_coat = has_coat || maps.finish.coat.is_some();
        maps.finish.coat_roughness = self.coat_roughness.as_ref().filter(|_| has_coat).and_then(&mut map);
        let same = |a: &Picture, b: &Picture| (&a.path, a.placement) == (&b.path, b.placement);
        match (&self.roughness, &self.metallic) {
            (Some(roughness), Some(metallic)) if same(roughness, metallic) => {
                maps.metallic_roughness = map(roughness);
            }
            (roughness, metallic) => {
                let keys = [(roughness, "map_Pr"), (metallic, "map_Pm")];
                let mut lines: Vec<_> = keys.iter().filter_map(|(of, key)| Some((of.as_ref()?.line, key))).collect();
                lines.sort_unstable();
                lines.iter().for_each(|(line, key)| apart.add(*line, key));
            }
        }
        let Some(opacity) = &self.opacity else { return (maps, None) };
        let Some(Map { texture, placement }) = map(opacity) else { return (maps, None) };
        if texture.has_opacity() && self.base.is_some_and(|base| same(&base, opacity)) {
            return (maps, Some(Alpha::Blend));
        }
        let texture = images.opacity_of(&opacity.path, &texture);
        maps.opacity = Some(Map { texture, placement });
        (maps, Some(Alpha::Blend))
    }
}
