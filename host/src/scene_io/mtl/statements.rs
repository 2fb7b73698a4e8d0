//! What one `newmtl` says, and the material that it makes.

use glam::Vec3;

use super::super::finish::{self, CoatFields, SheenFields};
use super::super::material::Fields;
use super::super::physical;
use crate::scene::{Alpha, FinishMaps, Maps};

/// The numbers of one `newmtl`, by the statements' keys.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Statements {
    pub kd: Option<Vec3>,
    pub ks: Option<Vec3>,
    /// And its line.
    pub ke: Option<(Vec3, usize)>,
    pub tf: Option<Vec3>,
    pub ns: Option<f32>,
    pub ni: Option<f32>,
    pub d: Option<f32>,
    /// 1 - d, and its line.
    pub tr: Option<(f32, usize)>,
    pub pr: Option<f32>,
    pub pm: Option<f32>,
    pub pc: Option<f32>,
    pub pcr: Option<f32>,
    pub ps: Option<Vec3>,
    pub illum: Option<u8>,
}

impl Statements {
    /// The line of light that is sent out without a picture of it.
    pub fn unlit(&self, maps: &Maps) -> Option<usize> {
        self.ke.filter(|&(ke, _)| ke != Vec3::ZERO && maps.emission.is_none()).map(|(_, line)| line)
    }

    /// Takes `Tr` where there is no `d`. Returns the line of one by which nothing would be seen, which is written for opaque.
    pub fn take_transparency(&mut self) -> Option<usize> {
        let (tr, line) = self.tr.filter(|_| self.d.is_none())?;
        if tr < 1.0 {
            self.d = Some(1.0 - tr);
            return None;
        }
        Some(line)
    }

    /// The material, with these maps; does `Ke` shine without a picture of it?
    pub fn fields(mut self, maps: Maps, alpha: Option<Alpha>, shines: bool) -> Fields {
        // A picture on black is none, and exporters write black beside pictures.
        let white = |colour: Option<Vec3>| colour.filter(|&colour| colour != Vec3::ZERO).or(Some(Vec3::ONE));
        if maps.base.is_some() {
            self.kd = white(self.kd);
        }
        let emission = maps.emission.as_ref().and_then(|_| white(self.ke.map(|(ke, _)| ke)));
        let emission = emission.or(self.ke.filter(|(ke, _)| shines && *ke != Vec3::ZERO).map(|(ke, _)| ke));
        let opacity = alpha.and(self.d);
        if alpha.is_some() {
            // What is cut out is no glass.
            self.d = None;
        }
        let physical = self.physical(&maps);
        let surface = Fields {
            diffuse: self.kd,
            specular: self.ks.filter(|_| !matches!(self.illum, Some(0 | 1))),
            shininess: self.ns,
            emission,
            maps,
            alpha,
            opacity,
            ..Fields::default()
        };
        match (self.passing(), self.illum, physical) {
            (Some(share), ..) => self.glass(surface, share),
            (None, Some(3 | 5), None) => Fields { reflection: self.ks, ..surface },
            (None, _, None) => surface,
            // Whitted's model keeps of it what it can.
            (None, _, Some(physical)) => Fields { diffuse: None, physical, ..surface },
        }
    }

    /// What is said of microfacets, if anything is. Exporters write coats and sheen of 0 for everything.
    fn physical(&self, maps: &Maps) -> Option<physical::Fields> {
        let rough = maps.metallic_roughness.as_ref().map(|_| 1.0);
        let (roughness, metallic) = (self.pr.or(rough), self.pm.or(rough));
        let some = |number: Option<f32>| number.filter(|&number| number > 0.0);
        let finish = &maps.finish;
        let has_coat = finish.coat.is_some() || some(self.pc).is_some();
        // A picture is multiplied with 1 where its number is 0, as one of colours is with white.
        let coat_roughness = if finish.coat_roughness.is_some() { some(self.pcr) } else { self.pcr };
        let coat = has_coat.then_some(CoatFields { weight: some(self.pc), roughness: coat_roughness });
        let sheen = self.ps.filter(|&colour| colour != Vec3::ZERO);
        let sheen = sheen.map(|colour| SheenFields { colour: Some(colour), roughness: None });
        if (roughness, metallic, coat, sheen) == (None, None, None, None) {
            return None;
        }
        let finish = finish::Fields { coat, sheen, ..Default::default() };
        Some(physical::Fields { base: self.kd, roughness, metallic, finish, ..Default::default() })
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
            // Coats are of microfacets, which glass has none of here.
            maps: Maps { finish: FinishMaps::default(), ..surface.maps },
            diffuse: Some(kd * (1.0 - share)),
            transmission: Some(self.tf.unwrap_or(hue) * share),
            ior: Some(self.ni.unwrap_or(if bending { 1.5 } else { 1.0 })),
            ..surface
        }
    }
}
