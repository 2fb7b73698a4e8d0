//! Texture coordinates of meshes, and the pictures of material files.

use std::io::Cursor;

use glam::{Vec2, Vec3};
use image::{ImageFormat, Rgba, RgbaImage};

use super::Folder;
use crate::scene::{Alpha, Coat, Integrator, Maps, Material, Scene, Sheen, Texels, Wrap};

/// A square of two triangles, with the first corner's texture coordinates on a seam.
const SQUARE: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 0.75\nvt 0 1 0.5\nvt 0.5\n\
    usemtl m\nf 1/1 2/2 3/3\nf 1/5 3/3 4/4\n";

/// A picture of two texels.
fn png(texels: [[u8; 4]; 2]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    RgbaImage::from_fn(2, 1, |x, _| Rgba(texels[x as usize])).write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

fn opaque() -> Vec<u8> {
    png([[255, 0, 0, 255], [128, 255, 0, 255]])
}

fn folder(mtl: &str) -> Folder {
    let clear = png([[9, 8, 7, 255], [6, 5, 4, 0]]);
    let files: [(&str, &[u8]); 6] = [
        ("a.obj", SQUARE.as_bytes()),
        ("a.mtl", mtl.as_bytes()),
        ("a.png", &opaque()),
        ("b c.png", &clear),
        ("damaged.png", &opaque()[..40]),
        ("old.webp", b"not read"),
    ];
    Folder::new(&files)
}

/// The scene of a material's statements.
fn loaded(statements: &str) -> (Scene, Vec<String>) {
    folder(&format!("newmtl m\n{statements}")).load("a.obj").unwrap()
}

fn material(statements: &str) -> Material {
    let (scene, warnings) = loaded(statements);
    assert!(warnings.is_empty(), "{warnings:?}");
    scene.materials[0].clone()
}

#[test]
fn coordinates_run_down_and_split_vertices_where_they_differ() {
    let (scene, _) = loaded("map_Kd a.png\n");
    let mesh = scene.mesh;
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 2, 4]]);
    assert_eq!(mesh.positions[3], mesh.positions[0]);
    let wanted = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.25], [0.5, 1.0], [0.0, 0.0]];
    assert_eq!(mesh.coordinates, [wanted.map(Vec2::from).to_vec(), Vec::new()]);
}

#[test]
fn a_mesh_without_textures_has_no_coordinates_and_no_more_vertices() {
    let mesh = loaded("Kd 1 0 0\nmap_Ks a.png\n").0.mesh;
    assert_eq!((mesh.positions.len(), mesh.coordinates), (4, [Vec::new(), Vec::new()]));
}

#[test]
fn a_scene_covers_a_mesh_whose_own_materials_have_no_textures() {
    let folder = folder("newmtl m\n");
    let scene = "[[mesh]]\nfile = \"a.obj\"\n[[material]]\nname = \"m\"\nbase_texture = \"a.png\"\n";
    std::fs::write(folder.path("a.toml"), scene).unwrap();
    let (scene, _) = folder.load("a.toml").unwrap();
    assert_eq!(scene.mesh.coordinates[0].len(), 5);
    assert_eq!(scene.materials[0].maps.all().count(), 1);
}

#[test]
fn pictures_are_read_once_and_named_among_the_files() {
    let folder = folder("newmtl m\nmap_Kd a.png\nnewmtl n\nmap_Kd ./a.png\n");
    let mesh = SQUARE.replace("f 1/5", "usemtl n\nf 1/5");
    std::fs::write(folder.path("a.obj"), mesh).unwrap();
    let (scene, _) = folder.load("a.obj").unwrap();
    assert_eq!(scene.files, [folder.path("a.mtl"), folder.path("a.png")]);
    let [one, other] = &scene.materials[..] else { panic!("{:?}", scene.materials) };
    assert_eq!(one.maps, other.maps);
}

#[test]
fn a_picture_is_multiplied_with_its_colour_or_white() {
    assert_eq!(material("map_Kd a.png\n").diffuse, Vec3::ONE);
    assert_eq!(material("Kd 0 0 0\nmap_Kd a.png\n").diffuse, Vec3::ONE);
    let red = material("Kd 1 0 0\nmap_Kd a.png\n");
    assert_eq!((red.diffuse, red.emission), (Vec3::X, Vec3::ZERO));
    let Texels::Bytes(texels) = &red.maps.base.unwrap().texture.texels else { panic!("no bytes") };
    assert_eq!(texels[1], [128, 255, 0, 255]);
    assert_eq!(material("Ke 0 0 0\nmap_Ke a.png\n").emission, Vec3::ONE);
    assert_eq!(material("Ke 4 2 1\nmap_Ke a.png\n").emission, Vec3::new(4.0, 2.0, 1.0));
    let integrator = |statements| loaded(statements).0.settings.transport.integrator;
    assert_eq!(integrator("map_Ke a.png\n"), Integrator::Path, "Whitted's model draws nothing that shines");
    assert_eq!(integrator("map_Kd a.png\n"), Integrator::Whitted);
}

#[test]
fn options_come_before_a_name_that_holds_blanks() {
    let maps = material("map_Kd -blendu on -s 2 4 -mm 0 1 -o 0.5 0.25 0 -clamp on -texres 64 b c.png\n").maps;
    let placement = maps.base.unwrap().placement;
    // In a file v = 4 v' + 0.25, counted up.
    assert_eq!(placement.transform, [[2.0, 0.0, 0.5], [0.0, 4.0, -3.25]]);
    assert_eq!(placement.wrap, [Wrap::Clamp; 2]);
    let maps = material("norm -bm 0.5 a.png\n").maps;
    assert_eq!((maps.normal_scale, maps.all().count()), (0.5, 1));
}

#[test]
fn opacity_is_a_pictures_alpha_or_else_its_red_and_no_glass() {
    let texels = |maps: &Maps| match &maps.opacity.as_ref().unwrap().texture.texels {
        Texels::Bytes(bytes) => bytes.clone(),
        Texels::Floats(_) => panic!("no bytes"),
    };
    let grey = material("d 0.5\nmap_d a.png\n");
    assert_eq!((grey.alpha, grey.opacity, grey.transmission), (Alpha::Blend, 0.5, Vec3::ZERO));
    assert_eq!(texels(&grey.maps), [[255; 4], [128; 4]]);
    assert_eq!(texels(&material("map_d b c.png\n").maps), [[255; 4], [0; 4]]);
    let one = material("map_Kd b c.png\nmap_d b c.png\n");
    assert_eq!((one.alpha, one.maps.opacity), (Alpha::Blend, None));
    assert_eq!(material("map_Kd b c.png\n").alpha, Alpha::Opaque);
}

#[test]
fn roughness_and_metalness_are_of_microfacets() {
    let physical = material("Kd 1 0 0\nPr 0.25\nPm 1\n").physical.unwrap();
    assert_eq!((physical.base, physical.roughness, physical.metallic), (Vec3::X, 0.25, 1.0));
    let mapped = material("Pr 0.5\nmap_Pr a.png\nmap_Pm a.png\n");
    let physical = mapped.physical.unwrap();
    assert_eq!((physical.roughness, physical.metallic), (0.5, 1.0));
    assert!(mapped.maps.metallic_roughness.is_some());
    assert_eq!(material("Pr 0.5\nd 0.5\n").physical, None);
    let (scene, warnings) = loaded("map_Pm a.png\nmap_Pr b c.png\n");
    assert_eq!(scene.materials[0].maps.all().count(), 0);
    assert!(warnings[0].contains("a.mtl:2: map_Pm and 1 more ignored"), "{warnings:?}");
}

#[test]
fn coats_and_sheen_are_of_microfacets_and_zeros_are_none() {
    let finish = |statements| material(statements).physical.map(|physical| (physical.coat, physical.sheen));
    let coat = |weight, roughness| Some(Coat { weight, roughness });
    let sheen = |colour| Some(Sheen { colour, roughness: 0.3 });
    assert_eq!(finish("Kd 1 0 0\nPc 0.5\nPcr 0.25\n"), Some((coat(0.5, 0.25), None)));
    assert_eq!(finish("Pc 1\nPs 0.5\n"), Some((coat(1.0, 0.0), sheen(Vec3::splat(0.5)))));
    assert_eq!(finish("Ps 0 0.5 1\n"), Some((None, sheen(Vec3::new(0.0, 0.5, 1.0)))));
    assert_eq!(material("Kd 1 0 0\nPc 1\n").physical.unwrap().base, Vec3::X);
    // As Blender writes for everything.
    assert_eq!(finish("Pr 0.5\nPs 0\nPc 0\nPcr 0.03\n"), Some((None, None)));
    assert_eq!(finish("Ps 0\nPc 0\nPcr 0.03\nmap_Pcr a.png\n"), None);
    assert_eq!(finish("Pc 1\nmap_Pc a.png\nd 0.5\n"), None, "glass has none");
    let (scene, warnings) = loaded("Pc 2\nPs -1\nPc x\n");
    assert_eq!(scene.materials[0].physical.unwrap().coat, coat(1.0, 0.0));
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].contains("a.mtl:4: Pc (Pc holds \"x\", which is no number"), "{warnings:?}");
    assert!(warnings[1].contains("a.mtl:2: Pc and 1 more out of range"), "{warnings:?}");
}

#[test]
fn pictures_of_a_coat_are_multiplied_with_its_numbers_or_one() {
    let of = |statements| {
        let material = material(statements);
        let maps = material.maps.finish;
        (material.physical.unwrap().coat.unwrap(), maps.coat.is_some(), maps.coat_roughness.is_some())
    };
    let coat = |weight, roughness| Coat { weight, roughness };
    assert_eq!(of("map_Pc a.png\n"), (coat(1.0, 0.0), true, false));
    assert_eq!(of("Pc 0\nPcr 0\nmap_Pc a.png\nmap_Pcr b c.png\n"), (coat(1.0, 1.0), true, true));
    assert_eq!(of("Pc 0.5\nPcr 0.25\nmap_Pc a.png\nmap_Pcr b c.png\n"), (coat(0.5, 0.25), true, true));
    let (_, warnings) = loaded("Ps 1\nmap_Ps a.png\n");
    assert!(warnings[0].contains("a.mtl:3: map_Ps ignored: pictures are drawn of"), "{warnings:?}");
}

#[test]
fn what_is_not_drawn_is_warned_of_once_a_file() {
    let statements =
        "map_Kd no.png\nmap_d\nKe 1 1 1\nKe 0 0 2\nmap_Kd old.webp\ndisp a.png\nrefl a.png\nmap_Ks a.png\n";
    let (scene, warnings) = loaded(statements);
    assert_eq!(scene.materials[0], Material { name: "m".into(), ..Material::default() });
    let wanted = [
        "a.mtl:2: map_Kd \"no.png\" and 1 more not found: surfaces are drawn without",
        "a.mtl:6: map_Kd \"old.webp\" is no .png, .jpg, .tga, .bmp, .tif, .exr or .hdr",
        "a.mtl:7: disp and 2 more ignored: pictures are drawn of",
        "a.mtl:5: Ke ignored: add --integrator path, or give the material an emission",
    ];
    assert_eq!(warnings.len(), wanted.len(), "{warnings:?}");
    for (warning, want) in warnings.iter().zip(wanted) {
        assert!(warning.contains(want), "{warning}, wanted: {want}");
    }
}

#[test]
fn surfaces_are_drawn_without_damaged_pictures_with_one_warning() {
    let (scene, warnings) = loaded("map_Kd damaged.png\nmap_Ke damaged.png\nnorm a.png\n");
    assert_eq!(scene.materials[0].maps.all().count(), 1);
    let [warning] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(warning.contains("a.mtl:2: ") && warning.contains("damaged.png: "), "{warning}");
    assert!(warning.ends_with(" and 1 more left out: surfaces are drawn without"), "{warning}");
}

#[test]
fn pictures_of_old_kinds_are_read() {
    for kind in [ImageFormat::Tga, ImageFormat::Bmp, ImageFormat::Tiff] {
        let name = format!("old.{}", kind.extensions_str()[0]);
        let mut bytes = Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(2, 1, |x, _| image::Rgb([255, 128 * x as u8, 0]));
        picture.write_to(&mut bytes, kind).unwrap();
        let folder = folder(&format!("newmtl m\nmap_Kd {name}\n"));
        std::fs::write(folder.path(&name), bytes.into_inner()).unwrap();
        let (scene, warnings) = folder.load("a.obj").unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        let Texels::Bytes(texels) = &scene.materials[0].maps.base.as_ref().unwrap().texture.texels else {
            panic!("{name}")
        };
        assert_eq!(texels[..], [[255, 0, 0, 255], [255, 128, 0, 255]], "{name}");
    }
}
