//! Who sees what, and what pictures show of it: against pictures of scenes without it, and closed forms.

use eyerays::picture::Picture;
use eyerays::scene::{
    Background, Camera, Integrator, Material, Matte, PixelFilter, Projection, Sampler, Scene, Settings, Sphere, Stereo,
    StereoLayout, Transport, Visibility,
};
use eyerays_tests::model::{add_box, add_wall, black, empty, matt, mirror, sun};
use eyerays_tests::{assert_same_bits, on_cpu, pack};
use glam::Vec3;

const SIZE: (u32, u32) = (48, 32);

fn paths(spp: u32, bounces: u32) -> Settings {
    Settings {
        size: SIZE,
        spp,
        bounces,
        sampler: Sampler::Sobol,
        pixel_filter: Some(PixelFilter::Box),
        transport: Transport { integrator: Integrator::Path, ..Transport::default() },
        ..Settings::default()
    }
}

fn whitted() -> Settings {
    Settings { size: SIZE, samples: 2, ..Settings::default() }
}

/// A floor at height 0 around the origin, which has a visibility.
fn floor(visibility: Visibility, colour: f32) -> Scene {
    let mut scene = empty();
    let material = Material { visibility, ..matt(Vec3::splat(colour)) };
    add_box(&mut scene, material, Vec3::new(-30.0, -1.0, -30.0), Vec3::new(30.0, 0.0, 30.0));
    scene.background = Background::Colour(Vec3::splat(0.5));
    scene
}

fn matte(matte: Matte) -> Visibility {
    Visibility { matte, ..Visibility::default() }
}

fn above() -> Camera {
    Camera::new("above", Vec3::new(0.0, 3.0, 6.0), Vec3::new(0.0, 0.5, 0.0), Projection::Perspective { fov: 40.0 })
}

fn rendered(scene: &mut Scene, settings: Settings) -> Picture {
    scene.cameras = vec![above()];
    let (picture, rays) = on_cpu(&pack(scene, &scene.cameras[0], settings));
    assert_eq!(rays.non_finite, 0);
    picture
}

/// Before a plate, in linear light.
fn over(picture: &Picture, plate: &Picture) -> Vec<f64> {
    let alpha = picture.alpha.as_deref().expect("a picture with mattes tells how opaque it is");
    let pixels = picture.pixels.iter().zip(&plate.pixels).zip(alpha);
    pixels.map(|((own, plate), alpha)| f64::from(own[1] + plate[1] * (1.0 - alpha))).collect()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let all: Vec<f64> = values.collect();
    all.iter().sum::<f64>() / all.len() as f64
}

/// A ball above a floor, by a sun and a pale sky: with the floor as a catcher before the picture of the floor alone, it is the picture of
/// both; where nothing is near, exactly clear.
#[test]
fn a_catcher_before_its_plate_is_the_picture_with_the_plate() {
    let ball = |scene: &mut Scene| {
        let material = scene.materials.len() as u32;
        scene.materials.push(matt(Vec3::new(0.1, 0.05, 0.02)));
        scene.spheres.push(Sphere { center: Vec3::new(0.0, 0.8, 0.0), radius: 0.7, material });
        scene.lights = vec![sun(Vec3::new(0.6, -1.0, 0.2))];
    };
    let (mut plate, mut both, mut caught) =
        (floor(Visibility::default(), 0.4), floor(Visibility::default(), 0.4), floor(matte(Matte::Catcher), 0.4));
    plate.lights = vec![sun(Vec3::new(0.6, -1.0, 0.2))];
    ball(&mut both);
    ball(&mut caught);
    let (plate, both) = (rendered(&mut plate, paths(256, 2)), rendered(&mut both, paths(256, 2)));
    let caught = rendered(&mut caught, paths(256, 2));
    let together = over(&caught, &plate);
    // In blocks of 8 x 8 pixels noise is little; light that goes from floor to ball to floor is a few parts of a hundred.
    for (x, y) in (0..SIZE.0 / 8).flat_map(|x| (0..SIZE.1 / 8).map(move |y| (x, y))) {
        let block = (0..64).map(|i| ((y * 8 + i / 8) * SIZE.0 + x * 8 + i % 8) as usize);
        let (got, want) = (mean(block.clone().map(|i| together[i])), mean(block.map(|i| f64::from(both.pixels[i][1]))));
        assert!((got / want - 1.0).abs() < 0.04, "{x},{y}: {got} of {want}");
    }
    let alpha = caught.alpha.as_deref().unwrap();
    let shadow = (0..alpha.len()).filter(|&i| alpha[i] > 0.3 && alpha[i] < 0.999).count();
    assert!(shadow > 20 && alpha.contains(&1.0), "there are a shadow and a ball: {shadow}");
    // Of the bottom corner on the sunny side no ray meets the ball but by the sky's light, far away.
    assert!(alpha[(SIZE.0 * (SIZE.1 - 1)) as usize] < 0.02);
}

/// Alone it is clear, exactly, by every light; and light from below is kept away by it as by any floor.
#[test]
fn a_catcher_alone_is_clear() {
    for lights in [vec![], vec![sun(Vec3::new(0.3, -1.0, 0.2))]] {
        let mut scene = floor(matte(Matte::Catcher), 0.4);
        scene.lights = lights;
        let picture = rendered(&mut scene, paths(16, 2));
        assert!(picture.alpha.as_deref().unwrap().iter().all(|&alpha| alpha == 0.0));
        assert!(picture.pixels.iter().all(|&pixel| pixel == [0.0; 3]));
    }
}

/// A mirror that catches shows what is reflected of others, and nothing of its surroundings.
#[test]
fn a_mirror_that_catches_shows_reflections_of_others() {
    let mut scene = empty();
    let glass = Material { visibility: matte(Matte::Catcher), ..mirror(Vec3::splat(0.9)) };
    add_box(&mut scene, glass, Vec3::new(-30.0, -1.0, -30.0), Vec3::new(30.0, 0.0, 30.0));
    scene.background = Background::Colour(Vec3::splat(0.5));
    let shining = Material { emission: Vec3::splat(2.0), two_sided: true, ..black() };
    add_wall(&mut scene, shining, Vec3::new(0.0, 1.0, -1.0), 0.5);
    let picture = rendered(&mut scene, paths(64, 2));
    let below: Vec<f32> = picture.pixels[(SIZE.0 * SIZE.1 / 2) as usize..].iter().map(|pixel| pixel[1]).collect();
    assert!(below.iter().any(|&light| (light - 1.8).abs() < 1e-3), "the lamp is reflected");
    assert_eq!(below[below.len() - 1], 0.0, "the sky is not");
}

#[test]
fn a_hole_is_where_the_camera_sees_it_and_nowhere_else() {
    for settings in [whitted(), paths(16, 2)] {
        let mut scene = floor(Visibility::default(), 0.5);
        scene.ambient = Vec3::splat(0.3);
        scene.lights = vec![sun(Vec3::new(0.3, -1.0, 0.2))];
        let shown = rendered(&mut scene, settings);
        let material = scene.materials.len() as u32;
        scene.materials.push(Material { visibility: matte(Matte::Holdout), ..matt(Vec3::splat(0.7)) });
        scene.spheres.push(Sphere { center: Vec3::new(0.0, 0.8, 0.0), radius: 0.7, material });
        let picture = rendered(&mut scene, settings);
        let alpha = picture.alpha.as_deref().unwrap();
        let holes: Vec<usize> = (0..alpha.len()).filter(|&i| alpha[i] == 0.0 && shown.alpha.is_none()).collect();
        assert!(holes.len() > 60 && holes.iter().all(|&i| picture.pixels[i] == [0.0; 3]), "{}", holes.len());
        let darker = (0..alpha.len()).filter(|&i| alpha[i] == 1.0 && picture.pixels[i][1] < 0.8 * shown.pixels[i][1]);
        assert!(darker.count() > 20, "it casts a shadow");
    }
}

/// A ball that rays do not see is as if it were not there, for those rays alone.
#[test]
fn what_is_hidden_is_hidden_from_those_rays_alone() {
    let scene = |visibility| {
        let mut scene = floor(Visibility::default(), 0.5);
        scene.materials[0] = Material { reflection: Vec3::splat(0.5), ..matt(Vec3::splat(0.3)) };
        scene.ambient = Vec3::splat(0.3);
        scene.lights = vec![sun(Vec3::new(0.3, -1.0, 0.2))];
        if let Some(visibility) = visibility {
            let material = scene.materials.len() as u32;
            scene.materials.push(Material { visibility, ..matt(Vec3::new(0.9, 0.2, 0.1)) });
            scene.spheres.push(Sphere { center: Vec3::new(0.0, 0.8, 0.0), radius: 0.7, material });
            add_box(
                &mut scene,
                Material { visibility, ..matt(Vec3::X) },
                Vec3::new(1.0, 0.1, 0.0),
                Vec3::new(2.0, 1.0, 1.0),
            );
        }
        scene
    };
    let plain = Visibility::default();
    let none = Visibility { camera: false, shadow: false, reflection: false, ..plain };
    for settings in [whitted(), paths(4, 2)] {
        let nothing = rendered(&mut scene(None), settings);
        assert_same_bits(&rendered(&mut scene(Some(none)), settings), &nothing, "hidden from all");
        let all = rendered(&mut scene(Some(plain)), settings);
        let differ = |a: &Picture, b: &Picture| a.pixels.iter().zip(&b.pixels).filter(|(a, b)| a != b).count();
        for some in [
            Visibility { camera: true, ..none },
            Visibility { shadow: true, ..none },
            Visibility { reflection: true, ..none },
        ] {
            let picture = rendered(&mut scene(Some(some)), settings);
            assert!(differ(&picture, &nothing) > 20 && differ(&picture, &all) > 20, "{some:?}");
        }
        let unseen = rendered(&mut scene(Some(Visibility { camera: false, ..plain })), settings);
        let red = |picture: &Picture| picture.pixels.iter().filter(|pixel| pixel[0] > 3.0 * pixel[1]).count();
        assert!(red(&all) > 60 && red(&unseen) < red(&all) / 4, "{} {}", red(&all), red(&unseen));
    }
}

/// A lamp that surfaces do not meet lights them as much as one that they do: all of it is sampled then.
#[test]
fn a_lamp_that_surfaces_do_not_meet_lights_them_all_the_same() {
    let light = |reflection| {
        let mut scene = floor(Visibility::default(), 0.6);
        scene.background = Background::Colour(Vec3::ZERO);
        let visibility = Visibility { reflection, ..Visibility::default() };
        let lamp = Material { emission: Vec3::splat(5.0), two_sided: true, visibility, ..black() };
        add_wall(&mut scene, lamp, Vec3::new(0.0, 2.0, -2.0), 0.8);
        let picture = rendered(&mut scene, paths(1024, 1));
        mean(picture.pixels[(SIZE.0 * SIZE.1 / 2) as usize..].iter().map(|pixel| f64::from(pixel[1])))
    };
    let (met, hidden) = (light(true), light(false));
    assert!(met > 0.01 && (hidden / met - 1.0).abs() < 0.01, "{hidden} of {met}");
}

/// A wall that is nearer than the near plane, or farther than the far one, is not seen; by one that is between all is as without planes.
#[test]
fn clipping_planes_leave_out_what_is_not_between_them() {
    for (projection, settings) in [
        (Projection::Perspective { fov: 60.0 }, whitted()),
        (Projection::Perspective { fov: 60.0 }, paths(4, 0)),
        (Projection::Orthographic { height: 3.0 }, whitted()),
        (Projection::Orthographic { height: 3.0 }, paths(4, 0)),
    ] {
        let mut scene = empty();
        scene.background = Background::Colour(Vec3::splat(0.25));
        let shining = |light: f32| Material { emission: Vec3::splat(light), two_sided: true, ..black() };
        let is_whitted = settings.transport.integrator == Integrator::Whitted;
        let of = |light: f32| if is_whitted { matt(Vec3::splat(light)) } else { shining(light) };
        scene.ambient = Vec3::ONE;
        add_wall(&mut scene, of(0.5), Vec3::NEG_Z * 2.0, 9.0);
        add_wall(&mut scene, of(1.0), Vec3::NEG_Z * 4.0, 18.0);
        let seen = |scene: &mut Scene, clip: [f32; 2]| {
            let camera = Camera { clip, ..Camera::new("front", Vec3::ZERO, Vec3::NEG_Z, projection) };
            scene.cameras = vec![camera];
            on_cpu(&pack(scene, &scene.cameras[0], settings)).0
        };
        let light = |picture: &Picture| picture.pixels.clone();
        let same = |picture: Picture, want: f32| {
            let pixels = light(&picture);
            assert!(
                pixels.iter().all(|pixel| (pixel[1] - want).abs() < 1e-6),
                "{projection:?} {want}: {:?}",
                pixels[0]
            );
        };
        same(seen(&mut scene, Camera::ALL), 0.5);
        same(seen(&mut scene, [1.99, f32::INFINITY]), 0.5);
        same(seen(&mut scene, [2.01, f32::INFINITY]), 1.0);
        same(seen(&mut scene, [2.01, 3.99]), 0.25);
        same(seen(&mut scene, [2.01, 4.01]), 1.0);
        same(seen(&mut scene, [0.0, 1.99]), 0.25);
    }
}

/// Each eye's half is, bit for bit, the picture of a camera that stands there; of two that converge the middles see one place.
#[test]
fn each_eye_sees_what_a_camera_there_does() {
    let settings = Settings { size: (32, 24), ..whitted() };
    let mut scene = floor(Visibility::default(), 0.5);
    scene.lights = vec![sun(Vec3::new(0.3, -1.0, 0.2))];
    add_box(&mut scene, matt(Vec3::X), Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 1.0, 1.0));
    for (layout, size) in [(StereoLayout::SideBySide, (64, 24)), (StereoLayout::TopBottom, (32, 48))] {
        let stereo = Stereo { layout, distance: 0.5, convergence: None };
        let two = Camera { stereo: Some(stereo), ..above() };
        let aside = (two.target - two.eye).cross(two.up).normalize() * 0.25;
        let single = |side: f32| Camera { eye: two.eye + aside * side, target: two.target + aside * side, ..above() };
        scene.cameras = vec![two.clone(), single(-1.0), single(1.0)];
        let [both, left, right] = [0, 1, 2].map(|i| {
            let size = if i == 0 { size } else { settings.size };
            on_cpu(&pack(&scene, &scene.cameras[i], Settings { size, ..settings })).0
        });
        let (mut differing, mut pixels) = (0, 0);
        for (x, y) in (0..32).flat_map(|x| (0..24).map(move |y| (x, y))) {
            let other = if layout == StereoLayout::SideBySide { (x + 32, y) } else { (x, y + 24) };
            for (got, want) in [(both.pixel(x, y), left.pixel(x, y)), (both.pixel(other.0, other.1), right.pixel(x, y))]
            {
                let (got, want) = (got.unwrap(), want.unwrap());
                pixels += 1;
                differing += u32::from((0..3).any(|c| (got[c] - want[c]).abs() > 1e-3));
            }
        }
        assert!(differing * 100 < pixels, "{layout}: {differing} of {pixels}");
    }
}
