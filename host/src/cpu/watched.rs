//! Pictures on the CPU that somebody may look on.

use eyerays_kernels_cpu::Number;

use super::render::{Growing, Renderer};
use crate::error::Result;
use crate::picture::Picture;
use crate::rays::Rays;
use crate::view::View;
use crate::watch::{Grows, Watch, grow};

/// A picture, its rays and the samples of each pixel.
pub(crate) fn rendered<R: Number>(
    renderer: &Renderer<'_>,
    view: &View,
    watch: Option<&Watch<'_>>,
    done: &(dyn Fn(u64) + Sync),
) -> Result<(Picture, Rays, u32)> {
    if let Some(watch) = watch {
        match renderer.start::<R>(view) {
            Ok(picture) => return watched(OnCpu { renderer, picture }, view, watch),
            // Without the memory that the sums of all pixels take, nobody can look on; but all samples at once fit no time.
            Err(error) if watch.limit.is_some() => return Err(error),
            Err(_) => {}
        }
    }
    let (film, rays) = renderer.render::<R>(view, done, &())?;
    Ok((film, rays, view.samples()))
}

/// A picture as somebody looks on, its rays and the samples of each pixel that there are in the end.
fn watched<R: Number>(mut growing: OnCpu<'_, R>, view: &View, watch: &Watch<'_>) -> Result<(Picture, Rays, u32)> {
    grow(&mut growing, view.samples(), watch)?;
    let (film, rays) = growing.picture.film()?;
    Ok((film, rays, growing.picture.samples()))
}

/// A picture that grows on a CPU.
struct OnCpu<'a, R: Number> {
    renderer: &'a Renderer<'a>,
    picture: Growing<R>,
}

impl<R: Number> Grows for OnCpu<'_, R> {
    fn add(&mut self, count: u32) -> Result<()> {
        self.renderer.add(&mut self.picture, count);
        Ok(())
    }

    fn picture(&mut self) -> Result<Picture> {
        Ok(self.picture.film()?.0)
    }
}
