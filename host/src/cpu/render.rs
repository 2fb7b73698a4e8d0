//! Whole pictures.

use std::sync::Mutex;

use eyerays_shader::real::Scalar;
use eyerays_shader::stage::{NON_FINITE, RECORDS};
use rayon::prelude::*;

use super::isa::Isa;
use super::pool::pool;
use super::tile::{Observer, render_tile_by};
use crate::error::Result;
use crate::film::Film;
use crate::method::Traversal;
use crate::pack::{Laid, Packed, Region};
use crate::rays::Rays;

/// Memory for the waiting rays of a tile, in bytes, that makes a tile smaller than [`TILE`].
const PATH_MEMORY: u64 = 64 << 20;
/// A tile's edge in pixels.
const TILE: u32 = 32;

/// A scene laid out for the CPU, with the threads to render it: made once for any number of pictures.
pub struct Renderer<'a> {
    laid: Laid<'a>,
    isa: Isa,
    threads: rayon::ThreadPool,
}

impl<'a> Renderer<'a> {
    /// Starts `threads` threads (0: one a core) and makes what the traversal needs beside the packed scene, such as
    /// wide nodes.
    ///
    /// # Errors
    /// If the threads can't be started.
    pub fn new(packed: &'a Packed, traversal: impl Into<Traversal>, threads: usize) -> Result<Self> {
        let threads = pool(threads)?;
        let traversal = traversal.into();
        let laid = threads.install(|| Laid::new(packed, traversal));
        Ok(Renderer { laid, isa: Isa::best(), threads })
    }

    /// Renders a picture in the arithmetic `R`. `done` hears of every finished share of the pixels, and `observer`
    /// looks on.
    ///
    /// # Errors
    /// If there is no memory for the film.
    pub fn render<R>(&self, done: &(dyn Fn(u64) + Sync), observer: &dyn Observer<R>) -> Result<(Film, Rays)>
    where
        R: Scalar<Record: Send + Sync>,
    {
        let packed = self.laid.packed;
        let (width, height) = packed.settings.size;
        let result = Mutex::new((Film::new(width, height)?, Rays::default()));
        self.threads.install(|| {
            // A tile a task: coarser splitting leaves threads idle at the end.
            tiles(packed).into_par_iter().with_max_len(1).for_each(|region| {
                let (film, secondary) = render_tile_by(self.isa, &self.laid, region, observer);
                let (image, rays) = &mut *result.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                keep::<R>(region, &film, image, rays);
                rays.secondary += secondary;
                rays.primary += u64::from(region.width * region.height) * u64::from(packed.samples());
                done(u64::from(region.width * region.height));
            });
        });
        Ok(result.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner))
    }
}

/// One picture: [`Renderer::new`] and [`Renderer::render`].
///
/// # Errors
/// If the film or the threads can't be had.
pub fn render<R>(
    packed: &Packed,
    traversal: impl Into<Traversal>,
    threads: usize,
    done: &(dyn Fn(u64) + Sync),
) -> Result<(Film, Rays)>
where
    R: Scalar<Record: Send + Sync>,
{
    Renderer::new(packed, traversal, threads)?.render::<R>(done, &())
}

fn tiles(packed: &Packed) -> Vec<Region> {
    let (width, height) = packed.settings.size;
    let slot = u64::from(packed.levels()) * u64::from(RECORDS) * 32;
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

/// Copies a tile's film into the image and counts.
fn keep<R: Scalar>(region: Region, film: &[R::Record], image: &mut Film, rays: &mut Rays) {
    for (row, line) in film.chunks_exact(region.width as usize).enumerate() {
        let start = (region.y as usize + row) * image.width as usize + region.x as usize;
        for (pixel, &record) in image.pixels[start..].iter_mut().zip(line) {
            let (colour, word) = R::load(record);
            *pixel = [colour.x.to_f32(), colour.y.to_f32(), colour.z.to_f32()];
            rays.shadow += u64::from(word & !NON_FINITE);
            rays.non_finite += u64::from(word & NON_FINITE != 0);
        }
    }
}
