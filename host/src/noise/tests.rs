//! A device whose noise is known, pictures that are disturbed, and films of them.

use std::cell::{Cell, RefCell};
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use eyerays_shader::real::V3;
use eyerays_shader::stage::{BLOCK, FilmWords, NOISY_FILM_WORDS, PixelSums, Row};
use glam::Vec3;

use super::*;
use crate::cpu::{OnCpu, Renderer};
use crate::film::{Film, Part};
use crate::job::Job;
use crate::method::Traversal;
use crate::quality::Bvh;
use crate::scene::Settings;
use crate::scene_io;
use crate::view::View;
use crate::watch::{Grows, Watch};

/// Light with uniform noise: of each cell the mean and, as a share of it, the standard deviation of a sample.
struct Noisy {
    cells: Vec<(f64, f64)>,
    /// Cells beside each other.
    across: u32,
}

impl Noisy {
    fn sample(&self, x: u32, y: u32, sample: u32) -> f32 {
        let (mean, share) = self.cells[(y / 16 * self.across + x / 16) as usize];
        // Splitmix64.
        let mut z = (u64::from(x) << 48 | u64::from(y) << 32 | u64::from(sample)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        let drawn = ((z ^ z >> 31) >> 11) as f64 / 2f64.powi(53);
        (mean * (1.0 + share * 12f64.sqrt() * (drawn - 0.5))) as f32
    }

    /// The sums of a pixel, block by block.
    fn pixel(&self, x: u32, y: u32, samples: Range<u32>) -> PixelSums {
        let grey = |light: f32| PixelSums::of::<f32>(V3::splat(Vec3::splat(light)), 0);
        let mut sums = PixelSums::default();
        for first in samples.step_by(BLOCK as usize) {
            let block: Vec<f32> = (first..first + BLOCK).map(|sample| self.sample(x, y, sample)).collect();
            let mean = block.iter().sum::<f32>() / BLOCK as f32;
            let light = block.into_iter().map(|light| PixelSums { squares: Default::default(), ..grey(light) });
            sums = sums.plus(light.fold(PixelSums::default(), PixelSums::plus));
            sums.squares = sums.squares.plus(grey(mean).squares);
        }
        sums
    }
}

impl Grows for Noisy {
    fn turn(&mut self, _: &Job) -> Result<()> {
        Ok(())
    }

    fn start(&mut self, _: &View, _: &[Region]) -> Result<()> {
        Ok(())
    }

    fn add(&mut self, _: Part, _: &(dyn Fn(u64) + Sync)) -> Result<()> {
        Err(Error::NoGpu)
    }

    fn wait(&mut self) -> Result<()> {
        Ok(())
    }

    fn cells(&mut self, _: &View, cells: &[Region], samples: Range<u32>) -> Result<CellSums> {
        let film = |cell: &Region| {
            let mut sums = vec![0; cell.pixels() as usize * NOISY_FILM_WORDS as usize];
            for (x, y) in (0..cell.height).flat_map(|y| (0..cell.width).map(move |x| (x, y))) {
                let pixel = self.pixel(cell.x + x, cell.y + y, samples.clone());
                pixel.store(&mut sums, Row::new(y, cell.width, FilmWords::of_light(NOISY_FILM_WORDS)), x);
            }
            sums
        };
        Ok(CellSums { sums: cells.iter().map(film).collect(), secondary: 0 })
    }

    fn film(&mut self) -> Result<Film> {
        Err(Error::NoGpu)
    }
}

fn posed(size: (u32, u32), spp: u32) -> (Job, View) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/cornell_path.toml");
    let (scene, _) = scene_io::load(path.as_ref()).unwrap();
    let settings = Settings { size, spp, bounces: 2, ..scene.settings };
    let packed = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
    let view = View::new(&packed, &scene.cameras[0]).unwrap();
    (packed, view)
}

fn on_cpu(job: &Job, threads: usize) -> OnCpu<f32> {
    OnCpu::new(Arc::new(Renderer::new(job, Traversal::default(), threads).unwrap()))
}

fn undisturbed(device: &mut dyn Grows, view: &View, target: &Target) -> Film {
    let stop = AtomicBool::new(false);
    go_on(device, view, target, None, &Watch { limit: None, stop: &stop, grown: &|_| () }).unwrap()
}

/// The samples of the cells of a picture of light and noise.
fn counts(cells: &[(f64, f64)], target: &Target) -> (Vec<u32>, Film) {
    let across = cells.len() as u32;
    let (_, view) = posed((16 * across, 16), 4100);
    let film = undisturbed(&mut Noisy { cells: cells.to_vec(), across }, &view, target);
    (film.samples()[..16 * cells.len()].chunks(16).map(|cell| cell[0]).collect(), film)
}

/// A standard error of a share X needs the square of (deviation / X) samples, which the next decision has.
#[test]
fn a_cell_gets_as_many_samples_as_its_noise_asks_for() {
    let target = Target::new(0.02, 0.0, ToneMap::None).unwrap();
    let cells = [(0.5, 0.0), (0.5, 0.1), (0.5, 0.3), (0.25, 0.5), (0.8, 1.0), (0.5, 9.0)];
    let (counts, film) = counts(&cells, &target);
    assert_eq!((counts[0], counts[1], counts[5]), (64, 64, 4096));
    for (&count, &(_, share)) in counts.iter().zip(&cells).skip(2).take(3) {
        let needed = (share / 0.02).powi(2);
        assert!((0.97 * needed..1.3 * needed).contains(&f64::from(count)), "{share}: {count} of {needed}");
    }
    assert_eq!(film.cells_left(), 0);
    let picture = film.develop().unwrap();
    for (number, (mean, _)) in cells.into_iter().enumerate().take(5) {
        let error = |x: usize, y: usize| f64::from(picture.pixels[y * 96 + 16 * number + x][0]) / mean - 1.0;
        let squares: f64 = (0..256).map(|i| error(i % 16, i / 16).powi(2)).sum();
        let error = (squares / 256.0).sqrt();
        // Of 256 pixels it errs itself by 1 / sqrt(2 * 256), three times which is 13 %.
        assert!(error < 0.02 * 1.13, "cell {number}: {error}");
    }
}

#[test]
fn what_is_beyond_white_has_no_noise_and_what_is_dark_may_have_more() {
    let target = |exposure_ev| Target::new(0.02, exposure_ev, ToneMap::None).unwrap();
    // Nine times white, and as bright as a 500th of it: a fifth of the floor, so that a 25th of the samples do.
    let cells = [(9.0, 0.8), (0.01, 2.5)];
    assert_eq!(counts(&cells, &target(0.0)).0[0], 64);
    let dark = counts(&cells, &target(0.0)).0[1];
    let needed = (2.5f64 / 0.02 / 5.0).powi(2);
    assert!((0.95 * needed..1.3 * needed).contains(&f64::from(dark)), "{dark} of {needed}");
    let shown = counts(&[(9.0, 0.4)], &target(-4.0)).0[0];
    assert!((380..520).contains(&shown), "{shown} of 400");
}

/// Of a picture by the CPU: how often it is stopped, and which cells are rendered together.
#[test]
fn a_picture_that_is_stopped_and_gone_on_with_has_the_bits_of_one_that_never_was() {
    let (packed, view) = posed((40, 36), 200);
    let target = Target::new(0.1, 0.0, ToneMap::None).unwrap();
    let mut device = on_cpu(&packed, 2);
    let whole = undisturbed(&mut device, &view, &target);
    let counts = whole.samples();
    assert!(counts.contains(&64) && counts.iter().any(|&count| count > 64), "{counts:?}");
    let (mut film, stops, stop) = (None, Cell::new(0), AtomicBool::new(false));
    loop {
        let grown = |_: crate::watch::Growth<'_>| {
            stop.store(true, Ordering::Relaxed);
            stops.set(stops.get() + 1);
        };
        let done = go_on(&mut device, &view, &target, film.take(), &Watch { limit: None, stop: &stop, grown: &grown });
        let again = through_a_file(&done.unwrap());
        if again.cells_left() == 0 {
            assert_same(&again, &whole);
            break;
        }
        film = Some(again);
    }
    assert!(stops.get() > 1);
}

fn through_a_file(film: &Film) -> Film {
    let mut bytes = Vec::new();
    film.write(&mut bytes).unwrap();
    Film::read(&mut &bytes[..]).unwrap()
}

fn assert_same(film: &Film, want: &Film) {
    assert_eq!(film.samples(), want.samples());
    assert_eq!(film.rays(), want.rays());
    assert_eq!(film.errors(), want.errors());
    assert!(film.develop().unwrap().bits_equal(&want.develop().unwrap()));
}

#[test]
fn tiles_that_are_merged_are_the_picture_and_none_is_given_twice() {
    let (packed, view) = posed((40, 36), 100);
    let target = Target::new(0.1, 0.0, ToneMap::None).unwrap();
    let mut device = on_cpu(&packed, 1);
    let whole = undisturbed(&mut device, &view, &target);
    let tiles = [(16, 16, 24, 20), (0, 0, 16, 36), (16, 0, 24, 16)].map(|(x, y, width, height)| {
        let tile = Region { x, y, width, height };
        through_a_file(&undisturbed(&mut device, &view.part(tile, view.range()).unwrap(), &target))
    });
    let mut tiles = tiles.into_iter();
    let mut film = tiles.next().unwrap();
    assert_eq!((film.cells_left(), film.window().width), (0, 24));
    let first = film.clone();
    tiles.for_each(|tile| film.merge(tile).unwrap());
    assert_same(&film, &whole);
    let error = film.merge(first).unwrap_err().message();
    assert!(error.contains("the cell at 16,16"), "{error}");
    let plain = device.expose(&view, &|_| ()).unwrap();
    assert!(film.merge(plain).unwrap_err().message().contains("of different pictures"));
}

/// Programs before know the first version alone, and say so.
#[test]
fn a_film_of_cells_has_a_version_of_its_own_and_is_refused_where_it_is_damaged() {
    let target = Target::new(0.02, -1.5, ToneMap::Agx).unwrap();
    let (_, film) = counts(&[(0.5, 0.2), (0.5, 0.4)], &target);
    let mut bytes = Vec::new();
    film.write(&mut bytes).unwrap();
    assert_eq!(bytes[..8], *b"\x89EYFILM\x02");
    assert_same(&Film::read(&mut &bytes[..]).unwrap(), &film);
    for at in (0..bytes.len()).step_by(11) {
        assert!(Film::read(&mut &bytes[..at]).is_err(), "cut off at {at}");
        let mut other = bytes.clone();
        other[at] ^= 5;
        if let Ok(read) = Film::read(&mut &other[..]) {
            assert_same(&read, &film);
        }
    }
    bytes[7] = 1;
    assert!(Film::read(&mut &bytes[..]).is_err(), "squares of blocks are no squares of samples");
}

#[test]
fn cells_of_an_unfinished_film_are_left() {
    let (_, view) = posed((64, 16), 4096);
    let target = Target::new(0.02, 0.0, ToneMap::None).unwrap();
    let (stop, told) = (AtomicBool::new(true), RefCell::new(Vec::new()));
    let grown = |growth: crate::watch::Growth<'_>| told.borrow_mut().push((growth.samples, growth.of, growth.cells));
    let mut device = Noisy { cells: vec![(0.5, 1.0), (0.5, 0.0), (0.5, 0.0), (0.5, 1.0)], across: 4 };
    let film = go_on(&mut device, &view, &target, None, &Watch { limit: None, stop: &stop, grown: &grown }).unwrap();
    // Half of them first, and the other half while these decide.
    let wanted = vec![(32, 4096, Some((1, 4))), (64, 4096, Some((2, 4)))];
    assert_eq!((film.cells_left(), told.into_inner()), (2, wanted));
}

/// The last decision is about fewer samples than the next that all others have.
#[test]
fn more_samples_go_on_where_fewer_ended() {
    let target = Target::new(0.02, 0.0, ToneMap::None).unwrap();
    let stop = AtomicBool::new(false);
    let watch = Watch { limit: None, stop: &stop, grown: &|_| () };
    let mut device = Noisy { cells: vec![(0.5, 0.2), (0.5, 0.4)], across: 2 };
    let of = |spp| posed((32, 16), spp).1;
    let few = go_on(&mut device, &of(185), &target, None, &watch).unwrap();
    assert_eq!(few.samples()[..32].iter().step_by(16).collect::<Vec<_>>(), [&112, &176]);
    let more = go_on(&mut device, &of(4096), &target, Some(few), &watch).unwrap();
    assert_same(&more, &undisturbed(&mut device, &of(4096), &target));
    assert!(go_on(&mut device, &of(80), &target, Some(more.clone()), &watch).is_err(), "it has more");
    let other = Target::new(0.03, 0.0, ToneMap::None).unwrap();
    assert!(go_on(&mut device, &of(4096), &other, Some(more), &watch).is_err(), "it is of another noise");
}

#[test]
fn what_cells_can_not_decide_about_is_refused() {
    let (_, view) = posed((40, 36), 100);
    let target = Target::new(0.02, 0.0, ToneMap::None).unwrap();
    let refused = |view: View| Film::of_cells(&view, &target).unwrap_err().message();
    let tile = |x, width| view.part(Region { x, y: 16, width, height: 20 }, 0..100).unwrap();
    assert!(Film::of_cells(&tile(16, 24), &target).is_ok(), "its right edge is the image's");
    assert!(refused(tile(16, 23)).contains("whole cells") && refused(tile(8, 32)).contains("whole cells"));
    assert!(refused(view.part(view.region(), 16..100).unwrap()).contains("from the first on"));
    assert!(refused(view.part(view.region(), 0..63).unwrap()).contains("64 samples"));
    assert!(Target::new(0.0, 0.0, ToneMap::None).is_err() && Target::new(f64::NAN, 0.0, ToneMap::None).is_err());
}
