//! Animations: where channels put nodes at a moment, by closed forms.

use glam::{DVec3, Vec3};
use serde_json::json;

use super::super::said;
use super::model::{F32, Model, floats, parse, parse_at};
use crate::scene::Light;
use crate::scene_io::gltf::Gltf;
use crate::scene_io::{AnimationWish, Moment};

/// A triangle whose node has an animation of one channel.
pub fn moving(path: &str, interpolation: &str, times: &[f32], values: &[f32]) -> Model {
    let mut model = Model::triangle();
    channel(&mut model, (0, path), interpolation, times, values);
    model
}

/// Adds a channel to the only animation.
pub fn channel(model: &mut Model, (node, path): (usize, &str), interpolation: &str, times: &[f32], values: &[f32]) {
    let (kind, width) = match path {
        "rotation" => ("VEC4", 4),
        "weights" => ("SCALAR", 1),
        _ => ("VEC3", 3),
    };
    let input = model.accessor("SCALAR", F32, times.len(), &floats(times));
    let output = model.accessor(kind, F32, values.len() / width, &floats(values));
    if model.json.get("animations").is_none() {
        model.json["animations"] = json!([{ "name": "walk", "samplers": [], "channels": [] }]);
    }
    let animation = &mut model.json["animations"][0];
    let samplers = animation["samplers"].as_array_mut().unwrap();
    samplers.push(json!({ "input": input, "output": output, "interpolation": interpolation }));
    let sampler = samplers.len() - 1;
    let channels = animation["channels"].as_array_mut().unwrap();
    channels.push(json!({ "sampler": sampler, "target": { "node": node, "path": path } }));
}

fn at(model: &Model, seconds: f64) -> Gltf {
    parse_at(&model.glb(), Moment { animation: None, seconds: Some(seconds) }).unwrap()
}

/// Where the triangle's corners are: the origin, and those on the axes x and y.
fn corners(model: &Model, seconds: f64) -> [Vec3; 3] {
    at(model, seconds).obj.mesh.positions[..3].try_into().unwrap()
}

fn assert_near(found: Vec3, wanted: DVec3, what: &str) {
    assert!((found.as_dvec3() - wanted).length() < 1e-5, "{what}: {found} is not {wanted}");
}

#[test]
fn values_go_straight_from_key_to_key_and_stand_still_before_and_after() {
    let model = moving("translation", "LINEAR", &[1.0, 2.0, 4.0], &[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 6.0, 0.0]);
    for (seconds, wanted) in [
        (-1.0, [0.0, 0.0]),
        (1.0, [0.0, 0.0]),
        (1.25, [0.5, 0.0]),
        (2.0, [2.0, 0.0]),
        (2.5, [2.0, 1.5]),
        (4.0, [2.0, 6.0]),
        (99.0, [2.0, 6.0]),
    ] {
        assert_near(corners(&model, seconds)[0], DVec3::new(wanted[0], wanted[1], 0.0), &format!("{seconds} s"));
    }
    let steps = moving("scale", "STEP", &[0.0, 1.0], &[1.0, 1.0, 1.0, 3.0, 3.0, 3.0]);
    for (seconds, size) in [(0.0, 1.0), (0.999, 1.0), (1.0, 3.0), (5.0, 3.0)] {
        assert_near(corners(&steps, seconds)[1], DVec3::X * size, &format!("{seconds} s"));
    }
}

/// Adds a channel whose pointer names what it changes.
fn pointing(model: &mut Model, pointer: &str, kind: &str, values: &[f32]) {
    channel(model, (0, "pointer"), "LINEAR", &[0.0, 1.0], &[0.0; 6]);
    let width = if kind == "SCALAR" { 1 } else { kind[3..].parse().unwrap() };
    let output = model.accessor(kind, F32, values.len() / width, &floats(values));
    let animation = &mut model.json["animations"][0];
    animation["samplers"].as_array_mut().unwrap().last_mut().unwrap()["output"] = json!(output);
    let target = &mut animation["channels"].as_array_mut().unwrap().last_mut().unwrap()["target"];
    *target = json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": pointer } } });
}

#[test]
fn pointers_change_materials_cameras_lights_and_nodes() {
    let mut model = Model::triangle();
    model.json["materials"] = json!([{}]);
    model.primitive()["material"] = json!(0);
    model.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } }]);
    let light = json!({ "type": "point", "intensity": 1.0 });
    model.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
    let of_light = json!({ "KHR_lights_punctual": { "light": 0 } });
    let nodes = model.json["nodes"].as_array_mut().unwrap();
    nodes.push(json!({ "camera": 0, "extensions": of_light }));
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    let colours = [0.0, 0.25, 0.5, 1.0, 1.0, 0.25, 0.0, 1.0];
    pointing(&mut model, "/materials/0/pbrMetallicRoughness/baseColorFactor", "VEC4", &colours);
    pointing(&mut model, "/materials/0/pbrMetallicRoughness/roughnessFactor", "SCALAR", &[0.25, 0.75]);
    pointing(&mut model, "/cameras/0/perspective/yfov", "SCALAR", &[0.5, 1.5]);
    pointing(&mut model, "/extensions/KHR_lights_punctual/lights/0/intensity", "SCALAR", &[1.0, 5.0]);
    pointing(&mut model, "/nodes/0/translation", "VEC3", &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    let moved = at(&model, 0.5);
    assert_eq!(moved.obj.mesh.positions[0], Vec3::X * 2.0);
    let (_, material) = moved.obj.materials.last().unwrap();
    let physical = &material.physical;
    assert_eq!((physical.base, physical.roughness), (Some(Vec3::new(0.5, 0.25, 0.25)), Some(0.5)));
    assert!((moved.cameras[0].projection.fov().unwrap() - 1f32.to_degrees()).abs() < 1e-4);
    let [one, three] = [0.0, 0.5].map(|seconds| match &at(&model, seconds).lights[0] {
        Light::Point { colour, .. } => colour.x,
        other => panic!("{other:?}"),
    });
    assert!((three / one - 3.0).abs() < 1e-5, "{one}, {three}");
}

#[test]
fn pointers_that_lead_nowhere_are_refused_in_a_line() {
    for (pointer, wanted) in [
        ("/materials/9/alphaCutoff", "names an element that is not there"),
        ("/accessors/0/count", "names nothing that is drawn"),
        ("/nodes/9/translation", "there is"),
        ("/nodes/0/name/x", "names an element that is not there"),
        ("/nodes/0/name", "names no number"),
        ("nodes/0/scale", "names nothing that is drawn"),
        ("/nodes/0/mesh", "write the file again"),
        ("", "names nothing that is drawn"),
    ] {
        let mut model = Model::triangle();
        model.json["nodes"][0]["name"] = json!("a");
        pointing(&mut model, pointer, "SCALAR", &[0.5, 0.75]);
        let fault = parse_at(&model.glb(), Moment { animation: None, seconds: Some(0.5) }).unwrap_err().message();
        assert!(fault.contains(wanted) && !fault.contains('\n'), "{pointer}: {fault}");
    }
}

/// Keys of a cubic with its own slopes are that cubic between them.
#[test]
fn cubic_splines_are_the_cubics_that_their_keys_are_of() {
    let of = |t: f32| (t * t * t - 2.0 * t * t + 0.5, 3.0 * t * t - 4.0 * t);
    let times = [0.5f32, 1.0, 3.0];
    let key = |&t: &f32| {
        let (value, slope) = of(t);
        [slope, 0.0, 0.0, value, 0.0, 1.0, slope, 0.0, 0.0]
    };
    let values: Vec<f32> = times.iter().flat_map(key).collect();
    let model = moving("translation", "CUBICSPLINE", &times, &values);
    for seconds in [0.5f32, 0.6, 0.9, 1.0, 1.7, 2.9, 3.0] {
        let wanted = DVec3::new(of(seconds).0.into(), 0.0, 1.0);
        assert_near(corners(&model, seconds.into())[0], wanted, &format!("{seconds} s"));
    }
}

/// At an even speed, by the shorter way, also where a quaternion is the other of its two.
#[test]
fn turns_go_at_an_even_speed_by_the_shorter_way() {
    let turn = |degrees: f64, sign: f64| {
        let half = degrees.to_radians() / 2.0;
        [0.0, 0.0, (sign * crate::math::sin(half)) as f32, (sign * crate::math::cos(half)) as f32]
    };
    for sign in [1.0, -1.0] {
        let keys = [turn(10.0, 1.0), turn(150.0, sign), turn(150.0001, 1.0)].concat();
        let model = moving("rotation", "LINEAR", &[0.0, 2.0, 3.0], &keys);
        for share in [0.0, 0.1, 0.5, 0.9, 1.0, 1.3] {
            let degrees = if share > 1.0 { 150.0 } else { 10.0 + 140.0 * share };
            let (sine, cosine) = crate::math::sin_cos(f64::to_radians(degrees));
            let found = corners(&model, 2.0 * share);
            assert_near(found[1], DVec3::new(cosine, sine, 0.0), &format!("{sign} {share}"));
            assert_near(found[2], DVec3::new(-sine, cosine, 0.0), &format!("{sign} {share}"));
        }
    }
}

#[test]
fn weights_of_targets_follow_and_so_do_children_joints_cameras_and_lights() {
    let mut model = Model::triangle();
    let up = model.accessor("VEC3", F32, 3, &floats(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0]));
    let away = model.accessor("VEC3", F32, 3, &floats(&[[0.0, 0.0, 4.0]; 3].concat()));
    model.primitive()["targets"] = json!([{ "POSITION": up }, { "POSITION": away }]);
    channel(&mut model, (0, "weights"), "LINEAR", &[0.0, 1.0], &[0.0, 0.5, 1.0, 0.0]);
    let [origin, _, corner] = corners(&model, 0.25);
    assert_eq!((origin, corner), (Vec3::new(0.0, 0.0, 1.5), Vec3::new(0.0, 1.5, 1.5)));

    let mut model = Model::triangle();
    let joints = model.accessor("VEC4", 5121, 3, &[0; 12]);
    let weights = model.accessor("VEC4", F32, 3, &floats(&[[1.0, 0.0, 0.0, 0.0]; 3].concat()));
    model.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    model.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
    model.json["skins"] = json!([{ "joints": [1] }]);
    model.json["cameras"] = json!([{ "perspective": { "yfov": 1 } }]);
    model.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    let light = json!({ "KHR_lights_punctual": { "light": 0 } });
    model.json["nodes"] = json!([
        { "mesh": 0, "skin": 0 }, { "children": [2] }, { "camera": 0, "extensions": light, "translation": [0, 0, 1] },
    ]);
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    channel(&mut model, (1, "translation"), "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 8.0, 0.0, 0.0]);
    let scene = at(&model, 0.5);
    assert_eq!(scene.obj.mesh.positions[1], Vec3::new(5.0, 0.0, 0.0), "the skin");
    assert_eq!(scene.cameras[0].eye, Vec3::new(4.0, 0.0, 1.0), "the camera");
    let crate::scene::Light::Point { position, .. } = scene.lights[0] else { panic!("no point light") };
    assert_eq!(position, Vec3::new(4.0, 0.0, 1.0));
}

#[test]
fn the_first_animation_stands_at_its_start_and_says_so_unless_another_moment_is_asked_for() {
    let mut model = moving("translation", "LINEAR", &[1.0, 2.0], &[7.0, 0.0, 0.0, 8.0, 0.0, 0.0]);
    let animations = model.json["animations"].as_array_mut().unwrap();
    let mut other = animations[0].clone();
    other["name"] = json!("run");
    other["samplers"][0]["interpolation"] = json!("STEP");
    animations.push(other);
    let first = parse(&model.glb()).unwrap();
    assert_eq!(first.obj.mesh.positions[0], Vec3::new(7.0, 0.0, 0.0));
    let warnings = said(&first.obj.warnings);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("its animation \"walk\" stands at its start"), "{warnings:?}");
    let listed: Vec<_> = first.animations.iter().map(|animation| (&animation.name[..], animation.seconds)).collect();
    assert_eq!(listed, [("walk", 2.0), ("run", 2.0)]);
    let of = |wish: &str, seconds| {
        let scene = parse_at(&model.glb(), Moment { animation: Some(AnimationWish::of(wish)), seconds: Some(seconds) });
        scene.map(|scene| {
            assert!(scene.obj.warnings.is_empty(), "{:?}", scene.obj.warnings);
            scene.obj.mesh.positions[0].x
        })
    };
    for (wish, x) in [("none", 0.0), ("walk", 7.5), ("run", 7.0), ("0", 7.5), ("1", 7.0)] {
        assert_eq!(of(wish, 1.5).unwrap(), x, "{wish}");
    }
    let error = of("jump", 0.0).unwrap_err().to_string();
    assert!(error.contains("there is no \"jump\"; name one of walk, run, or none"), "{error}");
    // A node that a matrix places is placed by what an animation says of it.
    model.json["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 5, 5, 1]);
    assert_eq!(corners(&model, 2.0)[0], Vec3::new(8.0, 0.0, 0.0));
}

#[test]
fn animations_that_make_no_sense_are_one_line_each() {
    let refusal = |change: &dyn Fn(&mut Model)| {
        let mut model = moving("translation", "LINEAR", &[0.0, 1.0], &[0.0; 6]);
        change(&mut model);
        let error = parse(&model.glb()).expect_err("refused").to_string();
        assert!(!error.contains('\n'), "{error}");
        error
    };
    let times = |times: &'static [f32]| {
        move |model: &mut Model| {
            let input = model.accessor("SCALAR", F32, times.len(), &floats(times));
            model.json["animations"][0]["samplers"][0]["input"] = json!(input);
        }
    };
    let key = |path: &'static [&'static str], value: serde_json::Value| {
        move |model: &mut Model| {
            let mut place = &mut model.json["animations"][0];
            for part in path {
                place = match part.parse::<usize>() {
                    Ok(number) => &mut place[number],
                    Err(_) => &mut place[*part],
                };
            }
            *place = value.clone();
        }
    };
    for (change, wanted) in [
        (&times(&[1.0, 1.0]) as &dyn Fn(&mut Model), "the time 1 of key 1 does not rise"),
        (&times(&[1.0, 0.5]), "the time 0.5 of key 1 does not rise"),
        (&times(&[f32::NAN, 1.0]), "the time NaN of key 0 does not rise"),
        (&times(&[0.0, f32::INFINITY]), "the time inf of key 1 does not rise"),
        (&times(&[]), "an animation has no key"),
        (&times(&[0.0, 1.0, 2.0]), "has 2 values for 3 keys"),
        (&key(&["samplers", "0", "interpolation"], json!("SPLINE")), "the interpolation \"SPLINE\""),
        (&key(&["samplers", "0", "interpolation"], json!("CUBICSPLINE")), "has 2 values for 2 keys"),
        (&key(&["samplers", "0", "input"], json!(99)), "accessor"),
        (&key(&["samplers", "0", "output"], json!(99)), "accessor"),
        (&key(&["channels", "0", "sampler"], json!(9)), "animations[0].channels[0].sampler"),
        (&key(&["channels", "0", "target", "node"], json!(9)), "animations[0].channels[0].target.node"),
        (&key(&["channels", "0", "target", "path"], json!("rotation")), "is not VEC4"),
    ] {
        let error = refusal(change);
        assert!(error.contains(wanted), "{error}");
    }
    // What is not there to be moved is left out with a warning.
    let mut model = moving("translation", "LINEAR", &[0.0, 1.0], &[0.0; 6]);
    model.json["animations"][0]["channels"][0]["target"] = json!({ "path": "pointer" });
    let warnings = said(&parse(&model.glb()).unwrap().obj.warnings);
    assert!(warnings.iter().any(|warning| warning.contains("it names no node and is left out")), "{warnings:?}");
    model.json["animations"][0]["channels"][0]["target"] = json!({ "node": 0, "path": "colour" });
    let warnings = said(&parse(&model.glb()).unwrap().obj.warnings);
    assert!(warnings.iter().any(|warning| warning.contains("\"colour\" are left out")), "{warnings:?}");
    // Numbers that are none put a node nowhere.
    let model = moving("translation", "LINEAR", &[0.0, 1.0], &[f32::NAN; 6]);
    let error = parse(&model.glb()).expect_err("refused").to_string();
    assert!(error.contains("nodes[0] takes it out of single precision"), "{error}");
    // Zeros that take no bytes of the file.
    let mut model = moving("weights", "LINEAR", &[0.0], &[0.0]);
    let accessors = model.json["accessors"].as_array_mut().unwrap();
    accessors.push(json!({ "componentType": F32, "count": 4_000_000_000u64, "type": "SCALAR" }));
    let output = accessors.len() - 1;
    model.json["animations"][0]["samplers"][0]["output"] = json!(output);
    let error = parse(&model.glb()).expect_err("refused").to_string();
    assert!(error.contains("the weights of animations are too many"), "{error}");
}
