//! Angles, their sines and cosines from polynomials of `+` and `*`: the same bits on every device.

use super::{FAINT, Real, TINY};

/// Taylor's for the sine of f quarters of a turn, over f; largest error on [-1/2, 1/2] 1.8e-9 before rounding.
const SINE: [f32; 5] = [core::f32::consts::FRAC_PI_2, -0.645_964_1, 0.079_692_624, -0.004_681_754, 0.000_160_441_18];

/// Taylor's for the cosine, likewise; largest error 1.2e-10 before rounding.
const COSINE: [f32; 6] = [1.0, -1.233_700_5, 0.253_669_5, -0.020_863_48, 0.000_919_260_26, -0.000_025_202_042];

/// Fitted to the angle in turns whose tangent is t, over t, on [0, sqrt(2) - 1]; largest error of the angle 2.5e-9 before
/// rounding.
const ANGLE: [f32; 5] = [0.159_154_94, -0.053_050_794, 0.031_790_253, -0.022_045_312, 0.012_708_463];

/// A step of an angle that counts, in quarters of a turn.
const STEP: f32 = 1.0 / (1 << 24) as f32;

/// The cosine and the sine of an angle in steps of 2^-32 of a turn, of which the last six bits do not count. Each is within
/// 1.2e-7, and within 2e-7 of itself; quarters of a turn are exact.
#[inline(always)]
pub fn cos_sin(turns: u32) -> (f32, f32) {
    let shifted = turns.wrapping_add(1 << 29);
    // A whole number of 25 bits, so that every device converts it exactly.
    let within = ((shifted & 0x3fff_ffff) >> 6) as i32 - (1 << 23);
    let f = within as f32 * STEP;
    let square = f * f;
    let sine = (((SINE[4] * square + SINE[3]) * square + SINE[2]) * square + SINE[1]) * square + SINE[0];
    let cosine = ((COSINE[5] * square + COSINE[4]) * square + COSINE[3]) * square + COSINE[2];
    let (sine, cosine) = (f * sine, (cosine * square + COSINE[1]) * square + COSINE[0]);
    match shifted >> 30 {
        0 => (cosine, sine),
        1 => (-sine, cosine),
        2 => (-cosine, -sine),
        _ => (sine, -cosine),
    }
}

/// The angle of the point (x, y) from the first axis, in turns of [-1/2, 1/2], within 4e-8; eighths of a turn are exact, and
/// that of the origin is 0. A zero's sign does not count. Coordinates are zero or normal, and
/// at most 2^126.
#[inline(always)]
pub fn atan2(y: f32, x: f32) -> f32 {
    /// tan(1/16 turn): steeper slopes are measured from the diagonal.
    const STEEP: f32 = core::f32::consts::SQRT_2 - 1.0;
    let (width, height) = (x.abs(), y.abs());
    let is_upright = width < height;
    let (long, short) = if is_upright { (height, width) } else { (width, height) };
    // Of tiny numbers the difference below would be subnormal.
    let scale = if long < TINY { const { 1.0 / TINY } } else { 1.0 };
    let (long, short) = (long * scale, short * scale);
    let is_steep = long * STEEP < short;
    let (over, under) = if is_steep { (short - long, short + long) } else { (short, long) };
    let t = if under == 0.0 { 0.0 } else { Real::div(over, under).flush(FAINT) };
    let square = (t * t).flush(FAINT);
    let sum = (((ANGLE[4] * square + ANGLE[3]) * square + ANGLE[2]) * square + ANGLE[1]) * square + ANGLE[0];
    let within = if is_steep { 0.125 + t * sum } else { t * sum };
    let quarter = if is_upright { 0.25 - within } else { within };
    let half = if x < 0.0 { 0.5 - quarter } else { quarter };
    if y < 0.0 { -half } else { half }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarters_of_a_turn_are_exact() {
        let quarters = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
        for (i, (x, y)) in quarters.into_iter().enumerate() {
            let (cosine, sine) = cos_sin((i as u32) << 30);
            assert!(cosine == x && sine == y, "{i}: {cosine}, {sine}");
        }
    }

    /// All 2^26 angles that there are.
    #[test]
    fn errors_are_as_stated() {
        let (mut worst, mut relative) = (0f64, 0f64);
        for step in 0..1u32 << 26 {
            let angle = f64::from(step) / f64::from(1 << 26) * std::f64::consts::TAU;
            let (cosine, sine) = cos_sin(step << 6);
            for (got, want) in [(cosine, angle.cos()), (sine, angle.sin())] {
                let error = (f64::from(got) - want).abs();
                worst = worst.max(error);
                // The standard library's own error counts where the value is almost zero.
                relative = relative.max((error - 1e-15).max(0.0) / want.abs());
            }
        }
        println!("absolute {worst:e}, relative {relative:e}");
        assert!(worst <= 1.2e-7 && relative <= 2e-7, "absolute {worst:e}, relative {relative:e}");
    }

    #[test]
    fn eighths_of_a_turn_are_exact() {
        for i in -3..=4 {
            let (cosine, sine) = cos_sin((i as u32) << 29);
            let (x, y) = (cosine.signum() * cosine.abs().round(), sine.signum() * sine.abs().round());
            assert_eq!(atan2(y, x), i as f32 / 8.0, "({x}, {y})");
            assert_eq!(atan2(y * 1e37, x * 1e37), i as f32 / 8.0, "({x}, {y})");
        }
        assert_eq!((atan2(0.0, 0.0), atan2(-0.0, -0.0)), (0.0, 0.0));
    }
}
