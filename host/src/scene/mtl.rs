//! Wavefront material files, mapped to the thesis' illumination model.
//!
//! | MTL | material |
//! |---|---|
//! | `Kd`, `Ks`, `Ns` | diffuse, specular, shininess |
//! | `Ka` | ambient; as diffuse where absent |
//! | `illum` 0, 1 | no highlight, whatever `Ks` says |
//! | `illum` 3, 5 | a mirror: reflection is `Ks` |
//! | `d` below 1, or `illum` 6, 7, or `illum` 4, 9 with `Ni` above 1 | glass |
//! | `Ni` | index of refraction; where absent 1.5 for `illum` 4, 6, 7, 9 and else 1, which does not bend |
//!
//! Glass passes the share 1 - `d` of the light (all of it where `d` is 1 or absent), coloured by
//! `Tf`, or where that is absent by the hue of `Kd` (its brightest channel passes in full). `Kd` and
//! `Ka` are scaled by the share that does not pass. `Tr` is 1 - `d`. `illum` 4 alone does not make
//! glass, since exporters write it for everything.
//!
//! Files are read here and not by tobj, which panics on `Kd 1 0`.

use std::borrow::Cow;
use std::path::Path;

use glam::Vec3;

use super::lines::{self, Lines, NOT_UTF8};
use super::material::Fields;
use super::tally::Tally;
use super::{Unplaced, file};
use crate::error::{Error, Result};

/// The materials of a file in its order, by name, and what of it was ignored or clamped.
#[derive(Debug, Default)]
pub struct Library {
    pub materials: Vec<(String, Fields)>,
    pub warnings: Vec<String>,
}

/// Reads a material file.
///
/// # Errors
/// A file that cannot be read, or a line that says nothing sensible. Finite numbers out of range
/// are clamped with a warning, since many exporters write them.
pub fn load(path: &Path) -> Result<Library> {
    let bytes = file::read(path, file::MOST_TEXT).map_err(|fault| Error::file(path, fault))?;
    parse(path, &bytes)
}

/// The materials of a text.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Library> {
    let mut lines = Lines::new(path, bytes);
    let mut reader = Reader::default();
    while let Some((number, line)) = lines.advance()? {
        reader.line = number;
        reader.read(line).map_err(|fault| Error::line(path, number, fault))?;
    }
    Ok(reader.finish(path))
}

#[derive(Default)]
struct Reader {
    line: usize,
    materials: Vec<(String, Statements)>,
    ignored: Tally,
    clamped: Tally,
    nameless: Tally,
    latin: Tally,
}

impl Reader {
    fn read(&mut self, line: &[u8]) -> Unplaced<()> {
        let text = lines::text(line);
        if let Cow::Owned(_) = text {
            self.latin.add(self.line, "line");
        }
        let Some((key, rest)) = lines::split(&text) else {
            return Ok(());
        };
        match key {
            "newmtl" => {
                if rest.is_empty() {
                    self.nameless.add(self.line, key);
                }
                let new = (rest.to_owned(), Statements::default());
                self.materials.push(new);
                Ok(())
            }
            "bump" | "disp" | "decal" | "refl" | "norm" => self.texture(key, rest),
            _ if key.starts_with("map_") => self.texture(key, rest),
            "Ka" | "Kd" | "Ks" | "Tf" | "Ns" | "Ni" | "d" | "Tr" | "illum" => {
                let Some((name, mut now)) = self.materials.pop() else {
                    return Err(format!("{key} comes before newmtl; name the material first"));
                };
                self.statement(&mut now, key, rest)?;
                self.materials.push((name, now));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn statement(&mut self, now: &mut Statements, key: &str, rest: &str) -> Unplaced<()> {
        match key {
            "Ka" => now.ka = Some(self.colour(key, rest)?),
            "Kd" => now.kd = Some(self.colour(key, rest)?),
            "Ks" => now.ks = Some(self.colour(key, rest)?),
            "Tf" => now.tf = Some(self.colour(key, rest)?),
            "Ns" => now.ns = Some(self.number(key, rest, 0.0, f32::MAX)?),
            "Ni" => now.ni = Some(self.number(key, rest, 1.0, 4.0)?),
            "d" => now.d = Some(self.number(key, without_halo(rest), 0.0, 1.0)?),
            "Tr" => now.d = now.d.or(Some(1.0 - self.number(key, rest, 0.0, 1.0)?)),
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

    /// One number stands for three equal ones, as the format has it.
    fn colour(&mut self, key: &str, rest: &str) -> Unplaced<Vec3> {
        let colour = match numbers(key, rest)?[..] {
            [grey] => Vec3::splat(grey),
            [r, g, b] => Vec3::new(r, g, b),
            ref all => return Err(format!("{key} takes three numbers, not {}", all.len())),
        };
        let clamped = colour.clamp(Vec3::ZERO, Vec3::ONE);
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

    /// A texture is not opened, but a file that points out of its folder is not to be trusted.
    /// Options come before the name, and the name may hold blanks: no word may lead outside.
    fn texture(&mut self, key: &str, rest: &str) -> Unplaced<()> {
        self.ignored.add(self.line, key);
        rest.split_whitespace().try_for_each(|name| file::downward(name).map(drop))
    }

    fn finish(self, path: &Path) -> Library {
        let warnings = [
            self.latin.warn(path, NOT_UTF8),
            self.nameless.warn(path, "without a name: usemtl without a name means it"),
            self.ignored.warn(path, "ignored: no textures are drawn"),
            self.clamped.warn(path, "out of range: the nearest value is used"),
        ];
        let fields = |(name, statements): (String, Statements)| (name, statements.fields());
        Library {
            materials: self.materials.into_iter().map(fields).collect(),
            warnings: warnings.into_iter().flatten().collect(),
        }
    }
}

fn numbers(key: &str, rest: &str) -> Unplaced<Vec<f32>> {
    lines::words(rest).map(|word| lines::number(key, word)).collect()
}

/// `d -halo 0.5` would fade glass towards its rim; the number counts all the same.
fn without_halo(rest: &str) -> &str {
    rest.strip_prefix("-halo").map_or(rest, str::trim_start)
}

/// What one `newmtl` says.
#[derive(Debug, Clone, Copy, Default)]
struct Statements {
    ka: Option<Vec3>,
    kd: Option<Vec3>,
    ks: Option<Vec3>,
    tf: Option<Vec3>,
    ns: Option<f32>,
    ni: Option<f32>,
    d: Option<f32>,
    illum: Option<u8>,
}

impl Statements {
    fn fields(self) -> Fields {
        let surface = Fields {
            ambient: self.ka,
            diffuse: self.kd,
            specular: self.ks.filter(|_| !matches!(self.illum, Some(0 | 1))),
            shininess: self.ns,
            ..Fields::default()
        };
        match (self.passing(), self.illum) {
            (Some(share), _) => self.glass(surface, share),
            (None, Some(3 | 5)) => Fields { reflection: self.ks, ..surface },
            (None, _) => surface,
        }
    }

    /// The share of light that passes, if this is glass.
    fn passing(&self) -> Option<f32> {
        let bends = self.ni.is_some_and(|ni| ni > 1.0);
        let named = match self.illum {
            Some(6 | 7) => true,
            Some(4 | 9) => bends,
            _ => false,
        };
        match self.d {
            Some(d) if d < 1.0 => Some(1.0 - d),
            _ => named.then_some(1.0),
        }
    }

    fn glass(self, surface: Fields, share: f32) -> Fields {
        let kd = self.kd.unwrap_or(Vec3::ZERO);
        let brightest = kd.max_element();
        let hue = if brightest > 0.0 { kd / brightest } else { Vec3::ONE };
        let bending = matches!(self.illum, Some(4 | 6 | 7 | 9));
        Fields {
            ambient: self.ka.map(|ka| ka * (1.0 - share)),
            diffuse: Some(kd * (1.0 - share)),
            transmission: Some(self.tf.unwrap_or(hue) * share),
            ior: Some(self.ni.unwrap_or(if bending { 1.5 } else { 1.0 })),
            ..surface
        }
    }
}
