//! What a scene pays for on a GPU: the kernels that run, and the memory that they read and write.

use eyerays_shader::data::Launch;
use eyerays_shader::resources::RESOURCES;
use serde::Serialize;

use super::recipe::{Recipe, Target};
use super::scene::SceneRecords;
use crate::job::Job;
use crate::method::{Processor, Traversal};
use crate::plan::{Plan, Step};

/// The cost of a scene, which an effect that it does not have adds nothing to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    /// In the order of their first launches.
    pub kernels: Vec<KernelCost>,
    /// What is uploaded once, and its bytes.
    pub scene: Vec<(&'static str, u64)>,
    /// What each sample in flight takes of the memory that kernels exchange, in bytes.
    pub sample: Vec<(&'static str, u64)>,
    /// What each pixel takes of the film, in bytes.
    pub pixel: u64,
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
    pub fn of(packed: &Job, exact: bool, traversal: Traversal) -> Cost {
        let resolve = |coherence| Ok(traversal.resolved(Processor::Gpu, coherence));
        let plan = Plan::new(packed, &traversal, resolve).expect("such a GPU has every method");
        let name = |binding: u32| RESOURCES[binding as usize].name;
        let kernel = |step: &Step| {
            let recipe = Recipe::new(*step, Target { exact, subgroups: true });
            let cut = recipe.cut();
            KernelCost {
                name: recipe.name,
                further: step.spec.launch.has(Launch::SECONDARY),
                instructions: cut.instructions(),
                buffers: cut.bindings().iter().map(|&binding| name(binding)).collect(),
            }
        };
        let records = SceneRecords::new(packed, traversal.layout, (&plan).into());
        let records = records.bytes().map(|(binding, bytes)| (name(binding), bytes.len() as u64));
        Cost {
            kernels: plan.steps().map(kernel).collect(),
            scene: records.into_iter().filter(|(_, bytes)| *bytes > 0).collect(),
            sample: plan.slot_bytes.iter().map(|&(binding, bytes)| (name(binding), bytes)).collect(),
            pixel: plan.film_bytes(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::scene_io;
    use eyerays_bvh::Quality;

    fn shipped(name: &str) -> Scene {
        let path = format!("{}/../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        scene_io::load(path.as_ref()).unwrap().0
    }

    fn cost(scene: &Scene) -> Cost {
        let packed = Job::new(scene, scene.settings, Quality::Fast).unwrap();
        Cost::of(&packed, true, Traversal::default())
    }

    fn names(cost: &Cost) -> Vec<&str> {
        cost.kernels.iter().map(|kernel| kernel.name.as_str()).collect()
    }

    fn used<'a>(buffers: &'a [(&'static str, u64)]) -> Vec<&'a str> {
        buffers.iter().map(|&(name, _)| name).collect()
    }

    const TRACE: &str = "exact::while_while::trace";
    const FIRST: [&str; 3] = [TRACE, "exact::if_if::shadow", "exact::shade"];
    const FURTHER: [&str; 4] = ["exact::advance", TRACE, "exact::while_while::shadow", "exact::shade"];
    const LAST: [&str; 1] = ["exact::gather"];

    /// All of them have lights, and glass or mirrors that send rays on; some are smooth.
    #[test]
    fn every_shipped_scene_has_exactly_these_kernels_and_buffers() {
        let all = |smooth: bool| {
            let of = ["hierarchy", "primitives", "normals", "materials", "lights"];
            of.into_iter().filter(|&name| smooth || name != "normals").collect::<Vec<_>>()
        };
        let waves = ["paths", "hits", "shadows", "sums", "queue", "next queue"];
        for (name, smooth) in [("cornell", false), ("whitted", false), ("glass", true), ("lights", false)] {
            let cost = cost(&shipped(name));
            assert_eq!(names(&cost), [&FIRST[..], &FURTHER, &LAST].concat(), "{name}");
            assert_eq!((used(&cost.scene), used(&cost.sample)), (all(smooth), waves.to_vec()), "{name}");
        }
    }

    /// Law: an effect that nothing asks for costs no dispatch, no buffer and no instruction.
    #[test]
    fn what_a_scene_does_not_have_costs_nothing() {
        let mut scene = shipped("glass");
        let whole = cost(&scene);
        scene.settings.bounces = 0;
        for material in &mut scene.materials {
            material.reflection = glam::Vec3::ZERO;
            material.transmission = glam::Vec3::ZERO;
        }
        let primary = cost(&scene);
        assert_eq!(names(&primary), [TRACE, "exact::if_if::shadow", "exact::shade", "exact::gather"]);
        assert_eq!(used(&primary.sample), ["hits", "shadows", "sums"]);
        let shade = |cost: &Cost| cost.kernels.iter().find(|kernel| kernel.name.ends_with("::shade")).unwrap().clone();
        assert!(shade(&primary).instructions < shade(&whole).instructions);
        assert!(shade(&whole).buffers.contains(&"paths") && !shade(&primary).buffers.contains(&"paths"));
        scene.mesh.normals.clear();
        let flat = cost(&scene);
        assert!(!used(&flat.scene).contains(&"normals") && !shade(&flat).buffers.contains(&"normals"));
        assert!(shade(&flat).instructions < shade(&primary).instructions);
        scene.lights.clear();
        let dark = cost(&scene);
        assert_eq!(names(&dark), [TRACE, "exact::shade", "exact::gather"]);
        assert_eq!((used(&dark.sample), used(&dark.scene).contains(&"lights")), (vec!["hits", "sums"], false));
    }

    /// Whatever a scene asks for, its kernels bind nothing that its plan or its records do not have.
    #[test]
    fn every_kernel_binds_what_there_is() {
        for name in ["cornell", "whitted", "glass", "lights"] {
            let whole = shipped(name);
            let mut dark = whole.clone();
            dark.lights.clear();
            let mut flat = whole.clone();
            flat.mesh.normals.clear();
            let mut unbounced = whole.clone();
            unbounced.settings.bounces = 0;
            for (what, scene) in [("whole", whole), ("dark", dark), ("flat", flat), ("unbounced", unbounced)] {
                let cost = cost(&scene);
                let own = ["frame", "counters", "arguments", "film"];
                let there = [used(&cost.scene), used(&cost.sample), own.to_vec()].concat();
                for kernel in &cost.kernels {
                    let missing = kernel.buffers.iter().find(|buffer| !there.contains(buffer));
                    assert_eq!(missing, None, "{name}, {what}: {}", kernel.name);
                }
                let needless = used(&cost.scene).into_iter().chain(used(&cost.sample));
                let bound = |buffer: &str| cost.kernels.iter().any(|kernel| kernel.buffers.contains(&buffer));
                let needless: Vec<&str> = needless.filter(|buffer| !bound(buffer)).collect();
                assert!(needless.is_empty(), "{name}, {what}: nothing reads {needless:?}");
            }
        }
    }
}
