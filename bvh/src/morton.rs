//! The order along a Z curve.

use crate::bounds::Bounds;

/// Bits an axis; three of them fill a code.
const BITS: u32 = 21;

/// The numbers of the boxes, sorted by the Morton code of their centres, then by number.
pub(crate) fn sorted(bounds: &[Bounds]) -> Vec<u32> {
    let scene = Bounds::around(bounds.iter().map(|b| Bounds::point(b.centre())));
    let mut keys: Vec<(u64, u32)> = bounds.iter().map(|b| code(b, &scene)).zip(0..).collect();
    keys.sort_unstable();
    keys.into_iter().map(|(_, number)| number).collect()
}

/// The Morton code of a box's centre within the box of all centres.
fn code(bounds: &Bounds, scene: &Bounds) -> u64 {
    let (centre, extent) = (bounds.centre(), scene.extent());
    (0..3).fold(0, |code, axis| {
        let unit = (centre[axis] - scene.min[axis]) / extent[axis];
        // A flat scene gives 0 / 0, and the conversion makes that 0.
        let cell = (unit * (1u32 << BITS) as f32) as u32;
        code | spread(cell.min((1 << BITS) - 1)) << axis
    })
}

/// Two zero bits between each two of the lower 21 bits.
fn spread(cell: u32) -> u64 {
    let x = u64::from(cell);
    let x = (x | x << 32) & 0x001f_0000_0000_ffff;
    let x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreading_keeps_every_bit_and_two_places_between() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread((1 << BITS) - 1), 0x1249_2492_4924_9249);
    }

    #[test]
    fn corners_of_a_cube_follow_the_curve_and_equals_their_numbers() {
        let corner = |i: u32| {
            let p = [0, 1, 2].map(|axis| (i >> axis & 1) as f32);
            Bounds::new(p, p)
        };
        let boxes: Vec<Bounds> = [7, 3, 0, 5, 5, 1, 0].map(corner).into();
        assert_eq!(sorted(&boxes), [2, 6, 5, 1, 3, 4, 0]);
    }
}
