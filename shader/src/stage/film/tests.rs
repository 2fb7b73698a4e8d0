use super::*;
use crate::camera;
use crate::data::Order;
use crate::stage::NON_FINITE;
use glam::Vec3;

const SIZE: (u32, u32) = (9, 5);
const PIXELS: usize = 45;
const PLAIN: FilmWords = FilmWords { light: FILM_WORDS, aovs: 0 };
const NOISY: FilmWords = FilmWords { light: NOISY_FILM_WORDS, aovs: 0 };

/// `batch` samples in flight of a region of 9x5 pixels.
fn frame(batch: u32, sample: u32, anew: bool) -> Frame {
    let pixel_slots = camera::slots(SIZE.0, SIZE.1, Order(0));
    Frame {
        columns: SIZE.0,
        rows: SIZE.1,
        across: camera::across(SIZE.0, Order(0)),
        pixel_slots,
        slots: batch * pixel_slots,
        sample,
        anew: anew.into(),
        ..Frame::default()
    }
}

fn exposed(frame: &Frame, words: FilmWords, film: &mut [u32], sample: impl Fn(u32) -> (f32, u32)) {
    for slot in 0..frame.pixel_slots {
        let pixel = camera::pixel(frame, Order(0), slot);
        let sample = |slot| {
            let (light, word) = sample(slot);
            Sample::of((V3::splat(Vec3::new(light, -light, 2.0 * light)), word))
        };
        expose::<f32>(frame, (pixel, slot), words, sample, film);
    }
}

fn pixels(film: &[u32], words: FilmWords) -> Vec<PixelSums> {
    let place = |i: u32| (Row::new(i / SIZE.0, SIZE.0, words), i % SIZE.0);
    (0..PIXELS as u32).map(place).map(|(row, x)| PixelSums::load(film, row, x)).collect()
}

/// What a film keeps: not the last words of channels.
fn kept(sums: PixelSums) -> PixelSums {
    let channel = |q: Quanta| Quanta(q.0, q.1, q.2, 0);
    PixelSums { red: channel(sums.red), green: channel(sums.green), blue: channel(sums.blue), ..sums }
}

/// Numbers whose sum in single precision depends on their order.
const VALUES: [f32; 5] = [1e8, 1.0, -1e8, 0.5, 3e-9];

#[test]
fn samples_have_the_same_sum_in_any_order_and_any_launches() {
    let sample = |value: f32| PixelSums::of::<f32>(V3::new(value, -value, 2.0 * value), 2);
    let want = kept(VALUES.map(sample).into_iter().reduce(PixelSums::plus).unwrap());
    let exact = (1.5 * 2f64.powi(40)) as u64 + (3e-9f32 as f64 * 2f64.powi(40)).round() as u64;
    assert_eq!((want.red, want.word), (Quanta(exact as u32, (exact >> 32) as u32, 0, 0), 10));
    for batches in [&[5][..], &[1, 1, 1, 1, 1], &[2, 3], &[4, 1]] {
        for turned in 0..5 {
            let mut film = vec![9; NOISY_FILM_WORDS as usize * PIXELS];
            let mut first = 7;
            for &batch in batches {
                let frame = frame(batch, first, first == 7);
                let value = |slot| VALUES[(first - 7 + slot / frame.pixel_slots + turned) as usize % 5];
                exposed(&frame, NOISY, &mut film, |slot| (value(slot), 2));
                first += batch;
            }
            assert!(pixels(&film, NOISY).iter().all(|&pixel| pixel == want), "{batches:?} {turned}");
        }
    }
}

#[test]
fn every_pixel_has_its_own_slots_and_those_outside_have_none() {
    let frame = frame(2, 0, true);
    for words in [PLAIN, NOISY] {
        let mut film = vec![0; words.light as usize * PIXELS];
        exposed(&frame, words, &mut film, |slot| (slot as f32, 1));
        let found = pixels(&film, words);
        for slot in 0..frame.pixel_slots {
            let pixel = camera::pixel(&frame, Order(0), slot);
            if pixel.inside {
                let light = Quanta::of((2 * slot + frame.pixel_slots) as f32, LIGHT_FRACTION, LIGHT_MOST);
                let PixelSums { red, word, squares, .. } = found[pixel.index as usize];
                assert_eq!((red, word), (light, 2));
                assert_eq!(squares == Quanta::default(), words == PLAIN, "{slot}");
            }
        }
    }
}

#[test]
fn what_was_left_out_is_remembered_and_counts_still_add_up() {
    let frame = frame(3, 0, true);
    let words = [3 | NON_FINITE, 4 | NON_FINITE, 5];
    let mut film = vec![0; FILM_WORDS as usize * PIXELS];
    exposed(&frame, PLAIN, &mut film, |slot| (1.0, words[(slot / frame.pixel_slots) as usize]));
    assert!(pixels(&film, PLAIN).iter().all(|pixel| pixel.word == 12 | NON_FINITE));
}

#[test]
fn clear_samples_are_counted_beside_shadow_rays() {
    let launch = Launch(Launch::CLEAR);
    for (is_noisy, first) in [(false, 0), (true, 0), (false, 1), (true, 2)] {
        let (words, frame) = (FilmWords::of_light(film_words(launch, is_noisy)), frame(3, 0, true));
        let told = [3 | CLEARED, 4, CLEARED | NON_FINITE];
        let mut film = vec![5; words.light as usize * PIXELS];
        exposed(&frame, words, &mut film, |slot| (1.0, told[((slot / frame.pixel_slots) + first) as usize % 3]));
        let right = |p: &PixelSums| (p.clear, p.word) == (2, 7 | NON_FINITE);
        assert!(pixels(&film, words).iter().all(right), "{is_noisy} {first}");
    }
    assert_eq!([false, true].map(|is_noisy| film_words(Launch(0), is_noisy)), [FILM_WORDS, NOISY_FILM_WORDS]);
}

/// Of three blocks, whose samples are small whole numbers: their light is that of samples one by one, and the squares are those of
/// the blocks' means, in any launches of whole blocks.
#[test]
fn blocks_keep_the_squares_of_their_means() {
    let value = |sample: u32| ((sample * 7) % 24) as f32;
    let mean = |block: u32| (0..BLOCK).map(|i| f64::from(value(block * BLOCK + i))).sum::<f64>() / f64::from(BLOCK);
    // Of red, green and blue as in `exposed`, the brightness is two thirds of the value.
    let wanted: f64 = (0..3).map(|block| (mean(block) * 2.0 / 3.0).powi(2)).sum();
    let mut films = Vec::new();
    for batches in [&[3][..], &[1, 2], &[1, 1, 1]] {
        let (mut film, mut first) = (vec![7; NOISY_FILM_WORDS as usize * PIXELS], 0);
        for &blocks in batches {
            let frame = frame(blocks * BLOCK, first, first == 0);
            for slot in 0..frame.pixel_slots {
                let pixel = camera::pixel(&frame, Order(0), slot);
                let sample = |slot: u32| {
                    let light = value(first + slot / frame.pixel_slots);
                    Sample::of((V3::<f32>::splat(Vec3::new(light, -light, 2.0 * light)), 1))
                };
                expose_blocks::<f32>(&frame, (pixel, slot), NOISY, sample, &mut film);
            }
            first += blocks * BLOCK;
        }
        films.push(film);
    }
    assert!(films[1..].iter().all(|film| *film == films[0]));
    let mut samples = vec![0; NOISY_FILM_WORDS as usize * PIXELS];
    let all = frame(3 * BLOCK, 0, true);
    exposed(&all, NOISY, &mut samples, |slot| (value(slot / all.pixel_slots), 1));
    for (own, single) in pixels(&films[0], NOISY).into_iter().zip(pixels(&samples, NOISY)) {
        assert_eq!((own.red, own.green, own.blue, own.word), (single.red, single.green, single.blue, single.word));
        let squares = (f64::from(own.squares.1) * 2f64.powi(32) + f64::from(own.squares.0)) / 2f64.powi(42);
        assert!((squares / wanted - 1.0).abs() < 1e-6 && own.squares.2 == 0, "{squares} {wanted}");
    }
}

/// As many samples as there may be, of the most light.
#[test]
fn the_most_light_of_the_most_samples_fits() {
    let mut sums = PixelSums::of::<f32>(V3::new(f32::MAX, f32::MIN, 0.0), 0);
    (0..24).for_each(|_| sums = sums.plus(sums));
    let signed = |q: Quanta| (i128::from(q.2 as i32) << 64) + (i128::from(q.1) << 32) + i128::from(q.0);
    let most = ((1i128 << 24) - 1) << (LIGHT_MOST + LIGHT_FRACTION);
    assert_eq!((signed(sums.red), signed(sums.green)), (most, -most));
}
