//! `--noise`: pictures that end by themselves, in whatever parts, and what is refused.

mod program;

use program::{Outcome, Place, shipped};
use serde_json::Value;

/// Renders a small picture by the CPU.
fn render(place: &Place, more: &[&str]) -> Outcome {
    let scene = shipped("cornell_path");
    let fixed = ["render", &scene, "--device", "cpu", "--size", "40x36", "--bounces", "2", "--reproducible"];
    place.run(&[&fixed[..], more].concat())
}

fn done(place: &Place, more: &[&str]) -> Outcome {
    let outcome = render(place, more);
    assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
    outcome
}

fn told(place: &Place, more: &[&str]) -> Value {
    done(place, &[more, &["--json"]].concat()).json()
}

#[test]
fn a_picture_tells_what_noise_it_ended_by() {
    let place = Place::new(&[]);
    let json = told(&place, &["--noise", "0.1", "--spp", "256", "-o", "a.exr", "--layers", "error,samples"]);
    let spp = json["spp"].as_u64().unwrap();
    assert!((64..256).contains(&spp), "{spp}");
    assert_eq!((&json["noise_target"], &json["picture"]["noise_target"]), (&0.1.into(), &0.1.into()));
    assert_eq!(json["picture"]["identity"]["noise"], "0.1");
    let plain = told(&place, &["--spp", "64", "-o", "b.exr"]);
    assert!(plain["noise_target"].is_null() && plain["picture"]["noise_target"].is_null());
    let line = done(&place, &["--noise", "0.1", "--spp", "256", "-o", "c.exr"]).stderr;
    assert!(line.contains("asked for 10 % of what is seen"), "{line}");
    let exr = std::fs::read(place.path("c.exr")).unwrap();
    let text = b"\"noise_target\":0.1";
    assert!(exr.windows(text.len()).any(|bytes| bytes == text));
}

#[test]
fn tiles_merged_are_the_picture_and_holes_are_told() {
    let place = Place::new(&[]);
    let noise = ["--noise", "0.1", "--spp", "256"];
    done(&place, &[&noise[..], &["-o", "whole.exr"]].concat());
    done(&place, &[&noise[..], &["--tile", "0,0,16,36", "-o", "a.film"]].concat());
    done(&place, &[&noise[..], &["--tile", "16,0,24,36", "-o", "b.film"]].concat());
    let hole = place.run(&["merge", "a.film", "-o", "part.exr"]);
    assert_eq!(hole.code, Some(2), "{}", hole.stderr);
    assert!(hole.stderr.contains("16x36 pixels at 0,0 alone"), "{}", hole.stderr);
    place.succeed(&["merge", "b.film", "a.film", "-o", "merged.exr"]);
    assert_eq!(place.succeed(&["diff", "whole.exr", "merged.exr"]).code, Some(0));
    let twice = place.run(&["merge", "a.film", "b.film", "a.film", "-o", "merged.exr"]);
    assert!(twice.stderr.contains("both films have samples of the cell at 0,0"), "{}", twice.stderr);
    done(&place, &["--noise", "0.2", "--spp", "256", "--tile", "16,0,24,36", "-o", "c.film"]);
    let other = place.run(&["merge", "a.film", "c.film", "-o", "merged.exr"]);
    assert!(other.stderr.contains("noise"), "{}", other.stderr);
}

#[test]
fn a_film_that_is_kept_is_gone_on_with() {
    let place = Place::new(&[]);
    let film = ["--noise", "0.03", "--checkpoint", "a.film", "--resume"];
    let few = told(&place, &[&film[..], &["--spp", "96", "-o", "a.exr"]].concat());
    let more = told(&place, &[&film[..], &["--spp", "200", "-o", "a.exr"]].concat());
    let whole = told(&place, &["--noise", "0.03", "--spp", "200", "-o", "b.exr"]);
    assert!(few["spp"].as_u64() < more["spp"].as_u64(), "{few}");
    assert_eq!((&more["film_hash"], &more["spp"]), (&whole["film_hash"], &whole["spp"]));
    let again = told(&place, &[&film[..], &["--spp", "200", "-o", "c.exr"]].concat());
    assert_eq!(again["film_hash"], whole["film_hash"]);
    let other = render(&place, &["--noise", "0.04", "--checkpoint", "a.film", "--resume", "-o", "d.exr"]);
    assert!(other.code == Some(2) && other.stderr.contains("noise"), "{}", other.stderr);
    let plain = render(&place, &["--spp", "200", "--checkpoint", "a.film", "--resume", "-o", "d.exr"]);
    assert!(plain.code == Some(2) && plain.stderr.contains("noise"), "{}", plain.stderr);
}

#[test]
fn a_time_limit_ends_it_and_says_nothing_untrue() {
    let place = Place::new(&[]);
    let json = told(&place, &["--noise", "0.001", "--time-limit", "0.2", "-o", "a.exr"]);
    assert!(json["spp"].as_u64().unwrap() < 4096, "{json}");
}

#[test]
fn what_noise_can_not_decide_about_is_refused_in_a_line() {
    let place = Place::new(&[]);
    for (more, wanted) in [
        (&["--samples-from", "64"][..], "cannot be used with '--samples-from"),
        (&["--samples-to", "64"], "cannot be used with '--samples-to"),
        (&["--repeat", "3"], "cannot be used with '--repeat"),
        (&["--samples", "8"], "cannot be used with '--samples"),
        (&["--spp", "48"], "--spp 48: --noise decides after 64 samples"),
        (&["--tile", "8,0,16,20"], "use --tile 0,0,32,32"),
        (&["--exposure", "auto"], "give stops"),
        (&["--sampler", "jittered"], "--sampler sobol"),
    ] {
        let outcome = render(&place, &[&["--noise", "0.1", "-o", "a.png"], more].concat());
        assert!(outcome.code == Some(2) && outcome.stderr.contains(wanted), "{more:?}: {}", outcome.stderr);
        assert!(!place.path("a.png").exists());
    }
    let whitted = place.run(&["render", &shipped("cornell"), "--noise", "0.1", "-o", "a.png"]);
    assert!(whitted.code == Some(2) && whitted.stderr.contains("use --integrator path"), "{}", whitted.stderr);
    for noise in ["0", "2", "nan"] {
        let outcome = render(&place, &["--noise", noise, "-o", "a.png"]);
        assert!(outcome.code == Some(2) && outcome.stderr.contains("from 0.0005 to 1"), "{}", outcome.stderr);
    }
}
