//! A picture over any numbers: the stages in their order, by the simplest method, on one thread.

use eyerays::method::Traversal;
use eyerays::pack::{Laid, Packed, Region};
use eyerays_shader::camera;
use eyerays_shader::data::Features;
use eyerays_shader::real::{Scalar, V3};
use eyerays_shader::scene::Looks;
use eyerays_shader::stage::{self, Asking, RECORDS, Wave};
use eyerays_shader::traverse::IfIf;

/// The film of one sample a pixel, row-major from the top left.
pub fn picture<R: Scalar>(packed: &Packed) -> Vec<V3<R>> {
    let (width, height) = packed.settings().size;
    let laid = Laid::new(packed, Traversal::default());
    let features = laid.features();
    let frame = packed.frame(Region { x: 0, y: 0, width, height }, 0, features);
    let mut geometry = laid.geometry(&frame);
    let looks = Looks { normals: packed.normals(), materials: packed.materials(), lights: packed.lights() };
    let (slots, black) = (geometry.slots() as usize, R::store(V3::zero(), 0));
    let mut paths = vec![black; slots * (packed.levels() * RECORDS) as usize];
    let (mut hits, mut shadows) = (vec![black; slots], vec![0; slots * packed.lights().len()]);
    let mut film = vec![black; (width * height) as usize];
    let mut queue: Vec<u32> = (0..slots as u32).filter(|&slot| camera::pixel(&frame, features, slot).inside).collect();
    while !queue.is_empty() {
        for &slot in &queue {
            hits[slot as usize] = stage::trace::<R, IfIf>(&geometry, slot, &paths);
            for light in 0..geometry.light_count() {
                let asking = Asking { lights: looks.lights, paths: &paths, hits: &hits };
                let answer = stage::shadow::<R, IfIf>(&geometry, asking, slot, light);
                shadows[light as usize * slots + slot as usize] = answer;
            }
        }
        queue.retain(|&slot| {
            let wave = Wave::<R> { paths: &mut paths, hits: &hits, shadows: &shadows, film: &mut film };
            stage::shade(&geometry, &looks, slot, wave)
        });
        geometry.features = Features(features.0 | Features::SECONDARY);
    }
    film.into_iter().map(|record| R::load(record).0).collect()
}
