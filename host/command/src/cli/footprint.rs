//! What a scene takes of the host's memory, stage by stage.

use std::collections::BTreeMap;
use std::fmt;

use eyerays::job::Job;
use eyerays::memory;
use eyerays::scene::Scene;
use eyerays_bvh::Reference;
use serde_json::{Value, json};

/// Bytes of every stage.
pub(super) struct Footprint {
    primitives: u64,
    stages: Vec<(&'static str, u64)>,
    peak: Option<u64>,
}

impl Footprint {
    /// That of a scene and what was made of it.
    pub fn of(scene: &Scene, packed: &Job) -> Self {
        let references = packed.statistics().references * size_of::<Reference>();
        let mut stages = vec![("the scene as read", scene.bytes()), ("references while building", references)];
        stages.extend(packed.bytes());
        let stages = stages.into_iter().map(|(stage, bytes)| (stage, bytes as u64)).collect();
        Footprint { primitives: scene.primitives(), stages, peak: memory::peak() }
    }

    pub fn json(&self) -> Value {
        json!({ "bytes": self.stages.iter().copied().collect::<BTreeMap<_, _>>(), "peak_bytes": self.peak })
    }
}

impl fmt::Display for Footprint {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(out, "memory of the host                            bytes  a primitive")?;
        let used = self.stages.iter().copied().filter(|(_, bytes)| *bytes > 0);
        for (stage, bytes) in used.chain(self.peak.map(|bytes| ("most of this process at once", bytes))) {
            writeln!(out, "{stage:<35} {bytes:>15} {:>12.1}", bytes as f64 / self.primitives.max(1) as f64)?;
        }
        Ok(())
    }
}
