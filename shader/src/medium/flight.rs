//! How far light goes in a homogeneous medium before it meets something of it.

use crate::data::{Medium, numbers};
use crate::real::{FAINT, Real, Scalar, V3};
use crate::sampler::unit;

/// One over the logarithm of two to the base e.
const NATS: f32 = core::f32::consts::LOG2_E;

/// What of light gets through a medium on a way of this length, which may be endless, linear RGB.
#[inline(always)]
pub fn transmittance<R: Scalar>(medium: &Medium, distance: R) -> V3<R> {
    V3::<R>::splat(numbers(medium.extinction)).map(|extinction| exponential(extinction, distance))
}

/// `exp(-extinction * distance)`, both at least 0; 1 where nothing is in the way, however long that is.
#[inline(always)]
fn exponential<R: Scalar>(extinction: R, distance: R) -> R {
    /// Beyond so many lengths nothing is left that counts.
    const MOST: f32 = 70.0;
    let depth = (extinction * distance.min(R::splat(ENDLESS))).min(R::splat(MOST));
    R::splat(0.5).pow(depth * R::splat(NATS)).flush(FAINT)
}

/// A way as long as this has no end, and no product with a coefficient overflows.
const ENDLESS: f32 = (1u64 << 40) as f32;

/// How far a ray gets in a medium, and what of it counts from there on.
#[derive(Clone, Copy)]
pub struct Flight<R: Real> {
    /// How far.
    pub distance: R,
    /// Did it meet something of the medium? Else it gets as far as it can.
    pub collides: bool,
    /// What of its light counts there, over the probability: before it is scattered.
    pub factor: V3<R>,
}

impl<R: Scalar> Flight<R> {
    /// The way of a ray that goes on at most so far, and whose light counts as `weight`. A channel is chosen in proportion to that, and
    /// the way by that channel's extinction; what all channels would have chosen counts together (one-sample multiple importance
    /// sampling, Veach 1997, 9.2.4), so that no channel is worth more than the sum of all.
    #[inline(always)]
    pub fn new(medium: &Medium, most: R, weight: V3<R>, (channel, way): (u32, u32)) -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let extinction = V3::<R>::splat(numbers(medium.extinction));
        let sum = weight.x + weight.y + weight.z;
        let is_something = zero.lt(sum);
        let over = R::select(is_something, sum, one).reciprocal();
        let share = |c: R| R::select(is_something, (c * over).flush(FAINT), R::splat(const { 1.0 / 3.0 }));
        let shares = weight.map(share);
        let drawn = R::splat(unit(channel));
        let chosen = if drawn.lt(shares.x) {
            extinction.x
        } else if drawn.lt(shares.x + shares.y) {
            extinction.y
        } else {
            extinction.z
        };
        // -ln(1 - u), at most 16.7.
        let depth = -(one - R::splat(unit(way))).log2() * R::splat(const { 1.0 / NATS });
        let meets_something = zero.lt(chosen);
        let distance = depth.div(R::select(meets_something, chosen, one));
        let collides = meets_something && distance.lt(most);
        let distance = R::select(collides, distance, most);
        let left = transmittance(medium, distance);
        let likely = if collides { left.times(extinction).map(|c| c.flush(FAINT)) } else { left };
        let all = shares.dot(likely).flush(FAINT);
        let is_likely = zero.lt(all);
        let over = R::select(is_likely, all, one).reciprocal();
        let factor = V3::select(is_likely, likely * over, V3::zero()).map(|c| c.flush(FAINT));
        Flight { distance, collides, factor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Launch, pack};
    use crate::sampler::{self, Key};
    use bytemuck::Zeroable;
    use glam::Vec3;
    use proptest::prelude::*;

    fn medium(extinction: Vec3) -> Medium {
        Medium { extinction: pack(extinction, 0), ..Zeroable::zeroed() }
    }

    fn drawn(i: u32) -> (u32, u32) {
        let set = sampler::set(Launch(Launch::RANDOM), Key(8, 5), i, 1);
        (set.x, set.y)
    }

    /// The mean of the factor of what gets through is the transmittance; that of what collides, over a function of the distance, is
    /// that function's integral: here of the distance itself.
    #[test]
    fn what_gets_through_and_what_collides_is_as_much_as_the_closed_form_says() {
        let coefficients = [
            (Vec3::new(1.0, 1.0, 1.0), V3::new(1.0, 1.0, 1.0), 1.0),
            (Vec3::new(3.0, 0.5, 0.01), V3::new(0.2, 1.0, 0.7), 1.5),
            (Vec3::new(0.0, 2.0, 20.0), V3::new(1.0, 0.3, 0.1), 0.7),
        ];
        for (extinction, weight, most) in coefficients {
            let (count, medium) = (1 << 18, medium(extinction));
            let (mut through, mut squares, mut collided) = ([0f64; 3], [0f64; 3], [0f64; 3]);
            for i in 0..count {
                let flight = Flight::<f64>::new(&medium, most, weight, drawn(i));
                let factor = [flight.factor.x, flight.factor.y, flight.factor.z];
                for (c, factor) in factor.into_iter().enumerate() {
                    let value = factor * if flight.collides { flight.distance } else { 0.0 };
                    collided[c] += value;
                    through[c] += if flight.collides { 0.0 } else { factor };
                    squares[c] += factor * factor;
                }
            }
            for c in 0..3 {
                let sigma = f64::from(extinction[c]);
                let error = 6.0 * (squares[c] / f64::from(count) / f64::from(count)).sqrt();
                let want = (-sigma * most).exp();
                let got = through[c] / f64::from(count);
                assert!((got - want).abs() < error, "{extinction}, {c}: {got} is not {want}");
                let want = if sigma == 0.0 { 0.0 } else { (1.0 - want * (1.0 + sigma * most)) / sigma };
                let got = collided[c] / f64::from(count);
                assert!((got - want).abs() < error, "{extinction}, {c}: {got} is not {want}");
            }
        }
    }

    #[test]
    fn nothing_is_left_of_an_endless_way_but_where_nothing_is_in_it() {
        let left = transmittance::<f32>(&medium(Vec3::new(0.0, 1e-6, 1e30)), f32::MAX);
        assert_eq!((left.x, left.y, left.z), (1.0, 0.0, 0.0));
    }

    proptest! {
        #[test]
        fn transmittance_is_the_exponential(extinction in 1e-3f32..1e3, depth in 1e-6f64..40.0) {
            let distance = (depth / f64::from(extinction)) as f32;
            let got = f64::from(transmittance::<f32>(&medium(Vec3::splat(extinction)), distance).x);
            let want = (-f64::from(extinction) * f64::from(distance)).exp();
            prop_assert!((got / want - 1.0).abs() < 4e-7 * (1.0 + depth * 1.5), "{} is not {}", got, want);
        }

        /// Whatever is drawn, no channel's light grows beyond the sum of all.
        #[test]
        fn no_channel_is_worth_more_than_all(
            extinction in [0f32..50.0, 0f32..50.0, 0f32..50.0], weight in [0f32..1.0, 0f32..1.0, 0f32..1.0],
            most in 0f32..4.0, drawn in any::<(u32, u32)>(),
        ) {
            let [x, y, z] = weight;
            prop_assume!(x + y + z > 1e-3);
            let flight = Flight::<f32>::new(&medium(extinction.into()), most, V3::new(x, y, z), drawn);
            let after = V3::new(x, y, z).times(flight.factor);
            prop_assert!(after.x + after.y + after.z <= (x + y + z) * 1.000_01);
            prop_assert!(flight.distance <= most && after.greatest().is_finite());
        }
    }
}
