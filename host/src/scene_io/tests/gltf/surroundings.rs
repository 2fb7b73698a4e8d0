//! What a scene in glTF is lit by, and how it is seen.

use glam::Vec3;
use serde_json::{Value, json};

use super::super::Folder;
use super::model::{F32, Model, floats, parse};
use crate::scene::{Background, Falloff, Light, Projection, Scene};
use crate::scene_io::{LightUnit, Loading, load_as};

fn load(model: &Model) -> Scene {
    Folder::new(&[("a.glb", &model.glb())]).load("a.glb").unwrap().0
}

/// A triangle of area 1/2, and a similar one so many times as large that emits.
fn beside_a_lamp(size: f64, emission: Value) -> Model {
    let mut model = Model::triangle();
    let attributes = model.primitive()["attributes"].clone();
    model.json["materials"] = json!([emission]);
    model.json["meshes"].as_array_mut().unwrap().push(json!({
        "primitives": [{ "attributes": attributes, "material": 0 }]
    }));
    model.json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 1, "scale": [size, size, size] }]);
    model.json["scenes"] = json!([{ "nodes": [0, 1] }]);
    model
}

#[test]
fn a_small_thing_that_shines_leaves_the_studio_on_and_a_lamp_turns_it_off() {
    let green = json!({ "emissiveFactor": [0, 1, 0] });
    let bright = json!({
        "emissiveFactor": [0, 1, 0], "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 100 } }
    });
    // A mean of 1/3 on a share of the area of 1/401 and of 1/5; 100 times as bright on the smaller.
    for (size, emission, is_in_studio) in [(0.05, &green, true), (0.5, &green, false), (0.05, &bright, false)] {
        let scene = load(&beside_a_lamp(size, emission.clone()));
        let grey = Background::Colour(Vec3::splat(0.6));
        assert_eq!((scene.environment.is_some(), scene.background == grey), (is_in_studio, is_in_studio), "{size}");
    }
}

#[test]
fn lights_too_dim_to_show_anything_leave_the_studio_on() {
    // Of 3 units away 9 pi / 64 candela are the least.
    for (candela, is_in_studio) in [(0.3, true), (0.6, false), (1e5, false)] {
        let mut model = Model::triangle();
        let lights = json!({ "lights": [{ "type": "point", "intensity": candela }] });
        model.json["extensions"] = json!({ "KHR_lights_punctual": lights });
        model.json["nodes"] = json!([
            { "mesh": 0 },
            { "translation": [0.5, 0.5, 3], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        ]);
        model.json["scenes"] = json!([{ "nodes": [0, 1] }]);
        assert_eq!(load(&model).environment.is_some(), is_in_studio, "{candela}");
    }
}

fn of_lights(generator: &str) -> Model {
    let mut model = Model::triangle();
    model.json["asset"]["generator"] = json!(generator);
    let lights = json!([
        { "type": "point", "intensity": 54351.41306588226 },
        { "type": "directional", "intensity": 2049 },
        { "type": "spot", "intensity": 54351.41306588226, "spot": { "outerConeAngle": 0.7, "innerConeAngle": 0.2 } },
    ]);
    model.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": lights } });
    let carries = |light: u32| json!({ "extensions": { "KHR_lights_punctual": { "light": light } } });
    model.json["nodes"] = json!([{ "mesh": 0 }, carries(0), carries(1), carries(2)]);
    model.json["scenes"] = json!([{ "nodes": [0, 1, 2, 3] }]);
    model
}

fn brightness(lights: &[Light]) -> Vec<f32> {
    let colour = |light: &Light| match *light {
        Light::Point { colour, .. } | Light::Directional { colour, .. } | Light::Spot { colour, .. } => colour.x,
    };
    lights.iter().map(colour).collect()
}

/// The exporter's start-up lamp of 1000 W, and a sun of strength 3.
#[test]
fn lamps_of_blenders_exporter_have_the_watts_of_blender() {
    let scene = of_lights("Khronos glTF Blender I/O v5.0.21").load();
    let watts = 1000.0 / (4.0 * std::f32::consts::PI);
    assert_eq!(brightness(&scene.lights), [watts, 3.0, watts]);
    let [warning] = &scene.obj.warnings[..] else { panic!("{:?}", scene.obj.warnings) };
    assert!(warning.message.contains("divided by 683") && warning.message.contains("--light-unit gltf"), "{warning}");
    let scene = of_lights("COLLADA2GLTF").load();
    assert_eq!((brightness(&scene.lights)[1], scene.obj.warnings.len()), (2049.0, 0));
}

#[test]
fn a_unit_that_is_asked_for_is_taken_without_a_word() {
    let folder = Folder::new(&[("a.glb", &of_lights("Khronos glTF Blender I/O v5.0.21").glb())]);
    let of = |unit| load_as(&folder.path("a.glb"), Loading { light_unit: Some(unit), ..Loading::default() }).unwrap();
    let (scene, warnings) = of(LightUnit::Gltf);
    assert_eq!((brightness(&scene.lights)[1], warnings.len()), (2049.0, 0));
    let (scene, _) = of(LightUnit::Raw);
    let wanted = 54351.41306588226 / (4.0 * std::f64::consts::PI);
    assert_eq!(brightness(&scene.lights)[..2], [wanted as f32, 2049.0]);
}

#[test]
fn spots_fade_as_their_extension_says() {
    let scene = of_lights("").load();
    assert!(matches!(scene.lights[2], Light::Spot { falloff: Falloff::Gltf, .. }), "{:?}", scene.lights[2]);
}

#[test]
fn the_first_cameras_aspect_ratio_shapes_the_picture() {
    let mut model = Model::triangle();
    let camera =
        |aspect: Value| json!([{ "type": "perspective", "perspective": { "yfov": 1, "aspectRatio": aspect } }]);
    model.json["nodes"][0]["camera"] = json!(0);
    for (aspect, size) in [(json!(1), (512, 512)), (json!(4), (1024, 256)), (json!(1.7777778), (683, 384))] {
        model.json["cameras"] = camera(aspect);
        assert_eq!(load(&model).settings.size, size);
    }
    model.json["cameras"] = camera(json!(0));
    assert_eq!(load(&model).settings.size, (512, 512), "no shape at all");
}

#[test]
fn an_orthographic_camera_has_a_height_and_a_shape() {
    let mut model = Model::triangle();
    model.json["nodes"][0]["camera"] = json!(0);
    model.json["cameras"] = json!([{ "type": "orthographic", "orthographic": { "xmag": 6, "ymag": 1.5 } }]);
    let scene = load(&model);
    assert_eq!(scene.cameras[0].projection, Projection::Orthographic { height: 3.0 });
    assert_eq!(scene.settings.size, (1024, 256));
    model.json["cameras"][0]["orthographic"]["ymag"] = json!(0);
    assert_eq!(load(&model).cameras[0].name, "default", "it is left out");
}

#[test]
fn colours_of_vertices_are_multiplied_with_what_is_unlit() {
    let mut model = Model::triangle();
    model.json["materials"] = json!([{ "extensions": { "KHR_materials_unlit": {} } }, {}]);
    let colours = model.accessor("VEC3", F32, 3, &floats(&[[1.0, 0.0, 0.0]; 3].concat()));
    model.primitive()["attributes"]["COLOR_0"] = json!(colours);
    model.primitive()["material"] = json!(0);
    let scene = load(&model);
    assert!(scene.materials[0].emission_is_coloured, "{:?}", scene.materials);
    let warnings = model.load().obj.warnings;
    assert!(!warnings.iter().any(|warning| warning.message.contains("colours")), "{warnings:?}");
}

#[test]
fn a_file_of_another_version_and_an_empty_first_scene_are_told() {
    let error = parse(br#"{"asset": {"version": "1.0"}, "accessors": {}, "buffers": {}, "scenes": {}}"#).unwrap_err();
    assert!(error.message().contains("this is glTF 1.0; convert it to 2.0"), "{error}");
    let mut model = Model::triangle();
    model.json["scenes"] = json!([{ "name": "empty" }, { "nodes": [0] }]);
    let error = parse(&model.glb()).unwrap_err();
    let wanted = "scene: it is not given, and the first of 2 scenes, which is shown then, holds no triangle; \
                  write \"scene\": 1 into the JSON";
    assert!(error.message().contains(wanted), "{error}");
    model.json["scene"] = json!(1);
    assert_eq!(model.mesh().triangles.len(), 1);
}

#[test]
fn whole_numbers_may_have_a_point() {
    let model = Model::triangle();
    let text = String::from_utf8(model.gltf()).unwrap();
    let floats = text.replace("\"count\":3", "\"count\":3.0").replace("\"mesh\":0", "\"mesh\":0.00");
    assert_ne!(floats, text);
    assert_eq!(parse(floats.as_bytes()).unwrap().obj.mesh, model.mesh());
    assert!(parse(text.replace("\"count\":3", "\"count\":3.5").as_bytes()).is_err());
}

/// Of whatever else exporters keep there nothing is asked.
#[test]
fn a_light_is_in_the_group_that_its_extras_name() {
    for (extras, group, warnings) in [
        (json!({ "group": "key", "other": [1, 2] }), "key", 0),
        (json!({ "group": "a.b" }), "", 1),
        (json!({ "group": "rest" }), "", 1),
        (json!({ "group": 7 }), "", 0),
        (json!("text"), "", 0),
        (json!(null), "", 0),
    ] {
        let mut model = Model::triangle();
        let light = json!({ "type": "point", "extras": extras });
        model.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
        model.json["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
        let scene = model.load();
        assert_eq!((scene.lights[0].group(), scene.obj.warnings.len()), (group, warnings), "{extras}");
    }
}
