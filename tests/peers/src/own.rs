//! Eyerays itself.

use eyerays::cpu;
use eyerays::job::Job;
use eyerays::method::Traversal;
use eyerays::stream::{Answers, Question, Stream, StreamRay};
use eyerays_shader::stage::SHADOWED;
use glam::UVec4;

use crate::contest::{self, RayTracer};

/// One of its methods.
pub struct Own<'a> {
    pub name: &'static str,
    pub packed: &'a Job,
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

    fn cast(&self, pool: &rayon::ThreadPool, stream: &Stream, question: Question) -> (f64, contest::Answers) {
        let threads = pool.current_num_threads();
        let (answers, time) = cpu::cast(self.packed, self.traversal, threads, stream, question).expect("threads");
        let distance = |hit: &UVec4| if hit.w == StreamRay::NOWHERE { -1.0 } else { f32::from_bits(hit.x) };
        let found = match answers {
            Answers::Closest(hits) => hits.iter().map(distance).collect(),
            Answers::Occlusion(answers) => answers.iter().map(|&a| if a == SHADOWED { 0.0 } else { -1.0 }).collect(),
        };
        (time.as_secs_f64(), found)
    }
}
