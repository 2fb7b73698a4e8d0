//! Films back from the GPU: as they are, or developed where they arrive.

use std::borrow::Cow;

use eyerays_shader::resources::binding;

use super::{Band, Growing, Renderer};
use crate::error::Result;
use crate::film::{Developer, Film};
use crate::picture::Picture;
use crate::rays::Rays;
use crate::view::Region;

/// Bytes of films that are read back at once.
const READ: u64 = 1 << 28;

/// Words as they lie there, unless they lie crooked.
pub(super) fn whole_words(bytes: &[u8]) -> Cow<'_, [u32]> {
    let words = bytemuck::try_cast_slice::<u8, u32>(bytes);
    words.map_or_else(|_| bytemuck::pod_collect_to_vec(bytes).into(), Cow::Borrowed)
}

impl Renderer {
    /// Waits for the samples so far, and reads their film.
    ///
    /// # Errors
    /// What the GPU reports, or if there is no memory for the film.
    ///
    /// # Panics
    /// If no film was started.
    pub fn film(&mut self) -> Result<Film> {
        let Growing { view, coverage, .. } = self.growing.as_ref().expect("a film was started");
        let mut film = Film::new(view, self.plan.film_words);
        film.set_coverage(coverage.clone());
        let secondary = self.read(|region, sums| film.add_sums(region, sums))?;
        film.add_rays(secondary);
        Ok(film)
    }

    /// Waits for a picture of which all samples were added, and develops it where it arrives: that saves a film of host memory, which
    /// takes longer than all else.
    pub(super) fn develop(&mut self) -> Result<(Picture, Rays)> {
        let Growing { view, bands, .. } = self.growing.as_ref().expect("a film was started");
        let (view, words) = (*view, self.plan.film_words);
        let Region { y: top, width, height, .. } = view.region();
        if bands.iter().any(|band| band.region.width != width) {
            return self.film()?.developed();
        }
        let mut developer = Developer::new(width, height)?;
        let counts = vec![view.samples(); width as usize];
        let secondary = self.read(|region, sums| {
            developer.rows(region.y - top, words, sums, |_| &counts);
            Ok(())
        })?;
        let (picture, rays) = developer.done(words);
        Ok((picture, Rays { primary: view.whole().volume(), secondary, ..rays }))
    }

    /// Reads the sums of each region that has any, in the order of their rows, and tells how many secondary rays there were.
    fn read(&mut self, mut look: impl FnMut(Region, &[u32]) -> Result<()>) -> Result<u64> {
        let Growing { bands, .. } = self.growing.as_ref().expect("a film was started");
        let bands: Vec<&Band> = bands.iter().filter(|band| !band.is_empty).collect();
        let counters = self.buffers().of(binding::COUNTERS).clone();
        let size = |band: &Band| self.plan.film_bytes() * band.region.pixels();
        let (mut rest, mut secondary, mut looked) = (&bands[..], 0, Ok(()));
        while !rest.is_empty() {
            let mut bytes = 0;
            let fits = |band: &&&Band| {
                bytes += size(band);
                bytes <= READ
            };
            let (now, later) = rest.split_at(rest.iter().take_while(fits).count().max(1));
            let films: Vec<_> = now.iter().map(|band| (&band.film, size(band))).collect();
            secondary = self.queue.read(&counters, &films, |i, bytes| {
                let sums = whole_words(bytes);
                if looked.is_ok() {
                    looked = look(now[i].region, &sums);
                }
            })?;
            rest = later;
        }
        looked.map(|()| secondary)
    }
}
