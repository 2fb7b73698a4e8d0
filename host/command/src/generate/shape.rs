//! Sheets that many pieces are made of.

use glam::DVec3;

use super::circle::turn;
use super::frame::Frame;
use super::patch::Patch;

/// The vector, in few letters.
pub fn at(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// From `a` to `b` by a share.
pub fn blend(a: f64, b: f64, share: f64) -> f64 {
    a + (b - a) * share
}

/// A point through `points` in order, smooth in between.
pub fn through(points: &[DVec3], share: f64) -> DVec3 {
    let last = points.len() - 1;
    let place = share.clamp(0.0, 1.0) * last as f64;
    let i = (place as usize).min(last - 1);
    let t = place - i as f64;
    let [before, from, to, after] = [i.max(1) - 1, i, i + 1, (i + 2).min(last)].map(|k| points[k]);
    let (leave, arrive) = ((to - before) * 0.5, (after - from) * 0.5);
    let bend = 3.0 * (to - from) - 2.0 * leave - arrive;
    let twist = leave + arrive - 2.0 * (to - from);
    from + t * (leave + t * (bend + t * twist))
}

/// A box on its frame's origin: half its width and depth, and its height. Six planes.
pub fn block(frame: Frame, half: f64, height: f64, depth: f64) -> Vec<Patch> {
    let point = |x, y, z| at(x * half, if y > 0.0 { height } else { 0.0 }, z * depth);
    let side = |a: DVec3, b: DVec3, c: DVec3| Patch::quad(frame.point(a), frame.vector(b - a), frame.vector(c - a));
    vec![
        side(point(-1.0, 0.0, 1.0), point(1.0, 0.0, 1.0), point(-1.0, 1.0, 1.0)),
        side(point(1.0, 0.0, -1.0), point(-1.0, 0.0, -1.0), point(1.0, 1.0, -1.0)),
        side(point(1.0, 0.0, 1.0), point(1.0, 0.0, -1.0), point(1.0, 1.0, 1.0)),
        side(point(-1.0, 0.0, -1.0), point(-1.0, 0.0, 1.0), point(-1.0, 1.0, -1.0)),
        side(point(-1.0, 1.0, 1.0), point(1.0, 1.0, 1.0), point(-1.0, 1.0, -1.0)),
        side(point(-1.0, 0.0, -1.0), point(1.0, 0.0, -1.0), point(-1.0, 0.0, 1.0)),
    ]
}

/// A turned piece: its outline as (radius, height) from the bottom up.
pub fn lathe(frame: Frame, outline: &[(f64, f64)]) -> Patch {
    let outline: Vec<DVec3> = outline.iter().map(|&(radius, height)| at(radius, height, 0.0)).collect();
    Patch::tube(move |u, v| {
        let point = through(&outline, v);
        let (cosine, sine) = turn(u);
        frame.point(at(point.x.max(0.0) * cosine, point.y, -point.x.max(0.0) * sine))
    })
}

/// A rod along a curve, and its radius along it.
pub fn rod(path: impl Fn(f64) -> DVec3 + 'static, radius: impl Fn(f64) -> f64 + 'static) -> Patch {
    const STEP: f64 = 1.0 / 64.0;
    Patch::tube(move |u, v| {
        let along = (path((v + STEP).min(1.0)) - path((v - STEP).max(0.0))).normalize_or(DVec3::Y);
        // Away from every axis, since rods mostly run along one.
        let side = along.cross(at(0.48, 0.36, 0.8)).normalize();
        let (cosine, sine) = turn(u);
        path(v) + (side * cosine + along.cross(side) * sine) * radius(v)
    })
    .least(1, 3)
}

/// A straight rod.
pub fn stick(from: DVec3, to: DVec3, radius: f64) -> Patch {
    rod(move |v| from + (to - from) * v, move |_| radius).least(1, 4)
}

/// A ball, pressed into shape: `form` takes a point of the unit sphere, whose pole is up.
pub fn ball(form: impl Fn(DVec3) -> DVec3 + 'static) -> Patch {
    Patch::tube(move |u, v| {
        let (cosine, sine) = turn(u);
        let (height, radius) = turn(0.5 - v / 2.0);
        form(at(radius.abs() * cosine, height, -radius.abs() * sine))
    })
    .least(3, 5)
}

/// A cushion: between a ball and a box of these half sides.
pub fn cushion(frame: Frame, x: f64, y: f64, z: f64) -> Patch {
    ball(move |p| frame.point(squared(p) * at(x, y, z)))
}

/// The unit sphere's point on a rounded box.
pub fn squared(p: DVec3) -> DVec3 {
    let fourth = (p * p) * (p * p);
    p / (fourth.x + fourth.y + fourth.z).sqrt().sqrt()
}
