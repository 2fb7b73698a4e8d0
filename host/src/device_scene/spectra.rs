//! The spectra that things of a scene have of their own: rows of the table that kernels read where light has wavelengths.

use std::sync::OnceLock;

use eyerays_shader::data::{SpectrumRow, Waves};
use glam::UVec4;

use crate::error::{Error, Result};
use crate::scene::{Physical, Scene};
use crate::spectrum::{self, Glass, Illuminant, Metal};

/// A row of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Row {
    /// How a glass bends light.
    Bends(Glass),
    /// The refractive part of a metal's index.
    Eta(Metal),
    /// The absorbing part.
    K(Metal),
    /// Light of a lamp, as a share of what its colour in red, green and blue has.
    Light(Illuminant),
}

impl Row {
    fn curve(self) -> Box<dyn Fn(f64) -> f64> {
        match self {
            Row::Bends(glass) => Box::new(move |wavelength| glass.bends(wavelength)),
            Row::Eta(metal) => Box::new(move |wavelength| metal.index(wavelength).0),
            Row::K(metal) => Box::new(move |wavelength| metal.index(wavelength).1),
            Row::Light(illuminant) => Box::new(illuminant.over_colour()),
        }
    }
}

/// The rows of a scene.
#[derive(Default)]
pub struct Spectra {
    rows: Vec<Row>,
    /// Made where it is asked for: most pictures have no wavelengths.
    words: OnceLock<Vec<UVec4>>,
}

impl Spectra {
    /// Those that a scene's materials and lights ask for.
    ///
    /// # Errors
    /// They are more than records can tell.
    pub fn of(scene: &Scene) -> Result<Spectra> {
        let of_material = |physical: Physical| {
            let metal = physical.conductor.and_then(|conductor| conductor.metal);
            let index = metal.into_iter().flat_map(|metal| [Row::Eta(metal), Row::K(metal)]);
            physical.glass.map(Row::Bends).into_iter().chain(index)
        };
        let materials = scene.materials.iter().filter_map(|material| material.physical).flat_map(of_material);
        let lights = scene.lights.iter().filter_map(|light| light.illuminant());
        let emissions = scene.materials.iter().filter_map(|material| material.illuminant);
        let most = (SpectrumRow::MOST - SpectrumRow::OWN) as usize;
        let mut rows = Vec::new();
        for row in materials.chain(lights.chain(emissions).map(Row::Light)) {
            if rows.contains(&row) {
                continue;
            }
            // At once, before a hundred thousand are compared with each other.
            if rows.len() == most {
                return Err(Error::new(format!(
                    "glasses, metals and lamps need more than {most} spectra: let some share theirs"
                )));
            }
            rows.push(row);
        }
        Ok(Spectra { rows, words: OnceLock::new() })
    }

    /// What kernels are compiled for where light has wavelengths.
    pub fn waves(&self) -> Waves {
        let has_light = self.rows.iter().any(|row| matches!(row, Row::Light(_)));
        let is_measured = self.rows.iter().any(|row| !matches!(row, Row::Light(_)));
        let bit = |bit, holds: bool| if holds { bit } else { 0 };
        Waves(bit(Waves::ILLUMINANTS, has_light) | bit(Waves::MEASURED, is_measured))
    }

    /// The whole table.
    pub fn words(&self) -> &[UVec4] {
        self.words.get_or_init(|| {
            let curves: Vec<_> = self.rows.iter().map(|row| row.curve()).collect();
            spectrum::words(&curves.iter().map(|curve| &**curve).collect::<Vec<_>>())
        })
    }

    /// The number of a row, as records have it; 0 for none.
    fn number(&self, row: Option<Row>) -> u32 {
        let place = row.and_then(|row| self.rows.iter().position(|own| *own == row));
        place.map_or(0, |place| SpectrumRow::OWN + place as u32)
    }

    /// That of how a glass bends light.
    pub fn glass(&self, glass: Option<Glass>) -> u32 {
        self.number(glass.map(Row::Bends))
    }

    /// That of the refractive part of a metal, which that of its absorbing part follows.
    pub fn metal(&self, metal: Option<Metal>) -> u32 {
        self.number(metal.map(Row::Eta))
    }

    /// That of a lamp's light.
    pub fn light(&self, illuminant: Option<Illuminant>) -> u32 {
        self.number(illuminant.map(Row::Light))
    }
}
