//! What of a file is not drawn, or drawn in another way, is said once.

use serde_json::json;

use super::model::{Model, data, picture};
use crate::scene::{Alpha, Light};

#[test]
fn what_is_left_out_is_said_once() {
    let mut model = Model::triangle();
    let primitive = model.primitive().clone();
    let mut points = primitive.clone();
    points["mode"] = json!(0);
    let mut morphed = primitive.clone();
    morphed["targets"] = json!([{ "TEXCOORD_0": 0 }]);
    model.json["meshes"][0]["primitives"] = json!([points, points, morphed, morphed]);
    model.json["animations"] = json!([{}, {}]);
    model.json["extensionsUsed"] = json!(["EXT_lights_image_based", "KHR_materials_ior"]);
    let warnings = model.load().obj.warnings;
    let wanted = ["EXT_lights_image_based", "its animation \"0\" stands", "points and lines", "morph targets"];
    assert_eq!(warnings.len(), wanted.len(), "{warnings:?}");
    for (warning, wanted) in warnings.iter().zip(wanted) {
        assert!(warning.message.contains(wanted), "{warning}");
    }
}

/// A triangle of one material.
fn with(material: serde_json::Value) -> Model {
    let mut model = Model::triangle();
    model.json["materials"] = json!([material]);
    model.primitive()["material"] = json!(0);
    model
}

#[test]
fn a_mask_that_nothing_is_opaque_enough_for_hides_all() {
    let obj = with(json!({ "alphaMode": "MASK", "alphaCutoff": 1.5 })).load().obj;
    let material = obj.materials[1].1.clone().finish("a");
    assert_eq!((material.alpha, material.opacity, obj.warnings.len()), (Alpha::Mask(1.0), 0.0, 0));
}

#[test]
fn words_and_angles_that_make_no_sense_are_replaced() {
    let obj = with(json!({ "alphaMode": "CLIP", "name": "  " })).load().obj;
    assert_eq!((obj.materials[1].0.as_str(), obj.materials[1].1.alpha), ("material 0", Some(Alpha::Opaque)));
    assert!(obj.warnings[0].message.contains("materials[0].alphaMode: \"CLIP\" is none of OPAQUE, MASK and BLEND"));
    let mut model = Model::triangle();
    let spot = json!({ "innerConeAngle": 0.9, "outerConeAngle": 0.5 });
    model.json["extensions"] =
        json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot", "range": 5, "spot": spot }] } });
    model.json["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
    let scene = model.load();
    assert!(matches!(scene.lights[0], Light::Spot { outer, inner, .. } if inner == outer));
    let says = |what: &str| scene.obj.warnings.iter().filter(|warning| warning.message.contains(what)).count();
    assert_eq!((says("ranges of lights are left out"), says("innerConeAngle is more than outerConeAngle")), (1, 1));
}

#[test]
fn data_may_be_named_in_capitals_and_percent_encoded() {
    let mut model = with(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
    model.json["textures"] = json!([{ "source": 0 }]);
    for uri in [
        data(&picture()),
        data(&picture())
            .replacen("data:", "DATA:", 1)
            .replace(";base64,", ";BASE64,")
            .replace('=', "%3D")
            .replace('+', "%2B"),
    ] {
        model.json["images"] = json!([{ "uri": uri }]);
        assert_eq!(model.load().obj.materials[1].1.maps.all().count(), 1);
    }
}
