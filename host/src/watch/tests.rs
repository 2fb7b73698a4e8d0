use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use eyerays_shader::stage::FilmWords;

use super::*;
use crate::cpu::{OnCpu, Renderer};
use crate::error::Error;
use crate::film::Part;
use crate::job::Job;
use crate::method::Traversal;
use crate::noise::CellSums;
use crate::quality::Bvh;
use crate::scene::Settings;
use crate::scene_io;
use crate::view::{Region, View};

/// A device whose samples take so long each, and the batches that were added.
struct Slow {
    each: Duration,
    batches: Vec<u32>,
    fails: bool,
    view: Option<View>,
}

impl Grows for Slow {
    fn turn(&mut self, _: &Job) -> Result<()> {
        Ok(())
    }

    fn start(&mut self, view: &View, _: &[Region]) -> Result<()> {
        self.view = Some(*view);
        Ok(())
    }

    fn add(&mut self, part: Part, _: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let count = part.samples.len() as u32;
        self.batches.push(count);
        std::thread::sleep(self.each * count);
        if self.fails { Err(Error::NoGpu) } else { Ok(()) }
    }

    fn wait(&mut self) -> Result<()> {
        Ok(())
    }

    fn cells(&mut self, _: &View, _: &[Region], _: Range<u32>) -> Result<CellSums> {
        Err(Error::NoGpu)
    }

    fn film(&mut self) -> Result<Film> {
        Ok(Film::new(self.view.as_ref().unwrap(), FilmWords::of_light(10)))
    }
}

fn slow(each: Duration) -> Slow {
    Slow { each, batches: Vec::new(), fails: false, view: None }
}

fn cornell(spp: u32) -> (Job, View) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/cornell_path.toml");
    let (scene, _) = scene_io::load(path.as_ref()).unwrap();
    let settings = Settings { size: (16, 12), spp, bounces: 1, ..scene.settings };
    let packed = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
    let view = View::new(&packed, &scene.cameras[0]).unwrap();
    (packed, view)
}

/// The batches of a rendering with a limit, in milliseconds.
fn filled(limit: Option<u64>, each: Duration, most: u32) -> Vec<u32> {
    let mut device = slow(each);
    let (stop, limit) = (AtomicBool::new(false), limit.map(Duration::from_millis));
    go_on(&mut device, &cornell(most).1, None, &Watch { limit, stop: &stop, grown: &|_| () }).unwrap();
    device.batches
}

#[test]
fn there_is_at_least_one_and_never_too_many() {
    assert_eq!(filled(Some(0), Duration::from_millis(1), 9), [1]);
    assert_eq!(filled(Some(10_000), Duration::ZERO, 9).iter().sum::<u32>(), 9);
    assert_eq!(filled(Some(10_000), Duration::ZERO, 1), [1]);
    assert_eq!(filled(None, Duration::ZERO, 100), [1, 4, 16, 64, 15]);
}

#[test]
fn batches_fit_the_limit_and_none_is_empty() {
    let batches = filled(Some(60), Duration::from_millis(2), 1 << 24);
    assert!(batches.iter().all(|&batch| batch > 0) && batches.iter().sum::<u32>() <= 31, "{batches:?}");
}

/// Three samples take more than a step.
#[test]
fn batches_are_short_enough_to_stop() {
    assert_eq!(filled(None, Duration::from_millis(400), 4), [1, 2, 1]);
}

#[test]
fn whoever_looks_on_sees_the_samples_and_can_end_it() {
    let (packed, view) = cornell(100);
    let (stop, seen) = (AtomicBool::new(false), RefCell::new(Vec::new()));
    let grown = |growth: Growth<'_>| {
        let (samples, of) = (growth.samples, growth.of);
        stop.store(samples >= 5, Ordering::Relaxed);
        seen.borrow_mut().push((samples, of, growth.film().unwrap().coverage().parts().to_vec()));
    };
    let renderer = Arc::new(Renderer::new(&packed, Traversal::default(), 1).unwrap());
    let watch = Watch { limit: None, stop: &stop, grown: &grown };
    let film = go_on(&mut OnCpu::<f32>::new(renderer.clone()), &view, None, &watch).unwrap();
    let part = |end| vec![Part { region: view.region(), samples: 0..end }];
    assert_eq!(*seen.borrow(), [(1, 100, part(1)), (5, 100, part(5))]);
    assert_eq!(film.coverage().parts(), part(5));
}

/// A film with a tile and some samples of the rest, in the middle of those that are asked for.
#[test]
fn what_is_gone_on_with_has_the_bits_of_all_at_once() {
    let (packed, view) = cornell(9);
    let renderer = Arc::new(Renderer::new(&packed, Traversal::default(), 1).unwrap());
    let mut device = OnCpu::<f32>::new(renderer.clone());
    let whole = device.expose(&view, &|_| ()).unwrap();
    let part = |region, samples| view.part(region, samples).unwrap();
    let tile = Region { x: 3, y: 2, width: 5, height: 7 };
    let mut from = device.expose(&part(tile, 0..4), &|_| ()).unwrap();
    from.merge(device.expose(&part(view.region(), 5..7), &|_| ()).unwrap()).unwrap();
    let (stop, seen) = (AtomicBool::new(false), RefCell::new(Vec::new()));
    let grown = |growth: Growth<'_>| seen.borrow_mut().push((growth.samples, growth.of));
    let film = go_on(&mut device, &view, Some(from), &Watch { limit: None, stop: &stop, grown: &grown }).unwrap();
    assert!(film.develop().unwrap().bits_equal(&whole.develop().unwrap()) && film.rays() == whole.rays());
    assert_eq!(film.coverage().parts(), [view.whole()]);
    assert_eq!(seen.borrow().last(), Some(&(9, 9)));
    assert!(seen.borrow().is_sorted());
    let again =
        go_on(&mut slow(Duration::ZERO), &view, Some(film), &Watch { limit: None, stop: &stop, grown: &|_| () });
    assert!(again.unwrap().develop().unwrap().bits_equal(&whole.develop().unwrap()));
}

#[test]
fn a_film_that_is_looked_at_is_kept() {
    let (packed, view) = cornell(9);
    let (stop, kept) = (AtomicBool::new(false), RefCell::new(Vec::new()));
    // Whoever looks on looks once.
    let grown = |growth: Growth<'_>| {
        if growth.samples == 5 {
            growth.film().unwrap();
        }
    };
    let watch = Watch { limit: None, stop: &stop, grown: &grown };
    let keep = |film: &Film| kept.borrow_mut().push(film.coverage().volume() / view.region().pixels());
    let grown = keeping(&watch, &keep);
    let renderer = Arc::new(Renderer::new(&packed, Traversal::default(), 1).unwrap());
    go_on(&mut OnCpu::<f32>::new(renderer), &view, None, &Watch { grown: &grown, ..watch }).unwrap();
    assert_eq!(*kept.borrow(), [5]);
}

#[test]
fn a_fault_ends_it() {
    let (mut device, stop) = (Slow { fails: true, ..slow(Duration::ZERO) }, AtomicBool::new(false));
    let watch = Watch { limit: None, stop: &stop, grown: &|_| () };
    assert!(go_on(&mut device, &cornell(9).1, None, &watch).is_err());
    assert_eq!(device.batches, [1]);
}
