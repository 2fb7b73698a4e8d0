//! TOML scenes.

use std::path::Path;

use glam::Vec3;

use super::{Folder, TRIANGLE, assert_refused, budget};
use crate::scene::{
    Background, Direct, Falloff, Integrator, Light, LightGroups, Material, Primitives, Projection, Sampler, Scene,
    Settings, Transport,
};
use crate::scene_io::load::Loading;

const BALL: &str = "[[mesh]]\nshape = \"sphere\"\nsubdivisions = 0\n";

fn load(text: &str) -> (Scene, Vec<String>) {
    let folder = Folder::new(&[("scene.toml", text.as_bytes()), ("a.obj", TRIANGLE)]);
    folder.load("scene.toml").unwrap()
}

#[test]
fn the_documented_example_loads_as_documented() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/scene_io/example.toml");
    let (scene, warnings) = crate::scene_io::load(&example).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let names: Vec<_> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["floor", "glass", "mirror", "lamp", "default"]);
    assert_eq!(scene.mesh.triangles.len(), 2 + 20 * 256 + 2 + (2 * 12 * 5 + 2 * 10) + 2 * 8 + 12 + 2 * 6);
    assert_eq!((scene.spheres.len(), scene.disks.len()), (1 + 3, 1));
    assert_eq!(scene.mesh.materials.len(), scene.mesh.triangles.len());
    assert_eq!(scene.mesh.normals.len(), scene.mesh.positions.len());
    assert_eq!(scene.settings.size, (640, 480));
    assert_eq!((scene.settings.samples, scene.settings.sampler), (2, Sampler::Sobol));
    assert_eq!(scene.settings.bounces, 8);
    assert_eq!(scene.settings.samples_a_pixel(), 10);
    let Transport { integrator, seed, roulette, clamp, direct, ao_distance } = scene.settings.transport;
    assert_eq!((integrator, direct), (Integrator::Path, Direct::Power));
    assert_eq!((seed, roulette, clamp, ao_distance), (1, 4, 20.0, 2.0));
    assert_eq!((scene.materials[3].emission, scene.materials[3].two_sided), (Vec3::new(4.0, 3.5, 3.0), true));
    let motion = scene.motion.as_ref().expect("it moves");
    assert_eq!((motion.cameras.as_slice(), motion.exposure), (&scene.cameras[..1], 0.3));
    // Half of a picture of 25 a second, in which the camera goes straight and the box turns by 3.6 degrees.
    let last = motion.poses.last().unwrap();
    assert!((last.cameras[0].eye.x - 0.01).abs() < 1e-6, "{}", last.cameras[0].eye);
    let turn = (30.0f32 + 0.02 * 180.0).to_radians();
    let row = last.instances[0].rows[0];
    assert!((row - Vec3::new(turn.cos(), 0.0, turn.sin())).length() < 1e-5, "{row}");
    assert_eq!((scene.instances.len(), motion.bent().count()), (1, 0));
    assert_eq!(scene.cameras[0].projection, Projection::Perspective { fov: 40.0 });
    assert_eq!(scene.ambient, Vec3::splat(0.1));
    assert_eq!(
        scene.lights[0],
        Light::Point {
            position: Vec3::new(2.0, 4.0, 3.0),
            colour: Vec3::new(1.0, 0.9, 0.8) * 0.8,
            group: "key".to_owned(),
            illuminant: None
        }
    );
    let Light::Spot { outer, inner, .. } = scene.lights[2] else {
        panic!("{:?}", scene.lights[2]);
    };
    assert_eq!((outer, inner), (20.0, 10.0));
    assert_eq!((&scene.materials[3].group[..], &scene.background_group[..]), ("key", "sky"));
    assert_eq!(LightGroups::of(&scene).names(), ["key", "sky"]);
    assert_eq!(scene.materials[0].checker.unwrap().size, 0.5);
    assert_eq!(scene.materials[4].ambient(), scene.materials[4].diffuse);
}

#[test]
fn what_is_not_said_has_defaults() {
    let (scene, _) = load(BALL);
    assert_eq!(scene.settings, Settings::default());
    assert_eq!(scene.background, Background::Colour(Vec3::ZERO));
    assert_eq!(scene.ambient, Vec3::ZERO);
    assert_eq!(scene.cameras.len(), 1);
    assert_eq!(scene.lights.len(), 2);
    let (scene, _) = load(&format!("light = []\n{BALL}"));
    assert!(scene.lights.is_empty());
}

#[test]
fn a_material_of_code_that_says_its_colour_is_that_of_a_file_that_says_it() {
    let material = |says: &str| {
        let scene = load(&format!("{BALL}material = \"m\"\n[[material]]\nname = \"m\"\n{says}")).0;
        scene.materials.into_iter().find(|material| material.name == "m").expect("it is used")
    };
    let name = || "m".to_owned();
    let diffuse = Vec3::new(0.5, 0.25, 0.125);
    let coloured = Material { name: name(), diffuse, ..Material::default() };
    assert_eq!(coloured.ambient(), diffuse, "ambient light shows another colour than lamps do");
    assert_eq!(material("diffuse = [0.5, 0.25, 0.125]\n"), coloured);
    assert_eq!(material(""), Material { name: name(), ..Material::default() });
}

#[test]
fn no_lamps_are_added_where_an_integrator_finds_light_elsewhere() {
    let lamps = |integrator: &str, rest: &str| {
        let (scene, _) = load(&format!("[render]\nintegrator = \"{integrator}\"\n{rest}\n{BALL}"));
        scene.lights.len()
    };
    let sky = "[background]\ncolor = [0, 0, 0.1]";
    let gradient = "[background]\nhorizon = [0, 0, 0]\nzenith = [0, 1, 0]";
    let black = "[background]\ncolor = [0, 0, 0]";
    let studio = "[background]\nenvironment = \"studio\"";
    let shining = "[[material]]\nname = \"default\"\nemission = [1, 0, 0]";
    let of = |integrator: &str| [sky, gradient, black, studio, shining].map(|rest| lamps(integrator, rest));
    assert_eq!(of("path"), [0, 0, 2, 0, 0]);
    assert_eq!(of("distributed"), [2, 2, 2, 0, 0]);
    // It lights nothing by a background, and draws nothing that shines.
    assert_eq!([sky, gradient, black, studio].map(|rest| lamps("whitted", rest)), [2, 2, 2, 0]);
}

#[test]
fn a_spot_fades_as_it_is_told() {
    let spot = "[[light]]\nkind = \"spot\"\nposition = [0, 1, 0]\ntarget = [0, 0, 0]\nangle = 40\n";
    let of = |key: &str| match load(&format!("{spot}{key}\n{BALL}")).0.lights[0] {
        Light::Spot { falloff, .. } => falloff,
        ref other => panic!("{other:?}"),
    };
    assert_eq!(
        (of(""), of("falloff = \"smooth\""), of("falloff = \"gltf\"")),
        (Falloff::Smooth, Falloff::Smooth, Falloff::Gltf)
    );
}

#[test]
fn numbers_are_read_as_toml_writes_them() {
    let text = "[render]\nsize = [0x10, 1_000]\n[[mesh]]\nshape = \"box\"\nmin = [-1_0.5, +0, 1e-3]\n\
        max = [1E1, 1.0, 100000000000000000000]\n";
    let (scene, _) = load(text);
    assert_eq!(scene.settings.size, (16, 1000));
    assert_eq!(scene.mesh.positions[0], Vec3::new(-10.5, 0.0, 1e-3));
    assert_eq!(scene.mesh.positions[7], Vec3::new(10.0, 1.0, 1e20));
}

/// Every text with the line to blame and a part of the message.
const REFUSED: &[(&str, usize, &str)] = &[
    ("[[mesh]\n", 1, ""),
    ("x = 1\nx = 2\n", 2, "duplicate key"),
    ("[[mesh]]\nshape = \"sphere\"\n\n[[lihgt]]\nkind = \"point\"\n", 4, "did you mean \"light\"?"),
    ("[[mesh]]\nshape = \"sphere\"\ncolour = 1\n", 3, "unknown key \"colour\""),
    ("[background]\ncolour = [0, 0, 0]\n", 2, "\"colour\" in [background]; did you mean \"color\"?"),
    ("[[camera]]\nname = \"a\"\neye = [0, 0, 1]\n\ntagret = [0, 0, 0]\n", 5, "did you mean \"target\"?"),
    ("[render]\nsamples = 2\nsize = [30000, 30000]\n", 3, "too large"),
    ("[background]\ncolor = [0, 0, 0]\nambient = [0, 0, 0]\n", 3, "above the first table"),
    ("[background]\ncolor = [0, 0, 0]\nzenith = [0, 0, 0]\n", 2, "remove the one"),
    ("[background]\nzenith = [0, 0, 0]\n", 1, "needs \"horizon\""),
    ("[background]\ncolor = [0, 0]\n", 2, "not 2 of them"),
    ("[background]\ncolor = [\n0,\n-1, 0]\n", 4, "at least 0"),
    ("ambient = [0, 0, nan]\n", 1, "not nan"),
    ("ambient = [0, 0, inf]\n", 1, "not inf"),
    ("ambient = [0, 0, 1e39]\n", 1, "finite"),
    ("ambient = [0, 0, \"1\"]\n", 1, "not a string"),
    ("ambient = 1\n", 1, "not an integer"),
    ("camera = 1\n", 1, "[[camera]]"),
    ("[light]\nkind = \"point\"\n", 1, "[[light]]"),
    ("[[render]]\nsize = [1, 1]\n", 1, "[render]"),
    ("[render]\nsize = [0, 1]\n", 2, "between 1 and 32767"),
    ("[render]\nsize = [1.5, 1]\n", 2, "a whole number, not a float"),
    ("[render]\nsize = 5\n", 2, "two whole numbers"),
    ("[render]\nsamples = 65\n", 2, "between 1 and 64"),
    ("[render]\nsampler = \"sobel\"\n", 2, "unknown sampler \"sobel\"; did you mean \"sobol\"?"),
    ("[render]\nsampler = 2\n", 2, "not an integer"),
    ("[render]\nbounces = -1\n", 2, "between 0 and 65535"),
    ("[render]\nmin_contribution = 2\n", 2, "between 0 and 1"),
    ("[render]\nculling = 1\n", 2, "true or false"),
    ("\n[[camera]]\nname = \"a\"\ntarget = [0, 0, 0]\n", 2, "needs \"eye\""),
    ("[[camera]]\nname = \" \"\n", 2, "give a name"),
    ("[[camera]]\nname = \"a\"\neye = [1, 1, 1]\ntarget = [1, 1, 1]\n", 4, "camera \"a\" looks at its own eye"),
    ("[[camera]]\nname = \"a\"\neye = [0, 5, 0]\ntarget = [0, 0, 0]\n", 4, "camera \"a\" has its up along"),
    ("[[camera]]\nname = \"a\"\neye = [0, 5, 0]\ntarget = [0, 0, 0]\nup = [0, -2, 0]\n", 5, "up aside"),
    ("[[camera]]\nname = \"a\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nup = [0, 0, 0]\n", 5, "up aside"),
    ("[[camera]]\nname = \"a\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\nfov = 180\n", 5, "between 0 and 180"),
    (
        "[[camera]]\nname = \"a\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n\
      [[camera]]\nname = \"a\"\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n",
        6,
        "a second camera \"a\"",
    ),
    ("[[light]]\nposition = [0, 0, 0]\n", 1, "needs \"kind\""),
    ("[[light]]\nkind = \"pont\"\n", 2, "did you mean \"point\"?"),
    ("[[light]]\nkind = \"point\"\n", 1, "a point light needs \"position\""),
    ("[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\nangle = 3\n", 4, "unknown key \"angle\" in a point light"),
    ("[[light]]\nkind = \"point\"\ncolor = [0, -1, 0]\n", 3, "at least 0"),
    ("[[light]]\nkind = \"point\"\ncolor = [1e38, 0, 0]\nintensity = 1e38\n", 4, "lower the intensity"),
    ("[[light]]\nkind = \"directional\"\ndirection = [0, 0, 0]\n", 3, "the direction is zero"),
    ("[[light]]\nkind = \"spot\"\nposition = [0, 1, 0]\ntarget = [0, 1, 0]\n", 4, "move its target"),
    ("[[light]]\nkind = \"spot\"\nposition = [0, 1, 0]\ntarget = [0, 0, 0]\nangle = 180\n", 5, "between 0 and 180"),
    (
        "[[light]]\nkind = \"spot\"\nposition = [0, 1, 0]\ntarget = [0, 0, 0]\nangle = 9\nsoftness = 1.5\n",
        6,
        "between 0 and 1",
    ),
    ("[[material]]\ndiffuse = [0, 0, 0]\n", 1, "needs \"name\""),
    ("[[material]]\nname = \"a\"\n[[material]]\nname = \"a\"\n", 4, "a second material \"a\""),
    ("[[material]]\nname = \"a\"\ndiffuse = [0, 0, 1.5]\n", 3, "between 0 and 1"),
    ("[[material]]\nname = \"a\"\nior = 0.5\n", 3, "between 1 and 4"),
    ("[[material]]\nname = \"a\"\nshininess = -1\n", 3, "at least 0"),
    ("[[material]]\nname = \"a\"\nchecker = { color = [0, 0, 0] }\n", 3, "needs \"size\""),
    ("[[material]]\nname = \"a\"\nchecker = { color = [0, 0, 0], size = 0 }\n", 3, "greater than 0"),
    ("[[material]]\nname = \"a\"\nchecker = { color = [0, 0, 0], size = 1, sise = 1 }\n", 3, "unknown key \"sise\""),
    ("[[mesh]]\nmaterial = \"a\"\n", 1, "\"file\" or \"shape\""),
    ("[[mesh]]\nfile = \"a.obj\"\nshape = \"box\"\n", 3, "a file or a shape"),
    ("[[mesh]]\nfile = \"a.obj\"\nradius = 1\n", 3, "unknown key \"radius\""),
    ("[[mesh]]\nfile = \"b.obj\"\n", 2, "no such file"),
    ("[[mesh]]\nfile = \"\"\n", 2, "give a name"),
    ("[[mesh]]\nfile = \".\"\n", 2, "this is a folder"),
    ("[[mesh]]\nfile = \"scene.toml\"\n", 2, "is no .obj"),
    ("[[mesh]]\nshape = \"cube\"\n", 2, "unknown shape \"cube\""),
    ("[[mesh]]\nshape = \"sphere\"\nradius = 0\n", 3, "greater than 0"),
    ("[[mesh]]\nshape = \"sphere\"\nsubdivisions = 9\n", 3, "between 0 and 8"),
    ("[[mesh]]\nshape = \"sphere\"\nradius = 3e38\ncenter = [3e38, 0, 0]\n", 1, "leaves the range"),
    ("[[mesh]]\nshape = \"quad\"\n", 1, "a quad needs \"corners\""),
    ("[[mesh]]\nshape = \"quad\"\ncorners = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\n", 3, "not 3 of them"),
    ("[[mesh]]\nshape = \"box\"\nmin = [0, 0, 0]\nmax = [1, 0, 1]\n", 4, "swap them"),
    ("[[mesh]]\nfile = \"a.obj\"\nscale = [1, 0, 1]\n", 3, "other than 0"),
    ("[[mesh]]\nfile = \"a.obj\"\nscale = 0\n", 3, "other than 0"),
    ("[[mesh]]\nfile = \"a.obj\"\nrotate = [inf, 0, 0]\n", 3, "finite"),
    ("[[mesh]]\nfile = \"a.obj\"\nmaterial = \"rad\"\n[[material]]\nname = \"red\"\n", 3, "did you mean \"red\"?"),
];

#[test]
fn what_makes_no_sense_is_refused_where_it_stands() {
    for (text, line, why) in REFUSED {
        let folder = Folder::new(&[("scene.toml", text.as_bytes()), ("a.obj", TRIANGLE)]);
        assert_refused(&folder.refuse("scene.toml"), "scene.toml", Some(*line), why);
    }
}

#[test]
fn a_scene_without_meshes_is_refused() {
    for text in ["# nothing\n", "mesh = []\n"] {
        let folder = Folder::new(&[("scene.toml", text.as_bytes())]);
        let error = folder.refuse("scene.toml");
        assert_refused(&error, "scene.toml", None, "there is no [[mesh]]");
    }
}

#[test]
fn text_that_is_not_utf8_is_refused() {
    let folder = Folder::new(&[("scene.toml", b"# a\n# \xff\n")]);
    assert_refused(&folder.refuse("scene.toml"), "scene.toml", Some(2), "UTF-8");
}

#[test]
fn a_fault_in_a_mesh_names_the_mesh() {
    let scene = b"[[mesh]]\nfile = \"b.obj\"\n";
    let folder = Folder::new(&[("scene.toml", scene), ("b.obj", b"v 0 0\n")]);
    assert_refused(&folder.refuse("scene.toml"), "b.obj", Some(1), "three numbers");
}

#[test]
fn a_material_overrides_what_it_says_of_a_material_file() {
    let scene = b"[[mesh]]\nfile = \"b.obj\"\n[[material]]\nname = \"red\"\nshininess = 5\n\
        [[material]]\nname = \"idle\"\n";
    let obj = b"mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
    let mtl = b"newmtl red\nKd 1 0 0\nNs 9\n";
    let folder = Folder::new(&[("scene.toml", scene), ("b.obj", obj), ("b.mtl", mtl)]);
    let (scene, warnings) = folder.load("scene.toml").unwrap();
    assert_eq!(scene.materials.len(), 1);
    assert_eq!(scene.materials[0].diffuse, Vec3::X);
    assert_eq!(scene.materials[0].shininess, 5.0);
    let [warning] = &warnings[..] else {
        panic!("{warnings:?}");
    };
    assert!(warning.ends_with("scene.toml:7: no surface has the material \"idle\""), "{warning}");
}

#[test]
fn a_mesh_s_material_covers_it_all_and_may_be_one_of_its_file() {
    let obj = b"mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl blue\nf 3 2 1\n";
    let mtl = b"newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n";
    let scene = b"[[mesh]]\nfile = \"b.obj\"\nmaterial = \"blue\"\n";
    let folder = Folder::new(&[("scene.toml", scene), ("b.obj", obj), ("b.mtl", mtl)]);
    let (scene, _) = folder.load("scene.toml").unwrap();
    assert_eq!(scene.materials.len(), 1);
    assert_eq!(scene.materials[0].diffuse, Vec3::Z);
    assert_eq!(scene.mesh.materials, [0, 0]);
}

#[test]
fn materials_of_one_name_in_two_files_stay_apart_and_a_file_twice_is_one() {
    let scene = b"[[mesh]]\nfile = \"a.obj\"\n[[mesh]]\nfile = \"b.obj\"\n[[mesh]]\nfile = \"a.obj\"\n";
    let a = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    let b = b"mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    let folder = Folder::new(&[
        ("scene.toml", scene),
        ("a.obj", a),
        ("b.obj", b),
        ("a.mtl", b"newmtl m\nKd 1 0 0\n"),
        ("b.mtl", b"newmtl m\nKd 0 1 0\n"),
    ]);
    let (scene, _) = folder.load("scene.toml").unwrap();
    // What is repeated comes last.
    assert_eq!(scene.mesh.materials, [1, 0, 0]);
    assert_eq!(scene.materials[1].diffuse, Vec3::Y);
    assert_eq!(scene.mesh.triangles[2], [6, 7, 8]);
}

#[test]
fn every_mesh_is_a_part_with_its_name_its_triangles_and_its_bounds() {
    let scene = format!(
        "{BALL}radius = 2\n[[mesh]]\nfile = \"a.obj\"\nmaterial = \"default\"\ntranslate = [0, 0, 9]\nscale = -1\n\
        [[mesh]]\nshape = \"box\"\nmin = [0, 1, 2]\nmax = [3, 4, 5]\n"
    );
    let (scene, _) = load(&scene);
    let names: Vec<_> = scene.objects.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["sphere", "a.obj (default)", "box"]);
    let ranges: Vec<_> = scene.objects.iter().map(|part| part.primitives.clone()).collect();
    assert_eq!(ranges, [0..20, 20..21, 21..33].map(Primitives::Triangles));
    assert_eq!(scene.objects[1].bounds, [Vec3::new(-1.0, -1.0, 9.0), Vec3::new(0.0, 0.0, 9.0)]);
    assert_eq!(scene.objects[2].bounds, [Vec3::new(0.0, 1.0, 2.0), Vec3::new(3.0, 4.0, 5.0)]);
    let folder = Folder::new(&[("a.obj", TRIANGLE)]);
    let (bare, _) = folder.load("a.obj").unwrap();
    assert_eq!(
        (bare.objects[0].name.as_str(), bare.objects[0].primitives.clone()),
        ("a.obj", Primitives::Triangles(0..1))
    );
    assert_eq!(bare.cameras, [crate::scene::default_camera(&bare, 1.0).unwrap()]);
}

#[test]
fn a_hundred_thousand_of_everything_take_seconds() {
    let tables = |text: &dyn Fn(usize) -> String| (0..100_000).map(text).collect::<String>();
    let text = [
        tables(&|i| format!("[[material]]\nname = \"m{i}\"\n")),
        tables(&|i| format!("[[camera]]\nname = \"c{i}\"\neye = [0, 0, 1]\ntarget = [0, 0, 0]\n")),
        tables(&|_| "[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\n".into()),
        tables(&|i| format!("[[mesh]]\nfile = \"a.obj\"\nmaterial = \"m{}\"\n", i / 2)),
    ];
    let start = std::time::Instant::now();
    let (scene, warnings) = load(&text.concat());
    // What grew with the square of them would take hours; machines that do other work take their time.
    assert!(start.elapsed().as_secs() < 120, "{:?}", start.elapsed());
    assert_eq!((scene.cameras.len(), scene.lights.len()), (100_000, 100_000));
    assert_eq!((scene.materials.len(), scene.objects.len()), (50_000, 100_000));
    assert_eq!(warnings.len(), 50_000);
}

#[test]
fn spheres_and_files_placed_again_are_counted_before_they_are_made() {
    let sphere = "[[mesh]]\nshape = \"sphere\"\nsubdivisions = 8\n";
    // The same again takes no triangles.
    let files: String = (0..9).map(|file| format!("[[mesh]]\nfile = \"./{}a.obj\"\n", "./".repeat(file))).collect();
    let folder = Folder::new(&[
        ("spheres.toml", sphere.repeat(500).as_bytes()),
        ("files.toml", files.as_bytes()),
        ("a.obj", TRIANGLE),
    ]);
    let refuse = |name: &str, bytes| {
        let scene = crate::scene_io::load::load_within(&folder.path(name), budget(bytes), Loading::default());
        scene.expect_err("accepted")
    };
    let why = "1310720 triangles with 655362 vertices take about 469 MB of memory, and the test leaves 400 MB";
    assert_refused(&refuse("spheres.toml", 400_000_000), "spheres.toml", Some(1), why);
    assert_refused(&refuse("files.toml", 2200), "files.toml", Some(9), "5 triangles with 15 vertices");
}
