//! Pictures of heights that turn normals.

use std::io::Cursor;

use glam::DVec3;
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb, RgbImage};

use super::{Folder, assert_refused, warning};
use crate::device_scene::made_tangents;
use crate::scene::{Map, Scene, Texels, Wrap};
use crate::scene_io::{fingerprint, write};

fn png(image: DynamicImage) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// Heights of 16 bits.
fn heights((width, height): (u32, u32), value: impl Fn(u32, u32) -> u16) -> Vec<u8> {
    png(DynamicImage::ImageLuma16(ImageBuffer::from_fn(width, height, |x, y| Luma([value(x, y)]))))
}

/// A normal map of waves.
fn normals() -> Vec<u8> {
    let vector = |x: u32, y: u32| DVec3::new(f64::from(x).sin(), f64::from(y).cos(), 2.0).normalize().to_array();
    let colour = |x, y| Rgb(vector(x, y).map(|x| (127.5 + 127.5 * x).round() as u8));
    png(DynamicImage::ImageRgb8(RgbImage::from_fn(16, 16, colour)))
}

/// Corners of a square, with texture coordinates for faces that want them.
const OBJ: &str = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

fn folder(scene: &str, mtl: &str, faces: &str) -> Folder {
    let huge = heights((9000, 1), |_, _| 0);
    Folder::new(&[
        ("a.toml", scene.as_bytes()),
        ("a.obj", format!("{OBJ}{faces}").as_bytes()),
        ("a.mtl", mtl.as_bytes()),
        // A plane that rises to the right by 1000 a texel and downwards by 500.
        ("h.png", &heights((32, 32), |x, y| (1000 * x + 500 * y) as u16)),
        ("flat.png", &heights((4, 4), |_, _| 9999)),
        ("n.png", &normals()),
        ("wide.png", &huge),
        ("broken.png", &huge[..60]),
    ])
}

/// A floor of this side of a material of these keys, and what is warned of.
fn told(side: f32, mesh: &str, keys: &str) -> (Scene, Vec<String>) {
    let corners = format!("corners = [[0, 0, {side}], [{side}, 0, {side}], [{side}, 0, 0], [0, 0, 0]]");
    let text = format!(
        "[[mesh]]\nshape = \"quad\"\nmaterial = \"m\"\n{corners}\n{mesh}\n[[material]]\nname = \"m\"\n{keys}\n"
    );
    folder(&text, "", "").load("a.toml").unwrap_or_else(|error| panic!("{keys}: {error}"))
}

fn floor(side: f32, mesh: &str, keys: &str) -> Scene {
    let (scene, warnings) = told(side, mesh, keys);
    assert!(warnings.is_empty(), "{warnings:?}");
    scene
}

fn bump(rest: &str) -> String {
    format!("bump_texture = {{ file = \"h.png\", {rest} }}")
}

/// The normal of a texel in the world, on the first triangle.
fn normal(scene: &Scene, (x, y): (u32, u32)) -> DVec3 {
    let maps = &scene.materials[0].maps;
    let Map { texture, .. } = maps.normal.as_ref().expect("a normal map");
    let Texels::Floats(texels) = &texture.texels else { panic!("no floats") };
    let [r, g, b, _] = texels[(y * texture.width + x) as usize].map(|x| 2.0 * f64::from(x) - 1.0);
    let scale = f64::from(maps.normal_scale);
    let (_, [tangent, ..]) = made_tangents(&scene.mesh, &scene.materials)[0];
    let [a, b_corner, c] = scene.mesh.triangles[0].map(|vertex| scene.mesh.positions[vertex as usize].as_dvec3());
    let own = (b_corner - a).cross(c - a).normalize();
    let (along, sign) = (tangent.truncate().as_dvec3(), f64::from(tangent.w));
    (along * (r * scale) + own.cross(along) * sign * (g * scale) + own * b).normalize()
}

/// Of a picture of 32 texels whose grey rises by `1000 / 65535` a texel to the right and half as much downwards, on a floor where that is
/// along x and z.
fn wanted(side: f64, height: f64) -> DVec3 {
    let right = height * 32.0 * 1000.0 / 65535.0 / side;
    DVec3::new(-right, 1.0, -0.5 * right).normalize()
}

#[test]
fn a_ramp_turns_the_normals_of_a_floor_to_those_of_its_slope() {
    for (side, height) in [(1.0, 1.0), (4.0, 0.5), (0.25, -0.01), (100.0, 1e-4)] {
        let scene = floor(side, "", &bump(&format!("height = {height}")));
        let wanted = wanted(side.into(), height);
        for texel in [(1, 1), (16, 9), (30, 30)] {
            let found = normal(&scene, texel);
            assert!(found.abs_diff_eq(wanted, 1e-5), "{side} {height} {texel:?}: {found}, not {wanted}");
        }
    }
}

/// The vertices of a floor that is moved by the picture tell its normals by themselves.
#[test]
fn normals_are_those_of_the_floor_that_is_moved_so() {
    let moved = floor(2.0, "subdivide = 5\ndisplace = { file = \"h.png\", height = 0.7 }", "diffuse = [1, 1, 1]");
    let middle =
        |(position, _): &(&glam::Vec3, &glam::Vec3)| (position.x - 1.0).abs() < 0.2 && (position.z - 1.0).abs() < 0.2;
    let vertices: Vec<_> = moved.mesh.positions.iter().zip(&moved.mesh.normals).filter(middle).collect();
    assert!(vertices.len() > 9);
    let found = normal(&floor(2.0, "", &bump("height = 0.7")), (16, 16));
    for (_, wanted) in vertices {
        assert!(found.abs_diff_eq(wanted.as_dvec3(), 1e-3), "{found}, not {wanted}");
    }
}

#[test]
fn a_picture_that_lies_smaller_is_as_much_steeper() {
    let scene = floor(1.0, "", &bump("height = 0.1, scale = 3"));
    let wanted = wanted(1.0, 0.3);
    assert!(normal(&scene, (16, 16)).abs_diff_eq(wanted, 1e-5));
    // A quarter turn brings what rose to the right to another side, and no other steepness.
    let turned = normal(&floor(1.0, "", &bump("height = 0.3, rotation = 90")), (16, 16));
    assert!((turned.y - wanted.y).abs() < 1e-5 && (turned.x.abs() - wanted.z.abs()).abs() < 1e-5, "{turned}");
}

#[test]
fn heights_stay_what_they_are_where_a_mesh_is_scaled_or_copied() {
    let scale = |scene: &Scene| scene.materials[0].maps.normal_scale;
    let alone = scale(&floor(1.0, "", &bump("height = 0.1")));
    let near = |found: f32, wanted: f32| assert!((found / wanted - 1.0).abs() < 1e-5, "{found}, not {wanted}");
    near(scale(&floor(1.0, "scale = 5", &bump("height = 0.1"))), alone / 5.0);
    let world = |rows: [&str; 2]| {
        let meshes = rows.map(|row| {
            let corners = "corners = [[0, 0, 1], [1, 0, 1], [1, 0, 0], [0, 0, 0]]";
            format!("[[mesh]]\nshape = \"quad\"\nmaterial = \"m\"\n{corners}\n{row}\n")
        });
        let text = format!("{}[[material]]\nname = \"m\"\n{}\n", meshes.concat(), bump("height = 0.1"));
        scale(&folder(&text, "", "").load("a.toml").unwrap().0)
    };
    // The mean of areas of 1 and 9 is 5, and of 2 and 4 it is 3. Scaled along its normal a floor is no larger.
    near(world(["scale = 1", "scale = 3"]), alone / 5.0f32.sqrt());
    near(world(["scale = [1, 7, 1]", "scale = [3, 0.1, 3]"]), alone / 5.0f32.sqrt());
    near(world(["scale = [2, 1, 1]", "scale = [4, 1, 1]"]), alone / 3.0f32.sqrt());
}

#[test]
fn materials_share_what_is_made_of_a_picture() {
    let corners = "corners = [[0, 0, 1], [1, 0, 1], [1, 0, 0], [0, 0, 0]]";
    let one = |name: &str, keys: &str| {
        let mesh = format!("[[mesh]]\nshape = \"quad\"\nmaterial = \"{name}\"\n{corners}\n");
        format!("{mesh}[[material]]\nname = \"{name}\"\n{keys}\n")
    };
    let all = [
        ("a", "height = 1"),
        ("b", "height = 2"),
        ("c", "height = 1, scale = 2"),
        ("d", "height = 1, wrap = \"clamp\""),
    ];
    let text: String = all.iter().map(|(name, rest)| one(name, &bump(rest))).collect();
    let folder = folder(&text, "", "");
    let (scene, _) = folder.load("a.toml").unwrap();
    let pictures: Vec<_> = scene.materials.iter().map(|of| &of.maps.normal.as_ref().unwrap().texture).collect();
    assert!(std::ptr::eq(&**pictures[0], &**pictures[1]) && std::ptr::eq(&**pictures[0], &**pictures[2]));
    assert!(!std::ptr::eq(&**pictures[0], &**pictures[3]));
    let scales: Vec<_> = scene.materials.iter().map(|of| of.maps.normal_scale).collect();
    assert_eq!(scales[..3], [1.0, 2.0, 2.0].map(|times| times * scales[0]));
    assert_eq!(scene.files, [folder.path("h.png")]);
}

#[test]
fn a_flat_picture_turns_nothing() {
    let scene = floor(1.0, "", "bump_texture = { file = \"flat.png\", height = 100 }");
    assert_eq!(normal(&scene, (2, 2)), DVec3::Y);
}

#[test]
fn a_mirrored_picture_has_its_mirror_image_beside_it() {
    let scene = floor(1.0, "", &bump("height = 1, wrap = \"mirror\", scale = 2"));
    let Map { texture, placement } = scene.materials[0].maps.normal.clone().unwrap();
    assert_eq!((texture.width, texture.height, placement.wrap), (64, 64, [Wrap::Repeat; 2]));
    let [here, there] = [(16, 16), (47, 16)].map(|texel| normal(&scene, texel));
    assert!(here.abs_diff_eq(DVec3::new(-there.x, there.y, there.z), 1e-5), "{here} {there}");
}

#[test]
fn what_does_nothing_is_told_once_a_file() {
    let (scene, warnings) = told(1.0, "", &format!("{}\nnormal_texture = \"n.png\"", bump("height = 1")));
    assert!(
        warning(&warnings).contains("a.toml:8: bump_texture ignored: the material has a normal map"),
        "{warnings:?}"
    );
    let normal = scene.materials[0].maps.normal.as_ref().unwrap();
    assert_eq!((&*normal.texture.name, scene.materials[0].maps.normal_scale), ("n.png", 1.0));
    for mesh in ["shape = \"sphere\"", "file = \"a.obj\""] {
        let text = format!("[[mesh]]\n{mesh}\nmaterial = \"m\"\n[[material]]\nname = \"m\"\n{}\n", bump("height = 1"));
        let (scene, warnings) = folder(&text, "newmtl m\n", "f 1 2 3\n").load("a.toml").unwrap();
        assert!(warning(&warnings).contains("a.toml:6: bump_texture ignored: no triangle"), "{mesh}: {warnings:?}");
        assert!(scene.materials[0].maps.normal.is_none());
    }
    let mtl = "newmtl m\nbump h.png\nnewmtl n\nmap_bump h.png\nnewmtl o\nnorm n.png\nmap_Bump h.png\n";
    let (_, warnings) = folder("", mtl, "f 1 2 3\nusemtl n\nf 1 2 3\nusemtl o\nf 1 2 3\n").load("a.obj").unwrap();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].contains("a.mtl:7: bump ignored: the material has normals by norm"), "{warnings:?}");
    assert!(warnings[1].contains("a.mtl:2: bump and 1 more ignored: no triangle"), "{warnings:?}");
}

#[test]
fn the_bumps_of_material_files_are_normals_or_heights_by_their_colours() {
    let maps = |statements: &str| {
        let mtl = format!("newmtl m\n{statements}\n");
        let (scene, warnings) = folder("", &mtl, "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n").load("a.obj").unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        (scene.materials[0].maps.clone(), scene)
    };
    let normals = |statements| {
        let (maps, _) = maps(statements);
        let texture = maps.normal.expect("a normal map").texture;
        assert!(matches!(texture.texels, Texels::Bytes(_)));
        maps.normal_scale
    };
    assert_eq!(normals("norm -bm 0.5 n.png"), 0.5);
    assert_eq!(normals("map_Bump -bm 0.5 n.png"), 0.5);
    assert_eq!(normals("map_Kd n.png\nbump n.png"), 1.0);
    for (statement, height) in [("bump h.png", 1.0), ("map_Bump -bm -0.25 h.png", -0.25), ("map_bump -bm 3 h.png", 3.0)]
    {
        let (_, scene) = maps(statement);
        // The square stands, with z in front.
        let wanted = wanted(1.0, height);
        let found = normal(&scene, (16, 16));
        assert!(found.abs_diff_eq(DVec3::new(wanted.x, -wanted.z, wanted.y), 1e-5), "{statement}: {found}");
    }
}

#[test]
fn a_scene_file_has_the_last_word_on_where_normals_come_from() {
    let of = |mtl: &str, keys: &str| {
        let text = format!("[[mesh]]\nfile = \"a.obj\"\n[[material]]\nname = \"m\"\n{keys}\n");
        let mtl = format!("newmtl m\n{mtl}\n");
        let (scene, warnings) = folder(&text, &mtl, "f 1/1 2/2 3/3\n").load("a.toml").unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        scene.materials[0].maps.normal.as_ref().unwrap().texture.name.clone()
    };
    assert_eq!(of("norm n.png", &bump("height = 1")), "h.png");
    assert_eq!(of("bump h.png", "normal_texture = \"n.png\""), "n.png");
    assert_eq!(of("bump h.png", "diffuse = [1, 0, 0]"), "h.png");
}

#[test]
fn the_binary_form_has_the_normals() {
    let scene = floor(3.0, "", &bump("height = 0.1"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.eyerays");
    write(&scene, None, &mut std::fs::File::create(&path).unwrap()).unwrap();
    let (back, _) = crate::scene_io::load(&path).unwrap();
    assert_eq!(normal(&back, (9, 9)), normal(&scene, (9, 9)));
    assert_eq!(fingerprint(&back), fingerprint(&scene));
}

#[test]
fn what_is_no_picture_of_heights_is_refused_in_one_line() {
    let refused = |keys: &str, why: &str| {
        let text = format!("[[mesh]]\nfile = \"a.obj\"\n[[material]]\nname = \"m\"\n{keys}\n");
        let error = folder(&text, "newmtl m\n", "f 1/1 2/2 3/3\n").refuse("a.toml");
        assert_refused(&error, "a.toml", Some(5), why);
    };
    refused("bump_texture = \"h.png\"", "how high white is above black");
    refused("bump_texture = { file = \"h.png\" }", "needs \"height\"");
    for number in ["nan", "inf", "-inf", "1e39"] {
        refused(&bump(&format!("height = {number}")), "\"height\" must be a finite number");
    }
    refused(&bump("height = 1, hight = 2"), "unknown key \"hight\"");
    refused("bump_texture = { file = \"none.png\", height = 1 }", "none.png");
    refused("bump_texture = { file = \"broken.png\", height = 1 }", "broken.png: ");
    // Its mirror image beside it makes it too large.
    let wide = |wrap: &str| format!("bump_texture = {{ file = \"wide.png\", height = 1, wrap = \"{wrap}\" }}");
    refused(&wide("mirror"), "wide.png: is 18000x2 texels large");
    floor(1.0, "", &wide("clamp"));
}

#[test]
fn surfaces_are_drawn_without_bumps_that_can_not_be_read() {
    let mtl = "newmtl m\nbump none.png\nmap_Bump broken.png\nbump -bm nan h.png\n";
    let (scene, warnings) = folder("", mtl, "f 1/1 2/2 3/3\n").load("a.obj").unwrap();
    assert!(scene.materials[0].maps.normal.is_none());
    let wanted = ["a.mtl:4: bump (-bm holds nan", "a.mtl:2: bump \"none.png\" not found", "broken.png: "];
    assert_eq!(warnings.len(), wanted.len(), "{warnings:?}");
    for (warning, want) in warnings.iter().zip(wanted) {
        assert!(warning.contains(want), "{warning}, wanted: {want}");
    }
}

/// The steepest slopes that numbers have.
#[test]
fn heights_of_any_size_make_a_finite_strength() {
    for height in ["3e38", "-3e38", "1e-45"] {
        let scene = floor(1e-6, "", &bump(&format!("height = {height}, scale = 1e30")));
        assert!(scene.materials[0].maps.normal_scale.is_finite(), "{height}");
    }
}
