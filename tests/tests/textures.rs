//! What textures, opacity and what is absorbed make of light, against closed forms and against the same by other means.

use std::sync::Arc;

use eyerays::picture::Picture;
use eyerays::scene::{
    Absorption, Alpha, Background, Camera, Filter, Integrator, Light, Map, Maps, Material, Physical, Placement,
    Projection, Sampler, Scene, Settings, Sphere, Texels, Texture, Transport,
};
use eyerays_tests::model::{add_quad, add_wall, black, empty, matt};
use eyerays_tests::{assert_same_bits, on_cpu, pack};
use glam::{Vec2, Vec3};

fn settings(integrator: Integrator) -> Settings {
    Settings {
        size: (48, 32),
        spp: 16,
        sampler: Sampler::Random,
        bounces: 4,
        transport: Transport { integrator, ..Transport::default() },
        ..Settings::default()
    }
}

fn camera(eye: Vec3, fov: f32) -> Camera {
    let projection = Projection::Perspective { fov };
    Camera { up: Vec3::new(0.1, 1.0, 0.0), ..Camera::new("front", eye, Vec3::ZERO, projection) }
}

fn picture(scene: &Scene, camera: &Camera, settings: Settings) -> Picture {
    let (picture, rays) = on_cpu(&pack(scene, camera, settings));
    assert_eq!(rays.non_finite, 0);
    picture
}

fn mean(picture: &Picture) -> f64 {
    picture.pixels.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / picture.pixels.len() as f64
}

fn map(side: u32, texels: Texels, placement: Placement) -> Map {
    Map { texture: Arc::new(Texture { name: "map".into(), width: side, height: side, texels }), placement }
}

fn scaled(scale: f32) -> Placement {
    Placement::default().transformed(Vec2::splat(scale), 0.0, Vec2::ZERO)
}

/// Texels that look drawn at random.
fn noise(side: u32) -> Texels {
    Texels::Bytes((0..side * side).map(|i| (i + 1).wrapping_mul(2_654_435_761).to_be_bytes()).collect())
}

/// A white floor under a sun that alone makes it as bright as white, with a black pane between that is opaque to a share.
#[test]
fn a_pane_lets_as_much_of_a_sun_pass_as_it_is_not_opaque() {
    let quad = |half: f32, y: f32| {
        [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)].map(|(x, z)| Vec3::new(half * x, y, half * z))
    };
    for integrator in [Integrator::Path, Integrator::Distributed] {
        for (opacity, tilt) in [(0.1, 0.0), (0.25, 0.1), (0.5, 0.0), (0.5, 0.3), (0.9, 0.2)] {
            let mut scene = empty();
            add_quad(&mut scene, matt(Vec3::ONE), quad(1.0, 0.0));
            add_quad(&mut scene, Material { alpha: Alpha::Blend, opacity, ..black() }, quad(2.0, 1.0));
            let direction = Vec3::new(tilt, -1.0, 0.0).normalize();
            let colour = Vec3::splat(std::f32::consts::PI / -direction.y);
            scene.lights.push(Light::Directional { direction, colour, group: String::new(), illuminant: None });
            // Below the pane.
            let picture = picture(&scene, &camera(Vec3::new(0.0, 0.8, 0.8), 20.0), settings(integrator));
            let (got, want) = (mean(&picture), f64::from(1.0 - opacity));
            let error = (want * (1.0 - want) / (picture.pixels.len() * 16) as f64).sqrt();
            assert!((got - want).abs() < 4.0 * error, "{integrator}, {opacity}, {tilt}: {got} of {want} ({error:.1e})");
        }
    }
}

/// A wall that shines as its picture does, from aslant.
fn wall(coordinates: [Vec<Vec2>; 2], placement: Placement, filter: Filter) -> Picture {
    let mut scene = empty();
    let maps = Maps { emission: Some(map(64, noise(64), placement)), ..Maps::default() };
    add_wall(&mut scene, Material { emission: Vec3::ONE, maps, ..black() }, Vec3::ZERO, 1.0);
    scene.mesh.coordinates = coordinates;
    let settings = Settings { filter, ..settings(Integrator::Path) };
    picture(&scene, &camera(Vec3::new(3.0, 1.0, 3.0), 40.0), settings)
}

/// By powers of two, so that products are exact: the levels are the same, too.
#[test]
fn a_transform_or_the_second_set_is_as_good_as_other_coordinates() {
    let corners = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)];
    let times = |scale: f32| corners.map(|(x, y)| Vec2::new(x, y) * scale).to_vec();
    for filter in [Filter::Bilinear, Filter::Mipmap] {
        for scale in [1.0 / 16.0, 1.0, 16.0] {
            let own = wall([times(scale), Vec::new()], Placement::default(), filter);
            let transformed = wall([times(1.0), Vec::new()], scaled(scale), filter);
            assert_same_bits(&transformed, &own, &format!("{filter}, {scale}, by a transform"));
            let second = Placement { set: 1, ..Placement::default() };
            let other = wall([times(64.0), times(scale)], second, filter);
            assert_same_bits(&other, &own, &format!("{filter}, {scale}, by the second set"));
        }
    }
    let far = |filter| wall([times(16.0), Vec::new()], Placement::default(), filter);
    assert!(!far(Filter::Bilinear).bits_equal(&far(Filter::Mipmap)), "levels make a difference");
}

/// A wall with holes where a picture of 4 x 4 texels says so.
fn grille(texels: Texels, side: u32, nearest: bool, filter: Filter) -> Picture {
    let mut scene = empty();
    let placement = Placement { nearest, ..Placement::default() };
    let maps = Maps { opacity: Some(map(side, texels, placement)), ..Maps::default() };
    let material = Material { alpha: Alpha::Mask(0.5), emission: Vec3::ONE, two_sided: true, maps, ..black() };
    add_wall(&mut scene, material, Vec3::ZERO, 1.0);
    scene.mesh.coordinates[0] = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)].map(Vec2::from).to_vec();
    picture(&scene, &camera(Vec3::new(1.0, 0.5, 3.0), 40.0), Settings { filter, ..settings(Integrator::Path) })
}

#[test]
fn opacity_is_that_of_the_nearest_texel_where_that_is_asked_for() {
    let opaque = |x: u32, y: u32| !(x * 7 + y * 5 + x * y).is_multiple_of(3);
    let picture = |side: u32| {
        let place = move |i: u32| (i % side * 4 / side, i / side * 4 / side);
        let texel = move |i| if opaque(place(i).0, place(i).1) { [255; 4] } else { [255, 255, 255, 0] };
        Texels::Bytes((0..side * side).map(texel).collect())
    };
    let own = grille(picture(4), 4, true, Filter::Mipmap);
    assert_same_bits(&own, &grille(picture(64), 64, true, Filter::Mipmap), "with texels of the same value");
    assert_same_bits(&own, &grille(picture(4), 4, false, Filter::Nearest), "by the filter");
    assert!(!own.bits_equal(&grille(picture(4), 4, false, Filter::Mipmap)), "between texels it is another");
}

#[test]
fn opacity_of_floats_counts_as_that_of_bytes() {
    let share = |i: u32| if i.is_multiple_of(3) { 255 } else { 51 };
    let bytes = Texels::Bytes((0..16).map(|i| [255, 255, 255, share(i)]).collect());
    let floats = (0..16).map(|i| [1.0, 1.0, 1.0, f32::from(share(i)) * (1.0 / 255.0)]).collect();
    let of = |texels| grille(texels, 4, false, Filter::Mipmap);
    assert_same_bits(&of(Texels::Floats(floats)), &of(bytes), "the same opacity");
}

/// A ball before white, seen in its middle.
fn ball(material: Material, integrator: Integrator) -> f64 {
    let mut scene = empty();
    scene.background = Background::Colour(Vec3::ONE);
    scene.materials.push(material);
    scene.spheres.push(Sphere { center: Vec3::ZERO, radius: 1.0, material: 0 });
    mean(&picture(&scene, &camera(Vec3::Z * 5.0, 0.1), settings(integrator)))
}

/// Beer and Lambert's law.
#[test]
fn a_body_absorbs_what_its_width_asks_for() {
    let absorption = Some(Absorption { colour: Vec3::splat(0.5), distance: 2.0 });
    let physical = Physical { transmission: Vec3::ONE, ior: 1.0, roughness: 0.0, absorption, ..Physical::default() };
    for integrator in [Integrator::Path, Integrator::Distributed] {
        let through = ball(Material { physical: Some(physical), ..black() }, integrator);
        assert!((through - 0.5).abs() < 1e-4, "{integrator}: {through}");
    }
}

/// At most all light is reflected, by the product of factor and texture (KHR_materials_specular).
#[test]
fn a_tint_is_limited_after_its_texture() {
    let reflects = |factor: f32, texel: f32| {
        let mut scene = empty();
        scene.background = Background::Colour(Vec3::ONE);
        let physical =
            Physical { base: Vec3::ZERO, specular_tint: Vec3::splat(factor), roughness: 0.5, ..Physical::default() };
        let texels = Texels::Floats(vec![[texel, texel, texel, 1.0]]);
        let maps = Maps { specular_tint: Some(map(1, texels, Placement::default())), ..Maps::default() };
        add_wall(&mut scene, Material { physical: Some(physical), maps, ..black() }, Vec3::ZERO, 1.0);
        picture(&scene, &camera(Vec3::Z * 3.0, 20.0), settings(Integrator::Path))
    };
    let (light, full) = (reflects(8.0, 1.0), reflects(64.0, 1.0));
    assert_same_bits(&reflects(64.0, 0.125), &light, "a factor of which a texture leaves an eighth");
    assert_same_bits(&reflects(512.0, 1.0), &full, "all of the light");
    assert!(mean(&light) < 0.5 * mean(&full), "{} of {}", mean(&light), mean(&full));
}
