//! Lamps by groups, whose light films keep apart.

use eyerays_shader::stage::LINKED_GROUPS;

use glam::Vec3;

use super::{Material, Scene, Unplaced};

/// Names of groups of lamps, each once, in the order of the lights, the materials that emit, and the surroundings.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LightGroups(Vec<String>);

impl LightGroups {
    /// The most that a scene may have.
    pub const MOST: usize = 255;
    /// What the light of all lamps without a group is called.
    pub const REST: &str = "rest";

    /// Those of a scene.
    pub fn of(scene: &Scene) -> Self {
        let mut names = Vec::new();
        let lights = scene.lights.iter().map(|light| light.group());
        let shining = scene.materials.iter().filter(|material| material.emission != Vec3::ZERO);
        let materials = shining.map(|material| &material.group[..]);
        for name in lights.chain(materials).chain([&scene.background_group[..]]) {
            // More are refused; a file may have a million.
            if names.len() <= Self::MOST && !name.is_empty() && !names.iter().any(|known| known == name) {
                names.push(name.to_owned());
            }
        }
        LightGroups(names)
    }

    /// Refuses more than there may be, and a group of the name that stands for none.
    pub(super) fn check(&self) -> Unplaced<()> {
        if self.0.len() > Self::MOST {
            return Err(format!("the scene has more than {} groups of lamps; put more of them together", Self::MOST));
        }
        match self.0.iter().find(|name| !Self::can_be(name)) {
            Some(name) => Err(format!("a group of lamps is called {name:?}; {}", Self::RULE)),
            None => Ok(()),
        }
    }

    /// What names may be.
    pub(crate) const RULE: &str = "a name has 1 to 64 characters of Latin-1 that print, no point or comma among them and no space around them, and is not \"rest\", which is that of lamps without one";

    /// May a group be called so? Channels of OpenEXR files are.
    pub fn can_be(name: &str) -> bool {
        let prints = |c: char| matches!(c, ' '..='~' | '\u{a1}'..='\u{ff}') && c != '.' && c != ',';
        (1..=64).contains(&name.chars().count())
            && name.chars().all(prints)
            && name.trim() == name
            && name != Self::REST
    }

    /// Refuses a material that is lit by a group that there is not, and more groups than kernels tell apart where some light is left out.
    pub(super) fn check_lit_by(&self, material: &Material) -> Unplaced<()> {
        let Some(lit_by) = &material.lit_by else { return Ok(()) };
        if self.0.len() >= LINKED_GROUPS as usize {
            let most = LINKED_GROUPS - 1;
            return Err(format!(
                "the scene has {} groups of lamps; where materials have lit_by there are at most {most}",
                self.0.len()
            ));
        }
        match lit_by.iter().find(|name| **name != Self::REST && !self.0.contains(name)) {
            Some(name) => Err(format!(
                "the material {:?} is lit by the group {name:?}, which no lamp is in; there are {}",
                material.name,
                self.0.iter().map(String::as_str).chain([Self::REST]).collect::<Vec<_>>().join(", ")
            )),
            None => Ok(()),
        }
    }

    /// A bit for each group that does not light a material, by its number.
    pub(crate) fn unlit(&self, material: &Material) -> u32 {
        let Some(lit_by) = &material.lit_by else { return 0 };
        let all = [Self::REST].into_iter().chain(self.0.iter().map(String::as_str));
        let unlit = all.enumerate().filter(|(_, name)| !lit_by.iter().any(|own| own == name));
        unlit.map(|(number, _)| 1 << number).sum()
    }

    /// All names.
    pub fn names(&self) -> &[String] {
        &self.0
    }

    /// A group's number from 1, or 0 for the empty name.
    pub fn number(&self, name: &str) -> u32 {
        self.0.iter().zip(1..).find(|(known, _)| *known == name).map_or(0, |(_, number)| number)
    }
}
