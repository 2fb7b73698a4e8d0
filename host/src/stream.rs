//! Rays in memory, to be traced as they are: what benchmarks and tests give to every method and device.

use std::ops::Range;

use eyerays_shader::data::{numbers, pack};
use eyerays_shader::ray::Hit;
use eyerays_shader::stage::Found;
use glam::{UVec4, Vec3};

/// A ray of a stream.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamRay {
    /// Where it starts, in the normalised scene.
    pub origin: Vec3,
    /// Where it goes, of any length but zero.
    pub direction: Vec3,
    /// Nothing beyond this many lengths of the direction counts.
    pub limit: f32,
    /// The primitive that it starts on and can't hit, or [`StreamRay::NOWHERE`].
    pub source_primitive: u32,
}

impl StreamRay {
    /// It starts on no primitive.
    pub const NOWHERE: u32 = Hit::<f32>::NOTHING;
    /// A ray that meets nothing: it starts beside the scene and goes away from it.
    pub(crate) const AWAY: StreamRay = StreamRay {
        origin: Vec3::new(2.0, 0.0, 0.0),
        direction: Vec3::X,
        limit: 0.0,
        source_primitive: StreamRay::NOWHERE,
    };
}

/// Rays as kernels read them ([`eyerays_shader::stage::Segment`]).
#[derive(Debug, Clone, Default)]
pub struct Stream {
    words: Vec<UVec4>,
}

impl Stream {
    /// The rays in this order.
    pub fn new(rays: impl ExactSizeIterator<Item = StreamRay>) -> Self {
        Self::filled(rays.len(), rays)
    }

    /// The rays of all parts in this order.
    pub fn of_parts(parts: &[Vec<StreamRay>]) -> Self {
        Self::filled(parts.iter().map(Vec::len).sum(), parts.iter().flatten().copied())
    }

    /// As [`Stream::words`] has them.
    pub(crate) fn of_words(words: Vec<UVec4>) -> Self {
        Stream { words }
    }

    fn filled(count: usize, rays: impl Iterator<Item = StreamRay>) -> Self {
        let mut words = vec![UVec4::ZERO; 2 * count];
        for (i, ray) in rays.enumerate() {
            words[i] = pack(ray.origin, ray.source_primitive);
            words[count + i] = pack(ray.direction, ray.limit.to_bits());
        }
        Stream { words }
    }

    /// Some of its rays, as a stream of their own.
    ///
    /// # Panics
    /// If there are not so many.
    pub fn part(&self, rays: Range<usize>) -> Self {
        let seconds = self.len() + rays.start..self.len() + rays.end;
        Stream { words: [&self.words[rays], &self.words[seconds]].concat() }
    }

    /// Those rays of it, as a stream of their own.
    pub(crate) fn of(&self, rays: &[u32]) -> Self {
        Stream::new(rays.iter().map(|&ray| self.ray(ray as usize)))
    }

    /// How many rays there are.
    pub fn len(&self) -> usize {
        self.words.len() / 2
    }

    /// Is there none?
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Ray `i`.
    ///
    /// # Panics
    /// If there are not so many.
    pub fn ray(&self, i: usize) -> StreamRay {
        let (first, second) = (self.words[i], self.words[self.len() + i]);
        StreamRay {
            origin: numbers(first),
            direction: numbers(second),
            limit: f32::from_bits(second.w),
            source_primitive: first.w,
        }
    }

    /// Every ray's origin and source primitive, then every ray's direction and limit.
    pub fn words(&self) -> &[UVec4] {
        &self.words
    }
}

/// What is asked of the rays of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Question {
    /// The closest hit of each.
    Closest,
    /// Whether anything opaque lies before its limit.
    Occlusion,
}

/// The answers to a [`Question`], by ray.
#[derive(Debug, Clone, PartialEq)]
pub enum Answers {
    /// The bits of (t, u, v), and the slot of the triangle or [`StreamRay::NOWHERE`]. In a scene with copies of meshes as many words
    /// follow, whose integer is the copy or [`StreamRay::NOWHERE`].
    Closest(Vec<UVec4>),
    /// [`eyerays_shader::stage::REACHED`] or [`eyerays_shader::stage::SHADOWED`].
    Occlusion(Vec<u32>),
}

impl Answers {
    /// What ray `i` of `count` has found, if that was asked.
    pub(crate) fn found(&self, i: usize, count: usize) -> Option<Found<f32>> {
        let Answers::Closest(records) = self else { return None };
        (i < count).then(|| found(records, i, count))
    }
}

/// What ray `i` of `count` has found, as [`Answers::Closest`] has it.
#[inline]
pub(crate) fn found(records: &[UVec4], i: usize, count: usize) -> Found<f32> {
    let instance = records.get(count + i).map_or(StreamRay::NOWHERE, |record| record.w);
    let record = records[i];
    let [t, u, v] = [record.x, record.y, record.z].map(f32::from_bits);
    Found { t, coordinates: (u, v), index: record.w, instance, time: 0.0 }
}
