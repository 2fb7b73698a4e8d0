//! The light of a slot's hit, added to the film, and the rays that go on from there.

use super::{FACES_AWAY, NON_FINITE, Path, REACHED};
use crate::buffer::{read, write};
use crate::camera;
use crate::data::{Features, Light};
use crate::ray::Hit;
use crate::real::{FAINT, Real, Scalar, V3};
use crate::scene::{Geometry, Looks};
use crate::shade::{Contact, Incidence, Surface, background, fresnel, illuminate, reflect, refract};

/// The records that the stages of a wave exchange.
pub struct Wave<'a, R: Scalar> {
    /// Paths by level, record and slot.
    pub paths: &'a mut [R::Record],
    /// (t, u, v) and triangle by slot.
    pub hits: &'a [R::Record],
    /// What [`super::shadow`] returned, by light and slot.
    pub shadows: &'a [u32],
    /// Linear RGB by pixel of the region; the integer counts shadow rays and holds [`NON_FINITE`].
    pub film: &'a mut [R::Record],
}

/// The rays that go on from a hit; a zero weight is none.
struct Branches<R: Real> {
    reflected: Path<R>,
    refracted: Path<R>,
}

/// Shades a slot's hit. Returns whether the slot has another ray to trace.
#[inline(always)]
pub fn shade<R: Scalar>(geometry: &Geometry<'_>, looks: &Looks<'_>, slot: u32, wave: Wave<'_, R>) -> bool {
    let Wave { paths, hits, shadows, film } = wave;
    let pixel = camera::pixel(geometry.frame, geometry.features, slot);
    if !pixel.inside {
        return false;
    }
    let path = Path::<R>::current(geometry, slot, paths);
    let (hit, triangle_index) = R::load(read(hits, slot));
    if triangle_index == Hit::<R>::NOTHING {
        add(geometry, film, pixel.index, &path, background(geometry.features, geometry.frame, path.direction), 0);
        return pop(geometry, slot, &path, paths);
    }
    let triangle = geometry.triangle(triangle_index);
    let contact = Contact::new(&triangle, hit.y, hit.z, path.direction);
    let surface = Surface::new(geometry.features, looks, triangle_index, &triangle, path.direction, &contact);
    let (light, rays) = lit(geometry, looks.lights, slot, path.direction, (&contact, &surface), shadows);
    add(geometry, film, pixel.index, &path, light, rays);
    if !geometry.features.has(Features::REFLECTION) && !geometry.features.has(Features::REFRACTION) {
        return false;
    }
    follow(geometry, slot, &path, branch(geometry, &path, triangle.primitive(), (&contact, &surface)), paths)
}

/// Ambient light and every light that reaches the place, in file order; and how many were asked.
#[inline(always)]
fn lit<R: Scalar>(
    geometry: &Geometry<'_>,
    lights: &[Light],
    slot: u32,
    direction: V3<R>,
    lit: (&Contact<R>, &Surface<R>),
    shadows: &[u32],
) -> (V3<R>, u32) {
    let (contact, surface) = lit;
    let mut sum = surface.ambient;
    let mut rays = 0;
    let mut index = 0;
    while index < geometry.light_count() {
        let answer = read(shadows, index * geometry.slots() + slot);
        if answer != FACES_AWAY {
            rays += 1;
        }
        if answer == REACHED {
            let incidence = Incidence::new(geometry.features, &read(lights, index), contact.position);
            sum = sum + illuminate(geometry.features, surface, direction, &incidence);
        }
        index += 1;
    }
    (sum, rays)
}

/// Adds a path's light to its pixel. What is not finite is left out and flagged, what is below 2^-100 is zero.
#[inline(always)]
fn add<R: Scalar>(
    geometry: &Geometry<'_>,
    film: &mut [R::Record],
    pixel: u32,
    path: &Path<R>,
    light: V3<R>,
    rays: u32,
) {
    let share = R::splat(f32::from_bits(geometry.frame.limits.x));
    let term = (light.times(path.weight) * share).map(|c| c.flush(FAINT));
    let finite = term.x.is_finite() && term.y.is_finite() && term.z.is_finite();
    let (sum, word) = R::load(read(film, pixel));
    let word = word.wrapping_add(rays);
    let record = if finite { R::store(sum + term, word) } else { R::store(sum, word | NON_FINITE) };
    write(film, pixel, record);
}

/// The reflected and the refracted ray with their weights (thesis 3.3): a mirror's colour, or
/// Fresnel's shares of an interface.
#[inline(always)]
fn branch<R: Scalar>(
    geometry: &Geometry<'_>,
    path: &Path<R>,
    source_primitive: u32,
    (contact, surface): (&Contact<R>, &Surface<R>),
) -> Branches<R> {
    let zero = R::splat(0.0);
    let mirrored = reflect(path.direction, surface.normal);
    // An interpolated normal may mirror a ray into its own surface; the triangle's normal does not.
    let mirrored = V3::select(contact.faces(mirrored), mirrored, reflect(path.direction, contact.normal));
    let none = path.on(source_primitive, contact.position, mirrored, V3::zero());
    if !geometry.features.has(Features::REFRACTION) || surface.ior.eq(zero) {
        let reflected = path.on(source_primitive, contact.leave(mirrored), mirrored, surface.reflection);
        return Branches { reflected, refracted: none };
    }
    let one = R::splat(1.0);
    let eta = if contact.front { one.div(surface.ior) } else { surface.ior };
    let at = refract(path.direction, surface.normal, eta);
    let share = fresnel(&at, eta);
    // On their own line, since glass magnifies a step beside it; a mirror has corners to escape through.
    let reflected = path.on(source_primitive, contact.leave_along(mirrored), mirrored, V3::new(share, share, share));
    if at.total {
        return Branches { reflected, refracted: none };
    }
    let inwards = at.direction.normalised().0;
    let refracted =
        path.on(source_primitive, contact.leave_along(inwards), inwards, surface.transmission * (one - share));
    // Likewise an interpolated normal may refract a ray back out.
    Branches { reflected, refracted: if contact.faces(inwards) { none } else { refracted } }
}

impl<R: Scalar> Path<R> {
    /// The path that goes on from a contact.
    #[inline(always)]
    fn on(&self, source_primitive: u32, origin: V3<R>, direction: V3<R>, weight: V3<R>) -> Self {
        Path {
            origin,
            direction,
            weight: self.weight.times(weight).map(|c| c.flush(FAINT)),
            bounces: self.bounces + 1,
            pending: self.pending,
            source_primitive,
        }
    }

    /// Is it worth following? Bounce limit and least contribution end a ray tree (thesis 3.3.1).
    #[inline(always)]
    fn counts(&self, geometry: &Geometry<'_>) -> bool {
        let least = R::splat(f32::from_bits(geometry.frame.limits.y));
        self.bounces <= geometry.frame.bottom.w
            && least.le(self.weight.greatest())
            && R::splat(0.0).lt(self.weight.greatest())
    }
}

/// Depth first, reflection before refraction: takes one branch in hand and lets the other wait.
#[inline(always)]
fn follow<R: Scalar>(
    geometry: &Geometry<'_>,
    slot: u32,
    path: &Path<R>,
    branches: Branches<R>,
    paths: &mut [R::Record],
) -> bool {
    let Branches { mut reflected, refracted } = branches;
    let second = refracted.counts(geometry);
    if reflected.counts(geometry) {
        if second {
            reflected.pending += 1;
            refracted.store(geometry.slots(), slot, reflected.pending, paths);
        }
        reflected.store(geometry.slots(), slot, 0, paths);
        true
    } else if second {
        refracted.store(geometry.slots(), slot, 0, paths);
        true
    } else {
        pop(geometry, slot, path, paths)
    }
}

/// Takes the last ray that waits in hand.
#[inline(always)]
fn pop<R: Scalar>(geometry: &Geometry<'_>, slot: u32, path: &Path<R>, paths: &mut [R::Record]) -> bool {
    if !geometry.features.has(Features::REFRACTION) || path.pending == 0 {
        return false;
    }
    let mut next = Path::<R>::load(geometry.slots(), slot, path.pending, paths);
    next.pending = path.pending - 1;
    next.store(geometry.slots(), slot, 0, paths);
    true
}
