use super::*;
use crate::data::{CELLS, Grid, Launch, pack};
use crate::sampler::{self, Key};
use bytemuck::Zeroable;

const EDGE: usize = CELLS as usize + 1;

/// Two blocks along x, whose cells have edges of a quarter and begin at the origin, with a number by the place of a corner.
fn grid(inset: f32, number: impl Fn([usize; 3]) -> f32) -> Vec<u32> {
    let mut words = vec![0; Grid::RECORDS as usize + 4];
    for axis in 0..3 {
        words[5 * axis] = 4f32.to_bits();
        let blocks = if axis == 0 { 2 } else { 1 };
        words[Grid::CELLS as usize + axis] = blocks * CELLS;
        words[Grid::BLOCKS as usize + axis] = blocks;
    }
    words[Grid::INSET as usize] = inset.to_bits();
    for block in 0..2 {
        let corners = (0..EDGE.pow(3)).map(|i| [i % EDGE + block * CELLS as usize, i / EDGE % EDGE, i / EDGE / EDGE]);
        let numbers: Vec<f32> = corners.map(&number).collect();
        let greatest = numbers.iter().copied().fold(0.0, f32::max);
        let record = Grid::RECORDS as usize + 2 * block;
        words[record] = greatest.to_bits();
        words[record + 1] = if numbers.iter().all(|&n| n == greatest) { Grid::EVEN } else { words.len() as u32 };
        if words[record + 1] != Grid::EVEN {
            words.extend(numbers.iter().map(|n| n.to_bits()));
        }
    }
    words
}

fn chain(i: u32) -> Chain {
    let set = sampler::set(Launch(Launch::RANDOM), Key(8, 5), i, 1);
    Chain::new(set.x, set.y)
}

fn medium(extinction: Vec3) -> Medium {
    Medium { extinction: pack(extinction, 0), ..Zeroable::zeroed() }.with_grid(0)
}

/// Bumps whose greatest numbers differ in both blocks.
fn bumpy([x, y, z]: [usize; 3]) -> f32 {
    ((x * 7 + y * 3 + z * 5) % 11) as f32 * if x > CELLS as usize { 0.3 } else { 0.1 }
}

/// The number at a place of the scene, by the corners around, in double precision.
fn at(place: [f64; 3], number: &dyn Fn([usize; 3]) -> f32) -> f64 {
    let cell: Vec<usize> = (0..3).map(|a| ((place[a] * 4.0) as usize).min(if a == 0 { 15 } else { 7 })).collect();
    let share: Vec<f64> = (0..3).map(|a| place[a] * 4.0 - cell[a] as f64).collect();
    (0..8)
        .map(|bits: usize| {
            let corner = [0, 1, 2].map(|a| cell[a] + (bits >> a & 1));
            let weight: f64 = (0..3).map(|a| if bits >> a & 1 == 1 { share[a] } else { 1.0 - share[a] }).product();
            weight * f64::from(number(corner))
        })
        .sum()
}

type Way = ([f64; 3], [f64; 3], f64);

const WAYS: [Way; 4] = [
    ([-1.0, 0.9, 1.1], [1.0, 0.0, 0.0], 9.0),
    ([3.9, 1.9, 0.1], [-0.8, -0.36, 0.48], 9.0),
    ([0.5, 0.5, 0.5], [0.6, 0.0, 0.8], 1.3),
    ([2.0, -3.0, 1.0], [0.0, 1.0, 0.0], 9.0),
];

/// The integral of density on a way, by midpoints.
fn depth_of((origin, direction, most): Way, number: &dyn Fn([usize; 3]) -> f32) -> f64 {
    let steps = 200_000;
    let step = most / f64::from(steps);
    let density = |i: u32| {
        let place = [0, 1, 2].map(|a| origin[a] + direction[a] * (f64::from(i) + 0.5) * step);
        let inside = (0..3).all(|a| place[a] >= 0.0 && place[a] <= if a == 0 { 4.0 } else { 2.0 });
        if inside { at(place, number) } else { 0.0 }
    };
    (0..steps).map(density).sum::<f64>() * step
}

fn of([x, y, z]: [f64; 3]) -> V3<f64> {
    V3::new(x, y, z)
}

#[test]
fn as_much_gets_through_as_the_integral_of_density_says() {
    let words = grid(0.0, bumpy);
    let extinction = Vec3::new(0.0, 0.7, 2.0);
    let (medium, count) = (medium(extinction), 1 << 17);
    for way in WAYS {
        let depth = depth_of(way, &bumpy);
        assert!(depth > 0.1);
        let (mut ratios, mut deltas, mut squares) = ([0f64; 3], [0f64; 3], [0f64; 3]);
        for i in 0..count {
            let ray = (of(way.0), of(way.1));
            let through = ratio::<f64>(&medium, &words, ray, way.2, chain(i));
            let flight = delta::<f64>(&medium, &words, ray, (way.2, V3::new(0.5, 1.0, 0.7)), chain(i));
            let (through, factor) =
                ([through.x, through.y, through.z], [flight.factor.x, flight.factor.y, flight.factor.z]);
            for c in 0..3 {
                ratios[c] += through[c];
                squares[c] += factor[c] * factor[c] + through[c] * through[c];
                deltas[c] += if flight.collides { 0.0 } else { factor[c] };
            }
        }
        let count = f64::from(count);
        for c in 0..3 {
            let want = (-depth * f64::from(extinction[c])).exp();
            let error = 5.0 * (squares[c] / count / count).sqrt() + 1e-12;
            for (what, got) in [("ratio", ratios[c] / count), ("delta", deltas[c] / count)] {
                assert!((got - want).abs() < error, "{what}, {way:?}, {c}: {got} is not {want}");
            }
        }
    }
}

#[test]
fn light_collides_where_it_is_dense() {
    let words = grid(0.0, bumpy);
    let (medium, count, way) = (medium(Vec3::splat(1.5)), 1 << 17, WAYS[0]);
    let mut sum = 0.0;
    for i in 0..count {
        let flight = delta::<f64>(&medium, &words, (of(way.0), of(way.1)), (way.2, V3::new(1.0, 1.0, 1.0)), chain(i));
        assert!((flight.factor.x - 1.0).abs() < 1e-5, "one channel's weight stays");
        sum += if flight.collides { flight.distance } else { 0.0 };
    }
    // The mean of the distance, over its density, sigma times what gets so far.
    let (steps, mut through, mut want) = (100_000, 1.0, 0.0);
    let step = way.2 / f64::from(steps);
    for i in 0..steps {
        let t = (f64::from(i) + 0.5) * step;
        let place = [0, 1, 2].map(|a| way.0[a] + way.1[a] * t);
        let inside = place[0] >= 0.0 && place[0] <= 4.0;
        let sigma = if inside { 1.5 * at(place, &bumpy) } else { 0.0 };
        let left = (-sigma * step).exp();
        want += t * through * (1.0 - left);
        through *= left;
    }
    let got = sum / f64::from(count);
    assert!((got - want).abs() < 5.0 * 2.0 / f64::from(count).sqrt(), "{got} is not {want}");
}

/// All as dense: homogeneous. Nothing: the ray goes on, whatever it draws.
#[test]
fn even_grids_are_homogeneous_and_empty_ones_nothing() {
    let (even, empty) = (grid(0.0, |_| 0.75), grid(0.0, |_| 0.0));
    let medium = medium(Vec3::splat(2.0));
    let ray = (of([-1.0, 1.0, 1.0]), of([1.0, 0.0, 0.0]));
    let count = 1 << 15;
    let mut through = 0.0;
    for i in 0..count {
        let flight = delta::<f64>(&medium, &empty, ray, (9.0, V3::new(1.0, 1.0, 1.0)), chain(i));
        assert!(!flight.collides && flight.factor == V3::new(1.0, 1.0, 1.0) && flight.distance == 9.0);
        assert_eq!(ratio::<f64>(&medium, &empty, ray, 9.0, chain(i)), V3::new(1.0, 1.0, 1.0));
        through += ratio::<f64>(&medium, &even, ray, 2.0, chain(i)).x;
    }
    let (got, want) = (through / f64::from(count), (-1.5f64).exp());
    assert!((got - want).abs() < 0.012, "{got} is not {want}");
}

/// Rays of single precision in and along faces of blocks end, and draw no number that is none.
#[test]
fn rays_along_faces_end() {
    let words = grid(0.5, bumpy);
    let medium = medium(Vec3::new(1.0, 30.0, 1e6));
    for i in 0..20_000u32 {
        let [a, b, c] = hash([i, 7, 9]);
        let place = |drawn: u32| (drawn % 9) as f32 * 0.5 - 0.5;
        let direction = [V3::new(1.0, 0.0, 0.0), V3::new(0.0, -1.0, 0.0), V3::new(0.6, 0.0, -0.8)][(i % 3) as usize];
        let ray = (V3::new(place(a), place(b), place(c)), direction);
        let flight = delta::<f32>(&medium, &words, ray, (f32::MAX, V3::new(0.1, 0.0, 1.0)), chain(i));
        assert!(flight.factor.greatest().is_finite() && flight.distance >= 0.0);
        assert!(ratio::<f32>(&medium, &words, ray, 3.0, chain(i)).greatest() <= 1.0);
    }
}
