//! A difference or a product and what its rounding took off are exact together, and the same bits in every lane.

use super::{F32xN, FAINT, Fast, Lanes, Real};
use core::array::from_fn;
use proptest::prelude::*;

/// Of any sign and any of these exponents, often with few bits or with all.
fn number(least: i32, greatest: i32) -> impl Strategy<Value = f32> {
    let bits = prop_oneof![0u32..1 << 23, Just(0), Just((1 << 23) - 1), (0u32..23).prop_map(|i| 1 << i)];
    let zero = prop_oneof![9 => Just(false), 1 => Just(true)];
    (least..greatest, bits, any::<bool>(), zero).prop_map(|(exponent, bits, minus, zero)| {
        let size = f32::from_bits(((exponent + 127) as u32) << 23 | bits);
        if zero {
            0.0
        } else if minus {
            -size
        } else {
            size
        }
    })
}

/// Whole steps of 2^-72, in which all numbers of at least 2^-49 are.
fn steps(x: f32) -> i128 {
    let scaled = f64::from(x) * 2f64.powi(72);
    assert!(scaled.fract() == 0.0 && scaled.abs() < 2f64.powi(126));
    scaled as i128
}

/// What a product's rounding takes off, exactly.
fn rest(x: f32, y: f32) -> f64 {
    f64::from(x) * f64::from(y) - f64::from(x * y)
}

proptest! {
    #![proptest_config(ProptestConfig { max_global_rejects: 1 << 20, ..ProptestConfig::with_cases(200_000) })]

    #[test]
    fn a_difference_and_its_rest_are_exact(x in number(-49, 50), y in number(-49, 50)) {
        let (difference, rest) = x.difference_and_rest(y);
        prop_assert_eq!(difference.to_bits(), (x - y).to_bits());
        prop_assert_eq!(steps(difference) + steps(rest), steps(x) - steps(y));
    }

    /// Neighbours, where all of the difference is exact, and numbers of one size.
    #[test]
    fn a_difference_of_neighbours_and_its_rest_are_exact(x in number(-20, 20), apart in -5i32..5, more: bool) {
        let y = f32::from_bits(x.to_bits().saturating_add_signed(if more { apart << 12 } else { apart }));
        prop_assume!(y.abs() >= 2f32.powi(-21) && y.is_finite());
        let (difference, rest) = x.difference_and_rest(y);
        prop_assert_eq!(steps(difference) + steps(rest), steps(x) - steps(y));
    }

    /// A product of two such numbers has 48 bits, so double precision has them all.
    #[test]
    fn a_product_and_its_rest_are_exact(x in number(-63, 63), y in number(-63, 63)) {
        let (product, got) = x.product_and_rest(y);
        prop_assert_eq!(product.to_bits(), (x * y).to_bits());
        let want = rest(x, y);
        prop_assert_eq!(f64::from(got), if want.abs() < f64::from(FAINT) { 0.0 } else { want });
    }

    /// As far as the operands may go.
    #[test]
    fn a_product_of_extremes_and_its_rest_are_exact(x in number(-100, 100), y in number(-100, 100)) {
        let exponents = x.abs().log2() + y.abs().log2();
        prop_assume!(x == 0.0 || y == 0.0 || exponents < 127.0 && exponents > -124.0);
        let (product, got) = x.product_and_rest(y);
        prop_assert_eq!(product.to_bits(), (x * y).to_bits());
        let want = rest(x, y);
        prop_assert_eq!(f64::from(got), if want.abs() < f64::from(FAINT) { 0.0 } else { want });
    }

    #[test]
    fn lanes_have_the_rests_of_their_numbers(
        x in prop::array::uniform8(number(-63, 63)), y in prop::array::uniform8(number(-63, 63)),
    ) {
        assert_lanes::<F32xN<8>>(&x, &y);
        assert_lanes::<F32xN<4>>(&x, &y);
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            assert_lanes::<super::Eight>(&x, &y);
            assert_lanes::<super::Four>(&x, &y);
        }
    }
}

/// Each lane has the bits of its number alone.
fn assert_lanes<L: Lanes<f32>>(x: &[f32; 8], y: &[f32; 8]) {
    let (a, b) = (L::taken(x), L::taken(y));
    let (difference, off) = a.difference_and_rest(b);
    let (product, rest) = a.product_and_rest(b);
    for i in 0..L::COUNT as usize {
        let got = [difference.lane(i), off.lane(i), product.lane(i), rest.lane(i)].map(f32::to_bits);
        let (alone, apart) = (x[i].difference_and_rest(y[i]), x[i].product_and_rest(y[i]));
        let zero = |bits: u32| if bits == 1 << 31 { 0 } else { bits };
        // A rest of zero is added to others, whatever its sign.
        let want = [alone.0, alone.1, apart.0, apart.1].map(f32::to_bits);
        assert_eq!(got.map(zero), want.map(zero), "{} and {}", x[i], y[i]);
        assert_eq!((got[0], got[2]), (want[0], want[2]));
    }
}

#[test]
fn hand_calculated_rests() {
    let step = f32::EPSILON;
    assert_eq!(1.0.difference_and_rest(-step / 4.0), (1.0, step / 4.0));
    assert_eq!((step / 4.0).difference_and_rest(1.0), (-1.0, step / 4.0));
    assert_eq!((1.0 + step).product_and_rest(1.0 + step), (1.0 + 2.0 * step, step * step));
    assert_eq!(3.0.product_and_rest(0.25), (0.75, 0.0));
    assert_eq!(f32::product_and_rest(1e-20, 1.1e-20).1, 0.0, "so small a rest counts as zero");
}

/// Where precision is not exact they have none.
#[test]
fn fast_numbers_have_no_rests() {
    let (x, y): ([f32; 2], [f32; 2]) = (from_fn(|i| 1.1 + i as f32), from_fn(|i| 0.3 - i as f32));
    for (x, y) in x.into_iter().zip(y) {
        assert_eq!(Fast(x).difference_and_rest(Fast(y)), (Fast(x - y), Fast(0.0)));
        assert_eq!(Fast(x).product_and_rest(Fast(y)), (Fast(x * y), Fast(0.0)));
    }
}
