//! A picture cut into launches.

use eyerays_shader::camera;
use eyerays_shader::data::Order;

use crate::view::Region;

/// Cuts what is rendered of an image into regions of at most `slots` slots: whole rows, if that many fit.
pub(super) fn bands(window: Region, slots: u32, order: Order) -> Vec<Region> {
    let (least, most) = camera::blocks(order);
    let columns = window.width.min((slots / (least * most) * least).max(least));
    let rows = (slots / camera::slots(columns, most, order) * most).max(most);
    window.pieces(columns, rows).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_cover_every_pixel_once_and_fit() {
        let corner = (3, 2);
        for (size, slots) in [((1, 1), 32), ((100, 70), 32), ((100, 70), 512), ((100, 70), 1 << 22), ((9, 3), 64)] {
            let mut seen = vec![0; (size.0 * size.1) as usize];
            let window = Region { x: corner.0, y: corner.1, width: size.0, height: size.1 };
            for band in bands(window, slots, Order(0)) {
                assert!(camera::slots(band.width, band.height, Order(0)) <= slots, "{size:?} {slots}: {band:?}");
                for y in band.y..band.y + band.height {
                    for x in band.x..band.x + band.width {
                        seen[((y - corner.1) * size.0 + x - corner.0) as usize] += 1;
                    }
                }
            }
            assert!(seen.iter().all(|&n| n == 1), "{size:?} {slots}");
        }
    }
}
