//! Eyerays itself.

use eyerays::cpu;
use eyerays::device_scene::DeviceScene;
use eyerays::method::Traversal;
use eyerays::stream::{Answers, Question, Stream, StreamRay};
use eyerays_shader::stage::SHADOWED;

use crate::contest::{Found, RayTracer};

/// One of its methods.
pub struct Own<'a> {
    pub name: &'static str,
    pub packed: &'a DeviceScene,
    pub traversal: Traversal,
    pub packet: bool,
}

impl RayTracer for Own<'_> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn is_packet(&self) -> bool {
        self.packet
    }

    fn cast(&self, pool: &rayon::ThreadPool, stream: &Stream, question: Question) -> (f64, Found) {
        let threads = pool.current_num_threads();
        let (answers, time) = cpu::cast(self.packed, self.traversal, threads, stream, question).expect("threads");
        let hit = |t: f32| Found { hits: 1, distance: f64::from(t) };
        let found = match answers {
            Answers::Closest(hits) => {
                let hits = hits.iter().filter(|hit| hit.w != StreamRay::NOWHERE);
                hits.fold(Found::default(), |sum, h| sum + hit(f32::from_bits(h.x)))
            }
            Answers::Occlusion(answers) => {
                answers.iter().filter(|&&a| a == SHADOWED).fold(Found::default(), |sum, _| sum + hit(0.0))
            }
        };
        (time.as_secs_f64(), found)
    }
}
