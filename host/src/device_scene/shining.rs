//! Primitives that emit light, where they stand in the scene.

use std::ops::Range;

use eyerays_shader::data::{Effects, Frame, Instance as Record, Launch, Primitive, Specialisation, pack};
use eyerays_shader::ray::Hit;
use eyerays_shader::scene::LaunchContext;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::copies;
use super::light_tree::Cone;
use super::lighting::normal;
use super::normalisation::Normalisation;
use crate::error::{Error, Result};
use crate::memory::Room;
use crate::scene::Scene;

/// One of them.
pub(super) struct Shining {
    /// As the shutter opens.
    pub primitive: Primitive,
    /// Its place in leaf order; of a split one any.
    pub index: u32,
    /// The first key of the copy that it is in, or [`Hit::NOTHING`].
    pub instance: u32,
    /// The least and the greatest corner while the shutter is open.
    pub bounds: [Vec3; 2],
    /// Where its front looks meanwhile.
    pub cone: Cone,
}

/// Where copies of meshes are.
#[derive(Default)]
pub(super) struct Places {
    /// The slots of each mesh.
    pub slots: Vec<Range<usize>>,
    /// The first key of each copy.
    pub firsts: Vec<usize>,
}

/// Those of a scene whose `primitives` lie in leaf order, the first `own` of them where they stand. Some may be there twice, as parts.
///
/// # Errors
/// Copies have more of them than there is memory for, or than numbers tell apart.
pub(super) fn of(
    scene: &Scene,
    normalisation: &Normalisation,
    (primitives, own): (&[Primitive], usize),
    (instances, places): (&[Record], &Places),
) -> Result<Vec<Shining>> {
    let emits: Vec<bool> = scene.materials.iter().map(|material| material.emission != Vec3::ZERO).collect();
    let two_sided: Vec<bool> = scene.materials.iter().map(|material| material.two_sided).collect();
    if !emits.contains(&true) {
        return Ok(Vec::new());
    }
    let is_lamp = |primitive: &Primitive| !primitive.is_instance() && emits[primitive.material() as usize];
    let lamps = |slots: Range<usize>| {
        let lamps = slots.filter(|&slot| is_lamp(&primitives[slot])).map(|slot| slot as u32);
        lamps.collect::<Vec<_>>()
    };
    let cone = |primitive: &Primitive| match primitive.is_sphere() {
        true => Cone::all(),
        false => Cone::flat(normal(primitive), two_sided[primitive.material() as usize]),
    };
    let still = |index: u32| {
        let primitive = primitives[index as usize];
        let (least, greatest) = primitive.bounds();
        Shining { primitive, index, instance: Hit::<f32>::NOTHING, bounds: [least, greatest], cone: cone(&primitive) }
    };
    let mut all: Vec<Shining> = lamps(0..own).into_iter().map(still).collect();
    let by_mesh: Vec<Vec<u32>> = places.slots.iter().cloned().map(lamps).collect();
    check(scene, &by_mesh)?;
    let steps = scene.motion.as_ref().map_or(0, |motion| motion.poses.len() as u32);
    let frame = Frame { origin: pack(copies::origin(normalisation), 0), steps, ..Frame::default() };
    let spec = Specialisation {
        effects: Effects(Effects::INSTANCED),
        launch: Launch(if steps > 0 { Launch::MOVING } else { 0 }),
        ..Specialisation::default()
    };
    let launch = LaunchContext::new(&frame, spec, bytemuck::cast_slice(primitives), instances);
    let moved = |(copy, &first): (usize, &usize)| {
        let times = if instances[first].moves() { 2 * steps } else { 0 };
        let shining = move |&index: &u32| {
            let at = |time: u32| launch.placed(index, first as u32, time as f32 / times.max(1) as f32);
            let primitive = at(0);
            let along: Vec<Primitive> = (0..=times).map(at).collect();
            let cones = along.iter().map(cone).reduce(Cone::with).unwrap_or(Cone::all());
            Shining { primitive, index, instance: first as u32, bounds: around(&along), cone: cones }
        };
        by_mesh[scene.instances[copy].mesh as usize].iter().map(shining).collect::<Vec<_>>()
    };
    all.par_extend(places.firsts.par_iter().enumerate().flat_map_iter(moved));
    all.sort_unstable_by_key(|shining| (shining.primitive.number(), shining.index));
    all.dedup_by_key(|shining| shining.primitive.number());
    Ok(all)
}

fn check(scene: &Scene, lamps: &[Vec<u32>]) -> Result<()> {
    /// What each takes, with its emitter and nodes, while all is packed.
    const BYTES: u64 = 512;
    let count: u64 = scene.instances.iter().map(|copy| lamps[copy.mesh as usize].len() as u64).sum();
    if count > 0 && scene.primitives() > u64::from(Record::NUMBERS) {
        let most = Record::NUMBERS;
        return Err(Error::new(format!(
            "copies of meshes emit light, and the scene has more than {most} primitives: use fewer copies, or lamps that are none"
        )));
    }
    let room = Room::now().check(count.saturating_mul(BYTES));
    room.map_err(|why| {
        Error::new(format!("copies of meshes have {count} triangles that emit light, which {why}; use fewer"))
    })
}

/// The box around a triangle on its way: at the ends of steps, and in the middle between. Each vertex goes along a parabola, which lies
/// within its ends and the point where their tangents meet.
fn around(along: &[Primitive]) -> [Vec3; 2] {
    let vertices = |of: &Primitive| of.vertices().map(|vertex| vertex.as_dvec3());
    let ends = along.iter().step_by(2).flat_map(vertices);
    let tangents = along.windows(3).step_by(2).flat_map(|step| {
        let [from, middle, to] = [0, 1, 2].map(|at| vertices(&step[at]));
        std::array::from_fn::<DVec3, 3, _>(|i| 2.0 * middle[i] - (from[i] + to[i]) / 2.0)
    });
    let (least, greatest) = along[0].bounds();
    if along.len() == 1 {
        return [least, greatest];
    }
    // More than positions are rounded by, and what boxes of primitives are padded with.
    let room = (least - along[0].vertices().into_iter().reduce(Vec3::min).unwrap_or(least)).abs() * 2.0;
    let nothing = [least, greatest];
    let all = ends.chain(tangents).map(|place| place.as_vec3());
    all.fold(nothing, |[least, greatest], place| [least.min(place - room), greatest.max(place + room)])
}
