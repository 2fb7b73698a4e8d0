//! What changes from picture to picture of a scene: nothing here touches geometry, hierarchies or kernels.

use std::ops::Range;

use eyerays_shader::camera::{self, FILTER_STEPS};
use eyerays_shader::data::{Frame, Launch, Order, Projection, numbers};
use eyerays_shader::photon::LISTS;
use eyerays_shader::stage::{FilmWords, film_words};
use serde::{Deserialize, Serialize};

use crate::device_scene::casters_extent;
use crate::error::{Error, Result};
use crate::film::Part;
use crate::job::Job;
use crate::optics::CameraRecord;
use crate::picture::Picture;
use crate::scene::{Camera, Settings};

/// A rectangle of the image in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Region {
    /// Left column.
    pub x: u32,
    /// Top row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Region {
    /// How many pixels there are.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Cut into pieces of so many columns and rows, smaller at the right and at the bottom; row by row.
    pub fn pieces(self, columns: u32, rows: u32) -> impl Iterator<Item = Region> {
        let Region { x: left, y: top, width, height } = self;
        let corners = (0..height).step_by(rows as usize);
        let corners = corners.flat_map(move |y| (0..width).step_by(columns as usize).map(move |x| (x, y)));
        corners.map(move |(x, y)| Region {
            x: left + x,
            y: top + y,
            width: (width - x).min(columns),
            height: (height - y).min(rows),
        })
    }

    /// The least region that holds both.
    pub fn around(&self, other: Region) -> Region {
        let (x, y) = (self.x.min(other.x), self.y.min(other.y));
        // What a file says may be anything.
        let end = |of: &Region| (of.x.saturating_add(of.width), of.y.saturating_add(of.height));
        let ((right, bottom), (other_right, other_bottom)) = (end(self), end(&other));
        Region { x, y, width: right.max(other_right) - x, height: bottom.max(other_bottom) - y }
    }
}

/// A camera, the size of its image, what of the image is rendered, and which samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    record: CameraRecord,
    width: u32,
    height: u32,
    /// Edge of the grid that a pixel's samples lie in, 1 without a grid.
    grid: u32,
    window: Region,
    /// The first of a pixel's samples that is rendered.
    first: u32,
    /// The one after the last.
    end: u32,
    /// What its films keep beside light, see [`Launch`].
    film: u32,
    /// Arbitrary output variables of its films.
    aovs: u32,
    /// Is all that it shows as the shutter opens?
    opens: bool,
}

impl View {
    /// A camera in a scene, with an image of the size and samples of the scene's settings.
    ///
    /// # Errors
    /// There is no way to look so, the camera is too far away for the scene's numbers, or no camera of the scene has such a lens or
    /// projection.
    pub fn new(packed: &Job, camera: &Camera) -> Result<View> {
        View::seen(packed, camera, packed.settings())
    }

    /// A camera in a scene, with an image of `width` x `height` pixels and `samples` x `samples` samples a pixel.
    ///
    /// # Errors
    /// As [`View::new`]; or a size that [`Picture::check_size`] refuses, or no sample or too many.
    pub fn of(packed: &Job, camera: &Camera, size: (u32, u32), samples: u32) -> Result<View> {
        crate::error::within("samples", &[samples], 1..=Settings::MOST_SAMPLES)?;
        View::seen(packed, camera, &Settings { size, samples, spp: 0, ..*packed.settings() })
    }

    fn seen(packed: &Job, camera: &Camera, settings: &Settings) -> Result<View> {
        let (width, height) = settings.size;
        Picture::check_size(width, height)?;
        let grid = settings.grid()?;
        let record = CameraRecord::new(packed, camera, (width, height), grid)?;
        let window = Region { x: 0, y: 0, width, height };
        Ok(View {
            record,
            width,
            height,
            grid,
            window,
            first: 0,
            end: settings.samples_a_pixel(),
            film: packed.film_bits(),
            aovs: packed.aov_count(),
            opens: false,
        })
    }

    /// The image's width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// A part of it: these samples of the pixels of a region. All parts together, in any partition, have the bits of the whole
    /// ([`Film::merge`](crate::film::Film::merge)).
    ///
    /// # Errors
    /// Nothing of it is in the view.
    pub fn part(&self, region: Region, samples: Range<u32>) -> Result<View> {
        let (Region { x, y, width, height }, window) = (region, self.window);
        if region.pixels() == 0 || window.around(region) != window {
            let whole = format!("{}x{} pixels at {},{}", window.width, window.height, window.x, window.y);
            return Err(Error::new(format!("a tile of {width}x{height} pixels at {x},{y} is not within the {whole}")));
        }
        let Range { start, end } = samples;
        if start >= end || start < self.first || end > self.end {
            let whole = format!("{} to {}", self.first, self.end);
            return Err(Error::new(format!("samples {start} to {end} are not some of the samples {whole}")));
        }
        Ok(View { window: region, first: start, end, ..*self })
    }

    /// The same of the moment in which the shutter opens.
    #[must_use]
    pub(crate) fn as_it_opens(self) -> View {
        View { opens: true, ..self }
    }

    /// All that its rays of the camera depend on beside the image and tables.
    pub(crate) fn camera_bytes(&self) -> Vec<u8> {
        let CameraRecord { camera, spread, angle, aperture, clip, eyes, keys, .. } = &self.record;
        // How it moves is told by the scene; whether it does, by what stands in the place of nothing.
        let moves = if *keys == Frame::STILL { 0.0 } else { 1.0 };
        [bytemuck::bytes_of(camera), bytemuck::cast_slice(&[[*spread, *angle], [*aperture, moves], *clip, *eyes])]
            .concat()
    }

    /// What is rendered: the whole image, unless it is a part.
    pub fn region(&self) -> Region {
        self.window
    }

    /// These samples of all pixels that are rendered.
    pub fn samples_of(&self, samples: Range<u32>) -> Part {
        Part { region: self.window, samples }
    }

    /// All that is rendered.
    pub fn whole(&self) -> Part {
        Part { region: self.window, samples: self.range() }
    }

    /// Words of a pixel of its film where noise is told.
    pub(crate) fn noisy_film_words(&self) -> FilmWords {
        FilmWords { light: film_words(Launch(self.film), true), aovs: self.aovs }
    }

    /// How many samples of a pixel are rendered, in both directions together.
    pub fn samples(&self) -> u32 {
        self.end - self.first
    }

    /// Which of a pixel's samples.
    pub fn range(&self) -> Range<u32> {
        self.first..self.end
    }

    /// The record of a launch in a scene: `count` samples of a region, from sample `first` on.
    pub fn launch(&self, scene: &Job, region: Region, first: u32, count: u32, order: Order) -> Frame {
        let pixel_slots = camera::slots(region.width, region.height, order);
        let CameraRecord {
            camera,
            spread,
            angle,
            aperture,
            clip: [near, farthest],
            eyes: [eyes, converging],
            keys,
            inside,
        } = self.record;
        let frame = scene.frame();
        let (exposure, delayed) = if self.opens { (0.0, 0.0) } else { (frame.exposure, 1.0 - frame.exposure) };
        Frame {
            camera,
            spread,
            angle,
            aperture,
            near,
            farthest,
            eyes,
            converging,
            keys,
            media: frame.media | inside,
            exposure,
            row_delay: delayed / self.height as f32,
            filter_steps: FILTER_STEPS as f32 / (2 * self.grid) as f32,
            width: self.width,
            height: self.height,
            samples: self.grid,
            sample: first,
            left: region.x,
            top: region.y,
            columns: region.width,
            across: camera::across(region.width, order),
            rows: region.height,
            pixel_slots,
            slots: count * pixel_slots,
            photons: self.photons(scene),
            heads: lists(self.photons(scene), count),
            radius: self.radius(scene),
            ..frame
        }
    }

    /// How many photons each sample has, see [`Job::photons`].
    pub fn photons(&self, scene: &Job) -> u32 {
        scene.photons((self.width, self.height))
    }

    /// The record of a launch of the photons of `count` samples, from sample `first` on.
    pub fn launch_of_photons(&self, scene: &Job, first: u32, count: u32, order: Order) -> Frame {
        let frame = self.launch(scene, self.window, first, count, order);
        Frame { pixel_slots: frame.photons, slots: count * frame.photons, ..frame }
    }

    /// How far the first sample of a pixel looks for photons, in the normalised scene: a pixel where casters are.
    fn radius(&self, scene: &Job) -> f32 {
        /// Cells of a grid are numbers of single precision.
        const LEAST: f32 = 1.0 / (1 << 18) as f32;
        let Some((middle, reach)) = casters_extent(scene.casters()) else { return 0.0 };
        let eye = numbers(self.record.camera.eye);
        let is_parallel = self.record.camera.eye.w == Projection::PARALLEL;
        // Who is among them looks at what is as far away as they reach.
        let distance = if is_parallel { 1.0 } else { eye.distance(middle).max(0.5 * reach) };
        (self.record.spread * self.grid as f32 * distance).clamp(LEAST, 0.125)
    }
}

/// Lists of the grid of so many photons of each of some samples: a power of two, at most two for each.
fn lists(photons: u32, samples: u32) -> u32 {
    let most = u64::from(LISTS) * u64::from(photons) * u64::from(samples);
    if most == 0 { 0 } else { 1 << most.ilog2().min(31) }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::cpu;
    use crate::method::Traversal;
    use crate::quality::Bvh;
    use crate::scene::{self, Background, Projection, Scene};
    use crate::scene_io;

    /// A square of edge 1 seen from so far away before black, and how many of 64 x 64 pixels it covers.
    fn covered(projection: Projection, distance: f32) -> usize {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/lights.toml");
        let (of, _) = scene_io::load(path.as_ref()).unwrap();
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let mut scene = Scene { background: Background::Colour(Vec3::ZERO), ambient: Vec3::ONE, ..of };
        scene.mesh = scene::Mesh {
            positions: vec![corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            materials: vec![0; 2],
            ..scene::Mesh::default()
        };
        scene.objects.clear();
        scene.spheres.clear();
        scene.disks.clear();
        let camera = &mut scene.cameras[0];
        (camera.eye, camera.target, camera.projection) = (Vec3::Z * distance, Vec3::ZERO, projection);
        let settings = Settings { size: (64, 64), samples: 1, bounces: 0, ..scene.settings };
        let packed = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
        let view = View::new(&packed, &scene.cameras[0]).unwrap();
        let picture = cpu::render::<f32>(&packed, &view, Traversal::default(), 1, &|_| ()).unwrap().0;
        picture.pixels.iter().filter(|pixel| pixel.iter().any(|&v| v > 0.0)).count()
    }

    #[test]
    fn an_orthographic_camera_sees_a_thing_as_large_from_anywhere() {
        let orthographic = Projection::Orthographic { height: 2.0 };
        assert_eq!([0.5, 3.0, 1000.0].map(|distance| covered(orthographic, distance)), [32 * 32; 3]);
        let [near, far] = [3.0, 12.0].map(|distance| covered(Projection::Perspective { fov: 30.0 }, distance));
        assert!(near > 12 * far, "{near} {far}");
    }

    #[test]
    fn a_scene_without_orthographic_cameras_has_no_kernel_for_one() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/lights.toml");
        let (scene, _) = scene_io::load(path.as_ref()).unwrap();
        let packed = Job::new(&scene, scene.settings, Bvh::Fast.quality()).unwrap();
        let camera = Camera { projection: Projection::Orthographic { height: 1.0 }, ..scene.cameras[0].clone() };
        let message = View::new(&packed, &camera).unwrap_err().to_string();
        assert!(message.contains("add it to the scene's cameras before it is packed"), "{message}");
    }
}
