//! Records of the copies of meshes.

use eyerays_bvh::{Bvh, Limits, Quality};
use eyerays_shader::data::{BOX_PADDING, CentredPair, Instance as Record, NodePair, NodeRef, Primitive, numbers, pack};
use eyerays_shader::geometry::Transform;
use glam::{DVec3, UVec4, Vec3};
use rayon::prelude::*;

use super::hierarchy::built;
use super::normalisation::Normalisation;
use crate::error::Result;
use crate::scene::{Instance, Primitives, Scene, SharedMesh};

/// A roundoff of single precision.
const U: f64 = 1.0 / (1 << 24) as f64;

/// What a shared mesh is multiplied by so that it lies in [-1, 1] in each of its shapes: a power of two.
pub(super) fn cube(scene: &Scene, number: usize) -> Normalisation {
    let own = scene.mesh.positions[scene.shared[number].vertices.clone()].iter();
    let poses = scene.motion.iter().flat_map(|motion| &motion.poses);
    let shapes = poses.flat_map(|pose| &pose.shapes).filter(|(mesh, _)| *mesh as usize == number);
    Normalisation::of(own.chain(shapes.flat_map(|(_, shape)| &shape.positions)).copied(), false)
}

/// A copy's transform from the cube of its mesh to the scene's, before the scene's origin is taken off.
fn normalised(transform: &Transform, cube: &Normalisation, scene: &Normalisation) -> Transform {
    let row = |row: Vec3| (row.as_dvec3() * (scene.scale / cube.scale)).as_vec3();
    Transform {
        x: row(transform.x),
        y: row(transform.y),
        z: row(transform.z),
        translation: (transform.translation.as_dvec3() * scene.scale).as_vec3(),
        side: transform.side,
    }
}

/// Where the scene's origin is in the units of transforms that [`normalised`] gives.
pub(super) fn origin(scene: &Normalisation) -> Vec3 {
    (scene.origin.as_dvec3() * scene.scale).as_vec3()
}

/// How large the numbers are on an axis that a place of a mesh in [-1, 1] is a sum of, at most.
fn sums(transform: &Transform, origin: Vec3) -> DVec3 {
    let rows = [transform.x, transform.y, transform.z].map(|row| row.as_dvec3().abs().element_sum());
    DVec3::from_array(rows) + transform.translation.as_dvec3().abs() + origin.as_dvec3().abs()
}

/// How far boxes of a mesh are widened that were moved: by the padding of primitives and the margin of nodes, since theirs are of
/// another size there; and by 16 roundoffs of the numbers that moved vertices and boxes are sums of, of which each takes 4.
fn margin(transform: &Transform, origin: Vec3) -> f32 {
    let rounding = 16.0 * U * sums(transform, origin).max_element();
    ((f64::from(BOX_PADDING + CentredPair::MARGIN) + rounding) * (1.0 + 2.0 * U)) as f32
}

/// The hierarchy of a mesh, and boxes around parts of it that are together around all of it.
pub(super) struct Bottom {
    pub bvh: Bvh,
    parts: Vec<[DVec3; 2]>,
}

impl Bottom {
    /// Builds that of some triangles in their cube, or of boxes around them.
    ///
    /// # Errors
    /// What the builder refuses.
    pub fn new(primitives: &[Primitive], quality: Quality) -> Result<Self> {
        let bvh = built(primitives, quality, Limits::OF_LEVELS)?;
        let parts = parts(&bvh.nodes);
        Ok(Bottom { bvh, parts })
    }

    /// A box around a copy in the normalised scene: of the moved parts, with what rounding and padding add, that of a transform
    /// between two keys, too.
    fn bounds(&self, transform: &Transform, origin: Vec3) -> [Vec3; 2] {
        let rows = [transform.x, transform.y, transform.z].map(Vec3::as_dvec3);
        let added = transform.translation.as_dvec3() - origin.as_dvec3();
        let most = DVec3::splat(1.0 + f64::from(BOX_PADDING));
        let room = sums(transform, origin) * (16.0 * U) + 1.01 * f64::from(BOX_PADDING);
        let moved = |&[low, high]: &[DVec3; 2]| {
            let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
            let at = DVec3::from_array(rows.map(|row| row.dot(middle))) + added;
            let around = DVec3::from_array(rows.map(|row| row.abs().dot(half))) + room;
            [at - around, at + around]
        };
        let widest = |[a, b]: [DVec3; 2], [c, d]: [DVec3; 2]| [a.min(c), b.max(d)];
        let [least, greatest] = self.parts.iter().map(moved).reduce(widest).expect("a mesh has a part");
        [least.max(-most).as_vec3(), greatest.min(most).as_vec3()]
    }
}

/// Boxes of nodes near the root that are together around all that is below it.
fn parts(nodes: &[NodePair]) -> Vec<[DVec3; 2]> {
    /// More make copies' boxes hardly tighter.
    const PARTS: usize = 16;
    let children = |pair: u32| {
        let pair = &nodes[pair as usize];
        let child = |least: UVec4, greatest: UVec4| ([numbers(least), numbers(greatest)], NodeRef(least.w));
        [child(pair.left_min, pair.left_max), child(pair.right_min, pair.right_max)]
    };
    let (mut parts, mut open) = (Vec::new(), vec![0]);
    while let Some(pair) = open.pop() {
        for (bounds, below) in children(pair) {
            // The right child of a single triangle's tree is outside of every scene.
            if bounds[0].x > 1.5 {
                continue;
            }
            if below.is_leaf() || parts.len() + open.len() >= PARTS {
                parts.push(bounds.map(Vec3::as_dvec3));
            } else {
                open.insert(0, below.index());
            }
        }
    }
    parts
}

/// The records of all copies, each that moves with its keys, and their boxes while the shutter is open, as primitives of the hierarchy
/// above, by the numbers of their first records.
pub(super) fn records(
    scene: &Scene,
    normalisation: &Normalisation,
    (cubes, bottoms): (&[Normalisation], &[Bottom]),
    flags: impl Fn(usize) -> u32 + Sync,
) -> (Vec<Record>, Vec<Primitive>) {
    let mut roots = Vec::with_capacity(bottoms.len());
    let mut next = 0;
    for bottom in bottoms {
        roots.push(next);
        next += bottom.bvh.nodes.len() as u32;
    }
    let (origin, firsts) = (origin(normalisation), scene.first_numbers());
    let record = |(number, instance): (usize, &Instance)| {
        let mesh = instance.mesh as usize;
        let transform = normalised(&instance.transform(), &cubes[mesh], normalisation);
        let added = transform.translation.to_array().map(f32::to_bits);
        let first = (firsts[number] % u64::from(Record::NUMBERS)) as u32;
        let mirrors = if transform.side < 0.0 { Record::MIRRORS } else { 0 };
        let margin = margin(&transform, origin).to_bits();
        let record = Record {
            x: pack(transform.x, added[0]),
            y: pack(transform.y, added[1]),
            z: pack(transform.z, added[2]),
            mesh: UVec4::new(roots[mesh], first, flags(number) | mirrors, margin),
        };
        (record, bottoms[mesh].bounds(&transform, origin))
    };
    let Some(motion) = &scene.motion else {
        let alone = |(number, instance)| {
            let (record, [least, greatest]) = record((number, instance));
            (record, Primitive::instance(least, greatest, number as u32))
        };
        return scene.instances.par_iter().enumerate().map(alone).unzip();
    };
    let keys = |(number, instance): (usize, &Instance)| {
        let later = motion.poses.iter().map(|pose| &pose.instances[number]);
        let first = record((number, instance));
        if motion.moves(number, instance) {
            [first].into_iter().chain(later.map(|other| record((number, other)))).collect()
        } else {
            vec![first]
        }
    };
    let keys: Vec<Vec<(Record, [Vec3; 2])>> = scene.instances.par_iter().enumerate().map(keys).collect();
    let (mut all, mut boxes) = (Vec::new(), Vec::new());
    for keys in keys {
        let number = all.len() as u32;
        let [least, greatest] =
            keys.iter().map(|&(_, of)| of).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).unwrap_or_default();
        boxes.push(Primitive::instance(least, greatest, number));
        let moves = if keys.len() > 1 { Record::MOVES } else { 0 };
        let margin = keys.iter().map(|(key, _)| key.margin()).fold(0.0, f32::max).to_bits();
        all.extend(keys.into_iter().enumerate().map(|(key, (record, _))| {
            let UVec4 { x: root, y: first, z: flags, .. } = record.mesh;
            Record { mesh: UVec4::new(if key == 0 { root } else { 0 }, first, flags | moves, margin), ..record }
        }));
    }
    (all, boxes)
}

/// A scene in which each copy of a mesh can be one: objects are flattened whose meshes emit light. Pictures of it have the bits of the
/// scene flattened, if that is done afterwards.
#[must_use]
pub fn fitted(scene: Scene) -> Scene {
    let is = unfit_objects(&scene);
    if is.contains(&true) { scene.flattened_where(&is) } else { scene }
}

/// Triangles that [`fitted`] makes.
pub(crate) fn unfit_triangles(scene: &Scene) -> u64 {
    let objects = scene.objects.iter().zip(unfit_objects(scene)).filter(|(_, is)| *is);
    objects.map(|(object, _)| scene.triangles_of(object.primitives.instances(&scene.instances))).sum()
}

/// Whether objects are copies of meshes whose numbers change by more than their exponents when they are normalised.
pub(crate) fn unfit_objects(scene: &Scene) -> Vec<bool> {
    /// Numbers between one over this and this are normal in any units.
    const MOST: f32 = (1u64 << 60) as f32;
    let is_held = |x: f32| x == 0.0 || (1.0 / MOST..=MOST).contains(&x.abs());
    let are_held = |v: &Vec3| v.to_array().into_iter().all(is_held);
    let is_odd = |copy: &Instance| !copy.rows.iter().chain([&copy.translation]).all(are_held);
    let is_unfit = |shared: &SharedMesh| {
        let mut places = scene.mesh.positions[shared.vertices.clone()].iter();
        places.any(|place| place.abs().max_element() > MOST)
    };
    let unfit: Vec<bool> = scene.shared.par_iter().map(is_unfit).collect();
    let is = |primitives: &Primitives| {
        let mut copies = primitives.instances(&scene.instances).iter();
        copies.any(|copy| unfit[copy.mesh as usize] || is_odd(copy))
    };
    scene.objects.iter().map(|object| is(&object.primitives)).collect()
}
