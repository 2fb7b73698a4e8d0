//! Several devices at one film: each takes samples of some strip of the image as soon as it is done with those before. Sums have no
//! order, so the film has the bits of any one device.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use crate::error::{Error, Result};
use crate::film::{Coverage, Film, Part};
use crate::view::{Region, View};
use crate::watch::Grows;

/// How long a device should take for what it takes at once.
const BLOCK: f64 = 0.3;
/// Strips of the image a device, so that a slow one can take little.
const STRIPS: u32 = 12;
/// Strips are whole blocks of pixels high.
const ROWS: u32 = 8;

/// A device of several that failed, by its name.
pub type Lost = (String, Error);

/// A device of several.
pub(crate) struct Member<'a> {
    name: String,
    device: Box<dyn Grows + Send + 'a>,
    has: Coverage,
    is_lost: bool,
    /// Samples of a pixel a second, once that is known.
    rate: Option<f64>,
}

impl<'a> Member<'a> {
    /// A device that is ready, by its name.
    pub fn new(name: String, device: impl Grows + Send + 'a) -> Self {
        Member { name, device: Box::new(device), has: Coverage::default(), is_lost: false, rate: None }
    }
}

/// Devices that share their work.
pub(crate) struct Team<'a> {
    members: Vec<Member<'a>>,
    view: Option<View>,
    coverage: Coverage,
    /// Of all renderings.
    lost: Vec<Lost>,
}

impl<'a> Team<'a> {
    /// Of devices that are ready.
    pub fn new(members: Vec<Member<'a>>) -> Self {
        Team { members, view: None, coverage: Coverage::default(), lost: Vec::new() }
    }

    /// Fails with the last fault if every device is lost.
    fn check(&mut self) -> Result<()> {
        if self.members.iter().any(|member| !member.is_lost) {
            return Ok(());
        }
        let fault = self.lost.pop().map(|(_, error)| error);
        Err(fault.unwrap_or_else(|| Error::new("every device has failed: render on another")))
    }

    /// Lets every member work until all is done. Fails if all are lost.
    fn share(&mut self, todo: Vec<Part>) -> Result<()> {
        let pace = |member: &Member<'_>| Pace { is_lost: member.is_lost, is_done: false, rate: member.rate };
        let members = self.members.iter().map(pace).collect();
        let work = Mutex::new(Work { todo, members, faults: Vec::new() });
        while !locked(&work).todo.is_empty() {
            thread::scope(|scope| {
                for (number, member) in self.members.iter_mut().enumerate().filter(|(_, member)| !member.is_lost) {
                    let work = &work;
                    scope.spawn(move || member.run(number, work));
                }
            });
            let mut work = locked(&work);
            // Whoever left the rest to a member that failed is needed again.
            work.members.iter_mut().for_each(|pace| pace.is_done = false);
            let faults = std::mem::take(&mut work.faults);
            drop(work);
            self.lost.extend(faults);
            self.check()?;
        }
        Ok(())
    }
}

impl Grows for Team<'_> {
    fn start(&mut self, view: &View, _: &[Region]) -> Result<()> {
        let strips = strips(view.region(), STRIPS * self.members.len() as u32);
        for member in self.members.iter_mut().filter(|member| !member.is_lost) {
            member.has = Coverage::default();
            if let Err(error) = member.device.start(view, &strips) {
                member.is_lost = true;
                self.lost.push((member.name.clone(), error));
            }
        }
        self.check()?;
        (self.view, self.coverage) = (Some(*view), Coverage::default());
        Ok(())
    }

    fn add(&mut self, part: Part, done: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let todo = strips(part.region, STRIPS * self.members.len() as u32);
        let todo = todo.into_iter().map(|region| Part { region, samples: part.samples.clone() }).collect();
        self.share(todo)?;
        let (pixels, samples) = (part.region.pixels(), part.samples.len() as u64);
        self.coverage.add(part).map_err(|both| Error::new(format!("the film has {both} already")))?;
        let all = self.view.as_ref().map_or(1, View::samples);
        done(pixels * samples / u64::from(all));
        Ok(())
    }

    fn wait(&mut self) -> Result<()> {
        Ok(())
    }

    fn lost(&mut self) -> Vec<Lost> {
        std::mem::take(&mut self.lost)
    }

    /// Devices wait for each other at the end of each step.
    fn step(&self) -> Duration {
        Duration::from_secs(2)
    }

    fn film(&mut self) -> Result<Film> {
        loop {
            let mut redo = Vec::new();
            let mut films = Vec::new();
            for member in self.members.iter_mut().filter(|member| !member.is_lost) {
                match member.device.film() {
                    Ok(film) => films.push(film),
                    Err(error) => {
                        member.is_lost = true;
                        redo.extend_from_slice(member.has.parts());
                        self.lost.push((member.name.clone(), error));
                    }
                }
            }
            self.check()?;
            if !redo.is_empty() {
                // What went with it is done by the others, and then read with the rest.
                self.share(redo)?;
                continue;
            }
            let mut films = films.into_iter();
            let mut film = films.next().expect("some device is left");
            films.try_for_each(|other| film.absorb(&other))?;
            film.set_coverage(self.coverage.clone());
            return Ok(film);
        }
    }
}

/// What is to be done, for whoever comes next.
struct Work {
    /// Parts of a strip each.
    todo: Vec<Part>,
    members: Vec<Pace>,
    faults: Vec<Lost>,
}

/// How fast a member is.
#[derive(Clone, Copy)]
struct Pace {
    is_lost: bool,
    /// Does it leave the rest to others?
    is_done: bool,
    /// Samples of a pixel a second, once that is known.
    rate: Option<f64>,
}

impl Pace {
    /// Is it faster than another member? Of two that are alike the first is.
    fn is_faster(&self, number: usize, other: Pace, other_number: usize) -> bool {
        let [own, other] = [self.rate, other.rate].map(|rate| rate.unwrap_or(0.0));
        own > other || own == other && number < other_number
    }
}

impl Work {
    /// Some samples of the strip that has most left, as many as suit the member; none if the others are done sooner without it.
    fn take(&mut self, number: usize) -> Option<Part> {
        let left: u64 = self.todo.iter().map(Part::volume).sum();
        let (at, strip) = self.todo.iter().enumerate().max_by_key(|(_, part)| part.samples.len())?;
        let (pixels, all) = (strip.region.pixels() as f64, strip.samples.len() as f64);
        let own = self.members[number];
        let all_rates: f64 = self.members.iter().filter(|pace| !pace.is_lost).filter_map(|pace| pace.rate).sum();
        // Only those count that stay: the fastest always does, so that some member does the rest.
        let stays =
            |&(other, pace): &(usize, &Pace)| !pace.is_lost && !pace.is_done && pace.is_faster(other, own, number);
        let others: f64 = self.members.iter().enumerate().filter(stays).filter_map(|(_, pace)| pace.rate).sum();
        let samples = match own.rate {
            None => 1.0,
            Some(rate) if others > 0.0 && pixels / rate > left as f64 / others => {
                self.members[number].is_done = true;
                return None;
            }
            // Less towards the end, and half of its share at most, so that all end together.
            Some(rate) => (rate * BLOCK).min(left as f64 * rate / (2.0 * all_rates.max(rate))) / pixels,
        };
        let taken = samples.clamp(1.0, all) as u32;
        let part = &mut self.todo[at];
        let (region, start) = (part.region, part.samples.start);
        part.samples.start += taken;
        if part.samples.is_empty() {
            self.todo.swap_remove(at);
        }
        Some(Part { region, samples: start..start + taken })
    }
}

impl Member<'_> {
    /// Works until there is nothing left for it, or it fails: then all that it had is to be done again.
    fn run(&mut self, number: usize, work: &Mutex<Work>) {
        loop {
            let Some(part) = locked(work).take(number) else { return };
            let before = Instant::now();
            let added = self.device.add(part.clone(), &|_| ()).and_then(|()| self.device.wait());
            let mut work = locked(work);
            if let Err(error) = added {
                self.is_lost = true;
                work.members[number].is_lost = true;
                work.todo.push(part);
                work.todo.extend_from_slice(self.has.parts());
                work.faults.push((self.name.clone(), error));
                return;
            }
            self.rate = Some(part.volume() as f64 / before.elapsed().as_secs_f64().max(1e-9));
            work.members[number].rate = self.rate;
            self.has.add(part).expect("nothing is done twice");
        }
    }
}

fn locked(work: &Mutex<Work>) -> MutexGuard<'_, Work> {
    work.lock().unwrap_or_else(PoisonError::into_inner)
}

/// About so many strips of whole rows.
fn strips(region: Region, count: u32) -> Vec<Region> {
    let Region { x, y, width, height } = region;
    let rows = height.div_ceil(count.max(1)).next_multiple_of(ROWS);
    let tops = (0..height).step_by(rows as usize);
    tops.map(|top| Region { x, y: y + top, width, height: (height - top).min(rows) }).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::cpu::{OnCpu, Renderer};
    use crate::device_scene::DeviceScene;
    use crate::method::Traversal;
    use crate::quality::Bvh;
    use crate::scene::{self, Settings};
    use crate::watch;

    fn posed() -> (DeviceScene, View) {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/cornell_path.toml");
        let (scene, _) = scene::load(path.as_ref()).unwrap();
        let settings = Settings { size: (24, 70), spp: 40, bounces: 1, ..scene.settings };
        let packed = DeviceScene::new(&scene, settings, Bvh::Fast.quality()).unwrap();
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

        fn film(&mut self) -> Result<Film> {
            match self.fails_after {
                0 => Err(Error::DeviceFailed { device: "odd".to_owned(), message: "it is lost".to_owned() }),
                _ => self.device.film(),
            }
        }
    }

    /// Devices, each with a pause in milliseconds and the parts after which it fails.
    fn rendered(devices: &[(u64, usize)]) -> (Result<Film>, Vec<Lost>, Film) {
        let (packed, view) = posed();
        let renderer = Arc::new(Renderer::new(&packed, Traversal::default(), 1).unwrap());
        let member = |(number, &(pause, fails_after)): (usize, &(u64, usize))| {
            let (device, pause) = (OnCpu::<f32>::new(renderer.clone()), Duration::from_millis(pause));
            Member::new(format!("device {number}"), Odd { device, pause, fails_after })
        };
        let mut team = Team::new(devices.iter().enumerate().map(member).collect());
        let film = watch::render(&mut team, &view, &|_| ());
        let lost = team.lost();
        (film, lost, watch::render(&mut OnCpu::<f32>::new(renderer.clone()), &view, &|_| ()).unwrap())
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
    fn what_a_lost_device_had_is_done_by_the_others() {
        for fails_after in [0, 1, 5] {
            let (film, lost, want) = rendered(&[(1, fails_after), (3, NEVER), (0, NEVER)]);
            assert_same(&film.unwrap(), &want);
            assert!(matches!(&lost[..], [(name, Error::DeviceFailed { .. })] if name == "device 0"), "{lost:?}");
        }
    }

    #[test]
    fn the_loss_of_the_last_device_is_a_fault() {
        let (film, _, _) = rendered(&[(0, 2), (0, 4)]);
        assert!(matches!(film, Err(Error::DeviceFailed { .. })));
    }

    /// One takes a second for anything, the other nearly nothing for everything.
    #[test]
    fn a_slow_device_does_not_hold_up_a_fast_one() {
        let start = Instant::now();
        let (film, _, want) = rendered(&[(1000, NEVER), (0, NEVER)]);
        assert_same(&film.unwrap(), &want);
        assert!(start.elapsed() < Duration::from_millis(2500), "it took a second part: {:?}", start.elapsed());
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
}
