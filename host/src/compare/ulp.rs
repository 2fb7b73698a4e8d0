//! Distances counted in representable numbers.

/// How many steps from one `f32` to the next lead from `a` to `b`: 0 for equal values, of which
/// 0 and -0 are two, and `u32::MAX` if either is NaN and the bits differ. All other pairs are at
/// most 0xff00_0000 apart, the distance of the infinities.
pub fn ulp_distance(a: f32, b: f32) -> u32 {
    if a.to_bits() == b.to_bits() {
        0
    } else if a.is_nan() || b.is_nan() {
        u32::MAX
    } else {
        ordered(a).abs_diff(ordered(b))
    }
}

/// An integer in the order of the floats, consecutive for neighbours, and 0 for both zeros.
fn ordered(value: f32) -> i32 {
    let magnitude = value.abs().to_bits() as i32;
    if value.is_sign_negative() { -magnitude } else { magnitude }
}
