//! What was measured.

use serde::Serialize;

use super::{Setting, front};

/// A setting, its time and its errors. As JSON, infinite numbers are `null`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Record {
    /// What was rendered with.
    #[serde(flatten)]
    pub setting: Setting,
    /// Median time of a rendering in milliseconds.
    pub time_ms: f64,
    /// From the 10th to the 90th percentile of the times, as a share of the median.
    pub spread: f64,
    /// The longest of the times in milliseconds.
    pub slowest_ms: f64,
    /// What building the hierarchy took in milliseconds.
    pub build_ms: f64,
    /// Share of the primary rays through pixels' centres that met another primitive than in double precision, or
    /// nothing where there is something.
    pub wrong_primitives: f64,
    /// Median error of the distance of those that met the same, in units of the last place of single precision;
    /// none if none did.
    pub t_error_median_ulp: Option<f64>,
    /// The largest such error.
    pub t_error_max_ulp: Option<f64>,
    /// Root of the mean square difference from the reference, over all channel values, in linear light.
    pub rmse: f64,
    /// Peak signal-to-noise ratio in dB with a peak of 1.0: infinite if the picture is the reference.
    pub psnr_db: f64,
    /// As `rmse`, from a reference with as few samples: without the error of sampling. None where light is sampled.
    pub rmse_same_samples: Option<f64>,
    /// Its place on the Pareto front of time and RMSE, from 1 by time.
    pub front: Option<usize>,
    /// Does it serve the wish best?
    pub recommended: bool,
}

/// All that was measured of a scene.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// The scene's name.
    pub scene: String,
    /// Where and how.
    pub setup: Vec<(String, String)>,
    /// What `eyerays render` takes by itself.
    pub base: Setting,
    /// In the order of measuring.
    pub records: Vec<Record>,
    /// What was left out, and why.
    pub notes: Vec<String>,
}

impl Report {
    /// Records on the Pareto front, by growing time.
    pub fn front(&self) -> Vec<&Record> {
        let mut members: Vec<&Record> = self.records.iter().filter(|record| record.front.is_some()).collect();
        members.sort_by_key(|record| record.front);
        members
    }

    /// The record that serves the wish best.
    pub fn recommended(&self) -> Option<&Record> {
        self.records.iter().find(|record| record.recommended)
    }
}

/// Numbers the members of the front.
pub(super) fn mark(records: &mut [Record]) {
    let points: Vec<(f64, f64)> = records.iter().map(|record| (record.time_ms, record.rmse)).collect();
    for record in records.iter_mut() {
        record.front = None;
    }
    for (place, i) in front(&points).into_iter().enumerate() {
        records[i].front = Some(place + 1);
    }
}
