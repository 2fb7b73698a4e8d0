//! The guarantees of every implementation.

use super::{F32xN, FAINT, Fast, Lanes, Mask, Real, SMALL, Scalar, TINY, V3};
use core::array::from_fn;

const SAMPLES: [f32; 9] = [-3.0, -1.0, -0.5, -0.0, 0.0, 0.25, 1.0, 2.0, 8.0];

fn pairs() -> impl Iterator<Item = (f32, f32)> {
    SAMPLES.into_iter().flat_map(|a| SAMPLES.into_iter().map(move |b| (a, b)))
}

/// Sums and products of the samples are exact, so all numbers agree with `f32`.
fn arithmetic_and_order<R: Scalar>() {
    for (x, y) in pairs() {
        let (a, b) = (R::splat(x), R::splat(y));
        assert_eq!(((a + b).to_f32(), (a - b).to_f32(), (a * b).to_f32()), (x + y, x - y, x * y), "{x} {y}");
        assert_eq!((a.lt(b), a.le(b), a.eq(b)), (x < y, x <= y, x == y), "{x} {y}");
        assert_eq!((a.min(b).to_f32(), a.max(b).to_f32()), (x.min(y), x.max(y)), "{x} {y}");
        assert_eq!((a.lesser(b).to_f32(), a.greater(b).to_f32()), (x.min(y), x.max(y)), "{x} {y}");
        assert_eq!((a.fused(b, R::splat(0.5))).to_f32(), x * y + 0.5, "{x} {y}");
        assert_eq!(((-a).to_f32(), a.abs().to_f32()), (-x, x.abs()));
        assert_eq!(R::select(x < y, a, b).to_f32(), if x < y { x } else { y });
        let (v, limit) = (V3::new(a, b, R::splat(1.0)), R::splat(4.0));
        assert_eq!(R::max_entry(v).to_f32(), x.max(y).max(1.0));
        assert_eq!(R::min_exit(v, limit).to_f32(), x.min(y).min(1.0));
    }
    assert_eq!(R::splat(3.0).div(R::splat(2.0)).to_f32(), 1.5);
    assert_eq!((R::splat(-4.0).reciprocal().to_f32(), R::splat(6.25).sqrt().to_f32()), (-0.25, 2.5));
    let (one, roundoff) = (R::splat(1.0), R::ROUNDOFF);
    assert!((one + roundoff).eq(one) && one.lt(one + (roundoff + roundoff)), "half the distance to the next number");
}

fn powers_and_whole_numbers<R: Scalar>() {
    let pow = |x: f32, e: f32| R::splat(x).pow(R::splat(e)).to_f32();
    assert!((pow(0.25, 1.5) - 0.125).abs() < 1e-6);
    assert_eq!((pow(0.0, 0.0), pow(0.5, 0.0), pow(0.0, 2.0), pow(1.0, 9.0)), (1.0, 1.0, 0.0, 1.0));
    for (x, floor) in [(-1.5, -2), (-1.0, -1), (0.75, 0), (2.0, 2), (1e30, 8_388_608), (-1e30, -8_388_608)] {
        assert_eq!(R::splat(x).floor_index(), floor, "{x}");
    }
    assert!(R::splat(1.0).is_finite() && !R::splat(f32::INFINITY).is_finite() && !R::splat(f32::NAN).is_finite());
}

fn small_numbers_and_records<R: Scalar>() {
    let flushed = |x: f32| R::splat(x).flush(TINY).to_f32();
    assert_eq!((flushed(TINY), flushed(-TINY), flushed(0.75 * TINY), flushed(-0.75 * TINY)), (TINY, -TINY, 0.0, 0.0));
    assert_eq!(R::splat(2.0).flush_if_exact(1.0).to_f32(), 2.0);
    let (v, word) = R::load(R::store(V3::new(R::splat(1.0), R::splat(-2.0), R::splat(0.5)), 77));
    assert_eq!((v.x.to_f32(), v.y.to_f32(), v.z.to_f32(), word), (1.0, -2.0, 0.5, 77));
}

fn vectors<R: Scalar>() {
    let v = |x: f32, y: f32, z: f32| V3::new(R::splat(x), R::splat(y), R::splat(z));
    let of = |v: V3<R>| [v.x.to_f32(), v.y.to_f32(), v.z.to_f32()];
    let (a, b) = (v(1.0, -2.0, 3.0), v(4.0, 0.5, -1.0));
    assert_eq!((of(a + b), of(a - b)), ([5.0, -1.5, 2.0], [-3.0, -2.5, 4.0]));
    assert_eq!((of(-a), of(a * R::splat(2.0))), ([-1.0, 2.0, -3.0], [2.0, -4.0, 6.0]));
    assert_eq!((of(a.cross(b)), a.dot(b).to_f32()), ([0.5, 13.0, 8.5], 0.0));
    assert_eq!((of(a.times(b)), of(a.abs()), a.greatest().to_f32()), ([4.0, -1.0, -3.0], [1.0, 2.0, 3.0], 3.0));
    assert_eq!((of(a.min(b)), of(a.max(b))), ([1.0, -2.0, -1.0], [4.0, 0.5, 3.0]));
    assert_eq!((of(a.lesser(b)), of(a.greater(b))), ([1.0, -2.0, -1.0], [4.0, 0.5, 3.0]));
    assert_eq!(of(a.fused(b, a)), [5.0, -3.0, 0.0]);
    assert_eq!((of(V3::select(true, a, b)), of(V3::select(false, a, b))), (of(a), of(b)));
    let (unit, length) = v(0.0, -6.0, 8.0).normalised();
    let near = |x: R, y: f32| (x.to_f32() - y).abs() < 1e-6;
    assert!(near(unit.x, 0.0) && near(unit.y, -0.6) && near(unit.z, 0.8) && near(length * R::splat(0.1), 1.0));
    let (unit, length) = v(0.0, 0.0, 0.0).normalised();
    assert_eq!((of(unit), length.to_f32()), ([0.0; 3], 0.0));
}

fn promises<R: Scalar>() {
    arithmetic_and_order::<R>();
    powers_and_whole_numbers::<R>();
    small_numbers_and_records::<R>();
    vectors::<R>();
}

#[test]
fn exact_numbers_keep_their_promises() {
    promises::<f32>();
}

#[test]
fn fast_numbers_keep_their_promises() {
    promises::<Fast>();
    assert_eq!(Fast(0.5).flush_if_exact(1.0), Fast(0.5), "a device may do as it likes");
}

#[test]
fn doubles_keep_their_promises() {
    promises::<f64>();
    assert_eq!(0.5f64.flush_if_exact(1.0), 0.5);
    assert_eq!(1e-15f64.flush(SMALL), 1e-15, "there is room below");
}

#[test]
fn limits_are_powers_of_two() {
    assert_eq!((SMALL, TINY, FAINT), (0.5f32.powi(40), 0.5f32.powi(60), 0.5f32.powi(100)));
}

/// Every lane has the bits that `f32` alone has.
fn lanes_are_as_alone<const N: usize>() {
    for (first, second) in pairs() {
        let at = |x: f32, i: usize| if i % 3 == 2 { 1.0 - x } else { x + i as f32 };
        let [x, y]: [[f32; N]; 2] = [from_fn(|i| at(first, i)), from_fn(|i| at(second, N - i))];
        let (a, b) = (F32xN(x), F32xN(y));
        let same = |got: F32xN<N>, want: &dyn Fn(f32, f32) -> f32| {
            (0..N).for_each(|i| assert_eq!(got.0[i].to_bits(), want(x[i], y[i]).to_bits(), "{} {}", x[i], y[i]));
        };
        same(a + b, &|x, y| x + y);
        same(a - b, &|x, y| x - y);
        same(a * b, &|x, y| x * y);
        same(-a, &|x, _| -x);
        same(a.abs(), &|x, _| x.abs());
        same(Real::div(a, b), &|x, y| Real::div(x, y));
        same(a.reciprocal(), &|x, _| x.reciprocal());
        same(a.abs().sqrt(), &|x, _| Real::sqrt(x.abs()));
        same(Real::min(a, b), &|x, y| Real::min(x, y));
        same(Real::max(a, b), &|x, y| Real::max(x, y));
        same(a.flush(1.0), &|x, _| x.flush(1.0));
        same(F32xN::select(a.lt(b), a, b), &|x, y| if x < y { x } else { y });
        same(F32xN::select(!a.le(b), a, b), &|x, y| if x <= y { y } else { x });
        same(F32xN::select(a.eq(b), a, b), &|x, y| if x == y { x } else { y });
        same(F32xN::select(a.lt(b) | a.eq(b), a, b), &|x, y| if x <= y { x } else { y });
        same(F32xN::select(a.le(b) & !a.eq(b), a, b), &|x, y| if x < y { x } else { y });
        let below = (0..N).filter(|&i| x[i] < y[i]);
        assert_eq!((a.lt(b).any(), a.lt(b).count()), (below.clone().count() > 0, below.clone().count() as u32));
        assert_eq!(<F32xN<N> as Lanes<f32>>::bits(a.lt(b)), below.map(|i| 1 << i).sum::<u32>());
    }
}

fn lanes_hold_indices<L: Lanes<f32>>() {
    let count = L::COUNT as usize;
    let numbers = L::indices(|i| 10 + i as u32);
    assert_eq!(L::bits(L::equals(11, numbers)), 2);
    assert!(!L::equals(9, numbers).any() && L::equals(9 + L::COUNT, numbers).any());
    assert_eq!(L::bits(L::precedes(11, numbers)), ((1u32 << count) - 1) & !3);
    let chosen = L::select_index(L::equals(11, numbers), L::index(5), numbers);
    assert_eq!((L::index_of(chosen, 0), L::index_of(chosen, 1), L::index_of(chosen, 2)), (10, 5, 12));
    let counted = L::of(|i| i as f32);
    let mut out = [-1.0; 17];
    counted.put(&mut out);
    assert_eq!((out[count - 1], out[count], counted.lane(2)), (count as f32 - 1.0, -1.0, 2.0));
    let taken = L::taken(&out[1..]);
    assert_eq!((taken.lane(0), taken.lane(count - 1)), (1.0, -1.0));
    assert!((0..count).all(|i| L::all(2.5).lane(i) == 2.5));
}

#[test]
fn packets_are_as_their_rays_alone() {
    lanes_are_as_alone::<4>();
    lanes_are_as_alone::<8>();
    lanes_are_as_alone::<16>();
    lanes_hold_indices::<F32xN<4>>();
    lanes_hold_indices::<F32xN<8>>();
    lanes_hold_indices::<F32xN<16>>();
}

#[test]
fn a_truth_value_counts_as_one_lane() {
    assert_eq!((true.any(), false.any(), Mask::count(true), Mask::count(false)), (true, false, 1, 0));
}
