//! Pictures are the same bits everywhere: on this machine as when the README's were made, and on another platform.

mod program;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use eyerays::image;
use program::{Outcome, Place, shipped};
use serde::Deserialize;

/// A picture of `docs/pictures.toml`.
#[derive(Deserialize)]
struct Picture {
    scene: String,
    options: Vec<String>,
    film_hash: String,
}

fn docs(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(name)
}

/// `write` makes the pictures and their hashes anew, instead of comparing them.
const PICTURES: &str = "EYERAYS_PICTURES";

#[test]
fn pictures_of_the_readme_and_the_gallery_are_what_the_program_renders() {
    let text = fs::read_to_string(docs("pictures.toml")).unwrap();
    let pictures: BTreeMap<String, Picture> = toml::from_str(&text).unwrap();
    let [readme, others @ ..] =
        ["../README.md", "gallery.md", "product-shot.md"].map(|page| fs::read_to_string(docs(page)).unwrap());
    let is_in = |name: &str| others.iter().any(|page| page.contains(&format!("]({name})")));
    let is_shown = |name: &str| readme.contains(&format!("](docs/{name})")) || is_in(name);
    assert!(pictures.len() == 21 && pictures.keys().all(|name| is_shown(name)));
    let writes = std::env::var(PICTURES).is_ok_and(|value| value == "write");
    let (place, mut renewed) = (Place::new(&[]), text.clone());
    for (name, Picture { scene, options, film_hash }) in &pictures {
        let scene = docs("..").join(scene);
        let mut arguments = vec!["render".into(), scene.into_os_string(), "-o".into(), name.into(), "--json".into()];
        arguments.push("--reproducible".into());
        arguments.extend(options.iter().map(Into::into));
        let found = place.succeed(&arguments).json()["film_hash"].as_str().expect("a text").to_owned();
        if writes {
            fs::copy(place.path(name), docs(name)).unwrap();
            renewed = renewed.replace(film_hash, &found);
            continue;
        }
        assert_eq!(found, *film_hash, "{name}: another picture; if it should be, {PICTURES}=write makes it again");
        let [now, then] = [place.path(name), docs(name)].map(|path| image::read(&path).unwrap());
        assert!(now.bits_equal(&then), "docs/{name} is another picture; {PICTURES}=write makes it again");
    }
    if renewed != text {
        fs::write(docs("pictures.toml"), renewed).unwrap();
    }
}

/// A command line that runs this program as built for another platform, such as `qemu-aarch64 -L DIR eyerays`.
const FOREIGN: &str = "EYERAYS_FOREIGN";

#[test]
fn another_platform_gives_the_same_pictures_and_files() {
    let Ok(foreign) = std::env::var(FOREIGN) else {
        eprintln!("skipped: {FOREIGN} names no program");
        return;
    };
    let foreign: Vec<&str> = foreign.split_whitespace().collect();
    let place = Place::new(&[("turned.toml", TURNED)]);
    let framed = shipped("rod").replace(".toml", ".obj");
    for (scene, format, tone) in [
        (shipped("cornell"), "png", "agx"),
        (shipped("glass"), "exr", "none"),
        (framed, "hdr", "none"),
        ("turned.toml".to_owned(), "png", "none"),
        ("turned.toml".to_owned(), "png", "neutral"),
    ] {
        let render = |name: &str, mut program: Command| {
            let name = format!("{name}.{format}");
            program.args(["render", &scene, "-o", &name, "--json"]).current_dir(place.path(""));
            // An emulator is slow.
            program.args(["--size", "24x16", "--samples", "1", "--device", "cpu", "--exposure", "0.3", "--tone", tone]);
            program.arg("--reproducible");
            let outcome: Outcome = program.output().expect("the program starts").into();
            assert_eq!(outcome.code, Some(0), "{program:?}: {}", outcome.stderr);
            (outcome.json()["film_hash"].take(), fs::read(place.path(&name)).unwrap())
        };
        let mut other = Command::new(foreign[0]);
        other.args(&foreign[1..]);
        let (here, there) = (render("here", place.command::<&str>(&[])), render("there", other));
        assert_eq!(here.0, there.0, "{scene}: the pictures differ");
        assert!(here.1 == there.1, "{scene}: the {format} files differ");
    }
}

/// A camera, a spot and a mesh whose numbers take sines.
const TURNED: &str = "\
[[camera]]
name = \"front\"
eye = [0, 1, 4]
target = [0, 0, 0]
fov = 37.0

[[light]]
kind = \"spot\"
position = [2, 3, 4]
target = [0, 0, 0]
angle = 31.0
softness = 0.3

[[mesh]]
shape = \"box\"
min = [-1, -1, -1]
max = [1, 1, 1]
rotate = [11.0, 23.0, 47.0]
";
