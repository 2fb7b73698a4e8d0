//! What `bench` measures, prints and writes.

mod program;

use std::collections::HashMap;
use std::fs;

use program::{Place, SCENE, has_gpu, shipped};

#[test]
fn bench_measures_every_method_and_all_answer_alike() {
    let place = Place::new(&[]);
    let cornell = shipped("cornell");
    let quick = ["bench", &cornell, "--quick", "--device", "cpu", "--size", "48x48", "--repeat", "1"];
    let outcome = place.succeed(&[&quick[..], &["--format", "json"]].concat());
    assert!(outcome.stderr.is_empty(), "{}", outcome.stderr);
    let json = outcome.json();
    assert_eq!((&json["scenes"][0]["scene"], &json["views"][0]["view"]), (&"cornell".into(), &"front".into()));
    assert!(json["faults"].as_array().is_some_and(Vec::is_empty) && json["views"][0]["hash"].is_string());
    let records = json["records"].as_array().unwrap();
    assert_eq!(records.len(), 6 * 9);
    let mut hashes = HashMap::new();
    for record in records {
        assert!(record["mrays_per_s"].as_f64().is_some_and(|x| x > 0.0), "{record}");
        let of_kind = hashes.entry(record["kind"].to_string()).or_insert_with(|| record["hash"].clone());
        assert_eq!(*of_kind, record["hash"], "{record}");
    }
    for (file, start) in [("a.md", "## Setup"), ("a.csv", "scene,view,kind,"), ("a.json", "{")] {
        let outcome =
            place.succeed(&[&quick[..], &["--kinds", "ao,primary", "--methods", "wide", "-o", file]].concat());
        assert!(outcome.stdout.is_empty());
        assert!(fs::read_to_string(place.path(file)).unwrap().starts_with(start), "{file}");
    }
    assert_eq!(fs::read_to_string(place.path("a.csv")).unwrap().lines().count(), 3);
    assert_eq!(place.names(), ["a.csv", "a.json", "a.md"]);
}

#[test]
fn bench_says_what_it_leaves_out() {
    let place = Place::new(&[("scene.toml", &format!("light = []\n{SCENE}"))]);
    let quick = ["bench", "scene.toml", "--quick", "--device", "cpu", "--size", "16x16", "--methods", "auto"];
    let outcome = place.succeed(&quick);
    assert_eq!(outcome.stderr, "note: scene front: there are no shadow rays\n");
    assert!(outcome.text().contains(" * | "), "{}", outcome.text());
    assert!(place.succeed(&[&quick[..], &["-q"]].concat()).stderr.is_empty());
}

#[test]
fn bench_measures_gpu_and_cpu_over_the_same_rays() {
    if !has_gpu() {
        return;
    }
    let place = Place::new(&[("scene.toml", SCENE)]);
    let ways = ["--methods", "if-if,wide,packet", "--scheduling", "grid,persistent", "--layout", "gathered,compact"];
    let what = ["bench", "scene.toml", "--device", "both", "--precision", "exact,fast", "--size", "24x24"];
    let json = place.succeed(&[&what[..], &ways, &["--repeat", "2", "--format", "json"]].concat()).json();
    let records = json["records"].as_array().unwrap();
    let of = |key: &str, value: &str| records.iter().filter(|r| r[key] == value).count();
    assert_eq!((of("processor", "cpu"), of("precision", "fast")), (6 * 3 * 2, 6 * 5 * 2));
    assert_eq!((of("scheduling", "persistent"), records.len()), (6 * 2 * 2 * 2, 6 * (3 + 5 + 5) * 2));
}
