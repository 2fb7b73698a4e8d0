//! Tables, lines and plots of records that were made up.

use std::collections::BTreeSet;

use super::*;

fn report() -> Report {
    let fast = Setting { precision: Precision::Fast, ..setting() };
    let mut records = vec![
        record(setting(), 80.0, 0.001),
        record(fast, 40.0, 0.002),
        record(Setting { samples: 1, method: Method::Wide, ..fast }, 4.5, 0.0213),
        record(Setting { bvh: Bvh::High, ..setting() }, 90.0, 0.001),
    ];
    records[2].recommended = true;
    records[2].wrong_primitives = 1.25e-4;
    records[2].t_error_max_ulp = None;
    super::super::record::mark(&mut records);
    Report {
        scene: "a|b, \"c\"".to_owned(),
        setup: vec![("device".to_owned(), "CPU".to_owned()), ("size".to_owned(), "8x8".to_owned())],
        base: setting(),
        records,
        notes: vec!["one is left out".to_owned()],
    }
}

#[test]
fn tables_line_up_and_tell_what_differs() {
    let text = markdown(&report());
    for part in [
        "## What speed costs: a\\|b, \"c\"\n",
        "\n### As it is\n\n| front | setting  | time, ms |",
        "\n|     3 | as it is |     80.0 |",
        "\n### Precision and triangle test\n",
        "\n|     2 | fast    |     40.0 |",
        "\n|       | BVH high |     90.0 |",
        "\n### Combinations\n",
        "|     1 | fast, wide, 1x1 sample * |     4.50 |      10.0 |      3.00 |              0.0125 |",
        "--precision fast --triangle watertight --method wide --layout gathered --bvh medium --integrator whitted --sampler regular --filter mipmap --samples 1 --bounces 8",
        "\n### Notes\n\n- one is left out\n",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    for block in text.split("\n\n").filter(|block| block.starts_with('|')) {
        let widths: BTreeSet<usize> =
            block.trim_end().lines().take_while(|l| l.starts_with('|')).map(|l| l.chars().count()).collect();
        assert_eq!(widths.len(), 1, "{block}");
    }
}

#[test]
fn a_line_of_csv_has_the_fields_of_a_record() {
    let report = report();
    let text = csv(&report);
    let lines: Vec<&str> = text.lines().collect();
    let json = serde_json::to_value(&report).unwrap();
    let record = json["records"][2].as_object().unwrap();
    let mut fields: BTreeSet<&str> = record.keys().map(String::as_str).collect();
    fields.insert("scene");
    assert_eq!(lines[0].split(',').collect::<BTreeSet<_>>(), fields);
    assert_eq!(lines.len(), 1 + report.records.len());
    let start = "\"a|b, \"\"c\"\"\",fast,watertight,wide,gathered,medium,whitted,regular,mipmap,,,1,0,8,0.0009765625,3,0,4.5,0.1,";
    assert!(
        lines[3].starts_with(start) && lines[3].contains(",0.0213,33.432") && lines[3].ends_with(",0,1,true"),
        "{text}"
    );
    assert_eq!((&record["precision"], &record["front"]), (&"fast".into(), &1.into()));
    assert!(record["t_error_max_ulp"].is_null() && json["records"][3]["front"].is_null());
}

/// Texts of an SVG.
fn texts(svg: &str) -> Vec<&str> {
    svg.split("</text>").filter_map(|part| part.trim_end().rsplit('\n').next()).collect()
}

#[test]
fn a_plot_has_axes_with_units_a_legend_and_every_record() {
    let report = report();
    let svg = plot(&report, Some(Wish::MaxError(0.05))).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    let texts = texts(&svg);
    for text in [
        "time of a rendering in ms (logarithmic)",
        "RMSE against the reference, linear light (logarithmic)",
        "Pareto front, numbered as in the table",
        "exact",
        "fast",
        "recommended",
        "a|b, &quot;c&quot;: 8x8 on CPU",
        "10",
        "1e-2",
    ] {
        assert!(texts.contains(&text), "{text}: {texts:?}");
    }
    assert!(!texts.contains(&"fast, moller"));
    let circles = svg.matches("<circle").count();
    assert_eq!(circles, report.records.len() + 1 + 3, "records, the ring, and the legend's");
}

#[test]
fn errors_of_nothing_lie_at_the_bottom_and_endless_ones_nowhere() {
    let mut report = report();
    report.records[0].rmse = 0.0;
    report.records[3].rmse = f64::INFINITY;
    super::super::record::mark(&mut report.records);
    let svg = plot(&report, None).unwrap();
    assert!(svg.contains("(logarithmic; 0 at the bottom)"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    for record in &mut report.records {
        record.rmse = f64::INFINITY;
    }
    assert!(plot(&report, None).is_err());
}

#[test]
fn marks_are_few_and_round() {
    let marks = |least: f64, most: f64| super::super::scale::Scale::of([least, most].into_iter()).unwrap().marks();
    assert_eq!(marks(0.5, 60.0).len(), 7, "0.5, 1, 2 and so on to 50");
    assert_eq!(marks(1e-6, 1e-2).len(), 5);
    for (least, most) in [(11.0, 12.0), (3e-8, 3e-8), (1e-3, 0.9), (99.0, 101.0)] {
        let marks = marks(least, most);
        assert!((1..=12).contains(&marks.len()), "{least} to {most}: {marks:?}");
    }
    assert!(super::super::scale::Scale::of([0.0, 1.0].into_iter()).is_none());
}
