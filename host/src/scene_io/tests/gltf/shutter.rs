//! What moves while the shutter is open: found by reading a scene at several moments.

use glam::Vec3;
use serde_json::json;

use super::super::{Folder, said};
use super::animation::{channel, moving};
use super::model::{F32, Model, floats};
use crate::scene::{Motion, Scene};
use crate::scene_io::{Loading, Moment, Shutter, load_as};

/// A file from `seconds` on for so long, and its warnings.
fn over(bytes: &[u8], name: &str, seconds: f64, long: f64) -> (Scene, Vec<String>) {
    let folder = Folder::new(&[
        (name, bytes),
        ("a.glb", &moving("translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]).glb()),
    ]);
    let moment = Moment { animation: None, seconds: Some(seconds) };
    let shutter = Some(Shutter { open: 0.0, close: long, rolling: 0.5 });
    let (scene, warnings) = load_as(&folder.path(name), Loading { moment, shutter, ..Loading::default() }).unwrap();
    scene.check().unwrap();
    (scene, said(&warnings))
}

fn motion(model: &Model, seconds: f64, long: f64) -> (Scene, Motion) {
    let (scene, warnings) = over(&model.glb(), "b.glb", seconds, long);
    assert_eq!(warnings, [""; 0]);
    let motion = scene.motion.clone().expect("it moves");
    (scene, motion)
}

#[test]
fn a_node_that_goes_straight_has_one_step_and_one_that_turns_has_more() {
    let line = moving("translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    let (scene, motion) = self::motion(&line, 0.25, 0.5);
    assert_eq!((scene.instances.len(), scene.own_triangles(), motion.bent().count()), (1, 0, 0));
    assert_eq!(scene.instances[0].translation, Vec3::X);
    assert_eq!((motion.poses.len(), motion.exposure, motion.cameras.len()), (1, 0.5, 0));
    assert_eq!(motion.poses[0].instances[0].translation, Vec3::X * 3.0);

    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turn = moving("rotation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half]);
    let poses = self::motion(&turn, 0.0, 1.0).1.poses;
    assert_eq!(poses.len(), 32, "an arc of a quarter is 1/8192 off a chord of 1/16");
    assert!((poses[31].instances[0].rows[0] - Vec3::NEG_Y).length() < 1e-6, "{}", poses[31].instances[0].rows[0]);
    assert_eq!(self::motion(&turn, 0.0, 0.01).1.poses.len(), 1, "a hundredth of that looks straight");
}

#[test]
fn what_targets_and_joints_bend_has_other_shapes() {
    let mut model = Model::triangle();
    let up = model.accessor("VEC3", F32, 3, &floats(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0]));
    model.primitive()["targets"] = json!([{ "POSITION": up }]);
    channel(&mut model, (0, "weights"), "LINEAR", &[0.0, 1.0], &[0.0, 1.0]);
    let (scene, motion) = self::motion(&model, 0.0, 1.0);
    assert_eq!((scene.instances.len(), motion.bent().collect::<Vec<_>>(), motion.poses.len()), (1, vec![0], 1));
    assert_eq!(scene.mesh.positions[2], Vec3::Y);
    assert_eq!(motion.poses[0].shapes[0].1.positions, [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 3.0, 0.0)]);
}

#[test]
fn cameras_move_and_those_that_were_made_stay() {
    let mut model = Model::triangle();
    model.json["cameras"] = json!([{ "perspective": { "yfov": 1 } }]);
    model.json["nodes"] = json!([{ "mesh": 0 }, { "camera": 0, "translation": [0, 0, 5] }]);
    model.json["scenes"][0]["nodes"] = json!([0, 1]);
    channel(&mut model, (1, "translation"), "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 5.0, 1.0, 0.0, 5.0]);
    let (scene, motion) = self::motion(&model, 0.0, 1.0);
    assert_eq!((scene.instances.len(), motion.cameras.as_slice()), (0, &scene.cameras[..]));
    assert_eq!(motion.poses[0].cameras[0].eye, Vec3::new(1.0, 0.0, 5.0));
    let line = moving("translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    assert_eq!(self::motion(&line, 0.0, 1.0).1.cameras, [], "one that frames the scene");
}

#[test]
fn what_stands_still_is_as_it_is_without_a_shutter() {
    let line = moving("translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    let (scene, _) = over(&line.glb(), "b.glb", 2.0, 1.0);
    assert_eq!((scene.motion.as_ref(), scene.instances.len()), (None, 0));
    let (still, _) = over(&line.glb(), "b.glb", 2.0, 0.0);
    assert_eq!(Scene { files: Vec::new(), ..scene }, Scene { files: Vec::new(), ..still });
    let (_, warnings) = over(&Model::triangle().glb(), "b.glb", 0.0, 1.0);
    assert!(warnings[0].ends_with("nothing moves in it: the shutter shows nothing"), "{warnings:?}");
}

#[test]
fn lamps_and_lights_move_as_all_else() {
    let mut line = moving("translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    line.json["materials"] = json!([{ "emissiveFactor": [1, 1, 1] }]);
    line.json["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
    line.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    line.primitive()["material"] = json!(0);
    let (scene, motion) = motion(&line, 0.0, 1.0);
    assert_eq!((scene.instances.len(), &motion.lights[..]), (1, &[0][..]));
    assert_eq!(motion.poses[0].instances[0].translation, Vec3::X * 4.0);
    assert_eq!(motion.poses[0].lights[0].stance(), (Vec3::X * 4.0, None));
}

#[test]
fn whole_spheres_stand_still_and_are_named() {
    let toml = "[[mesh]]\nshape = \"sphere\"\n[[mesh.key]]\ntime = 0\n[[mesh.key]]\ntime = 1\ntranslate = [0, 0, 3]\n";
    let (scene, warnings) = over(toml.as_bytes(), "b.toml", 0.0, 1.0);
    assert_eq!((scene.motion, scene.spheres.len()), (None, 1));
    assert!(warnings[0].contains("\"sphere\" stands still while the shutter is open"), "{warnings:?}");
}

/// A file that a scene places moves there, and keys of the scene move it as a whole.
#[test]
fn keys_of_a_scene_and_animations_of_its_files_go_together() {
    let toml = "[[mesh]]\nfile = \"a.glb\"\n[[mesh.key]]\ntime = 0\n[[mesh.key]]\ntime = 1\ntranslate = [0, 0, 3]\n\
                [[mesh]]\nshape = \"box\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\ntranslate = [9, 0, 0]\n";
    let (scene, warnings) = over(toml.as_bytes(), "s.toml", 0.0, 1.0);
    assert_eq!(warnings, [""; 0]);
    let motion = scene.motion.as_ref().unwrap();
    assert_eq!((scene.instances.len(), scene.own_triangles()), (1, 12));
    assert_eq!(scene.instances[0].translation, Vec3::ZERO);
    assert_eq!(motion.poses.last().unwrap().instances[0].translation, Vec3::new(4.0, 0.0, 3.0));
    assert_eq!(scene.animations.iter().map(|of| of.name.as_str()).collect::<Vec<_>>(), ["keys", "walk"]);
}

#[test]
fn keys_and_shutters_that_make_no_sense_are_told_with_their_line() {
    let mesh = "[[mesh]]\nshape = \"box\"\n";
    for (text, fault) in [
        (
            format!("{mesh}[[mesh.key]]\ntime = 1\n[[mesh.key]]\ntime = 1\n"),
            "s.toml:6: the key at 1 is not after the one at 1",
        ),
        (format!("{mesh}[[mesh.key]]\nscale = 2\n"), "s.toml:3: a key needs \"time\""),
        (format!("{mesh}[[mesh.key]]\ntime = nan\n"), "s.toml:4"),
        (format!("{mesh}[[mesh.key]]\ntime = 0\nsize = 2\n"), "s.toml:5"),
        (format!("{mesh}[[mesh.key]]\ntime = 0\nscale = 0\n"), "s.toml:5"),
        (format!("[shutter]\nfps = 24\n{mesh}"), "s.toml:1: it does not say when it is open"),
        (format!("[shutter]\nframes = [1, 0]\n{mesh}"), "s.toml:2: it closes before it opens"),
        (
            format!("[shutter]\nframes = [0, 1]\nseconds = [0, 1]\n{mesh}"),
            "s.toml:2: seconds says when it is open, too",
        ),
        (format!("[shutter]\nframes = [0, 1]\nrolling = 2\n{mesh}"), "s.toml:3"),
        (format!("[shutter]\nframes = [0, 1]\nopen = 2\n{mesh}"), "s.toml:3"),
    ] {
        let error = Folder::new(&[("s.toml", text.as_bytes())]).refuse("s.toml").to_string();
        assert!(error.contains(fault), "{fault} is not in {error}");
    }
}
