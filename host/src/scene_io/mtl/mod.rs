//! Wavefront material files, mapped to the thesis' illumination model.
//!
//! | MTL | material |
//! |---|---|
//! | `Kd`, `Ks`, `Ns` | diffuse, specular, shininess |
//! | `Ka` | nothing: exporters write white for every material, and ambient light answers to `Kd` |
//! | `illum` 0, 1 | no highlight, whatever `Ks` says |
//! | `illum` 3, 5 | a mirror: reflection is `Ks` |
//! | `d` below 1, or `illum` 6, 7, or `illum` 4, 9 with `Ni` above 1 | glass |
//! | `Ni` | index of refraction; where absent 1.5 for `illum` 4, 6, 7, 9 and else 1, which does not bend |
//! | `Pr`, `Pm` | roughness and metalness of what is no glass, which is then of microfacets, with `Kd` as its base |
//! | `Pc`, `Pcr`, `Ps` | weight and roughness of a coat, and the colour of sheen, likewise; 0 is none |
//! | `map_Kd` | texture of the base and diffuse colour, times `Kd`; white where that is absent or black |
//! | `map_Ke` | texture of the emission, times `Ke`; white where that is absent or black |
//! | `Ke` alone | emission under paths; nothing under Whitted's model, which draws nothing that emits |
//! | `map_d` | blended opacity, times `d`, which then makes no glass: the picture's alpha, or its red without |
//! | `norm` | texture of normals, whose slopes `-bm` multiplies |
//! | `bump`, `map_Bump` | the same if its colours are those of normals, as Blender writes it; else heights by its first channel, where white is `-bm` world units above black |
//! | `map_Pr`, `map_Pm` | texture of roughness (green) and metalness (blue), where both name the same picture |
//! | `map_Pc`, `map_Pcr` | texture of the coat's weight (red) and of its roughness (green), times `Pc` and `Pcr`; 1 where those are absent or 0 |
//! | other pictures | nothing |
//!
//! Glass passes the share 1 - `d` of the light (all of it where `d` is 1 or absent), coloured by
//! `Tf`, or where that is absent by the hue of `Kd` (its brightest channel passes in full). `Kd` is
//! scaled by the share that does not pass. `Tr` is 1 - `d`, but for `Tr 1` without `d`, which much is written with that is
//! opaque. `illum` 4 alone does not make
//! glass, since exporters write it for everything.
//!
//! Of the options of pictures `-s`, `-o`, `-clamp` and `-bm` count. Their files lie in the material file's folder or below it: see [`Neighbours`].
//!
//! Files are read here and not by tobj, which panics on `Kd 1 0`.

mod bump;
mod picture;
mod statements;

use std::borrow::Cow;
use std::path::Path;

use glam::Vec3;

use self::picture::{Picture, Pictures, Statement, UNUSED};
use self::statements::Statements;
use super::Warning;
use super::WarningKind::{Changed, Idle, LeftOut, Missing};
use super::file;
use super::lines::{self, Lines, NOT_UTF8};
use super::map::Images;
use super::material::Fields;
use super::neighbours::Neighbours;
use super::tally::Tally;
use crate::error::{Error, Result};
use crate::scene::{Integrator, Material, Unplaced};

/// The materials of a file in its order, by name, and what of it was ignored or clamped.
#[derive(Debug, Default)]
pub struct Library {
    pub materials: Vec<(String, Fields)>,
    pub warnings: Vec<Warning>,
}

/// Reads a material file and its pictures.
///
/// # Errors
/// A file that cannot be read. A line that makes no sense is left out with a warning, finite numbers out of range are clamped
/// with one, since many exporters write them, and without a picture that is missing or damaged a surface is drawn.
pub fn load(path: &Path, images: &mut Images) -> Result<Library> {
    let bytes = file::read(path, file::MOST_TEXT).map_err(|fault| Error::file(path, fault))?;
    parse(path, &bytes, images)
}

/// The materials of a text.
pub(super) fn parse(path: &Path, bytes: &[u8], images: &mut Images) -> Result<Library> {
    images
        .room
        .check_bytes(memory(bytes))
        .map_err(|why| Error::file(path, format!("its materials may {why}; remove those that no surface has")))?;
    let mut lines = Lines::new(path, bytes);
    let mut reader = Reader::new(path, images.loading.allow_outside);
    while let Some((number, line)) = lines.advance()? {
        reader.line = number;
        reader.read(line);
    }
    Ok(reader.finish(images))
}

/// What the materials of a text take of memory at most, in bytes: what is read of each, what its fields are, and what it is in
/// a scene, in lists that double as they grow.
fn memory(bytes: &[u8]) -> u64 {
    const EACH: usize = 2 * (size_of::<(String, New)>() + size_of::<(String, Fields)>() + size_of::<Material>());
    const WORD: &[u8] = b"newmtl";
    let starts = bytes.split(|&byte| byte == b'\n' || byte == b'\r').map(<[u8]>::trim_ascii_start);
    starts.filter(|line| line.starts_with(WORD)).count() as u64 * EACH as u64
}

/// What a `newmtl` says.
#[derive(Default)]
struct New {
    numbers: Statements,
    pictures: Pictures,
}

struct Reader<'p> {
    path: &'p Path,
    neighbours: Neighbours,
    line: usize,
    materials: Vec<(String, New)>,
    /// Pictures that there is no use for, that are not there, and that are of another format.
    unused: Tally,
    missing: Tally,
    foreign: Tally,
    clamped: Tally,
    /// Lines that make no sense.
    bad: Tally,
    nameless: Tally,
    latin: Tally,
}

impl<'p> Reader<'p> {
    fn new(path: &'p Path, allow_outside: bool) -> Self {
        let neighbours = Neighbours::new(path, allow_outside);
        let [unused, missing, foreign, clamped, bad, nameless, latin] = std::array::from_fn(|_| Tally::default());
        Reader {
            path,
            neighbours,
            line: 0,
            materials: Vec::new(),
            unused,
            missing,
            foreign,
            clamped,
            bad,
            nameless,
            latin,
        }
    }

    fn read(&mut self, line: &[u8]) {
        let text = lines::text(line);
        if let Cow::Owned(_) = text {
            self.latin.add(self.line, "line");
        }
        if let Some((key, rest)) = lines::split(&text)
            && let Err(fault) = self.follow(key, rest)
        {
            self.bad.add(self.line, format_args!("{key} ({fault})"));
        }
    }

    fn follow(&mut self, key: &str, rest: &str) -> Unplaced<()> {
        match key {
            "newmtl" => {
                if rest.is_empty() {
                    self.nameless.add(self.line, key);
                }
                let new = (rest.to_owned(), New::default());
                self.materials.push(new);
                Ok(())
            }
            "Kd" | "Ks" | "Ke" | "Tf" | "Ns" | "Ni" | "d" | "Tr" | "Pr" | "Pm" | "Pc" | "Pcr" | "Ps" | "illum" => {
                let mut now = self.latest(key)?.numbers;
                self.statement(&mut now, key, rest)?;
                self.latest(key)?.numbers = now;
                Ok(())
            }
            "map_Kd" | "map_Ke" | "map_d" | "norm" | "bump" | "map_Bump" | "map_bump" | "map_Pr" | "map_Pm"
            | "map_Pc" | "map_Pcr" => {
                let picture = self.picture(key, rest)?;
                let pictures = &mut self.latest(key)?.pictures;
                let of = match key {
                    "map_Kd" => &mut pictures.base,
                    "map_Ke" => &mut pictures.emission,
                    "map_d" => &mut pictures.opacity,
                    "norm" => &mut pictures.normal,
                    "bump" | "map_Bump" | "map_bump" => &mut pictures.bump,
                    "map_Pr" => &mut pictures.roughness,
                    "map_Pc" => &mut pictures.coat,
                    "map_Pcr" => &mut pictures.coat_roughness,
                    _ => &mut pictures.metallic,
                };
                *of = picture;
                Ok(())
            }
            "disp" | "decal" | "refl" => {
                self.unused.add(self.line, key);
                Ok(())
            }
            _ if key.starts_with("map_") => {
                self.unused.add(self.line, key);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The material that a statement is of.
    fn latest(&mut self, key: &str) -> Unplaced<&mut New> {
        let latest = self.materials.last_mut().map(|(_, new)| new);
        latest.ok_or_else(|| format!("{key} comes before newmtl; name the material first"))
    }

    fn statement(&mut self, now: &mut Statements, key: &str, rest: &str) -> Unplaced<()> {
        match key {
            "Kd" => now.kd = Some(self.colour(key, rest)?),
            "Ks" => now.ks = Some(self.colour(key, rest)?),
            "Ke" => now.ke = Some((self.light(key, rest)?, self.line)),
            "Tf" => now.tf = Some(self.colour(key, rest)?),
            "Ns" => now.ns = Some(self.number(key, rest, 0.0, f32::MAX)?),
            "Ni" => now.ni = Some(self.number(key, rest, 1.0, 4.0)?),
            "d" => now.d = Some(self.number(key, without_halo(rest), 0.0, 1.0)?),
            "Pr" => now.pr = Some(self.number(key, rest, 0.0, 1.0)?),
            "Pm" => now.pm = Some(self.number(key, rest, 0.0, 1.0)?),
            "Pc" => now.pc = Some(self.number(key, rest, 0.0, 1.0)?),
            "Pcr" => now.pcr = Some(self.number(key, rest, 0.0, 1.0)?),
            "Ps" => now.ps = Some(self.colour(key, rest)?),
            "Tr" => now.tr = Some((self.number(key, rest, 0.0, 1.0)?, self.line)),
            _ => {
                let model = lines::words(rest).next().and_then(|word| word.parse().ok());
                now.illum = model.filter(|&model| model <= 10);
                if now.illum.is_none() {
                    return Err(format!("illum takes a number from 0 to 10, not {rest:?}"));
                }
            }
        }
        Ok(())
    }

    fn colour(&mut self, key: &str, rest: &str) -> Unplaced<Vec3> {
        self.clamped(key, rest, Vec3::ONE)
    }

    fn light(&mut self, key: &str, rest: &str) -> Unplaced<Vec3> {
        self.clamped(key, rest, Vec3::MAX)
    }

    /// One number stands for three equal ones, as the format has it.
    fn clamped(&mut self, key: &str, rest: &str, most: Vec3) -> Unplaced<Vec3> {
        let colour = match numbers(key, rest)?[..] {
            [grey] => Vec3::splat(grey),
            [r, g, b] => Vec3::new(r, g, b),
            ref all => return Err(format!("{key} takes three numbers, not {}", all.len())),
        };
        let clamped = colour.clamp(Vec3::ZERO, most);
        if colour != clamped {
            self.clamped.add(self.line, key);
        }
        Ok(clamped)
    }

    fn number(&mut self, key: &str, rest: &str, least: f32, most: f32) -> Unplaced<f32> {
        let [number] = numbers(key, rest)?[..] else {
            return Err(format!("{key} takes one number, not {rest:?}"));
        };
        let clamped = number.clamp(least, most);
        if number != clamped {
            self.clamped.add(self.line, key);
        }
        Ok(clamped)
    }

    /// The picture of a statement, if there is one that can be read.
    fn picture(&mut self, key: &str, rest: &str) -> Unplaced<Option<Picture>> {
        let Statement { name, placement, strength } = Statement::parse(rest)?;
        let what = format_args!("{key} {name:?}");
        let Some(path) = self.neighbours.find(name) else {
            self.missing.add(self.line, what);
            return Ok(None);
        };
        if !picture::is_known(&path) {
            self.foreign.add(self.line, what);
        } else {
            return Ok(Some(Picture { path, placement, strength, line: self.line }));
        }
        Ok(None)
    }

    fn finish(self, images: &mut Images) -> Library {
        let path = self.path;
        let mut said = picture::Said::default();
        let (mut unlit, mut opaque) = (Tally::default(), Tally::default());
        let shines = images.loading.integrator == Some(Integrator::Path);
        let mut materials = Vec::with_capacity(self.materials.len());
        for (name, New { mut numbers, mut pictures }) in self.materials {
            if let Some(line) = numbers.take_transparency() {
                opaque.add(line, "Tr 1");
            }
            let has_coat = numbers.pc.is_some_and(|weight| weight > 0.0);
            let relief = pictures.bump.take();
            let (mut maps, alpha) = pictures.maps(has_coat, images, &mut said);
            let bump = relief.and_then(|relief| relief.bump(&mut maps, images, path, &mut said));
            if let Some(line) = numbers.unlit(&maps).filter(|_| !shines) {
                unlit.add(line, "Ke");
            }
            materials.push((name, Fields { bump, ..numbers.fields(maps, alpha, shines) }));
        }
        let warnings = [
            self.latin.warn(Changed, path, NOT_UTF8),
            self.nameless.warn(Changed, path, "without a name: usemtl without a name means it"),
            self.bad.warn(LeftOut, path, "left out"),
            self.missing.warn(Missing, path, MISSING),
            self.foreign.warn(LeftOut, path, picture::FOREIGN),
            said.beside.warn(Idle, path, "ignored: the material has normals by norm, too, which count; remove one"),
            said.damaged.warn(Missing, path, "left out: surfaces are drawn without"),
            self.unused.warn(LeftOut, path, UNUSED),
            said.apart.warn(LeftOut, path, "ignored: roughness and metalness are read of one picture that both name"),
            unlit.warn(Idle, path, "ignored: add --integrator path, or give the material an emission in a scene file"),
            opaque.warn(
                Changed,
                path,
                "without d taken for opaque, as many exporters mean it; write d 0 for what is not there",
            ),
            self.clamped.warn(Changed, path, "out of range: the nearest value is used"),
        ];
        Library { materials, warnings: warnings.into_iter().flatten().collect() }
    }
}

/// What is said of pictures that are not there.
const MISSING: &str = "not found: surfaces are drawn without. Only this folder and those below are looked through, \
    unless --allow-outside is given";

fn numbers(key: &str, rest: &str) -> Unplaced<Vec<f32>> {
    lines::words(rest).map(|word| lines::number(key, word)).collect()
}

/// `d -halo 0.5` would fade glass towards its rim; the number counts all the same.
fn without_halo(rest: &str) -> &str {
    rest.strip_prefix("-halo").map_or(rest, str::trim_start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene_io::Loading;
    use crate::scene_io::tests::budget;

    #[test]
    fn materials_that_there_is_no_memory_for_are_refused_before_they_are_read() {
        let text = "newmtl a\n".repeat(1000);
        let within = |bytes| {
            parse(
                Path::new("a.mtl"),
                text.as_bytes(),
                &mut Images::within(Path::new(""), budget(bytes), Loading::default()),
            )
        };
        let refused = within(100_000).unwrap_err().to_string();
        assert!(refused.starts_with("a.mtl: its materials may take about ") && refused.contains("0 MB"), "{refused}");
        assert_eq!(within(1 << 30).unwrap().materials.len(), 1000);
    }
}
