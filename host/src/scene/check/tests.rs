//! What no scene may be.

use glam::{Vec2, Vec4};

use super::*;
use crate::scene::{Alpha, Checker, Environment, Map, Placement, Texels, Texture};

fn loaded(path: &str) -> Scene {
    crate::scene_io::load(&std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap().0
}

/// What is said of a scene after a change.
fn after(whole: &Scene, spoil: fn(&mut Scene)) -> String {
    let mut scene = whole.clone();
    spoil(&mut scene);
    scene.check().expect_err("accepted").message()
}

#[test]
fn what_is_out_of_range_is_told_with_what_has_it() {
    let whole = loaded("src/scene_io/example.toml");
    assert_eq!(whole.check(), Ok(()));
    let after = |spoil| after(&whole, spoil);
    assert_eq!(after(|s| s.ambient.y = -1.0), "the scene has the ambient -1; it must be a finite number of at least 0");
    assert!(after(|s| s.background = Background::Colour(Vec3::NAN)).starts_with("the scene has the background NaN"));
    let wrong_material: [fn(&mut Material); 5] = [
        |m| m.diffuse.x = 1.5,
        |m| m.shininess = -1.0,
        |m| m.ior = 0.5,
        |m| m.emission.z = f32::INFINITY,
        |m| m.checker = Some(Checker { colour: Vec3::ZERO, ambient: Vec3::ZERO, size: 0.0 }),
    ];
    for spoil in wrong_material {
        let mut scene = whole.clone();
        spoil(&mut scene.materials[0]);
        let fault = scene.check().expect_err("accepted").message();
        assert!(fault.starts_with(&format!("the material {:?} has the ", whole.materials[0].name)), "{fault}");
    }
    let light = |light| {
        let mut scene = whole.clone();
        scene.lights.insert(0, light);
        scene.check().expect_err("accepted").message()
    };
    let (position, colour, direction) = (Vec3::ONE, Vec3::ONE, Vec3::ZERO);
    assert!(
        light(Light::Point { position, colour: -colour, group: String::new(), illuminant: None })
            .starts_with("light 0 has the color -1")
    );
    assert!(
        light(Light::Directional { direction, colour, group: String::new(), illuminant: None })
            .starts_with("light 0 has no direction")
    );
    let falloff = crate::scene::Falloff::Smooth;
    let spot = |target, outer, inner| {
        light(Light::Spot { position, target, colour, outer, inner, falloff, group: String::new(), illuminant: None })
    };
    assert!(spot(position, 20.0, 10.0).starts_with("light 0 shines at its own position"));
    assert!(spot(-position, 20.0, 30.0).starts_with("light 0 has the inner angle 30"));
    assert!(spot(-position, 90.0, 10.0).starts_with("light 0 has the angle 180"));
    assert!(
        after(|s| s.cameras[0].projection = Projection::Perspective { fov: 180.0 })
            .starts_with("the camera \"front\" has the fov 180")
    );
    assert!(after(|s| s.cameras[0].up = s.cameras[0].target - s.cameras[0].eye).contains("has its up along its view"));
    let range = after(|s| s.objects[0].primitives = Primitives::Triangles(0..1_000_000));
    assert!(range.contains("is made of the triangles 0 to 1000000, but there are "), "{range}");
    assert!(after(|s| s.objects[0].bounds[1].x = f32::NAN).contains("has the bounds NaN"));
}

/// What code makes is refused as what files hold is; kernels would read beyond their buffers.
#[test]
fn a_mesh_that_names_what_there_is_not_or_is_nowhere_is_refused() {
    let whole = loaded("../scenes/whitted.toml");
    let after = |spoil| after(&whole, spoil);
    assert!(after(|s| s.mesh.materials[1] = 1000).starts_with("triangle 1 has material 1000"));
    assert!(after(|s| s.mesh.triangles[0][1] = u32::MAX).starts_with("triangle 0 has vertex 4294967295"));
    assert!(after(|s| s.mesh.materials.truncate(1)).contains("materials of them"));
    assert!(after(|s| s.mesh.normals.push(Vec3::X)).contains("normals"));
    assert!(
        after(|s| s.mesh.normals = vec![Vec3::ONE; s.mesh.positions.len()])
            .starts_with("vertex 0 has a normal of length")
    );
    assert!(after(|s| s.materials.clear()).starts_with("triangle 0 has material"));
    assert!(after(|s| s.mesh.positions[2].z = f32::NAN).starts_with("triangle 0 has vertex 2 at ["));
    assert!(after(|s| s.mesh.positions.push(Vec3::INFINITY)).starts_with("the mesh has vertex "));
}

#[test]
fn spheres_and_disks_that_are_none_are_refused_by_their_number() {
    let mut whole = loaded("../scenes/whitted.toml");
    let sphere = Sphere { center: Vec3::ZERO, radius: 1.0, material: 0 };
    whole.spheres = vec![sphere; 2];
    // Off by no more than single precision makes it.
    let disk = Disk { center: Vec3::ONE, normal: Vec3::new(0.6, 0.800_1, 0.0), radius: 2.0, material: 1 };
    whole.disks = vec![disk; 3];
    assert_eq!(Scene::check(&whole), Ok(()));
    let spoilt = |spoil| after(&whole, spoil);
    assert_eq!(spoilt(|s| s.spheres[1].material = 9), "sphere 1 has material 9, but there are 3");
    assert_eq!(spoilt(|s| s.disks[2].material = 9), "disk 2 has material 9, but there are 3");
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let mut scene = whole.clone();
        scene.spheres[0].radius = radius;
        let fault = Scene::check(&scene).expect_err("accepted").message();
        assert_eq!(fault, format!("sphere 0 has the radius {radius}: make it finite and greater than 0"));
    }
    assert!(spoilt(|s| (s.spheres[0].center.x, s.spheres[0].radius) = (3e38, 1e38)).contains("leaves the range"));
    assert!(spoilt(|s| s.spheres[1].center.y = f32::NAN).starts_with("sphere 1 has the center [0, NaN, 0]"));
    assert!(spoilt(|s| s.disks[0].radius = -1.0).starts_with("disk 0 has the radius -1"));
    for normal in [Vec3::ZERO, Vec3::splat(0.5), Vec3::NAN, Vec3::INFINITY, Vec3::Y * 1.01] {
        let mut scene = whole.clone();
        scene.disks[1].normal = normal;
        let fault = Scene::check(&scene).expect_err("accepted").message();
        assert!(fault.starts_with("disk 1 has a normal of length "), "{fault}");
    }
}

#[test]
fn what_covers_surfaces_is_refused_by_the_vertex_or_the_material() {
    let mut whole = loaded("../scenes/whitted.toml");
    let vertices = whole.mesh.positions.len();
    whole.mesh.coordinates = [vec![Vec2::ONE; vertices], Vec::new()];
    whole.mesh.tangents = vec![Vec4::X; vertices];
    whole.mesh.colours = vec![Vec4::ONE; vertices];
    let texture = Texture { name: "a.png".into(), width: 1, height: 1, texels: Texels::Floats(vec![[1.0; 4]]) };
    let map = Map { texture: texture.into(), placement: Placement::default() };
    whole.materials[0].maps.base = Some(map.clone());
    whole.environment = Some(Environment { texture: map.texture, rotation: 0.0, scale: 1.0, visible: true });
    assert_eq!(Scene::check(&whole), Ok(()));
    let spoilt = |spoil| after(&whole, spoil);
    assert!(
        spoilt(|s| s.mesh.coordinates[1] = vec![Vec2::ONE]).contains("1 second texture coordinates: give each one")
    );
    assert!(spoilt(|s| s.mesh.tangents.truncate(1)).contains("tangents: give each one, or none"));
    assert!(
        spoilt(|s| s.mesh.coordinates[0][1].y = f32::NAN).starts_with("vertex 1 has the texture coordinates [1, NaN]")
    );
    assert!(spoilt(|s| s.mesh.tangents[2].w = f32::INFINITY).starts_with("vertex 2 has the tangent "));
    assert!(
        spoilt(|s| s.mesh.colours[0].x = 1.5).starts_with("vertex 0 has the color [1.5, 1, 1, 1]; its numbers must")
    );
    assert!(spoilt(|s| s.materials[0].opacity = 1.5).contains("has the opacity 1.5; it must be between 0 and 1"));
    assert!(spoilt(|s| s.materials[0].alpha = Alpha::Mask(f32::NAN)).contains("has the alpha_cutoff NaN"));
    assert!(spoilt(|s| s.materials[0].maps.normal_scale = f32::NAN).contains("strength of normals NaN"));
    fn placement(scene: &mut Scene) -> &mut Placement {
        &mut scene.materials[0].maps.base.as_mut().unwrap().placement
    }
    assert!(spoilt(|s| placement(s).set = 2).contains("takes the texture \"a.png\" by coordinates 2"));
    assert!(spoilt(|s| placement(s).transform[1][2] = f32::NAN).contains("place of the texture \"a.png\" NaN"));
    assert!(spoilt(|s| s.environment.as_mut().unwrap().rotation = f32::NAN).contains("environment's rotation NaN"));
    assert!(spoilt(|s| s.environment.as_mut().unwrap().scale = -1.0).contains("environment's scale -1"));
    let dark = |s: &mut Scene| {
        let texture = Texture {
            texels: Texels::Floats(vec![[1.0, -1.0, 1.0, 1.0]]),
            ..(*s.environment.as_ref().unwrap().texture).clone()
        };
        s.environment.as_mut().unwrap().texture = texture.into();
    };
    assert_eq!(spoilt(dark), "the texture \"a.png\" holds -1; light is finite and at least 0, opacity at most 1");
}
