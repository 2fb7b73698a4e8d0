//! Files of strangers: refused in a line that says where, or read in full, but never a panic and never a long wait.

use std::path::Path;

use glam::Vec3;
use serde_json::{Value, json};

use super::model::{F32, Model, U16, data, floats, parse, picture, shorts};
use crate::scene_io::load::load_within;
use crate::scene_io::tests::{Folder, budget};
use crate::scene_io::{Instancing, Loading, gltf};

/// Asserts why a file is refused.
fn assert_refused(bytes: &[u8], why: &str) {
    let error = parse(bytes).expect_err(why).to_string();
    assert!(error.starts_with("/nowhere/a.glb: ") && !error.contains('\n'), "{error}");
    assert!(error.contains(why), "{error}, wanted: {why}");
}

/// A triangle whose JSON has another value at a path: `/accessors/0/count`.
fn changed(path: &str, value: Value) -> Vec<u8> {
    let mut model = Model::triangle();
    set(&mut model.json, path, value);
    model.glb()
}

fn set(json: &mut Value, path: &str, value: Value) {
    let (parent, key) = path.rsplit_once('/').unwrap();
    let parent = json.pointer_mut(parent).unwrap();
    match key.parse::<usize>() {
        Ok(number) => parent[number] = value,
        Err(_) => parent[key] = value,
    }
}

#[test]
fn numbers_that_name_nothing_are_refused_where_they_stand() {
    for (path, value, why) in [
        ("/accessors/0/bufferView", json!(9), "accessors[0].bufferView: there is no buffer view 9; the file has 1"),
        ("/accessors/0/componentType", json!(5124), "accessors[0].componentType: 5124 is none of"),
        ("/accessors/0/type", json!("VEC2"), "accessors[0].type: \"VEC2\" is not VEC3"),
        (
            "/accessors/0/count",
            json!(4),
            "accessors[0]: 4 elements of 12 bytes from 0 are more than the 36 of buffer view 0",
        ),
        ("/accessors/0/count", json!(u64::MAX), "accessors[0].count"),
        ("/accessors/0/count", json!(-1), "accessors[0].count: -1 makes no sense here"),
        ("/accessors/0/count", json!(3.5), "accessors[0].count: 3.5 makes no sense here (line 1, column "),
        ("/accessors/0/type", json!({}), "accessors[0].type: a table makes no sense here"),
        ("/nodes/0/extensions", json!(null), "nodes[0].extensions: null makes no sense here"),
        ("/accessors/0/byteOffset", json!(u64::MAX), "accessors[0]: 3 elements"),
        ("/bufferViews/0/byteLength", json!(40), "bufferViews[0]: 40 bytes from 0 are more than the 36 of buffer 0"),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), "bufferViews[0]: 36 bytes"),
        ("/bufferViews/0/buffer", json!(1), "bufferViews[0].buffer: there is no buffer 1; the file has 1"),
        ("/bufferViews/0/byteStride", json!(4), "bufferViews[0].byteStride: 4 is less than"),
        (
            "/meshes/0/primitives/0/attributes/POSITION",
            json!(3),
            "primitives[0].attributes.POSITION: there is no accessor 3",
        ),
        ("/meshes/0/primitives/0/indices", json!(1), "meshes[0].primitives[0].indices: there is no accessor 1"),
        (
            "/meshes/0/primitives/0/material",
            json!(0),
            "primitives[0].material: there is no material 0; the file has none",
        ),
        ("/meshes/0/primitives/0/mode", json!(7), "meshes[0].primitives[0].mode: 7 is none of"),
        ("/meshes/0/primitives/0/indices", json!(0), "accessors[0].type: \"VEC3\" is not SCALAR"),
        ("/asset/minVersion", json!("2.1"), "asset.minVersion: this needs a reader of glTF 2.1"),
        ("/nodes/0/mesh", json!(1), "nodes[0].mesh: there is no mesh 1"),
        ("/nodes/0/children", json!([5]), "nodes[0].children: there is no node 5"),
        ("/nodes/0/children", json!([0]), "nodes[0]: it is reached twice"),
        ("/nodes/0/children", json!([0, 0]), "nodes[0].children: node 0 has two parents"),
        ("/nodes/0/matrix", json!([1, 0]), "nodes[0].matrix: it has 2 numbers and needs 16"),
        ("/nodes/0/scale", json!([1e300, 1e300, 1]), "nodes[0] takes it out of single precision"),
        ("/nodes/0/camera", json!(0), "nodes[0].camera: there is no camera 0"),
        ("/scene", json!(1), "scene: there is no scene 1"),
        ("/scenes/0/nodes", json!([1]), "scenes[0].nodes: there is no node 1"),
        ("/scenes/0/nodes", json!([]), "there is no triangle in its scene"),
        (
            "/extensionsRequired",
            json!(["KHR_draco_mesh_compression"]),
            "\"KHR_draco_mesh_compression\" is not read; save its meshes without compression",
        ),
        ("/asset/version", json!("1.0"), "this is glTF 1.0; convert it to 2.0"),
    ] {
        assert_refused(&changed(path, value), why);
    }
}

#[test]
fn places_that_are_none_and_corners_out_of_range_are_refused() {
    let mut model = Model::triangle();
    model.bytes[..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_refused(&model.glb(), "meshes[0].primitives[0].attributes.POSITION: vertex 0 is at [NaN, 0, 0]");
    let mut model = Model::triangle();
    let indices = model.accessor("SCALAR", U16, 3, &shorts(&[0, 1, 3]));
    model.primitive()["indices"] = json!(indices);
    assert_refused(&model.glb(), "meshes[0].primitives[0].indices: corner 2 names vertex 3 of 3");
    let normal = model.accessor("VEC3", F32, 1, &floats(&[0.0, 0.0, 1.0]));
    model.bytes[40..42].copy_from_slice(&[2, 0]);
    model.primitive()["attributes"]["NORMAL"] = json!(normal);
    assert_refused(&model.glb(), "attributes.NORMAL: it has 1 elements for 3 positions");
}

#[test]
fn files_that_end_early_or_are_of_another_kind_are_refused() {
    let whole = Model::triangle().glb();
    for (bytes, why) in [
        (&whole[..10], "the file ends early"),
        (&whole[..30], "the file ends early"),
        (&whole[..whole.len() - 4], "the file ends early"),
        (b"glTF\x01\0\0\0\0\0\0\0", "a binary glTF of version 1"),
        (b"solid thing", "the JSON: it does not begin with {; write the file again as glTF 2.0"),
        (b"{}", "there is no triangle"),
        (b"[]", "the JSON: it does not begin with {"),
    ] {
        assert_refused(bytes, why);
    }
    let mut longer = whole.clone();
    longer[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_refused(&longer, "a chunk claims 4294967295 bytes");
}

#[test]
fn too_many_triangles_are_refused_before_they_are_made() {
    let mut model = Model::triangle();
    // Zeros that take no bytes.
    model.json["accessors"][0] = json!({ "componentType": F32, "count": u32::MAX, "type": "VEC3" });
    assert_refused(&model.glb(), "use fewer");
    let mut model = Model::triangle();
    model.json["accessors"][0] = json!({ "componentType": F32, "count": 30_000, "type": "VEC3" });
    let nodes = 20_000;
    model.json["nodes"] = (0..nodes).map(|_| json!({ "mesh": 0 })).collect();
    model.json["scenes"][0]["nodes"] = (0..nodes).collect();
    // Which are held once; but not if each is to have triangles of its own.
    assert_eq!(parse(&model.glb()).unwrap().obj.copies.places.len(), nodes);
    let folder = Folder::new(&[("a.glb", &model.glb())]);
    let apart = Loading { instancing: Instancing::Never, ..Loading::default() };
    let error = load_within(&folder.path("a.glb"), budget(1 << 34), apart).unwrap_err().to_string();
    assert!(error.contains("a.glb: 200000000 triangles with") && error.contains("use fewer"), "{error}");
    let mut text = br#"{"nodes":["#.to_vec();
    text.extend(b"{},".repeat(1_000_001));
    text.extend(b"{}]}");
    assert_refused(&text, "a list has more than 1000000 elements");
}

/// Tables of three bytes become records of hundreds.
#[test]
fn json_that_there_is_no_memory_for_is_refused_before_it_is_read() {
    let json = format!("{{\"asset\": {{}}, \"materials\": [{{}}{}]}}", ",{}".repeat(500_000));
    let error =
        gltf::parse(Path::new("/nowhere/a.gltf"), json.as_bytes(), budget(1 << 28), Loading::default()).unwrap_err();
    assert!(error.message().starts_with("its JSON would take about"), "{error}");
    // A long text is no table.
    let data = format!("{{\"asset\": {{\"generator\": \"{}\"}}}}", "A".repeat(1 << 24));
    let error =
        gltf::parse(Path::new("/nowhere/a.gltf"), data.as_bytes(), budget(1 << 28), Loading::default()).unwrap_err();
    assert!(error.message().starts_with("there is no triangle"), "{error}");
}

#[test]
fn a_chain_of_many_nodes_is_walked() {
    let mut model = Model::triangle();
    let nodes = 100_000;
    let node = |number: u32| json!({ "children": [number + 1], "translation": [0.5, 0, 0] });
    model.json["nodes"] = (0..nodes).map(node).chain([json!({ "mesh": 0 })]).collect();
    let mesh = parse(&model.glb()).unwrap().obj.mesh;
    assert_eq!(mesh.positions[0], Vec3::new(50_000.0, 0.0, 0.0));
}

#[test]
fn only_files_in_the_folder_are_read() {
    let model = Model::triangle();
    let with = |uri: &str| {
        let mut json = model.json.clone();
        json["buffers"] = json!([{ "uri": uri, "byteLength": model.bytes.len() }]);
        serde_json::to_vec(&json).unwrap()
    };
    for (uri, why) in [
        ("https://example.org/a.bin", "buffers[0].uri: \"https://example.org/a.bin\" is an address and is not fetched"),
        ("file:///a.bin", "is an address"),
        ("/a.bin", "there is no such file in this file's folder or below; copy it there, or add --allow-outside"),
        ("b/%2e%2e/../a.bin", "there is no such file in this file's folder"),
        ("%2Fa.bin", "there is no such file in this file's folder"),
        ("C:/a.bin", "there is no such file in this file's folder"),
        ("none.bin", "buffers[0].uri: \"none.bin\": there is no such file"),
        ("data:;base64,AAAA", "buffers[0].byteLength: it claims 36 bytes and there are 3"),
        ("data:;base64,!", "is not base64"),
        ("data:text/plain,x", "is not in base64"),
    ] {
        assert_refused(&with(uri), why);
    }
    let folder = Folder::new(&[("my triangle.bin", &model.bytes), ("a.gltf", &with("my%20triangle.bin"))]);
    let (scene, _) = folder.load("a.gltf").unwrap();
    assert_eq!(scene.files, [folder.path("my triangle.bin")]);
}

#[test]
fn surfaces_are_drawn_without_pictures_that_cannot_be_read_with_a_warning() {
    for (path, value, why) in [
        ("/images/0/uri", json!("missing.png"), "images[0].uri: \"missing.png\": there is no such file"),
        ("/images/0/uri", json!("https://example.org/a.png"), "is an address and is not fetched"),
        (
            "/images/0/uri",
            json!(data(b"GIF picture")),
            "images[0].uri: the image is not a PNG, JPEG, TGA, BMP, TIFF, EXR or HDR",
        ),
        ("/images/0/uri", json!(data(&picture()[..40])), "images[0].uri: the image "),
        ("/images/0", json!({}), "images[0]: there is neither a uri nor a bufferView"),
    ] {
        let mut model = Model::everything();
        set(&mut model.json, path, value);
        let obj = parse(&model.glb()).unwrap().obj;
        assert!(obj.materials.iter().all(|(_, fields)| fields.maps.all().count() == 0), "{why}");
        let told: Vec<_> = obj.warnings.iter().filter(|warning| warning.message.contains(why)).collect();
        assert!(
            told.len() == 1 && told[0].message.ends_with("surfaces are drawn without"),
            "{:?}, wanted: {why}",
            obj.warnings
        );
    }
}

#[test]
fn textures_that_make_no_sense_are_refused() {
    let textured = |path: &str, value: Value| {
        let mut model = Model::everything();
        set(&mut model.json, path, value);
        model.glb()
    };
    for (path, value, why) in [
        ("/textures/0/source", json!(2), "textures[0].source: there is no image 2; the file has 1"),
        ("/textures/0/sampler", json!(2), "textures[0].sampler: there is no sampler 2"),
        ("/materials/0/normalTexture/index", json!(2), "materials[0].normalTexture.index: there is no texture 2"),
        (
            "/materials/0/emissiveFactor",
            json!([-1, 0, 0]),
            "materials[0].emissiveFactor: -1 must be a finite number of at least 0",
        ),
        ("/cameras/0/perspective/yfov", json!(9), "cameras[0].perspective.yfov"),
        ("/extensions/KHR_lights_punctual/lights/0/type", json!("sun"), "lights[0].type: \"sun\" is none of"),
        ("/extensions/KHR_lights_punctual/lights/0/intensity", json!(-3), "below 0"),
    ] {
        assert_refused(&textured(path, value), why);
    }
}
