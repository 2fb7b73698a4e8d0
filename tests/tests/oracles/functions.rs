//! Division, roots and powers: their largest errors, and the same bits on the GPU.

use eyerays::gpu::{AdapterRequest, Gpu, numerics};
use eyerays_shader::numerics::{evaluate, function};
use eyerays_shader::real::{power, soft, turns};
use eyerays_tests::{count, gpu};
use fastrand::Rng;
use glam::UVec4;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The distance from a double's nearest `f32` of the same binade to the next.
fn ulp(x: f64) -> f64 {
    let exponent = x.abs().log2().floor().max(-126.0);
    (exponent - 23.0).exp2()
}

/// All normal positive numbers in full, else every 1009th. (That every mantissa is rounded right, the functions' own
/// tests show.)
fn normals() -> impl ParallelIterator<Item = f32> {
    let step = if count::full() { 1 } else { 1009 };
    (0x0080_0000 / step..0x7f80_0000u32 / step)
        .into_par_iter()
        .map(move |i| f32::from_bits(i * step + step / 2))
        .filter(|x| x.is_normal())
}

/// The largest of each error.
fn most<const N: usize>(errors: impl ParallelIterator<Item = [f64; N]>) -> [f64; N] {
    errors.reduce(|| [0.0; N], |a, b| std::array::from_fn(|i| a[i].max(b[i])))
}

/// Correctly rounded: half a unit, and the bits of the processor's own instructions.
#[test]
fn roots_and_reciprocals_are_correctly_rounded() {
    let wrong = normals().filter(|x| soft::sqrt(*x).to_bits() != x.sqrt().to_bits()).count();
    // The reciprocals of numbers above 2^126 are subnormal.
    let normal = || normals().filter(|x| *x < 8.5e37);
    let other = |x: f32| soft::reciprocal(x).to_bits() != (1.0 / x).to_bits();
    let bent = normal().filter(|&x| other(x) || other(-x)).count();
    let [root] = most(normals().map(|x| {
        let exact = f64::from(x).sqrt();
        [(f64::from(soft::sqrt(x)) - exact).abs() / ulp(exact)]
    }));
    let [reciprocal] =
        most(normal().map(|x| [(f64::from(soft::reciprocal(x)) - 1.0 / f64::from(x)).abs() * ulp_of_one_over(x)]));
    println!("sqrt: {wrong} wrong of {}, largest error {root:.6} ulp", normals().count());
    println!("reciprocal: {bent} wrong of {}, largest error {reciprocal:.6} ulp", 2 * normal().count());
    assert_eq!((wrong, bent), (0, 0));
    assert!(root <= 0.5 + 1e-6 && reciprocal <= 0.5 + 1e-6);
}

/// One over the unit of a reciprocal.
fn ulp_of_one_over(x: f32) -> f64 {
    1.0 / ulp(1.0 / f64::from(x))
}

#[test]
fn quotients_are_correctly_rounded() {
    let count = count::of(8_000_000, 1_000_000_000);
    let wrong = (0..count.div_ceil(1 << 16))
        .into_par_iter()
        .map(|part| {
            let mut rng = Rng::with_seed(part as u64);
            let differs = |_: &usize| {
                let (a, b) = (f32::from_bits(rng.u32(..)), f32::from_bits(rng.u32(..)));
                let (soft, hard) = (soft::div(a, b), soft::native::div(a, b));
                soft.to_bits() != hard.to_bits() && !(soft.is_nan() && hard.is_nan())
            };
            (0..1usize << 16).filter(differs).count()
        })
        .sum::<usize>();
    println!("div: {wrong} wrong of {count} pairs of bits");
    assert_eq!(wrong, 0);
}

/// The stated bounds of [`power`], over all mantissas and the whole domain.
#[test]
fn powers_err_less_than_stated() {
    let near_one = (0..1u32 << 24).into_par_iter().map(|i| f32::from_bits(0x3f00_0000 + i));
    let [absolute, ulps] = most(normals().chain(near_one).map(|x| {
        let exact = f64::from(x).log2();
        let error = (f64::from(power::log2(x)) - exact).abs();
        [error / exact.abs().max(1.0), error / ulp(exact)]
    }));
    println!("log2: largest error {absolute:.2e} of the greater of 1 and the result; {ulps:.2} ulp");
    assert!(absolute <= 4e-7 && ulps <= LOG_ULPS);
    let count = count::of(1 << 22, 1 << 30) as u64;
    let [exp] = most((0..count).into_par_iter().map(|i| {
        let x = (i as f64 / count as f64 * 200.0 - 100.0) as f32;
        let exact = f64::from(x).exp2();
        [(f64::from(power::exp2(x)) - exact).abs() / ulp(exact)]
    }));
    println!("exp2: largest error {exp:.2} ulp over {count} numbers in [-100, 100]");
    assert!(exp <= EXP_ULPS);
    let [relative, ulps] = most((0..count).into_par_iter().map(|i| {
        let mut rng = Rng::with_seed(i);
        let x = (1.0 - (-24.0 * rng.f64()).exp2()) as f32;
        let exponent = if i % 2 == 0 { (30.0 * rng.f64()).exp2() } else { rng.f64() } as f32;
        let exact = f64::from(x).powf(f64::from(exponent));
        let error = (f64::from(power::pow(x, exponent)) - exact).abs();
        // Below 2^-100 the result may be zero.
        if exact < 8e-31 { [0.0; 2] } else { [error / exact / exact.log2().abs().max(1.0), error / ulp(exact)] }
    }));
    println!(
        "pow: largest relative error {relative:.2e} of the greater of 1 and |log2| of the result, {ulps:.0} ulp, over {count} powers"
    );
    assert!(relative <= 4e-7);
}

/// All slopes of (0, 1] in full, else every 499th, in four places each; and any points.
#[test]
fn angles_err_less_than_stated() {
    let off = |y: f32, x: f32| (f64::from(turns::atan2(y, x)) - f64::from(y).atan2(f64::from(x)) / TAU).abs();
    let step = if count::full() { 1 } else { 499 };
    let slopes = (1..=1f32.to_bits() / step).into_par_iter().map(|i| f32::from_bits(i * step));
    let [of_slopes] = most(slopes.map(|t| {
        let places = [off(t, 1.0), off(1.0, t), off(-t, -1.0), off(-1.0, -t)];
        [places.into_iter().fold(0.0, f64::max)]
    }));
    let count = count::of(1 << 21, 1 << 30) as u64;
    let [of_points] = most((0..count).into_par_iter().map(|i| {
        let mut rng = Rng::with_seed(i);
        let mut coordinate = || f32::from_bits(angle_operand(&mut rng));
        let (x, y) = (coordinate(), coordinate());
        // The standard library tells the sides of a cut by the signs of zeros.
        [if y == 0.0 { 0.0 } else { off(y, x) }]
    }));
    println!("atan2: largest error {of_slopes:.2e} turns of slopes, {of_points:.2e} of {count} points");
    assert!(of_slopes.max(of_points) <= 4e-8, "{of_slopes:e}, {of_points:e}");
}

/// Units that log2 and exp2 may be off by.
const LOG_ULPS: f64 = 4.0;
const EXP_ULPS: f64 = 2.0;

/// Zero or a normal number of at most 2^126, either sign.
fn angle_operand(rng: &mut Rng) -> u32 {
    let size = if rng.u32(..16) == 0 { 0 } else { rng.u32(0x0080_0000..=0x7e80_0000) };
    size | rng.u32(..) & 0x8000_0000
}

/// A million operations from the whole domain of a function, special numbers among them.
fn operations(function: u32, part: u64) -> Vec<UVec4> {
    let mut rng = Rng::with_seed(part << 8 | u64::from(function));
    let special =
        [0, 1, 0x007f_ffff, 0x0080_0000, 0x3f7f_ffff, 0x3f80_0000, 0x3f80_0001, 0x7f7f_ffff, 0x7f80_0000, 0x7fc0_0000];
    let any = |rng: &mut Rng| match rng.u32(..16) {
        0 => special[rng.usize(0..special.len())] | rng.u32(..) & 0x8000_0000,
        _ => rng.u32(..),
    };
    let operation = |_| {
        let (a, b) = match function {
            function::QUOTIENT | function::ROOT => (any(&mut rng), any(&mut rng)),
            function::RECIPROCAL => (rng.u32(0x0080_0000..0x7e80_0000) | rng.u32(..) & 0x8000_0000, 0),
            function::POWER => (rng.u32(0..=0x3f80_0000), rng.u32(0x2180_0000..0x4e6e_6b28)),
            function::LOGARITHM => (rng.u32(0x0080_0000..0x7f80_0000), 0),
            function::EXPONENTIAL => ((rng.f32() * 200.0 - 100.0).to_bits(), 0),
            function::ANGLE => (angle_operand(&mut rng), angle_operand(&mut rng)),
            _ => (rng.u32(..), 0),
        };
        UVec4::new(a, b, function, 0)
    };
    (0..1 << 20).map(operation).collect()
}

/// A NaN's bits may differ.
fn same(a: u32, b: u32) -> bool {
    a == b || f32::from_bits(a).is_nan() && f32::from_bits(b).is_nan()
}

#[test]
fn the_gpu_has_the_same_bits() {
    let Some(gpu) = gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) else { return };
    let names = ["div", "reciprocal", "sqrt", "pow", "log2", "exp2", "cos", "sin", "atan2"];
    for (name, function) in names.iter().zip(function::QUOTIENT..) {
        let count = count::of(1 << 20, 1 << 27);
        let differing: usize = (0..count as u64 >> 20).map(|part| differing(&gpu, &operations(function, part))).sum();
        println!("{name}: {differing} of {count} differ on {}", gpu.report.name);
        assert_eq!(differing, 0, "{name}");
    }
}

fn differing(gpu: &Gpu, operations: &[UVec4]) -> usize {
    let values = numerics::evaluate(gpu, operations).unwrap();
    assert_eq!(values.len(), operations.len());
    let differs = |(operation, value): (&UVec4, &u32)| !same(evaluate(*operation), *value);
    let first = operations.iter().zip(&values).find(|pair| differs(*pair));
    if let Some((operation, value)) = first {
        println!("{operation:08x?} gives {value:08x} instead of {:08x}", evaluate(*operation));
    }
    operations.iter().zip(&values).filter(|pair| differs(*pair)).count()
}
