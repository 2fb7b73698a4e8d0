//! The thesis' tables of chapter 7, in Markdown.

use super::text::{Text, distinct, escaped, grouped, short};
use super::{Kind, Record, Report, SceneRow, ViewRow};

/// All tables of a report.
pub fn markdown(report: &Report) -> String {
    let mut text = Text::default();
    setup(&mut text, report);
    scenes(&mut text, report);
    views(&mut text, report);
    summary(&mut text, report);
    let (primary, others): (Vec<_>, Vec<_>) = report.records.iter().partition(|r| r.kind == Kind::Primary);
    if !primary.is_empty() {
        text.heading("Primary rays (thesis table 7.2)", SPEEDS);
        speeds(&mut text, &primary);
    }
    if !others.is_empty() {
        text.heading("Other rays (thesis table 7.3)", SPEEDS);
        speeds(&mut text, &others);
    }
    counts(&mut text, report);
    differences(&mut text, report);
    list(&mut text, "Faults", &report.faults);
    list(&mut text, "Notes", &report.notes);
    text.0
}

const SUMMARY: &str =
    "Mrays/s, mean of the views. The best of each kind is bold; `*` marks what `auto` takes for the device and kind.";

const SPEEDS: &str =
    "\
Frames a second (if these rays were all) / Mrays/s, each from the median time: on a GPU the device's time of the dispatch, on
the CPU the wall clock's of tracing. `*` marks what `auto` takes.";

const COUNTS: &str = "\
What the kernels' own hooks count on the CPU over a sample of each stream, a ray, mean of the views. A visit is one of a pair
of boxes, or of a wide node's eight. What a packet of 32 does is charged to each of its rays. SIMD efficiency is the share of
a packet's rays that want the child it goes to.";

fn setup(text: &mut Text, report: &Report) {
    text.heading("Setup", "");
    let rows: Vec<_> = report.setup.iter().map(|(name, value)| vec![name.clone(), value.clone()]).collect();
    text.table(&["", ""], &rows);
}

fn scenes(text: &mut Text, report: &Report) {
    text.heading("Scenes (thesis table 7.1)", "");
    let row = |s: &SceneRow| {
        let counts = [s.primitives, s.references, s.nodes, s.leaves, s.depth as usize, s.wide_nodes];
        let mut row = vec![s.scene.clone()];
        row.extend(counts.map(grouped));
        row.extend([format!("{:.0}", s.build_ms), format!("{:.4}", s.ao_length)]);
        row
    };
    let rows: Vec<_> = report.scenes.iter().map(row).collect();
    text.table(
        &[
            "scene",
            "primitives",
            "references",
            "nodes",
            "leaves",
            "largest depth",
            "wide nodes",
            "build, ms",
            "length of ao rays",
        ],
        &rows,
    );
}

fn views(text: &mut Text, report: &Report) {
    let caption =
        "The hash is over the answers of all rays, and the same for every method and device in exact precision.";
    text.heading("Views", caption);
    let row = |v: &ViewRow| {
        let hits = format!("{:.2} %", 100.0 * v.hit_share);
        vec![v.scene.clone(), v.view.clone(), v.order.clone(), hits, grouped(v.rays), format!("`{}`", v.hash)]
    };
    let rows: Vec<_> = report.views.iter().map(row).collect();
    text.table(&["scene", "view", "order", "primary rays that hit", "rays", "hash"], &rows);
}

/// What was measured of one scene on one device in one precision.
fn group(record: &Record) -> (&str, &str, &str, &str) {
    (&record.scene, record.processor, &record.device, record.precision)
}

/// A table a scene, device and precision: methods down, kinds across.
fn summary(text: &mut Text, report: &Report) {
    if report.records.is_empty() {
        return;
    }
    text.heading("All kinds of rays", SUMMARY);
    for (scene, processor, device, precision) in distinct(report.records.iter().map(group)) {
        let wanted = (scene, processor, device, precision);
        let of: Vec<&Record> = report.records.iter().filter(|r| group(r) == wanted).collect();
        let kinds = distinct(of.iter().map(|r| r.kind));
        let ways = distinct(of.iter().map(|r| label(r)));
        let columns: Vec<Vec<String>> = kinds.iter().map(|&kind| column(kind, &ways, &of)).collect();
        let row = |(i, way): (usize, &String)| {
            std::iter::once(way.clone()).chain(columns.iter().map(|column| column[i].clone())).collect()
        };
        let rows: Vec<_> = ways.iter().enumerate().map(row).collect();
        let head: Vec<_> = std::iter::once("method").chain(kinds.iter().map(|kind| kind.name())).collect();
        text.paragraph(&format!("**{}**, {} in {precision} precision", escaped(scene), escaped(device)));
        text.table(&head, &rows);
    }
}

/// A kind's cell for each way.
fn column(kind: Kind, ways: &[String], records: &[&Record]) -> Vec<String> {
    let cell = |way: &String| {
        let of: Vec<&&Record> = records.iter().filter(|r| r.kind == kind && label(r) == *way).collect();
        let mean = of.iter().map(|r| r.mrays_per_s).sum::<f64>() / of.len() as f64;
        (!of.is_empty()).then(|| (mean, of.iter().any(|r| r.auto)))
    };
    let cells: Vec<_> = ways.iter().map(cell).collect();
    let best = cells.iter().flatten().map(|cell| cell.0).fold(0.0, f64::max);
    let written = |(mean, auto): (f64, bool)| {
        let star = if auto { " *" } else { "" };
        if mean == best { format!("**{}**{star}", short(mean)) } else { format!("{}{star}", short(mean)) }
    };
    cells.into_iter().map(|cell| cell.map_or_else(|| "-".to_owned(), written)).collect()
}

/// A table a scene, kind, device and precision: methods down, views across.
fn speeds(text: &mut Text, records: &[&Record]) {
    for (kind, (scene, processor, device, precision)) in distinct(records.iter().map(|r| (r.kind, group(r)))) {
        let wanted = (kind, (scene, processor, device, precision));
        let of: Vec<&Record> = records.iter().copied().filter(|r| (r.kind, group(r)) == wanted).collect();
        let views = distinct(of.iter().map(|r| r.view.clone()));
        let mut head = vec!["method"];
        head.extend(views.iter().map(String::as_str));
        head.extend((views.len() > 1).then_some("mean"));
        let rows: Vec<_> =
            distinct(of.iter().map(|r| label(r))).into_iter().map(|way| speed_row(&way, &views, &of)).collect();
        let spread = of.iter().map(|r| r.spread).fold(0.0, f64::max);
        text.paragraph(&format!(
            "**{}**, {} rays, {} in {precision} precision; spread at most {:.1} %",
            escaped(scene),
            kind.name(),
            escaped(device),
            100.0 * spread
        ));
        text.table(&head, &rows);
    }
}

fn speed_row(way: &str, views: &[String], records: &[&Record]) -> Vec<String> {
    let of: Vec<&Record> = records.iter().copied().filter(|r| label(r) == way).collect();
    let star = if of.iter().any(|r| r.auto) { " *" } else { "" };
    let mut row = vec![format!("{way}{star}")];
    for view in views {
        let record = of.iter().find(|r| r.view == *view);
        row.push(record.map_or_else(|| "-".to_owned(), |r| speed(r.frames_per_s, r.mrays_per_s)));
    }
    if views.len() > 1 {
        let mean = |value: &dyn Fn(&Record) -> f64| of.iter().map(|r| value(r)).sum::<f64>() / of.len() as f64;
        row.push(speed(mean(&|r| r.frames_per_s), mean(&|r| r.mrays_per_s)));
    }
    row
}

fn speed(frames: f64, mrays: f64) -> String {
    format!("{} / {}", short(frames), short(mrays))
}

fn counts(text: &mut Text, report: &Report) {
    if report.records.is_empty() {
        return;
    }
    text.heading("Counts", COUNTS);
    let key = |r: &Record| (r.scene.clone(), r.kind, counted(r));
    let mut rows = Vec::new();
    for (scene, kind, way) in distinct(report.records.iter().map(key)) {
        let (wanted, mut of) = ((scene.clone(), kind, way.clone()), Vec::new());
        of.extend(report.records.iter().filter(|r| key(r) == wanted));
        let mean = |value: &dyn Fn(&Record) -> Option<f64>| {
            let all: Option<Vec<f64>> = of.iter().map(|r| value(r)).collect();
            all.map_or_else(|| "-".to_owned(), |all| format!("{:.2}", all.iter().sum::<f64>() / all.len() as f64))
        };
        let mut row = vec![scene, kind.name().to_owned(), way];
        row.extend([
            mean(&|r| Some(r.visits)),
            mean(&|r| Some(r.boxes)),
            mean(&|r| Some(r.primitive_tests)),
            mean(&|r| r.simd_efficiency),
        ]);
        rows.push(row);
    }
    text.table(&["scene", "kind", "method", "visits", "box tests", "primitive tests", "SIMD efficiency"], &rows);
}

/// What fast precision changes.
fn differences(text: &mut Text, report: &Report) {
    let fast: Vec<&Record> = report.records.iter().filter(|r| r.precision == "fast").collect();
    if fast.is_empty() {
        return;
    }
    let caption = "Rays that met another primitive than in exact precision, or were told another answer; the most of all methods.";
    text.heading("Fast precision", caption);
    let key = |r: &Record| (r.scene.clone(), r.view.clone(), r.kind);
    let mut rows = Vec::new();
    for (scene, view, kind) in distinct(fast.iter().map(|r| key(r))) {
        let wanted = (scene.clone(), view.clone(), kind);
        let of = fast.iter().filter(|r| key(r) == wanted);
        let most = of.map(|r| (r.differing, r.rays)).fold((0.0, 0), |a, b| if b.0 >= a.0 { b } else { a });
        let rays = (most.0 * most.1 as f64).round() as usize;
        rows.push(vec![scene, view, kind.name().to_owned(), grouped(rays), grouped(most.1), format!("{:.2e}", most.0)]);
    }
    text.table(&["scene", "view", "kind", "rays that differ", "of", "share"], &rows);
}

fn list(text: &mut Text, title: &str, lines: &[String]) {
    if !lines.is_empty() {
        text.heading(title, "");
        text.0 += "\n";
        lines.iter().for_each(|line| text.0 += &format!("- {}\n", escaped(line)));
    }
}

/// A method and those of its switches that are not as they are by default.
fn label(record: &Record) -> String {
    let scheduling = record.scheduling.as_deref().filter(|scheduling| *scheduling != "grid");
    scheduling.map_or_else(|| counted(record), |scheduling| format!("{}, {scheduling}", counted(record)))
}

/// The same without the scheduling, which does not change what is counted.
fn counted(record: &Record) -> String {
    let mut label = vec![record.method.as_str()];
    label.extend([record.order.as_str()].iter().filter(|order| **order != "tiled"));
    label.extend([record.layout.as_str()].iter().filter(|layout| **layout != "gathered"));
    label.extend([record.triangle.as_str()].iter().filter(|test| **test != "watertight"));
    label.join(", ")
}
