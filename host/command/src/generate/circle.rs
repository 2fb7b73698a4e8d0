//! Points of a circle by arithmetic alone: the last bits of a library's sine differ from machine to machine.

use std::f64::consts::FRAC_PI_2;

/// The cosine and the sine of a number of whole turns.
pub fn turn(turns: f64) -> (f64, f64) {
    let quarters = (turns - turns.floor()) * 4.0;
    let nearest = (quarters + 0.5).floor();
    let angle = (quarters - nearest) * FRAC_PI_2;
    let (cosine, sine) = (series(angle, 0), angle * series(angle, 1));
    match nearest as u8 & 3 {
        0 => (cosine, sine),
        1 => (-sine, cosine),
        2 => (-cosine, -sine),
        _ => (sine, -cosine),
    }
}

/// Taylor's series of the cosine (`odd` 0) or of the sine over its angle (`odd` 1), for an eighth of a turn.
fn series(angle: f64, odd: i32) -> f64 {
    let square = angle * angle;
    (1..=8).rev().fold(1.0, |sum, k| {
        let k = 2 * k + odd;
        1.0 - sum * square / f64::from(k * (k - 1))
    })
}

#[cfg(test)]
mod tests {
    use super::turn;

    #[test]
    fn agrees_with_the_library_to_many_digits() {
        for step in -400..=400 {
            let turns = f64::from(step) / 160.0;
            let (sine, cosine) = (turns * std::f64::consts::TAU).sin_cos();
            let (x, y) = turn(turns);
            assert!((x - cosine).abs() < 1e-13 && (y - sine).abs() < 1e-13, "{turns}: {x} {y}");
        }
    }
}
