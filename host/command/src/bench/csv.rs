//! Measurements as comma-separated values, a line each.

use super::{Record, Report};

/// Every measurement, below a line of names; RFC 4180 but for the line ends.
pub fn csv(report: &Report) -> String {
    let line = |values: Vec<String>| values.join(",") + "\n";
    let mut text = line(NAMES.map(str::to_owned).to_vec());
    for record in &report.records {
        text += &line(values(record).iter().map(|value| quoted(value)).collect());
    }
    text
}

/// The fields of [`Record`].
const NAMES: [&str; 30] = [
    "scene",
    "view",
    "kind",
    "method",
    "auto",
    "scheduling",
    "order",
    "layout",
    "triangle",
    "bvh",
    "stack_max",
    "cut",
    "processor",
    "device",
    "driver",
    "precision",
    "width",
    "height",
    "rays",
    "repeat",
    "median_seconds",
    "spread",
    "mrays_per_s",
    "frames_per_s",
    "visits",
    "boxes",
    "primitive_tests",
    "simd_efficiency",
    "hash",
    "differing",
];

fn values(r: &Record) -> [String; 30] {
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| x.to_string());
    [
        r.scene.clone(),
        r.view.clone(),
        r.kind.name().to_owned(),
        r.method.clone(),
        r.auto.to_string(),
        r.scheduling.clone().unwrap_or_default(),
        r.order.clone(),
        r.layout.clone(),
        r.triangle.clone(),
        r.bvh.clone(),
        r.stack_max.to_string(),
        r.cut.to_string(),
        r.processor.to_owned(),
        r.device.clone(),
        r.driver.clone(),
        r.precision.to_owned(),
        r.width.to_string(),
        r.height.to_string(),
        r.rays.to_string(),
        r.repeat.to_string(),
        r.median_seconds.to_string(),
        r.spread.to_string(),
        r.mrays_per_s.to_string(),
        r.frames_per_s.to_string(),
        r.visits.to_string(),
        r.boxes.to_string(),
        r.primitive_tests.to_string(),
        number(r.simd_efficiency),
        r.hash.clone(),
        r.differing.to_string(),
    ]
}

/// In quotes if it must be.
pub(crate) fn quoted(value: &str) -> String {
    if value.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", value.replace('"', "\"\""))
    } else {
        value.to_owned()
    }
}
