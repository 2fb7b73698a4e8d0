//! Whitted's shading: the light of a slot's hit, added to the slot's sum, and the rays that go on from there.

use crate::background::background;
use crate::buffer::{read, write};
use crate::camera;
use crate::data::{Effects, Launch, Light, Primitive};
use crate::geometry::SurfaceInteraction;
use crate::light::{LightSample, at_time};
use crate::material::{Seen, Surface, eval_phong, fresnel, mirrored, refract};
use crate::real::{FAINT, Real, Scalar, V3};
use crate::scene::{LaunchContext, ShadingData};
use crate::stage::{CLEARED, FACES_AWAY, Found, NON_FINITE, Path, REACHED};
use crate::texture::Cone;

/// The records that the stages of a wave exchange.
pub struct Wave<'a, R: Scalar> {
    /// Paths by level, record and slot.
    pub paths: &'a mut [R::Record],
    /// [`Found`] by slot.
    pub hits: &'a [R::Record],
    /// What [`crate::stage::shadow`] returned, by light and slot.
    pub shadows: &'a [u32],
    /// Lights in file order.
    pub lights: &'a [Light],
    /// Light from far away, see [`crate::light::Environment`].
    pub environment: &'a [u32],
    /// Linear RGB by slot; the integer counts shadow rays and holds [`NON_FINITE`].
    pub sums: &'a mut [R::Record],
}

/// The rays that go on from a hit; a zero weight is none.
struct Branches<R: Real> {
    reflected: Path<R>,
    refracted: Path<R>,
}

/// Shades a slot's hit. Returns whether the slot has another ray to trace.
#[inline(always)]
pub fn shade<R: Scalar>(launch: &LaunchContext<'_>, shading: &ShadingData<'_>, slot: u32, wave: Wave<'_, R>) -> bool {
    let Wave { paths, hits, shadows, lights, environment, sums } = wave;
    // A queue holds no slot of a pixel outside.
    let is_first = !launch.spec.launch.has(Launch::SECONDARY);
    if is_first && !camera::pixel(launch.frame, launch.spec.order, slot).inside {
        return false;
    }
    let effects = launch.spec.effects;
    let path = Path::<R>::current(launch, slot, paths);
    let found = Found::<R>::load(launch, slot, hits);
    if found.is_nothing() {
        if is_first && launch.spec.launch.has(Launch::CLEAR) {
            add(launch, sums, slot, &path, V3::zero(), CLEARED);
            return pop(launch, slot, &path, paths);
        }
        add(launch, sums, slot, &path, background(effects, launch.frame, environment, path.direction, is_first), 0);
        return pop(launch, slot, &path, paths);
    }
    let primitive = launch.placed(found.index, found.instance, found.time);
    if is_first && effects.has(Effects::HOLDOUT) && primitive.has(Primitive::HOLDOUT) {
        let word = if launch.spec.launch.has(Launch::CLEAR) { CLEARED } else { 0 };
        add(launch, sums, slot, &path, V3::zero(), word);
        return pop(launch, slot, &path, paths);
    }
    let interaction = SurfaceInteraction::new(effects, &primitive, found.coordinates, path.direction);
    let sample = camera::sample(launch.frame, slot);
    let start = if is_first { Cone::confused(launch, found.t, sample) } else { Cone::none() };
    let cone = start.after(launch, found.t, sample);
    let (Found { index, instance, time, .. }, direction) = (found, path.direction);
    let seen = Seen { index, instance, time, primitive, interaction, direction, cone };
    let covering = seen.covering(launch, shading);
    let surface = Surface::new(launch, shading, &seen, &covering);
    let (light, rays) = lit(launch, lights, (slot, time), path.direction, (&interaction, &surface), shadows);
    add(launch, sums, slot, &path, light, rays);
    if !effects.has(Effects::REFLECTION | Effects::REFRACTION) {
        return false;
    }
    follow(launch, slot, &path, branch(launch, &path, (&interaction, &surface)), paths)
}

/// Ambient light and every light that reaches the place, in file order; and how many were asked.
#[inline(always)]
fn lit<R: Scalar>(
    launch: &LaunchContext<'_>,
    lights: &[Light],
    (slot, time): (u32, f32),
    direction: V3<R>,
    lit: (&SurfaceInteraction<R>, &Surface<R>),
    shadows: &[u32],
) -> (V3<R>, u32) {
    let (interaction, surface) = lit;
    let mut sum = surface.ambient;
    let mut rays = 0;
    if !launch.spec.effects.has(Effects::LIT) {
        return (sum, rays);
    }
    let mut index = 0;
    while index < launch.frame.lights {
        let answer = read(shadows, index * launch.frame.slots + slot);
        if answer != FACES_AWAY {
            rays += 1;
        }
        if answer == REACHED {
            let light = at_time::<R>(launch, read(lights, index), time);
            let incidence = LightSample::new(launch.spec.effects, &light, interaction.position);
            sum = sum + eval_phong(launch.spec.effects, surface, direction, &incidence);
        }
        index += 1;
    }
    (sum, rays)
}

/// Adds a path's light to its slot's sum, or starts it. What is not finite is left out and flagged, what is below 2^-100
/// is zero.
#[inline(always)]
fn add<R: Scalar>(
    launch: &LaunchContext<'_>,
    sums: &mut [R::Record],
    slot: u32,
    path: &Path<R>,
    light: V3<R>,
    rays: u32,
) {
    let term = light.times(path.weight).map(|c| c.flush(FAINT));
    let finite = term.x.is_finite() && term.y.is_finite() && term.z.is_finite();
    let is_first = !launch.spec.launch.has(Launch::SECONDARY);
    let (sum, word) = if is_first { (V3::zero(), 0) } else { R::load(read(sums, slot)) };
    let word = word.wrapping_add(rays);
    let record = if finite { R::store(sum + term, word) } else { R::store(sum, word | NON_FINITE) };
    write(sums, slot, record);
}

/// The reflected and the refracted ray with their weights (thesis 3.3): a mirror's colour, or
/// Fresnel's shares of an interface.
#[inline(always)]
fn branch<R: Scalar>(
    launch: &LaunchContext<'_>,
    path: &Path<R>,
    (interaction, surface): (&SurfaceInteraction<R>, &Surface<R>),
) -> Branches<R> {
    let zero = R::splat(0.0);
    let mirrored = mirrored(path.direction, interaction, surface);
    let none = path.on(interaction, interaction.position, mirrored, V3::zero());
    if !launch.spec.effects.has(Effects::REFRACTION) || surface.ior.eq(zero) {
        let reflected = path.on(interaction, interaction.offset_ray_origin(mirrored), mirrored, surface.reflection);
        return Branches { reflected, refracted: none };
    }
    let one = R::splat(1.0);
    let eta = interaction.relative_ior(surface.ior);
    let at = refract(path.direction, surface.normal, eta);
    let share = fresnel(&at, eta);
    // On their own line, since glass magnifies a step beside it; a mirror has corners to escape through.
    let reflected =
        path.on(interaction, interaction.offset_ray_origin_along(mirrored), mirrored, V3::new(share, share, share));
    if at.total {
        return Branches { reflected, refracted: none };
    }
    let inwards = at.direction.normalised().0;
    let refracted = path.on(
        interaction,
        interaction.offset_ray_origin_along(inwards),
        inwards,
        surface.transmission * (one - share),
    );
    // Likewise an interpolated normal may refract a ray back out.
    Branches { reflected, refracted: if interaction.faces(inwards) { none } else { refracted } }
}

impl<R: Scalar> Path<R> {
    /// The path that goes on from an interaction.
    #[inline(always)]
    fn on(&self, from: &SurfaceInteraction<R>, origin: V3<R>, direction: V3<R>, weight: V3<R>) -> Self {
        Path {
            origin,
            direction,
            weight: self.weight.times(weight).map(|c| c.flush(FAINT)),
            bounces: self.bounces + 1,
            pending: self.pending,
            source_primitive: from.source_primitive(direction),
        }
    }
}

/// Is a path worth following? Bounce limit and least contribution end a ray tree (thesis 3.3.1).
#[inline(always)]
pub(super) fn counts<R: Scalar>(launch: &LaunchContext<'_>, bounces: u32, weight: V3<R>) -> bool {
    let least = R::splat(launch.frame.min_contribution);
    bounces <= launch.frame.bounces && least.le(weight.greatest()) && R::splat(0.0).lt(weight.greatest())
}

/// Depth first, reflection before refraction: takes one branch in hand and lets the other wait.
#[inline(always)]
fn follow<R: Scalar>(
    launch: &LaunchContext<'_>,
    slot: u32,
    path: &Path<R>,
    branches: Branches<R>,
    paths: &mut [R::Record],
) -> bool {
    let Branches { mut reflected, refracted } = branches;
    let second = counts(launch, refracted.bounces, refracted.weight);
    if counts(launch, reflected.bounces, reflected.weight) {
        if second {
            reflected.pending += 1;
            refracted.store(launch.frame.slots, slot, reflected.pending, paths);
        }
        reflected.store(launch.frame.slots, slot, 0, paths);
        true
    } else if second {
        refracted.store(launch.frame.slots, slot, 0, paths);
        true
    } else {
        pop(launch, slot, path, paths)
    }
}

/// Takes the last ray that waits in hand.
#[inline(always)]
fn pop<R: Scalar>(launch: &LaunchContext<'_>, slot: u32, path: &Path<R>, paths: &mut [R::Record]) -> bool {
    if !launch.spec.effects.has(Effects::REFRACTION) || path.pending == 0 {
        return false;
    }
    let mut next = Path::<R>::load(launch.frame.slots, slot, path.pending, paths);
    next.pending = path.pending - 1;
    next.store(launch.frame.slots, slot, 0, paths);
    true
}
