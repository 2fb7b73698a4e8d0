//! What `render` and `diff` print, write and return when all is well.

mod program;

use std::fs;

use eyerays::image;
use program::{Place, SCENE, TRIANGLE, has_gpu, shipped};

const PNG_END: &[u8] = b"\0\0\0\0IEND\xae\x42\x60\x82";

#[test]
fn a_cornell_box_is_on_disk() {
    let place = Place::new(&[]);
    let outcome = place.succeed(&["render", &shipped("cornell"), "-o", "cornell.png", "--device", "cpu"]);
    let picture = image::read(&place.path("cornell.png")).unwrap();
    assert_eq!((picture.width, picture.height), (512, 512));
    // A red wall to the left and a green one to the right.
    let [left, right] = [60, 451].map(|x| picture.pixel(x, 256).unwrap());
    assert!(left[0] > 2.0 * left[1] && right[1] > 2.0 * right[0], "{left:?} {right:?}");
    assert_eq!(place.names(), ["cornell.png"]);
    let summary = outcome.stderr.strip_suffix('\n').unwrap();
    assert!(!summary.contains('\n'), "{summary}");
    for part in [
        "512x512",
        "exact",
        "CPU",
        "--device cpu",
        "262144 primary",
        "Mrays/s",
        "read",
        "build",
        "prepare",
        "render",
        "write",
        "0 non-finite pixels",
    ] {
        assert!(summary.contains(part), "{part}: {summary}");
    }
    assert!(outcome.stdout.is_empty());
}

#[test]
fn a_bare_mesh_is_framed_lit_and_coloured() {
    let mesh = format!("mtllib mesh.mtl\nusemtl red\n{TRIANGLE}");
    let place = Place::new(&[("mesh.obj", &mesh), ("mesh.mtl", "newmtl red\nKd 1 0 0\nmap_Kd red.png\n")]);
    let outcome = place.succeed(&["render", "mesh.obj", "--device", "cpu", "--size", "33x33"]);
    assert_eq!(place.names(), ["mesh.mtl", "mesh.obj", "mesh.png"]);
    let [warning, summary] = outcome.stderr.lines().collect::<Vec<_>>()[..] else { panic!("{}", outcome.stderr) };
    assert!(warning.starts_with("warning: ") && warning.contains("mesh.mtl") && warning.contains("map_Kd"));
    assert!(summary.starts_with("mesh.png: 33x33"), "{summary}");
    let picture = image::read(&place.path("mesh.png")).unwrap();
    assert!(picture.pixels.iter().any(|&[r, g, b]| r > 0.1 && g == 0.0 && b == 0.0), "there is no red");
}

#[test]
fn the_largest_coordinates_render() {
    let mesh = "v -1e38 0 0\nv 1e38 0 0\nv 0 1e38 0\nf 1 2 3\n";
    let place = Place::new(&[("large.obj", mesh), ("small.obj", &mesh.replace("e38", ""))]);
    for name in ["large", "small"] {
        let scene = format!("{name}.obj");
        let outcome = place.succeed(&["render", &scene, "--device", "cpu", "--size", "41x41"]);
        assert!(outcome.stderr.contains("0 non-finite pixels"));
    }
    place.succeed(&["diff", "large.png", "small.png", "--tolerance", "0.02"]);
}

#[test]
fn a_dash_writes_a_picture_to_standard_output_and_nothing_else() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let outcome = place.succeed(&["render", "scene.toml", "--device", "cpu", "-o", "-"]);
    let picture = image::decode(std::io::Cursor::new(&outcome.stdout)).unwrap();
    assert_eq!((picture.width, picture.height), (24, 18));
    assert!(outcome.stdout.ends_with(PNG_END));
    assert_eq!(place.names(), ["scene.toml"]);
    assert!(outcome.stderr.starts_with("standard output: 24x18"), "{}", outcome.stderr);
}

#[test]
fn quiet_says_nothing() {
    let mesh = format!("mtllib missing.mtl\n{TRIANGLE}");
    let place = Place::new(&[("mesh.obj", &mesh), ("scene.toml", SCENE)]);
    for arguments in [
        &["render", "mesh.obj", "-o", "a.png", "-q", "--device", "cpu"][..],
        &["render", "mesh.obj", "-o", "b.png", "--quiet"],
        &["diff", "a.png", "b.png", "-q"],
        &["check", "mesh.obj", "-q"],
    ] {
        let outcome = place.succeed(arguments);
        assert!(outcome.stdout.is_empty() && outcome.stderr.is_empty(), "{arguments:?}: {}", outcome.stderr);
    }
}

#[test]
fn json_tells_everything_of_a_rendering() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let outcome =
        place.succeed(&["render", "scene.toml", "--device", "cpu", "-o", "out.png", "--json", "--samples", "2"]);
    let json = outcome.json();
    assert!(outcome.stderr.is_empty(), "{}", outcome.stderr);
    assert_eq!((&json["width"], &json["height"], &json["samples"]), (&24.into(), &18.into(), &2.into()));
    assert_eq!((&json["output"], &json["precision"]), (&"out.png".into(), &"exact".into()));
    assert_eq!((&json["why"], &json["primitives"], &json["bounces"]), (&"--device cpu".into(), &80.into(), &5.into()));
    assert!(json["device"].as_str().unwrap().starts_with("CPU ("));
    assert_eq!(json["sampler"], "regular");
    place.succeed(&["render", "scene.toml", "--device", "cpu", "-o", "out.exr", "--samples", "2"]);
    assert_eq!(json["film_hash"], image::read(&place.path("out.exr")).unwrap().hash());
    let rays = &json["rays"];
    assert_eq!((&rays["primary"], &rays["secondary"]), (&(24 * 18 * 4).into(), &0.into()));
    assert!(rays["shadow"].as_u64().unwrap() > 0);
    assert_eq!(rays["non_finite_pixels"], 0);
    for time in ["mrays_per_second", "read_ms", "build_ms", "prepare_ms", "render_ms", "write_ms"] {
        assert!(json[time].as_f64().is_some_and(|ms| ms > 0.0), "{time}: {json}");
    }
    assert!(json.as_object().unwrap().contains_key("device_ms") && json["device_ms"].is_null());
}

/// `auto` never takes a software adapter, and says so.
#[test]
fn auto_says_which_device_ran_and_why() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let adapters = place.succeed(&["info", "--json"]).json()["adapters"].take();
    let best = adapters.as_array().unwrap().first();
    let outcome = place.succeed(&["render", "scene.toml", "-o", "out.png"]);
    let (device, why) = match best {
        None => ("on CPU (", "there is no GPU"),
        Some(best) if best["kind"] == "software" => ("on CPU (", "is software, which --device gpu takes"),
        Some(best) => (best["name"].as_str().unwrap(), "a GPU that works"),
    };
    assert!(outcome.stderr.contains(device) && outcome.stderr.contains(why), "{}", outcome.stderr);
}

#[test]
fn the_gpu_is_taken_when_asked_for() {
    if !has_gpu() {
        return;
    }
    let place = Place::new(&[("scene.toml", SCENE)]);
    let json = place.succeed(&["render", "scene.toml", "-o", "a.exr", "--device", "gpu", "--json"]).json();
    let adapters = place.succeed(&["info", "--json"]).json()["adapters"].take();
    assert!(json["device"].as_str().unwrap().contains(adapters[0]["name"].as_str().unwrap()), "{json}");
    assert_eq!(json["why"], "--device gpu");
    place.succeed(&["render", "scene.toml", "-o", "b.exr", "--device", "cpu"]);
    assert!(place.succeed(&["diff", "a.exr", "b.exr"]).text().contains("equal in every bit  yes"));
    let naga = ["render", "scene.toml", "-o", "c.exr", "--device", "gpu", "--precision", "fast", "--no-passthrough"];
    assert!(place.succeed(&naga).stderr.contains("through naga"));
    let outcome = place.succeed(&["diff", "scene.toml", "--json"]).json();
    assert_eq!(outcome["comparison"]["bit_equal"], true);
    assert_eq!(outcome["comparison"]["differing_pixels"], 0);
}

#[test]
fn every_format_is_written_and_read_again() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let render = |output: &str, more: &[&str]| {
        place.succeed(&[&["render", "scene.toml", "--device", "cpu", "-o", output], more].concat());
    };
    render("a.exr", &[]);
    render("b.exr", &["--threads", "3", "--bvh", "high"]);
    render("a.hdr", &[]);
    render("a.png", &[]);
    render("b.PNG", &["--bits", "16"]);
    render("bright.exr", &["--exposure", "1"]);
    render("half.exr", &["--half"]);
    assert!(place.succeed(&["diff", "a.exr", "b.exr"]).text().contains("differing pixels    0 of 432"));
    place.succeed(&["diff", "a.exr", "a.hdr", "--tolerance", "0.02"]);
    place.succeed(&["diff", "a.exr", "half.exr", "--tolerance", "0.0005"]);
    assert_eq!(place.run(&["diff", "a.exr", "half.exr"]).code, Some(1));
    place.succeed(&["diff", "a.exr", "a.png", "--tolerance", "0.01"]);
    place.succeed(&["diff", "a.exr", "b.PNG", "--tolerance", "0.0001"]);
    let [dark, bright] = ["a.exr", "bright.exr"].map(|name| image::read(&place.path(name)).unwrap());
    assert!(dark.pixels.iter().flatten().zip(bright.pixels.iter().flatten()).all(|(a, b)| 2.0 * a == *b));
}

#[test]
fn tone_maps_find_a_place_for_what_is_brighter_than_white() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let render = |output: &str, more: &[&str]| rendered(&place, output, &[&["--exposure", "4"], more].concat());
    let cut_off = render("a.png", &[]);
    assert_eq!(cut_off, render("b.png", &["--tone", "none"]));
    render("c.exr", &["--tone", "none"]);
    let whites = |name: &str| image::read(&place.path(name)).unwrap().pixels.iter().filter(|&&p| p == [1.0; 3]).count();
    let before = whites("a.png");
    for tone in ["neutral", "agx"] {
        let name = format!("{tone}.png");
        assert_ne!(cut_off, render(&name, &["--tone", tone, "--bits", "16"]));
        assert!(whites(&name) < before, "{tone}: {} of {before}", whites(&name));
    }
}

/// Light is balanced wherever it is, and what is no light is not; nor are films, which their merge balances.
#[test]
fn the_light_that_is_asked_for_looks_white() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let layers = ["--layers", "albedo,direct"];
    rendered(&place, "plain.exr", &layers);
    rendered(&place, "warm.exr", &[&layers[..], &["--white-balance", "2900K"]].concat());
    rendered(&place, "a.film", &["--white-balance", "2900"]);
    place.succeed(&["merge", "a.film", "--white-balance", "2900", "-o", "merged.exr"]);
    let white = image::WhiteBalance::of(2900.0).unwrap();
    let light = |file: &str, layer: Option<&str>| match layer {
        Some(layer) => image::read_layer(&place.path(file), layer).unwrap().pixels,
        None => image::read(&place.path(file)).unwrap().pixels,
    };
    for layer in [None, Some("direct")] {
        let balanced: Vec<[f32; 3]> = light("plain.exr", layer).into_iter().map(|pixel| white.apply(pixel)).collect();
        assert!(balanced == light("warm.exr", layer) && balanced != light("plain.exr", layer), "{layer:?}");
    }
    assert_eq!(light("warm.exr", Some("albedo")), light("plain.exr", Some("albedo")));
    assert_eq!(light("merged.exr", None), light("warm.exr", None));
    for (kelvins, why) in [("100", "1700 to 25000"), ("warm", "no temperature; give kelvins"), ("nan", "1700 to 25000")]
    {
        let refused = place.run(&["render", "scene.toml", "--white-balance", kelvins]);
        assert!(refused.code == Some(2) && refused.stderr.contains(why), "{kelvins}: {}", refused.stderr);
    }
}

/// The bytes of a picture of the scene.
fn rendered(place: &Place, output: &str, options: &[&str]) -> Vec<u8> {
    place.succeed(&[&["render", "scene.toml", "--device", "cpu", "--reproducible", "-o", output], options].concat());
    fs::read(place.path(output)).unwrap()
}

#[test]
fn layers_lie_beside_the_picture_in_one_file() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let render = |output: &str, more: &[&str]| rendered(&place, output, &[&["--samples", "2"], more].concat());
    render("plain.exr", &[]);
    let bytes = render("layers.exr", &["--layers", "depth,normal,object,colour,depth"]);
    // A header names its channels, each with a zero byte.
    let has = |name: &str| bytes.windows(name.len()).any(|window| window == name.as_bytes());
    assert!(["depth.Z\0", "normal.X\0", "object.id\0", "R\0"].into_iter().all(has));
    assert!(!has("albedo.R\0"));
    let [plain, layered] = ["plain.exr", "layers.exr"].map(|name| image::read(&place.path(name)).unwrap());
    assert!(plain.bits_equal(&layered));
    assert_eq!(bytes, render("again.exr", &["--layers", "normal,object,depth", "--threads", "1"]));
}

/// The picture replaces what was shown first, and has its own bits. Standard output can't take back what it was given.
#[test]
fn a_preview_changes_nothing_of_the_picture() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let render = |output: &str, more: &[&str]| rendered(&place, output, &[&["--samples", "2"], more].concat());
    assert_eq!(render("plain.png", &[]), render("after.png", &["--preview"]));
    place.refuse(&["render", "scene.toml", "--device", "cpu", "--preview", "-o", "-"], &["--preview", "--output"]);
}

#[test]
fn the_summary_tells_what_layers_took_where_there_are_any() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let render = ["render", "scene.toml", "--device", "cpu", "-o", "out.exr"];
    let with = |more: &[&str]| place.succeed(&[&render[..], more].concat());
    assert!(!with(&[]).stderr.contains("layers"));
    assert!(with(&["--json"]).json()["layers_ms"].is_null());
    let said = with(&["--layers", "normal"]).stderr;
    assert!(said.contains("s, layers ") && said.contains("s, write "), "{said}");
    assert!(with(&["--layers", "normal", "--json"]).json()["layers_ms"].as_f64().is_some_and(|ms| ms > 0.0));
}

#[test]
fn diff_returns_what_it_found() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    for (name, eye) in [("a.exr", "0,0,4"), ("b.exr", "0,0,4"), ("c.exr", "0,0.2,4")] {
        place.succeed(&["render", "scene.toml", "--device", "cpu", "-o", name, "--eye", eye, "--target", "0,0,0"]);
    }
    assert_eq!(place.run(&["diff", "a.exr", "b.exr"]).code, Some(0));
    let different = place.run(&["diff", "a.exr", "c.exr", "-o", "map.png"]);
    assert_eq!(different.code, Some(1), "{}", different.stderr);
    for line in ["equal in every bit  no", "largest ulps", "largest difference", "RMSE", "PSNR"] {
        assert!(different.text().contains(line), "{}", different.text());
    }
    assert_eq!(image::read(&place.path("map.png")).unwrap().width, 24);
    assert_eq!(place.run(&["diff", "a.exr", "c.exr", "--tolerance", "10"]).code, Some(0));
    let json = place.run(&["diff", "a.exr", "c.exr", "--json"]);
    assert_eq!(json.code, Some(1));
    let comparison = &json.json()["comparison"];
    assert_eq!((&comparison["width"], &comparison["bit_equal"]), (&24.into(), &false.into()));
    for number in ["differing_pixels", "largest_ulps", "largest_difference", "rmse", "psnr"] {
        assert!(comparison[number].as_f64().is_some_and(|x| x > 0.0), "{number}: {comparison}");
    }
}

#[test]
fn diff_tells_how_far_pictures_look_apart_when_asked() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    for (name, exposure) in [("a.exr", "0"), ("b.exr", "0.1"), ("c.exr", "1")] {
        place.succeed(&["render", "scene.toml", "--device", "cpu", "-o", name, "--exposure", exposure]);
    }
    let mean = |other: &str| {
        let json = place.run(&["diff", "a.exr", other, "--json", "--flip"]).json();
        json["mean_flip"].as_f64().unwrap()
    };
    assert_eq!(mean("a.exr"), 0.0);
    assert!(0.0 < mean("b.exr") && mean("b.exr") < mean("c.exr") && mean("c.exr") <= 1.0);
    assert!(place.succeed(&["diff", "a.exr", "a.exr", "--flip"]).text().ends_with("mean FLIP           0.000000\n"));
    let mapped = place.run(&["diff", "a.exr", "c.exr", "--flip-map", "seen.png", "-o", "heat.png"]);
    assert!(mapped.text().contains("mean FLIP"), "{}", mapped.text());
    let [seen, heat] = ["seen.png", "heat.png"].map(|name| image::read(&place.path(name)).unwrap());
    assert!((seen.width, seen.height) == (24, 18) && !seen.bits_equal(&heat));
    let unasked = place.run(&["diff", "a.exr", "c.exr", "--json"]).json();
    assert!(unasked.as_object().unwrap().contains_key("mean_flip") && unasked["mean_flip"].is_null());
}

/// Reading and building may take long before the first pixel.
#[cfg(target_os = "linux")]
#[test]
fn a_terminal_sees_which_stage_is_under_way() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let program = place.command::<&str>(&[]);
    let command = format!("{:?} render scene.toml --device cpu", program.get_program());
    // The one of util-linux gives its command a terminal.
    let mut script = std::process::Command::new("script");
    script.args(["-qec", &command, "/dev/null"]).current_dir(place.path("")).env("TERM", "xterm");
    let Ok(output) = script.output() else { return eprintln!("skipped: there is no script command") };
    let shown = String::from_utf8_lossy(&output.stdout).into_owned();
    for stage in ["reading", "building", "opening the device", "rendering", "writing"] {
        assert!(shown.contains(stage), "{stage}: {shown}");
    }
    let piped = place.succeed(&["render", "scene.toml", "--device", "cpu"]);
    assert!(piped.stderr.starts_with("scene.png: 24x18"), "{}", piped.stderr);
}

#[test]
fn cameras_are_named_numbered_or_given() {
    let second = "\n[[camera]]\nname = \"above\"\neye = [0, 5, 0]\ntarget = [0, 0, 0]\nup = [0, 0, -1]\n";
    let place = Place::new(&[("scene.toml", &format!("{SCENE}{second}"))]);
    let render = |output: &str, more: &[&str]| {
        place.succeed(&[&["render", "scene.toml", "--device", "cpu", "-o", output], more].concat());
        image::read(&place.path(output)).unwrap().hash()
    };
    let above = render("a.exr", &["--camera", "above"]);
    assert_eq!(above, render("b.exr", &["--camera", "1"]));
    assert_ne!(above, render("c.exr", &[]));
    let front = render("d.exr", &["--camera", "front"]);
    assert_eq!(front, render("e.exr", &["--camera", "0"]));
    assert_eq!(front, render("f.exr", &["--eye", "0,0,4", "--target", "0,0,0", "--fov", "45"]));
    assert_ne!(front, render("g.exr", &["--fov", "60"]));
    // Straight down, where the usual up has no direction.
    render("h.exr", &["--eye", "0,5,0", "--target", "0,0,0"]);
}

#[test]
fn an_eye_or_a_target_replaces_that_of_the_camera_and_leaves_the_rest() {
    let camera = |name: &str, eye: &str, target: &str| {
        format!("\n[[camera]]\nname = \"{name}\"\neye = {eye}\ntarget = {target}\nup = [1, 1, 0]\nfov = 30\n")
    };
    let cameras = [("tilted", "[0, 0, 5]", "[0, 0.5, 0]"), ("nearer", "[1, 0, 3]", "[0, 0.5, 0]")];
    let cameras = cameras.map(|(name, eye, target)| camera(name, eye, target)).concat();
    let cameras = cameras + &camera("aside", "[0, 0, 5]", "[0.5, 0, 0]");
    let place = Place::new(&[("scene.toml", &format!("{SCENE}{cameras}"))]);
    let render = |more: &[&str]| {
        place.succeed(&[&["render", "scene.toml", "--device", "cpu", "-o", "out.exr"], more].concat());
        image::read(&place.path("out.exr")).unwrap().hash()
    };
    let [nearer, aside] = ["nearer", "aside"].map(|name| render(&["--camera", name]));
    assert_eq!(nearer, render(&["--camera", "tilted", "--eye", "1,0,3"]));
    assert_eq!(aside, render(&["--camera", "1", "--target", "0.5,0,0"]));
    assert_eq!(nearer, render(&["--camera", "aside", "--eye", "1,0,3", "--target", "0,0.5,0"]));
    assert_ne!(nearer, render(&["--eye", "1,0,3", "--target", "0,0.5,0"]), "without a camera nothing is of one");
    // Along the camera's own up.
    render(&["--camera", "tilted", "--eye", "1,1,0", "--target", "-1,-1,0"]);
    for alone in ["--eye", "--target"] {
        let refused = place.run(&["render", "scene.toml", alone, "1,0,3"]);
        assert_eq!(refused.code, Some(2));
        assert!(refused.stderr.contains("--camera"), "{}", refused.stderr);
    }
}

#[test]
fn an_unknown_option_is_told_the_nearest_one_if_that_is_near_and_else_none() {
    let place = Place::new(&[]);
    let said = |option: &str| place.run(&["-q", "render", "scene.toml", option]).stderr;
    for (option, meant) in [("--sampels", "--samples"), ("--exposur", "--exposure"), ("--quite", "--quiet")] {
        let said = said(option);
        assert!(said.contains(&format!("unexpected argument '{option}'")), "{said}");
        assert!(said.contains("tip:") && said.contains(&format!("'{meant}'")), "{said}");
    }
    // Clap itself names --threads for the second and --size for the third.
    for far in ["--zzzz", "--heard", "--sieze-it"] {
        let said = said(far);
        assert!(said.contains(&format!("unexpected argument '{far}'")), "{said}");
        assert!(!said.contains("tip:") && said.contains("Usage: eyerays render [OPTIONS] <SCENE>"), "{said}");
    }
}

/// However many samples fit, they are the first ones: as many give the same bits.
#[test]
fn a_time_limit_gives_the_bits_of_the_samples_that_it_tells() {
    let place = Place::new(&[]);
    let scene = shipped("bleeding");
    let common = ["render", &scene, "--size", "24x18", "--device", "cpu", "--json", "-o"];
    let limited = place.succeed(&[&common[..], &["a.exr", "--time-limit", "0.05"]].concat()).json();
    let samples = limited["spp"].to_string();
    assert!(samples.parse::<u32>().unwrap() >= 1);
    let counted = place.succeed(&[&common[..], &["b.exr", "--spp", &samples]].concat()).json();
    assert_eq!(limited["film_hash"], counted["film_hash"], "{samples} samples");
    let other = place.succeed(&[&common[..], &["c.exr", "--spp", &samples, "--seed", "1"]].concat()).json();
    assert_ne!(limited["film_hash"], other["film_hash"]);
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_is_not_replaced() {
    let place = Place::new(&[("mesh.obj", TRIANGLE)]);
    std::os::unix::fs::symlink("nowhere.png", place.path("p.png")).unwrap();
    place.refuse(&["render", "mesh.obj", "--device", "cpu", "-o", "p.png"], &["p.png", "is a link to a file"]);
    assert_eq!(fs::read_link(place.path("p.png")).unwrap().to_str(), Some("nowhere.png"));
}

#[test]
fn too_many_threads_of_the_environment_are_refused_before_they_are_started() {
    let place = Place::new(&[("mesh.obj", TRIANGLE)]);
    let mut many = place.command(&["check", "mesh.obj"]);
    place.refuse_run(many.env("RAYON_NUM_THREADS", "99999"), &["RAYON_NUM_THREADS is 99999", "1024"]);
}
