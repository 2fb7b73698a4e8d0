//! `eyerays tradeoff` and the settings files that it keeps, as a person runs them.

mod program;

use std::cell::RefCell;
use std::fs;

use program::{Place, SCENE, has_gpu, shipped};

/// A small run over few settings.
const FEW: [&str; 12] = [
    "--size",
    "32x32",
    "--device",
    "cpu",
    "--repeat",
    "1",
    "--methods",
    "auto,wide",
    "--layout",
    "gathered",
    "--bvh",
    "fast",
];

/// Renders with and without a settings file, and measures the root of the mean square error against the reference of
/// so many samples.
fn error(place: &Place, scene: &str, more: &[&str], samples: &str) -> f64 {
    let render = |output: &str, more: &[&str]| {
        place.succeed(&[&["render", scene, "--size", "32x32", "-o", output, "-q"], more].concat());
    };
    render("again.exr", more);
    render("reference.exr", &["--precision", "reference", "--samples", samples]);
    let compared = place.run(&["diff", "again.exr", "reference.exr", "--json"]).json();
    compared["comparison"]["rmse"].as_f64().unwrap()
}

#[test]
fn the_recommended_setting_meets_its_bound_when_it_is_rendered_again() {
    let place = Place::new(&[]);
    let cornell = shipped("cornell");
    let run = |wish: &[&str], file: &str| {
        let report = format!("{file}.json");
        let more = ["--samples", "1,2", "--save", file, "-o", &report];
        let outcome = place.succeed(&[&["tradeoff", &cornell], &FEW[..], &more, wish].concat());
        assert!(outcome.stderr.contains(&format!("--settings {file}")), "{}", outcome.stderr);
        let json: serde_json::Value = serde_json::from_slice(&fs::read(place.path(&report)).unwrap()).unwrap();
        let records = json["records"].as_array().unwrap().clone();
        let best = records.iter().find(|record| record["recommended"] == true).unwrap().clone();
        (records, best, error(&place, &cornell, &["--settings", file], "2"))
    };
    let (records, best, found) = run(&["--max-error", "0.05"], "near.toml");
    assert!(found <= 0.05 && best["rmse"] == found, "{found}: {best}");
    let slower = |record: &serde_json::Value| record["time_ms"].as_f64() < best["time_ms"].as_f64();
    assert!(records.iter().filter(|r| slower(r)).all(|r| r["rmse"].as_f64().unwrap() > 0.05));
    // A minute is enough for the most accurate of all.
    let (records, best, found) = run(&["--budget", "60000"], "soon.toml");
    assert_eq!(best["rmse"], found);
    assert!(records.iter().all(|record| record["rmse"].as_f64().unwrap() >= found));
}

#[test]
fn a_report_is_written_in_every_format() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let outputs = ["a.md", "a.csv", "a.json", "a.svg"];
    let outputs = outputs.iter().flat_map(|name| ["-o", name]).collect::<Vec<_>>();
    let outcome = place.succeed(&[&["tradeoff", "scene.toml", "--samples", "1"], &FEW[..], &outputs].concat());
    assert!(outcome.stderr.is_empty(), "{}", outcome.stderr);
    let read = |name| fs::read_to_string(place.path(name)).unwrap();
    assert_eq!(read("a.md"), outcome.text());
    for part in ["## What speed costs: scene", "| time, ms |", "| RMSE", "### Pareto front"] {
        assert!(outcome.text().contains(part), "{part}: {}", outcome.text());
    }
    assert!(!outcome.text().contains("### Bounces"), "nothing here reflects or lets light pass");
    let json: serde_json::Value = serde_json::from_str(&read("a.json")).unwrap();
    let records = json["records"].as_array().unwrap();
    assert_eq!(read("a.csv").lines().count(), 1 + records.len());
    assert!(records.iter().any(|record| record["method"] == "wide"));
    assert!(records.iter().all(|record| record["precision"] == "exact"), "a CPU has no other");
    assert!(read("a.svg").starts_with("<svg") && read("a.svg").contains("in ms (logarithmic)"));
    let quiet = place.succeed(&[&["tradeoff", "scene.toml", "--samples", "1", "-q"], &FEW[..]].concat());
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty(), "{}", quiet.stderr);
}

#[test]
fn a_wish_that_nothing_serves_is_told_and_nothing_kept() {
    let kept = "# eyerays tradeoff scene.toml\nsamples = 3\n";
    let place = Place::new(&[("scene.toml", SCENE), ("old.toml", kept)]);
    for (wish, nearest) in [("--max-error", "the least RMSE is"), ("--budget", "the fastest takes up to")] {
        let more = ["--samples", "1,2", wish, "1e-12", "--save", "old.toml"];
        let outcome = place.run(&[&["tradeoff", "scene.toml"], &FEW[..], &more].concat());
        assert_eq!(outcome.code, Some(1), "{}", outcome.stderr);
        assert!(outcome.stderr.contains(nearest) && outcome.stderr.contains("--precision"), "{}", outcome.stderr);
        assert!(!outcome.text().contains("### Recommended"));
        assert_eq!(fs::read_to_string(place.path("old.toml")).unwrap(), kept);
    }
}

#[test]
fn the_gpu_is_measured_by_its_own_clock() {
    if !has_gpu() {
        return;
    }
    let place = Place::new(&[("scene.toml", SCENE)]);
    let few = ["--size", "16x16", "--device", "gpu", "--repeat", "1", "--methods", "if-if", "--layout", "gathered"];
    let more = ["--bvh", "fast", "--samples", "1", "--budget", "60000", "--save", "kept.toml", "-o", "a.json"];
    let outcome = place.succeed(&[&["tradeoff", "scene.toml"], &few[..], &more].concat());
    let json: serde_json::Value = serde_json::from_slice(&fs::read(place.path("a.json")).unwrap()).unwrap();
    assert_eq!(json["records"].as_array().unwrap().len(), 3, "{}", outcome.text());
    assert!(outcome.text().contains("device time, by timestamps") || outcome.text().contains("wall-clock"));
    assert!(fs::read_to_string(place.path("kept.toml")).unwrap().contains("device = \"gpu\"\n"));
    let again = place.succeed(&["render", "scene.toml", "--settings", "kept.toml", "-o", "out.png", "--json"]).json();
    assert_eq!(again["why"], "--device gpu");
}

/// Light that is sampled: what is kept is what was measured, and renders the same picture again.
#[test]
fn sampled_light_is_recommended_by_its_noise() {
    let place = Place::new(&[]);
    let scene = shipped("cornell_path");
    let few = ["--size", "16x16", "--device", "cpu", "--repeat", "1", "--methods", "auto", "--layout", "gathered"];
    let more = ["--bvh", "fast", "--precision", "exact", "--spp", "1,4", "--sampler", "sobol,random", "--bounces", "3"];
    let wish = ["--clamp", "0,1", "--roulette", "0,65535", "--budget", "60000", "--save", "kept.toml", "-o", "a.json"];
    let outcome = place.succeed(&[&["tradeoff", &scene], &few[..], &more, &wish].concat());
    for part in
        ["two pictures of 32 samples", "its standard error is", "### Sampler", "### Russian roulette", "### Clamp"]
    {
        assert!(outcome.text().contains(part), "{part}: {}", outcome.text());
    }
    let json: serde_json::Value = serde_json::from_slice(&fs::read(place.path("a.json")).unwrap()).unwrap();
    let best = json["records"].as_array().unwrap().iter().find(|record| record["recommended"] == true).unwrap().clone();
    assert_eq!(best["spp"], 4, "{best}");
    let kept = fs::read_to_string(place.path("kept.toml")).unwrap();
    assert!(kept.contains("integrator = \"path\"\n") && kept.contains("spp = 4\n"), "{kept}");
    let render = |output: &str, more: &[&str]| {
        let json =
            place.succeed(&[&["render", &scene, "--size", "16x16", "-o", output, "--json"], more].concat()).json();
        (json["film_hash"].to_string(), json["spp"].clone())
    };
    let by_options = ["sampler", "roulette", "clamp"].map(|key| match &best[key] {
        serde_json::Value::String(word) => format!("--{key}={word}"),
        other => format!("--{key}={other}"),
    });
    let by_options: Vec<&str> = by_options.iter().map(String::as_str).chain(["--spp=4", "--bounces=3"]).collect();
    let by_options = [&by_options[..], &["--device", "cpu", "--bvh", "fast"]].concat();
    assert_eq!(render("again.exr", &["--settings", "kept.toml"]), render("asked.exr", &by_options));
    assert_eq!(render("again.exr", &["--settings", "kept.toml", "--samples", "3"]).1, 9);
}

/// The command line over the file, the file over the scene.
#[test]
fn options_override_a_settings_file_and_it_the_scene() {
    let kept = "device = \"cpu\"\nprecision = \"fast\"\ntriangle = \"moller\"\nsamples = 2\nbounces = 3\n";
    let scene = SCENE.replace("size = [24, 18]", "size = [24, 18]\nsamples = 3\nbounces = 7");
    let place = Place::new(&[("scene.toml", &scene), ("kept.toml", kept), ("bounces.toml", "bounces = 1\n")]);
    let hashes = RefCell::new(Vec::new());
    let summary = |more: &[&str]| {
        let json = place.succeed(&[&["render", "scene.toml", "-o", "out.exr", "--json"], more].concat()).json();
        hashes.borrow_mut().push(json["film_hash"].to_string());
        ["samples", "bounces", "precision"].map(|key| json[key].to_string())
    };
    assert_eq!(summary(&["--device", "cpu"]), ["3", "7", "\"exact\""]);
    assert_eq!(summary(&["--settings", "kept.toml"]), ["2", "3", "\"fast\""]);
    assert_eq!(summary(&["--settings", "bounces.toml", "--device", "cpu"]), ["3", "1", "\"exact\""]);
    assert_eq!(summary(&["--settings", "kept.toml", "--samples", "1", "--bounces", "0"]), ["1", "0", "\"fast\""]);
    // Exact precision undoes the triangle test that is for fast precision alone. A CPU has neither.
    assert_eq!(summary(&["--settings", "kept.toml", "--precision", "exact"]), ["2", "3", "\"exact\""]);
    let hashes = hashes.into_inner();
    assert_eq!(hashes[1], hashes[4], "fast precision on a CPU is exact");
    assert_ne!(hashes[1], hashes[3], "other samples");
}

#[test]
fn bad_settings_files() {
    for (text, wants) in [
        ("", &["empty"][..]),
        ("precision = \"fats\"\n", &["kept.toml:1: ", "\"fats\"", "did you mean \"fast\"?"]),
        ("samples = 2\nprecison = \"fast\"\n", &["kept.toml:2: ", "unknown key \"precison\"", "\"precision\""]),
        ("size = [8, 8]\n", &["kept.toml:1: ", "unknown key \"size\"", "known are", "method"]),
        ("\nsamples = 0\n", &["kept.toml:2: ", "\"samples\" must be between 1 and 64"]),
        ("samples = 1.5\n", &["kept.toml:1: ", "whole number"]),
        ("bounces = 65536\n", &["kept.toml:1: ", "\"bounces\"", "65535"]),
        ("min_contribution = 1.5\n", &["kept.toml:1: ", "between 0 and 1"]),
        ("min_contribution = nan\n", &["kept.toml:1: ", "between 0 and 1"]),
        ("samples = 2\nspp = 4\n", &["kept.toml:2: ", "remove one"]),
        ("spp = 0\n", &["kept.toml:1: ", "\"spp\" must be between 1 and"]),
        ("integrator = \"paths\"\n", &["kept.toml:1: ", "\"paths\"", "did you mean \"path\"?"]),
        ("sampler = \"halton\"\n", &["kept.toml:1: ", "\"halton\"", "sobol"]),
        ("roulette = -1\n", &["kept.toml:1: ", "\"roulette\""]),
        ("clamp = inf\n", &["kept.toml:1: ", "\"clamp\""]),
        ("method = 3\n", &["kept.toml:1: ", "\"method\" must be a string"]),
        ("bvh = \"best\"\n", &["kept.toml:1: ", "unknown bvh \"best\"", "device, fast, high, medium"]),
        ("device = \"tpu\"\n", &["kept.toml:1: ", "\"tpu\"", "\"cpu\""]),
        ("layout = \"compact\"\ntriangle = \"moller\"\n", &["kept.toml:2: ", "precision = \"fast\""]),
        ("samples = 1\nsamples = 2\n", &["kept.toml:2: ", "duplicate"]),
        ("samples = \n", &["kept.toml:1: "]),
    ] {
        let place = Place::new(&[("scene.toml", SCENE), ("kept.toml", text)]);
        let render = ["render", "scene.toml", "--device", "cpu", "-o", "out.png", "--settings", "kept.toml"];
        place.refuse(&render, &[&["kept.toml"], wants].concat());
    }
    let place = Place::new(&[("scene.toml", SCENE)]);
    place.refuse(
        &["render", "scene.toml", "-o", "out.png", "--settings", "missing.toml"],
        &["missing.toml", "no such file"],
    );
}

#[test]
fn runs_that_can_not_be() {
    let place = Place::new(&[("scene.toml", SCENE), ("old.svg", "an older plot")]);
    for (more, wants) in [
        (&["-o", "trade.txt"][..], &["trade.txt", ".md", ".csv", ".json", ".svg"][..]),
        (&["-o", "missing/trade.svg"], &["missing/trade.svg", "folder does not exist"]),
        (&["-o", "old.svg", "--camera", "back"], &["\"back\"", "0 \"front\""]),
        (&["--save", "kept.toml"], &["--save", "--max-error", "--budget"]),
        (&["--save", "missing/kept.toml", "--budget", "1"], &["missing/kept.toml", "folder does not exist"]),
        (&["--save", "scene.toml", "--budget", "1"], &["scene.toml", "would replace the input"]),
        (&["--save", "old.svg", "--budget", "1"], &["old.svg", "not written by eyerays tradeoff", "--save"]),
        (&["--save", "new.md", "--budget", "1", "-o", "./new.md"], &["new.md", "same file as the output"]),
        (&["-o", "new.md", "-o", "new.svg", "-o", "./new.md"], &["new.md", "same file as the output"]),
        (&["--max-error", "0"], &["--max-error 0"]),
        (&["--max-error=-1"], &["--max-error -1"]),
        (&["--budget", "nan"], &["--budget NaN"]),
        (&["--samples", "1,65"], &["--samples 65"]),
        (&["--samples", "0"], &["--samples 0"]),
        (&["--bounces", "65536"], &["--bounces 65536"]),
        (&["--min-contribution", "0.5,2"], &["--min-contribution 2"]),
        (&["--spp", "4,0"], &["--spp 0"]),
        (&["--clamp", "1,nan"], &["--clamp NaN"]),
        (&["--roulette", "65536"], &["--roulette 65536"]),
        (&["--reference-spp", "1"], &["--reference-spp 1", "2 to"]),
        (&["--sampler", "regular", "--spp", "8"], &["scene.toml", "no grid of 8"]),
        (&["--triangle", "moller"], &["--triangle moller", "GPUs", "--device cpu"]),
        (&["--precision", "exact,fast"], &["--precision fast", "GPUs", "--device cpu"]),
        (&["--threads", "0"], &["--threads 0"]),
        (&["--adapter", "0"], &["--adapter", "--device cpu"]),
        (&["--size", "0x10"], &["0x10"]),
    ] {
        place.refuse(&[&["tradeoff", "scene.toml", "--device", "cpu"], more].concat(), wants);
    }
    place.refuse(&["tradeoff", "missing.toml", "-o", "old.svg"], &["missing.toml", "no such file"]);
    for more in [&["--repeat", "0"][..], &["--methods", "fastest"], &["--max-error", "1", "--budget", "1"]] {
        let outcome = place.run(&[&["tradeoff", "scene.toml", "--device", "cpu"], more].concat());
        assert_eq!(outcome.code, Some(2), "{more:?}");
        assert!(outcome.stdout.is_empty() && outcome.stderr.starts_with("error: "), "{}", outcome.stderr);
    }
}
