//! A picture over any numbers: the stages in their order, by the simplest method, on one thread; no executor's loop.

use eyerays::device_scene::SceneView;
use eyerays::integrator::whitted;
use eyerays::method::Traversal;
use eyerays_shader::camera;
use eyerays_shader::data::Launch;
use eyerays_shader::integrator::{self, Wave};
use eyerays_shader::real::{Scalar, V3};
use eyerays_shader::scene::ShadingData;
use eyerays_shader::stage::{self, RECORDS, ShadowInputs};
use eyerays_shader::traverse::{IfIf, Primitives};

use crate::Posed;

/// The film of one sample a pixel, row-major from the top left.
pub fn picture<R: Scalar>(posed: &Posed) -> Vec<V3<R>> {
    let (scene, region) = (SceneView::new(posed, Traversal::default()), posed.view.region());
    let spec = scene.specialisation();
    let frame = posed.view.launch(posed, region, 0, 1, spec.order);
    let looks = ShadingData { normals: posed.normals(), materials: posed.materials(), lights: posed.lights() };
    let (slots, black) = (frame.slots as usize, R::store(V3::zero(), 0));
    let mut paths = vec![black; slots * (whitted(posed).paths * RECORDS) as usize];
    let (mut hits, mut shadows) = (vec![black; slots], vec![0; slots * posed.lights().len()]);
    let (mut sums, mut film) = (vec![black; slots], vec![V3::zero(); region.pixels() as usize]);
    let pixel = |slot: u32| camera::pixel(&frame, spec.order, slot);
    let mut queue: Vec<u32> = (0..frame.slots).filter(|&slot| pixel(slot).inside).collect();
    let mut context = scene.context(&frame, spec);
    while !queue.is_empty() {
        for &slot in &queue {
            hits[slot as usize] = stage::trace::<R, IfIf, Primitives>(&context, slot, &paths);
            for light in 0..frame.lights {
                let inputs = ShadowInputs { lights: looks.lights, paths: &paths, hits: &hits };
                let answer = stage::shadow::<R, IfIf, Primitives>(&context, inputs, slot, light);
                shadows[light as usize * slots + slot as usize] = answer;
            }
        }
        queue.retain(|&slot| {
            let wave = Wave::<R> { paths: &mut paths, hits: &hits, shadows: &shadows, sums: &mut sums };
            integrator::shade(&context.base, &looks, slot, wave)
        });
        context.base.spec = spec.with_launch(Launch::SECONDARY);
    }
    for slot in (0..frame.slots).filter(|&slot| pixel(slot).inside) {
        film[pixel(slot).index as usize] = R::load(sums[slot as usize]).0;
    }
    film
}
