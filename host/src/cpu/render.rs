//! Whole pictures.

use std::sync::{Arc, Mutex, PoisonError};

use eyerays_kernels_cpu::{Isa, Number};
use eyerays_shader::resources::binding;
use rayon::prelude::*;

use super::pool::pool;
use super::tile::{Observer, Planned};
use crate::device_scene::SceneView;
use crate::error::Result;
use crate::film::{Film, Part};
use crate::job::Job;
use crate::method::Traversal;
use crate::picture::Picture;
use crate::rays::Rays;
use crate::scene::Light;
use crate::view::{Region, View};

/// Memory for the waiting rays of a tile, in bytes, that makes a tile smaller than [`TILE`].
const PATH_MEMORY: u64 = 64 << 20;
/// A tile's edge in pixels.
const TILE: u32 = 32;

/// A scene laid out for the CPU, with the threads to render it: made once for any number of pictures.
///
/// Samples can be added to a film bit by bit, with the bits of all at once:
///
/// ```
/// # use eyerays::{cpu::Renderer, job::Job, method::Traversal, quality::Bvh, scene_io, view::View};
/// # fn main() -> eyerays::error::Result<()> {
/// # let (scene, _) = scene_io::load("../scenes/cornell.toml".as_ref())?;
/// let job = Job::new(&scene, scene.settings, Bvh::Fast.quality())?;
/// let view = View::of(&job, &scene.cameras[0], (16, 16), 2)?;
/// let renderer = Renderer::new(&job, Traversal::default(), 0)?;
/// let mut film = renderer.start(&view);
/// for sample in view.range() {
///     renderer.add::<f32>(&view, &mut film, view.samples_of(sample..sample + 1), &|_| (), &())?;
///     let _so_far = film.develop()?;
/// }
/// # Ok(())
/// # }
/// ```
pub struct Renderer {
    pub(super) planned: Planned,
    threads: Arc<rayon::ThreadPool>,
}

impl Renderer {
    /// Starts `threads` threads (0: one a core) and makes what the traversal needs beside the packed scene, such as
    /// wide nodes.
    ///
    /// # Errors
    /// If the threads can't be started.
    pub fn new(packed: &Job, traversal: impl Into<Traversal>, threads: usize) -> Result<Self> {
        Ok(Renderer::on(Arc::new(pool(threads)?), packed, traversal.into()))
    }

    fn on(threads: Arc<rayon::ThreadPool>, job: &Job, traversal: Traversal) -> Self {
        let laid = threads.install(|| SceneView::new(job, traversal));
        Renderer { planned: Planned::new(laid, Isa::best()), threads }
    }

    /// One for another job, with the same threads.
    pub(crate) fn turned(&self, job: &Job) -> Self {
        Renderer::on(self.threads.clone(), job, self.planned.laid.traversal)
    }

    /// Goes on with other lights: as many as the scene's, of the same kinds.
    ///
    /// # Errors
    /// As [`DeviceScene::relit`](crate::device_scene::DeviceScene::relit).
    pub fn set_lights(&mut self, lights: &[Light]) -> Result<()> {
        self.planned.laid.set_lights(lights)
    }

    /// Renders a picture in the arithmetic `R`. `done` hears of every finished share of the pixels, and `observer`
    /// looks on.
    ///
    /// # Errors
    /// If there is no memory for the film.
    pub fn render<R>(
        &self,
        view: &View,
        done: &(dyn Fn(u64) + Sync),
        observer: &dyn Observer<R>,
    ) -> Result<(Picture, Rays)>
    where
        R: Number,
    {
        let mut film = self.start(view);
        self.add(view, &mut film, view.whole(), done, observer)?;
        self.threads.install(|| film.developed())
    }

    /// A film of a view without any sample.
    pub fn start(&self, view: &View) -> Film {
        Film::new(view, self.planned.film_words())
    }

    /// Adds a part of a view to its film, in the arithmetic `R`: n and then n more give the bits of 2n at once. `done` hears of
    /// every finished share of the pixels, and `observer` looks on.
    ///
    /// # Errors
    /// The view has no such part, or there is no memory for its sums.
    ///
    /// # Panics
    /// If the film has some of the samples, or is of another view.
    pub fn add<R>(
        &self,
        view: &View,
        film: &mut Film,
        part: Part,
        done: &(dyn Fn(u64) + Sync),
        observer: &dyn Observer<R>,
    ) -> Result<()>
    where
        R: Number,
    {
        let view = view.part(part.region, part.samples)?;
        self.threads.install(|| film.make_room())?;
        let film = Mutex::new(film);
        let (tiles, range) = (self.tiles(&view), view.range());
        let at_once = self.planned.samples_at_once(&view);
        let share = |samples: u32, pixels: u64| pixels * u64::from(samples) / u64::from(range.end - range.start);
        for first in range.clone().step_by(at_once as usize) {
            let samples = first..range.end.min(first.saturating_add(at_once));
            let maps = self.threads.install(|| self.planned.maps::<R>(&view, samples.clone()));
            let shared = |pixels| share(samples.end - range.start, pixels) - share(first - range.start, pixels);
            self.threads.install(|| {
                // A tile a task: coarser splitting leaves threads idle at the end.
                tiles.par_iter().with_max_len(1).for_each(|&region| {
                    let mut sums = self.planned.film(region);
                    let of = (samples.clone(), &maps[..]);
                    let secondary = self.planned.add_by(&view, region, of, &mut sums, observer);
                    let mut film = film.lock().unwrap_or_else(PoisonError::into_inner);
                    film.add_part_alone(region, &sums);
                    film.add_rays(secondary);
                    done(shared(region.pixels()));
                });
            });
        }
        film.into_inner().unwrap_or_else(PoisonError::into_inner).cover(view.whole());
        Ok(())
    }

    /// Runs something on its threads.
    pub(crate) fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        self.threads.install(work)
    }

    fn tiles(&self, view: &View) -> Vec<Region> {
        // Records of numbers of 64 bits take twice as much.
        let slot = 2 * self.planned.plan.bytes_of(binding::PATHS);
        let mut edge = TILE;
        while edge > 8 && u64::from(edge * edge) * slot > PATH_MEMORY {
            edge /= 2;
        }
        view.region().pieces(edge, edge).collect()
    }
}

/// One picture: [`Renderer::new`] and [`Renderer::render`].
///
/// # Errors
/// If the film or the threads can't be had.
pub fn render<R>(
    packed: &Job,
    view: &View,
    traversal: impl Into<Traversal>,
    threads: usize,
    done: &(dyn Fn(u64) + Sync),
) -> Result<(Picture, Rays)>
where
    R: Number,
{
    Renderer::new(packed, traversal, threads)?.render::<R>(view, done, &())
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::quality::Bvh;
    use crate::scene::{Scene, Settings};
    use crate::scene_io;

    fn lights() -> Scene {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/lights.toml");
        scene_io::load(path.as_ref()).unwrap().0
    }

    fn packed(scene: &Scene, settings: Settings) -> Job {
        Job::new(scene, settings, Bvh::Fast.quality()).unwrap()
    }

    /// Three threads, a picture of whole and broken tiles, and reflected rays.
    #[test]
    fn samples_in_parts_are_the_samples_at_once() {
        let scene = lights();
        let packed = packed(&scene, Settings { size: (45, 37), samples: 3, ..scene.settings });
        let view = View::new(&packed, &scene.cameras[0]).unwrap();
        let renderer = Renderer::new(&packed, Traversal::default(), 3).unwrap();
        let (whole, rays) = renderer.render::<f32>(&view, &|_| (), &()).unwrap();
        for parts in [&[9][..], &[1, 8], &[4, 4, 1], &[3, 3, 3]] {
            let (mut film, mut first) = (renderer.start(&view), 0);
            for &count in parts {
                let part = view.samples_of(first..first + count);
                renderer.add::<f32>(&view, &mut film, part, &|_| (), &()).unwrap();
                first += count;
            }
            assert!(film.develop().unwrap().bits_equal(&whole), "{parts:?}");
            assert_eq!(film.rays(), rays, "{parts:?}");
        }
    }

    #[test]
    fn a_picture_of_some_samples_is_their_mean_and_of_none_black() {
        let scene = lights();
        let packed = packed(&scene, Settings { size: (16, 12), samples: 2, bounces: 0, ..scene.settings });
        let view = View::new(&packed, &scene.cameras[0]).unwrap();
        let renderer = Renderer::new(&packed, Traversal::default(), 1).unwrap();
        let mut film = renderer.start(&view);
        assert!(film.develop().unwrap().pixels.iter().all(|&pixel| pixel == [0.0; 3]));
        renderer.add::<f32>(&view, &mut film, view.samples_of(0..1), &|_| (), &()).unwrap();
        let one = film.develop().unwrap();
        renderer.add::<f32>(&view, &mut film, view.samples_of(1..4), &|_| (), &()).unwrap();
        let four = film.develop().unwrap();
        let brightness =
            |picture: &Picture| picture.pixels.as_flattened().iter().sum::<f32>() / picture.pixels.len() as f32;
        assert!(brightness(&one) > 0.1 && (brightness(&one) / brightness(&four) - 1.0).abs() < 0.05);
        assert!(!one.bits_equal(&four));
    }

    /// Cameras, sizes and lights' values change without another scene.
    #[test]
    fn what_changes_from_frame_to_frame_needs_no_other_scene() {
        let mut scene = lights();
        let settings = Settings { size: (24, 18), samples: 1, ..scene.settings };
        let first = packed(&scene, settings);
        let mut renderer = Renderer::new(&first, Traversal::default(), 2).unwrap();
        for (size, camera) in [((24, 18), 1), ((7, 40), 0), ((24, 18), 0)] {
            let view = View::of(&first, &scene.cameras[camera], size, 1).unwrap();
            let film = renderer.render::<f32>(&view, &|_| (), &()).unwrap().0;
            let fresh = packed(&scene, Settings { size, ..settings });
            let view = View::new(&fresh, &scene.cameras[camera]).unwrap();
            assert!(film.bits_equal(&render::<f32>(&fresh, &view, Traversal::default(), 1, &|_| ()).unwrap().0));
        }
        for light in &mut scene.lights {
            if let Light::Point { position, colour, .. } | Light::Spot { position, colour, .. } = light {
                (*position, *colour) = (*position + Vec3::Y * 0.1, *colour * 0.5);
            }
        }
        renderer.set_lights(&scene.lights).unwrap();
        let view = View::new(&first, &scene.cameras[0]).unwrap();
        let film = renderer.render::<f32>(&view, &|_| (), &()).unwrap().0;
        let fresh = packed(&scene, settings);
        assert!(film.bits_equal(&render::<f32>(&fresh, &view, Traversal::default(), 1, &|_| ()).unwrap().0));
        scene.lights.pop();
        assert!(renderer.set_lights(&scene.lights).unwrap_err().to_string().contains("lights of other kinds"));
    }
}
