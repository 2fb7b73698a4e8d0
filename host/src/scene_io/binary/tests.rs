use std::path::Path;
use std::sync::{Arc, LazyLock};

use bytemuck::bytes_of;
use glam::{Vec2, Vec4};
use proptest::prelude::*;

use super::header::Header;
use super::read::parse;
use super::{fingerprint, write};
use crate::device_scene::hierarchy;
use crate::error::Result;
use crate::job::Job;
use crate::memory::Room;
use crate::quality::Bvh;
use crate::scene::{
    Alpha, Environment, FinishMaps, Light, Map, Maps, Motion, Placement, Scene, Shape, Texels, Texture, Unplaced, Wrap,
};
use crate::scene_io::{Loading, Shutter, budget::Budget, load, load_as};

/// A scene of a text form at one moment, and no files, as binary ones have none.
pub(super) fn text(path: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let still = Loading { shutter: Some(Shutter::CLOSED), ..Loading::default() };
    Scene { files: Vec::new(), animations: Vec::new(), ..load_as(&path, still).expect("a scene").0 }
}

fn binary(scene: &Scene) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(scene, None, &mut bytes).expect("a scene in range");
    bytes
}

pub(super) fn read(bytes: &[u8]) -> Unplaced<Scene> {
    parse(bytes, Budget::new(Room { bytes: 1 << 30, limit: "this test" }))
}

/// Why a file is refused, with what to do about it.
fn remedied(read: Unplaced<Scene>) -> String {
    let fault = read.expect_err("accepted");
    assert!(fault.contains("eyerays convert"), "{fault} has no remedy");
    fault
}

/// Gives a file the hash of what it holds, if it is whole.
pub(super) fn sign(bytes: &mut [u8]) {
    if let Ok((header, sections)) = Header::read(bytes) {
        let header = Header::of(header.counts, &sections.map(|section| &bytes[section]));
        bytes[..size_of::<Header>()].copy_from_slice(bytes_of(&header));
    }
}

/// A map of a picture that is like no other.
fn map(name: &str, texels: Texels, placement: Placement) -> Map {
    Map { texture: Arc::new(Texture { name: name.to_owned(), width: 2, height: 1, texels }), placement }
}

/// A scene with all that covers surfaces, too.
fn covered() -> Scene {
    let mut scene = text("src/scene_io/example.toml");
    let vertices = scene.mesh.positions.len();
    let along = |x: usize| x as f32 / vertices as f32;
    scene.mesh.coordinates = [0.5, 2.0].map(|y| (0..vertices).map(|x| Vec2::new(along(x), y)).collect());
    scene.mesh.tangents = vec![Vec4::new(0.0, 1.0, 0.0, -1.0); vertices];
    scene.mesh.colours = (0..vertices).map(|x| Vec4::new(along(x), 0.25, 1.0, 0.5)).collect();
    let turned = Placement { set: 1, nearest: true, wrap: [Wrap::Mirror, Wrap::Clamp], ..Placement::default() }
        .transformed(Vec2::new(2.0, 3.0), 30.0, Vec2::new(0.1, 1e-9));
    let bytes = map("a \"b\".png", Texels::Bytes(vec![[1, 2, 3, 4], [255, 0, 9, 128]]), turned);
    let floats = map("sky.exr", Texels::Floats(vec![[0.1, 1e9, 0.0, 1.0], [3.0, 4.0, 5.0, 0.5]]), Placement::default());
    let like = map("a \"b\".png", bytes.texture.texels.clone(), turned);
    let all = |map: &Map| Some(map.clone());
    scene.materials[0].maps = Maps {
        base: all(&bytes),
        metallic_roughness: all(&like),
        normal: all(&bytes),
        normal_scale: 0.5,
        emission: all(&floats),
        transmission: all(&like),
        specular_weight: all(&bytes),
        specular_tint: all(&floats),
        anisotropy: all(&bytes),
        opacity: Some(Map { placement: Placement::default(), ..bytes.clone() }),
        finish: FinishMaps {
            coat: all(&like),
            coat_roughness: all(&bytes),
            coat_normal: all(&like),
            coat_normal_scale: 0.25,
            sheen_colour: all(&floats),
            sheen_roughness: all(&like),
            diffuse_transmission: all(&bytes),
            diffuse_transmission_colour: all(&floats),
            film: all(&like),
            film_thickness: all(&bytes),
        },
    };
    (scene.materials[0].alpha, scene.materials[0].opacity) = (Alpha::Mask(0.3), 0.7);
    scene.materials[2].maps.base = all(&bytes);
    scene.materials[2].alpha = Alpha::Blend;
    scene.environment = Some(Environment { texture: floats.texture, rotation: 30.0, scale: 0.1, visible: false });
    scene
}

/// All that a scene can say, primitives of every kind, and their hierarchy.
pub(super) static EXAMPLE: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let scene = covered();
    let bvh = hierarchy(&scene, Bvh::Fast.quality()).expect("a hierarchy");
    let mut bytes = Vec::new();
    write(&scene, Some((Bvh::Fast, &bvh)), &mut bytes).expect("a scene in range");
    bytes
});

pub(super) fn packed(scene: &Scene) -> Result<Job> {
    Job::new(scene, scene.settings, Bvh::Fast.quality())
}

#[test]
fn every_scene_is_the_same_in_either_form() {
    let shipped = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes")).unwrap();
    let names = shipped.map(|entry| format!("../scenes/{}", entry.unwrap().file_name().display()));
    // Pictures and strands are parts of others.
    let is_part = |name: &String| [".png", ".hdr", ".txt"].iter().any(|ending| name.ends_with(ending));
    let names = names.filter(|name| !is_part(name));
    for name in names.chain(["src/scene_io/example.toml".into(), "src/scene_io/pyramid.obj".into()]) {
        let scene = text(&name);
        let bytes = binary(&scene);
        let back = read(&bytes).expect("a scene");
        assert!(binary(&back) == bytes, "{name}");
        // Pictures are the same only where they are one.
        let has_pictures = scene.environment.is_some() || scene.materials.iter().any(|m| m.maps.all().next().is_some());
        assert!(has_pictures || back == scene, "{name}");
    }
}

/// Two boxes, one of which turns and bends, before a camera that pans.
pub(super) fn moving() -> Scene {
    let text = r#"
        shutter = { frames = [0.0, 0.5], rolling = 0.25 }
        camera = [{ name = "c", eye = [0, 1, 5], target = [0, 0, 0], key = [{ time = 0.0 }, { time = 0.1, eye = [1, 1, 5] }] }]
        mesh = [
            { shape = "box", min = [-1, 0, 0], max = [0, 1, 1] },
            { shape = "box", min = [0, 0, 0], max = [1, 1, 1], key = [{ time = 0.0 }, { time = 0.1, rotate = [0, 20, 0] }] },
        ]
    "#;
    let room = Budget::new(Room { bytes: 1 << 30, limit: "this test" });
    let (scene, warnings) = load::parse("moving.toml".as_ref(), text.as_bytes(), room, Loading::default()).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let mut scene = Scene { files: Vec::new(), animations: Vec::new(), ..scene };
    let range = scene.shared[0].vertices.clone();
    let motion = scene.motion.as_mut().expect("it moves");
    for (number, pose) in motion.poses.iter_mut().enumerate() {
        let bent = scene.mesh.positions[range.clone()].iter().map(|&place| place * (1.5 + number as f32));
        let normals = scene.mesh.normals.get(range.clone()).unwrap_or_default().to_vec();
        pose.shapes = vec![(0, Shape { positions: bent.collect(), normals, tangents: Vec::new() })];
    }
    scene.check().unwrap();
    scene
}

#[test]
fn what_moves_comes_back_and_counts_in_the_fingerprint() {
    let scene = moving();
    let back = read(&binary(&scene)).expect("a scene");
    assert!(back == scene && back.motion.is_some());
    let print = fingerprint(&scene).unwrap();
    let changes: [fn(&mut Motion); 5] = [
        |motion| motion.exposure = 0.5,
        |motion| motion.cameras[0].eye.x += 1.0,
        |motion| motion.poses[0].cameras[0].eye.x += 1.0,
        |motion| motion.poses[0].instances[0].translation.x += 1.0,
        |motion| motion.poses[0].shapes[0].1.positions[0].x += 1.0,
    ];
    for (number, change) in changes.into_iter().enumerate() {
        let mut other = scene.clone();
        change(other.motion.as_mut().unwrap());
        assert_ne!(fingerprint(&other).unwrap(), print, "change {number}");
    }
}

#[test]
fn poses_of_other_scenes_are_refused() {
    let scene = moving();
    let changes: [fn(&mut Motion); 3] = [
        |motion| {
            let _ = motion.poses[0].instances.pop();
        },
        |motion| {
            let _ = motion.poses[0].shapes[0].1.positions.pop();
        },
        |motion| motion.poses[0].shapes.clear(),
    ];
    for change in changes {
        let mut other = scene.clone();
        change(other.motion.as_mut().unwrap());
        assert!(write(&other, None, &mut Vec::new()).is_err());
    }
}

#[test]
fn what_covers_surfaces_comes_back_and_every_picture_once() {
    let scene = covered();
    let bytes = binary(&scene);
    let back = read(&bytes).expect("a scene");
    assert_eq!(binary(&back), bytes);
    assert_eq!(back.mesh, scene.mesh);
    let pictures = |scene: &Scene| -> Vec<(Texture, Placement)> {
        let maps = scene.materials.iter().flat_map(|material| material.maps.all());
        maps.map(|map| ((*map.texture).clone(), map.placement)).collect()
    };
    assert_eq!(pictures(&back), pictures(&scene));
    let maps = |number: usize| &back.materials[number].maps;
    let shares = |one: &Option<Map>, other: &Option<Map>| match (one, other) {
        (Some(one), Some(other)) => Arc::ptr_eq(&one.texture, &other.texture),
        _ => false,
    };
    assert!(shares(&maps(0).base, &maps(2).base) && !shares(&maps(0).base, &maps(0).metallic_roughness));
    let around = back.environment.as_ref().expect("an environment");
    assert!(Arc::ptr_eq(&around.texture, &maps(0).emission.as_ref().expect("a map").texture));
    assert_eq!((around.rotation, around.scale, around.visible), (30.0, 0.1, false));
    let scales = |maps: &Maps| (maps.normal_scale, maps.finish.coat_normal_scale);
    let of = |scene: &Scene| scene.materials.iter().map(|m| (m.alpha, m.opacity, scales(&m.maps))).collect::<Vec<_>>();
    assert_eq!(of(&back), of(&scene));
}

#[test]
fn textures_that_do_not_fit_their_texels_or_are_not_there_are_refused() {
    let refused = |from: &str, to: &str| {
        let mut bytes = binary(&covered());
        let place = bytes.windows(from.len()).position(|window| window == from.as_bytes()).expect(from);
        bytes[place..place + from.len()].copy_from_slice(to.as_bytes());
        sign(&mut bytes);
        remedied(read(&bytes))
    };
    assert!(refused("width = 2", "width = 0").contains("is 0x1 texels large"));
    assert!(refused("width = 2", "width = 1").contains("leave 16 bytes of texels over"));
    assert!(refused("height = 1", "height = 9").contains("bytes of texels and needs"));
    assert!(refused("picture = 1", "picture = 7").contains("something takes texture 7, but there are 3"));
    assert!(refused("material = 2", "material = 9").contains("material 9 takes textures, but there are"));
    assert!(refused("set = 1", "set = 2").contains("by coordinates 2; a mesh has 0 and 1"));
    assert!(refused("visible = false", "visible = fa1se").contains("of its description"));
}

#[test]
fn a_hierarchy_is_taken_as_it_was_built_unless_it_is_that_of_another_geometry() {
    let mut scene = read(&EXAMPLE).expect("a scene");
    let [kept, built] = [packed(&scene), packed(&covered())].map(|packed| packed.unwrap());
    assert!(kept.nodes() == built.nodes() && kept.bounds() == built.bounds());
    assert!(kept.primitives() == built.primitives());
    scene.mesh.positions.iter_mut().for_each(|position| position.y = -position.y);
    let refused = packed(&scene).err().expect("accepted").message();
    assert!(refused.starts_with("the hierarchy that the scene brings along is not its own: "), "{refused}");
    assert!(refused.ends_with("; write its file again with eyerays convert"), "{refused}");
    scene.hierarchy = None;
    assert!(packed(&scene).is_ok());
}

#[test]
fn the_page_on_scene_files_tells_the_version_that_is_written() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/scene-format.md");
    let page = std::fs::read_to_string(page).expect("the page");
    let version = u32::from_le_bytes(EXAMPLE[8..12].try_into().expect("four bytes"));
    assert!(page.contains(&format!("| 8 to 11 | the version, {version} |")), "version {version} is written");
}

#[test]
fn what_is_no_binary_scene_or_another_version_or_cut_off_or_changed_is_told_so() {
    let refused = |spoil: fn(&mut Vec<u8>)| {
        let mut bytes = EXAMPLE.clone();
        spoil(&mut bytes);
        remedied(read(&bytes))
    };
    assert!(refused(|b| b.truncate(5)).starts_with("this is no binary scene"));
    assert!(refused(|b| b.truncate(100)).starts_with("its 100 bytes are less than a header"));
    assert!(refused(|b| b[0] = b'v').starts_with("this is no binary scene"));
    assert!(refused(|b| b[8] = 8).starts_with("version 8 of the binary form, and 9 is what is read"));
    assert!(refused(|b| b[168] = 1).starts_with("its byte 168, which belongs to no section, is not zero"));
    assert!(refused(|b| b[12] = 1).starts_with("its header has other than zeros in its spare bytes"));
    assert!(refused(|b| b.truncate(1000)).starts_with("its 1000 bytes are not what its header tells"));
    assert!(refused(|b| b.push(0)).contains("are not what its header tells"));
    assert!(refused(|b| b[55] = 0xff).contains("are not what its header tells"));
    assert!(refused(|b| *b.last_mut().unwrap() ^= 1).starts_with("its contents have another hash"));
    assert!(refused(|b| b[200] ^= 1).starts_with("its contents have another hash"));
}

#[test]
fn a_file_for_which_there_is_no_memory_is_refused_before_any_is_taken() {
    let fault = parse(&EXAMPLE, Budget::new(Room { bytes: 1000, limit: "this test" })).expect_err("accepted");
    assert!(fault.contains("this test leaves 0 MB; end other programs"), "{fault}");
}

#[test]
fn settings_out_of_range_are_neither_written_nor_read() {
    let mut scene = text("../scenes/whitted.toml");
    let mut bytes = binary(&scene);
    scene.settings.bounces = 70_000;
    let refused = write(&scene, None, &mut Vec::new()).expect_err("written").message();
    assert_eq!(refused, "bounces 70000 is not within 0 to 65535");
    let place = bytes.windows(12).position(|window| window == b"\nsamples = 1").expect("samples");
    bytes[place + 11] = b'0';
    sign(&mut bytes);
    let refused = remedied(read(&bytes));
    assert!(refused.starts_with("samples 0 is not within 1 to 64; mend it in the scene"), "{refused}");
}

#[test]
fn a_scene_out_of_range_is_not_written_nor_read_under_a_right_hash() {
    let mut scene = text("src/scene_io/example.toml");
    scene.cameras[0].target = scene.cameras[0].eye;
    let refused = write(&scene, None, &mut Vec::new()).expect_err("written").message();
    assert_eq!(refused, "the camera \"front\" looks at its own eye; move its target");
    let mut bytes = binary(&text("src/scene_io/example.toml"));
    let (_, [.., disks, _, _, _, _, _, _]) = Header::read(&bytes).unwrap();
    bytes[disks.end - 4..disks.end].copy_from_slice(&u32::MAX.to_le_bytes());
    sign(&mut bytes);
    let refused = remedied(read(&bytes));
    assert!(refused.contains("has material 4294967295, but there are"), "{refused}");
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

    /// The description is decimal.
    #[test]
    fn every_number_comes_back_with_its_bits(bits in prop::array::uniform3(0..f32::INFINITY.to_bits()), name in ".*") {
        let mut scene = text("../scenes/whitted.toml");
        let numbers = bits.map(f32::from_bits).into();
        scene.ambient = numbers;
        scene.settings.transport.ao_distance = f32::INFINITY;
        scene.lights = vec![Light::Point { position: -numbers, colour: numbers, group: String::new(), illuminant: None }];
        scene.cameras[0].name = name;
        prop_assert_eq!(read(&binary(&scene)), Ok(scene));
    }
}
