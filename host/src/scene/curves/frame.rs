//! Normals along a strand that turn about it no more than they must.

use glam::DVec3;

use super::stations::Station;

/// Carries a normal from station to station.
#[derive(Default)]
pub struct Frame {
    last: Option<(Station, DVec3)>,
}

impl Frame {
    /// The unit normal of the next station, at right angles to its tangent: the one that faces `up` most, where that tells it, else that of
    /// the station before, turned as the curve is, else any.
    pub fn normal(&mut self, station: &Station, up: Option<DVec3>) -> DVec3 {
        let normal = up.and_then(|up| faced(station.tangent, up)).or_else(|| {
            let (last, normal) = self.last.as_ref()?;
            across(station.tangent, carried(last, *normal, station))
        });
        let normal = normal.unwrap_or_else(|| station.tangent.any_orthonormal_vector());
        self.last = Some((*station, normal));
        normal
    }
}

/// The unit part of a vector that is at right angles to a unit tangent.
fn across(tangent: DVec3, of: DVec3) -> Option<DVec3> {
    (of - tangent * tangent.dot(of)).try_normalize()
}

/// The same, unless the vector leads along the tangent but for a thousandth.
fn faced(tangent: DVec3, up: DVec3) -> Option<DVec3> {
    let up = up.try_normalize()?;
    let rest = up - tangent * tangent.dot(up);
    (rest.length_squared() > 1e-6).then(|| rest.normalize())
}

/// A normal as the curve turns it on the way to another station: by two reflections (Wang, Jüttler, Zheng and Liu, Computation of Rotation
/// Minimizing Frames, 2008), or, where the stations' tangents do not lead from the one to the other, by the smallest turn of them.
fn carried(from: &Station, normal: DVec3, to: &Station) -> DVec3 {
    let way = to.center - from.center;
    let square = way.length_squared();
    // Reflections of what hardly leads there are of no plane in particular.
    let least = 0.1 * square.sqrt();
    if square > 0.0 && from.tangent.dot(way) > least && to.tangent.dot(way) > least {
        let reflect = |of: DVec3| of - way * (2.0 / square * way.dot(of));
        let (normal, tangent) = (reflect(normal), reflect(from.tangent));
        let second = to.tangent - tangent;
        return normal - second * (2.0 / second.length_squared() * second.dot(normal));
    }
    let sum = from.tangent + to.tangent;
    let square = sum.length_squared();
    if square > 0.0 { normal - sum * (2.0 * to.tangent.dot(normal) / square) } else { normal }
}
