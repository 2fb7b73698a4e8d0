//! Records as comma-separated values, a line each.

use super::{Record, Report};
use crate::bench::quoted;
use crate::preset::name;

/// A column's name and its value of a record.
type Column = (&'static str, fn(&Record) -> String);

/// The fields of [`Record`].
const COLUMNS: [Column; 28] = [
    ("precision", |r| name(r.setting.precision)),
    ("triangle", |r| name(r.setting.triangle)),
    ("method", |r| name(r.setting.method)),
    ("layout", |r| name(r.setting.layout)),
    ("bvh", |r| name(r.setting.bvh)),
    ("integrator", |r| name(r.setting.integrator)),
    ("sampler", |r| name(r.setting.sampler)),
    ("filter", |r| name(r.setting.filter)),
    ("spectral", |r| r.setting.spectral.map_or_else(String::new, |is| is.to_string())),
    ("caustics", |r| r.setting.caustics.map_or_else(String::new, |photons| photons.to_string())),
    ("samples", |r| r.setting.samples.to_string()),
    ("spp", |r| r.setting.spp.to_string()),
    ("bounces", |r| r.setting.bounces.to_string()),
    ("min_contribution", |r| r.setting.min_contribution.to_string()),
    ("roulette", |r| r.setting.roulette.to_string()),
    ("clamp", |r| r.setting.clamp.to_string()),
    ("time_ms", |r| r.time_ms.to_string()),
    ("spread", |r| r.spread.to_string()),
    ("slowest_ms", |r| r.slowest_ms.to_string()),
    ("build_ms", |r| r.build_ms.to_string()),
    ("wrong_primitives", |r| r.wrong_primitives.to_string()),
    ("t_error_median_ulp", |r| number(r.t_error_median_ulp)),
    ("t_error_max_ulp", |r| number(r.t_error_max_ulp)),
    ("rmse", |r| r.rmse.to_string()),
    ("psnr_db", |r| r.psnr_db.to_string()),
    ("rmse_same_samples", |r| number(r.rmse_same_samples)),
    ("front", |r| r.front.map_or_else(String::new, |place| place.to_string())),
    ("recommended", |r| r.recommended.to_string()),
];

/// Every record with the scene's name, below a line of names; RFC 4180 but for the line ends.
pub fn csv(report: &Report) -> String {
    let line = |values: Vec<String>| values.join(",") + "\n";
    let mut names = vec!["scene".to_owned()];
    names.extend(COLUMNS.iter().map(|(name, _)| (*name).to_owned()));
    let mut text = line(names);
    for record in &report.records {
        let mut values = vec![quoted(&report.scene)];
        values.extend(COLUMNS.iter().map(|(_, value)| value(record)));
        text += &line(values);
    }
    text
}

fn number(x: Option<f64>) -> String {
    x.map_or_else(String::new, |x| x.to_string())
}
