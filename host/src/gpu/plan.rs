//! The kernels of a rendering in the order of their launches.

use eyerays_shader::data::Features;

use super::recipe::{Recipe, Step};
use super::scene::Hierarchies;
use crate::error::Result;
use crate::method::{Coherence, Method, Traversal};
use crate::pack::Packed;

/// What the waves of a launch run, one kernel after the other; nothing for an effect that the scene does not have.
pub struct Plan {
    /// For the camera's rays.
    pub first: Vec<Recipe>,
    /// For the rays of each further wave; empty if the scene reflects and refracts none.
    pub further: Vec<Recipe>,
}

impl Plan {
    /// For a scene in the exact or the fast precision. `resolve` tells the method for rays of some coherence.
    ///
    /// # Errors
    /// Those of `resolve`.
    pub fn new(
        packed: &Packed,
        exact: bool,
        traversal: &Traversal,
        resolve: impl Fn(Coherence) -> Result<Traversal>,
    ) -> Result<Self> {
        let wave = |features, traced, shadowed| -> Result<Vec<Recipe>> {
            let mut steps = vec![Recipe::tracing(Step::Trace, features, exact, resolve(traced)?)];
            if !packed.lights.is_empty() {
                steps.push(Recipe::tracing(Step::Shadow, features, exact, resolve(shadowed)?));
            }
            steps.push(Recipe::shading(Step::Shade, features, exact, traversal));
            Ok(steps)
        };
        let first = wave(packed.features, Coherence::Primary, Coherence::Shadow)?;
        let mut further = Vec::new();
        if packed.has_secondary_rays() {
            let features = Features(packed.features.0 | Features::SECONDARY);
            further.push(Recipe::shading(Step::Advance, features, exact, traversal));
            further.extend(wave(features, Coherence::Secondary, Coherence::Secondary)?);
        }
        Ok(Plan { first, further })
    }

    /// Every kernel, in the order of the first launches.
    pub fn recipes(&self) -> impl Iterator<Item = &Recipe> {
        self.first.iter().chain(&self.further)
    }

    /// The hierarchies that its methods walk.
    pub(super) fn hierarchies(&self) -> Hierarchies {
        let methods = || self.recipes().filter_map(|recipe| recipe.method);
        let wide = methods().any(|method| method == Method::Wide);
        Hierarchies { binary: methods().any(|method| method != Method::Wide), wide }
    }
}
