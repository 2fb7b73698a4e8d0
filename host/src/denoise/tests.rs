use super::*;

/// A plain surface of one colour, and noise of a known deviation, by a generator of its own.
struct Plain {
    picture: Picture,
    albedo: Picture,
    normal: Picture,
    depth: Vec<f32>,
    error: Vec<f32>,
}

impl Plain {
    fn new((width, height): (u32, u32), deviation: f32, light: impl Fn(u32, u32) -> f32) -> Plain {
        let mut state = 0x9e37_79b9u32;
        // Twelve even numbers have a deviation of 1 and look like Gauss' curve.
        let mut drawn = || {
            let one = |state: &mut u32| {
                *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (*state >> 8) as f32 / (1 << 24) as f32
            };
            (0..12).map(|_| one(&mut state)).sum::<f32>() - 6.0
        };
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let pixels = places.map(|(x, y)| [light(x, y) + deviation * drawn(); 3]).collect();
        let of = |pixel| Picture::from_pixels(width, height, vec![pixel; (width * height) as usize]).unwrap();
        let count = (width * height) as usize;
        Plain {
            picture: Picture::from_pixels(width, height, pixels).unwrap(),
            albedo: of([0.5; 3]),
            normal: of([0.0, 0.0, 1.0]),
            depth: vec![3.0; count],
            error: vec![deviation; count],
        }
    }

    fn denoised(&self) -> Picture {
        denoise(&self.picture, &self.guides()).unwrap()
    }

    fn guides(&self) -> Guides<'_> {
        let Plain { albedo, normal, depth, error, .. } = self;
        Guides { albedo, normal, depth, error, opacity_error: None }
    }
}

/// The root mean square of what pixels of some columns are off.
fn off(picture: &Picture, columns: std::ops::Range<usize>, light: impl Fn(usize) -> f32) -> f64 {
    let rows = picture.pixels.chunks(picture.width as usize);
    let squares =
        rows.flat_map(|row| columns.clone().map(|x| f64::from(row[x][1] - light(x)).powi(2)).collect::<Vec<_>>());
    let squares: Vec<f64> = squares.collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// The mean of 225 pixels that have nothing but noise has a fifteenth of it; what differs by more than most is left out.
#[test]
fn noise_on_a_plain_surface_falls_by_what_averaging_gives() {
    let plain = Plain::new((64, 48), 0.1, |_, _| 1.0);
    let (before, after) = (off(&plain.picture, 0..64, |_| 1.0), off(&plain.denoised(), 0..64, |_| 1.0));
    println!("{before:.4} became {after:.4}");
    assert!((before - 0.1).abs() < 0.01 && after < before / 4.0 && after > before / 15.0, "{before} became {after}");
}

#[test]
fn pixels_without_noise_keep_their_bits() {
    let mut plain = Plain::new((40, 30), 0.1, |x, y| (x * y) as f32 / 100.0);
    // The right half shows nothing, and that without noise.
    plain.error.chunks_mut(40).for_each(|row| row[20..].fill(0.0));
    plain.depth.chunks_mut(40).for_each(|row| row[20..].fill(f32::INFINITY));
    let denoised = plain.denoised();
    let rows = plain.picture.pixels.chunks(40).zip(denoised.pixels.chunks(40));
    assert!(rows.into_iter().all(|(before, after)| before[20..] == after[20..] && before[..20] != after[..20]));
}

/// Pixels all of whose samples were dark tell no noise, but those around them do.
#[test]
fn dark_pixels_on_a_noisy_surface_are_no_exception() {
    let mut plain = Plain::new((32, 32), 0.2, |_, _| 1.0);
    for at in [100, 333, 700] {
        (plain.picture.pixels[at], plain.error[at]) = ([0.6; 3], 0.0);
    }
    let denoised = plain.denoised();
    assert!([100, 333, 700].into_iter().all(|at| denoised.pixels[at][0] > 0.75), "{:?}", denoised.pixels[100]);
}

/// What samples tell is up to four times too much, where they are placed evenly: light that differs by less than that is no noise.
#[test]
fn noise_that_is_overstated_blurs_no_more_than_there_is() {
    let light = |x: usize| 1.0 + 0.1 * ((x as f32) * 0.7).sin();
    let mut plain = Plain::new((48, 48), 0.005, |x, _| light(x as usize));
    plain.error.fill(0.1);
    let blurred = off(&plain.denoised(), 8..40, light);
    assert!(blurred < 0.03, "{blurred}");
}

/// Edges that the light, the colour, the normal or the depth of a surface has, ten standard errors high.
#[test]
fn edges_stay() {
    type Edge = fn(&mut Plain);
    let edges: [Edge; 4] = [
        |_| (),
        |plain| plain.albedo.pixels.chunks_mut(32).for_each(|row| row[16..].fill([0.8; 3])),
        |plain| plain.normal.pixels.chunks_mut(32).for_each(|row| row[16..].fill([1.0, 0.0, 0.0])),
        |plain| plain.depth.chunks_mut(32).for_each(|row| row[16..].fill(f32::INFINITY)),
    ];
    for (number, edge) in edges.into_iter().enumerate() {
        // Of light alone it is high, with another surface low: the guides tell it.
        let step = if number == 0 { 1.0 } else { 0.15 };
        let light = |x: usize| if x < 16 { 1.0 } else { 1.0 + step };
        let mut plain = Plain::new((32, 32), 0.1, |x, _| light(x as usize));
        edge(&mut plain);
        let denoised = plain.denoised();
        let columns = [off(&denoised, 13..16, light), off(&denoised, 16..19, light)];
        assert!(columns.iter().all(|&off| off < 0.05), "{number}: {columns:?}");
    }
}

#[test]
fn any_size_and_any_light_give_numbers() {
    for size in [(1, 1), (1, 9), (9, 1), (2, 17)] {
        for light in [0.0, 1e-30, 1e30] {
            let mut plain = Plain::new(size, 0.0, |_, _| light);
            plain.error.fill(light);
            plain.albedo.pixels.iter_mut().step_by(2).for_each(|albedo| *albedo = [0.0, 1e-9, 1.0]);
            plain.depth.iter_mut().step_by(3).for_each(|depth| *depth = f32::INFINITY);
            let denoised = plain.denoised();
            let is_near = |value: &f32| (value - light).abs() <= light * 1e-5;
            assert!(denoised.pixels.iter().flatten().all(is_near), "{size:?} {light}: {:?}", denoised.pixels);
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let plain = Plain::new((37, 53), 0.2, |x, _| x as f32 / 10.0);
    let with =
        |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| plain.denoised());
    assert!(with(1).bits_equal(&with(3)));
}

#[test]
fn guides_of_other_pictures_and_single_samples_are_refused() {
    let mut plain = Plain::new((4, 4), 0.1, |_, _| 1.0);
    let refusal = |plain: &Plain| denoise(&plain.picture, &plain.guides()).unwrap_err().message();
    plain.error[7] = f32::INFINITY;
    assert!(refusal(&plain).contains("render two or more"));
    plain.depth.pop();
    assert!(refusal(&plain).contains("other pixels than the picture"));
}

/// A black surface mirrors white light, and its colour differs by less than it is seen: no channel stands out.
#[test]
fn light_that_dark_surfaces_mirror_stays_white() {
    let mut plain = Plain::new((32, 32), 0.05, |_, _| 0.5);
    let dark =
        |i: usize| [0.016 + 0.002 * (i % 5) as f32, 0.015 + 0.003 * (i % 4) as f32, 0.017 + 0.002 * (i % 3) as f32];
    plain.albedo.pixels.iter_mut().enumerate().for_each(|(i, albedo)| *albedo = dark(i));
    let denoised = plain.denoised();
    let apart = denoised.pixels.iter().map(|[r, g, b]| (r - g).abs().max((g - b).abs()));
    assert!(apart.fold(0.0, f32::max) < 1e-5);
    assert!(off(&denoised, 0..32, |_| 0.5) < 0.02);
}

/// A shadow that half of the light is kept away in, and none beside it: each sample tells all or nothing.
#[test]
fn shadows_that_are_caught_have_less_noise_and_keep_their_edge() {
    const SAMPLES: f32 = 64.0;
    let shadow = |x: usize| if x < 24 { 0.5 } else { 0.0 };
    let mut plain = Plain::new((48, 40), 0.5 / SAMPLES.sqrt(), |x, _| shadow(x as usize));
    let alpha: Vec<f32> =
        plain.picture.pixels.iter().enumerate().map(|(i, p)| if i % 48 < 24 { p[0] } else { 0.0 }).collect();
    let errors: Vec<f32> = alpha.iter().map(|a| (2.0 * a * (1.0 - a) / SAMPLES).max(0.0).sqrt()).collect();
    plain.picture.pixels.fill([0.0; 3]);
    plain.picture.alpha = Some(alpha.clone());
    let denoised = denoise(&plain.picture, &Guides { opacity_error: Some(&errors), ..plain.guides() }).unwrap();
    let off = |alpha: &[f32], columns: std::ops::Range<usize>| {
        let squares =
            alpha.chunks(48).flat_map(|row| columns.clone().map(|x| (row[x] - shadow(x)).powi(2)).collect::<Vec<_>>());
        let squares: Vec<f32> = squares.collect();
        (squares.iter().sum::<f32>() / squares.len() as f32).sqrt()
    };
    let after = denoised.alpha.unwrap();
    let (before, inside, beside) = (off(&alpha, 2..20), off(&after, 2..20), off(&after, 28..48));
    assert!((before - 0.0625).abs() < 0.01 && inside < before / 3.0 && beside < 1e-3, "{before} {inside} {beside}");
    let edge = off(&after, 20..28);
    assert!(edge < before, "{edge}");
    assert!(denoised.pixels == plain.picture.pixels);
    // Unless somebody tells how noisy they are, they stay as they are.
    assert_eq!(denoise(&plain.picture, &plain.guides()).unwrap().alpha, Some(alpha));
}
