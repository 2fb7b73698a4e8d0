//! The shapes that meshes have: where copies stand, what morph targets add, and which joints they follow.

use glam::Vec3;
use serde_json::json;

use super::super::said;
use super::model::{F32, Model, U16, floats, parse, shorts};

#[test]
fn a_node_with_instances_has_a_copy_of_its_mesh_at_each() {
    let mut model = Model::triangle();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let translation = model.accessor("VEC3", F32, 2, &floats(&[1.0, 0.0, 0.0, 0.0, 5.0, 0.0]));
    // Quaternions of two bytes: none, and a quarter turn about z.
    let bytes: Vec<u8> =
        [0i16, 0, 0, 32767, 0, 0, 23170, 23170].iter().flat_map(|number| number.to_le_bytes()).collect();
    let rotation = model.accessor("VEC4", 5122, 2, &bytes);
    model.json["accessors"][rotation]["normalized"] = json!(true);
    let scale = model.accessor("VEC3", F32, 2, &floats(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]));
    let attributes = json!({ "TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale });
    model.json["nodes"][0] = json!({
        "mesh": 0, "translation": [0, 0, 3], "extensions": { "EXT_mesh_gpu_instancing": { "attributes": attributes } }
    });
    model.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let scene = model.load();
    let mesh = &scene.obj.mesh;
    assert_eq!((mesh.triangles.len(), scene.obj.objects.len(), scene.obj.warnings.len()), (2, 1, 0));
    assert_eq!(mesh.positions[1], Vec3::new(2.0, 0.0, 3.0));
    assert!(mesh.positions[4].abs_diff_eq(Vec3::new(0.0, 7.0, 3.0), 1e-4), "{}", mesh.positions[4]);
    assert!(mesh.positions[5].abs_diff_eq(Vec3::new(-2.0, 5.0, 3.0), 1e-4), "{}", mesh.positions[5]);
    assert!((half - 23170.0 / 32767.0).abs() < 1e-4);
    model.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = json!(0);
    let error = parse(&model.glb()).unwrap_err().to_string();
    assert!(error.contains("attributes.SCALE: it has 3 elements beside 2 of another"), "{error}");
}

#[test]
fn more_instances_than_there_is_memory_for_are_refused_before_they_are_made() {
    let mut model = Model::triangle();
    // A list without a buffer view holds zeros, and takes no bytes of the file.
    model.json["accessors"].as_array_mut().unwrap().push(json!({
        "componentType": F32, "count": 200_000_000, "type": "VEC3"
    }));
    let instances = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 1 } } });
    model.json["nodes"][0]["extensions"] = instances;
    let error = parse(&model.glb()).unwrap_err().to_string();
    assert!(error.contains("200000000 copies of a mesh"), "{error}");
}

#[test]
fn morph_targets_add_what_the_weights_of_the_mesh_or_of_the_node_say() {
    let mut model = Model::triangle();
    let normal = model.accessor("VEC3", F32, 3, &floats(&[[0.0, 0.0, 1.0]; 3].concat()));
    let up = model.accessor("VEC3", F32, 3, &floats(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0]));
    let turn = model.accessor("VEC3", F32, 3, &floats(&[[0.0, 1.0, -1.0]; 3].concat()));
    // The second target moves the first corner alone.
    let (places, values) = (model.view(&shorts(&[0])), model.view(&floats(&[-4.0, 0.0, 0.0])));
    model.json["accessors"].as_array_mut().unwrap().push(json!({
        "componentType": F32, "count": 3, "type": "VEC3", "sparse": {
            "count": 1, "indices": { "bufferView": places, "componentType": U16 }, "values": { "bufferView": values }
        }
    }));
    let sparse = turn + 1;
    model.primitive()["attributes"]["NORMAL"] = json!(normal);
    model.primitive()["targets"] = json!([{ "POSITION": up, "NORMAL": turn }, { "POSITION": sparse }]);
    assert_eq!(model.mesh().positions, [Vec3::ZERO, Vec3::X, Vec3::Y], "no weight is 0");
    model.json["meshes"][0]["weights"] = json!([1.0]);
    let mesh = model.mesh();
    assert_eq!((mesh.positions[2], mesh.normals[0]), (3.0 * Vec3::Y, Vec3::Y));
    model.json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "weights": [0, 0.5] }]);
    model.json["scenes"] = json!([{ "nodes": [0, 1] }]);
    let scene = model.load();
    let positions = &scene.obj.mesh.positions;
    assert_eq!((positions[2], positions[3], positions[5]), (3.0 * Vec3::Y, Vec3::NEG_X * 2.0, Vec3::Y));
    assert_eq!(said(&scene.obj.warnings), [""; 0]);
    model.primitive()["targets"] = json!([{ "POSITION": normal + 4 }]);
    assert!(parse(&model.glb()).is_err(), "a target that is not there");
}

#[test]
fn a_mesh_with_a_skin_follows_its_joints_and_not_its_node() {
    let mut model = Model::triangle();
    let joints = model.accessor("VEC4", 5121, 3, &[0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    let weights = [[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0]];
    let weights = model.accessor("VEC4", F32, 3, &floats(&weights.concat()));
    model.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    model.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
    // The mesh was bound where the joints stood one unit along z.
    let bound = glam::Mat4::from_translation(Vec3::NEG_Z).to_cols_array();
    let inverse = model.accessor("MAT4", F32, 2, &floats(&[bound, bound].concat()));
    model.json["skins"] = json!([{ "joints": [1, 2], "inverseBindMatrices": inverse }]);
    model.json["nodes"] = json!([
        { "mesh": 0, "skin": 0, "translation": [100, 0, 0], "scale": [7, 7, 7] },
        { "translation": [0, 0, 1], "children": [2] },
        { "translation": [0, 4, 0] },
    ]);
    model.json["scenes"] = json!([{ "nodes": [0, 1] }]);
    let scene = model.load();
    let wanted = [Vec3::ZERO, Vec3::new(1.0, 4.0, 0.0), Vec3::new(0.0, 3.0, 0.0)];
    assert_eq!((&scene.obj.mesh.positions[..], scene.obj.warnings.len()), (&wanted[..], 0));
    model.json["accessors"][inverse]["count"] = json!(1);
    let error = parse(&model.glb()).unwrap_err().to_string();
    assert!(error.contains("skins[0].inverseBindMatrices: it has 1 matrices for 2 joints"), "{error}");
}

#[test]
fn a_primitive_without_positions_is_left_out_and_the_others_are_drawn() {
    let mut model = Model::triangle();
    let primitive = model.primitive().clone();
    model.json["meshes"][0]["primitives"] = json!([{ "attributes": {} }, primitive, { "attributes": {} }]);
    let obj = model.load().obj;
    assert_eq!((obj.mesh.triangles.len(), obj.warnings.len()), (1, 1));
    assert!(obj.warnings[0].message.contains("meshes[0].primitives[0] is left out"), "{:?}", obj.warnings);
}
