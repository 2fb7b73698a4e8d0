//! Texels to a value at a place.

use super::{Place, Textures};
use crate::buffer::read;
use crate::data::{Launch, TextureMap};
use crate::real::{Real, Scalar, V3};

/// A value of a texture.
#[derive(Clone, Copy)]
pub struct Texel<R: Real> {
    /// Linear RGB.
    pub colour: V3<R>,
    /// Opacity in [0, 1].
    pub alpha: R,
}

impl<R: Real> Texel<R> {
    #[inline(always)]
    fn mix(self, other: Self, share: R) -> Self {
        Texel { colour: self.colour.mix(other.colour, share), alpha: self.alpha + (other.alpha - self.alpha) * share }
    }
}

/// A level of a texture: where its texels start, its width and its height.
#[derive(Clone, Copy)]
struct Level {
    start: u32,
    width: u32,
    height: u32,
}

impl Level {
    /// The level of a number, below the count of levels.
    #[inline(always)]
    fn of(map: &TextureMap, number: u32) -> Level {
        let mut level = Level { start: map.place.x, width: map.place.y, height: map.place.z };
        let words = if map.place.w & TextureMap::FLOATS != 0 { 4 } else { 1 };
        let mut left = number;
        while left > 0 {
            level.start += level.width * level.height * words;
            level.width = halved(level.width);
            level.height = halved(level.height);
            left -= 1;
        }
        level
    }

    #[inline(always)]
    fn texel<R: Scalar>(&self, texels: &[u32], flags: u32, (x, y): (u32, u32)) -> Texel<R> {
        let index = y * self.width + x;
        let number = |bits: u32| R::splat(f32::from_bits(bits));
        if flags & TextureMap::FLOATS != 0 {
            let word = |i: u32| number(read(texels, self.start + 4 * index + i));
            return Texel { colour: V3::new(word(0), word(1), word(2)), alpha: word(3) };
        }
        let word = read(texels, self.start + index);
        let (red, green, blue) = (word & 255, (word >> 8) & 255, (word >> 16) & 255);
        let colour = V3::new(channel(texels, flags, red), channel(texels, flags, green), channel(texels, flags, blue));
        Texel { colour, alpha: share(word >> 24) }
    }

    #[inline(always)]
    fn alpha<R: Scalar>(&self, texels: &[u32], flags: u32, (x, y): (u32, u32)) -> R {
        let index = y * self.width + x;
        if flags & TextureMap::FLOATS != 0 {
            return R::splat(f32::from_bits(read(texels, self.start + 4 * index + 3)));
        }
        share(read(texels, self.start + index) >> 24)
    }
}

/// A byte as a share of 255; the products are exact at both ends.
#[inline(always)]
fn share<R: Real>(byte: u32) -> R {
    const STEP: f32 = 1.0 / 255.0;
    R::splat(byte as f32 * STEP)
}

/// A byte of a colour or of anything else.
#[inline(always)]
fn channel<R: Real>(texels: &[u32], flags: u32, byte: u32) -> R {
    if flags & TextureMap::SRGB != 0 { R::splat(f32::from_bits(read(texels, byte))) } else { share(byte) }
}

/// Half an edge, rounded down, at least 1.
#[inline(always)]
fn halved(edge: u32) -> u32 {
    if edge < 2 { 1 } else { edge >> 1 }
}

/// A texture at some coordinates, by the filter that a launch asks for: its nearest texel, or the four around weighted by their
/// distance (the finest level, or that whose texels are nearest in size to a ray's footprint). `footprint` is the square of the
/// ray's width there, in the units of the texture coordinates: of the whole texture.
#[inline(always)]
pub fn sample<R: Scalar>(
    launch: Launch,
    textures: &Textures<'_>,
    map: &TextureMap,
    (u, v): (R, R),
    footprint: R,
) -> Texel<R> {
    let flags = map.place.w;
    let level = if launch.has(Launch::MIPMAPPED) && R::splat(0.0).lt(footprint) { level(map, footprint) } else { 0 };
    let level = Level::of(map, level);
    let (wrap_u, wrap_v) = ((flags >> TextureMap::WRAP_SHIFT) & 3, (flags >> (TextureMap::WRAP_SHIFT + 2)) & 3);
    let (x, y) = (Axis::new(u, level.width, wrap_u), Axis::new(v, level.height, wrap_v));
    let texels = textures.texels;
    if is_nearest(launch, flags) {
        return level.texel(texels, flags, (x.nearest(), y.nearest()));
    }
    let (left, right) =
        (level.texel(texels, flags, (x.first, y.first)), level.texel(texels, flags, (x.second, y.first)));
    let above = left.mix(right, x.share);
    let (left, right) =
        (level.texel(texels, flags, (x.first, y.second)), level.texel(texels, flags, (x.second, y.second)));
    above.mix(left.mix(right, x.share), y.share)
}

/// The opacity of the finest level alone, of the nearest texel or the four around: what the kernels that follow rays hold of a
/// texture.
#[inline(always)]
pub fn opacity<R: Scalar>(launch: Launch, textures: &Textures<'_>, map: u32, place: &Place<R>) -> R {
    let map = read(textures.textures, map - 1);
    let (flags, finest, texels) = (map.place.w, Level::of(&map, 0), textures.texels);
    let (u, v) = place.coordinates(&place.corners(textures, &map), &map);
    let (wrap_u, wrap_v) = ((flags >> TextureMap::WRAP_SHIFT) & 3, (flags >> (TextureMap::WRAP_SHIFT + 2)) & 3);
    let (x, y) = (Axis::new(u, finest.width, wrap_u), Axis::new(v, finest.height, wrap_v));
    if is_nearest(launch, flags) {
        return finest.alpha(texels, flags, (x.nearest(), y.nearest()));
    }
    let a = finest.alpha::<R>(texels, flags, (x.first, y.first));
    let b = finest.alpha::<R>(texels, flags, (x.second, y.first));
    let c = finest.alpha::<R>(texels, flags, (x.first, y.second));
    let d = finest.alpha::<R>(texels, flags, (x.second, y.second));
    let (above, below) = (a + (b - a) * x.share, c + (d - c) * x.share);
    above + (below - above) * y.share
}

/// Does the nearest texel count alone?
#[inline(always)]
fn is_nearest(launch: Launch, flags: u32) -> bool {
    launch.has(Launch::NEAREST) || flags & TextureMap::NEAREST != 0
}

/// The level whose texels are nearest in size to a footprint: each is twice as wide as those of the one before.
#[inline(always)]
fn level<R: Scalar>(map: &TextureMap, footprint: R) -> u32 {
    let texels = footprint * R::splat(map.place.y as f32) * R::splat(map.place.z as f32);
    let exponent = (texels.to_f32().to_bits() >> 23) as i32 - 127;
    (((exponent + 1) >> 1).max(0) as u32).min(map.u.w - 1)
}

/// The texels beside a coordinate.
struct Axis<R> {
    first: u32,
    second: u32,
    /// How far it is from the middle of the first to that of the second, in [0, 1).
    share: R,
}

impl<R: Scalar> Axis<R> {
    #[inline(always)]
    fn new(coordinate: R, size: u32, wrap: u32) -> Self {
        let (zero, one, half) = (R::splat(0.0), R::splat(1.0), R::splat(0.5));
        let whole = |x: R| R::splat(x.floor_index() as f32);
        // Beyond 2^23 whole numbers end, and whatever is left is taken for an edge.
        let within = if wrap == TextureMap::CLAMP {
            coordinate.max(zero).min(one)
        } else if wrap == TextureMap::MIRROR {
            let periods = whole(coordinate * half);
            (coordinate - (periods + periods)).max(zero).min(one + one)
        } else {
            (coordinate - whole(coordinate)).max(zero).min(one)
        };
        let place = within * R::splat(size as f32) - half;
        let index = place.floor_index();
        Axis { first: wrapped(index, size, wrap), second: wrapped(index + 1, size, wrap), share: beyond(place, index) }
    }

    #[inline(always)]
    fn nearest(&self) -> u32 {
        if self.share.lt(R::splat(0.5)) { self.first } else { self.second }
    }
}

/// How far a place is beyond the middle of a texel, in texels; none of it below 2^-20, so that no product with it is subnormal.
#[inline(always)]
pub(crate) fn beyond<R: Scalar>(place: R, index: i32) -> R {
    const STEP: f32 = 1.0 / (1 << 20) as f32;
    (place - R::splat(index as f32)).max(R::splat(0.0)).flush(STEP)
}

/// The texel of an index from -1 to twice the size.
#[inline(always)]
fn wrapped(index: i32, size: u32, wrap: u32) -> u32 {
    let size = size as i32;
    let index = if wrap == TextureMap::CLAMP {
        index
    } else if wrap == TextureMap::MIRROR {
        let index = if index < 0 { -1 - index } else { index };
        if index < size { index } else { 2 * size - 1 - index }
    } else if index < 0 {
        index + size
    } else if index >= size {
        index - size
    } else {
        index
    };
    // Whatever rounding did, a texel of this level.
    index.max(0).min(size - 1) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;
    use glam::UVec4;
    use proptest::prelude::*;

    /// A texture of one level whose texels' red is their number, in floats.
    fn numbered(width: u32, height: u32, wrap: [u32; 2]) -> (TextureMap, Vec<u32>) {
        let flags = TextureMap::FLOATS | (wrap[0] | wrap[1] << 2) << TextureMap::WRAP_SHIFT;
        let map =
            TextureMap { place: UVec4::new(0, width, height, flags), u: UVec4::new(0, 0, 0, 1), ..Zeroable::zeroed() };
        (map, (0..width * height).flat_map(|i| [(i as f32).to_bits(), 0, 0, (i as f32).to_bits()]).collect())
    }

    fn textures(texels: &[u32]) -> Textures<'_> {
        Textures { textures: &[], texels, coordinates: &[], colours: &[] }
    }

    fn red(launch: u32, (map, texels): &(TextureMap, Vec<u32>), at: (f64, f64)) -> f64 {
        sample(Launch(launch), &textures(texels), map, at, 0.0).colour.x
    }

    #[test]
    fn the_middle_of_a_texel_is_its_own_value() {
        for wrap in [TextureMap::REPEAT, TextureMap::MIRROR, TextureMap::CLAMP] {
            let texture = numbered(5, 3, [wrap; 2]);
            for (x, y) in (0..3).flat_map(|y| (0..5).map(move |x| (x, y))) {
                let at = ((f64::from(x) + 0.5) / 5.0, (f64::from(y) + 0.5) / 3.0);
                let want = f64::from(y * 5 + x);
                assert!((red(0, &texture, at) - want).abs() < 1e-5 && red(Launch::NEAREST, &texture, at) == want);
            }
        }
    }

    #[test]
    fn textures_repeat_are_mirrored_or_end_at_their_edges() {
        let at = |wrap, x: f64| red(0, &numbered(4, 1, [wrap; 2]), (x / 4.0, 0.5));
        for (x, repeat, mirror, clamp) in [
            (-0.5, 3.0, 0.0, 0.0),
            (0.0, 1.5, 0.0, 0.0),
            (4.5, 0.0, 3.0, 3.0),
            (9.5, 1.0, 1.0, 3.0),
            (4001.5, 1.0, 1.0, 3.0),
        ] {
            let got = [TextureMap::REPEAT, TextureMap::MIRROR, TextureMap::CLAMP].map(|wrap| at(wrap, x));
            for (got, want) in got.into_iter().zip([repeat, mirror, clamp]) {
                assert!((got - want).abs() < 1e-4, "{x}: {got}, not {want}");
            }
        }
    }

    /// Each level is as coarse as its number says, and starts where the one before ends.
    #[test]
    fn a_footprint_finds_the_level_of_its_size() {
        let map = TextureMap { place: UVec4::new(7, 16, 8, 0), u: UVec4::new(0, 0, 0, 5), ..Zeroable::zeroed() };
        let texels = |width: f64| level(&map, width * width / 128.0);
        assert_eq!([0.0, 1.0, 1.4, 1.5, 2.0, 2.8, 2.9, 8.0, 1e9].map(texels), [0, 0, 0, 1, 1, 1, 2, 3, 4]);
        let levels: Vec<(u32, u32, u32)> =
            (0..5).map(|i| Level::of(&map, i)).map(|l| (l.start, l.width, l.height)).collect();
        assert_eq!(levels, [(7, 16, 8), (135, 8, 4), (167, 4, 2), (175, 2, 1), (177, 1, 1)]);
    }

    #[test]
    fn bytes_are_shares_or_go_through_the_table() {
        let mut texels: Vec<u32> = (0..256u32).map(|byte| (byte as f32 * 2.0).to_bits()).collect();
        texels.push(0x80ff_0001);
        let map =
            |flags| TextureMap { place: UVec4::new(256, 1, 1, flags), u: UVec4::new(0, 0, 0, 1), ..Zeroable::zeroed() };
        let got = sample::<f32>(Launch(0), &textures(&texels), &map(TextureMap::SRGB), (0.5, 0.5), 0.0);
        assert_eq!((got.colour, got.alpha), (V3::new(2.0, 0.0, 510.0), 128.0 * (1.0 / 255.0)));
        let got = sample::<f32>(Launch(0), &textures(&texels), &map(0), (0.5, 0.5), 0.0);
        assert_eq!(got.colour, V3::new(1.0 / 255.0, 0.0, 1.0));
    }

    proptest! {
        /// No coordinate, however large or odd, finds a texel that is not there.
        #[test]
        fn every_coordinate_finds_texels(
            bits in prop::array::uniform2(any::<u32>()), width in 1u32..70, height in 1u32..70,
            wrap in prop::array::uniform2(0u32..3), nearest: bool,
        ) {
            let at = (f32::from_bits(bits[0]), f32::from_bits(bits[1]));
            let (map, texels) = numbered(width, height, wrap);
            let launch = if nearest { Launch::NEAREST } else { 0 };
            let got = sample::<f32>(Launch(launch), &textures(&texels), &map, at, 0.0).colour.x;
            prop_assert!(!at.0.is_finite() || !at.1.is_finite() || (0.0..(width * height) as f32).contains(&got));
        }

        #[test]
        fn between_texels_values_are_weighted_by_distance(x in 0.0f64..1.0, y in 0.0f64..1.0) {
            let texture = numbered(4, 4, [TextureMap::CLAMP; 2]);
            let at = |c: f64| (c * 4.0 - 0.5).clamp(0.0, 3.0);
            prop_assert!((red(0, &texture, (x, y)) - (at(x) + 4.0 * at(y))).abs() < 1e-4);
        }
    }
}
