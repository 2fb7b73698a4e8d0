//! The thesis' tables of chapter 7, in Markdown.

use super::{Kind, Record, Report};

/// All tables of a report.
pub fn markdown(report: &Report) -> String {
    let mut text = Text::default();
    setup(&mut text, report);
    scenes(&mut text, report);
    views(&mut text, report);
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

const SPEEDS: &str =
    "Frames a second (if these rays were all) / Mrays/s, each from the median time; `*` marks what `auto` takes.";

const COUNTS: &str = "\
What the kernels' own hooks count on the CPU over a sample of each stream, a ray, mean of the views. A visit is one of a pair
of boxes, or of a wide node's eight. What a packet of 32 does is charged to each of its rays. SIMD efficiency is the share of
a packet's rays that want the child it goes to.";

/// Markdown in the making.
#[derive(Default)]
struct Text(String);

impl Text {
    fn heading(&mut self, title: &str, caption: &str) {
        self.0 += if self.0.is_empty() { "" } else { "\n" };
        self.0 += &format!("## {title}\n");
        self.paragraph(caption);
    }

    fn paragraph(&mut self, text: &str) {
        if !text.is_empty() {
            self.0 += &format!("\n{text}\n");
        }
    }

    fn table(&mut self, head: &[&str], rows: &[Vec<String>]) {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        self.0 += "\n";
        self.0 += &line(head.iter().map(|cell| escaped(cell)).collect());
        self.0 += &format!("|{}\n", "---|".repeat(head.len()));
        for row in rows {
            self.0 += &line(row.iter().map(|cell| escaped(cell)).collect());
        }
    }
}

/// A cell's text; names come from files.
fn escaped(cell: &str) -> String {
    let line: String = cell.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    line.replace('|', "\\|")
}

fn setup(text: &mut Text, report: &Report) {
    text.heading("Setup", "");
    let rows: Vec<_> = report.setup.iter().map(|(name, value)| vec![name.clone(), value.clone()]).collect();
    text.table(&["", ""], &rows);
}

fn scenes(text: &mut Text, report: &Report) {
    text.heading("Scenes (thesis table 7.1)", "");
    let row = |s: &super::SceneRow| {
        let counts = [s.triangles, s.split_triangles, s.nodes, s.leaves, s.depth as usize, s.wide_nodes];
        let mut row = vec![s.scene.clone()];
        row.extend(counts.map(grouped));
        row.extend([format!("{:.0}", s.build_ms), format!("{:.4}", s.ao_length)]);
        row
    };
    let rows: Vec<_> = report.scenes.iter().map(row).collect();
    text.table(
        &[
            "scene",
            "triangles",
            "split triangles",
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
    let row = |v: &super::ViewRow| {
        let hits = format!("{:.2} %", 100.0 * v.hit_share);
        vec![v.scene.clone(), v.view.clone(), v.order.clone(), hits, grouped(v.rays), format!("`{}`", v.hash)]
    };
    let rows: Vec<_> = report.views.iter().map(row).collect();
    text.table(&["scene", "view", "order", "primary rays that hit", "rays", "hash"], &rows);
}

/// A table a scene, kind, device and precision: methods down, views across.
fn speeds(text: &mut Text, records: &[&Record]) {
    let title = |r: &Record| (r.scene.clone(), r.kind, r.processor, r.precision, r.device.clone());
    for (scene, kind, processor, precision, device) in distinct(records.iter().map(|r| title(r))) {
        let key = (scene.clone(), kind, processor, precision, device.clone());
        let of: Vec<&Record> = records.iter().copied().filter(|r| title(r) == key).collect();
        let views = distinct(of.iter().map(|r| r.view.clone()));
        let mut head = vec!["method"];
        head.extend(views.iter().map(String::as_str));
        head.extend((views.len() > 1).then_some("mean"));
        let rows: Vec<_> =
            distinct(of.iter().map(|r| label(r))).into_iter().map(|way| speed_row(&way, &views, &of)).collect();
        let spread = of.iter().map(|r| r.spread).fold(0.0, f64::max);
        text.paragraph(&format!(
            "**{}**, {} rays, {} in {precision} precision; spread at most {:.1} %",
            escaped(&scene),
            kind.name(),
            escaped(&device),
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
    let key = |r: &Record| (r.scene.clone(), r.kind, r.order.clone(), r.method.clone());
    let mut rows = Vec::new();
    for (scene, kind, order, method) in distinct(report.records.iter().map(key)) {
        let (wanted, mut of) = ((scene.clone(), kind, order.clone(), method.clone()), Vec::new());
        of.extend(report.records.iter().filter(|r| key(r) == wanted));
        let mean = |value: &dyn Fn(&Record) -> Option<f64>| {
            let all: Option<Vec<f64>> = of.iter().map(|r| value(r)).collect();
            all.map_or_else(|| "-".to_owned(), |all| format!("{:.2}", all.iter().sum::<f64>() / all.len() as f64))
        };
        let mut row = vec![scene, kind.name().to_owned(), order, method];
        row.extend([
            mean(&|r| Some(r.visits)),
            mean(&|r| Some(r.boxes)),
            mean(&|r| Some(r.triangle_tests)),
            mean(&|r| r.simd_efficiency),
        ]);
        rows.push(row);
    }
    text.table(
        &["scene", "kind", "order", "method", "visits", "box tests", "triangle tests", "SIMD efficiency"],
        &rows,
    );
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
    let mut label = vec![record.method.as_str()];
    label.extend(record.scheduling.as_deref().filter(|s| *s != "grid"));
    label.extend([record.order.as_str()].iter().filter(|o| **o != "tiled"));
    label.extend([record.triangles.as_str()].iter().filter(|t| **t != "gathered"));
    label.join(", ")
}

/// What there is, each once, in the order of first appearance.
fn distinct<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<T> {
    let mut once = Vec::new();
    for one in all {
        if !once.contains(&one) {
            once.push(one);
        }
    }
    once
}

/// Three digits, or all before the point.
fn short(x: f64) -> String {
    let decimals = if x >= 99.95 {
        0
    } else if x >= 9.995 {
        1
    } else {
        2
    };
    format!("{x:.decimals$}")
}

/// 1234567 as 1,234,567.
fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
