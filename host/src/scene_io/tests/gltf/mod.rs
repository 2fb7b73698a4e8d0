//! Scenes in glTF: what comes out of them.

mod animation;
mod damaged;
mod finish;
mod hostile;
mod left_out;
mod model;
mod shape;
mod shutter;
mod surroundings;

use glam::{Vec2, Vec3, Vec4};
use serde_json::json;

use self::model::{F32, Model, U16, data, floats, picture, shorts};
use super::Folder;
use crate::scene::{Alpha, Background, Integrator, Light, Primitives, Texels, Wall, Wrap};
use crate::scene_io::gltf::Gltf;
use crate::scene_io::tests::said;

#[test]
fn a_triangle_is_a_scene_in_a_studio_and_a_mesh_of_a_scene() {
    let mut model = Model::triangle();
    let toml = b"[[mesh]]\nfile = \"a.glb\"\ntranslate = [0, 0, 2]\n[render]\nsize = [8, 8]\n";
    let files: [(&str, &[u8]); 3] = [("a.gltf", &model.gltf()), ("a.glb", &model.glb()), ("a.toml", toml)];
    let folder = Folder::new(&files);
    let (scene, warnings) = folder.load("a.gltf").unwrap();
    assert_eq!(scene.mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!((&scene.mesh.triangles[..], warnings.len()), (&[[0, 1, 2]][..], 0));
    assert_eq!((scene.lights.len(), scene.cameras.len(), scene.settings.spp), (0, 1, 64));
    assert_eq!(scene.background, Background::Colour(Vec3::splat(0.6)));
    assert_eq!(scene.environment.as_ref().map(|environment| environment.visible), Some(false));
    assert_eq!(scene.settings.transport.integrator, Integrator::Path);
    let physical = scene.materials[0].physical.unwrap();
    assert_eq!((physical.base, physical.metallic, physical.roughness), (Vec3::ONE, 1.0, 1.0));
    scene.check().unwrap();
    let (bare, _) = folder.load("a.glb").unwrap();
    assert_eq!(bare.mesh, scene.mesh);
    let (toml, warnings) = folder.load("a.toml").unwrap();
    assert_eq!((toml.mesh.positions[1], warnings.len()), (Vec3::new(1.0, 0.0, 2.0), 0));
    model.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } }]);
    model.json["nodes"][0]["camera"] = json!(0);
    let folder = Folder::new(&[("a.glb", &model.glb()), ("a.toml", toml_of_one())]);
    let (_, warnings) = folder.load("a.toml").unwrap();
    assert!(warnings[0].contains("its cameras are left out"), "{warnings:?}");
    let with_camera = [toml_of_one(), b"[[camera]]\nname = \"mine\"\neye = [0, 0, 9]\ntarget = [0, 0, 0]\n"].concat();
    let folder = Folder::new(&[("a.glb", &model.glb()), ("a.toml", &with_camera)]);
    assert_eq!(folder.load("a.toml").unwrap().1, Vec::<String>::new(), "the scene has its own");
}

fn toml_of_one() -> &'static [u8] {
    b"[[mesh]]\nfile = \"a.glb\"\n"
}

#[test]
fn strips_and_fans_turn_and_only_vertices_in_use_are_kept() {
    let mut model = Model::triangle();
    let corners = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 9.0, 9.0, 9.0]);
    let position = model.accessor("VEC3", F32, 5, &corners);
    let indices = model.accessor("SCALAR", U16, 4, &shorts(&[0, 1, 2, 3]));
    *model.primitive() = json!({ "attributes": { "POSITION": position }, "indices": indices, "mode": 5 });
    let mesh = model.mesh();
    assert_eq!((mesh.positions.len(), &mesh.triangles[..]), (4, &[[0, 1, 2], [1, 3, 2]][..]));
    model.primitive()["mode"] = json!(6);
    let mesh = model.mesh();
    let places = |triangle: [u32; 3]| triangle.map(|corner| mesh.positions[corner as usize].truncate());
    let [zero, one] = [Vec2::ZERO, Vec2::ONE];
    assert_eq!(
        mesh.triangles.iter().copied().map(places).collect::<Vec<_>>(),
        [[Vec2::X, Vec2::Y, zero], [Vec2::Y, one, zero]]
    );
}

#[test]
fn sparse_elements_replace_those_of_the_base_or_zeros() {
    let mut model = Model::triangle();
    let places = model.view(&shorts(&[2]));
    let values = model.view(&floats(&[0.0, 5.0, 0.0]));
    let sparse = json!({
        "count": 1,
        "indices": { "bufferView": places, "componentType": U16 },
        "values": { "bufferView": values },
    });
    model.json["accessors"][0]["sparse"] = sparse;
    assert_eq!(model.mesh().positions, [Vec3::ZERO, Vec3::X, 5.0 * Vec3::Y]);
    model.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let of_zeros = model.mesh();
    assert_eq!(of_zeros.positions, [Vec3::ZERO, Vec3::ZERO, 5.0 * Vec3::Y]);
}

#[test]
fn quantised_and_interleaved_numbers_are_read() {
    let mut model = Model::triangle();
    // Four bytes of position and four of a colour.
    let bytes: Vec<u8> =
        [[0, 0, 0, 0, 255, 0, 51, 7], [127, 0, 0, 0, 0, 255, 0, 7], [0, 129, 0, 0, 0, 0, 255, 7]].concat();
    let position = model.accessor("VEC3", 5120, 3, &bytes);
    model.json["bufferViews"][1]["byteStride"] = json!(8);
    model.json["accessors"][1]["normalized"] = json!(true);
    let colour = json!({ "bufferView": 1, "byteOffset": 4, "componentType": 5121, "count": 3, "type": "VEC3", "normalized": true });
    model.json["accessors"].as_array_mut().unwrap().push(colour);
    *model.primitive() = json!({ "attributes": { "POSITION": position, "COLOR_0": 2 } });
    model.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let mesh = model.mesh();
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::NEG_Y]);
    assert_eq!(mesh.colours[0], Vec4::new(1.0, 0.0, 0.2, 1.0));
}

#[test]
fn nodes_place_meshes_and_mirrors_turn_them_back() {
    let mut model = Model::triangle();
    let up = floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let normal = model.accessor("VEC3", F32, 3, &up);
    let tangent = model.accessor("VEC4", F32, 3, &floats(&[[1.0, 0.0, 0.0, 1.0]; 3].concat()));
    model.primitive()["attributes"]["NORMAL"] = json!(normal);
    model.primitive()["attributes"]["TANGENT"] = json!(tangent);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    model.json["nodes"] = json!([
        { "children": [2, 1], "translation": [10, 0, 0] },
        { "mesh": 0, "scale": [-2, 1, 1] },
        { "mesh": 0, "rotation": [half, 0, 0, half] },
        { "mesh": 0 },
    ]);
    let mesh = model.mesh();
    // The quarter turn about x first, then the mirror; what no scene names is not there.
    assert_eq!(mesh.positions.len(), 6);
    assert!(mesh.positions[2].abs_diff_eq(Vec3::new(10.0, 0.0, 1.0), 1e-6), "{}", mesh.positions[2]);
    assert!(mesh.normals[0].abs_diff_eq(Vec3::NEG_Y, 1e-6), "{}", mesh.normals[0]);
    assert_eq!((mesh.positions[4], mesh.normals[3], mesh.triangles[1]), (Vec3::X * 8.0, Vec3::Z, [3, 5, 4]));
    assert_eq!(mesh.tangents[3], Vec4::new(-1.0, 0.0, 0.0, -1.0));
}

#[test]
fn materials_take_textures_and_extensions() {
    let mut model = Model::triangle();
    let coordinates = model.accessor("VEC2", F32, 3, &floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]));
    model.primitive()["attributes"]["TEXCOORD_1"] = json!(coordinates);
    model.primitive()["material"] = json!(0);
    let view = model.view(&picture());
    model.json["images"] = json!([{ "uri": data(&picture()) }, { "bufferView": view, "mimeType": "image/png" }]);
    model.json["samplers"] = json!([{ "magFilter": 9728, "wrapS": 33071, "wrapT": 33648 }]);
    model.json["textures"] = json!([{ "source": 0, "sampler": 0 }, { "source": 1 }]);
    let quarter = std::f64::consts::FRAC_PI_2;
    let turned = json!({ "KHR_texture_transform": { "offset": [0, 1], "rotation": quarter, "scale": [0.5, 0.5] } });
    model.json["materials"] = json!([{
        "name": "glass",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.25, 1.5, 0.75], "metallicFactor": 0, "roughnessFactor": 0.25,
            "baseColorTexture": { "index": 0, "texCoord": 1, "extensions": turned },
        },
        "normalTexture": { "index": 1, "scale": 2 },
        "emissiveFactor": [1, 0.5, 0], "doubleSided": true, "alphaMode": "MASK",
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 4 },
            "KHR_materials_ior": { "ior": 1.25 },
            "KHR_materials_transmission": { "transmissionFactor": 0.5 },
            "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0, 0] },
            "KHR_materials_anisotropy": { "anisotropyStrength": 0.5, "anisotropyRotation": quarter },
            "KHR_materials_specular": { "specularFactor": 0.5, "specularColorFactor": [2, 1, 1] },
            "KHR_materials_unknown": { "factor": "none" },
        },
    }]);
    let Gltf { obj, .. } = model.load();
    let (name, fields) = &obj.materials[1];
    let physical = fields.physical;
    assert_eq!((name.as_str(), obj.mesh.materials[0], fields.opacity), ("glass", 1, Some(0.75)));
    assert_eq!((physical.base, physical.roughness), (Some(Vec3::new(0.5, 0.25, 1.0)), Some(0.25)));
    assert_eq!((fields.emission, fields.two_sided), (Some(Vec3::new(4.0, 2.0, 0.0)), Some(true)));
    assert_eq!((fields.alpha, fields.ior), (Some(Alpha::Mask(0.5)), Some(1.25)));
    assert_eq!((fields.transmission, physical.wall), (Some(Vec3::splat(0.5)), Some(Wall::Body)));
    assert_eq!(physical.absorption.unwrap().distance, 2.0);
    assert_eq!((physical.anisotropy_rotation, physical.specular_tint), (Some(90.0), Some(Vec3::new(2.0, 1.0, 1.0))));
    let base = fields.maps.base.as_ref().unwrap();
    assert_eq!((base.texture.width, base.placement.set, base.placement.nearest), (2, 1, true));
    assert_eq!(base.placement.wrap, [Wrap::Clamp, Wrap::Mirror]);
    // The extension's own example: the lower left quarter, turned clockwise.
    let rows = base.placement.transform;
    let at = |u: f32, v: f32| rows.map(|[x, y, z]| x * u + y * v + z);
    assert!(Vec2::from(at(1.0, 0.0)).abs_diff_eq(Vec2::new(0.0, 0.5), 1e-6), "{rows:?}");
    assert!(Vec2::from(at(0.0, 1.0)).abs_diff_eq(Vec2::new(0.5, 1.0), 1e-6), "{rows:?}");
    assert_eq!((fields.maps.normal_scale, fields.maps.all().count()), (2.0, 2));
    assert_eq!(obj.warnings.len(), 2, "{:?}", obj.warnings);
    assert!(obj.warnings[1].message.contains("specularColorFactor: bodies of glass reflect without a tint"));
}

/// KHR_materials_ior: what light meets at right angles reflects by its index, all of it by the index 0, and by its tint; glass bends
/// light by 4 at most.
#[test]
fn any_index_of_refraction_reflects_as_much_as_it_says() {
    let read = |ior: f64, more: serde_json::Value| {
        let mut model = Model::triangle();
        let mut extensions = json!({
            "KHR_materials_ior": { "ior": ior },
            "KHR_materials_specular": { "specularColorFactor": [0.9, 0.6, 0.3] },
        });
        extensions.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        model.json["materials"] = json!([{ "extensions": extensions }]);
        model.primitive()["material"] = json!(0);
        let Gltf { obj, .. } = model.load();
        (obj.materials[1].1.clone().finish("a").physical.unwrap(), obj.warnings.len())
    };
    let tint = Vec3::new(0.9, 0.6, 0.3);
    for (ior, share) in [(0.0, 1.0f32), (1.0, 0.0), (1.5, 0.04), (4.0, 0.36), (9.0, 0.64), (1e9, 1.0)] {
        let (physical, warnings) = read(ior, json!({}));
        assert!((physical.reflectance() - share * tint).abs().max_element() < 1e-6, "{ior}: {physical:?}");
        assert_eq!(warnings, 0, "{ior}");
    }
    let glass = json!({
        "KHR_materials_transmission": { "transmissionFactor": 1.0 },
        "KHR_materials_volume": { "thicknessFactor": 1.0 },
    });
    let (physical, warnings) = read(9.0, glass.clone());
    assert_eq!((physical.ior, physical.specular_tint, warnings), (4.0, tint, 2));
    let (physical, _) = read(0.0, glass);
    assert!(!physical.is_transparent(), "nothing passes what reflects all");
}

/// KHR_materials_pbrSpecularGlossiness: the specular colour is the reflection at normal incidence, and what is not glossy is rough.
#[test]
fn specular_glossiness_is_no_metal_of_its_specular_colour() {
    let mut model = Model::triangle();
    let coordinates = model.accessor("VEC2", F32, 3, &floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]));
    model.primitive()["attributes"]["TEXCOORD_0"] = json!(coordinates);
    model.primitive()["material"] = json!(0);
    model.json["extensionsRequired"] = json!(["KHR_materials_pbrSpecularGlossiness"]);
    let gloss = json!({
        "diffuseFactor": [0.5, 0.25, 1, 0.75], "specularFactor": [1, 0.5, 0], "glossinessFactor": 0.75,
    });
    model.json["materials"] = json!([{
        "pbrMetallicRoughness": { "metallicFactor": 1 },
        "extensions": { "KHR_materials_pbrSpecularGlossiness": gloss },
    }]);
    let Gltf { obj, .. } = model.load();
    let material = obj.materials[1].1.clone().finish("a");
    let physical = material.physical.unwrap();
    assert_eq!((physical.base, physical.metallic, physical.roughness), (Vec3::new(0.5, 0.25, 1.0), 0.0, 0.25));
    assert!(physical.reflectance().abs_diff_eq(Vec3::new(1.0, 0.5, 0.0), 1e-6), "{}", physical.reflectance());
    assert_eq!((material.opacity, obj.warnings.len()), (0.75, 0));
    model.json["images"] = json!([{ "uri": data(&picture()) }]);
    model.json["textures"] = json!([{ "source": 0 }]);
    let of = &mut model.json["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"];
    of["diffuseTexture"] = json!({ "index": 0 });
    of["specularGlossinessTexture"] = json!({ "index": 0 });
    let Gltf { obj, .. } = model.load();
    let fields = &obj.materials[1].1;
    assert!(fields.maps.base.is_some() && fields.maps.specular_tint == fields.maps.base);
    let rough = fields.maps.metallic_roughness.as_ref().unwrap();
    // The picture is opaque, which is glossy.
    assert_eq!(rough.texture.texels, Texels::Bytes(vec![[0, 64, 0, 255]; 2]));
    assert_eq!(fields.physical.roughness, Some(1.0));
}

#[test]
fn what_is_unlit_sends_out_its_colour() {
    let mut model = Model::triangle();
    model.primitive()["material"] = json!(0);
    model.json["materials"] = json!([{
        "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.25, 0.75, 1] }, "extensions": { "KHR_materials_unlit": {} }
    }]);
    let Gltf { obj, .. } = model.load();
    let (name, fields) = &obj.materials[1];
    assert_eq!((name.as_str(), fields.emission), ("material 0", Some(Vec3::new(0.5, 0.25, 0.75))));
    assert_eq!((fields.physical.base, obj.warnings.len()), (Some(Vec3::ZERO), 1));
}

#[test]
fn lights_and_cameras_stand_where_their_nodes_are() {
    let mut model = Model::triangle();
    let lights = json!([
        { "type": "point", "intensity": 3, "color": [1, 0.5, 0] },
        { "type": "spot", "spot": { "outerConeAngle": 0.5 } },
        { "type": "directional", "intensity": 0 },
        { "type": "directional" },
    ]);
    model.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": lights } });
    let carries = |light: u32| json!({ "KHR_lights_punctual": { "light": light } });
    model.json["cameras"] = json!([
        { "type": "perspective", "perspective": { "yfov": std::f64::consts::FRAC_PI_4 } },
        { "type": "orthographic", "orthographic": {} },
    ]);
    model.json["nodes"] = json!([
        { "mesh": 0, "children": [1, 2, 3, 4, 5] },
        { "translation": [1, 2, 3], "extensions": carries(0) },
        { "translation": [1, 2, 3], "extensions": carries(1), "camera": 0, "name": "front" },
        { "extensions": carries(2), "camera": 0, "name": "front" },
        { "rotation": [0, 1, 0, 0], "extensions": carries(3) },
        { "camera": 1 },
    ]);
    let Gltf { obj, lights, cameras, .. } = model.load();
    let position = Vec3::new(1.0, 2.0, 3.0);
    assert_eq!(lights.len(), 3);
    assert_eq!(
        lights[0],
        Light::Point { position, colour: Vec3::new(3.0, 1.5, 0.0), group: String::new(), illuminant: None }
    );
    assert!(
        matches!(lights[1], Light::Spot { outer, inner: 0.0, target, .. } if outer == 0.5f32.to_degrees() && target == position - Vec3::Z)
    );
    assert!(matches!(lights[2], Light::Directional { direction, .. } if direction.abs_diff_eq(Vec3::Z, 1e-6)));
    assert_eq!(cameras.iter().map(|camera| camera.name.as_str()).collect::<Vec<_>>(), ["front", "front 2"]);
    assert_eq!((cameras[0].eye, cameras[0].projection.fov(), cameras[0].up), (position, Some(45.0), Vec3::Y));
    assert_eq!(
        said(&obj.warnings),
        ["/nowhere/a.glb: nodes[5].camera: it is left out, as it has neither a field of view nor a size"]
    );
}

#[test]
fn every_node_with_a_mesh_is_a_part_of_its_name() {
    let mut model = Model::triangle();
    let primitive = model.primitive().clone();
    model.json["meshes"] = json!([{ "name": "tile", "primitives": [primitive, primitive] }]);
    model.json["nodes"] = json!([
        { "mesh": 0, "name": "left" }, { "translation": [2, 0, 0], "mesh": 0 }, { "name": "empty" },
    ]);
    model.json["scenes"] = json!([{ "nodes": [0, 1, 2] }]);
    let Gltf { obj, .. } = model.load();
    let parts = &obj.objects;
    let told: Vec<_> = parts.iter().map(|part| (part.name.as_str(), part.primitives.clone())).collect();
    assert_eq!(told, [("left", Primitives::Instances(0..1)), ("tile", Primitives::Instances(1..2))]);
    let folder = Folder::new(&[("a.glb", &model.glb())]);
    let scene = folder.load("a.glb").unwrap().0;
    let told: Vec<_> = scene.objects.iter().map(|part| part.primitives.clone()).collect();
    assert_eq!(told, [0..2, 2..4].map(Primitives::Triangles), "few are flattened");
    assert_eq!(scene.objects[1].bounds, [2.0 * Vec3::X, 3.0 * Vec3::X + Vec3::Y]);
    let corner = |triangle: usize| obj.mesh.positions[obj.mesh.triangles[triangle][0] as usize].x;
    assert_eq!([0, 1, 2, 3].map(corner), [0.0, 0.0, 2.0, 2.0]);
}
