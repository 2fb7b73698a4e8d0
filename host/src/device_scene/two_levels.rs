//! The hierarchies of a scene as one: that of what stands in the world, and behind it those of meshes that stand in several places,
//! to whose starts copies lead.

use std::ops::Range;

use eyerays_bvh::{Bvh, Limits, Quality, Statistics, linear};
use eyerays_shader::data::{CentredPair, Instance as Record, NodePair, NodeRef, Primitive};
use rayon::prelude::*;

use super::copies::{self, Bottom};
use super::hierarchy::{built, kept_or_built, refused};
use super::keys::{self, Bends};
use super::normalisation::Normalisation;
use super::shining::Places;
use super::{DeviceScene, flags, records};
use crate::error::{Error, Result};
use crate::scene::{Scene, SharedMesh};

/// Hierarchies, and what their leaves hold.
pub(super) struct Levels {
    /// All of them: pairs, order and own boxes. In that of the world, pairs lead to copies where it has leaves of one. Only that has wide
    /// nodes.
    pub bvh: Bvh,
    /// Pairs and slots of that of the world.
    pub top: (usize, usize),
    /// Triangles, spheres, disks and copies: what the order numbers.
    pub primitives: Vec<Primitive>,
    /// Copies of meshes.
    pub instances: Vec<Record>,
    /// Where the copies and their meshes are.
    pub places: Places,
    /// Triangles of meshes in their later shapes, the last in the order.
    pub bends: Bends,
    /// Of that of the world, unless it is left open.
    pub statistics: Option<Statistics>,
    /// Do some primitives have several slots?
    pub is_split: bool,
    /// Is it that of the scene before?
    pub is_fitted: bool,
}

impl Levels {
    /// Builds those of a scene that was checked, or takes the one that it brings along; `is_wide` with nodes of eight children, too. That of
    /// the scene as it was `before` is fitted to it where that will do.
    ///
    /// # Errors
    /// What builders refuse.
    pub fn new(
        scene: &Scene,
        normalisation: &Normalisation,
        (quality, is_wide): (Quality, bool),
        before: Option<&DeviceScene>,
    ) -> Result<Self> {
        let cubes: Vec<Normalisation> = (0..scene.shared.len()).map(|mesh| copies::cube(scene, mesh)).collect();
        let mut primitives = records::primitives(scene, normalisation, &cubes);
        if scene.shared.is_empty() {
            if quality == Quality::Linear
                && !is_wide
                && primitives.len() > 1
                && primitives.iter().all(Primitive::is_triangle)
            {
                return Self::left_open(primitives);
            }
            let fitted = before.and_then(|before| before.fitted(&primitives));
            let is_fitted = fitted.is_some();
            let mut bvh = fitted.map_or_else(|| kept_or_built(scene, &primitives, quality), Ok)?;
            widen(&mut bvh, is_wide)?;
            let statistics = Some(Statistics::of(&bvh, &primitives));
            let top = (bvh.nodes.len(), bvh.order.len());
            let is_split = bvh.order.len() > primitives.len();
            let (instances, places, bends) = (Vec::new(), Places::default(), Bends::default());
            return Ok(Levels { bvh, top, primitives, instances, places, bends, statistics, is_split, is_fitted });
        }
        let bottom = |(mesh, shared): (usize, &SharedMesh)| {
            if scene.motion.as_ref().is_some_and(|motion| motion.is_bent(mesh as u32)) {
                return Bottom::new(&keys::boxes(scene, mesh, &cubes[mesh]), quality);
            }
            Bottom::new(&primitives[shared.triangles.clone()], quality)
        };
        let bottoms: Vec<Bottom> = scene.shared.par_iter().enumerate().map(bottom).collect::<Result<_>>()?;
        let (firsts, by_object) = (scene.first_numbers(), flags::by_object(scene));
        let flags = |number: usize| by_object(firsts[number]);
        let (mut instances, boxes) = copies::records(scene, normalisation, (&cubes, &bottoms), flags);
        let own: Vec<u32> = in_the_world(scene, primitives.len(), boxes.len()).collect();
        primitives.extend(boxes);
        let above: Vec<Primitive> = own.par_iter().map(|&primitive| primitives[primitive as usize]).collect();
        let mut bvh = built(&above, quality, Limits::OF_LEVELS)?;
        widen(&mut bvh, is_wide)?;
        let statistics = Some(Statistics::of(&bvh, &above));
        bvh.order.par_iter_mut().for_each(|primitive| *primitive = own[*primitive as usize]);
        let top = (bvh.nodes.len(), bvh.order.len());
        let firsts = primitives[primitives.len() - scene.instances.len()..].iter().map(|copy| copy.number() as usize);
        let firsts: Vec<usize> = firsts.collect();
        firsts.iter().for_each(|&first| instances[first].mesh.x += top.0 as u32);
        let mut slots = Vec::with_capacity(bottoms.len());
        for (Bottom { bvh: bottom, .. }, shared) in bottoms.into_iter().zip(&scene.shared) {
            slots.push(bvh.order.len()..bvh.order.len() + bottom.order.len());
            append(&mut bvh, bottom, shared.triangles.start as u32)?;
        }
        lead(&mut bvh, top.0, &primitives, instances.len())?;
        let is_split = bvh.order.len() > primitives.len();
        let bends = bends(scene, (&slots, &firsts), &mut bvh.order, &mut instances);
        let places = Places { slots, firsts };
        Ok(Levels { bvh, top, primitives, instances, places, bends, statistics, is_split, is_fitted: false })
    }
}

/// Adds the triangles of meshes in their later shapes, and tells the keys of their copies where those are.
fn bends(
    scene: &Scene,
    (slots, firsts): (&[Range<usize>], &[usize]),
    order: &mut Vec<u32>,
    instances: &mut [Record],
) -> Bends {
    let mut bends = Bends::default();
    let Some(motion) = &scene.motion else { return bends };
    for mesh in motion.bent() {
        let behind = bends.add(slots[mesh].clone(), motion.poses.len(), order);
        let copies = firsts.iter().zip(&scene.instances).filter(|(_, copy)| copy.mesh as usize == mesh);
        for (&first, _) in copies {
            instances[first + 1..].iter_mut().zip(&behind).for_each(|(key, &behind)| key.mesh.x = behind);
        }
    }
    bends
}

impl Levels {
    /// Triangles in the order that they have, whose hierarchy a device builds, or whoever asks for it first.
    fn left_open(primitives: Vec<Primitive>) -> Result<Self> {
        linear::check(&primitives).map_err(refused)?;
        let order = (0..primitives.len() as u32).collect();
        let bvh = Bvh { nodes: Vec::new(), wide: Vec::new(), order, bounds: Vec::new() };
        let (top, instances, places) = ((0, primitives.len()), Vec::new(), Places::default());
        let bends = Bends::default();
        Ok(Levels {
            bvh,
            top,
            primitives,
            instances,
            places,
            bends,
            statistics: None,
            is_split: false,
            is_fitted: false,
        })
    }
}

/// Makes leaves of a copy lead to it: a number behind those of all pairs stands for it.
fn lead(bvh: &mut Bvh, top: usize, primitives: &[Primitive], records: usize) -> Result<()> {
    let pairs = bvh.nodes.len() as u64;
    let most = u64::from(NodeRef::MAX_INDEX);
    let last = pairs + records as u64;
    if last > most {
        return Err(Error::new(format!("pairs of nodes and copies of meshes are {last}, more than {most}; use fewer")));
    }
    let order = &bvh.order;
    let lead = |child: NodeRef| {
        let copy = child.is_leaf().then(|| &primitives[order[child.index() as usize] as usize]);
        copy.filter(|copy| copy.is_instance()).map_or(child, |copy| NodeRef::inner(pairs as u32 + copy.number()))
    };
    bvh.nodes[..top].par_iter_mut().for_each(|pair| {
        pair.left_min.w = lead(pair.left()).0;
        pair.right_min.w = lead(pair.right()).0;
    });
    Ok(())
}

fn widen(bvh: &mut Bvh, is_wide: bool) -> Result<()> {
    if is_wide { bvh.widen().map_err(refused) } else { Ok(()) }
}

/// The numbers in the list of all primitives of those that stand in the world; its last are copies.
fn in_the_world(scene: &Scene, count: usize, copies: usize) -> impl Iterator<Item = u32> {
    let triangles = 0..scene.own_triangles() as u32;
    triangles.chain(scene.mesh.triangles.len() as u32..(count + copies) as u32)
}

/// Adds a hierarchy behind others, whose primitives start at `first` in the list of all.
fn append(all: &mut Bvh, more: Bvh, first: u32) -> Result<()> {
    let (pairs, slots) = (all.nodes.len(), all.order.len());
    let most = NodeRef::MAX_INDEX as usize;
    if pairs + more.nodes.len() > most || slots + more.order.len() > most {
        return Err(Error::new(format!(
            "the meshes have more than {most} triangles in all; use fewer or simpler ones"
        )));
    }
    let moved = |child: NodeRef| {
        if child.is_leaf() {
            NodeRef::leaf(slots as u32 + child.index(), child.count())
        } else {
            NodeRef::inner(pairs as u32 + child.index())
        }
    };
    all.nodes.par_extend(more.nodes.into_par_iter().map(|mut pair: NodePair| {
        pair.left_min.w = moved(pair.left()).0;
        pair.right_min.w = moved(pair.right()).0;
        pair
    }));
    all.order.extend(more.order.iter().map(|&primitive| first + primitive));
    all.bounds.extend(more.bounds);
    Ok(())
}

/// The first pairs as they were before they led to copies.
pub(super) fn leaves(pairs: &[CentredPair], top: usize, primitives: &[Primitive]) -> Vec<CentredPair> {
    let copies = primitives.iter().enumerate().filter(|(_, primitive)| primitive.is_instance());
    let mut slots: Vec<(u32, u32)> = copies.map(|(slot, copy)| (copy.number(), slot as u32)).collect();
    slots.par_sort_unstable();
    let slot = |copy: u32| slots[slots.partition_point(|&(number, _)| number < copy)].1;
    let leaf = |child: NodeRef| match child.index().checked_sub(pairs.len() as u32) {
        Some(copy) if !child.is_leaf() => NodeRef::leaf(slot(copy), 1),
        _ => child,
    };
    let mut pairs = pairs[..top].to_vec();
    pairs.par_iter_mut().for_each(|pair| {
        pair.left_centre.w = leaf(pair.left()).0;
        pair.right_centre.w = leaf(pair.right()).0;
    });
    pairs
}
