//! obvhs' own traversals of its own hierarchies, with its triangle test.

use std::time::Duration;

use eyerays::job::Job;
use eyerays::stream::{Question, Stream};
use eyerays_bvh::Quality;
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;

use crate::contest::{Answers, RayTracer, tasks};
use crate::primitives;

fn triangles(packed: &Job) -> Vec<Triangle> {
    let all = primitives(packed);
    all.iter().map(|t| t.vertices().map(Vec3A::from)).map(|[v0, v1, v2]| Triangle { v0, v1, v2 }).collect()
}

fn parameters(quality: Quality) -> BvhBuildParams {
    match quality {
        Quality::Linear => BvhBuildParams::fastest_build(),
        Quality::Fast => BvhBuildParams::fast_build(),
        Quality::Medium => BvhBuildParams::medium_build(),
        Quality::High => BvhBuildParams::slow_build(),
    }
}

/// Two children a node.
pub struct Binary {
    bvh: Bvh2,
    /// In the order of leaves.
    triangles: Vec<Triangle>,
}

/// Eight compressed children a node.
pub struct Compressed {
    bvh: CwBvh,
    triangles: Vec<Triangle>,
}

impl Binary {
    pub fn new(packed: &Job, quality: Quality) -> Self {
        let all = triangles(packed);
        let bvh = build_bvh2_from_tris(&all, parameters(quality), &mut Duration::default());
        let triangles = bvh.primitive_indices.iter().map(|&i| all[i as usize]).collect();
        Binary { bvh, triangles }
    }
}

impl Compressed {
    pub fn new(packed: &Job, quality: Quality) -> Self {
        let all = triangles(packed);
        let bvh = build_cwbvh_from_tris(&all, parameters(quality), &mut Duration::default());
        let triangles = bvh.primitive_indices.iter().map(|&i| all[i as usize]).collect();
        Compressed { bvh, triangles }
    }
}

/// Both have the same functions without a common trait.
macro_rules! contestant {
    ($type:ident, $name:literal) => {
        impl $type {
            #[inline(always)]
            fn task(&self, stream: &Stream, question: Question, first: usize, answers: &mut [f32]) {
                for (i, answer) in answers.iter_mut().enumerate() {
                    let r = stream.ray(first + i);
                    let ray = Ray::new(r.origin.into(), r.direction.into(), 0.0, r.limit);
                    *answer = match question {
                        Question::Closest => {
                            let mut hit = RayHit::none();
                            let any = self.bvh.ray_traverse(ray, &mut hit, |ray, id| self.triangles[id].intersect(ray));
                            if any { hit.t } else { -1.0 }
                        }
                        Question::Occlusion => {
                            let free = self.bvh.ray_traverse_miss(ray, |ray, id| self.triangles[id].intersect(ray));
                            if free { -1.0 } else { 0.0 }
                        }
                    };
                }
            }

            /// With the instructions that a build for this processor would have.
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt,fma")]
            fn task_avx2(&self, stream: &Stream, question: Question, first: usize, answers: &mut [f32]) {
                self.task(stream, question, first, answers);
            }
        }

        impl RayTracer for $type {
            fn name(&self) -> &'static str {
                $name
            }

            fn cast(&self, pool: &rayon::ThreadPool, stream: &Stream, question: Question) -> (f64, Answers) {
                #[cfg(target_arch = "x86_64")]
                if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
                    return tasks(pool, stream, |first, answers| {
                        // SAFETY: a processor with AVX2 and FMA has the others.
                        unsafe { self.task_avx2(stream, question, first, answers) }
                    });
                }
                tasks(pool, stream, |first, answers| self.task(stream, question, first, answers))
            }
        }
    };
}

contestant!(Binary, "obvhs BVH2");
contestant!(Compressed, "obvhs CWBVH");
