//! When the shutter is open, as the command line says it.

use eyerays::scene_io::Shutter;

/// From when to when it is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Open {
    /// In pictures of a sequence.
    Frames(f64, f64),
    /// In seconds.
    Seconds(f64, f64),
}

impl Open {
    /// For so many pictures a second, with the share of the time that each row is exposed.
    pub fn shutter(self, rate: f64, rolling: Option<f64>) -> Shutter {
        let (open, close) = match self {
            Open::Frames(open, close) => (open / rate, close / rate),
            Open::Seconds(open, close) => (open, close),
        };
        Shutter { open, close, rolling: rolling.unwrap_or(1.0) }
    }
}

/// `A,B`, `B` for `0,B`, both with an s behind them for seconds.
pub(super) fn open(text: &str) -> Result<Open, String> {
    let help = "write when it opens and closes, for example 0,0.5, or 0,0.02s for seconds";
    let (numbers, is_seconds) = text.strip_suffix('s').map_or((text, false), |numbers| (numbers, true));
    let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite() && number.abs() < 1e9);
    let (open, close) = numbers.split_once(',').unwrap_or(("0", numbers));
    let (Some(open), Some(close)) = (number(open), number(close)) else { return Err(help.into()) };
    if close < open {
        return Err(format!("it closes before it opens; {help}"));
    }
    Ok(if is_seconds { Open::Seconds(open, close) } else { Open::Frames(open, close) })
}

/// A number from 0 to 1.
pub(super) fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| "write a number from 0 to 1, for example 0.1".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shutter_is_told_in_pictures_or_seconds() {
        assert_eq!(open("0,0.5"), Ok(Open::Frames(0.0, 0.5)));
        assert_eq!(open("-0.25, 0.25"), Ok(Open::Frames(-0.25, 0.25)));
        assert_eq!(open("0.5"), Ok(Open::Frames(0.0, 0.5)));
        assert_eq!(open("0,0.02s"), Ok(Open::Seconds(0.0, 0.02)));
        for wrong in ["", "a,b", "1,0", "0,nan", "0,1,2", "0,1e300", "1s,2s"] {
            assert!(open(wrong).unwrap_err().contains("0,0.5"), "{wrong}");
        }
        assert!(share("1.5").is_err() && share("NaN").is_err() && share("0.25") == Ok(0.25));
        let Shutter { open, close, rolling } = Open::Frames(0.0, 0.5).shutter(25.0, None);
        assert_eq!((open, close, rolling), (0.0, 0.02, 1.0));
    }
}
