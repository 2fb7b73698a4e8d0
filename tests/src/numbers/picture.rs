//! A picture over any numbers: the stages in their order, by the simplest method, on one thread; no executor's loop.

use eyerays::device_scene::SceneView;
use eyerays::integrator::needs;
use eyerays::method::Traversal;
use eyerays_shader::camera;
use eyerays_shader::data::Launch;
use eyerays_shader::integrator::{self, Exchange, Wave};
use eyerays_shader::photon::Photons;
use eyerays_shader::real::{Scalar, V3};
use eyerays_shader::stage::{self, CameraTables, RECORDS, ShadowInputs, shadow_records, state_records};
use eyerays_shader::traverse::{IfIf, Primitives};

use crate::Posed;

/// The picture of one sample a pixel, row-major from the top left.
pub fn picture<R: Scalar>(posed: &Posed) -> Vec<V3<R>> {
    if posed.settings().transport.integrator.samples() { sampled(posed) } else { whitted(posed) }
}

fn whitted<R: Scalar>(posed: &Posed) -> Vec<V3<R>> {
    let (scene, region) = (SceneView::new(posed, Traversal::default()), posed.view.region());
    let spec = scene.specialisation();
    let frame = posed.view.launch(posed, region, 0, 1, spec.order);
    let (slots, black) = (frame.slots as usize, R::store(V3::zero(), 0));
    let mut paths = vec![black; slots * (needs(posed).paths * RECORDS) as usize];
    let (mut hits, mut shadows) = (vec![black; slots], vec![0; slots * posed.lights().len()]);
    let (mut sums, mut picture) = (vec![black; slots], vec![V3::zero(); region.pixels() as usize]);
    let pixel = |slot: u32| camera::pixel(&frame, spec.order, slot);
    let mut queue: Vec<u32> = (0..frame.slots).filter(|&slot| pixel(slot).inside).collect();
    let mut context = scene.context(&frame, spec);
    while !queue.is_empty() {
        for &slot in &queue {
            stage::trace::<R, IfIf, Primitives>(&context, (slot, 0.0), &paths).store(&context.base, slot, &mut hits);
            for light in 0..frame.lights {
                let inputs = ShadowInputs { lights: posed.lights(), paths: &paths, hits: &hits };
                let answer = stage::shadow::<R, IfIf, Primitives>(&context, inputs, slot, light);
                shadows[light as usize * slots + slot as usize] = answer;
            }
        }
        queue.retain(|&slot| {
            let lights = posed.lights();
            let (environment, sums) = (posed.environment(), &mut sums);
            let wave = Wave::<R> { paths: &mut paths, hits: &hits, shadows: &shadows, lights, environment, sums };
            integrator::shade(&context.base, &scene.shading(), slot, wave)
        });
        context.base.spec = spec.with_launch(Launch::SECONDARY);
    }
    for slot in (0..frame.slots).filter(|&slot| pixel(slot).inside) {
        picture[pixel(slot).index as usize] = R::load(sums[slot as usize]).0;
    }
    picture
}

fn sampled<R: Scalar>(posed: &Posed) -> Vec<V3<R>> {
    let (scene, region) = (SceneView::new(posed, Traversal::default()), posed.view.region());
    let mut spec = scene.specialisation();
    let frame = posed.view.launch(posed, region, 0, 1, spec.order);
    let (slots, pixels, black) = (frame.slots as usize, region.pixels() as usize, R::store(V3::zero(), 0));
    let mut paths = vec![black; slots * state_records(spec.media) as usize];
    let mut segments = vec![black; slots * shadow_records(spec.media) as usize];
    let (mut hits, mut shadows, mut sums) = (vec![black; slots], vec![0; slots], vec![black; slots]);
    let order = spec.order;
    let inside = |slot: &u32| camera::pixel(&frame, order, *slot).inside;
    let mut queue: Vec<u32> = (0..frame.slots).filter(inside).collect();
    let tables = CameraTables { cells: &[], optics: posed.optic_tables(), instances: &[] };
    queue.iter().for_each(|&slot| stage::generate::<R>(&frame, spec, tables, slot, (&mut paths, &mut [])));
    while !queue.is_empty() {
        let streams = scene.context(&frame, spec.with_launch(Launch::STREAM));
        for &slot in &queue {
            stage::trace::<R, IfIf, Primitives>(&streams, (slot, 0.0), &paths).store(&streams.base, slot, &mut hits);
        }
        let (base, wave) = (scene.context(&frame, spec).base, queue.clone());
        queue.retain(|&slot| {
            let (paths, segments, sums) = (&mut paths, &mut segments, &mut sums);
            let starts = !spec.launch.has(Launch::SECONDARY);
            // Of scenes without caustics.
            let (photons, landed) = (Photons { records: &[], heads: &[] }, &mut []);
            let exchange =
                Exchange::<R> { paths, hits: &hits, shadows: &shadows, segments, sums, starts, photons, landed };
            integrator::scatter::<R>(&base, &scene.scattering(), slot, exchange)
        });
        for slot in wave {
            let inputs = ShadowInputs { lights: &[], paths: &segments, hits: &hits };
            shadows[slot as usize] = stage::shadow::<R, IfIf, Primitives>(&streams, inputs, slot, 0);
        }
        spec = spec.with_launch(Launch::SECONDARY);
    }
    let mut picture = vec![V3::zero(); pixels];
    for slot in (0..frame.pixel_slots).filter(inside) {
        let index = camera::pixel(&frame, order, slot).index as usize;
        picture[index] = stage::sampled::<R>(&frame, spec.launch, slot, (&sums, &shadows, &segments)).light;
    }
    picture
}
