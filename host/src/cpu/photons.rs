//! Photons on a CPU: those of some samples, for all tiles to look through.

use std::ops::Range;

use eyerays_kernels_cpu::{Number, Records};
use eyerays_shader::data::Frame;
use eyerays_shader::photon::{self, Photons, RECORDS};
use glam::UVec4;
use rayon::prelude::*;

use super::tile::{Launch, Planned, records};
use crate::plan;
use crate::view::View;

/// Photons that a thread follows at once.
const CHUNK: u32 = 1 << 12;
/// Bytes of photons that lie in memory at once, unless those of one sample take more.
const MEMORY: u64 = 256 << 20;

/// The photons of some samples of a picture, and the lists of their grid; empty where none tell of caustics.
pub(super) struct Map {
    records: Vec<UVec4>,
    heads: Vec<u32>,
}

/// Of no photons.
pub(super) static NONE: Map = Map { records: Vec::new(), heads: Vec::new() };

impl Map {
    /// As kernels look through them.
    pub fn photons(&self) -> Photons<'_> {
        Photons { records: &self.records, heads: &self.heads }
    }
}

impl Planned {
    /// How many samples may have their photons in memory at once.
    pub(super) fn samples_at_once(&self, view: &View) -> u32 {
        let bytes = 16 * u64::from(RECORDS) * u64::from(view.photons(&self.laid.job));
        MEMORY.checked_div(bytes).map_or(u32::MAX, |samples| samples.clamp(1, u32::MAX.into()) as u32)
    }

    /// The photons of each of some samples; none where none tell of caustics.
    pub(super) fn maps<R: Number>(&self, view: &View, samples: Range<u32>) -> Vec<Map> {
        let each = samples.map(|sample| self.map::<R>(view, sample, 1));
        if self.photons.is_some() { each.collect() } else { Vec::new() }
    }

    /// Those of `count` samples together, from sample `first` on.
    pub(super) fn map<R: Number>(&self, view: &View, first: u32, count: u32) -> Map {
        let order = self.laid.specialisation().order;
        let whole = view.launch_of_photons(&self.laid.job, first, count, order);
        if whole.photons == 0 {
            return Map { records: Vec::new(), heads: Vec::new() };
        }
        let mut records = vec![UVec4::ZERO; (RECORDS * whole.slots) as usize];
        let chunks = records.par_chunks_mut((RECORDS * CHUNK) as usize).enumerate();
        chunks.for_each(|(chunk, records)| {
            let (before, slots) = (chunk as u32 * CHUNK, records.len() as u32 / RECORDS);
            // A chunk may lie in the photons of two samples.
            let mut done = 0;
            while done < slots {
                let (sample, photon) = ((before + done) / whole.photons, (before + done) % whole.photons);
                let here = (slots - done).min(whole.photons - photon);
                let part = &mut records[(RECORDS * done) as usize..(RECORDS * (done + here)) as usize];
                let frame = Frame { sample: first + sample, photon, slots: here, ..whole };
                self.land::<R>(&frame, part);
                done += here;
            }
        });
        let mut heads = vec![0; whole.heads as usize];
        for slot in 0..whole.slots {
            photon::file(&whole, slot, &mut records, |list, first| std::mem::replace(&mut heads[list as usize], first));
        }
        Map { records, heads }
    }

    /// Follows some photons of a sample, and keeps where they land.
    fn land<R: Number>(&self, frame: &Frame, landed: &mut [UVec4]) {
        let plan = self.photons.as_ref().expect("the view has photons");
        let records = Records { landed: landed.to_vec(), ..records::<R>(&self.plan, frame.slots) };
        let slots = (0..frame.slots).collect();
        let mut launch = Launch::new((self, frame), slots, (records, &mut []), &(), &NONE);
        plan::run(plan, &mut launch).expect("a CPU reports no errors");
        landed.copy_from_slice(&launch.into_records().landed);
    }
}
