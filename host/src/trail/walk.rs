//! The steps of the kernels' traversals, one by one, with all that they decide by.
//!
//! Kernels tell when they visit a node, not which, and what they do not tell costs them nothing. So their steps are repeated here, by
//! the same tests of boxes and primitives, and what [`tape`](super::tape) has of the kernel itself must be the same events.

use eyerays_shader::data::{CentredPair, Effects, NodeRef, STACK};
use eyerays_shader::geometry::Span;
use eyerays_shader::ray::{Hit, Ray};
use eyerays_shader::real::{Lanes, Mask, Real};
use eyerays_shader::scene::TraceContext;
use eyerays_shader::traverse::lanes::RayLanes;
use eyerays_shader::traverse::step;

use super::block::Block;
use super::parting::{Parting, everyone};
use super::step::{Child, Fate, Target, Visit};
use super::tape::{Event, intersect};
use crate::method::Method;

/// Who hears of the steps. A step is of the lanes of a mask; what it is for one of them is told where that is asked for, in the kernels'
/// own lengths.
pub(super) trait Witness {
    /// A kernel does something.
    fn event(&mut self, _event: Event) {}
    /// Some lanes visit a node so deep.
    fn visit(&mut self, lanes: u32, depth: u32, tell: impl Fn(usize) -> Visit);
    /// Some lanes test a primitive.
    fn test(&mut self, lanes: u32, tell: impl Fn(usize) -> Trial);
    /// Some lanes leave out what waited, which they would enter at this distance.
    fn drop(&mut self, _lanes: u32, _child: Target, _near: f32) {}
}

/// The test of a primitive for one ray.
pub(super) struct Trial {
    /// The primitive's number in the scene.
    pub primitive: u32,
    /// What the ray finds of the primitive alone.
    pub met: Hit<f32>,
    /// Is it the closest so far?
    pub is_closest: bool,
}

/// A node that waits.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    pub node: NodeRef,
    /// The copy of a mesh that it is in, or [`Hit::NOTHING`].
    pub instance: u32,
    pub depth: u32,
}

/// The way of rays through a scene.
pub(super) struct Walk<'w, W> {
    pub context: &'w TraceContext<'w>,
    pub block: &'w Block,
    pub witness: &'w mut W,
    /// Is it in a leaf whose primitives the kernel does not tell one by one?
    pub is_in_block: bool,
}

impl<'w, W: Witness> Walk<'w, W> {
    pub fn new(context: &'w TraceContext<'w>, block: &'w Block, witness: &'w mut W) -> Self {
        Walk { context, block, witness, is_in_block: false }
    }

    /// Follows the ray of a lane by a method, or all of its packet, and returns what it finds.
    pub fn follow(&mut self, method: Method, lane: usize) -> Hit<f32> {
        let root = Waiting { node: NodeRef::ROOT, instance: Hit::<f32>::NOTHING, depth: 0 };
        if super::is_packet(method) {
            let (ray, mut hit) = self.block.packet();
            let parting = Parting::of(method, self.context.base.spec.tuning);
            self.pairs((&ray, &mut hit), self.block.lanes, vec![root], parting);
            return hit.lane(lane);
        }
        let (ray, limit) = self.block.ray(lane);
        let mut hit = Hit::none(limit);
        match method {
            Method::Wide => self.nodes((&ray, &mut hit), lane),
            _ => self.pairs((&ray, &mut hit), 1 << lane, vec![root], Parting::Never),
        }
        hit
    }

    /// Walks pairs of nodes until nothing waits: the rays of some lanes together, or one.
    pub fn single(&mut self, (ray, hit): (&Ray<f32>, &mut Hit<f32>), lane: usize, waiting: Vec<Waiting>) {
        self.pairs((ray, hit), 1 << lane, waiting, Parting::Never);
    }

    fn pairs<R>(&mut self, (ray, hit): (&Ray<R>, &mut Hit<R>), lanes: u32, mut waiting: Vec<Waiting>, parting: Parting)
    where
        R: RayLanes<Lane = f32> + Lanes<f32>,
    {
        let mut deferred = Vec::new();
        while let Some(at) = waiting.pop() {
            match parting {
                Parting::Full { most, rejoins: true } if waiting.len() >= most as usize => {
                    self.alone((ray, hit), everyone::<R>(), &[at]);
                }
                Parting::Full { most, rejoins: false } if waiting.len() >= most as usize => {
                    waiting.push(at);
                    self.alone((ray, hit), everyone::<R>(), &waiting);
                    waiting.clear();
                }
                _ if at.node.is_leaf() => self.leaf((ray, hit), lanes, at),
                _ => self.open((ray, hit), (lanes, at), parting, (&mut waiting, &mut deferred)),
            }
        }
        while let Some((at, rays)) = deferred.pop() {
            self.alone((ray, hit), rays, &[at]);
        }
    }

    /// Each ray of a mask by itself.
    fn alone<R>(&mut self, (ray, hit): (&Ray<R>, &mut Hit<R>), rays: R::Mask, waiting: &[Waiting])
    where
        R: RayLanes<Lane = f32> + Lanes<f32>,
    {
        self.witness.event(Event::Parted(true));
        let mut open = R::bits(rays);
        R::each_lane(ray, hit, rays, |ray, hit| {
            let lane = open.trailing_zeros() as usize;
            open &= open - 1;
            self.single((ray, hit), lane, waiting.to_vec());
        });
        self.witness.event(Event::Parted(false));
    }

    /// Tests the boxes of a pair, and decides what is visited next.
    fn open<R>(
        &mut self,
        (ray, hit): (&Ray<R>, &mut Hit<R>),
        (lanes, at): (u32, Waiting),
        parting: Parting,
        (waiting, deferred): (&mut Vec<Waiting>, &mut Vec<(Waiting, R::Mask)>),
    ) where
        R: RayLanes<Lane = f32> + Lanes<f32>,
    {
        self.witness.event(Event::Node);
        let (pair, instance) = self.context.hierarchy().opened(at.node, at.instance, ray.time);
        let below = |node| Waiting { node, instance, depth: at.depth + 1 };
        let children = [below(pair.left()), below(pair.right())];
        let spans = spans(&pair, ray, hit);
        let met = spans.map(|span| span.near.le(span.far));
        let turned = (met[0] & met[1] & spans[1].near.lt(spans[0].near)).any();
        let leaves = met.map(|rays| parting.leaves::<R>(rays));
        let goes = [0, 1].map(|child| met[child].any() && !leaves[child]);
        let order = if turned { [1, 0] } else { [0, 1] };
        let fates = fates(goes, [0, 1].map(|child| leaves[child] && met[child].any()), order);
        self.told(lanes, (at, instance), children, &Boxes { spans, met, fates });
        for child in 0..2 {
            if leaves[child] && met[child].any() {
                let now = matches!(parting, Parting::Few { rejoins: true, .. }) || deferred.len() == STACK;
                match now {
                    true => self.alone((ray, hit), met[child], &[children[child]]),
                    false => deferred.push((children[child], met[child])),
                }
            }
        }
        waiting.extend(order.into_iter().rev().filter(|&child| goes[child]).map(|child| children[child]));
    }

    /// Tells a visit of a pair.
    fn told<R: Lanes<f32>>(
        &mut self,
        lanes: u32,
        (at, instance): (Waiting, u32),
        children: [Waiting; 2],
        boxes: &Boxes<R>,
    ) {
        let context = self.context;
        self.witness.visit(lanes, at.depth, |lane| {
            let lane = lane % R::COUNT as usize;
            let child = |i: usize| Child {
                child: target(context, children[i].node),
                near: boxes.spans[i].near.lane(lane).into(),
                far: boxes.spans[i].far.lane(lane).into(),
                rays: R::bits(boxes.met[i]).count_ones(),
                fate: boxes.fates[i],
            };
            Visit {
                node: number(context, at.node),
                copy: (instance != Hit::<f32>::NOTHING).then_some(instance),
                depth: at.depth,
                rays: lanes.count_ones(),
                children: [0, 1].map(child).into(),
            }
        });
    }

    /// Tests all that a leaf holds.
    fn leaf<R: Lanes<f32>>(&mut self, (ray, hit): (&Ray<R>, &mut Hit<R>), lanes: u32, at: Waiting) {
        let mut leaf = at.node;
        while leaf.is_leaf() {
            self.primitive((ray, hit), lanes, (leaf.index(), at.instance));
            leaf = leaf.rest();
        }
    }

    /// Tests a primitive by its index in leaf order and the copy that it is in.
    pub fn primitive<R: Lanes<f32>>(&mut self, (ray, hit): (&Ray<R>, &mut Hit<R>), lanes: u32, place: (u32, u32)) {
        if !self.is_in_block {
            self.witness.event(Event::Primitive(place.0, place.1));
        }
        let before = *hit;
        intersect(self.context, place, ray, hit);
        let (context, block, after) = (self.context, self.block, *hit);
        self.witness.test(lanes, |lane| {
            let (ray, limit) = block.ray(lane);
            let mut met = Hit::none(limit);
            intersect(context, place, &ray, &mut met);
            let lane = lane % R::COUNT as usize;
            let found = |hit: &Hit<R>| (hit.t.lane(lane).to_bits(), R::index_of(hit.primitive_index, lane));
            let primitive = context.base.placed(place.0, place.1, ray.time).number();
            Trial { primitive, met, is_closest: found(&before) != found(&after) }
        });
    }
}

/// What the test of two boxes gave.
struct Boxes<R: Real> {
    spans: [Span<R>; 2],
    met: [R::Mask; 2],
    fates: [Fate; 2],
}

fn spans<R: Real>(pair: &CentredPair, ray: &Ray<R>, hit: &Hit<R>) -> [Span<R>; 2] {
    let of = [(pair.left_centre, pair.left_half), (pair.right_centre, pair.right_half)];
    of.map(|(centre, half)| step::inside(centre, half, ray, hit.t))
}

/// What becomes of two children: some are visited, in this order, and some by rays alone.
fn fates(goes: [bool; 2], leaves: [bool; 2], order: [usize; 2]) -> [Fate; 2] {
    [0, 1].map(|child| match (goes[child], leaves[child]) {
        (_, true) => Fate::Alone,
        (false, _) => Fate::Missed,
        (true, _) if order[0] == child || !goes[order[0]] => Fate::Next,
        (true, _) => Fate::Pushed,
    })
}

/// What a reference to a node leads to.
fn target(context: &TraceContext<'_>, node: NodeRef) -> Target {
    let pairs = context.base.frame.pairs;
    match node.is_leaf() {
        true => Target::Leaf { number: node.index(), primitives: node.count() },
        false if is_copy(context, node) => Target::Copy(node.index() - pairs),
        false => Target::Node(node.index()),
    }
}

/// The number of the pair that a reference leads to, of a copy that of the first of its mesh.
fn number(context: &TraceContext<'_>, node: NodeRef) -> u32 {
    match is_copy(context, node) {
        true => context.base.instances[(node.index() - context.base.frame.pairs) as usize].root(),
        false => node.index(),
    }
}

fn is_copy(context: &TraceContext<'_>, node: NodeRef) -> bool {
    context.base.spec.effects.has(Effects::INSTANCED) && node.index() >= context.base.frame.pairs
}
