//! What cameras have beside pinholes, against closed forms.

use std::f64::consts::PI;

use eyerays::picture::Picture;
use eyerays::scene::{
    Background, Camera, Focus, Integrator, Lens, Mapping, Material, PixelFilter, Projection, Sampler, Scene, Settings,
    Sphere, Transport,
};
use eyerays_tests::model::{add_quad, add_wall, black, empty, glowing, matt};
use eyerays_tests::{assert_same_bits, on_cpu, pack, shipped};
use glam::Vec3;

/// Path tracing by Sobol's points without a bounce, each pixel by itself.
fn plain(size: (u32, u32), spp: u32) -> Settings {
    Settings {
        size,
        spp,
        sampler: Sampler::Sobol,
        bounces: 0,
        pixel_filter: Some(PixelFilter::Box),
        transport: Transport { integrator: Integrator::Path, ..Transport::default() },
        ..Settings::default()
    }
}

fn lamp(radiance: f32) -> Material {
    Material { emission: Vec3::splat(radiance), two_sided: true, ..black() }
}

fn render(scene: &mut Scene, camera: Camera, settings: Settings) -> Picture {
    scene.cameras = vec![camera];
    let (picture, rays) = on_cpu(&pack(scene, &scene.cameras[0], settings));
    assert_eq!(rays.non_finite, 0);
    picture
}

/// At the origin, looking along -z.
fn camera(projection: Projection, lens: Option<Lens>) -> Camera {
    Camera { lens, ..Camera::new("front", Vec3::ZERO, Vec3::NEG_Z, projection) }
}

/// The light of a picture as a distribution over its pixels: all of it, and the mean of squares of distances from the middle.
fn moments(picture: &Picture) -> (f64, f64) {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let (mut sum, mut squares) = (0.0, 0.0);
    for (i, pixel) in picture.pixels.iter().enumerate() {
        let at = |i: usize, size: usize| i as f64 + 0.5 - size as f64 / 2.0;
        let (x, y) = (at(i % width, width), at(i / width, height));
        sum += f64::from(pixel[1]);
        squares += f64::from(pixel[1]) * (x * x + y * y);
    }
    (sum, squares / sum)
}

/// A square lamp of this half edge at a distance, seen through a lens that is sharp at another: how many pixels a unit has in the
/// plane of focus, and the picture of 64 x 64 pixels.
fn out_of_focus(lens: Lens, half: f32, distance: f32, spp: u32) -> (f64, Picture) {
    let fov = 40.0f32;
    let Focus::Distance(focus) = lens.focus else { panic!("a distance") };
    let mut scene = empty();
    add_wall(&mut scene, lamp(1.0), Vec3::NEG_Z * distance, half);
    let picture = render(&mut scene, camera(Projection::Perspective { fov }, Some(lens)), plain((64, 64), spp));
    let height = 2.0 * f64::from(focus) * (f64::from(fov).to_radians() / 2.0).tan();
    (64.0 / height, picture)
}

/// A small light at distance d is, through a lens of radius a that is sharp at s, a disk of radius a |s - d| / d in the plane of focus,
/// with all the light that a pinhole shows of it.
#[test]
fn a_light_out_of_focus_is_a_disk() {
    for (focus, distance, radius) in [(4.0f32, 8.0f32, 1.6f32), (4.0, 2.5, 1.4), (6.0, 3.0, 1.1)] {
        let lens = Lens { focus: Focus::Distance(focus), ..Lens::round(radius) };
        let (scale, picture) = out_of_focus(lens, 0.1, distance, 1024);
        let in_focus = f64::from(focus / distance);
        let half = 0.1 * in_focus * scale;
        let (sum, squares) = moments(&picture);
        // The lamp's own extent, and that of pixels, along both axes.
        let own = 2.0 * half * half / 3.0 + 2.0 / 12.0;
        let found = (2.0 * (squares - own)).sqrt();
        let wanted = f64::from(radius) * (f64::from(focus) - f64::from(distance)).abs() / f64::from(distance) * scale;
        assert!(wanted > 8.0 && (found - wanted).abs() < 0.1, "{found} of {wanted} pixels");
        let (area, hits) = (4.0 * half * half, sum * 1024.0);
        println!("{found:.3} of {wanted:.3} pixels, {sum:.3} of {area:.3} light, {hits} hits");
        assert!((sum - area).abs() < 3.0 * area / hits.sqrt(), "{sum} of {area}, {hits} hits");
    }
}

#[test]
fn what_is_in_focus_is_as_sharp_as_through_a_pinhole() {
    let lens = Lens { focus: Focus::Distance(5.0), ..Lens::round(1.0) };
    let (scale, picture) = out_of_focus(lens, 1.0, 5.0, 256);
    let lit: Vec<f32> = picture.pixels.iter().map(|pixel| pixel[1]).collect();
    let whole = lit.iter().filter(|&&light| light == 1.0).count() as f64;
    let none = lit.iter().filter(|&&light| light == 0.0).count() as f64;
    let edge = 2.0 * scale;
    assert!(whole >= (edge - 2.0).powi(2) && none >= 64.0 * 64.0 - (edge + 2.0).powi(2), "{whole} {none} {edge}");
}

/// Five blades: a corner points up behind the plane of focus, and down before it, by the radius; the edge on the other side is nearer by
/// the cosine of 36 degrees.
#[test]
fn blades_are_the_shape_of_a_light_out_of_focus() {
    for (distance, flips) in [(9.0f32, false), (2.4, true)] {
        let lens = Lens { focus: Focus::Distance(4.0), blades: 5, ..Lens::round(1.5) };
        let (scale, picture) = out_of_focus(lens, 0.05, distance, 512);
        let radius = 1.5 * f64::from(4.0 - distance).abs() / f64::from(distance) * scale;
        let rows = (0..64).filter(|&y| (0..64).any(|x| picture.pixel(x, y).unwrap()[1] > 0.0));
        let (top, bottom) = (rows.clone().min().unwrap(), rows.max().unwrap());
        let (above, below) = (32.0 - f64::from(top), f64::from(bottom) + 1.0 - 32.0);
        let (above, below) = if flips { (below, above) } else { (above, below) };
        let edge = radius * (PI / 5.0).cos();
        // The lamp's own extent, and a pixel.
        let more = 0.05 * f64::from(4.0 / distance) * scale + 1.0;
        assert!(radius > 10.0 && above > radius - 1.5 && above < radius + more, "{above} of {radius}");
        assert!(below > edge - 0.5 && below < edge + more, "{below} of {edge}");
    }
}

/// By an anamorphic ratio of 2 it is half as wide as high.
#[test]
fn an_anamorphic_lens_makes_ovals() {
    let lens = Lens { focus: Focus::Distance(4.0), ratio: 2.0, ..Lens::round(1.5) };
    let (_, picture) = out_of_focus(lens, 0.05, 9.0, 512);
    let extent =
        |of: &dyn Fn(u32, u32) -> [f32; 3]| (0..64).filter(|&a| (0..64).any(|b| of(a, b)[1] > 0.0)).count() as f64;
    let wide = extent(&|x, y| picture.pixel(x, y).unwrap());
    let high = extent(&|y, x| picture.pixel(x, y).unwrap());
    assert!((high / wide - 2.0).abs() < 0.2, "{wide} x {high}");
}

/// What sends on all light is as bright as the white around it, in focus or not.
#[test]
fn white_surroundings_are_white_through_a_lens() {
    let mut scene = empty();
    scene.background = Background::Colour(Vec3::ONE);
    scene.materials.push(matt(Vec3::ONE));
    scene.spheres.push(Sphere { center: Vec3::NEG_Z * 3.0, radius: 1.0, material: 0 });
    let lens = Lens { focus: Focus::Distance(9.0), blades: 6, roundness: 0.3, ..Lens::round(0.8) };
    let settings = Settings { bounces: 1, ..plain((24, 24), 64) };
    let picture = render(&mut scene, camera(Projection::Perspective { fov: 50.0 }, Some(lens)), settings);
    assert!(picture.pixels.iter().flatten().all(|&light| (light - 1.0).abs() < 1e-6));
}

/// Also where another camera of the scene has a lens, for which kernels are compiled.
#[test]
fn a_lens_without_an_aperture_is_a_pinhole_in_every_bit() {
    for name in ["glass", "cornell_path"] {
        let mut scene = shipped(name);
        let pinhole = scene.cameras[0].clone();
        let settings = Settings { size: (24, 18), spp: 4, sampler: Sampler::Sobol, ..scene.settings };
        let plain = on_cpu(&pack(&scene, &pinhole, settings)).0;
        let closed = Camera { lens: Some(Lens::round(0.0)), ..pinhole.clone() };
        let open = Camera { lens: Some(Lens::round(0.3)), name: "open".into(), ..pinhole };
        scene.cameras = vec![closed, open];
        let seen = |number: usize| on_cpu(&pack(&scene, &scene.cameras[number], settings)).0;
        // In a scene that samples no light, no filter moves what the other has.
        assert_same_bits(&seen(0), &plain, name);
        assert!(!seen(1).bits_equal(&plain), "{name}");
    }
}

/// A sphere that covers so many degrees around a direction is of a known solid angle, which pixels sum up to.
#[test]
fn images_of_all_around_hold_the_whole_solid_angle() {
    let half = 20f64.to_radians();
    let solid_angle = 2.0 * PI * (1.0 - half.cos());
    for direction in [Vec3::NEG_Z, Vec3::new(0.4, 0.8, -0.3), Vec3::new(0.5, -0.6, 0.9)] {
        let mut scene = empty();
        scene.materials.push(lamp(1.0));
        let center = direction.normalize() * 10.0;
        scene.spheres.push(Sphere { center, radius: (10.0 * half.sin()) as f32, material: 0 });
        let picture = render(&mut scene, camera(Projection::Equirectangular, None), plain((128, 64), 16));
        let mut sum = 0.0;
        for (y, row) in picture.pixels.chunks(128).enumerate() {
            let latitude = |edge: usize| (0.5 - edge as f64 / 64.0) * PI;
            let area = (latitude(y).sin() - latitude(y + 1).sin()) * 2.0 * PI / 128.0;
            sum += row.iter().map(|pixel| f64::from(pixel[1]) * area).sum::<f64>();
        }
        assert!((sum / solid_angle - 1.0).abs() < 5e-3, "{direction}: {sum} of {solid_angle}");
        if direction.z < 0.0 {
            let mapping = Mapping::Equisolid;
            let picture =
                render(&mut scene, camera(Projection::Fisheye { fov: 240.0, mapping }, None), plain((100, 100), 16));
            // 50 pixels are twice the focal length times the sine of 60 degrees.
            let focal_length = 50.0 / 2.0 / (PI / 3.0).sin();
            let (sum, _) = moments(&picture);
            assert!((sum / focal_length.powi(2) / solid_angle - 1.0).abs() < 1e-2, "{direction}: {sum}");
        }
    }
}

#[test]
fn an_equidistant_fisheye_shows_angles_as_lengths_and_nothing_beyond_its_circle() {
    let mut scene = empty();
    scene.materials.push(lamp(1.0));
    let half = 30f64.to_radians();
    scene.spheres.push(Sphere { center: Vec3::NEG_Z * 10.0, radius: (10.0 * half.sin()) as f32, material: 0 });
    let projection = Projection::Fisheye { fov: 240.0, mapping: Mapping::Equidistant };
    let picture = render(&mut scene, camera(projection, None), plain((120, 80), 64));
    let (sum, _) = moments(&picture);
    let radius = 40.0 * 30.0 / 120.0;
    assert!(((sum / PI).sqrt() - radius).abs() < 0.05, "{} of {radius}", (sum / PI).sqrt());
    scene.background = Background::Colour(Vec3::ONE);
    let picture = render(&mut scene, camera(projection, None), plain((120, 80), 64));
    assert!(((moments(&picture).0 / PI).sqrt() - 40.0).abs() < 0.05, "the circle is the image's shorter side");
}

/// An edge in the middle of a pixel covers half of it, in associated light.
#[test]
fn alpha_is_how_much_of_a_pixel_is_covered() {
    for (integrator, samples) in [(Integrator::Whitted, 8), (Integrator::Path, 1)] {
        let mut scene = empty();
        let material = if integrator == Integrator::Whitted { glowing(Vec3::splat(0.8)) } else { lamp(0.8) };
        let corner = |x: f32, y: f32| Vec3::new(x, y, -2.0);
        add_quad(&mut scene, material, [corner(-4.0, -4.0), corner(0.5, -4.0), corner(0.5, 4.0), corner(-4.0, 4.0)]);
        scene.ambient = Vec3::ONE;
        scene.background = Background::Colour(Vec3::new(0.1, 0.5, 0.9));
        let of_whitted = Settings { size: (4, 4), samples, ..Settings::default() };
        let settings = if integrator == Integrator::Whitted { of_whitted } else { plain((4, 4), 64) };
        let settings = Settings { transparent: true, ..settings };
        let picture = render(&mut scene, camera(Projection::Orthographic { height: 4.0 }, None), settings);
        let alpha = picture.alpha.as_deref().expect("it is asked for");
        for (row, pixels) in alpha.chunks(4).zip(picture.pixels.chunks(4)) {
            assert_eq!(row, [1.0, 1.0, 0.5, 0.0], "{integrator:?}");
            let light: Vec<f32> = pixels.iter().map(|pixel| pixel[2]).collect();
            let is_near = |(got, alpha): (&f32, &f32)| (got - 0.8 * alpha).abs() < 1e-6;
            assert!(light.iter().zip(row).all(is_near), "{integrator:?}: {light:?}");
        }
    }
}

/// Where half of the image shines, a pixel shows the share of its filter's weight on that side of it.
#[test]
fn an_edge_shows_the_filters_shares() {
    for filter in [PixelFilter::Box, PixelFilter::Tent, PixelFilter::Gaussian, PixelFilter::BlackmanHarris] {
        let mut scene = empty();
        let corner = |x: f32, y: f32| Vec3::new(x, y, -2.0);
        // The edge is a quarter of a pixel right of the image's middle.
        add_quad(&mut scene, lamp(1.0), [corner(-9.0, -9.0), corner(0.25, -9.0), corner(0.25, 9.0), corner(-9.0, 9.0)]);
        let settings = Settings { pixel_filter: Some(filter), ..plain((8, 8), 4096) };
        let picture = render(&mut scene, camera(Projection::Orthographic { height: 8.0 }, None), settings);
        let steps = 20_000;
        let weight = |from: f64, to: f64| {
            let width = (to - from) / f64::from(steps);
            (0..steps).map(|i| filter.weight(from + (f64::from(i) + 0.5) * width) * width).sum::<f64>()
        };
        for x in 0..8 {
            let middle = f64::from(x) + 0.5 - 4.0;
            let share = weight(-2.0, (0.25 - middle).clamp(-2.0, 2.0)) / weight(-2.0, 2.0);
            let got = f64::from(picture.pixel(x, 3).unwrap()[1]);
            assert!((got - share).abs() < 2e-3, "{filter}, column {x}: {got} of {share}");
        }
    }
}
