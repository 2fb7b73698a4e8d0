//! `render --fireflies`.

mod program;

use eyerays::compare::compare;
use eyerays::image;
use eyerays::picture::Picture;
use program::{Place, SCENE, shipped};

/// A picture of the Cornell box by paths, whose balls gather light.
fn render(place: &Place, name: &str, more: &[&str]) -> Picture {
    let scene = shipped("cornell_path");
    let render = ["render", &scene, "--device", "cpu", "--size", "48x48", "--sampler", "sobol", "-o", name];
    place.succeed(&[&render[..], more].concat());
    image::read(&place.path(name)).unwrap()
}

/// Light that glass gathers is found by few samples, each of which is far too bright.
#[test]
fn pictures_are_nearer_to_what_they_come_to() {
    let place = Place::new(&[]);
    let wanted = render(&place, "wanted.exr", &["--spp", "4096", "--seed", "1"]);
    let error = |picture: &Picture| compare(picture, &wanted).unwrap().rmse;
    let plain = error(&render(&place, "plain.exr", &["--spp", "60"]));
    let without = error(&render(&place, "without.exr", &["--spp", "60", "--fireflies"]));
    assert!(without < 0.95 * plain, "{without} of {plain}");
}

#[test]
fn equal_samples_give_the_very_picture_and_files_say_how_they_were_made() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    // Rays of the corner show the background alone.
    let options = [
        "render",
        "scene.toml",
        "--device",
        "cpu",
        "--spp",
        "9",
        "--sampler",
        "sobol",
        "--integrator",
        "path",
        "--json",
        "--reproducible",
    ];
    for (name, more) in [("a.exr", &[][..]), ("b.exr", &["--fireflies=9"])] {
        place.succeed(&[&options[..], &["-o", name], more].concat());
    }
    let [plain, without] = ["a.exr", "b.exr"].map(|name| image::read(&place.path(name)).unwrap());
    assert_eq!(plain.pixels[0], without.pixels[0]);
    let said = std::fs::read(place.path("b.exr")).unwrap();
    let text = b"\"fireflies\":\"left out of 9 buckets\"";
    assert!(said.windows(text.len()).any(|part| part == text));
}

#[test]
fn what_makes_no_buckets_is_refused() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let scene = ["render", "scene.toml", "--device", "cpu"];
    let refuse = |more: &[&str], why: &str| place.refuse(&[&scene[..], more].concat(), &[why]);
    let path = ["--integrator", "path", "--sampler", "sobol", "--fireflies", "-o", "a.png"];
    refuse(
        &[&["--spp", "9"], &path[..]].concat(),
        "15 buckets take as many samples or more of a pixel, and there are 9",
    );
    refuse(&["--samples", "4", "--fireflies", "-o", "a.png"], "pictures of the integrator whitted have none");
    refuse(&["--fireflies", "-o", "a.film"], "are for pictures, not for films");
    for (count, why) in [("8", "not within 9 to 64"), ("many", "is no number of buckets")] {
        let refused = place.run(&[&scene[..], &[&format!("--fireflies={count}")]].concat());
        assert!(refused.code == Some(2) && refused.stderr.contains(why), "{}", refused.stderr);
    }
}
