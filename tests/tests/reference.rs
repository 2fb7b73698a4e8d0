//! Exact precision against the reference in double precision: where they are apart, a ray took another way.

use std::sync::Mutex;

use eyerays::cpu::{self, Observer, Records};
use eyerays::job::Job;
use eyerays::method::Traversal;
use eyerays::picture::Picture;
use eyerays_shader::camera;
use eyerays_shader::data::{Effects, Light};
use eyerays_shader::geometry::SurfaceInteraction;
use eyerays_shader::light::LightSample;
use eyerays_shader::material::{Seen, Surface, refract};
use eyerays_shader::ray::Hit;
use eyerays_shader::real::Scalar;
use eyerays_shader::scene::{ShadingData, TraceContext};
use eyerays_shader::stage::{Found, Path, REACHED};
use eyerays_shader::texture::{Cone, Covering};
use eyerays_tests::{Posed, differences, pack, shipped};

/// The largest difference of a channel that rounding explains.
const NEAR: f32 = 1e-4;
/// Where a ray leaves glass with a cosine outside below this, it is so near the critical angle that the share which
/// passes goes with the root of what cancellation left: single precision's last bit becomes 1e-4 in a few bounces.
const CRITICAL: f32 = 1.0 / 32.0;

/// What the rays of a pixel did.
#[derive(Clone, Default)]
struct Story {
    /// Primitives, shadow answers and branches in their order, as words that do not depend on the arithmetic.
    events: Vec<u32>,
    /// Did one leave glass near the critical angle?
    critical: bool,
}

/// Writes the stories of a picture.
struct Log<'a> {
    packed: &'a Job,
    stories: Mutex<Vec<Story>>,
}

impl<R: cpu::Number> Observer<R> for Log<'_> {
    fn wave(&self, geometry: &TraceContext<'_>, slots: &[u32], records: &Records<R>) {
        let mut stories = self.stories.lock().unwrap();
        let frame = geometry.base.frame;
        for &slot in slots {
            let pixel = camera::pixel(frame, geometry.base.spec.order, slot);
            let at = (frame.top + pixel.y) * frame.width + frame.left + pixel.x;
            self.tell(geometry, slot, records, &mut stories[at as usize]);
        }
    }
}

impl Log<'_> {
    /// What became of a slot's ray: its place in the tree, what it hit, and every branch that shading takes there.
    fn tell<R: Scalar>(&self, geometry: &TraceContext<'_>, slot: u32, records: &Records<R>, story: &mut Story) {
        let path = Path::<R>::current(&geometry.base, slot, &records.paths);
        story.events.extend([path.bounces, path.pending]);
        let Found { index, instance, coordinates, time, .. } = Found::<R>::load(&geometry.base, slot, &records.hits);
        if index == Hit::<R>::NOTHING {
            return story.events.push(index);
        }
        let packed = self.packed;
        let looks = ShadingData { normals: packed.normals(), materials: packed.materials(), ..ShadingData::default() };
        let triangle = &geometry.primitive(index);
        let contact = SurfaceInteraction::new(geometry.base.spec.effects, triangle, coordinates, path.direction);
        let direction = path.direction;
        let narrow = Cone::none();
        let seen = Seen { index, instance, time, primitive: *triangle, interaction: contact, direction, cone: narrow };
        let surface = Surface::new(&geometry.base, &looks, &seen, &Covering::none());
        // The diffuse colour tells the checker's cell.
        let cell = [surface.diffuse.x, surface.diffuse.y, surface.diffuse.z].map(|channel| channel.to_f32().to_bits());
        story.events.extend([triangle.number(), u32::from(contact.front)]);
        story.events.extend(cell);
        for (light, index) in packed.lights().iter().zip(0..) {
            let answer = records.shadows[(index * geometry.base.frame.slots + slot) as usize];
            story.events.push(answer);
            if answer == REACHED {
                story.events.push(cone(geometry.base.spec.effects, light, &contact));
            }
        }
        if !surface.ior.eq(R::splat(0.0)) {
            let eta = contact.relative_ior(surface.ior);
            let at = refract(path.direction, surface.normal, eta);
            story.events.push(u32::from(at.total));
            story.critical |= !at.total && at.cos_out.to_f32() < CRITICAL;
        }
    }
}

/// The part of a spot's cone that a place is in: full light, the rim or none.
fn cone<R: Scalar>(effects: Effects, light: &Light, contact: &SurfaceInteraction<R>) -> u32 {
    let colour = LightSample::new(effects, light, contact.position).colour;
    let all = f32::from_bits(light.colour.x);
    match colour.x.to_f32() {
        0.0 => 0,
        some if some == all => 2,
        _ => 1,
    }
}

fn render<R: cpu::Number>(packed: &Posed) -> (Picture, Vec<Story>) {
    let (width, height) = packed.view.size();
    let log = Log { packed, stories: Mutex::new(vec![Story::default(); (width * height) as usize]) };
    let renderer = cpu::Renderer::new(packed, Traversal::default(), 0).unwrap();
    let (picture, rays) = renderer.render::<R>(&packed.view, &|_| (), &log).unwrap();
    assert_eq!(rays.non_finite, 0);
    (picture, log.stories.into_inner().unwrap())
}

/// For every camera: at least 99.9 % of the pixels are near the reference, and in each of the others a ray hit
/// another triangle, had another shadow answer, took another branch, or left glass near the critical angle.
fn assert_explained(name: &str) {
    let scene = shipped(name);
    for camera in &scene.cameras {
        let packed = pack(&scene, camera, scene.settings);
        let ((exact, stories), (reference, truths)) = (render::<f32>(&packed), render::<f64>(&packed));
        let differences = differences(&exact, &reference);
        let far: Vec<usize> = (0..differences.len()).filter(|&pixel| differences[pixel] > NEAR).collect();
        let what = format!("{name}, camera {}: {} of {} pixels differ", camera.name, far.len(), differences.len());
        eprintln!("{what}");
        assert!(far.len() * 1000 <= differences.len(), "{what}");
        for pixel in far {
            let (story, truth) = (&stories[pixel], &truths[pixel]);
            let place = (pixel % scene.settings.size.0 as usize, pixel / scene.settings.size.0 as usize);
            assert!(
                story.events != truth.events || story.critical || truth.critical,
                "{what}; {place:?} by {} for no reason, with events {:?}",
                differences[pixel],
                story.events
            );
        }
    }
}

#[test]
fn lights() {
    assert_explained("lights");
}

#[test]
fn cornell() {
    assert_explained("cornell");
}

#[test]
fn whitted() {
    assert_explained("whitted");
}

#[test]
fn glass() {
    assert_explained("glass");
}
