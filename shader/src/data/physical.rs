//! Surfaces by microfacets, as glTF describes them.

use bytemuck::{Pod, Zeroable};
use glam::UVec4;

/// How a surface scatters light by microfacets, bound only where some material is physical. One for each material; that of any
/// other material says so, and its [`Material`](super::Material) is taken.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Physical {
    /// Base colour, linear RGB in [0, 1]; the integer holds the flags.
    pub base: UVec4,
    /// Roughness, metalness and strength of the anisotropy, each in [0, 1]; the integer is the bits of the index of refraction.
    pub shape: UVec4,
    /// What the dielectric part reflects at normal incidence, linear RGB of at least 0, of which at most 1 counts, times the share at
    /// grazing angles, whose bits the integer is.
    pub dielectric: UVec4,
    /// Share of the base that lets light pass, linear RGB; the integer is the bits of one over the distance of `attenuation`, 0
    /// where nothing is absorbed.
    pub transmission: UVec4,
    /// What is left of light that went that far inside, linear RGB; the integer is the row of the spectrum
    /// ([`SpectrumRow`](super::SpectrumRow)) of a conductor's refractive part, which that of its absorbing part follows, or 0.
    pub attenuation: UVec4,
    /// The refractive part of a conductor's complex index, linear RGB; the integer is the bits of the cosine of the angle by which
    /// the axis along which facets are rougher is turned from the tangent.
    pub eta: UVec4,
    /// The absorbing part; the integer is the bits of that angle's sine.
    pub k: UVec4,
}

impl Physical {
    /// The flag of a record that is in use.
    pub const IS_PHYSICAL: u32 = 1;
    /// Reflects by a complex index instead of a base colour.
    pub const CONDUCTOR: u32 = 2;
    /// What passes goes straight on, as through a pane that is thinner than anything else.
    pub const THIN: u32 = 4;
    /// Such a pane has two faces, between which light goes to and fro; else it is one interface.
    pub const TWO_FACES: u32 = 8;

    /// Is this flag set?
    #[inline(always)]
    pub fn has(&self, flag: u32) -> bool {
        self.base.w & flag != 0
    }
}
