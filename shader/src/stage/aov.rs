//! Arbitrary output variables ([`Aovs`]): what slots have of them, behind their light, and how films keep them.

use super::{Caught, FilmWords, LIGHT_FRACTION, LIGHT_MOST, Row, ShadowRay};
use crate::buffer::{read, write};
use crate::camera::Pixel;
use crate::data::{Aovs, Frame, Launch, Quanta, Specialisation};
use crate::real::{FAINT, Real, Scalar, V3};

/// Words that a film keeps of one: three a channel.
pub const AOV_WORDS: u32 = 9;

/// Light that reaches the pixel.
#[derive(Clone, Copy)]
pub struct Contribution<R: Real> {
    /// Linear RGB.
    pub light: V3<R>,
    /// How often it was scattered.
    pub bounces: u32,
    /// The group of the lamp that sends it.
    pub group: u32,
    /// How it was found, by the constants of this type.
    pub found: u32,
}

impl<R: Real> Contribution<R> {
    /// By the path, on a surface.
    pub const SURFACE: u32 = 0;
    /// By the path, beyond all surfaces.
    pub const SURROUNDINGS: u32 = 1;
    /// By a shadow ray.
    pub const SAMPLED: u32 = 2;

    /// Bits of a [tag](Self::tag) below those of its bounces.
    const GROUP: u32 = 8;

    /// What a shadow ray's record remembers of its light: its group, and whether it was scattered once.
    #[inline(always)]
    pub fn tag(group: u32, bounces: u32) -> u32 {
        let often = if bounces > 1 { 2 } else { 1 };
        group | (often << Self::GROUP)
    }

    /// The light of a shadow ray, by its tag.
    #[inline(always)]
    pub fn of_shadow_ray(light: V3<R>, tag: u32) -> Self {
        let group = tag & ((1 << Self::GROUP) - 1);
        Contribution { light, bounces: tag >> Self::GROUP, group, found: Self::SAMPLED }
    }
}

/// By which parts the surface that the camera sees scatters light from some direction.
#[derive(Clone, Copy)]
pub struct Split<R: Real> {
    /// The share of the diffuse part; the rest is mirrored.
    pub diffuse: V3<R>,
    /// Does all of it come through the surface instead?
    pub passes: bool,
}

impl<R: Scalar> Split<R> {
    /// All is mirrored.
    #[inline(always)]
    pub fn none() -> Self {
        Split { diffuse: V3::zero(), passes: false }
    }

    /// All is scattered evenly: by a medium.
    #[inline(always)]
    pub fn even() -> Self {
        Split { diffuse: V3::splat(glam::Vec3::ONE), passes: false }
    }

    /// Of what is scattered in all and what the diffuse part scatters.
    #[inline(always)]
    pub fn new(all: V3<R>, diffuse: V3<R>, passes: bool) -> Self {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let share = |all: R, part: R| {
            let is_some = zero.lt(all);
            R::select(is_some, part.div(R::select(is_some, all, one)).min(one), zero)
        };
        let diffuse = V3::new(share(all.x, diffuse.x), share(all.y, diffuse.y), share(all.z, diffuse.z));
        Split { diffuse, passes }
    }
}

/// What is known at the first surface alone.
#[derive(Clone, Copy)]
pub struct FirstSurface<R: Real> {
    /// See [`Aovs::ALBEDO`].
    pub albedo: V3<R>,
    /// See [`Aovs::NORMAL`].
    pub normal: V3<R>,
    /// Of its shadow ray's light.
    pub sampled: Split<R>,
    /// Of all that the path finds further on.
    pub further: Split<R>,
}

impl<R: Scalar> FirstSurface<R> {
    /// There is none.
    #[inline(always)]
    pub fn none() -> Self {
        FirstSurface { albedo: V3::zero(), normal: V3::zero(), sampled: Split::none(), further: Split::none() }
    }
}

/// Where a slot keeps its variables: by record, behind the light of all slots.
#[derive(Clone, Copy)]
pub struct AovSlot {
    aovs: Aovs,
    /// How many there are.
    count: u32,
    slots: u32,
    slot: u32,
    /// The first record.
    first: u32,
}

/// Records before a slot's variables: its light, what it has of shadow catchers, and two [splits](Split).
#[inline(always)]
fn records_before(launch: Launch, aovs: Aovs) -> u32 {
    let catcher = if launch.has(Launch::CATCHER) { 1 } else { 0 };
    1 + catcher + if aovs.has(Aovs::LOBES) { 2 } else { 0 }
}

/// Records of all that a slot sums.
pub fn sum_records(spec: Specialisation, aovs: u32) -> u32 {
    records_before(spec.launch, spec.aovs) + aovs
}

impl AovSlot {
    /// That of a launch.
    #[inline(always)]
    pub fn new(frame: &Frame, spec: Specialisation, slot: u32) -> Self {
        let first = records_before(spec.launch, spec.aovs);
        AovSlot { aovs: spec.aovs, count: frame.aovs, slots: frame.slots, slot, first }
    }

    /// The place of a record in memory.
    #[inline(always)]
    fn at(self, record: u32) -> u32 {
        (self.first + record) * self.slots + self.slot
    }

    /// Starts with what the first surface tells, and no light.
    #[inline(always)]
    pub fn start<R: Scalar>(self, surface: &FirstSurface<R>, sums: &mut [R::Record]) {
        let mut record = 0;
        while record < self.count {
            write(sums, self.at(record), R::store(V3::zero(), 0));
            record += 1;
        }
        if self.aovs.has(Aovs::ALBEDO) {
            write(sums, self.at(self.aovs.place(Aovs::ALBEDO)), R::store(surface.albedo, 0));
        }
        if self.aovs.has(Aovs::NORMAL) {
            write(sums, self.at(self.aovs.place(Aovs::NORMAL)), R::store(surface.normal, 0));
        }
        if self.aovs.has(Aovs::LOBES) {
            self.keep(0, &surface.sampled, sums);
            self.keep(1, &surface.further, sums);
        }
    }

    /// Where one of the two splits is: right before the variables.
    #[inline(always)]
    fn split_at(self, number: u32) -> u32 {
        (self.first - 2 + number) * self.slots + self.slot
    }

    #[inline(always)]
    fn keep<R: Scalar>(self, number: u32, split: &Split<R>, sums: &mut [R::Record]) {
        write(sums, self.split_at(number), R::store(split.diffuse, if split.passes { 1 } else { 0 }));
    }

    /// Adds light to all variables that it is part of.
    #[inline(always)]
    pub fn add<R: Scalar>(self, of: &Contribution<R>, sums: &mut [R::Record]) {
        if !R::splat(0.0).lt(of.light.greatest()) {
            return;
        }
        let Contribution { light, bounces, group, found } = *of;
        let is_far = found == Contribution::<R>::SURROUNDINGS;
        if self.aovs.has(Aovs::EMISSION) && bounces == 0 && !is_far {
            self.add_to(self.aovs.place(Aovs::EMISSION), light, sums);
        }
        if self.aovs.has(Aovs::ENVIRONMENT) && bounces == 0 && is_far {
            self.add_to(self.aovs.place(Aovs::ENVIRONMENT), light, sums);
        }
        if self.aovs.has(Aovs::DIRECT) && bounces <= 1 {
            self.add_to(self.aovs.place(Aovs::DIRECT), light, sums);
        }
        if self.aovs.has(Aovs::GROUPS) {
            self.add_to(self.aovs.place(Aovs::GROUPS) + group, light, sums);
        }
        if self.aovs.has(Aovs::LOBES) && bounces > 0 {
            self.add_by_lobe(of, sums);
        }
    }

    #[inline(always)]
    fn add_by_lobe<R: Scalar>(self, of: &Contribution<R>, sums: &mut [R::Record]) {
        let Contribution { light, bounces, found, .. } = *of;
        // Without a branch, behind which a compiler would choose a pointer.
        let own = (bounces == 1) & (found == Contribution::<R>::SAMPLED);
        let (share, passes) = R::load(read(sums, self.split_at(1 - u32::from(own))));
        // The variable of indirect light is the one after that of direct light.
        let further = u32::from(bounces > 1);
        if passes != 0 {
            self.add_to_asked(Aovs::TRANSMISSION_DIRECT << further, light, sums);
            return;
        }
        let part = light.times(share).map(|c| c.flush(FAINT));
        self.add_to_asked(Aovs::DIFFUSE_DIRECT << further, part, sums);
        self.add_to_asked(Aovs::GLOSSY_DIRECT << further, light - part, sums);
    }

    #[inline(always)]
    fn add_to_asked<R: Scalar>(self, bit: u32, light: V3<R>, sums: &mut [R::Record]) {
        if self.aovs.has(bit) {
            self.add_to(self.aovs.place(bit), light, sums);
        }
    }

    #[inline(always)]
    fn add_to<R: Scalar>(self, record: u32, light: V3<R>, sums: &mut [R::Record]) {
        let at = self.at(record);
        let sum = R::load(read(sums, at)).0;
        write(sums, at, R::store(sum + light, 0));
    }
}

/// What some samples of a pixel have of a variable; the last words are not kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AovSums {
    /// Red, or the first component.
    pub x: Quanta,
    /// Green, or the second.
    pub y: Quanta,
    /// Blue, or the third.
    pub z: Quanta,
}

impl AovSums {
    /// One sample's.
    #[inline(always)]
    pub fn of<R: Scalar>(value: V3<R>) -> Self {
        let channel = |c: R| Quanta::of(c.to_f32(), LIGHT_FRACTION, LIGHT_MOST);
        AovSums { x: channel(value.x), y: channel(value.y), z: channel(value.z) }
    }

    /// These samples and others.
    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        AovSums { x: self.x.plus(other.x), y: self.y.plus(other.y), z: self.z.plus(other.z) }
    }

    /// Those of a variable, by its number, of the pixel in column `x` of a row of a film.
    #[inline(always)]
    pub fn load(film: &[u32], row: Row, number: u32, x: u32) -> Self {
        AovSums {
            x: load(film, row, row.aov(number, 0) + x),
            y: load(film, row, row.aov(number, 3) + x),
            z: load(film, row, row.aov(number, 6) + x),
        }
    }

    /// Keeps them there.
    #[inline(always)]
    pub fn store(self, film: &mut [u32], row: Row, number: u32, x: u32) {
        store(film, row, row.aov(number, 0) + x, self.x);
        store(film, row, row.aov(number, 3) + x, self.y);
        store(film, row, row.aov(number, 6) + x, self.z);
    }
}

// No closures: one that captures a slice in a loop makes a phi of it, which drivers crash on.

/// A channel of a film's row whose first word is at `place`.
#[inline(always)]
fn load(film: &[u32], row: Row, place: u32) -> Quanta {
    Quanta(read(film, place), read(film, place + row.columns), read(film, place + 2 * row.columns), 0)
}

#[inline(always)]
fn store(film: &mut [u32], row: Row, place: u32, sum: Quanta) {
    write(film, place, sum.0);
    write(film, place + row.columns, sum.1);
    write(film, place + 2 * row.columns, sum.2);
}

/// Adds the variables of the samples that a launch has of a pixel to the film of its region, once with the light that the last vertices
/// waited for. `slot` is that of the first.
#[inline(always)]
pub fn expose_aovs<R: Scalar>(
    frame: &Frame,
    spec: Specialisation,
    (pixel, slot): (Pixel, u32),
    (sums, shadows, segments): (&mut [R::Record], &[u32], &[R::Record]),
    words: FilmWords,
    film: &mut [u32],
) {
    if !pixel.inside || slot >= frame.pixel_slots {
        return;
    }
    let mut at = slot;
    while at < frame.slots {
        // That of a shadow catcher is none of the picture.
        if !Caught::<R>::load(spec.launch, frame, at, sums).waits() {
            let (light, tag) = ShadowRay::<R>::arrived(frame.slots, at, shadows, segments);
            AovSlot::new(frame, spec, at).add(&Contribution::of_shadow_ray(light, tag), sums);
        }
        at += frame.pixel_slots;
    }
    let row = Row::new(pixel.y, frame.columns, words);
    let mut number = 0;
    while number < frame.aovs {
        let mut all = AovSums::default();
        if frame.anew == 0 {
            all = AovSums::load(film, row, number, pixel.x);
        }
        let mut at = slot;
        while at < frame.slots {
            let record = AovSlot::new(frame, spec, at).at(number);
            all = all.plus(AovSums::of(R::load(read(sums, record)).0));
            at += frame.pixel_slots;
        }
        all.store(film, row, number, pixel.x);
        number += 1;
    }
}
