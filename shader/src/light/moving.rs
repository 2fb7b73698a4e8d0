//! Lights that move while the shutter is open (thesis 3.4.7).

use crate::buffer::read;
use crate::data::{Instance, Launch, Light, Waves, numbers, pack};
use crate::geometry::across;
use crate::ray::Hit;
use crate::real::{FAINT, Scalar, TINY, V3};
use crate::scene::LaunchContext;
use glam::{UVec4, Vec3};

/// A light without extent where it is at a time.
#[inline(always)]
pub fn at_time<R: Scalar>(launch: &LaunchContext<'_>, light: Light, time: f32) -> Light {
    let mut light = light;
    if launch.spec.waves.has(Waves::ILLUMINANTS) {
        light.position.w = light.without_illuminant();
    }
    if !launch.spec.launch.has(Launch::MOVING) || !light.moves() {
        return light;
    }
    let (step, share) = launch.frame.step(time);
    let key = |number: u32| read(launch.instances, light.first_key() + number);
    moved::<R>(light, key(step), key(step + 1), share)
}

/// The same at a share of the way between two keys, by which it is turned against the first of all and put into its place.
// A function of its own on the GPU, so that a module holds it once.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
fn moved<R: Scalar>(light: Light, from: Instance, to: Instance, share: f32) -> Light {
    let key = from.towards(&to, share).transform();
    let turned = |of: UVec4| {
        let way = key.turned(V3::<R>::splat(numbers(of))).normalised().0;
        Vec3::new(way.x.to_f32(), way.y.to_f32(), way.z.to_f32())
    };
    let (kind, outer) = (light.position.w & Light::KINDS, light.axis.w);
    if kind == Light::DIRECTIONAL {
        return Light { position: pack(turned(light.position), kind), ..light };
    }
    let position = pack(key.translation, kind);
    if kind == Light::POINT {
        Light { position, ..light }
    } else {
        Light { position, axis: pack(turned(light.axis), outer), ..light }
    }
}

/// A density over the area that a triangle has as the shutter opens, over the area that it has at a time: 0 where that is none. Its
/// index, its copy and the time tell which it is.
#[inline(always)]
pub(super) fn over_area_at<R: Scalar>(
    launch: &LaunchContext<'_>,
    per_area: R,
    (index, instance, time): (u32, u32, f32),
) -> R {
    if !launch.spec.launch.has(Launch::MOVING) || instance == Hit::<f32>::NOTHING {
        return per_area;
    }
    let area = |time: f32| {
        let [a, b, c] = launch.placed(index, instance, time).vertices();
        across([V3::<R>::splat(a), V3::splat(b), V3::splat(c)]).1
    };
    let (then, now) = (area(0.0), area(time));
    let is_none = now.lt(R::splat(TINY));
    let shrunk = then.div(R::select(is_none, R::splat(1.0), now));
    R::select(is_none, R::splat(0.0), (per_area * shrunk).flush(FAINT))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Frame, Specialisation};

    fn key(rows: [Vec3; 3], place: Vec3) -> Instance {
        let row = |row: Vec3, added: f32| pack(row, added.to_bits());
        let [x, y, z] = rows;
        Instance { x: row(x, place.x), y: row(y, place.y), z: row(z, place.z), mesh: UVec4::ZERO }
    }

    #[test]
    fn lights_go_straight_from_key_to_key_and_turn_with_them() {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z];
        // A quarter turn about z takes x to y.
        let turned = [-Vec3::Y, Vec3::X, Vec3::Z];
        let keys = [Instance::NONE, key(axes, Vec3::ZERO), key(turned, Vec3::X)];
        let frame = Frame { steps: 1, exposure: 1.0, ..Frame::default() };
        let spec = Specialisation { launch: Launch(Launch::MOVING), ..Specialisation::default() };
        let launch = LaunchContext::new(&frame, spec, &[], &keys);
        let light = |kind| Light {
            position: pack(Vec3::X, kind | (1 + 1) << Light::KEYS),
            colour: UVec4::ONE,
            axis: pack(Vec3::X, 7),
        };
        let (half, diagonal) = (Vec3::X * 0.5, Vec3::new(1.0, 1.0, 0.0).normalize());
        for (kind, position, axis) in [
            (Light::POINT, half, Vec3::X),
            (Light::SPOT, half, diagonal),
            (Light::RAMP, half, diagonal),
            (Light::DIRECTIONAL, diagonal, Vec3::X),
        ] {
            let at = at_time::<f64>(&launch, light(kind), 0.5);
            assert_eq!((at.position.w, at.axis.w, at.colour), (kind, 7, UVec4::ONE));
            assert!((numbers(at.position) - position).length() < 1e-6, "{kind}: {}", numbers(at.position));
            assert!((numbers(at.axis) - axis).length() < 1e-6, "{kind}: {}", numbers(at.axis));
        }
        let still = Light { position: pack(Vec3::X, Light::SPOT), ..light(0) };
        assert_eq!(at_time::<f64>(&launch, still, 0.5), still);
    }
}
