//! Balls around what mirrors or refracts light, for photons to be sent there.

use std::collections::BinaryHeap;
use std::ops::Range;

use eyerays_shader::data::{Instance as Record, Primitive, numbers, pack};
use glam::{UVec3, UVec4, Vec3};

use super::copies;
use super::normalisation::Normalisation;
use super::shining::Places;
use crate::scene::{Instance, Material, Scene};

/// The most balls: a photon asks each of them how likely it was sent.
const MOST: usize = 32;
/// Balls are parted only where that leaves less than this share of their areas.
const SAVES: f32 = 0.8;

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ball {
    centre: Vec3,
    radius: f32,
}

/// Some balls, and one around all of them.
#[derive(Clone, PartialEq)]
struct Group {
    around: Ball,
    members: Vec<Ball>,
}

impl Eq for Group {}

impl Ord for Group {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.around.radius.total_cmp(&other.around.radius)
    }
}

impl PartialOrd for Group {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// The records of a scene, see [`Casters`](eyerays_shader::photon::Casters), whose `primitives` lie in leaf order, the first `own` of them
/// where they stand; empty if nothing casts.
pub(super) fn of(
    scene: &Scene,
    normalisation: &Normalisation,
    (primitives, own): (&[Primitive], usize),
    (instances, places): (&[Record], &Places),
) -> Vec<UVec4> {
    let casts: Vec<bool> = scene.materials.iter().map(Material::casts).collect();
    if !casts.contains(&true) {
        return Vec::new();
    }
    let casters = |slots: Range<usize>| {
        let own = primitives[slots].iter().filter(|of| !of.is_instance() && casts[of.material() as usize]);
        own.map(ball).collect::<Vec<_>>()
    };
    let bends = |mesh: usize| scene.motion.as_ref().is_some_and(|motion| motion.is_bent(mesh as u32));
    let box_of = |(mesh, slots): (usize, &Range<usize>)| match casters(slots.clone()) {
        none if none.is_empty() => None,
        // Each of its shapes lies in its cube.
        _ if bends(mesh) => Some([Vec3::NEG_ONE, Vec3::ONE]),
        all => Some(bounds(&all)),
    };
    let boxes: Vec<_> = places.slots.iter().enumerate().map(box_of).collect();
    let keys = 1 + scene.motion.as_ref().map_or(0, |motion| motion.poses.len());
    let origin = copies::origin(normalisation);
    let copy = |(instance, &first): (&Instance, &usize)| {
        let within = boxes[instance.mesh as usize]?;
        let all = instances[first..].iter().take(if instances[first].moves() { keys } else { 1 });
        Some(Group::new(all.map(|key| placed(key, origin, within)).collect()).around)
    };
    let mut all = casters(0..own);
    all.extend(scene.instances.iter().zip(&places.firsts).filter_map(copy));
    records(&all)
}

/// Around a primitive.
fn ball(primitive: &Primitive) -> Ball {
    if primitive.is_sphere() || primitive.is_disk() {
        return Ball { centre: primitive.centre(), radius: primitive.radius() };
    }
    let (least, greatest) = primitive.bounds();
    let centre = (least + greatest) / 2.0;
    let radius = primitive.vertices().into_iter().map(|vertex| vertex.distance(centre)).fold(0.0, f32::max);
    Ball { centre, radius }
}

/// Around what lies in a box of its mesh, where a key of a copy has it.
fn placed(key: &Record, origin: Vec3, [least, greatest]: [Vec3; 2]) -> Ball {
    let transform = key.transform();
    let moved = |at: Vec3| Vec3::new(transform.x.dot(at), transform.y.dot(at), transform.z.dot(at));
    let (middle, half) = ((least + greatest) / 2.0, (greatest - least) / 2.0);
    // The other four corners lie opposite these.
    let corners = [Vec3::ONE, Vec3::new(-1.0, 1.0, 1.0), Vec3::new(1.0, -1.0, 1.0), Vec3::new(1.0, 1.0, -1.0)];
    let radius = corners.into_iter().map(|corner| moved(corner * half).length()).fold(0.0, f32::max);
    // The margin is more than what moving rounds.
    Ball { centre: moved(middle) + (transform.translation - origin), radius: radius + key.margin() }
}

/// The least box around balls.
fn bounds(balls: &[Ball]) -> [Vec3; 2] {
    let each = balls.iter().map(|ball| [ball.centre - ball.radius, ball.centre + ball.radius]);
    each.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).unwrap_or_default()
}

impl Group {
    fn new(members: Vec<Ball>) -> Self {
        /// More than the rounding of places within the scene's cube.
        const ROOM: f32 = 1.0 / (1 << 20) as f32;
        let [least, greatest] = bounds(&members);
        let centre = (least + greatest) / 2.0;
        let reach = |ball: &Ball| ball.centre.distance(centre) + ball.radius;
        let radius = members.iter().map(reach).fold(0.0, f32::max) + ROOM;
        Group { around: Ball { centre, radius }, members }
    }

    fn area(&self) -> f32 {
        self.around.radius * self.around.radius
    }

    /// Two parts, if they are together much smaller.
    fn parted(&self) -> Option<[Group; 2]> {
        /// Places along the longest axis that are tried.
        const PLACES: u32 = 8;
        let [least, greatest] = bounds(&self.members);
        let axis = (greatest - least).max_position();
        let at = |place: u32| least[axis] + (greatest - least)[axis] * place as f32 / PLACES as f32;
        let parts = |place: u32| {
            let (below, above): (Vec<Ball>, Vec<Ball>) =
                self.members.iter().partition(|ball| ball.centre[axis] < at(place));
            let are_two = !below.is_empty() && !above.is_empty();
            are_two.then(|| [Group::new(below), Group::new(above)])
        };
        let both = |parts: &[Group; 2]| parts[0].area() + parts[1].area();
        let best = (1..PLACES).filter_map(parts).min_by(|a, b| both(a).total_cmp(&both(b)))?;
        (both(&best) < SAVES * self.area()).then_some(best)
    }
}

/// Few balls around many.
fn gathered(balls: Vec<Ball>) -> Vec<Ball> {
    let (mut open, mut done) = (BinaryHeap::from([Group::new(balls)]), Vec::new());
    while let Some(largest) = open.pop() {
        match largest.parted().filter(|_| open.len() + done.len() + 2 <= MOST) {
            Some(halves) => open.extend(halves),
            None => done.push(largest.around),
        }
    }
    done
}

/// One around those in each cell of a grid. They depend neither on the order of the balls nor on how often each is there, which
/// hierarchies of different quality decide: photons go to the same places with all of them.
fn in_cells(balls: &[Ball]) -> Vec<Ball> {
    /// Cells along the longest edge.
    const CELLS: u32 = 64;
    let [least, greatest] = bounds(balls);
    let over = CELLS as f32 / (greatest - least).max_element().max(f32::MIN_POSITIVE);
    let mut cells = vec![Vec::new(); CELLS.pow(3) as usize];
    for ball in balls {
        let UVec3 { x, y, z } = ((ball.centre - least) * over).as_uvec3().min(UVec3::splat(CELLS - 1));
        cells[((z * CELLS + y) * CELLS + x) as usize].push(*ball);
    }
    cells.into_iter().filter(|cell| !cell.is_empty()).map(|cell| Group::new(cell).around).collect()
}

fn records(balls: &[Ball]) -> Vec<UVec4> {
    if balls.is_empty() {
        return Vec::new();
    }
    let balls = gathered(in_cells(balls));
    let [least, greatest] = bounds(&balls);
    let middle = (least + greatest) / 2.0;
    let mut records = vec![pack(middle, balls.len() as u32)];
    let area = |ball: &Ball| f64::from(ball.radius) * f64::from(ball.radius);
    let all: f64 = balls.iter().map(area).sum();
    let (mut sum, mut before) = (0.0, 0u64);
    for (number, ball) in balls.iter().enumerate() {
        /// All values of a draw.
        const DRAWS: f64 = (1u64 << 32) as f64;
        sum += area(ball);
        let is_last = number + 1 == balls.len();
        // Each ball is drawn by at least one value.
        let end = if is_last { 1 << 32 } else { ((sum / all * DRAWS) as u64).clamp(before + 1, (1 << 32) - 1) };
        let probability = ((end - before) as f64 / DRAWS) as f32;
        records.push(pack(ball.centre, (end - 1) as u32));
        records.push(pack(Vec3::new(ball.radius, probability, 0.0), 0));
        before = end;
    }
    records
}

/// The middle of casters, and how far they reach around it.
pub(crate) fn extent(records: &[UVec4]) -> Option<(Vec3, f32)> {
    let (first, balls) = records.split_first()?;
    let middle = numbers(*first);
    let reach = |ball: &[UVec4]| numbers(ball[0]).distance(middle) + numbers(ball[1]).x;
    Some((middle, balls.chunks_exact(2).map(reach).fold(0.0, f32::max)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(x: f32, y: f32, radius: f32) -> Ball {
        Ball { centre: Vec3::new(x, y, 0.0), radius }
    }

    /// Whatever casts is in some ball, and draws mean balls as often as their probabilities say: of clusters of many and of few, far
    /// apart, whatever order they come in and though some come twice.
    #[test]
    fn balls_hold_all_that_casts_and_draws_mean_each_as_often_as_it_is_large() {
        let clusters = [(-0.8, -0.7, 9000), (0.6, -0.5, 20), (0.1, 0.8, 1)];
        let member = |(x, y, count): (f32, f32, u32), i: u32| {
            let turn = i as f32 * 0.37;
            ball(x + 0.05 * turn.sin() * (i % 7) as f32, y + 0.03 * turn.cos(), 0.002 + 0.01 / count as f32)
        };
        let all: Vec<Ball> = clusters.into_iter().flat_map(|of| (0..of.2).map(move |i| member(of, i))).collect();
        let records = records(&all);
        let count = records[0].w as usize;
        assert!((3..=MOST).contains(&count) && records.len() == 1 + 2 * count, "{count}");
        let balls: Vec<(Vec3, f32)> =
            records[1..].chunks_exact(2).map(|ball| (numbers(ball[0]), numbers(ball[1]).x)).collect();
        assert!(balls.iter().all(|ball| ball.1 < 0.5), "{balls:?}");
        for own in &all {
            let is_in = |&(centre, radius): &(Vec3, f32)| own.centre.distance(centre) + own.radius <= radius + 1e-6;
            assert!(balls.iter().any(is_in), "{own:?}");
        }
        let mut before = -1i64;
        for ball in records[1..].chunks_exact(2) {
            let share = (i64::from(ball[0].w) - before) as f64 / (1u64 << 32) as f64;
            assert!((share - f64::from(numbers(ball[1]).y)).abs() < 1e-7, "{share}");
            before = ball[0].w.into();
        }
        assert_eq!(before, i64::from(u32::MAX));
        let (forth, back) = (all.iter().step_by(2), all.iter().rev());
        assert_eq!(super::records(&forth.chain(back).copied().collect::<Vec<_>>()), records);
    }

    /// However a copy is turned, stretched and moved: no corner of its mesh's box is outside, and the furthest is near the border.
    #[test]
    fn a_copy_lies_in_its_ball() {
        let (origin, [least, greatest]) =
            (Vec3::new(30.0, -2.0, 5.0), [Vec3::new(-0.7, -0.2, 0.1), Vec3::new(0.9, 0.3, 0.8)]);
        for turn in (0..40).map(|turn| turn as f32 * 0.16) {
            let (sin, cos) = turn.sin_cos();
            let rows = [
                Vec3::new(0.2 * cos, -0.02 * sin, 0.1),
                Vec3::new(0.2 * sin, 0.02 * cos, 0.3),
                Vec3::new(0.0, 0.4, -0.1),
            ];
            let at = origin + Vec3::new(0.1 * turn, 0.2, -0.3);
            let row = |axis: usize| pack(rows[axis], at[axis].to_bits());
            let key = Record { x: row(0), y: row(1), z: row(2), mesh: UVec4::new(0, 0, 0, 1e-6f32.to_bits()) };
            let ball = placed(&key, origin, [least, greatest]);
            let corner = |bits: u32| {
                let corner =
                    Vec3::from_array([0, 1, 2].map(|axis| if bits >> axis & 1 == 0 { least } else { greatest }[axis]));
                let moved = Vec3::from_array(rows.map(|row| row.dot(corner))) + (at - origin);
                moved.distance(ball.centre)
            };
            let furthest = (0..8).map(corner).fold(0.0, f32::max);
            assert!(furthest <= ball.radius && ball.radius < furthest + 1e-5, "{turn}: {furthest}, {ball:?}");
        }
    }

    #[test]
    fn a_ball_stays_one_and_what_is_far_apart_is_parted() {
        assert_eq!(records(&[ball(0.1, 0.0, 0.3)])[0].w, 1);
        assert_eq!(records(&[ball(-0.9, 0.0, 0.01), ball(0.9, 0.0, 0.01)])[0].w, 2);
        assert!(records(&[]).is_empty() && extent(&[]).is_none());
        let (middle, reach) = extent(&records(&[ball(-0.9, 0.0, 0.01), ball(0.9, 0.0, 0.01)])).unwrap();
        assert!(middle.length() < 1e-6 && (reach - 0.91).abs() < 1e-4, "{middle}, {reach}");
    }
}
