//! All that rays cross.

use std::ops::Range;

use eyerays_shader::stage::Found;

use super::Queries;
use super::surfaces::Surfaces;
use crate::batch::{Batch, Hit, Rays};
use crate::cpu;
use crate::error::Result;
use crate::gpu::Caster;

/// Crossings of many rays, those of a ray one after the other, the nearest first.
pub struct Crossings {
    /// Where those of each ray begin, and how many there are in all.
    starts: Vec<usize>,
    hits: Vec<Hit>,
}

/// Past nothing.
const BEFORE: f32 = -1.0;

impl Crossings {
    /// Asks for the next crossing of each ray until none has any.
    pub(super) fn found(queries: &Queries, range: Range<usize>, rays: &impl Rays) -> Result<Self> {
        let (Queries { surfaces, caster }, count) = (queries, range.len());
        surfaces.threads.install(|| {
            let batch = Batch::of(&surfaces.job, range, rays);
            let passes = match caster {
                Some(caster) => on_gpu(caster, &batch)?,
                None => on_cpu(surfaces, &batch),
            };
            let mut starts = vec![0; count + 1];
            passes.iter().flat_map(|pass| &pass.slots).for_each(|&slot| starts[slot as usize + 1] += 1);
            for slot in 0..count {
                starts[slot + 1] += starts[slot];
            }
            let mut hits = vec![None; starts[count]];
            // A pass has the next of each of its rays.
            for (number, pass) in passes.iter().enumerate() {
                for (&slot, found) in pass.slots.iter().zip(&pass.found) {
                    hits[starts[slot as usize] + number] = surfaces.hit(batch.measure(slot as usize), found);
                }
            }
            Ok(Crossings { starts, hits: hits.into_iter().flatten().collect() })
        })
    }

    /// All of them.
    pub fn hits(&self) -> &[Hit] {
        &self.hits
    }

    /// Those of a ray, the nearest first.
    pub fn of_ray(&self, ray: usize) -> &[Hit] {
        match self.starts.get(ray..ray + 2) {
            Some(&[start, end]) => &self.hits[start..end],
            _ => &[],
        }
    }
}

/// The next crossing of each ray that has one.
#[derive(Clone)]
struct Pass {
    slots: Vec<u32>,
    found: Vec<Found<f32>>,
}

impl Pass {
    /// All rays, before their first.
    fn first(count: usize) -> Pass {
        Pass { slots: (0..count as u32).collect(), found: vec![Found { t: BEFORE, ..Found::nothing() }; count] }
    }

    /// Those rays that have found something.
    fn kept(self) -> Pass {
        let both = self.slots.into_iter().zip(self.found).filter(|(_, found)| !found.is_nothing());
        let (slots, found) = both.unzip();
        Pass { slots, found }
    }
}

fn on_cpu(surfaces: &Surfaces, batch: &Batch) -> Vec<Pass> {
    let next = |slots: &[u32], found: &mut [Found<f32>]| {
        cpu::cross_here(&surfaces.job, batch.stream(), slots, found);
        Ok(())
    };
    passes(batch, next).expect("a CPU does not fail")
}

fn on_gpu(caster: &Caster, batch: &Batch) -> Result<Vec<Pass>> {
    passes(batch, |slots, found| caster.cross(&batch.stream().of(slots), found))
}

/// Pass after pass, until no ray crosses anything more.
fn passes(batch: &Batch, mut next: impl FnMut(&[u32], &mut [Found<f32>]) -> Result<()>) -> Result<Vec<Pass>> {
    let mut passes = Vec::new();
    let mut pass = Pass::first(batch.stream().len());
    while !pass.slots.is_empty() {
        next(&pass.slots, &mut pass.found)?;
        pass = pass.kept();
        passes.extend((!pass.slots.is_empty()).then(|| pass.clone()));
    }
    Ok(passes)
}
