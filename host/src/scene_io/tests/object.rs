//! Objects that meshes stand on: nested, in several places, and moved by keys.

use glam::Vec3;

use super::{Folder, said};
use crate::scene::{Primitives, Scene};
use crate::scene_io::{Loading, Moment, Shutter, load_as};

const CAMERA: &str = "camera = [{ name = \"c\", eye = [0, 0, 9], target = [0, 0, 0] }]\n";

fn text(text: &str) -> Scene {
    let folder = Folder::new(&[("a.toml", format!("{CAMERA}{text}").as_bytes())]);
    let (scene, warnings) = folder.load("a.toml").unwrap();
    assert_eq!(warnings, [""; 0]);
    scene.check().unwrap();
    scene
}

/// The centre of each object that there is, where copies are those of one.
fn centres(scene: &Scene) -> Vec<Vec3> {
    let scene = scene.clone().flattened();
    let all = scene.objects.iter().flat_map(|object| match &object.primitives {
        Primitives::Triangles(range) => {
            let boxes = scene.mesh.triangles[range.clone()].chunks(12);
            let centre = |triangles: &[[u32; 3]]| {
                let mut corners: Vec<u32> = triangles.as_flattened().to_vec();
                corners.sort_unstable();
                corners.dedup();
                corners.iter().map(|&v| scene.mesh.positions[v as usize]).sum::<Vec3>() / corners.len() as f32
            };
            boxes.map(centre).collect::<Vec<_>>()
        }
        Primitives::Spheres(range) => scene.spheres[range.clone()].iter().map(|sphere| sphere.center).collect(),
        other => panic!("{other:?}"),
    });
    all.collect()
}

fn assert_near(found: &[Vec3], wanted: &[[f32; 3]]) {
    let same = found.iter().zip(wanted).all(|(found, wanted)| (found - Vec3::from(*wanted)).length() < 1e-5);
    assert!(found.len() == wanted.len() && same, "{found:?}, not {wanted:?}");
}

const CUBE: &str = "shape = \"box\", min = [-0.1, -0.1, -0.1], max = [0.1, 0.1, 0.1]";

/// Two cars of two wheels each, on a road that is turned by a quarter: x goes down z.
#[test]
fn meshes_stand_on_objects_that_stand_on_others_in_all_their_places() {
    let scene = text(&format!(
        "object = [
            {{ name = \"car\", on = \"road\", translate = [0, 1, 0], place = [{{}}, {{ translate = [10, 0, 0] }}] }},
            {{ name = \"road\", rotate = [0, -90, 0], translate = [0, 0, 100] }},
        ]
        mesh = [
            {{ {CUBE}, on = \"car\", scale = 2, place = [{{ translate = [1, 0, 0] }}, {{ translate = [2, 0, 3] }}] }},
            {{ {CUBE}, translate = [7, 0, 0] }},
        ]"
    ));
    let wheels = [[0.0, 1.0, 101.0], [-3.0, 1.0, 102.0], [0.0, 1.0, 111.0], [-3.0, 1.0, 112.0]];
    let mut wanted = wheels.to_vec();
    wanted.push([7.0, 0.0, 0.0]);
    assert_near(&centres(&scene), &wanted);
    let of_wheels = &scene.objects[0].bounds;
    assert!((of_wheels[0] - Vec3::new(-3.2, 0.8, 100.8)).length() < 1e-5, "{of_wheels:?}");
}

#[test]
fn copies_are_held_once_and_only_in_triangles_where_a_mesh_stands_once() {
    let cube = |more: &str| format!("mesh = [{{ {CUBE}{more} }}]");
    let folder = |text: String| Folder::new(&[("a.toml", format!("{CAMERA}{text}").as_bytes())]);
    let always = || Loading { instancing: crate::scene_io::Instancing::Always, ..Loading::default() };
    let often = folder(cube(", place = [{}, { translate = [1, 0, 0] }, { rotate = [0, 0, 90] }]"));
    let (scene, _) = load_as(&often.path("a.toml"), always()).unwrap();
    assert_eq!((scene.mesh.triangles.len(), scene.instances.len(), scene.objects.len()), (12, 3, 1));
    let once = folder(cube(", on = \"a\"") + "\nobject = [{ name = \"a\", translate = [1, 0, 0] }]");
    let (scene, _) = load_as(&once.path("a.toml"), always()).unwrap();
    assert_eq!((scene.own_triangles(), scene.instances.len()), (12, 0));
}

#[test]
fn spheres_stand_in_each_place_and_are_meshes_where_an_object_stretches_them() {
    let of = |more: &str| {
        text(&format!(
            "object = [{{ name = \"a\", scale = {more}, place = [{{}}, {{ translate = [4, 0, 0] }}] }}]
            mesh = [{{ shape = \"sphere\", center = [1, 0, 0], radius = 0.5, on = \"a\" }}]"
        ))
    };
    let whole = of("2");
    assert_near(&centres(&whole), &[[2.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    assert!(whole.spheres.iter().all(|sphere| sphere.radius == 1.0));
    assert!(of("[2, 1, 1]").spheres.is_empty());
}

#[test]
fn what_stands_on_a_moving_object_moves_with_it() {
    let text = format!(
        "{CAMERA}object = [{{ name = \"a\", translate = [0, 1, 0], key = [{{ time = 0 }}, {{ time = 2, translate = [4, 1, 0] }}] }}]
        mesh = [{{ {CUBE}, translate = [0, 0, 3], on = \"a\" }}, {{ {CUBE} }}]"
    );
    let folder = Folder::new(&[("a.toml", text.as_bytes())]);
    let load = |shutter| {
        let moment = Moment { animation: None, seconds: Some(0.5) };
        let (scene, warnings) =
            load_as(&folder.path("a.toml"), Loading { moment, shutter, ..Loading::default() }).unwrap();
        assert_eq!(said(&warnings), [""; 0]);
        scene
    };
    let still = load(Some(Shutter::CLOSED));
    assert_near(&centres(&still), &[[1.0, 1.0, 3.0], [0.0; 3]]);
    assert_eq!(still.animations[0].seconds, 2.0);
    let motion = load(Some(Shutter { open: 0.0, close: 0.5, rolling: 1.0 })).motion.expect("it moves");
    let there: Vec<Vec3> = motion.poses.iter().flat_map(|pose| &pose.instances).map(|copy| copy.translation).collect();
    assert_near(&there, &[[2.0, 1.0, 3.0]]);
}

#[test]
fn objects_that_make_no_sense_are_refused_in_a_line() {
    let object = |name: &str, more: &str| format!("{{ name = \"{name}\"{more} }}");
    let twice = ", place = [{}, { translate = [1, 0, 0] }]";
    let nested: Vec<String> =
        (0..50).map(|n| object(&format!("o{n}"), &format!(", on = \"o{}\"{twice}", n + 1))).collect();
    for (objects, on, wanted) in [
        (object("a", ""), "b", "stands on the object \"b\", which is not there"),
        (object("a", ", on = \"b\"") + "," + &object("b", ", on = \"a\""), "a", "or stands on it itself"),
        (object("a", ", on = \"a\""), "a", "or stands on it itself"),
        (object("a", "") + "," + &object("a", ""), "a", "a second object \"a\""),
        ("{}".into(), "a", "needs \"name\""),
        (object("a", ", wheels = 4"), "a", "wheels"),
        (object("a", ", place = [{ key = 3 }]"), "a", "key"),
        (object("a", ", scale = 0"), "a", "scale"),
        (nested.join(",") + "," + &object("o50", ""), "o0", "places there are more than"),
    ] {
        let text = format!("{CAMERA}object = [{objects}]\nmesh = [{{ {CUBE}, on = \"{on}\" }}]");
        let error = Folder::new(&[("a.toml", text.as_bytes())]).refuse("a.toml");
        assert!(error.to_string().contains(wanted), "{wanted}: {error}");
    }
}
