//! What a film keeps of its pixels beside their light.

use super::specialisation::bits;

bits! {
    /// Arbitrary output variables of a film: each three channels of a pixel, linear RGB or a vector.
    Aovs {
        /// The share of white light that the surface sends on which the camera's ray meets.
        ALBEDO = 0;
        /// Its shading normal on the viewer's side, in world axes.
        NORMAL = 1;
        /// What surfaces emit that the camera's ray meets.
        EMISSION = 2;
        /// What of the surroundings it sees.
        ENVIRONMENT = 3;
        /// Both, and light that was scattered once.
        DIRECT = 4;
        /// Light that the diffuse part of the first surface scatters, which no other has scattered before.
        DIFFUSE_DIRECT = 5;
        /// Which others have.
        DIFFUSE_INDIRECT = 6;
        /// Light that the first surface mirrors, likewise.
        GLOSSY_DIRECT = 7;
        /// Likewise.
        GLOSSY_INDIRECT = 8;
        /// Light that comes through the first surface.
        TRANSMISSION_DIRECT = 9;
        /// Likewise.
        TRANSMISSION_INDIRECT = 10;
        /// All light of each group of lamps, and first of those that are in none. They are the last.
        GROUPS = 11;
    }
}

impl Aovs {
    /// What the parts of the first surface scatter.
    pub const LOBES: u32 = Aovs::DIFFUSE_DIRECT
        | Aovs::DIFFUSE_INDIRECT
        | Aovs::GLOSSY_DIRECT
        | Aovs::GLOSSY_INDIRECT
        | Aovs::TRANSMISSION_DIRECT
        | Aovs::TRANSMISSION_INDIRECT;

    /// Is there any?
    #[inline(always)]
    pub fn any(self) -> bool {
        self.0 != 0
    }

    /// How many are before one of them.
    #[inline(always)]
    pub fn place(self, bit: u32) -> u32 {
        (self.0 & (bit - 1)).count_ones()
    }

    /// How many there are in a scene of so many groups.
    pub fn count(self, groups: u32) -> u32 {
        let groups = if self.has(Aovs::GROUPS) { groups } else { 0 };
        self.0.count_ones() + groups
    }
}
