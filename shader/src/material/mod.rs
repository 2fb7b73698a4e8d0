//! What a surface is made of at a place: its colours and its shading normal. How it answers light is a file a model.

mod albedo;
mod bend;
mod bsdf;
mod closure;
mod coat;
mod coated;
mod energy;
mod facet;
mod film;
mod finish;
mod frame;
mod fresnel;
mod ggx;
mod hair;
mod lambert;
mod layers;
mod lobes;
mod optics;
mod phong;
mod physical;
mod refraction;
mod sheen;
mod specular;
mod terminator;

#[cfg(not(target_arch = "spirv"))]
pub use albedo::ALBEDOS;
pub use albedo::{Albedos, BRUSHED, EVEN, GLASS, MOST_BEND, STARTS, cosine_coordinate};
pub use bsdf::Bsdf;
pub use closure::{Closure, ClosureSample, Scattering};
pub use coat::Coat;
pub use coated::Coated;
pub use film::film;
pub use finish::Channels;
pub use fresnel::Reflectance;
#[cfg(not(target_arch = "spirv"))]
pub use fresnel::conductor_mean;
pub use ggx::Ggx;
pub use hair::Hair;
pub use lambert::{INVERSE_PI, cosine_direction};
pub use layers::{Layers, Way};
pub use lobes::Lobes;
pub use optics::{Refraction, fresnel, reflect, refract};
pub use phong::eval_phong;
pub use physical::{closure, transmittance};
pub use sheen::Sheen;
pub use specular::Specular;
pub use terminator::lifted;

use crate::buffer::read;
use crate::data::{Effects, FinishMaps, Launch, Maps, Material, Normals, Primitive, numbers};
use crate::geometry::{SurfaceInteraction, tangents};
use crate::integrator::ScatterContext;
use crate::real::{Real, SMALL, Scalar, TINY, V3};
use crate::scene::{LaunchContext, ShadingData};
use crate::texture::{Cone, Covering, Place};

/// A material at an interaction, with the normal that light sees.
#[derive(Clone, Copy)]
pub struct Surface<R: Real> {
    /// Unit shading normal on the viewer's side: the vertices' normals interpolated, or the triangle's.
    pub normal: V3<R>,
    /// Reflected ambient light: the material's colour times the scene's ambient light.
    pub ambient: V3<R>,
    /// Lambert's colour, that of the checker's cell included.
    pub diffuse: V3<R>,
    /// Phong's colour.
    pub specular: V3<R>,
    /// Phong's exponent.
    pub shininess: R,
    /// Mirror colour of an opaque surface.
    pub reflection: V3<R>,
    /// Colour of the transmitted light.
    pub transmission: V3<R>,
    /// Index of refraction over that of what is around it, 0 for an opaque surface.
    pub ior: R,
    /// The index of refraction around it: what its own is divided by.
    pub around: R,
    /// The shading normal before a map changes it.
    pub even_normal: V3<R>,
}

/// What a ray has met.
#[derive(Clone, Copy)]
pub struct Seen<R: Real> {
    /// The primitive's index in leaf order.
    pub index: u32,
    /// The copy of a mesh that it is in, or [`Hit::NOTHING`](crate::ray::Hit::NOTHING).
    pub instance: u32,
    /// When it is, see [`Ray::time`](crate::ray::Ray::time).
    pub time: f32,
    /// The primitive.
    pub primitive: Primitive,
    /// The place on it.
    pub interaction: SurfaceInteraction<R>,
    /// The ray's unit direction.
    pub direction: V3<R>,
    /// How wide it is there.
    pub cone: Cone<R>,
}

// By copies: rust-gpu keeps in memory whatever a pointer leads into.
impl<R: Scalar> Seen<R> {
    /// The material's index.
    #[inline(always)]
    pub fn material(&self) -> u32 {
        let Seen { primitive, .. } = *self;
        primitive.material()
    }

    /// What its textures say. Nothing but white in a scene without.
    #[inline(always)]
    pub fn covering(&self, launch: &LaunchContext<'_>, shading: &ShadingData<'_>) -> Covering<R> {
        self.covered(launch, shading, FinishMaps::NONE, false)
    }

    /// The same with what they say of [finishes](crate::data::Finish), or that of emission alone.
    #[inline(always)]
    pub fn whole_covering(
        &self,
        launch: &LaunchContext<'_>,
        ScatterContext { shading, finishes, .. }: &ScatterContext<'_>,
        emits_only: bool,
    ) -> Covering<R> {
        // Read here: a closure in a closure would keep the buffer's pointer in memory.
        let is_asked = launch.spec.finishes.any() && launch.spec.effects.has(Effects::TEXTURED) && !emits_only;
        let maps = if is_asked { read(finishes, self.material()).maps } else { FinishMaps::NONE };
        self.covered(launch, shading, maps, emits_only)
    }

    #[inline(always)]
    fn covered(
        &self,
        launch: &LaunchContext<'_>,
        shading: &ShadingData<'_>,
        finish_maps: FinishMaps,
        emits_only: bool,
    ) -> Covering<R> {
        let (effects, launched) = (launch.spec.effects, launch.spec.launch);
        let Seen { index, primitive, interaction, direction, cone, .. } = *self;
        let place = Place { index, weights: interaction.coordinates, count: launch.frame.vertices };
        let mut footprint = R::splat(0.0);
        if effects.has(Effects::TEXTURED) && launched.has(Launch::MIPMAPPED) {
            footprint = cone.footprint(&primitive, (interaction.normal, direction));
        }
        let further = if launch.spec.finishes.any() { FinishMaps::COUNT } else { 0 };
        let range = if emits_only { (Maps::EMISSION, Maps::EMISSION + 1) } else { (0, Maps::COUNT + further) };
        let maps = || read(shading.maps, primitive.material());
        Covering::new(launch.spec, &shading.textures, (maps, finish_maps), &place, footprint, range)
    }
}

impl<R: Scalar> Surface<R> {
    /// The surface of what a ray has met, with what covers it.
    #[inline(always)]
    pub fn new(launch: &LaunchContext<'_>, shading: &ShadingData<'_>, seen: &Seen<R>, covering: &Covering<R>) -> Self {
        let effects = launch.spec.effects;
        let Seen { index, instance, time, primitive, interaction, direction, .. } = *seen;
        let material: Material = read(shading.materials, primitive.material());
        let colour = |record| V3::<R>::splat(numbers(record));
        let covered = |colour| launch.banded(covered(effects, colour, covering));
        let number = |bits| R::splat(f32::from_bits(bits));
        let even_normal = if effects.has(Effects::SMOOTH) {
            interpolated(&shading.normals(launch, (index, instance, time)), direction, &interaction)
        } else {
            interaction.normal
        };
        let normal = if effects.has(Effects::TANGENTS) && effects.has(Effects::TEXTURED) {
            mapped(launch, shading, seen, (even_normal, covering.normal))
        } else {
            even_normal
        };
        let other = effects.has(Effects::CHECKER)
            && material.checker.w != 0
            && odd_cell(&interaction, number(material.checker.w));
        Surface {
            normal,
            ambient: covered(if other { colour(material.checker_ambient) } else { colour(material.ambient) }),
            diffuse: covered(if other { colour(material.checker) } else { colour(material.diffuse) }),
            specular: launch.banded(colour(material.specular)),
            shininess: number(material.specular.w),
            reflection: launch.banded(colour(material.reflection)),
            transmission: launch.banded(colour(material.transmission)),
            ior: number(material.reflection.w),
            around: R::splat(1.0),
            even_normal,
        }
    }

    /// The same in surroundings of an index of refraction.
    #[inline(always)]
    pub fn within(self, around: R) -> Self {
        Surface { ior: self.ior.div(around), around, ..self }
    }
}

/// A colour below what covers it.
#[inline(always)]
fn covered<R: Scalar>(effects: Effects, colour: V3<R>, covering: &Covering<R>) -> V3<R> {
    if effects.has(Effects::TEXTURED | Effects::COLOURED) { colour.times(covering.base) } else { colour }
}

/// The direction in which a surface mirrors. An interpolated normal may mirror a ray into its own surface; the triangle's normal
/// does not. Of unit length again, since one that is reflected to and fro would grow by the normals' rounding each time.
#[inline(always)]
pub fn mirrored<R: Scalar>(direction: V3<R>, interaction: &SurfaceInteraction<R>, surface: &Surface<R>) -> V3<R> {
    let mirrored = reflect(direction, surface.normal);
    V3::select(interaction.faces(mirrored), mirrored, reflect(direction, interaction.normal)).renormalised()
}

/// The vertex normals' weighted sum, flipped to the viewer's side of the triangle. If the sum is zero,
/// or faces away from the viewer, the triangle's own normal replaces it.
#[inline(always)]
fn interpolated<R: Scalar>(normals: &Normals, direction: V3<R>, interaction: &SurfaceInteraction<R>) -> V3<R> {
    let (u, v) = interaction.coordinates;
    let normal = |record| V3::<R>::splat(numbers(record));
    let sum = normal(normals.a) * (R::splat(1.0) - u - v) + normal(normals.b) * u + normal(normals.c) * v;
    let (unit, length) = sum.map(|c| c.flush(SMALL)).direction_and_length();
    let unit = V3::select(interaction.faces(unit), unit, -unit);
    let lost = length.eq(R::splat(0.0)) || R::splat(0.0).le(unit.dot(direction));
    V3::select(lost, interaction.normal, unit)
}

/// The tangent at a place, at right angles to a normal, and the sign of the bitangent; a zero vector if there is none.
#[inline(always)]
fn tangent<R: Scalar>(
    launch: &LaunchContext<'_>,
    shading: &ShadingData<'_>,
    seen: &Seen<R>,
    normal: V3<R>,
) -> (V3<R>, R) {
    let (u, v) = seen.interaction.coordinates;
    let Normals { a, b, c } = shading.tangents(launch, (seen.index, seen.instance, seen.time));
    let of = |record| V3::<R>::splat(numbers(record));
    let sum = of(a) * (R::splat(1.0) - u - v) + of(b) * u + of(c) * v;
    let across = sum - normal * normal.dot(sum);
    let (unit, length) = across.map(|c| c.flush(SMALL)).direction_and_length();
    // Along the normal there is no tangent.
    let none = length.lt(R::splat(LEAST_TANGENT));
    (V3::select(none, V3::zero(), unit), R::splat(f32::from_bits(a.w)))
}

/// The least sine between a tangent and a normal.
const LEAST_TANGENT: f32 = 1.0 / 1024.0;

/// The axes of a surface's frame: tangent, bitangent and normal, of unit length.
#[inline(always)]
pub fn axes<R: Scalar>(
    launch: &LaunchContext<'_>,
    shading: &ShadingData<'_>,
    seen: &Seen<R>,
    normal: V3<R>,
) -> [V3<R>; 3] {
    let [x, y] = tangents(normal);
    if !launch.spec.effects.has(Effects::TANGENTS) {
        return [x, y, normal];
    }
    let (along, sign) = tangent(launch, shading, seen, normal);
    let none = along.greatest().eq(R::splat(0.0)) && (-along).greatest().eq(R::splat(0.0));
    let side = R::select(seen.interaction.front, sign, -sign);
    let across = normal.cross(along).map(|c| c.flush(TINY)) * side;
    [V3::select(none, x, along), V3::select(none, y, across), normal]
}

/// A normal by a map's, which is in the frame of the front's tangent, bitangent and normal. Where the map's leads away from the
/// viewer it is bent back until it is seen.
#[inline(always)]
fn mapped<R: Scalar>(
    launch: &LaunchContext<'_>,
    shading: &ShadingData<'_>,
    seen: &Seen<R>,
    (normal, map): (V3<R>, V3<R>),
) -> V3<R> {
    /// The least cosine to the viewer.
    const LEAST: f32 = 1.0 / 64.0;
    let (zero, front) = (R::splat(0.0), seen.interaction.front);
    let (along, sign) = tangent(launch, shading, seen, normal);
    let own = V3::select(front, normal, -normal);
    let across = own.cross(along).map(|c| c.flush(TINY)) * sign;
    let part = |axis: V3<R>, length: R| (axis * length.flush(SMALL)).map(|c| c.flush(SMALL));
    let sum = part(along, map.x) + part(across, map.y) + part(own, map.z);
    let unit = sum.map(|c| c.flush(SMALL)).direction_and_length().0;
    let unit = V3::select(front, unit, -unit);
    let none = unit.dot(unit).eq(zero);
    let unit = V3::select(none, normal, unit);
    let seen_by = -unit.dot(seen.direction);
    let bent = (unit - seen.direction * (R::splat(LEAST) - seen_by)).map(|c| c.flush(SMALL)).direction_and_length().0;
    let bent = V3::select(zero.lt(-bent.dot(seen.direction)), bent, normal);
    V3::select(R::splat(LEAST).le(seen_by), unit, bent)
}

/// Cells of a checkerboard over the two axes that the surface faces least.
#[inline(always)]
fn odd_cell<R: Scalar>(interaction: &SurfaceInteraction<R>, cells: R) -> bool {
    let n = interaction.normal.abs();
    let p = interaction.position;
    let (a, b) = if n.y.le(n.x) && n.z.le(n.x) {
        (p.y, p.z)
    } else if n.z.le(n.y) {
        (p.x, p.z)
    } else {
        (p.x, p.y)
    };
    ((a * cells).floor_index() ^ (b * cells).floor_index()) & 1 != 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::pack;
    use glam::Vec3;

    fn contact(normal: Vec3, position: [f32; 3]) -> SurfaceInteraction<f32> {
        SurfaceInteraction {
            position: V3::splat(position.into()),
            error_offset: 0.0,
            normal: V3::splat(normal),
            front: true,
            coordinates: (0.0, 0.0),
            number: 0,
            is_curved: false,
            radius: 0.0,
            is_lifted: false,
            lift: 0.0,
        }
    }

    #[test]
    fn checkers_alternate_along_the_surface_and_not_across_it() {
        for (normal, a, b) in [(Vec3::X, 1, 2), (Vec3::Y, 0, 2), (-Vec3::Z, 0, 1)] {
            let across = 3 - a - b;
            let odd = |i: f32, j: f32, k: f32| {
                let mut p = [0.0; 3];
                (p[a], p[b], p[across]) = (i, j, k);
                odd_cell(&contact(normal, p), 4.0)
            };
            assert!(!odd(0.1, 0.1, 0.0) && odd(0.3, 0.1, 0.0) && odd(0.1, 0.3, 0.0) && !odd(0.3, 0.3, 0.0));
            assert!(odd(-0.1, 0.1, 0.0), "the cell below zero is another cell");
            assert_eq!(odd(0.1, 0.1, 1e-7), odd(0.1, 0.1, -1e-7), "a plane through zero has no noise");
        }
    }

    /// The shading normal where vertices have these.
    fn smooth_of(normals: [Vec3; 3], weights: (f32, f32), from: Vec3, own: Vec3) -> V3<f32> {
        let [a, b, c] = normals.map(|n| pack(n, 0));
        let interaction = SurfaceInteraction { coordinates: weights, ..contact(own, [0.0; 3]) };
        interpolated(&Normals { a, b, c }, V3::splat(from), &interaction)
    }

    /// Of a triangle whose vertices' normals lean towards x, y and away from x.
    fn smooth(weights: (f32, f32), from: Vec3, own: Vec3) -> V3<f32> {
        let leaning = [Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8), Vec3::new(-0.6, 0.0, 0.8)];
        smooth_of(leaning, weights, from, own)
    }

    fn is_near(got: V3<f32>, want: Vec3) -> bool {
        (Vec3::new(got.x, got.y, got.z) - want).length() < 1e-6
    }

    #[test]
    fn normals_are_weighted_as_the_vertices_are() {
        assert!(is_near(smooth((0.0, 0.0), -Vec3::Z, Vec3::Z), Vec3::new(0.6, 0.0, 0.8)));
        assert!(is_near(smooth((1.0, 0.0), -Vec3::Z, Vec3::Z), Vec3::new(0.0, 0.6, 0.8)));
        assert!(is_near(smooth((0.0, 1.0), -Vec3::Z, Vec3::Z), Vec3::new(-0.6, 0.0, 0.8)));
        assert!(is_near(smooth((0.25, 0.5), -Vec3::Z, Vec3::Z), Vec3::new(-0.15, 0.15, 0.8).normalize()));
    }

    #[test]
    fn a_normal_is_on_the_viewers_side_or_the_triangles_own() {
        let behind = smooth((1.0, 0.0), Vec3::Z, -Vec3::Z);
        assert!(is_near(behind, Vec3::new(0.0, -0.6, -0.8)), "seen from behind it is turned");
        let grazing = Vec3::new(0.9, 0.0, -0.1).normalize();
        assert!(is_near(smooth((0.0, 0.0), grazing, Vec3::Z), Vec3::Z), "turned away from the viewer");
        let lost = smooth_of([Vec3::X, -Vec3::X, Vec3::X], (0.5, 0.0), -Vec3::Z, Vec3::Z);
        assert!(is_near(lost, Vec3::Z), "no direction is left");
    }
}
