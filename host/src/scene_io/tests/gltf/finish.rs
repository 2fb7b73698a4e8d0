//! Extensions of glTF's materials by which light passes and by which it is reflected.

use glam::Vec3;
use serde_json::{Value, json};

use super::model::{F32, Model, data, floats, parse, picture};
use crate::scene::{Coat, DiffuseTransmission, Material, Sheen, ThinFilm, Wall};
use crate::scene_io::gltf::Gltf;
use crate::scene_io::tests::said;

/// A triangle of a dielectric with these extensions, three textures at hand.
fn model(extensions: Value) -> Model {
    let mut model = Model::triangle();
    let coordinates = model.accessor("VEC2", F32, 3, &floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]));
    model.primitive()["attributes"]["TEXCOORD_0"] = json!(coordinates);
    model.primitive()["material"] = json!(0);
    model.json["images"] =
        json!([{ "uri": data(&picture()) }, { "uri": data(&picture()) }, { "uri": data(&picture()) }]);
    model.json["textures"] = json!([{ "source": 0 }, { "source": 1 }, { "source": 2 }]);
    let used: Vec<_> = extensions.as_object().unwrap().keys().cloned().collect();
    model.json["extensionsRequired"] = json!(used);
    model.json["extensionsUsed"] = json!(used);
    model.json["materials"] = json!([{ "pbrMetallicRoughness": { "metallicFactor": 0 }, "extensions": extensions }]);
    model
}

/// The material, and all that is said.
fn load(extensions: Value) -> (Material, Vec<String>) {
    let Gltf { obj, .. } = model(extensions).load();
    (obj.materials[1].1.clone().finish("m"), said(&obj.warnings))
}

/// The material of which nothing is said.
fn material(extensions: Value) -> Material {
    let (material, warnings) = load(extensions);
    assert!(warnings.is_empty(), "{warnings:?}");
    material
}

/// The texture of a number with a scale of its coordinates by which it is told from others.
fn texture(number: usize, scale: u32) -> Value {
    json!({ "index": number, "extensions": { "KHR_texture_transform": { "scale": [scale, 1] } } })
}

/// The scales of some maps.
fn scales<const N: usize>(maps: [&Option<crate::scene::Map>; N]) -> [f32; N] {
    maps.map(|map| map.as_ref().map_or(0.0, |map| map.placement.transform[0][0]))
}

#[test]
fn a_clearcoat_is_a_coat_with_its_own_textures_and_normals() {
    let coat = material(json!({ "KHR_materials_clearcoat": {
        "clearcoatFactor": 0.5, "clearcoatTexture": texture(0, 2),
        "clearcoatRoughnessFactor": 0.25, "clearcoatRoughnessTexture": texture(1, 3),
        "clearcoatNormalTexture": { "index": 2, "scale": 0.75 },
    } }));
    assert_eq!(coat.physical.unwrap().coat, Some(Coat { weight: 0.5, roughness: 0.25 }));
    let maps = &coat.maps.finish;
    assert_eq!(scales([&maps.coat, &maps.coat_roughness, &maps.coat_normal]), [2.0, 3.0, 1.0]);
    assert_eq!((maps.coat_normal_scale, maps.all().count(), &coat.maps.normal), (0.75, 3, &None));
    let plain = material(json!({ "KHR_materials_clearcoat": { "clearcoatFactor": 1 } }));
    assert_eq!(plain.physical.unwrap().coat, Some(Coat { weight: 1.0, roughness: 0.0 }));
    let textured = json!({ "clearcoatFactor": 1, "clearcoatRoughnessTexture": texture(0, 2) });
    let textured = material(json!({ "KHR_materials_clearcoat": textured }));
    assert_eq!(textured.physical.unwrap().coat.unwrap().roughness, 0.0, "the factor 0 counts, unlike in scene files");
}

#[test]
fn sheen_has_a_colour_and_a_roughness_of_its_own() {
    let velvet = material(json!({ "KHR_materials_sheen": {
        "sheenColorFactor": [0.5, 0.25, 0], "sheenColorTexture": texture(0, 2),
        "sheenRoughnessFactor": 0.75, "sheenRoughnessTexture": texture(0, 3),
    } }));
    let wanted = Sheen { colour: Vec3::new(0.5, 0.25, 0.0), roughness: 0.75 };
    assert_eq!(velvet.physical.unwrap().sheen, Some(wanted));
    assert_eq!(scales([&velvet.maps.finish.sheen_colour, &velvet.maps.finish.sheen_roughness]), [2.0, 3.0]);
    let plain = material(json!({ "KHR_materials_sheen": { "sheenColorFactor": [1, 1, 1] } }));
    assert_eq!(plain.physical.unwrap().sheen, Some(Sheen { colour: Vec3::ONE, roughness: 0.0 }));
}

#[test]
fn iridescence_is_a_film_of_the_greatest_thickness_without_a_texture_of_it() {
    let of = |extension: Value| material(json!({ "KHR_materials_iridescence": extension }));
    let plain = of(json!({ "iridescenceFactor": 1 })).physical.unwrap().film;
    assert_eq!(plain, Some(ThinFilm { weight: 1.0, ior: 1.3, thickness: [400.0; 2] }));
    let of_one = of(json!({ "iridescenceFactor": 1, "iridescenceThicknessMaximum": 250 })).physical.unwrap().film;
    assert_eq!(of_one.unwrap().thickness, [250.0; 2]);
    let thickness = json!({ "iridescenceFactor": 1, "iridescenceThicknessTexture": texture(0, 1) });
    assert_eq!(of(thickness).physical.unwrap().film.unwrap().thickness, [100.0, 400.0]);
    let all = of(json!({
        "iridescenceFactor": 0.5, "iridescenceTexture": texture(0, 2), "iridescenceIor": 1.8,
        "iridescenceThicknessMinimum": 600, "iridescenceThicknessMaximum": 200,
        "iridescenceThicknessTexture": texture(1, 3),
    }));
    let wanted = ThinFilm { weight: 0.5, ior: 1.8, thickness: [600.0, 200.0] };
    assert_eq!(all.physical.unwrap().film, Some(wanted), "the least may be more than the greatest");
    assert_eq!(scales([&all.maps.finish.film, &all.maps.finish.film_thickness]), [2.0, 3.0]);
}

#[test]
fn diffuse_transmission_goes_into_a_volume_or_through_an_interface() {
    let leaf = json!({
        "diffuseTransmissionFactor": 0.5, "diffuseTransmissionTexture": texture(0, 2),
        "diffuseTransmissionColorFactor": [0.5, 1, 0], "diffuseTransmissionColorTexture": texture(1, 3),
    });
    let of =
        |volume: Value| material(json!({ "KHR_materials_diffuse_transmission": leaf, "KHR_materials_volume": volume }));
    let thin = of(json!({ "attenuationDistance": 2, "attenuationColor": [1, 0, 0] }));
    let physical = thin.physical.unwrap();
    let wanted = DiffuseTransmission { weight: 0.5, colour: Vec3::new(0.5, 1.0, 0.0) };
    assert_eq!(physical.diffuse_transmission, Some(wanted));
    assert_eq!((physical.wall, physical.absorption, physical.transmission), (Wall::Interface, None, Vec3::ZERO));
    let maps = &thin.maps.finish;
    assert_eq!(scales([&maps.diffuse_transmission, &maps.diffuse_transmission_colour]), [2.0, 3.0]);
    let wax = of(json!({ "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0, 0] }));
    let physical = wax.physical.unwrap();
    assert_eq!((physical.wall, physical.absorption.unwrap().distance), (Wall::Body, 2.0));
    assert!(wax.lets_light_in() && !thin.lets_light_in() && physical.idle(&wax.maps).is_none());
    let white = json!({ "diffuseTransmissionFactor": 0.5 });
    let white = material(json!({ "KHR_materials_diffuse_transmission": white }));
    let wanted = Some(DiffuseTransmission { weight: 0.5, colour: Vec3::ONE });
    assert_eq!(white.physical.unwrap().diffuse_transmission, wanted, "by default white, not the base's colour");
    assert_eq!(white.maps.finish.diffuse_transmission_colour, None);
}

#[test]
fn what_scatters_inside_is_below_diffuse_transmission_too() {
    let scattering = material(json!({
        "KHR_materials_diffuse_transmission": { "diffuseTransmissionFactor": 0.5 },
        "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 0.5, 0.5] },
        "KHR_materials_volume_scatter": { "multiscatterColor": [0.5, 0.5, 0.5] },
    }));
    assert!(scattering.volume.is_some() && scattering.physical.unwrap().absorption.is_none());
    assert_eq!(scattering.idle_volume(), None);
}

#[test]
fn dispersion_is_twenty_over_the_abbe_number_of_glass_with_a_volume() {
    let of = |number: f64, thickness: f64, passes: f64| {
        let material = material(json!({
            "KHR_materials_dispersion": { "dispersion": number },
            "KHR_materials_transmission": { "transmissionFactor": passes },
            "KHR_materials_diffuse_transmission": { "diffuseTransmissionFactor": 0.5 },
            "KHR_materials_volume": { "thicknessFactor": thickness },
        }));
        material.physical.unwrap().abbe
    };
    assert_eq!((of(0.5, 1.0, 1.0), of(20.0, 1.0, 0.5)), (Some(40.0), Some(1.0)));
    assert_eq!((of(0.0, 1.0, 1.0), of(0.5, 0.0, 1.0), of(0.5, 1.0, 0.0)), (None, None, None));
    assert_eq!(of(1e-30, 1.0, 1.0), Some(1000.0), "too little to be seen");
}

/// Its pictures, which are damaged, are not looked at either: nothing is said of them.
#[test]
fn a_factor_of_zero_is_none() {
    for extensions in [
        json!({ "KHR_materials_clearcoat": { "clearcoatTexture": { "index": 0 }, "clearcoatRoughnessFactor": 1 } }),
        json!({ "KHR_materials_sheen": { "sheenColorTexture": { "index": 0 }, "sheenRoughnessFactor": 1 } }),
        json!({ "KHR_materials_iridescence": { "iridescenceTexture": { "index": 0 } } }),
        json!({ "KHR_materials_diffuse_transmission": { "diffuseTransmissionColorTexture": { "index": 0 } } }),
        json!({ "KHR_materials_dispersion": {} }),
    ] {
        let mut model = model(extensions.clone());
        model.json["images"] = json!([{ "uri": data(b"no picture") }]);
        let Gltf { obj, .. } = model.load();
        assert!(obj.warnings.is_empty(), "{extensions}: {:?}", obj.warnings);
        let material = obj.materials[1].1.clone().finish("m");
        let physical = material.physical.unwrap();
        assert_eq!((physical.coat, physical.sheen, physical.film), (None, None, None), "{extensions}");
        assert_eq!((physical.diffuse_transmission, physical.abbe, physical.wall), (None, None, Wall::Body));
        assert_eq!(material.maps.finish.all().count(), 0, "{extensions}");
    }
}

#[test]
fn numbers_of_a_finish_out_of_range_are_replaced_by_the_nearest_with_a_warning() {
    let (material, warnings) = load(json!({
        "KHR_materials_clearcoat": { "clearcoatFactor": 1.5, "clearcoatRoughnessFactor": -1 },
        "KHR_materials_sheen": { "sheenColorFactor": [1, 1e300, 0], "sheenRoughnessFactor": 9 },
        "KHR_materials_iridescence": {
            "iridescenceFactor": 1e300, "iridescenceIor": 0.5, "iridescenceThicknessMaximum": 1e300,
        },
        "KHR_materials_transmission": { "transmissionFactor": 0.5 },
        "KHR_materials_diffuse_transmission": {
            "diffuseTransmissionFactor": 2, "diffuseTransmissionColorFactor": [0, -1, 0],
        },
        "KHR_materials_volume": { "thicknessFactor": 1 },
        "KHR_materials_dispersion": { "dispersion": 21 },
    }));
    let physical = material.physical.unwrap();
    assert_eq!(physical.coat, Some(Coat { weight: 1.0, roughness: 0.0 }));
    assert_eq!(physical.sheen, Some(Sheen { colour: Vec3::new(1.0, 1.0, 0.0), roughness: 1.0 }));
    assert_eq!(physical.film, Some(ThinFilm { weight: 1.0, ior: 1.0, thickness: [100_000.0; 2] }));
    assert_eq!(physical.diffuse_transmission, Some(DiffuseTransmission { weight: 1.0, colour: Vec3::ZERO }));
    assert_eq!(physical.abbe, Some(1.0));
    let wanted = [
        ("diffuse_transmission.diffuseTransmissionFactor", "2 must be between 0 and 1; 1 takes its place"),
        ("diffuse_transmission.diffuseTransmissionColorFactor", "-1 must be between 0 and 1; 0 takes its place"),
        ("dispersion.dispersion", "21 must be between 0 and 20; 20 takes its place"),
        ("clearcoat.clearcoatFactor", "1.5 must be"),
        ("clearcoat.clearcoatRoughnessFactor", "-1 must be"),
        ("sheen.sheenColorFactor", "must be between 0 and 1; 1 takes its place"),
        ("sheen.sheenRoughnessFactor", "9 must be"),
        ("iridescence.iridescenceFactor", "must be between 0 and 1; 1 takes its place"),
        ("iridescence.iridescenceIor", "0.5 must be between 1 and 4; 1 takes its place"),
        ("iridescence.iridescenceThicknessMaximum", "must be between 0 and 100000 nanometres; 100000 takes its place"),
    ];
    assert_eq!(warnings.len(), wanted.len(), "{warnings:?}");
    for (warning, (field, why)) in warnings.iter().zip(wanted) {
        let place = format!("materials[0].extensions.KHR_materials_{field}: ");
        assert!(warning.contains(&place) && warning.contains(why), "{warning}, wanted: {place}{why}");
    }
}

#[test]
fn a_finish_of_another_kind_is_refused_in_a_line_that_names_its_field() {
    let texture = json!({ "index": 9 });
    for (name, field, value, why) in [
        ("clearcoat", "clearcoatFactor", json!("all"), "string \"all\" makes no sense here"),
        ("clearcoat", "clearcoatNormalTexture", json!({ "index": 0, "scale": 1e300 }), "must be a finite number"),
        ("clearcoat", "clearcoatTexture", texture.clone(), "there is no texture 9; the file has 3"),
        ("sheen", "sheenColorFactor", json!([1, 1]), "a list of length 2 makes no sense here"),
        ("sheen", "sheenColorTexture", texture.clone(), "there is no texture 9; the file has 3"),
        ("iridescence", "iridescenceThicknessMaximum", json!([1]), "a list makes no sense here"),
        ("iridescence", "iridescenceThicknessTexture", json!({}), "there is none; name a texture"),
        ("diffuse_transmission", "diffuseTransmissionColorFactor", json!({}), "a table makes no sense here"),
        ("diffuse_transmission", "diffuseTransmissionTexture", texture, "there is no texture 9; the file has 3"),
        ("dispersion", "dispersion", json!(true), "true makes no sense here"),
    ] {
        let name = format!("KHR_materials_{name}");
        let mut of = json!({
            "clearcoatFactor": 1, "sheenColorFactor": [1, 1, 1], "iridescenceFactor": 1, "diffuseTransmissionFactor": 1,
        });
        of[field] = value;
        let fault = parse(&model(json!({ name: of })).glb()).expect_err(field).to_string();
        assert!(fault.starts_with("/nowhere/a.glb: materials[0].extensions."), "{fault}");
        assert!(
            fault.contains(field) && fault.contains(why) && !fault.contains('\n'),
            "{fault}, wanted: {field} {why}"
        );
    }
}

/// KHR_materials_ior: the index 0 reflects all light. The older workflow and what is unlit have no extensions.
#[test]
fn a_finish_is_left_out_where_nothing_is_below_it() {
    let leaf = json!({ "diffuseTransmissionFactor": 0.5 });
    let mirror = json!({ "KHR_materials_ior": { "ior": 0 }, "KHR_materials_diffuse_transmission": leaf });
    assert_eq!(material(mirror).physical.unwrap().diffuse_transmission, None);
    let coat = json!({ "clearcoatFactor": 1 });
    for other in ["KHR_materials_pbrSpecularGlossiness", "KHR_materials_unlit"] {
        let (material, _) = load(json!({ other: {}, "KHR_materials_clearcoat": coat }));
        assert_eq!(material.physical.unwrap().coat, None, "{other}");
    }
}
