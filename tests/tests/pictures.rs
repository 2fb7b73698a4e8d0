//! Pictures whose pixels a person can calculate: exact precision on the CPU against the formulas.

use eyerays::scene::{Background, Checker, Falloff, Light, Material, Projection, Scene, Settings};
use eyerays_tests::model::{add, add_box, add_wall, black, empty, glass, glowing, lamp, matt, mirror, sun};
use eyerays_tests::{on_cpu, pack};
use glam::Vec3;

/// The pixels row by row from the top left.
fn render(scene: &Scene) -> Vec<Vec3> {
    let packed = pack(scene, &scene.cameras[0], scene.settings);
    let (picture, rays) = on_cpu(&packed);
    assert_eq!(rays.non_finite, 0);
    picture.pixels.into_iter().map(Vec3::from).collect()
}

/// The one pixel along the view.
fn pixel(scene: &Scene) -> Vec3 {
    assert_eq!(scene.settings.size, (1, 1));
    render(scene)[0]
}

fn assert_near(got: Vec3, want: Vec3) {
    assert!((got - want).abs().max_element() < 1e-6, "{got} is not {want}");
}

fn look(scene: &mut Scene, eye: Vec3, target: Vec3) {
    let up = if (target - eye).cross(Vec3::Y) == Vec3::ZERO { Vec3::Z } else { Vec3::Y };
    (scene.cameras[0].eye, scene.cameras[0].target, scene.cameras[0].up) = (eye, target, up);
}

const GREY: Vec3 = Vec3::new(0.5, 0.4, 0.25);

#[test]
fn a_plane_has_ambient_and_lamberts_light() {
    for degrees in [0f32, 30.0, 60.0, 85.0] {
        let mut scene = empty();
        add_wall(&mut scene, matt(GREY), Vec3::new(0.0, 0.0, -3.0), 1.0);
        scene.ambient = Vec3::new(0.1, 0.2, 0.3);
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let colour = Vec3::new(1.0, 0.5, 2.0);
        scene.lights = vec![Light::Directional {
            direction: Vec3::new(sine, 0.0, -cosine) * 7.0,
            colour,
            group: String::new(),
            illuminant: None,
        }];
        assert_near(pixel(&scene), GREY * scene.ambient + GREY * colour * cosine);
    }
}

#[test]
fn light_from_behind_a_surface_does_not_reach_it() {
    let mut scene = empty();
    add_wall(&mut scene, matt(GREY), Vec3::new(0.0, 0.0, -3.0), 1.0);
    scene.ambient = Vec3::splat(0.1);
    scene.lights = vec![sun(Vec3::Z), lamp(Vec3::new(0.0, 0.0, -5.0))];
    assert_near(pixel(&scene), GREY * 0.1);
}

#[test]
fn a_point_light_has_its_own_direction_and_does_not_fade() {
    for distance in [0.5, 1.0, 40.0] {
        let mut scene = empty();
        let place = Vec3::new(0.0, 0.0, -3.0);
        add_wall(&mut scene, matt(GREY), place, 1.0);
        scene.lights = vec![lamp(place + Vec3::new(0.6, 0.0, 0.8) * distance)];
        assert_near(pixel(&scene), GREY * 0.8);
    }
}

#[test]
fn lights_add_up() {
    let mut scene = empty();
    add_wall(&mut scene, matt(GREY), Vec3::new(0.0, 0.0, -3.0), 1.0);
    scene.lights = vec![sun(Vec3::NEG_Z), sun(Vec3::new(0.0, 3.0, -4.0)), lamp(Vec3::ZERO)];
    assert_near(pixel(&scene), GREY * (1.0 + 0.8 + 1.0));
}

#[test]
fn a_highlight_has_phongs_power() {
    for (degrees, shininess) in [(0f32, 10.0), (20.0, 10.0), (20.0, 0.0), (3.0, 200.0)] {
        let mut scene = empty();
        let shiny = Material { specular: Vec3::new(0.2, 0.4, 0.8), shininess, ..black() };
        add_wall(&mut scene, shiny, Vec3::new(0.0, 0.0, -3.0), 1.0);
        let (sine, cosine) = degrees.to_radians().sin_cos();
        scene.lights = vec![sun(Vec3::new(sine, 0.0, -cosine))];
        // The mirrored light is as far from the view as the light itself.
        assert_near(pixel(&scene), Vec3::new(0.2, 0.4, 0.8) * f64::from(cosine).powf(shininess.into()) as f32);
    }
}

#[test]
fn a_shadow_has_ambient_light_alone() {
    let mut scene = empty();
    add_wall(&mut scene, matt(GREY), Vec3::new(0.0, 0.0, -3.0), 2.0);
    add_wall(&mut scene, matt(Vec3::ONE), Vec3::new(1.0, 0.0, -2.0), 0.5);
    scene.ambient = Vec3::splat(0.25);
    for light in [lamp(Vec3::new(2.0, 0.0, -1.0)), sun(Vec3::new(-1.0, 0.0, -1.0))] {
        scene.lights = vec![light];
        assert_near(pixel(&scene), GREY * 0.25);
    }
    // Just over the edge of what is between, and in front of it.
    for (light, cosine) in [
        (lamp(Vec3::new(2.0, 1.1, -1.0)), 2.0 / Vec3::new(2.0, 1.1, 2.0).length()),
        (lamp(Vec3::new(0.4, 0.0, -2.6)), 0.5f32.sqrt()),
    ] {
        scene.lights = vec![light];
        assert_near(pixel(&scene), GREY * (0.25 + cosine));
    }
}

#[test]
fn glass_casts_no_shadow() {
    let mut scene = empty();
    add_wall(&mut scene, matt(GREY), Vec3::new(0.0, 0.0, -3.0), 2.0);
    add_wall(&mut scene, glass(Vec3::splat(0.1)), Vec3::new(1.0, 0.0, -2.0), 0.5);
    scene.lights = vec![sun(Vec3::new(-1.0, 0.0, -1.0))];
    assert_near(pixel(&scene), GREY * 0.5f32.sqrt());
}

#[test]
fn a_spot_lights_its_cone_with_a_soft_rim() {
    for (degrees, share) in [(0f32, 1.0), (19.0, 1.0), (41.0, 0.0), (80.0, 0.0), (30.0, f64::NAN)] {
        let mut scene = empty();
        add_wall(&mut scene, matt(GREY), Vec3::new(0.0, 0.0, -3.0), 1.0);
        scene.ambient = Vec3::splat(0.1);
        // The light is straight above the place; its axis is turned away from it.
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let position = Vec3::new(0.0, 0.0, -1.0);
        let target = position + Vec3::new(sine, 0.0, -cosine);
        let (outer, inner, falloff) = (40.0, 20.0, Falloff::Smooth);
        scene.lights = vec![Light::Spot {
            position,
            target,
            colour: Vec3::ONE,
            outer,
            inner,
            falloff,
            group: String::new(),
            illuminant: None,
        }];
        let cos = |degrees: f64| degrees.to_radians().cos();
        let x = (cos(degrees.into()) - cos(40.0)) / (cos(20.0) - cos(40.0));
        let share = if share.is_nan() { x * x * (3.0 - 2.0 * x) } else { share };
        assert_near(pixel(&scene), GREY * (0.1 + share as f32));
    }
}

const SKY: Background = Background::Gradient { horizon: Vec3::new(0.8, 0.6, 0.4), zenith: Vec3::new(0.1, 0.2, 0.9) };

fn sky(height: f32) -> Vec3 {
    let height = height.clamp(0.0, 1.0);
    Vec3::new(0.8, 0.6, 0.4) * (1.0 - height) + Vec3::new(0.1, 0.2, 0.9) * height
}

#[test]
fn the_background_is_a_gradient_over_the_height() {
    let mut scene = empty();
    add_wall(&mut scene, matt(GREY), Vec3::new(0.0, 0.0, 5.0), 1.0);
    scene.background = SKY;
    for (direction, height) in
        [(Vec3::NEG_Z, 0.0), (Vec3::Y, 1.0), (Vec3::NEG_Y, 0.0), (Vec3::new(0.0, 3.0, -4.0), 0.6), (Vec3::X, 0.0)]
    {
        look(&mut scene, Vec3::ZERO, direction);
        assert_near(pixel(&scene), sky(height));
    }
}

#[test]
fn a_mirror_shows_what_is_behind_the_camera() {
    let tint = Vec3::new(0.9, 0.5, 0.25);
    let mut scene = empty();
    add_wall(&mut scene, Material { ambient: Some(GREY), ..mirror(tint) }, Vec3::new(0.0, 0.0, -3.0), 1.0);
    add_wall(&mut scene, glowing(Vec3::new(0.3, 0.7, 0.9)), Vec3::new(0.0, 0.0, 2.0), 1.0);
    scene.ambient = Vec3::ONE;
    assert_near(pixel(&scene), GREY + tint * Vec3::new(0.3, 0.7, 0.9));
    scene.settings.bounces = 0;
    assert_near(pixel(&scene), GREY);
}

#[test]
fn a_mirror_turned_up_shows_the_sky() {
    let tint = Vec3::new(0.9, 0.5, 0.25);
    let mut scene = empty();
    scene.background = SKY;
    let corners = [(-1.0, -4.0, -2.0), (1.0, -4.0, -2.0), (1.0, 4.0, -10.0), (-1.0, 4.0, -10.0)];
    let corners = corners.map(|(x, y, z)| Vec3::new(x, y, z + 0.5));
    add(&mut scene, mirror(tint), &corners, &[[0, 1, 2], [0, 2, 3]]);
    assert_near(pixel(&scene), tint * sky(1.0));
}

#[test]
fn mirrors_face_to_face_end_at_the_bounce_limit() {
    for bounces in 0..6 {
        let mut scene = empty();
        for z in [-2.0, 3.0] {
            let half = Material { ambient: Some(Vec3::ONE), ..mirror(Vec3::splat(0.5)) };
            add_wall(&mut scene, half, Vec3::new(0.0, 0.0, z), 1.0);
        }
        scene.ambient = Vec3::ONE;
        scene.settings.bounces = bounces;
        assert_near(pixel(&scene), Vec3::splat(2.0 - 0.5f32.powi(bounces as i32)));
    }
}

#[test]
fn the_least_contribution_ends_a_chain_of_mirrors() {
    let mut scene = empty();
    for z in [-2.0, 3.0] {
        let half = Material { ambient: Some(Vec3::ONE), ..mirror(Vec3::splat(0.5)) };
        add_wall(&mut scene, half, Vec3::new(0.0, 0.0, z), 1.0);
    }
    scene.ambient = Vec3::ONE;
    scene.settings = Settings { bounces: 100, min_contribution: 0.125, ..scene.settings };
    assert_near(pixel(&scene), Vec3::splat(1.0 + 0.5 + 0.25 + 0.125));
}

/// What an interface to glass of index 1.5 reflects at normal incidence.
const MIRRORED: f32 = 0.04;

#[test]
fn a_slab_of_glass_passes_what_fresnels_equations_leave() {
    let tint = Vec3::new(0.9, 0.8, 0.5);
    let passed = tint * tint * (1.0 - MIRRORED) * (1.0 - MIRRORED);
    for (bounces, share) in [(2, Vec3::ONE), (4, Vec3::splat(1.0 + MIRRORED * MIRRORED))] {
        let mut scene = empty();
        add_box(&mut scene, glass(tint), Vec3::new(-1.0, -1.0, -3.0), Vec3::new(1.0, 1.0, -2.0));
        add_wall(&mut scene, glowing(GREY), Vec3::new(0.0, 0.0, -5.0), 2.0);
        scene.ambient = Vec3::ONE;
        scene.settings.bounces = bounces;
        assert_near(pixel(&scene), GREY * passed * share);
        // And the background that the first interface mirrors.
        scene.background = Background::Colour(Vec3::ONE);
        let second = if bounces == 2 { Vec3::ZERO } else { passed * MIRRORED };
        assert_near(pixel(&scene), GREY * passed * share + MIRRORED + second);
    }
}

/// Glass of any index without a tint neither makes nor takes light.
#[test]
fn glass_in_an_even_light_cannot_be_seen() {
    for ior in [1.0, 1.333, 1.5, 2.4] {
        let mut scene = empty();
        let clear = Material { ior, ..glass(Vec3::ONE) };
        add_box(&mut scene, clear, Vec3::new(-1.0, -0.8, -4.0), Vec3::new(0.6, 1.0, -2.0));
        scene.background = Background::Colour(Vec3::new(0.3, 0.5, 0.7));
        scene.cameras[0].projection = Projection::Perspective { fov: 60.0 };
        scene.settings = Settings { size: (32, 24), bounces: 60, min_contribution: 1e-6, ..scene.settings };
        for got in render(&scene) {
            let lost = (got / Vec3::new(0.3, 0.5, 0.7) - 1.0).abs().max_element();
            assert!(lost < 1e-3, "index {ior}: {got}");
        }
    }
}

/// A ray at 45 degrees leaves a slab beside where it came in, by Snell's law.
#[test]
fn a_slab_moves_what_is_behind_it() {
    let inside = (0.5f64.sqrt() / 1.5).asin();
    // From the eye at the origin: down to the slab at -1, through its thickness of 1, to the floor at -3.
    let shift = (1.0 + inside.tan() + 1.0) as f32;
    for (side, seen) in [(1e-3, Vec3::X), (-1e-3, Vec3::Y)] {
        let mut scene = empty();
        add_box(&mut scene, glass(Vec3::ONE), Vec3::new(-9.0, -2.0, -9.0), Vec3::new(9.0, -1.0, 9.0));
        for (from, to, colour) in [(-20.0, shift + side, Vec3::X), (shift + side, 20.0, Vec3::Y)] {
            let corners = [(from, 9.0), (to, 9.0), (to, -9.0), (from, -9.0)].map(|(x, z)| Vec3::new(x, -3.0, z));
            add(&mut scene, glowing(colour), &corners, &[[0, 1, 2], [0, 2, 3]]);
        }
        scene.ambient = Vec3::ONE;
        scene.settings.bounces = 2;
        look(&mut scene, Vec3::ZERO, Vec3::new(1.0, -1.0, 0.0));
        let (outside, inside) = (0.5f64.sqrt(), inside.cos());
        let across = (outside - 1.5 * inside) / (outside + 1.5 * inside);
        let along = (1.5 * outside - inside) / (1.5 * outside + inside);
        let passed = 1.0 - (across * across + along * along) / 2.0;
        assert_near(pixel(&scene), seen * (passed * passed) as f32);
    }
}

/// Straight into a wedge, off its slanted side, which reflects all, and out at its top.
#[test]
fn beyond_the_critical_angle_glass_is_a_mirror() {
    let mut scene = empty();
    let profile = [(-2.0, -1.0), (-2.0, 1.0), (-4.0, 1.0)];
    let corners: Vec<Vec3> = [-1.0, 1.0].iter().flat_map(|&x| profile.map(|(z, y)| Vec3::new(x, y, z))).collect();
    let sides = [[0, 3, 4], [0, 4, 1], [1, 4, 5], [1, 5, 2], [2, 5, 3], [2, 3, 0], [0, 1, 2], [3, 5, 4]];
    add(&mut scene, glass(Vec3::ONE), &corners, &sides);
    let ceiling = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)].map(|(x, z)| Vec3::new(x, 5.0, z));
    add(&mut scene, glowing(GREY), &ceiling, &[[0, 1, 2], [0, 2, 3]]);
    scene.ambient = Vec3::ONE;
    scene.settings.bounces = 3;
    assert_near(pixel(&scene), GREY * (1.0 - MIRRORED) * (1.0 - MIRRORED));
    scene.settings.bounces = 2;
    assert_near(pixel(&scene), Vec3::ZERO);
}

#[test]
fn culling_shows_what_is_behind_a_back() {
    let mut scene = empty();
    let back = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(x, y)| Vec3::new(x, y, -2.0));
    add(&mut scene, glowing(Vec3::X), &back, &[[0, 1, 2], [0, 2, 3]]);
    add_wall(&mut scene, matt(GREY), Vec3::new(0.0, 0.0, -3.0), 1.0);
    scene.ambient = Vec3::ONE;
    scene.lights = vec![sun(Vec3::NEG_Z)];
    assert_near(pixel(&scene), Vec3::X);
    scene.settings.culling = true;
    // A back that is not seen casts its shadow all the same.
    assert_near(pixel(&scene), GREY);
}

#[test]
fn a_checker_changes_at_its_cells() {
    for (x, y, odd) in [(0.3, 0.3, false), (0.7, 0.3, true), (0.7, 0.7, false), (-0.2, 0.3, true), (1.3, -0.2, true)] {
        let mut scene = empty();
        let checker = Some(Checker { colour: Vec3::X, ambient: Vec3::Y, size: 0.5 });
        add_wall(&mut scene, Material { checker, ..matt(GREY) }, Vec3::new(0.0, 0.0, -3.0), 2.0);
        scene.lights = vec![sun(Vec3::NEG_Z)];
        scene.ambient = Vec3::splat(0.5);
        look(&mut scene, Vec3::new(x, y, 0.0), Vec3::new(x, y, -1.0));
        assert_near(pixel(&scene), if odd { Vec3::new(1.0, 0.5, 0.0) } else { GREY * 1.5 });
    }
}

/// Light follows the vertices' normals, not the triangle's.
#[test]
fn smooth_normals_are_interpolated() {
    let mut scene = empty();
    let corners = [Vec3::new(-1.0, -1.0, -3.0), Vec3::new(1.0, -1.0, -3.0), Vec3::new(0.0, 1.0, -3.0)];
    add(&mut scene, matt(GREY), &corners, &[[0, 1, 2]]);
    let normals = [Vec3::new(-0.6, 0.0, 0.8), Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8)];
    scene.mesh.normals = normals.to_vec();
    scene.lights = vec![sun(Vec3::NEG_Z)];
    for weights in [[0.25, 0.25, 0.5], [0.6, 0.3, 0.1], [0.1, 0.1, 0.8]] {
        let mix = |all: [Vec3; 3]| all.iter().zip(weights).map(|(&v, weight)| v * weight).sum::<Vec3>();
        let place = mix(corners);
        look(&mut scene, Vec3::new(place.x, place.y, 0.0), place);
        assert_near(pixel(&scene), GREY * mix(normals).normalize().z);
    }
}

/// An edge along a pixel's middle: as many samples on one side as on the other.
#[test]
fn samples_are_averaged() {
    let mut scene = empty();
    let half = [(-9.0, -9.0), (0.0, -9.0), (0.0, 9.0), (-9.0, 9.0)].map(|(x, y)| Vec3::new(x, y, -3.0));
    add(&mut scene, glowing(GREY), &half, &[[0, 1, 2], [0, 2, 3]]);
    scene.ambient = Vec3::ONE;
    scene.background = Background::Colour(Vec3::Z);
    for samples in [2, 4] {
        scene.settings.samples = samples;
        assert_near(pixel(&scene), (GREY + Vec3::Z) / 2.0);
    }
}

/// Left is left and up is up, and the field of view is the image's height.
#[test]
fn the_camera_frames_what_it_says() {
    let mut scene = empty();
    for (x, y, colour) in [(-1.0, 1.0, Vec3::X), (1.0, 1.0, Vec3::Y), (-1.0, -1.0, Vec3::Z), (1.0, -1.0, Vec3::ONE)] {
        add_wall(&mut scene, glowing(colour), Vec3::new(x, y, -2.0), 1.0);
    }
    scene.ambient = Vec3::ONE;
    // The four walls, 4 by 4 at a distance of 2, fill a square picture of 90 degrees and half of a wide one.
    scene.cameras[0].projection = Projection::Perspective { fov: 90.0 };
    scene.settings.size = (2, 2);
    assert_eq!(render(&scene), [Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE]);
    scene.settings.size = (4, 2);
    let black = Vec3::ZERO;
    assert_eq!(render(&scene), [black, Vec3::X, Vec3::Y, black, black, Vec3::Z, Vec3::ONE, black]);
    scene.settings.size = (2, 2);
    scene.cameras[0].up = Vec3::X;
    assert_eq!(render(&scene), [Vec3::Y, Vec3::ONE, Vec3::X, Vec3::Z]);
}

/// The same picture at any size of the world.
#[test]
fn units_do_not_matter() {
    let scaled = |scale: f32| {
        let mut scene = empty();
        add_wall(&mut scene, matt(GREY), Vec3::new(0.0, 0.0, -3.0) * scale, scale);
        add_box(&mut scene, glass(Vec3::ONE), Vec3::new(-0.5, -0.4, -2.5) * scale, Vec3::new(0.4, 0.3, -2.0) * scale);
        scene.lights = vec![lamp(Vec3::new(1.0, 2.0, 3.0) * scale)];
        scene.cameras[0].target *= scale;
        scene.cameras[0].projection = Projection::Perspective { fov: 50.0 };
        scene.settings.size = (24, 18);
        render(&scene)
    };
    let unit = scaled(1.0);
    for exponent in [-100, -20, 3, 60, 120] {
        assert_eq!(scaled(2f32.powi(exponent)), unit, "2^{exponent}");
    }
}
