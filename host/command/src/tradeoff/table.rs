//! Markdown that lines up, to be read as it is.

use super::{Axis, Record, Report, Setting};
use crate::bench::{escaped, short};

const CAPTION: &str = "\
Time: the median of a rendering, and from the 10th to the 90th percentile as a share of it. Wrong primitives and the
error of the distance t (in units of the last place of single precision, where the primitive is right): of the rays
through pixels' centres, against double precision. RMSE and PSNR: of the picture, in linear light, against the
reference; \"RMSE, same samples\" against a reference with as few samples, so without the error of sampling (none where
light is sampled). A number in the first column is a place on the front: nothing that was tried is both faster and nearer
to the reference.";

/// Everything, as tables.
pub fn markdown(report: &Report) -> String {
    let mut text = format!("## What speed costs: {}\n\n", escaped(&report.scene));
    text += &aligned(
        &["", ""],
        &report.setup.iter().map(|(name, value)| vec![name.clone(), value.clone()]).collect::<Vec<_>>(),
    );
    text += &format!("\nAs it is: `{}`\n\n{CAPTION}\n", report.base.options());
    for (title, of) in sections(report) {
        text += &format!("\n### {title}\n\n{}", table(&of, &report.base));
    }
    text += &format!("\n### Pareto front\n\n{}", table(&report.front(), &report.base));
    if let Some(best) = report.recommended() {
        text += &format!("\n### Recommended\n\n{}\n`{}`\n", table(&[best], &report.base), best.setting.options());
    }
    if !report.notes.is_empty() {
        text += "\n### Notes\n\n";
        report.notes.iter().for_each(|note| text += &format!("- {}\n", escaped(note)));
    }
    text
}

/// The base, every axis by itself, and what differs from the base on several.
fn sections(report: &Report) -> Vec<(&'static str, Vec<&Record>)> {
    let titles = [
        (Some(Axis::Arithmetic), "Precision and triangle test"),
        (Some(Axis::Method), "Method"),
        (Some(Axis::Layout), "Layout of nodes and triangles"),
        (Some(Axis::Bvh), "Quality of the hierarchy"),
        (Some(Axis::Integrator), "Integrator"),
        (Some(Axis::Sampler), "Sampler"),
        (Some(Axis::Filter), "Filter of textures"),
        (Some(Axis::Spectral), "Light of single wavelengths"),
        (Some(Axis::Samples), "Samples"),
        (Some(Axis::Bounces), "Bounces"),
        (Some(Axis::MinContribution), "Least contribution"),
        (Some(Axis::Roulette), "Russian roulette"),
        (Some(Axis::Clamp), "Clamp"),
        (None, "Combinations"),
    ];
    let of = |axis| report.records.iter().filter(|r| r.setting != report.base && only(r, report) == axis).collect();
    let mut all: Vec<(&str, Vec<&Record>)> = titles.into_iter().map(|(axis, title)| (title, of(axis))).collect();
    all.insert(0, ("As it is", report.records.iter().filter(|r| r.setting == report.base).collect()));
    all.retain(|(_, records)| !records.is_empty());
    all
}

/// The one axis on which a record differs from the base.
fn only(record: &Record, report: &Report) -> Option<Axis> {
    let differs = |axis: &Axis| axis.taken(report.base, &record.setting) != report.base;
    let mut axes = Axis::ALL.into_iter().filter(differs);
    axes.next().filter(|_| axes.next().is_none())
}

const HEAD: [&str; 11] = [
    "front",
    "setting",
    "time, ms",
    "spread, %",
    "build, ms",
    "wrong primitives, %",
    "t error, ulp: median",
    "largest",
    "RMSE",
    "PSNR, dB",
    "RMSE, same samples",
];

fn table(records: &[&Record], base: &Setting) -> String {
    let rows: Vec<_> = records.iter().map(|record| row(record, base)).collect();
    aligned(&HEAD, &rows)
}

fn row(record: &Record, base: &Setting) -> Vec<String> {
    let ulps = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), short);
    let star = if record.recommended { " *" } else { "" };
    vec![
        record.front.map_or_else(String::new, |place| place.to_string()),
        record.setting.beside(base) + star,
        short(record.time_ms),
        format!("{:.1}", 100.0 * record.spread),
        short(record.build_ms),
        percent(record.wrong_primitives),
        ulps(record.t_error_median_ulp),
        ulps(record.t_error_max_ulp),
        scientific(record.rmse),
        if record.psnr_db.is_finite() { format!("{:.1}", record.psnr_db) } else { record.psnr_db.to_string() },
        record.rmse_same_samples.map_or_else(|| "-".to_owned(), scientific),
    ]
}

/// Down to one ray of a million, and 0 for none.
fn percent(share: f64) -> String {
    if share == 0.0 { "0".to_owned() } else { format!("{:.4}", 100.0 * share) }
}

/// Three digits.
fn scientific(x: f64) -> String {
    if x == 0.0 { "0".to_owned() } else { format!("{x:.2e}") }
}

/// A Markdown table whose columns line up; words to the left, numbers to the right.
fn aligned(head: &[&str], rows: &[Vec<String>]) -> String {
    let escape = |cell: &String| escaped(cell);
    let head: Vec<String> = head.iter().map(|cell| escaped(cell)).collect();
    let rows: Vec<Vec<String>> = rows.iter().map(|row| row.iter().map(escape).collect()).collect();
    let count = |cell: &String| cell.chars().count();
    let is_number = |cell: &str| cell.is_empty() || cell == "-" || cell == "inf" || cell.parse::<f64>().is_ok();
    let columns: Vec<(usize, bool)> = (0..head.len())
        .map(|i| {
            let cells = || rows.iter().map(|row| &row[i]);
            let width = cells().map(count).chain([count(&head[i]), 3]).max().unwrap_or(0);
            (width, cells().all(|cell| is_number(cell)))
        })
        .collect();
    let line = |cells: &[String]| {
        let padded = cells.iter().zip(&columns).map(|(cell, &(width, right))| {
            if right { format!(" {cell:>width$} |") } else { format!(" {cell:<width$} |") }
        });
        format!("|{}\n", padded.collect::<String>())
    };
    let rule = columns.iter().map(|&(width, right)| {
        let dashes = "-".repeat(width);
        if right { format!(" {}: |", &dashes[1..]) } else { format!(" {dashes} |") }
    });
    let rule = format!("|{}\n", rule.collect::<String>());
    let rows: String = rows.iter().map(|row| line(row)).collect();
    format!("{}{rule}{rows}", line(&head))
}
