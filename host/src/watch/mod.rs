//! Films that grow by samples while somebody looks on, and end early where that is wanted.

mod grower;
mod grows;
#[cfg(test)]
mod tests;

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use crate::error::Result;
use crate::film::Film;
use crate::picture::Picture;

pub(crate) use grower::go_on;
pub(crate) use grows::Grows;

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
