//! Whole pictures.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use eyerays_kernels_cpu::{Isa, Number};
use eyerays_shader::resources::binding;
use rayon::prelude::*;

use super::pool::pool;
use super::tile::{Observer, Planned};
use crate::device_scene::{DeviceScene, SceneView};
use crate::error::{Error, Result};
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
/// Samples can be added to a picture bit by bit, with the bits of all at once:
///
/// ```
/// # use eyerays::{cpu::Renderer, device_scene::DeviceScene, method::Traversal, quality::Bvh, scene, view::View};
/// # fn main() -> eyerays::error::Result<()> {
/// # let (scene, _) = scene::load("../scenes/cornell.toml".as_ref())?;
/// let device_scene = DeviceScene::new(&scene, scene.settings, Bvh::Fast.quality())?;
/// let view = View::of(&device_scene, &scene.cameras[0], (16, 16), 2)?;
/// let renderer = Renderer::new(&device_scene, Traversal::default(), 0)?;
/// let mut picture = renderer.start::<f32>(&view)?;
/// while picture.samples() < view.samples() {
///     renderer.add(&mut picture, 1);
///     let (_so_far, _rays) = picture.film()?;
/// }
/// # Ok(())
/// # }
/// ```
pub struct Renderer<'a> {
    planned: Planned<'a>,
    threads: rayon::ThreadPool,
}

/// A picture that samples are added to: [`Renderer::start`].
pub struct Growing<R: Number> {
    view: View,
    tiles: Vec<Tile<R>>,
    samples: u32,
}

struct Tile<R: Number> {
    region: Region,
    film: Vec<R::Record>,
    secondary: u64,
}

impl<'a> Renderer<'a> {
    /// Starts `threads` threads (0: one a core) and makes what the traversal needs beside the packed scene, such as
    /// wide nodes.
    ///
    /// # Errors
    /// If the threads can't be started.
    pub fn new(packed: &'a DeviceScene, traversal: impl Into<Traversal>, threads: usize) -> Result<Self> {
        let threads = pool(threads)?;
        let traversal = traversal.into();
        let laid = threads.install(|| SceneView::new(packed, traversal));
        Ok(Renderer { planned: Planned::new(laid, Isa::best()), threads })
    }

    /// Goes on with other lights: as many as the scene's, of the same kinds.
    ///
    /// # Errors
    /// As [`DeviceScene::relit`].
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
        let (width, height) = view.size();
        let result = Mutex::new((Picture::new(width, height)?, Rays::default()));
        self.threads.install(|| {
            // A tile a task: coarser splitting leaves threads idle at the end.
            self.tiles(view).into_par_iter().with_max_len(1).for_each(|region| {
                let mut tile = Tile { region, film: self.planned.film::<R>(region), secondary: 0 };
                tile.add(&self.planned, view, 0..view.samples(), observer);
                let (image, rays) = &mut *result.lock().unwrap_or_else(PoisonError::into_inner);
                tile.develop(view.samples(), image, rays);
                done(region.pixels());
            });
        });
        Ok(result.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    /// Starts a picture without any sample, which keeps the sums of all its pixels.
    ///
    /// # Errors
    /// If there is no memory for them.
    pub fn start<R: Number>(&self, view: &View) -> Result<Growing<R>> {
        let (width, height) = view.size();
        let tile = |region| {
            let film = self.planned.try_film::<R>(region).ok_or(Error::Memory { width, height })?;
            Ok(Tile { region, film, secondary: 0 })
        };
        let tiles = self.tiles(view).into_iter().map(tile).collect::<Result<_>>()?;
        Ok(Growing { view: *view, tiles, samples: 0 })
    }

    /// Adds the next `count` samples of each pixel to a picture, or as many as its view has: n and then n more give the
    /// bits of 2n at once.
    pub fn add<R>(&self, picture: &mut Growing<R>, count: u32)
    where
        R: Number,
    {
        let end = picture.samples.saturating_add(count).min(picture.view.samples());
        let samples = picture.samples..end;
        self.threads.install(|| {
            let tiles = picture.tiles.par_iter_mut().with_max_len(1);
            tiles.for_each(|tile| tile.add(&self.planned, &picture.view, samples.clone(), &()));
        });
        picture.samples = end;
    }

    fn tiles(&self, view: &View) -> Vec<Region> {
        let (width, height) = view.size();
        // Records of numbers of 64 bits take twice as much.
        let slot = 2 * self.planned.plan.bytes_of(binding::PATHS);
        let mut edge = TILE;
        while edge > 8 && u64::from(edge * edge) * slot > PATH_MEMORY {
            edge /= 2;
        }
        let edge = edge as usize;
        let rows = (0..height).step_by(edge);
        rows.flat_map(|y| (0..width).step_by(edge).map(move |x| (x, y)))
            .map(|(x, y)| Region { x, y, width: (width - x).min(edge as u32), height: (height - y).min(edge as u32) })
            .collect()
    }
}

impl<R: Number> Tile<R> {
    fn add(&mut self, planned: &Planned<'_>, view: &View, samples: Range<u32>, observer: &dyn Observer<R>) {
        self.secondary += planned.add(view, self.region, samples, &mut self.film, observer);
    }

    fn develop(&self, samples: u32, image: &mut Picture, rays: &mut Rays) {
        image.develop::<R>(self.region, &self.film, samples, rays);
        rays.secondary += self.secondary;
        rays.primary += self.region.pixels() * u64::from(samples);
    }
}

impl<R: Number> Growing<R> {
    /// How many samples of each pixel it has.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// The mean of its samples so far, black without any, and the rays that they took.
    ///
    /// # Errors
    /// If there is no memory for the film.
    pub fn film(&self) -> Result<(Picture, Rays)> {
        let (width, height) = self.view.size();
        let (mut film, mut rays) = (Picture::new(width, height)?, Rays::default());
        if self.samples > 0 {
            self.tiles.iter().for_each(|tile| tile.develop(self.samples, &mut film, &mut rays));
        }
        Ok((film, rays))
    }
}

/// One picture: [`Renderer::new`] and [`Renderer::render`].
///
/// # Errors
/// If the film or the threads can't be had.
pub fn render<R>(
    packed: &DeviceScene,
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
    use crate::scene::{self, Scene, Settings};

    fn lights() -> Scene {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/lights.toml");
        scene::load(path.as_ref()).unwrap().0
    }

    fn packed(scene: &Scene, settings: Settings) -> DeviceScene {
        DeviceScene::new(scene, settings, Bvh::Fast.quality()).unwrap()
    }

    /// Three threads, a picture of whole and broken tiles, and reflected rays.
    #[test]
    fn samples_in_parts_are_the_samples_at_once() {
        let scene = lights();
        let packed = packed(&scene, Settings { size: (45, 37), samples: 3, ..scene.settings });
        let view = View::new(&packed, &scene.cameras[0]).unwrap();
        let renderer = Renderer::new(&packed, Traversal::default(), 3).unwrap();
        let (whole, rays) = renderer.render::<f32>(&view, &|_| (), &()).unwrap();
        for parts in [&[9][..], &[1, 8], &[4, 4, 1], &[3, 3, 3, 99]] {
            let mut picture = renderer.start::<f32>(&view).unwrap();
            parts.iter().for_each(|&count| renderer.add(&mut picture, count));
            let (film, counted) = picture.film().unwrap();
            assert!(picture.samples() == 9 && film.bits_equal(&whole), "{parts:?}");
            assert_eq!(counted, rays, "{parts:?}");
        }
    }

    #[test]
    fn a_picture_of_some_samples_is_their_mean_and_of_none_black() {
        let scene = lights();
        let packed = packed(&scene, Settings { size: (16, 12), samples: 2, bounces: 0, ..scene.settings });
        let view = View::new(&packed, &scene.cameras[0]).unwrap();
        let renderer = Renderer::new(&packed, Traversal::default(), 1).unwrap();
        let mut picture = renderer.start::<f32>(&view).unwrap();
        assert!(picture.film().unwrap().0.pixels.iter().all(|&pixel| pixel == [0.0; 3]));
        renderer.add(&mut picture, 1);
        let one = picture.film().unwrap().0;
        renderer.add(&mut picture, 3);
        let four = picture.film().unwrap().0;
        let brightness = |film: &Picture| film.pixels.as_flattened().iter().sum::<f32>() / film.pixels.len() as f32;
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
            if let Light::Point { position, colour } | Light::Spot { position, colour, .. } = light {
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
