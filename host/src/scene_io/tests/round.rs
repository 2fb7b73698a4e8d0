//! Spheres and disks, and when they become meshes.

use std::path::Path;

use glam::Vec3;

use super::{Folder, assert_refused, budget};
use crate::scene::{Disk, Primitives, Scene, Sphere, default_camera};
use crate::scene_io::load::Loading;
use crate::scene_io::{load::load_within, xyzr};

fn load(mesh: &str) -> Scene {
    let text = format!("[[mesh]]\n{mesh}\n");
    let folder =
        Folder::new(&[("scene.toml", text.as_bytes()), ("heap.xyzr", b"0 0 0 1\n# two\n\n3e0 -1 .5 2 # more\n")]);
    let (scene, warnings) = folder.load("scene.toml").unwrap_or_else(|error| panic!("{mesh}: {error}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    scene
}

fn sphere(center: Vec3, radius: f32) -> Sphere {
    Sphere { center, radius, material: 0 }
}

#[test]
fn a_sphere_and_a_disk_are_whole_unless_triangles_are_asked_for() {
    let scene = load("shape = \"sphere\"\ncenter = [1, 2, 3]\nradius = 0.5\nsmooth = true");
    assert_eq!(scene.spheres, [sphere(Vec3::new(1.0, 2.0, 3.0), 0.5)]);
    assert_eq!((scene.mesh.positions.len(), scene.materials.len(), scene.disks.len()), (0, 1, 0));
    let scene = load("shape = \"disk\"\nnormal = [0, 0, -4]\nradius = 3\nsmooth = false");
    assert_eq!(scene.disks, [Disk { center: Vec3::ZERO, normal: Vec3::NEG_Z, radius: 3.0, material: 0 }]);
    assert_eq!(load("shape = \"disk\"").disks[0].normal, Vec3::Y);
    for (keys, triangles) in [
        ("tessellate = 0", 20),
        ("tessellate = 2\nscale = [1, 2, 3]", 320),
        ("subdivisions = 1", 80),
        ("smooth = false", 20 << 10),
        ("scale = [1, 1, -2]", 20 << 10),
    ] {
        let scene = load(&format!("shape = \"sphere\"\n{keys}"));
        assert_eq!((scene.mesh.triangles.len(), scene.spheres.len()), (triangles, 0), "{keys}");
    }
    for (keys, triangles) in [("tessellate = 3", 3), ("scale = [1, 2, 1]", 128), ("tessellate = 7\nscale = 2", 7)] {
        let scene = load(&format!("shape = \"disk\"\n{keys}"));
        assert_eq!((scene.mesh.triangles.len(), scene.disks.len()), (triangles, 0), "{keys}");
    }
}

#[test]
fn a_transform_that_scales_equally_moves_centers_radii_and_normals() {
    let place = "rotate = [90, 0, 0]\ntranslate = [10, 0, 0]";
    // About x, y turns to z and z to -y.
    let scene = load(&format!("shape = \"sphere\"\ncenter = [1, 2, 3]\nscale = [-2, 2, 2]\n{place}"));
    assert_eq!(scene.spheres, [sphere(Vec3::new(8.0, -6.0, 4.0), 2.0)]);
    let scene = load(&format!("shape = \"disk\"\ncenter = [0, 1, 0]\nscale = -3\n{place}"));
    let disk = Disk { center: Vec3::new(10.0, 0.0, -3.0), normal: Vec3::NEG_Z, radius: 3.0, material: 0 };
    assert_eq!(scene.disks, [disk]);
}

/// The triangles of a disk turn as its normal says, whatever a mirror does to both.
#[test]
fn a_disk_and_its_mesh_face_the_same_side() {
    for scale in ["1", "-1", "[1, -1, 1]", "[-2, 2, 2]"] {
        let keys = format!("shape = \"disk\"\nnormal = [1, 2, 3]\nscale = {scale}\nrotate = [10, 20, 30]");
        let (whole, fan) = (load(&keys), load(&format!("{keys}\ntessellate = 12")));
        let disk = &whole.disks[0];
        for &triangle in &fan.mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| fan.mesh.positions[vertex as usize]);
            assert!((b - a).cross(c - a).normalize().dot(disk.normal) > 0.999, "{scale}");
            assert!((b.distance(disk.center) - disk.radius).abs() < 1e-5, "{scale}");
        }
        let [least, greatest] = disk.bounds();
        let inside = |p: &Vec3| p.cmpge(least - 1e-5).all() && p.cmple(greatest + 1e-5).all();
        assert!(fan.mesh.positions.iter().all(inside), "{scale}");
    }
}

#[test]
fn a_file_holds_many_spheres_of_one_material() {
    let scene = load("file = \"heap.xyzr\"\nscale = 2\nmaterial = \"red\"\n[[material]]\nname = \"red\"");
    assert_eq!(scene.spheres, [sphere(Vec3::ZERO, 2.0), sphere(Vec3::new(6.0, -2.0, 1.0), 4.0)]);
    assert_eq!(scene.materials[0].name, "red");
    let part = &scene.objects[0];
    assert_eq!((part.name.as_str(), &part.primitives), ("heap.xyzr (red)", &Primitives::Spheres(0..2)));
    assert_eq!(part.bounds, [Vec3::new(-2.0, -6.0, -3.0), Vec3::new(10.0, 2.0, 5.0)]);
    assert!(scene.files[0].ends_with("heap.xyzr"));
    let mesh = load("file = \"heap.xyzr\"\ntessellate = 1").mesh;
    assert_eq!((mesh.triangles.len(), mesh.positions.len()), (160, 84));
    assert_eq!(mesh.triangles[80], mesh.triangles[0].map(|vertex| vertex + 42));
}

#[test]
fn parts_are_told_by_what_they_hold_and_materials_are_counted_over_all() {
    let scene = load(
        "shape = \"sphere\"\nmaterial = \"a\"\n[[mesh]]\nshape = \"quad\"\n\
        corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\nmaterial = \"b\"\n\
        [[mesh]]\nshape = \"disk\"\n[[mesh]]\nshape = \"sphere\"\nmaterial = \"b\"\n\
        [[material]]\nname = \"a\"\n[[material]]\nname = \"b\"",
    );
    let held: Vec<_> = scene.objects.iter().map(|part| part.primitives.clone()).collect();
    let want =
        [Primitives::Spheres(0..1), Primitives::Triangles(0..2), Primitives::Disks(0..1), Primitives::Spheres(1..2)];
    assert_eq!(held, want);
    assert_eq!((held[1].count(), held[1].noun(), held[2].noun()), (2, "triangle", "disk"));
    assert_eq!([scene.spheres[0].material, scene.spheres[1].material, scene.disks[0].material], [0, 1, 2]);
    assert_eq!(scene.mesh.materials, [1, 1]);
}

#[test]
fn the_bounds_and_the_framing_camera_are_of_all_surfaces() {
    let scene = load(
        "shape = \"sphere\"\ncenter = [-5, 0, 0]\n[[mesh]]\nshape = \"disk\"\ncenter = [0, 3, 0]\nradius = 2\n\
        [[mesh]]\nfile = \"heap.xyzr\"",
    );
    assert_eq!(scene.bounds(), [Vec3::new(-6.0, -3.0, -2.0), Vec3::new(5.0, 3.0, 2.5)]);
    assert_eq!(scene.extremes().count(), 2 * 4);
    let camera = default_camera(&scene, 1.0).unwrap();
    assert_eq!(scene.cameras, std::slice::from_ref(&camera));
    let forward = (camera.target - camera.eye).normalize();
    for Sphere { center, radius, .. } in &scene.spheres {
        let view = *center - camera.eye;
        let angle = view.normalize().dot(forward).acos() + (radius / view.length()).asin();
        assert!(angle.to_degrees() < camera.projection.fov().unwrap() / 2.0);
    }
}

/// Every text with a part of the message; the line to blame is the last of those given.
#[test]
fn spheres_and_disks_that_make_no_sense_are_refused_where_they_stand() {
    for (keys, line, why) in [
        ("shape = \"sphere\"\ntessellate = 9", 3, "between 0 and 8"),
        ("shape = \"sphere\"\ntessellate = 1\nsubdivisions = 1", 4, "an older name of \"tessellate\""),
        ("shape = \"sphere\"\nnormal = [0, 1, 0]", 3, "unknown key \"normal\" in a sphere"),
        ("shape = \"sphere\"\nradius = -1", 3, "greater than 0"),
        ("shape = \"sphere\"\ncenter = [1e8, 0, 0]", 1, "the sphere is too small for single precision"),
        ("shape = \"sphere\"\nradius = 1e-30\nscale = 1e-30", 1, "the sphere is too small"),
        ("shape = \"sphere\"\nradius = 1e30\nscale = 1e30", 1, "the sphere leaves the range"),
        ("shape = \"sphere\"\ntranslate = [3e38, 0, 0]\nradius = 1e38", 1, "the sphere leaves the range"),
        ("shape = \"disk\"\nnormal = [0, 0, 0]", 3, "the normal is zero"),
        ("shape = \"disk\"\ntessellate = 2", 3, "between 3 and 65536"),
        ("shape = \"disk\"\nsubdivisions = 2", 3, "unknown key \"subdivisions\" in a disk"),
        ("shape = \"disk\"\nradius = 0", 3, "greater than 0"),
        ("shape = \"disk\"\ncenter = [1e8, 0, 0]", 1, "the disk is too small for single precision"),
        ("shape = \"dsik\"", 2, "did you mean \"disk\"?"),
        ("shape = \"box\"\nmin = [0, 0, 0]\nmax = [1, 1, 1]\ntessellate = 1", 5, "unknown key \"tessellate\""),
        ("file = \"heap.xyzr\"\nradius = 1", 3, "unknown key \"radius\" in a file of spheres"),
        ("file = \"heap.xyzr\"\ntranslate = [1e8, 0, 0]", 1, "the sphere number 2 is too small"),
        ("file = \"none.xyzr\"", 2, "no such file"),
        ("file = \"heap.stl\"", 2, "is no .obj, .ply, .gltf, .glb, .xyzr, .hair or .txt"),
    ] {
        let text = format!("[[mesh]]\n{keys}\n");
        let files: [(&str, &[u8]); 3] =
            [("scene.toml", text.as_bytes()), ("heap.xyzr", b"0 0 0 9\n0 0 0 1\n"), ("heap.stl", b"solid\n")];
        assert_refused(&Folder::new(&files).refuse("scene.toml"), "scene.toml", Some(line), why);
    }
}

#[test]
fn a_fault_in_a_file_of_spheres_names_its_line() {
    for (text, line, why) in [
        (&b"0 0 0 1\n1 2 3\n"[..], Some(2), "four numbers, x y z radius, not 3"),
        (b"\n0 0 0 1 7\n", Some(2), "not 5"),
        (b"0 0 nan 1\n", Some(1), "no finite number"),
        (b"0 0 0 inf\n", Some(1), "no finite number"),
        (b"0,0,0,1\n", Some(1), "not 1"),
        (b"0, 0, 0, 1\n", Some(1), "holds \"0,\", which is no number"),
        (b"0 0 0 0\n", Some(1), "greater than 0, not 0"),
        (b"# r\n0 0 0 -2\n", Some(2), "greater than 0, not -2"),
        (b"1e8 0 0 1\n", Some(1), "too small for single precision"),
        (b"3e38 0 0 2e38\n", Some(1), "leaves the range"),
        (b"\xff 0 0 1\n", Some(1), "no number"),
        (b"# nothing\n\n", None, "no sphere in it"),
    ] {
        let error = xyzr::parse(Path::new("heap.xyzr"), text, budget(1 << 20)).expect_err("accepted");
        assert_refused(&error, "heap.xyzr", line, why);
        assert!(!error.to_string().contains('\n'), "{error}");
    }
}

#[test]
fn spheres_are_counted_before_they_are_placed_and_while_they_are_read() {
    let folder = Folder::new(&[
        ("twice.toml", b"[[mesh]]\nfile = \"heap.xyzr\"\n[[mesh]]\nfile = \"heap.xyzr\"\n"),
        ("many.toml", "[[mesh]]\nshape = \"sphere\"\n".repeat(9).as_bytes()),
        ("heap.xyzr", "0 0 0 1\n".repeat(4).as_bytes()),
    ]);
    let refuse =
        |name: &str, bytes| load_within(&folder.path(name), budget(bytes), Loading::default()).expect_err("accepted");
    assert_refused(&refuse("twice.toml", 2700), "twice.toml", Some(3), "8 spheres and disks take about 0 MB");
    assert_refused(&refuse("twice.toml", 900), "heap.xyzr", Some(3), "3 spheres and disks");
    assert_refused(&refuse("many.toml", 1900), "many.toml", Some(11), "6 spheres and disks");
}
