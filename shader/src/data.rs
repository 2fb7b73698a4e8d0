//! Every record that lives in device memory, once, for the host and for the kernels.
//!
//! A record is made of 16-byte words of three numbers and an integer. Numbers travel as their bits,
//! so that an index never passes through a float register (a small integer is a subnormal float,
//! which a device may flush). Coordinates are in the normalised scene: the host divides the scene by
//! a power of two so that every coordinate, cameras included, lies in [-1, 1].

use crate::real::Real;
use bytemuck::{Pod, Zeroable};
use glam::{UVec4, Vec3};

/// Three numbers and an integer in the 16 bytes that a GPU loads at once.
#[inline(always)]
pub fn pack(v: Vec3, word: u32) -> UVec4 {
    UVec4::new(v.x.to_bits(), v.y.to_bits(), v.z.to_bits(), word)
}

/// The three numbers of a packed word.
#[inline(always)]
pub fn numbers(q: UVec4) -> Vec3 {
    Vec3::new(f32::from_bits(q.x), f32::from_bits(q.y), f32::from_bits(q.z))
}

/// The most triangles a leaf holds (thesis chapter 6: "less than six").
pub const MAX_LEAF: u32 = 5;
/// Entries of a traversal stack; `eyerays-bvh` builds no tree that needs more.
pub const STACK: usize = 64;
/// Half a box's padding in the normalised scene; see `intersect::triangle` for the bound it covers.
pub const BOX_PADDING: f32 = 1.0 / (1 << 20) as f32;

/// A reference to a node: a pair of children, or a run of triangles.
///
/// Bits 0 to 2 count the triangles of a leaf (1 to [`MAX_LEAF`]), 0 for an inner node; bits 3 to 31
/// are the index of the child pair or of the first triangle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct NodeRef(pub u32);

impl NodeRef {
    /// The largest index a reference holds.
    pub const MAX_INDEX: u32 = (1 << 29) - 1;
    /// The pair that traversal starts with.
    pub const ROOT: NodeRef = NodeRef(0);

    /// The inner node whose children are pair `pair`.
    #[inline(always)]
    pub fn inner(pair: u32) -> Self {
        NodeRef(pair << 3)
    }

    /// The leaf of `count` triangles from `first` on.
    #[inline(always)]
    pub fn leaf(first: u32, count: u32) -> Self {
        NodeRef((first << 3) | count)
    }

    /// Is this a run of triangles?
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & 7 != 0
    }

    /// The child pair, or the first triangle of the run.
    #[inline(always)]
    pub fn index(self) -> u32 {
        self.0 >> 3
    }

    /// How many triangles a leaf has left; 0 for an inner node.
    #[inline(always)]
    pub fn count(self) -> u32 {
        self.0 & 7
    }

    /// The same run without its first triangle; `count() == 0` once it is used up.
    #[inline(always)]
    pub fn rest(self) -> Self {
        NodeRef(self.0.wrapping_add(8 - 1))
    }
}

/// The boxes of two siblings in one 64-byte block (thesis figure 6.1). A leaf's box bounds its
/// triangles' own boxes ([`Triangle::bounds`]), an inner node's box bounds its children's.
///
/// A tree of one triangle has one pair, whose right child is [`NodePair::EMPTY`].
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct NodePair {
    /// Least corner of the left box, and the left [`NodeRef`].
    pub left_min: UVec4,
    /// Greatest corner of the left box; the integer is 0.
    pub left_max: UVec4,
    /// Least corner of the right box, and the right [`NodeRef`].
    pub right_min: UVec4,
    /// Greatest corner of the right box; the integer is 0.
    pub right_max: UVec4,
}

impl NodePair {
    /// The right child of a tree of one triangle: a point outside the scene. Its reference is the
    /// first triangle, so that a ray that does meet it finds nothing new.
    pub const EMPTY: (Vec3, Vec3, NodeRef) = (Vec3::splat(2.0), Vec3::splat(2.0), NodeRef(1));

    /// A pair of (least corner, greatest corner, reference).
    pub fn new(left: (Vec3, Vec3, NodeRef), right: (Vec3, Vec3, NodeRef)) -> Self {
        NodePair {
            left_min: pack(left.0, left.2.0),
            left_max: pack(left.1, 0),
            right_min: pack(right.0, right.2.0),
            right_max: pack(right.1, 0),
        }
    }

    /// The left child's reference.
    #[inline(always)]
    pub fn left(&self) -> NodeRef {
        NodeRef(self.left_min.w)
    }

    /// The right child's reference.
    #[inline(always)]
    pub fn right(&self) -> NodeRef {
        NodeRef(self.right_min.w)
    }
}

/// The boxes of two siblings as kernels test them: by centre and half their extent, which spares a minimum
/// and a maximum an axis, each as dear on a GPU as two sums.
///
/// Such a test rounds otherwise than that of a triangle's own box, so these boxes are wider than what
/// they hold by [`CentredPair::MARGIN`]; see `traverse::step`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct CentredPair {
    /// Centre of the left box, and the left [`NodeRef`].
    pub left_centre: UVec4,
    /// Half the left box's extent; the integer is 0.
    pub left_half: UVec4,
    /// Centre of the right box, and the right [`NodeRef`].
    pub right_centre: UVec4,
    /// Half the right box's extent; the integer is 0.
    pub right_half: UVec4,
}

impl CentredPair {
    /// How much wider than what it holds a box is at least, on every side.
    pub const MARGIN: f32 = 1.0 / (1 << 19) as f32;

    /// The left child's reference.
    #[inline(always)]
    pub fn left(&self) -> NodeRef {
        NodeRef(self.left_centre.w)
    }

    /// The right child's reference.
    #[inline(always)]
    pub fn right(&self) -> NodeRef {
        NodeRef(self.right_centre.w)
    }
}

#[cfg(not(target_arch = "spirv"))]
impl From<&NodePair> for CentredPair {
    fn from(pair: &NodePair) -> Self {
        let (left_centre, left_half) = centred(pair.left_min, pair.left_max);
        let (right_centre, right_half) = centred(pair.right_min, pair.right_max);
        CentredPair { left_centre, left_half, right_centre, right_half }
    }
}

/// Centre and half the extent of a box, the latter rounded up, and wider by the margin.
#[cfg(not(target_arch = "spirv"))]
fn centred(least: UVec4, greatest: UVec4) -> (UVec4, UVec4) {
    let (low, high) = (numbers(least), numbers(greatest));
    let centre = (low + high) * 0.5;
    let half = |low: f32, high: f32, centre: f32| {
        let centre = f64::from(centre);
        let reach = (f64::from(high) - centre).max(centre - f64::from(low)) + f64::from(CentredPair::MARGIN);
        // A roundoff more than the conversion takes off.
        (reach as f32) * (1.0 + f32::EPSILON)
    };
    let half = Vec3::new(half(low.x, high.x, centre.x), half(low.y, high.y, centre.y), half(low.z, high.z, centre.z));
    (pack(centre, least.w), pack(half, 0))
}

/// The boxes of two siblings in 32 bytes: a [`CentredPair`] on a grid of 2^-15 over [-1, 1].
///
/// Each word has six numbers of 16 bits, the lowest first: a centre (x, y, z), counted from -1, and half an
/// extent; then a [`NodeRef`]. A box on the grid contains the pair's.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct CompactPair {
    /// The left box and its [`NodeRef`].
    pub left: UVec4,
    /// The right box and its [`NodeRef`].
    pub right: UVec4,
}

impl CompactPair {
    /// A step of the grid.
    pub const STEP: f32 = 1.0 / (1 << 15) as f32;
}

impl From<CompactPair> for CentredPair {
    /// Exact: every number of the grid is a float.
    #[inline(always)]
    fn from(pair: CompactPair) -> Self {
        let (left_centre, left_half) = from_grid(pair.left);
        let (right_centre, right_half) = from_grid(pair.right);
        CentredPair { left_centre, left_half, right_centre, right_half }
    }
}

#[inline(always)]
fn from_grid(q: UVec4) -> (UVec4, UVec4) {
    let low = |word: u32| (word & 0xffff) as f32 * CompactPair::STEP;
    let high = |word: u32| (word >> 16) as f32 * CompactPair::STEP;
    let centre = Vec3::new(low(q.x) - 1.0, high(q.x) - 1.0, low(q.y) - 1.0);
    (pack(centre, q.w), pack(Vec3::new(high(q.y), low(q.z), high(q.z)), 0))
}

#[cfg(not(target_arch = "spirv"))]
impl From<&CentredPair> for CompactPair {
    fn from(pair: &CentredPair) -> Self {
        CompactPair {
            left: to_grid(pair.left_centre, pair.left_half),
            right: to_grid(pair.right_centre, pair.right_half),
        }
    }
}

/// A box on the grid around a box; one beyond the grid is cut off, where no ray is.
#[cfg(not(target_arch = "spirv"))]
fn to_grid(centre: UVec4, half: UVec4) -> UVec4 {
    let (c, h) = (numbers(centre).to_array().map(f64::from), numbers(half).to_array().map(f64::from));
    let step = f64::from(CompactPair::STEP);
    let place = |i: usize| ((c[i] + 1.0) / step).round().clamp(0.0, 65535.0);
    let reach = |i: usize| {
        let beside = (place(i) * step - 1.0 - c[i]).abs();
        ((h[i] + beside) / step).ceil().clamp(0.0, 65535.0)
    };
    let word = |low: f64, high: f64| low as u32 | (high as u32) << 16;
    UVec4::new(word(place(0), place(1)), word(place(2), reach(0)), word(reach(1), reach(2)), centre.w)
}

/// Eight siblings in 80 bytes, their boxes quantised to a grid (Ylitie, Karras and Laine 2017: CWBVH).
///
/// A box of child `i` lies between `origin + low[i] * 2^e` and `origin + high[i] * 2^e` on each axis.
/// Quantised boxes are wider than what they hold by at least [`WideNode::MARGIN`], which covers the
/// rounding of a box test that scales the grid instead of the box; see `traverse::wide`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct WideNode {
    /// The grid's origin; a byte an axis is the biased exponent of its step 2^e, x in the lowest; bit
    /// 24 + `i` tells that child `i` is an inner node.
    pub grid: UVec4,
    /// Number of the first inner child, whose siblings follow in the order of their slots; the first
    /// triangle; then a byte a child, see [`WideNode::INNER`].
    pub children: UVec4,
    /// A byte a child: low x in the first two words, low y in the last two.
    pub low_x_low_y: UVec4,
    /// Low z, high x.
    pub low_z_high_x: UVec4,
    /// High y, high z.
    pub high_y_high_z: UVec4,
}

impl WideNode {
    /// Children of a node.
    pub const ARITY: usize = 8;
    /// The most triangles of a child.
    pub const MAX_LEAF: u32 = 3;
    /// In a child's byte: 0 for no child; `INNER + 24 + i` for an inner node at slot `i`; else the first
    /// triangle's place behind the node's first in bits 0 to 4, and a bit set from bit 5 on for each of
    /// its triangles.
    pub const INNER: u32 = 1 << 5;
    /// How much wider than a child its quantised box is at least, on every side.
    pub const MARGIN: f32 = 1.0 / (1 << 19) as f32;
}

/// What bounds a reference to a part of a triangle: the box of that part, padded by [`BOX_PADDING`].
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Bounds {
    /// Least corner; the integer is 0.
    pub least: UVec4,
    /// Greatest corner; the integer is 0.
    pub greatest: UVec4,
}

/// A triangle in leaf order.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Triangle {
    /// First vertex, and the primitive's number in the scene (which decides ties).
    pub a: UVec4,
    /// Second vertex, and the material's index.
    pub b: UVec4,
    /// Third vertex, and [`Triangle::TRANSPARENT`] or 0.
    pub c: UVec4,
}

impl Triangle {
    /// The flag of a triangle that casts no shadow (thesis 3.2: opaque objects do).
    pub const TRANSPARENT: u32 = 1;
    /// The same flag beside the material of an indexed triangle's vertex.
    pub const CLEAR_VERTEX: u32 = 1 << 31;

    /// A record of three vertices in the normalised scene.
    pub fn new(vertices: [Vec3; 3], primitive: u32, material: u32, flags: u32) -> Self {
        let [a, b, c] = vertices;
        Triangle { a: pack(a, primitive), b: pack(b, material), c: pack(c, flags) }
    }

    /// The vertices in the normalised scene.
    #[inline(always)]
    pub fn vertices(&self) -> [Vec3; 3] {
        [numbers(self.a), numbers(self.b), numbers(self.c)]
    }

    /// The primitive's number in the scene, whatever the order of the leaves.
    #[inline(always)]
    pub fn primitive(&self) -> u32 {
        self.a.w
    }

    /// The index of the material.
    #[inline(always)]
    pub fn material(&self) -> u32 {
        self.b.w
    }

    /// Does light pass?
    #[inline(always)]
    pub fn is_transparent(&self) -> bool {
        self.c.w & Self::TRANSPARENT != 0
    }

    /// The triangle's own box (least, greatest corner): its extent and [`BOX_PADDING`] around it.
    /// A hit must lie in it, so every box above must contain it exactly.
    #[inline(always)]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let [a, b, c] = self.vertices();
        (
            Vec3::new(
                least(a.x, b.x, c.x) - BOX_PADDING,
                least(a.y, b.y, c.y) - BOX_PADDING,
                least(a.z, b.z, c.z) - BOX_PADDING,
            ),
            Vec3::new(
                greatest(a.x, b.x, c.x) + BOX_PADDING,
                greatest(a.y, b.y, c.y) + BOX_PADDING,
                greatest(a.z, b.z, c.z) + BOX_PADDING,
            ),
        )
    }
}

/// A zero's sign is lost in the padding.
#[inline(always)]
fn least(a: f32, b: f32, c: f32) -> f32 {
    a.lesser(b).lesser(c)
}

#[inline(always)]
fn greatest(a: f32, b: f32, c: f32) -> f32 {
    a.greater(b).greater(c)
}

/// The vertex normals of a triangle in leaf order, bound only where a mesh is smooth.
/// Three zeros stand for a flat triangle. The integers are 0.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Normals {
    /// Normal at the first vertex, of unit length.
    pub a: UVec4,
    /// Normal at the second vertex.
    pub b: UVec4,
    /// Normal at the third vertex.
    pub c: UVec4,
}

/// A surface's answer to light: ambient, Lambert, Phong (thesis 3.1), mirror and glass (3.3).
/// Colours are linear RGB in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Material {
    /// Ambient colour times the scene's ambient light.
    pub ambient: UVec4,
    /// Diffuse colour.
    pub diffuse: UVec4,
    /// Specular colour; the integer is the Phong exponent's bits.
    pub specular: UVec4,
    /// Mirror colour; the integer is the bits of the index of refraction, 0 for an opaque surface.
    pub reflection: UVec4,
    /// Colour of what passes.
    pub transmission: UVec4,
    /// The checker's second diffuse colour; the integer is the bits of cells per unit, 0 for none.
    pub checker: UVec4,
    /// The second cells' ambient colour times the scene's ambient light.
    pub checker_ambient: UVec4,
}

/// A light without extent.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Light {
    /// Position, or the direction towards a directional light; the integer is its kind.
    pub position: UVec4,
    /// Colour times intensity; the integer is the bits of the cosine of a spot's inner angle.
    pub colour: UVec4,
    /// The axis a spot points along, of unit length; the integer is the bits of the cosine of its
    /// outer angle.
    pub axis: UVec4,
}

impl Light {
    /// [`Light::position`] is a place; light goes every way.
    pub const POINT: u32 = 0;
    /// [`Light::position`] is the unit direction towards the light.
    pub const DIRECTIONAL: u32 = 1;
    /// [`Light::position`] is a place; light fades from the inner to the outer cone.
    pub const SPOT: u32 = 2;
}

/// What a launch renders: one sample of every pixel of a region.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Frame {
    /// Camera position; the integer is the image's width in pixels.
    pub eye: UVec4,
    /// Step to the right for half a sample's width on the image plane; the image's height.
    pub right: UVec4,
    /// Step up for half a sample's height; samples along a pixel's edge.
    pub up: UVec4,
    /// To the centre of the image plane, at distance one; this launch's sample within the pixel.
    pub forward: UVec4,
    /// Background at the horizon and below; the bounce limit.
    pub bottom: UVec4,
    /// Background straight up; how many lights there are.
    pub top: UVec4,
    /// The region's left and top pixel, its width and height.
    pub region: UVec4,
    /// Bits of a sample's share of its pixel, bits of the least contribution that is followed, slots a
    /// launch has room for, the word at which the vertices of indexed triangles start.
    pub limits: UVec4,
}

/// Thresholds of the hybrid methods (thesis 6.2.3) and of persistent subgroups.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Tuning(pub u32);

impl Tuning {
    /// Parts a full stack of `stack_max` nodes, or a child that less than `cut` percent of a packet want.
    pub const fn new(stack_max: u32, cut: u32) -> Self {
        Tuning(stack_max | (cut << 8)).with_busy(Self::BUSY)
    }

    /// The default of [`Tuning::busy`], measured.
    const BUSY: u32 = 40;

    /// Lets the lanes of persistent subgroups take new rays when less than `busy` percent are at work.
    pub const fn with_busy(self, busy: u32) -> Self {
        Tuning((self.0 & 0xffff) | (busy << 16))
    }

    /// Percent of a persistent subgroup below which idle lanes take new rays. (Each time all wait for the
    /// rays' preparation.)
    #[inline(always)]
    pub fn busy(self) -> u32 {
        self.0 >> 16
    }

    /// Nodes that wait when a packet parts.
    #[inline(always)]
    pub fn stack_max(self) -> u32 {
        self.0 & 0xff
    }

    /// Percent of a packet below which rays part.
    #[inline(always)]
    pub fn cut(self) -> u32 {
        (self.0 >> 8) & 0xff
    }
}

impl Default for Tuning {
    fn default() -> Self {
        Tuning::new(8, 25)
    }
}

/// Which effects a scene asks for; a kernel holds no instruction for the others.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Features(pub u32);

impl Features {
    /// Some mesh has vertex normals.
    pub const SMOOTH: u32 = 1 << 0;
    /// Some material is a checker.
    pub const CHECKER: u32 = 1 << 1;
    /// Some material is a mirror or reflects as glass, and bounces are allowed.
    pub const REFLECTION: u32 = 1 << 2;
    /// Some material lets light pass.
    pub const REFRACTION: u32 = 1 << 3;
    /// Some light is a spot.
    pub const SPOT: u32 = 1 << 4;
    /// Some light is directional.
    pub const DIRECTIONAL: u32 = 1 << 5;
    /// Some material has a Phong highlight.
    pub const SPECULAR: u32 = 1 << 6;
    /// Triangles seen from behind are skipped.
    pub const CULLING: u32 = 1 << 7;
    /// The background is a gradient.
    pub const GRADIENT: u32 = 1 << 8;
    /// This launch follows secondary rays: its slots come from a queue.
    pub const SECONDARY: u32 = 1 << 9;
    /// This launch follows rays that lie in memory as [`crate::stage::Segment`]s.
    pub const STREAM: u32 = 1 << 10;
    /// Triangles are given as indices of vertices, see [`crate::scene::Geometry::triangle`].
    pub const INDEXED: u32 = 1 << 11;
    /// Triangles are split: a slot holds a part, whose bounds are given.
    pub const SPLIT: u32 = 1 << 12;
    /// Pixels are taken row by row.
    pub const LINEAR: u32 = 1 << 13;
    /// Pixels are taken along a Morton curve.
    pub const MORTON: u32 = 1 << 14;
    /// Pairs of nodes are [`CompactPair`]s.
    pub const COMPACT: u32 = 1 << 15;
    /// Triangles are met by the test of Moeller and Trumbore, where [`Real::CHOOSES`].
    pub const MOLLER: u32 = 1 << 16;

    /// Is the effect asked for?
    #[inline(always)]
    pub fn has(self, bit: u32) -> bool {
        self.0 & bit != 0
    }
}
