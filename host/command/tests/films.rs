//! Films that are kept, gone on with and merged: whatever happened on the way, the picture is the one that was never disturbed.
#![cfg(target_os = "linux")]

mod program;

use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use program::{Outcome, Place, shipped};

/// Of some seconds, so that it can be killed.
const SPP: &str = "1500";

/// Renders with a film that is written all the time.
fn kept(place: &Place, more: &[&str]) -> Command {
    kept_in(place, "a.film", more)
}

fn kept_in(place: &Place, film: &str, more: &[&str]) -> Command {
    let scene = shipped("bleeding");
    let render = ["render", &scene, "--device", "cpu", "--size", "32x24", "--spp", SPP, "-o", "a.exr", "--json"];
    let keep = ["--checkpoint", film, "--checkpoint-every", "0.02", "--resume", "--reproducible"];
    let program = place.command(&[&render[..], &keep, more].concat());
    let mut command = Command::new("env");
    command.arg("--default-signal=HUP,INT,TERM").arg(program.get_program()).args(program.get_args());
    command.current_dir(place.path("")).env_remove("RUST_LOG");
    command
}

fn undisturbed(place: &Place) -> String {
    let outcome: Outcome = kept_in(place, "whole.film", &[]).output().unwrap().into();
    hash(&outcome)
}

fn hash(outcome: &Outcome) -> String {
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    outcome.json()["film_hash"].as_str().unwrap().to_owned()
}

fn kill(child: &mut Child, signal: &str) {
    // It may have ended by itself.
    Command::new("kill").args(["-s", signal, &child.id().to_string()]).stderr(Stdio::null()).status().unwrap();
    child.wait().unwrap();
}

/// How many samples a kept film has.
fn samples(place: &Place, film: &str) -> Option<u32> {
    if !place.path(film).exists() {
        return None;
    }
    let outcome = place.succeed(&["merge", film, "-o", "copy.film"]);
    let end = outcome.stderr.split(" to ").nth(1).and_then(|rest| rest.split(' ').next());
    Some(end.unwrap().parse().unwrap())
}

/// Fifty times, at any moment.
#[test]
fn a_rendering_that_is_killed_again_and_again_ends_with_the_bits_of_one_that_never_was() {
    let place = Place::new(&[]);
    let want = undisturbed(&place);
    let (mut seed, mut pictures) = (12_345u32, 0);
    for kills in 0..50 {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let before = samples(&place, "a.film");
        let mut child = kept(&place, &[]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        sleep(Duration::from_millis(u64::from(seed >> 16) % 300));
        kill(&mut child, if kills % 2 == 0 { "KILL" } else { "TERM" });
        let after = samples(&place, "a.film");
        assert!(after >= before, "nothing that was kept is lost: {before:?}, then {after:?}");
        if after == Some(1500) {
            assert_eq!(hash(&kept(&place, &[]).output().unwrap().into()), want);
            fs::remove_file(place.path("a.film")).unwrap();
            pictures += 1;
        }
    }
    assert_eq!(hash(&kept(&place, &[]).output().unwrap().into()), want, "after {pictures} other pictures");
}

#[test]
fn a_kept_film_that_is_cut_short_is_rendered_again_with_a_warning() {
    let place = Place::new(&[]);
    let want = undisturbed(&place);
    let whole = fs::read(place.path("whole.film")).unwrap();
    for length in [0, 7, 100, whole.len() / 2, whole.len() - 1] {
        fs::write(place.path("a.film"), &whole[..length]).unwrap();
        let outcome: Outcome = kept(&place, &[]).output().unwrap().into();
        assert!(
            outcome.stderr.contains("warning: a.film: ") && outcome.stderr.contains("first sample"),
            "{}",
            outcome.stderr
        );
        assert_eq!(hash(&outcome), want, "{length}");
    }
}

/// The system lets it write 8 KiB; the film takes more.
#[test]
fn a_disk_that_is_full_costs_no_picture_and_no_film_that_was_there() {
    let place = Place::new(&[]);
    let want = undisturbed(&place);
    let render = kept(&place, &["--samples-to", "40"]);
    let few: Outcome = Command::new("env").args(render.get_args()).current_dir(place.path("")).output().unwrap().into();
    assert_eq!(few.code, Some(0), "{}", few.stderr);
    let old = fs::read(place.path("a.film")).unwrap();
    let render = kept(&place, &[]);
    let mut limited = Command::new("bash");
    limited.args(["-c", "ulimit -f 8; exec env \"$@\"", "bash"]).args(render.get_args()).current_dir(place.path(""));
    let outcome: Outcome = limited.output().unwrap().into();
    assert_eq!(outcome.code, Some(2), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("a.film") && outcome.stderr.contains("ulimit -f"), "{}", outcome.stderr);
    assert_eq!(fs::read(place.path("a.film")).unwrap(), old, "the film that was there is not hurt");
    assert_eq!(hash(&kept(&place, &[]).output().unwrap().into()), want);
}

/// The name that a film has by itself is another than one that somebody gave.
#[test]
fn a_film_that_somebody_keeps_stays_where_it_is() {
    let place = Place::new(&[]);
    let scene = shipped("bleeding");
    let render = ["render", &scene, "--device", "cpu", "--size", "32x24", "--spp", "4", "-o", "a.png", "-q"];
    for film in ["a.film", "a.png.film"] {
        place.succeed(&[&render[..], &["--checkpoint", film]].concat());
        place.refuse(&[&render[..], &["--checkpoint", film]].concat(), &[film, "--resume"]);
        place.succeed(&render);
        assert_eq!(
            place.names(),
            [film, "a.png"]
                .map(str::to_owned)
                .iter()
                .cloned()
                .collect::<std::collections::BTreeSet<_>>()
                .into_iter()
                .collect::<Vec<_>>()
        );
        fs::remove_file(place.path(film)).unwrap();
    }
}

#[test]
fn more_samples_are_added_to_those_that_there_are() {
    let place = Place::new(&[]);
    let scene = shipped("bleeding");
    let render = |more: &[&str]| {
        let render = ["render", &scene, "--device", "cpu", "--size", "32x24", "-o", "a.png", "--json"];
        place.succeed(&[&render[..], more].concat()).json()
    };
    let keep = |spp| render(&["--spp", spp, "--checkpoint", "a.film", "--resume"]);
    let (few, more) = (keep("8"), keep("32"));
    assert_eq!(more["film_hash"], render(&["--spp", "32"])["film_hash"]);
    assert_ne!(more["film_hash"], few["film_hash"]);
    assert_eq!(more["picture"]["samples"], 32);
    // There are more than enough.
    let outcome = place.run(&[
        "render",
        &scene,
        "--device",
        "cpu",
        "--size",
        "32x24",
        "--spp",
        "8",
        "-o",
        "a.png",
        "--checkpoint",
        "a.film",
        "--resume",
    ]);
    assert_eq!(outcome.code, Some(2), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("a.film: ") && outcome.stderr.contains("32"), "{}", outcome.stderr);
}

#[test]
fn films_of_other_pictures_are_refused_with_what_differs() {
    let place = Place::new(&[]);
    let scene = shipped("bleeding");
    let render = ["render", &scene, "--device", "cpu", "--size", "16x12", "--spp", "4", "-o"];
    let film = |name: &str, more: &[&str]| drop(place.succeed(&[&render[..], &[name], more].concat()));
    film("a.film", &["--samples-to", "2"]);
    film("b.film", &["--samples-from", "2", "--seed", "7"]);
    film("c.film", &["--samples-from", "2", "--tile", "0,0,16,5"]);
    place.refuse(&["merge", "a.film", "b.film", "-o", "p.png"], &["b.film: ", "seed is 0", "7"]);
    place.refuse(&["merge", "a.film", "a.film", "-o", "p.png"], &["a.film: ", "samples 0 to 2"]);
    place.refuse(
        &["merge", "a.film", "c.film", "-o", "p.png"],
        &["1 hole", "samples 2 to 4 of the 16x7 pixels at 0,5", "--part"],
    );
    place.refuse(&["merge", "a.film", "none.film", "-o", "p.png"], &["none.film: ", "no such file"]);
    place.refuse(&["merge", &scene, "-o", "p.png"], &["no film"]);
    let on = |more: [&'static str; 2]| {
        let go_on = ["p.png", "--checkpoint", "a.film", "--resume"];
        [&render[..], &go_on, &more].concat().into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    place.refuse(&on(["--bounces", "1"]), &["a.film: ", "bounces"]);
    place.refuse(&on(["--tile", "1,2,16,3"]), &["--tile 1,2,16,3", "16x12"]);
    place.refuse(&on(["--samples-from", "4"]), &["--samples-from 4", "0 to 4", "--spp"]);
    film("d.film", &["--samples-from", "2"]);
    place.refuse(&["merge", "d.film", "-o", "p.exr"], &["samples 0 to 2"]);
    film("tile.film", &["--tile", "0,0,16,5"]);
    place.refuse(&["merge", "tile.film", "-o", "p.exr"], &["samples 0 to 4 of the 16x7 pixels at 0,5"]);
    place.succeed(&["merge", "tile.film", "-o", "tile.exr", "--part"]);
    // A tile is gone on with to the whole image.
    place.succeed(&[&render[..], &["t.exr", "--checkpoint", "tile.film", "--resume"]].concat());
    place.succeed(&["merge", "d.film", "a.film", "-o", "p.exr"]);
    place.succeed(&["diff", "p.exr", "t.exr"]);
    place.succeed(&[&render[..], &["q.exr"]].concat());
    place.succeed(&["diff", "p.exr", "q.exr"]);
}

/// One device is a CPU, the other any GPU.
#[test]
fn parts_of_different_devices_are_one_picture() {
    if !program::has_gpu() {
        return;
    }
    let place = Place::new(&[]);
    let scene = shipped("whitted");
    let render = |device: &str, name: &str, more: &[&str]| {
        let render = ["render", &scene, "--size", "40x30", "--samples", "2", "--device", device, "-o", name];
        place.succeed(&[&render[..], more].concat());
    };
    render("gpu", "a.film", &["--tile", "0,0,40,13"]);
    render("cpu", "b.film", &["--tile", "0,13,40,17", "--samples-to", "3"]);
    render("gpu", "c.film", &["--tile", "0,13,40,17", "--samples-from", "3"]);
    place.succeed(&["merge", "c.film", "a.film", "b.film", "-o", "p.exr"]);
    render("cpu", "q.exr", &[]);
    place.succeed(&["diff", "p.exr", "q.exr"]);
}

/// Whatever each of them did of it.
#[test]
fn several_devices_render_the_picture_of_one() {
    if !program::has_gpu() {
        return;
    }
    let place = Place::new(&[]);
    for (scene, more) in [("whitted", &["--samples", "2"][..]), ("lights", &["--spp", "40", "--sampler", "sobol"])] {
        let scene = shipped(scene);
        let render = |device: &str, name: &str| {
            let render = ["render", &scene, "--size", "70x90", "-o", name, "--json", "--device", device];
            place.succeed(&[&render[..], more].concat()).json()
        };
        let (both, one) = (render("gpu:0,cpu", "p.exr"), render("cpu", "q.exr"));
        assert!(both["device"].as_str().unwrap().contains(" + CPU ("), "{both}");
        assert_eq!((&both["film_hash"], &both["rays"]), (&one["film_hash"], &one["rays"]));
    }
    place.refuse(&["render", &shipped("whitted"), "--device", "cpu,cpu"], &["twice"]);
    place.refuse(
        &["render", &shipped("whitted"), "--device", "gpu:0,cpu", "--precision", "fast"],
        &["exact precision only"],
    );
}
