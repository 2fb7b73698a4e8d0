//! Devices that take longer than others, and devices that fail.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::work::Pace;
use super::*;
use crate::cpu::{OnCpu, Renderer};
use crate::image::ToneMap;
use crate::job::Job;
use crate::method::Traversal;
use crate::noise::{self, Target};
use crate::quality::Bvh;
use crate::scene::Settings;
use crate::scene_io;
use crate::watch::Watch;

fn posed() -> (Job, View) {
    posed_with(40)
}

fn posed_with(spp: u32) -> (Job, View) {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/cornell_path.toml");
    let (scene, _) = scene_io::load(path.as_ref()).unwrap();
    let settings = Settings { size: (24, 70), spp, bounces: 1, ..scene.settings };
    let packed = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
    let view = View::new(&packed, &scene.cameras[0]).unwrap();
    (packed, view)
}

/// A device that takes so much longer, and fails after so many parts.
struct Odd<G> {
    device: G,
    pause: Duration,
    fails_after: usize,
}

impl<G: Grows> Grows for Odd<G> {
    fn turn(&mut self, job: &Job) -> Result<()> {
        self.device.turn(job)
    }

    fn start(&mut self, view: &View, regions: &[Region]) -> Result<()> {
        self.device.start(view, regions)
    }

    fn add(&mut self, part: Part, done: &(dyn Fn(u64) + Sync)) -> Result<()> {
        thread::sleep(self.pause);
        match self.fails_after.checked_sub(1) {
            Some(left) => self.fails_after = left,
            None => return Err(Error::DeviceFailed { device: "odd".to_owned(), message: "it is lost".to_owned() }),
        }
        self.device.add(part, done)
    }

    fn wait(&mut self) -> Result<()> {
        self.device.wait()
    }

    fn cells(&mut self, view: &View, cells: &[Region], samples: Range<u32>) -> Result<CellSums> {
        thread::sleep(self.pause);
        match self.fails_after.checked_sub(1) {
            Some(left) => self.fails_after = left,
            None => return Err(Error::DeviceFailed { device: "odd".to_owned(), message: "it is lost".to_owned() }),
        }
        self.device.cells(view, cells, samples)
    }

    fn film(&mut self) -> Result<Film> {
        match self.fails_after {
            0 => Err(Error::DeviceFailed { device: "odd".to_owned(), message: "it is lost".to_owned() }),
            _ => self.device.film(),
        }
    }
}

/// Devices, each with a pause in milliseconds and the parts after which it fails.
fn rendered(devices: &[(u64, usize)]) -> (Result<Film>, Vec<Lost>, Film) {
    rendered_by(devices, |team| team)
}

/// The same by the team that is made of theirs.
fn rendered_by(devices: &[(u64, usize)], of: impl Fn(Team) -> Team) -> (Result<Film>, Vec<Lost>, Film) {
    let (packed, view) = posed();
    let renderer = Arc::new(Renderer::new(&packed, Traversal::default(), 1).unwrap());
    let member = |(number, &(pause, fails_after)): (usize, &(u64, usize))| {
        let (device, pause) = (OnCpu::<f32>::new(renderer.clone()), Duration::from_millis(pause));
        Member::new(format!("device {number}"), Odd { device, pause, fails_after })
    };
    let mut team = of(Team::new(devices.iter().enumerate().map(member).collect()));
    let film = team.expose(&view, &|_| ());
    let lost = team.lost();
    (film, lost, OnCpu::<f32>::new(renderer.clone()).expose(&view, &|_| ()).unwrap())
}

fn assert_same(film: &Film, want: &Film) {
    assert!(film.develop().unwrap().bits_equal(&want.develop().unwrap()));
    assert_eq!((film.rays(), film.coverage()), (want.rays(), want.coverage()));
}

const NEVER: usize = usize::MAX;

#[test]
fn a_film_of_several_devices_has_the_bits_of_one() {
    for devices in [&[(0, NEVER)][..], &[(0, NEVER), (0, NEVER)], &[(0, NEVER), (30, NEVER), (1, NEVER)]] {
        let (film, lost, want) = rendered(devices);
        assert_same(&film.unwrap(), &want);
        assert!(lost.is_empty());
    }
}

#[test]
fn samples_of_whole_images_are_shared_too() {
    for devices in [&[(0, NEVER)][..], &[(0, NEVER), (30, NEVER), (1, NEVER)], &[(0, 1), (5, NEVER), (5, NEVER)]] {
        let (film, lost, want) = rendered_by(devices, Team::of_whole_samples);
        assert_same(&film.unwrap(), &want);
        assert_eq!(lost.len(), devices.iter().filter(|&&(_, fails_after)| fails_after != NEVER).count());
    }
}

#[test]
fn what_a_lost_device_had_is_done_by_the_others() {
    for fails_after in [0, 1, 5] {
        // Those that stay are slow, so that on a busy machine, too, the other comes to its last part.
        let (film, lost, want) = rendered(&[(0, fails_after), (20, NEVER), (10, NEVER)]);
        assert_same(&film.unwrap(), &want);
        assert!(matches!(&lost[..], [(name, Error::DeviceFailed { .. })] if name == "device 0"), "{lost:?}");
    }
}

#[test]
fn the_loss_of_the_last_device_is_a_fault() {
    let (film, _, _) = rendered(&[(0, 2), (0, 4)]);
    assert!(matches!(film, Err(Error::DeviceFailed { .. })));
}

/// One takes four seconds for anything, the other nearly nothing for everything.
#[test]
fn a_slow_device_does_not_hold_up_a_fast_one() {
    let start = Instant::now();
    let (film, _, want) = rendered(&[(4000, NEVER), (0, NEVER)]);
    assert_same(&film.unwrap(), &want);
    assert!(start.elapsed() < Duration::from_millis(7900), "it took a second part: {:?}", start.elapsed());
}

/// Three of one pace, and one that is slow: each would be done sooner by the others together.
#[test]
fn alike_devices_do_not_wait_for_each_other() {
    let (film, _, want) = rendered(&[(2, NEVER), (2, NEVER), (2, NEVER), (20, NEVER)]);
    assert_same(&film.unwrap(), &want);
}

/// Whatever the paces are, somebody takes the rest.
#[test]
fn the_fastest_member_always_takes_what_is_left() {
    let region = Region { x: 0, y: 0, width: 10, height: 8 };
    for rates in [[1.0, 1.0, 1.0], [5.0, 5.0, 0.1], [3.0, 2.0, 2.5], [1e9, 1e9, 1e3]] {
        let members = rates.map(|rate| Pace { is_lost: false, is_done: false, rate: Some(rate) }).to_vec();
        let mut work = Work { todo: vec![Part { region, samples: 0..7 }], members, faults: Vec::new() };
        let mut rounds = 0;
        while !work.todo.is_empty() {
            let taken = [0, 1, 2].map(|number| work.take(number));
            assert!(
                taken.iter().any(Option::is_some) || work.todo.is_empty(),
                "{rates:?}: nobody takes {:?}",
                work.todo
            );
            rounds += 1;
        }
        assert!(rounds <= 7);
    }
}

#[test]
fn strips_fill_a_region() {
    for (height, count) in [(1, 4), (8, 4), (70, 24), (1080, 24), (2160, 96)] {
        let region = Region { x: 3, y: 5, width: 9, height };
        let strips = strips(region, count);
        assert!(strips.len() <= count as usize && strips.iter().all(|strip| (strip.x, strip.width) == (3, 9)));
        let ends = strips.iter().map(|strip| strip.y + strip.height);
        assert_eq!(
            ends.collect::<Vec<_>>().split_last().unwrap().1,
            strips[1..].iter().map(|s| s.y).collect::<Vec<_>>()
        );
        assert_eq!(strips.iter().map(|strip| strip.height).sum::<u32>(), height);
    }
}

/// Cells by devices, each with a pause in milliseconds and the calls after which it fails.
fn by_cells(devices: &[(u64, usize)]) -> (Result<Film>, usize, Film) {
    let (packed, view) = posed_with(200);
    let target = Target::new(0.2, 0.0, ToneMap::None).unwrap();
    let renderer = Arc::new(Renderer::new(&packed, Traversal::default(), 1).unwrap());
    let stop = AtomicBool::new(false);
    let render = |device: &mut dyn Grows| {
        noise::go_on(device, &view, &target, None, &Watch { limit: None, stop: &stop, grown: &|_| () })
    };
    let member = |(number, &(pause, fails_after)): (usize, &(u64, usize))| {
        let (device, pause) = (OnCpu::<f32>::new(renderer.clone()), Duration::from_millis(pause));
        Member::new(format!("device {number}"), Odd { device, pause, fails_after })
    };
    let mut team = Team::new(devices.iter().enumerate().map(member).collect());
    let film = render(&mut team);
    (film, team.lost().len(), render(&mut OnCpu::<f32>::new(renderer.clone())).unwrap())
}

#[test]
fn cells_by_devices_of_which_some_fail_have_the_bits_of_one() {
    for (devices, lost) in [(&[(0, 99), (3, 99)][..], 0), (&[(0, 1), (2, 99), (1, 99)], 1), (&[(5, 0), (0, 99)], 1)] {
        let (film, failed, want) = by_cells(devices);
        let film = film.unwrap();
        assert_eq!((film.samples(), film.rays(), failed), (want.samples(), want.rays(), lost), "{devices:?}");
        assert_same(&film, &want);
    }
    let (film, failed, _) = by_cells(&[(0, 1), (0, 0)]);
    assert!(film.is_err() && failed == 1, "the last fault is the rendering's");
}
