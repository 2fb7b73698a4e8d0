//! docs/product-shot.md, as somebody follows it: every command, in its order.

mod program;

use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use eyerays::image;
use program::{Place, opacity};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The blocks of a language that a page has.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let start = format!("```{language}\n");
    page.split(&start).skip(1).map(|rest| rest.split("```").next().unwrap().to_owned()).collect()
}

/// What a command is run with here: a small picture of few samples, by the CPU.
fn quick(line: &str) -> Vec<String> {
    let words: Vec<&str> = line.split_whitespace().skip(1).collect();
    let mut quick: Vec<String> = Vec::new();
    for (word, before) in words.iter().zip([""].iter().chain(&words)) {
        quick.push(match *before {
            "--spp" => "8".to_owned(),
            "--size" => "60x45".to_owned(),
            // Of a picture an eighth as large.
            "--focus-on" => "17,18".to_owned(),
            _ => (*word).to_owned(),
        });
    }
    if words[0] == "render" {
        quick.extend(["--device", "cpu"].map(str::to_owned));
        if !words.contains(&"--size") {
            quick.extend(["--size", "60x45"].map(str::to_owned));
        }
    }
    quick
}

#[test]
fn the_page_of_a_product_shot_works_as_it_is_written() {
    let page = fs::read_to_string(root().join("docs/product-shot.md")).unwrap();
    let scene = fs::read_to_string(root().join("scenes/shot.toml")).unwrap();
    let written = blocks(&page, "toml");
    assert!(written.len() == 1 && scene.ends_with(&written[0]), "scenes/shot.toml is another scene than the page's");
    let place = Place::new(&[("shot.toml", &written[0])]);
    fs::copy(root().join("scenes/chess.glb"), place.path("chess.glb")).unwrap();
    let commands: Vec<String> =
        blocks(&page, "sh").iter().flat_map(|block| block.lines().map(str::to_owned).collect::<Vec<_>>()).collect();
    assert!(commands.len() >= 8 && commands.iter().all(|line| line.starts_with("eyerays ")), "{commands:?}");
    for line in &commands {
        place.succeed(&quick(line));
    }
    place.succeed(&["check", "start.toml"]);

    // The model is opaque, its surroundings are clear, and its shadow is between.
    let opacity = opacity(&place.path("shot.png"));
    let share = |of: RangeInclusive<u8>| {
        opacity.iter().filter(|&alpha| of.contains(alpha)).count() as f64 / opacity.len() as f64
    };
    let [opaque, clear, between] = [share(255..=255), share(0..=5), share(25..=230)];
    assert!(opaque > 0.4 && clear > 0.02 && between > 0.02, "{opaque} {clear} {between}");
    for layer in ["albedo", "normal", "depth", "direct", "indirect", "noisy"] {
        image::read_layer(&place.path("shot.exr"), layer).unwrap_or_else(|error| panic!("{error}"));
    }
    assert!(["try.png", "glass.png", "sharp.png", "later.png"].iter().all(|name| place.path(name).is_file()));
}
