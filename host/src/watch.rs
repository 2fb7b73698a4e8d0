//! Films that grow by samples while somebody looks on, and end early where that is wanted.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::error::{Error, Result};
use crate::film::{Film, Leasts, Part};
use crate::job::Job;
use crate::noise::{CellSums, Lot};
use crate::picture::Picture;
use crate::rays::Rays;
use crate::team::Lost;
use crate::view::{Region, View};

/// Who looks on, and when it ends. See [`Session::render_watched`](crate::render::Session::render_watched).
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// As many samples as fit so long, at least one.
    pub limit: Option<Duration>,
    /// Once it is set, the rendering ends with the samples that are done.
    pub stop: &'a AtomicBool,
    /// Hears of samples that were added.
    pub grown: &'a dyn Fn(Growth<'_>),
}

/// What hears of samples as a watch does, and tells `kept` of each film that is looked at: another device can go on from there.
pub(crate) fn keeping<'a>(watch: &'a Watch<'_>, kept: &'a dyn Fn(&Film)) -> impl Fn(Growth<'_>) + 'a {
    move |Growth { samples, of, cells, film }| {
        let mut film = || {
            let film = film()?;
            kept(&film);
            Ok(film)
        };
        (watch.grown)(Growth { samples, of, cells, film: &mut film });
    }
}

/// A film that has got some samples.
pub struct Growth<'a> {
    /// Samples of each pixel, in the mean of all.
    pub samples: u32,
    /// Samples that it shall have, or has at most where noise decides.
    pub of: u32,
    /// Where noise decides, how many cells have enough samples, and how many there are.
    pub cells: Option<(usize, usize)>,
    pub(crate) film: &'a mut dyn FnMut() -> Result<Film>,
}

impl Growth<'_> {
    /// The film so far: the bits of one of so many samples.
    ///
    /// # Errors
    /// What the device reports, or if there is no memory for it.
    pub fn film(self) -> Result<Film> {
        (self.film)()
    }

    /// The picture so far.
    ///
    /// # Errors
    /// As [`Growth::film`].
    pub fn picture(self) -> Result<Picture> {
        self.film()?.develop()
    }
}

/// A device that films grow on.
pub(crate) trait Grows: Send {
    /// Goes on with another job. The film is then to be started again.
    fn turn(&mut self, job: &Job) -> Result<()>;

    /// Starts a film of a view, without any sample. Parts that are added lie within one of these regions each, which fill its window.
    fn start(&mut self, view: &View, regions: &[Region]) -> Result<()>;

    /// Adds a part of the view of which it has nothing. `done` hears of shares of the pixels.
    fn add(&mut self, part: Part, done: &(dyn Fn(u64) + Sync)) -> Result<()>;

    /// Waits until what was added is done.
    fn wait(&mut self) -> Result<()>;

    /// How long samples take that are added at once, where one does not take longer: so soon a rendering ends that is stopped.
    fn step(&self) -> Duration {
        Duration::from_secs(1)
    }

    /// Time on the device of all that was rendered and read, if it has a clock.
    fn device_time(&self) -> Option<Duration> {
        None
    }

    /// Devices of several that failed since this was asked last.
    fn lost(&mut self) -> Vec<Lost> {
        Vec::new()
    }

    /// Whole blocks of samples of cells of a view, which may be others each time: their sums, which are of no film that was started.
    fn cells(&mut self, view: &View, cells: &[Region], samples: Range<u32>) -> Result<CellSums>;

    /// Lots of cells until there is none any more: `next` gives one, and waits for it where it is told to; `done` hears what comes of
    /// each, in their order, and of nothing more after a fault.
    fn lots(&mut self, view: &View, next: &mut dyn FnMut(bool) -> Option<Lot>, done: &mut dyn FnMut(Result<CellSums>)) {
        while let Some(Lot { cells, samples }) = next(true) {
            let sums = self.cells(view, &cells, samples);
            let is_lost = sums.is_err();
            done(sums);
            if is_lost {
                return;
            }
        }
    }

    /// How many lots it has under way at once.
    fn lots_at_once(&self) -> usize {
        1
    }

    /// The picture of a film, developed on its threads, and the rays that it took.
    fn develop(&self, film: &Film) -> Result<(Picture, Rays)> {
        film.developed()
    }

    /// Renders all samples of a view at once.
    fn expose(&mut self, view: &View, done: &(dyn Fn(u64) + Sync)) -> Result<Film> {
        self.start(view, &[view.region()])?;
        self.add(view.whole(), done)?;
        self.end()
    }

    /// The same to a picture, without a film.
    fn picture(&mut self, view: &View, done: &(dyn Fn(u64) + Sync)) -> Result<(Picture, Rays)> {
        let film = self.expose(view, done)?;
        self.develop(&film)
    }

    /// The film so far.
    fn film(&mut self) -> Result<Film>;

    /// What a screen shows of the film so far, where that need not leave the device.
    fn show(&mut self, _leasts: Leasts) -> Option<Result<wgpu::Texture>> {
        None
    }

    /// The film, to which nothing is added any more.
    fn end(&mut self) -> Result<Film> {
        self.film()
    }
}

/// Renders what a film has not yet of a view, until all is there, the time is up or somebody stops it.
///
/// # Errors
/// What the device reports, or a film of something else.
pub(crate) fn go_on(device: &mut dyn Grows, view: &View, from: Option<Film>, watch: &Watch<'_>) -> Result<Film> {
    let from = from.map(|film| prepared(film, view)).transpose()?;
    let missing = match &from {
        Some(film) => film.missing(view),
        None => vec![view.whole()],
    };
    let left = missing.iter().map(|part| part.volume()).sum();
    let mut grower = Grower { view, watch, film: from, left, start: Instant::now() };
    for part in missing {
        device.start(&view.part(part.region, part.samples.clone())?, &[part.region])?;
        let goes_on = grower.grow(device, part)?;
        grower.keep(device.end()?)?;
        if !goes_on {
            break;
        }
    }
    match grower.film {
        Some(film) => Ok(film),
        None => {
            device.start(view, &[view.region()])?;
            device.end()
        }
    }
}

/// A film as large as a view that goes on with it.
fn prepared(mut film: Film, view: &View) -> Result<Film> {
    film.widen(view.region())?;
    if film.window() != view.region() {
        return Err(Error::new("the film is of more than is rendered: render all that it shows, or name another film"));
    }
    Ok(film)
}

/// What a rendering has got, and what it has yet to get.
struct Grower<'a> {
    view: &'a View,
    watch: &'a Watch<'a>,
    /// Without the part under way.
    film: Option<Film>,
    /// Samples of all pixels that are missing.
    left: u64,
    start: Instant,
}

impl Grower<'_> {
    /// Adds samples until all of a part are there; false if it ends before that. Their number is chosen by what those before took.
    fn grow(&mut self, device: &mut dyn Grows, part: Part) -> Result<bool> {
        let Part { region, samples: all } = part;
        let (mut from, mut next) = (all.start, 1u32);
        while next > 0 {
            let before = Instant::now();
            device.add(Part { region, samples: from..from + next }, &|_| ())?;
            device.wait()?;
            from += next;
            self.left -= u64::from(next) * region.pixels();
            let each = (before.elapsed().as_secs_f64() / f64::from(next)).max(1e-9);
            self.tell(device);
            if self.watch.stop.load(Ordering::Relaxed) {
                return Ok(false);
            }
            let step = ((device.step().as_secs_f64() / each) as u32).max(1).min(next.saturating_mul(4));
            let left = match self.watch.limit {
                // Half of what should fit, since nobody knows what it takes; in the end one by one.
                Some(limit) => ((limit.saturating_sub(self.start.elapsed()).as_secs_f64() / each) as u32).div_ceil(2),
                None => u32::MAX,
            };
            next = step.min(left).min(all.end - from);
        }
        Ok(from == all.end)
    }

    fn tell(&self, device: &mut dyn Grows) {
        let (of, whole) = (self.view.samples(), self.view.whole());
        let samples = (whole.volume() - self.left) / whole.region.pixels();
        let mut film = || self.with(device.film()?);
        (self.watch.grown)(Growth { samples: samples as u32, of, cells: None, film: &mut film });
    }

    fn with(&self, part: Film) -> Result<Film> {
        match self.film.clone() {
            Some(mut film) => film.merge(part).map(|()| film),
            None => Ok(part),
        }
    }

    fn keep(&mut self, part: Film) -> Result<()> {
        match &mut self.film {
            Some(film) => film.merge(part)?,
            None => self.film = Some(part),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::sync::Arc;

    use eyerays_shader::stage::FilmWords;

    use super::*;
    use crate::cpu::{OnCpu, Renderer};
    use crate::job::Job;
    use crate::method::Traversal;
    use crate::quality::Bvh;
    use crate::scene::Settings;
    use crate::scene_io;

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
}
