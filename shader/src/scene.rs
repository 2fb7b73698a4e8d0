//! What a launch sees of the scene in device memory.

use crate::buffer::read;
#[cfg(not(target_arch = "spirv"))]
use crate::bvh8::Bvh8View;
use crate::data::{
    CentredPair, CompactPair, CwbvhNode, Effects, Frame, Instance, Launch, Layout, Maps, Material, Medium, NodeRef,
    Normals, Primitive, Specialisation, Waves, line, numbers, pack,
};
use crate::geometry::Transform;
use crate::ray::Hit;
use crate::real::{Real, Scalar, TINY, V3};
use crate::sampler::{self, Key, WAVELENGTHS};
use crate::spectrum::Bands;
use crate::texture::Textures;
use crate::traverse::Cutout;
use glam::{UVec4, Vec3};

/// A launch, and the primitives of its scene.
#[derive(Clone, Copy)]
pub struct LaunchContext<'a> {
    /// What is rendered.
    pub frame: &'a Frame,
    /// What the kernel is compiled for; constants on the GPU.
    pub spec: Specialisation,
    /// Primitives in leaf order: [`Primitive`]s, or their indices and vertices ([`Layout::INDEXED`]).
    pub primitives: &'a [UVec4],
    /// Copies of meshes ([`Effects::INSTANCED`]).
    pub instances: &'a [Instance],
    /// The wavelengths of a sample's light ([`Waves::SPECTRAL`]).
    pub bands: Bands,
}

impl<'a> LaunchContext<'a> {
    /// Of red, green and blue light.
    #[inline(always)]
    pub fn new(frame: &'a Frame, spec: Specialisation, primitives: &'a [UVec4], instances: &'a [Instance]) -> Self {
        LaunchContext { frame, spec, primitives, instances, bands: Bands::none() }
    }

    /// For a sample of a pixel, which draws its wavelengths where light has any.
    #[inline(always)]
    pub fn of_sample(&self, spectra: &[UVec4], key: Key, sample: u32) -> Self {
        // No launch is chosen between two: that would be a phi of its buffers.
        let bands = if self.spec.waves.has(Waves::SPECTRAL) {
            Bands::drawn(spectra, sampler::set(self.spec.launch, key, sample, WAVELENGTHS).x)
        } else {
            Bands::none()
        };
        LaunchContext { bands, ..*self }
    }

    /// What a colour, linear RGB, is at each of the sample's wavelengths; itself where light has none.
    #[inline(always)]
    pub fn banded<R: Scalar>(&self, rgb: V3<R>) -> V3<R> {
        if self.spec.waves.has(Waves::SPECTRAL) { self.bands.of(rgb) } else { rgb }
    }

    /// A medium by its number from 1 on, as it is for the sample's wavelengths.
    #[inline(always)]
    pub fn medium(&self, media: &[Medium], number: u32) -> Medium {
        let medium = read(media, number - 1);
        if !self.spec.waves.has(Waves::SPECTRAL) {
            return medium;
        }
        let banded = |of: UVec4| {
            let V3 { x, y, z } = self.bands.of(V3::<f32>::splat(numbers(of)));
            pack(Vec3::new(x, y, z), of.w)
        };
        let Medium { extinction, albedo, emission, density } = medium;
        Medium { extinction: banded(extinction), albedo: banded(albedo), emission: banded(emission), density }
    }

    /// The colour of light that has the sample's wavelengths, linear RGB.
    #[inline(always)]
    pub fn rgb<R: Scalar>(&self, light: V3<R>) -> V3<R> {
        if self.spec.waves.has(Waves::SPECTRAL) { self.bands.rgb(light) } else { light }
    }
}

impl LaunchContext<'_> {
    /// The primitive at an index: a record of its own, gathered before; or a record of the numbers of its three words but
    /// for their integers, whose integer is its own number, and which carry the material and the flags.
    #[inline(always)]
    pub fn primitive(&self, index: u32) -> Primitive {
        let word = |i| read(self.primitives, i);
        if self.spec.layout.has(Layout::INDEXED) {
            let corners = word(index);
            let vertex = |i: u32| word(self.frame.vertices + i);
            let (mut a, mut b, mut c) = (vertex(corners.x), vertex(corners.y), vertex(corners.z));
            let flags = b.w >> Primitive::FLAGS_SHIFT;
            (a.w, b.w, c.w) = (corners.w, b.w & Primitive::MATERIAL, flags);
            Primitive { a, b, c }
        } else {
            Primitive { a: word(3 * index), b: word(3 * index + 1), c: word(3 * index + 2) }
        }
    }

    /// The primitive at an index of a copy of a mesh, or of none, at a time.
    #[inline(always)]
    pub fn placed(&self, index: u32, instance: u32, time: f32) -> Primitive {
        if self.spec.effects.has(Effects::INSTANCED) && instance != Hit::<f32>::NOTHING {
            let posed = Posed::new(self.spec.launch, self.frame, self.instances, (instance, time));
            let mut own = self.primitive(index + posed.from);
            if self.spec.launch.has(Launch::MOVING) && posed.is_bent() {
                own = bent(own, self.primitive(index + posed.to), posed.share);
            }
            return placed(own, posed.instance, self.frame.origin);
        }
        self.primitive(index)
    }
}

/// A copy of a mesh at a time.
struct Posed {
    instance: Instance,
    /// How far from its triangles those of the keys before and behind are.
    from: u32,
    to: u32,
    /// The share of the way between.
    share: f32,
}

impl Posed {
    /// By the number of its record, or of the first of its keys.
    #[inline(always)]
    fn new(launch: Launch, frame: &Frame, instances: &[Instance], (number, time): (u32, f32)) -> Self {
        let is_moving = launch.has(Launch::MOVING);
        let mut mesh = UVec4::ZERO;
        let (mut step, mut share, mut after) = (0, 0.0, 0);
        if is_moving {
            mesh = read(instances, number).mesh;
            if mesh.z & Instance::MOVES != 0 {
                (step, share) = frame.step(time);
                after = 1;
            }
        }
        let instance = read(instances, number + step);
        if is_moving {
            return posed(mesh, instance, read(instances, number + step + after), (step, share));
        }
        Posed { instance, from: 0, to: 0, share }
    }

    /// Does its mesh change its shape?
    #[inline(always)]
    fn is_bent(&self) -> bool {
        self.to != 0
    }
}

/// A copy at a step and a share of it, between two keys; one of a mesh that does not move is as it is.
// A function of its own on the GPU, so that a module holds it once.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
fn posed(mesh: UVec4, from: Instance, to: Instance, (step, share): (u32, f32)) -> Posed {
    if mesh.z & Instance::MOVES == 0 {
        return Posed { instance: from, from: 0, to: 0, share: 0.0 };
    }
    let instance = Instance { mesh, ..from.towards(&to, share) };
    Posed { instance, from: if step == 0 { 0 } else { from.mesh.x }, to: to.mesh.x, share }
}

/// A triangle at a share of the way between two keys: each vertex goes straight.
// Likewise.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
fn bent(from: Primitive, to: Primitive, share: f32) -> Primitive {
    let place = |from: UVec4, to: UVec4| pack(line(numbers(from), numbers(to), share), from.w);
    Primitive { a: place(from.a, to.a), b: place(from.b, to.b), c: place(from.c, to.c) }
}

/// A triangle of a mesh where a copy has it.
// A function of its own on the GPU, so that a module holds it once.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
fn placed(Primitive { a, b, c }: Primitive, of: Instance, origin: UVec4) -> Primitive {
    let (transform, origin) = (of.transform(), numbers(origin));
    let place = |of: UVec4| {
        let place = transform.place(numbers(of)) - origin;
        Vec3::new(place.x.flush(TINY), place.y.flush(TINY), place.z.flush(TINY))
    };
    Primitive { a: pack(place(a), of.number(a.w)), b: pack(place(b), b.w), c: pack(place(c), c.w | of.flags()) }
}

/// A launch and what its rays meet.
#[derive(Clone, Copy)]
pub struct TraceContext<'a> {
    /// The launch and its primitives.
    pub base: LaunchContext<'a>,
    /// Words of child pairs, the root's first: [`CentredPair`]s, or [`CompactPair`]s ([`Layout::COMPACT`]).
    pub nodes: &'a [UVec4],
    /// Nodes of eight children; the root is node 0. Of the method `wide` alone.
    pub wide: &'a [CwbvhNode],
    /// The same for a CPU. Empty unless the method is `wide`.
    #[cfg(not(target_arch = "spirv"))]
    pub bvh8: Bvh8View<'a>,
    /// Where primitives are not opaque.
    pub cutout: Cutout<'a>,
}

/// A launch and the hierarchy over its primitives.
#[derive(Clone, Copy)]
pub struct Hierarchy<'a> {
    /// The launch and its primitives.
    pub base: LaunchContext<'a>,
    /// See [`TraceContext::nodes`].
    pub nodes: &'a [UVec4],
}

impl TraceContext<'_> {
    /// The hierarchy of pairs.
    #[inline(always)]
    pub fn hierarchy(&self) -> Hierarchy<'_> {
        Hierarchy { base: self.base, nodes: self.nodes }
    }

    /// The primitive at an index.
    #[inline(always)]
    pub fn primitive(&self, index: u32) -> Primitive {
        self.base.primitive(index)
    }
}

impl Hierarchy<'_> {
    /// The child pair that a reference leads to where the copy has it at a time that the reference was found in, and the copy that it
    /// is in itself: it may lead to one.
    #[inline(always)]
    pub fn opened(&self, node: NodeRef, instance: u32, time: f32) -> (CentredPair, u32) {
        let is_instanced = self.base.spec.effects.has(Effects::INSTANCED);
        let (mut number, mut instance) = (node.index(), instance);
        let mut of = Instance::NONE;
        if is_instanced {
            let leads = number >= self.base.frame.pairs;
            instance = if leads { number - self.base.frame.pairs } else { instance };
            if instance != Hit::<f32>::NOTHING {
                let LaunchContext { spec, frame, instances, .. } = self.base;
                of = Posed::new(spec.launch, frame, instances, (instance, time)).instance;
                number = if leads { of.root() } else { number };
            }
        }
        let pair = self.pair(number);
        if is_instanced && instance != Hit::<f32>::NOTHING {
            return (moved(pair, of, self.base.frame.origin), instance);
        }
        (pair, if is_instanced { instance } else { Hit::<f32>::NOTHING })
    }

    /// The child pair of this number.
    #[inline(always)]
    pub fn pair(&self, number: u32) -> CentredPair {
        let word = |i| read(self.nodes, i);
        if self.base.spec.layout.has(Layout::COMPACT) {
            CompactPair { left: word(2 * number), right: word(2 * number + 1) }.into()
        } else {
            let [left_centre, left_half] = [word(4 * number), word(4 * number + 1)];
            let [right_centre, right_half] = [word(4 * number + 2), word(4 * number + 3)];
            CentredPair { left_centre, left_half, right_centre, right_half }
        }
    }
}

/// A pair of nodes of a mesh where a copy has it.
// A function of its own on the GPU, so that a module holds it once.
#[cfg_attr(target_arch = "spirv", inline(never))]
#[cfg_attr(not(target_arch = "spirv"), inline(always))]
fn moved(pair: CentredPair, of: Instance, origin: UVec4) -> CentredPair {
    let (transform, origin, margin) = (of.transform(), numbers(origin), Vec3::splat(of.margin()));
    let centre = |of: UVec4| pack(transform.place(numbers(of)) - origin, of.w);
    let half = |of: UVec4| pack(transform.around(numbers(of)) + margin, 0);
    CentredPair {
        left_centre: centre(pair.left_centre),
        left_half: half(pair.left_half),
        right_centre: centre(pair.right_centre),
        right_half: half(pair.right_half),
    }
}

/// What surfaces look like.
#[derive(Clone, Copy, Default)]
pub struct ShadingData<'a> {
    /// Vertex normals in leaf order ([`Effects::SMOOTH`](crate::data::Effects)).
    pub normals: &'a [Normals],
    /// Materials.
    pub materials: &'a [Material],
    /// Tangents in leaf order ([`Effects::TANGENTS`](crate::data::Effects)); the first vertex' integer is the bits of the sign of
    /// the bitangent. Three zeros stand for a triangle without.
    pub tangents: &'a [Normals],
    /// Their maps, by material ([`Effects::TEXTURED`](crate::data::Effects)).
    pub maps: &'a [Maps],
    /// What they are covered with.
    pub textures: Textures<'a>,
}

impl ShadingData<'_> {
    /// The vertex normals of a triangle, where the copy has it at a time that it may be in.
    #[inline(always)]
    pub fn normals(&self, launch: &LaunchContext<'_>, place: (u32, u32, f32)) -> Normals {
        launch.turned(self.normals, place, |transform, normal| transform.normal(normal))
    }

    /// Likewise its tangents. Those of a mesh that is mirrored are so in its own cube.
    #[inline(always)]
    pub fn tangents(&self, launch: &LaunchContext<'_>, place: (u32, u32, f32)) -> Normals {
        launch.turned(self.tangents, place, |transform, tangent| transform.direction(tangent))
    }
}

impl LaunchContext<'_> {
    /// Vectors of a triangle's vertices, turned where a copy has it.
    #[inline(always)]
    fn turned(
        &self,
        all: &[Normals],
        (index, instance, time): (u32, u32, f32),
        turn: impl Fn(&Transform, Vec3) -> Vec3,
    ) -> Normals {
        if !self.spec.effects.has(Effects::INSTANCED) || instance == Hit::<f32>::NOTHING {
            return read(all, index);
        }
        let posed = Posed::new(self.spec.launch, self.frame, self.instances, (instance, time));
        let Normals { mut a, mut b, mut c } = read(all, index + posed.from);
        if self.spec.launch.has(Launch::MOVING) && posed.is_bent() {
            let to = read(all, index + posed.to);
            let between = |from: UVec4, to: UVec4| pack(line(numbers(from), numbers(to), posed.share), from.w);
            (a, b, c) = (between(a, to.a), between(b, to.b), between(c, to.c));
        }
        let transform = posed.instance.transform();
        let turned = |own: UVec4| pack(turn(&transform, numbers(own)), own.w);
        Normals { a: turned(a), b: turned(b), c: turned(c) }
    }
}
