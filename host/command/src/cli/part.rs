//! Parts of a picture: tiles and some of the samples.

use clap::Args;

use crate::error::{Error, Result};
use eyerays::view::{Region, View};

/// Which part of a picture is rendered.
#[derive(Args, Clone)]
#[command(next_help_heading = "Parts")]
pub(super) struct PartArgs {
    /// Render only this tile of the image, in pixels from the top left; a picture is of the tile alone
    #[arg(long, alias = "crop", value_name = "X,Y,W,H", value_parser = tile)]
    tile: Option<Region>,
    /// The first of each pixel's samples that is rendered, counted from 0
    #[arg(long, value_name = "A", conflicts_with = "repeat")]
    samples_from: Option<u32>,
    /// The one after the last, at most as many as a pixel has [default: all]
    #[arg(long, value_name = "B", conflicts_with = "repeat")]
    samples_to: Option<u32>,
}

impl PartArgs {
    /// Are there samples that it leaves out?
    pub fn has_some_samples(&self) -> bool {
        self.samples_from.is_some() || self.samples_to.is_some()
    }

    /// The part of a view.
    pub fn of(&self, view: &View) -> Result<View> {
        let (all, size) = (view.range(), view.size());
        let (from, to) = (self.samples_from.unwrap_or(all.start), self.samples_to.unwrap_or(all.end));
        if from >= to || to > all.end {
            let asked = format!("--samples-from {from} --samples-to {to}");
            return Err(Error::new(format!("{asked}: a pixel has the samples 0 to {}; --spp gives more", all.end)));
        }
        let tile = self.tile.unwrap_or(view.region());
        view.part(tile, from..to).map_err(|_| {
            let Region { x, y, width, height } = tile;
            Error::new(format!(
                "--tile {x},{y},{width},{height}: it is not within the image of {}x{} pixels",
                size.0, size.1
            ))
        })
    }
}

/// `X,Y,W,H`.
fn tile(text: &str) -> std::result::Result<Region, String> {
    let numbers: Vec<u32> = text.split(',').filter_map(|number| number.trim().parse().ok()).collect();
    match numbers[..] {
        [x, y, width, height] if text.split(',').count() == 4 => Ok(Region { x, y, width, height }),
        _ => Err("write left column, top row, width and height in pixels, for example 0,0,256,128".to_owned()),
    }
}
