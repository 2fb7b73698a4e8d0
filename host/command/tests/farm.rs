//! Jobs for many machines, whose scripts are run here one by one.
#![cfg(unix)]

mod program;

use std::process::Command;

use program::{Outcome, Place, SCENE};

const OPTIONS: [&str; 6] = ["--device", "cpu", "--spp", "5", "--sampler", "sobol"];

/// Runs a script of a job as Slurm does: in the job's folder, and with the number of its task.
fn script(place: &Place, name: &str, part: u32) -> Outcome {
    let mut shell = Command::new("sh");
    shell.arg(name).current_dir(place.path("job")).env("SLURM_ARRAY_TASK_ID", part.to_string());
    shell.env("EYERAYS", env!("CARGO_BIN_EXE_eyerays")).output().expect("a shell").into()
}

fn farm(place: &Place, parts: &str, options: &[&str]) -> Outcome {
    place.run(&[&["farm", "a 'scene'.toml", "--parts", parts, "-o", "job", "--"], options].concat())
}

#[test]
fn the_scripts_of_a_job_make_the_picture_that_is_rendered_at_once() {
    for (parts, said) in [(3, "3 parts of the 5 samples of each pixel"), (7, "7 parts of the 18 rows")] {
        let place = Place::new(&[("a 'scene'.toml", SCENE)]);
        let outcome = farm(&place, &parts.to_string(), &OPTIONS);
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        assert!(outcome.stderr.starts_with(&format!("job: {said}; ")), "{}", outcome.stderr);
        std::fs::create_dir(place.path("job/parts")).unwrap();
        // The first is started again, in vain.
        for part in (0..parts).rev().chain([0]) {
            let done = script(&place, "slurm.sh", part);
            assert_eq!(done.code, Some(0), "part {part}: {}", done.stderr);
        }
        let merged = script(&place, "merge.sh", 0);
        assert_eq!(merged.code, Some(0), "{}", merged.stderr);
        place.succeed(&[&["render", "a 'scene'.toml", "-o", "whole.exr"], &OPTIONS[..]].concat());
        place.succeed(&["diff", "whole.exr", "job/a 'scene'.exr"]);
    }
}

#[test]
fn a_job_is_four_files_in_a_folder_of_its_own() {
    let place = Place::new(&[("a 'scene'.toml", SCENE)]);
    assert_eq!(farm(&place, "4", &OPTIONS).code, Some(0));
    let mut names: Vec<_> =
        std::fs::read_dir(place.path("job")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["job.yaml", "merge.sh", "slurm.sh", "submit.sh"]);
    for name in ["slurm.sh", "merge.sh", "submit.sh"] {
        let checked = Command::new("sh").arg("-n").arg(place.path("job").join(name)).status().unwrap();
        assert!(checked.success(), "{name}");
    }
    place.refuse(&["farm", "a 'scene'.toml", "--parts", "4", "-o", "job"], &["job: is not empty; name a new folder"]);
}

#[test]
fn options_that_render_would_refuse_are_refused_at_once() {
    let place = Place::new(&[("scene.toml", SCENE), ("file", "")]);
    let farm = ["farm", "scene.toml", "--parts", "2", "-o", "job"];
    for (more, wants) in [
        (&["--", "--sise", "1x1"][..], &["after --: ", "'--sise'", "eyerays render --help"][..]),
        (&["--", "--size", "big"], &["after --: ", "'big'"]),
        (&["--", "--size", "0x9"], &["0x9", "empty"]),
        (&["--", "--camera", "nosuch"], &["scene.toml: ", "\"nosuch\"", "0 \"front\""]),
        (&["--", "--no-passthrough"], &["--precision fast"]),
        (&["--", "--help"], &["eyerays render --help"]),
        (&["--", "-o", "a.exr"], &["--output is not for parts"]),
        (&["--", "--layers", "depth"], &["--layers: depth"]),
        (&["--", "--samples-from", "1"], &["--samples-from is not for parts"]),
        (&["--", "--tone", "agx"], &["--tone is not for parts", "add it to the merge"]),
        (&["--", "--settings", "fast.toml"], &["--settings is not for parts"]),
        (&["--picture", "sub/a.exr"], &["sub/a.exr: --picture is a file in the job's folder"]),
        (&["--picture", "a.jpg"], &["a.jpg", "\"jpg\""]),
        (&["--parts", "19", "--", "--spp", "4"], &["--parts 19", "4 samples", "18 rows", "at most 18"]),
        (&["--parts", "0"], &["--parts 0"]),
        (&["-o", "file"], &["file: is no folder"]),
        (&["-o", "missing/job"], &["missing/job: the folder does not exist"]),
    ] {
        let mut arguments = farm.to_vec();
        // An option is given once.
        if let Some(at) = more.first().and_then(|name| arguments.iter().position(|argument| argument == name)) {
            arguments.drain(at..at + 2);
        }
        arguments.extend(more);
        place.refuse(&arguments, wants);
    }
    place.refuse(&["farm", "-", "--parts", "2", "-o", "job"], &["standard input"]);
    place.refuse(&["farm", "missing.toml", "--parts", "2", "-o", "job"], &["missing.toml: there is no such file"]);
}
