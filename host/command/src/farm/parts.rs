//! A picture divided among machines.

use std::fmt;
use std::ops::Range;

use crate::error::{Error, Result, within};

/// The most parts: an Open Job Description template lists no more values of a parameter.
pub const MOST_PARTS: u32 = 1024;

/// The parts of a picture, in order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Parts {
    /// Some of the samples of every pixel each: so many samples in so many parts.
    Samples {
        /// Of a pixel.
        samples: u32,
        /// How many parts.
        count: u32,
    },
    /// All samples of a band of rows each.
    Bands {
        /// Of the picture, in pixels.
        size: (u32, u32),
        /// How many parts.
        count: u32,
    },
}

impl Parts {
    /// Divides a picture of a size and so many samples of a pixel: by samples, or by rows where there are fewer samples than parts.
    ///
    /// # Errors
    /// No parts, or more than [`MOST_PARTS`] or than there are samples and rows.
    pub fn new(count: u32, samples: u32, size: (u32, u32)) -> Result<Self> {
        within("--parts", &[count], 1..=MOST_PARTS)?;
        if samples >= count {
            Ok(Parts::Samples { samples, count })
        } else if size.1 >= count {
            Ok(Parts::Bands { size, count })
        } else {
            let most = samples.max(size.1);
            Err(Error::new(format!(
                "--parts {count}: the picture has {samples} samples of a pixel and {} rows; ask for at most {most}",
                size.1
            )))
        }
    }

    /// How many parts there are.
    pub fn count(&self) -> u32 {
        match *self {
            Parts::Samples { count, .. } | Parts::Bands { count, .. } => count,
        }
    }

    /// The first sample or row of each part, and the one after its last.
    pub fn ranges(&self) -> impl Iterator<Item = Range<u32>> {
        let (all, count) = match *self {
            Parts::Samples { samples, count } => (samples, count),
            Parts::Bands { size, count } => (size.1, count),
        };
        let start = move |part: u32| (u64::from(part) * u64::from(all) / u64::from(count)) as u32;
        (0..count).map(move |part| start(part)..start(part + 1))
    }
}

impl fmt::Display for Parts {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (count, ends) = (self.count(), if self.count() == 1 { "" } else { "s" });
        match self {
            Parts::Samples { samples, .. } => write!(out, "{count} part{ends} of the {samples} samples of each pixel"),
            Parts::Bands { size: (_, rows), .. } => write!(out, "{count} part{ends} of the {rows} rows"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_follow_each_other_and_differ_by_one_at_most() {
        for (count, samples, height) in [(1, 1, 1), (8, 512, 10), (7, 512, 10), (7, 3, 10), (1024, 16_777_216, 1)] {
            let parts = Parts::new(count, samples, (30, height)).unwrap();
            let ranges: Vec<_> = parts.ranges().collect();
            let all = if samples >= count { samples } else { height };
            assert_eq!((ranges.len() as u32, ranges[0].start, ranges.last().unwrap().end), (count, 0, all));
            assert!(ranges.windows(2).all(|pair| pair[0].end == pair[1].start), "{ranges:?}");
            assert!(ranges.iter().all(|range| [all / count, all.div_ceil(count)].contains(&(range.end - range.start))));
        }
    }

    #[test]
    fn more_parts_than_samples_are_bands_and_more_than_rows_are_refused() {
        assert_eq!(Parts::new(8, 8, (30, 20)), Ok(Parts::Samples { samples: 8, count: 8 }));
        assert_eq!(Parts::new(8, 7, (30, 20)), Ok(Parts::Bands { size: (30, 20), count: 8 }));
        let refused = Parts::new(21, 4, (30, 20)).unwrap_err().to_string();
        assert_eq!(refused, "--parts 21: the picture has 4 samples of a pixel and 20 rows; ask for at most 20");
        for count in [0, MOST_PARTS + 1] {
            assert!(Parts::new(count, 1 << 20, (30, 20)).is_err(), "{count}");
        }
    }
}
