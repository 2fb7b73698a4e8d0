//! What a scene pays for on a GPU: the kernels that run, and the memory that they read and write.

use eyerays_passes::Kernel;
use eyerays_shader::launch::binding;
use serde::Serialize;

use super::buffers::{self, Room};
use super::plan::Plan;
use super::recipe::Recipe;
use super::scene::SceneRecords;
use crate::error::Result;
use crate::method::{Processor, Traversal};
use crate::pack::Packed;

/// The cost of a scene, which an effect that it does not have adds nothing to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    /// In the order of their first launches.
    pub kernels: Vec<KernelCost>,
    /// What is uploaded once, and its bytes.
    pub scene: Vec<(&'static str, u64)>,
    /// What each ray in flight takes of the memory that kernels exchange, in bytes.
    pub ray: Vec<(&'static str, u64)>,
}

/// The cost of a kernel.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct KernelCost {
    /// The name of its entry point.
    pub name: String,
    /// Does it run in every wave but the first, for reflected and refracted rays?
    pub further: bool,
    /// Its instructions, once what the scene decides is folded.
    pub instructions: usize,
    /// The buffers that it reads and writes.
    pub buffers: Vec<&'static str>,
}

impl Cost {
    /// Of a scene in the exact or the fast precision, on a GPU with subgroups.
    ///
    /// # Errors
    /// None today: every method runs on such a GPU.
    pub fn of(packed: &Packed, exact: bool, traversal: Traversal) -> Result<Cost> {
        let plan = Plan::new(packed, exact, &traversal, |coherence| Ok(traversal.resolved(Processor::Gpu, coherence)))?;
        let kernels = |recipes: &[Recipe], further| -> Vec<KernelCost> {
            recipes.iter().map(|recipe| kernel(recipe, &recipe.cut(), further)).collect()
        };
        let records = SceneRecords::new(packed, traversal.layout, plan.hierarchies());
        let named = |(binding, bytes)| (buffers::name(binding), bytes);
        let used = |(_, bytes): &(&str, u64)| *bytes > 0;
        let Room { paths, hits, shadows, film, queue } = Room::of(packed, 1, 1);
        let ray = [
            (binding::PATHS, paths),
            (binding::HITS, hits),
            (binding::SHADOWS, shadows),
            (binding::FILM, film),
            (binding::QUEUE, queue),
            (binding::NEXT, queue),
        ];
        Ok(Cost {
            kernels: [kernels(&plan.first, false), kernels(&plan.further, true)].concat(),
            scene: records
                .bytes()
                .map(|(binding, bytes)| named((binding, bytes.len() as u64)))
                .into_iter()
                .filter(used)
                .collect(),
            ray: ray.map(named).into_iter().filter(used).collect(),
        })
    }
}

fn kernel(recipe: &Recipe, kernel: &Kernel, further: bool) -> KernelCost {
    KernelCost {
        name: recipe.name.clone(),
        further,
        instructions: kernel.instructions(),
        buffers: kernel.bindings().into_iter().map(buffers::name).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{self, Scene};
    use eyerays_bvh::Quality;

    fn shipped(name: &str) -> Scene {
        let path = format!("{}/../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        scene::load(path.as_ref()).unwrap().0
    }

    fn cost(scene: &Scene) -> Cost {
        let packed = Packed::new(scene, &scene.cameras[0], scene.settings, Quality::Fast).unwrap();
        Cost::of(&packed, true, Traversal::default()).unwrap()
    }

    fn names(cost: &Cost) -> Vec<&str> {
        cost.kernels.iter().map(|kernel| kernel.name.as_str()).collect()
    }

    fn used<'a>(buffers: &'a [(&'static str, u64)]) -> Vec<&'a str> {
        buffers.iter().map(|&(name, _)| name).collect()
    }

    const FIRST: [&str; 3] = ["exact_trace_while_while", "exact_shadow_if_if", "exact_shade"];
    const FURTHER: [&str; 4] = ["exact_advance", "exact_trace_while_while", "exact_shadow_while_while", "exact_shade"];

    /// All of them have lights, smooth normals, and glass or mirrors that send rays on.
    #[test]
    fn every_shipped_scene_has_exactly_these_kernels_and_buffers() {
        let all = ["hierarchy", "triangles", "normals", "materials", "lights"];
        let waves = ["paths", "hits", "shadows", "film", "queue", "next queue"];
        for name in ["cornell", "whitted", "glass", "lights"] {
            let cost = cost(&shipped(name));
            assert_eq!(names(&cost), [&FIRST[..], &FURTHER].concat(), "{name}");
            let scene: Vec<_> = used(&cost.scene).into_iter().filter(|&name| name != "bounds").collect();
            assert_eq!((scene, used(&cost.ray)), (all.to_vec(), waves.to_vec()), "{name}");
        }
    }

    /// Law: an effect that nothing asks for costs no dispatch, no buffer and no instruction.
    #[test]
    fn what_a_scene_does_not_have_costs_nothing() {
        let mut scene = shipped("whitted");
        let whole = cost(&scene);
        scene.settings.bounces = 0;
        for material in &mut scene.materials {
            material.reflection = glam::Vec3::ZERO;
            material.transmission = glam::Vec3::ZERO;
        }
        let primary = cost(&scene);
        assert_eq!(names(&primary), FIRST);
        assert_eq!(used(&primary.ray), ["hits", "shadows", "film"]);
        let shade = |cost: &Cost| cost.kernels.iter().find(|kernel| kernel.name == "exact_shade").unwrap().clone();
        assert!(shade(&primary).instructions < shade(&whole).instructions);
        assert!(shade(&whole).buffers.contains(&"paths") && !shade(&primary).buffers.contains(&"paths"));
        scene.mesh.normals.clear();
        let flat = cost(&scene);
        assert!(!used(&flat.scene).contains(&"normals") && !shade(&flat).buffers.contains(&"normals"));
        assert!(shade(&flat).instructions < shade(&primary).instructions);
        scene.lights.clear();
        let dark = cost(&scene);
        assert_eq!(names(&dark), ["exact_trace_while_while", "exact_shade"]);
        assert_eq!((used(&dark.ray), used(&dark.scene).contains(&"lights")), (vec!["hits", "film"], false));
    }
}
