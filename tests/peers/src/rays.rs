//! The rays that all contestants follow.

use eyerays::cpu;
use eyerays::method::{Method, Traversal};
use eyerays::pack::{Packed, Region};
use eyerays::stream::{Answers, Question, Stream, StreamRay};
use eyerays_shader::camera;
use eyerays_shader::data::{Triangle, numbers};
use eyerays_shader::real::V3;
use eyerays_shader::shade::Contact;
use glam::Vec3;

/// Rays of one kind.
pub struct Kind {
    pub name: &'static str,
    pub question: Question,
    pub stream: Stream,
    /// Are neighbours alike?
    pub coherent: bool,
}

/// Primary rays of a view, and shadow, ambient occlusion and diffuse rays from what they hit.
pub fn kinds(packed: &Packed, light: Vec3, reach: f32) -> Vec<Kind> {
    let primary = primary(packed);
    let stream = Stream::new(primary.iter().copied());
    let traversal = Traversal::from(Method::IfIf);
    let (answers, _) = cpu::cast(packed, traversal, 0, &stream, Question::Closest).expect("threads");
    let Answers::Closest(hits) = answers else { unreachable!("closest hits were asked for") };
    let mut seed = 1u32;
    let (mut shadow, mut ao, mut diffuse) = (Vec::new(), Vec::new(), Vec::new());
    for (ray, hit) in primary.iter().zip(&hits) {
        if hit.w == StreamRay::NOWHERE {
            continue;
        }
        let triangle = &packed.triangles[hit.w as usize];
        let contact = Contact::<f32>::new(triangle, f32::from_bits(hit.y), f32::from_bits(hit.z), v3(ray.direction));
        let towards = light - vec3(contact.position);
        shadow.push(leaving(&contact, triangle, towards, 1.0));
        for _ in 0..4 {
            ao.push(leaving(&contact, triangle, cosine(&contact, &mut seed), reach));
        }
        diffuse.push(leaving(&contact, triangle, cosine(&contact, &mut seed), f32::MAX));
    }
    let kind = |name, question, rays: Vec<StreamRay>, coherent| Kind {
        name,
        question,
        stream: Stream::new(rays.into_iter()),
        coherent,
    };
    vec![
        kind("primary", Question::Closest, primary, true),
        kind("shadow", Question::Occlusion, shadow, true),
        kind("ao", Question::Occlusion, ao, false),
        kind("diffuse", Question::Closest, diffuse, false),
    ]
}

fn primary(packed: &Packed) -> Vec<StreamRay> {
    let (width, height) = packed.settings.size;
    let frame = packed.frame(Region { x: 0, y: 0, width, height }, 0, packed.features);
    let slots = camera::slots(width, height, packed.features);
    let pixels = (0..slots).map(|slot| camera::pixel(&frame, packed.features, slot)).filter(|p| p.inside);
    pixels
        .map(|pixel| {
            let (origin, direction) = camera::ray::<f32>(&frame, pixel);
            let (origin, direction) = (vec3(origin), vec3(direction));
            StreamRay { origin, direction, limit: f32::MAX, leaves: StreamRay::NOWHERE }
        })
        .collect()
}

fn leaving(contact: &Contact<f32>, triangle: &Triangle, direction: Vec3, limit: f32) -> StreamRay {
    let origin = vec3(contact.leave(v3(direction)));
    StreamRay { origin, direction, limit, leaves: triangle.primitive() }
}

/// A direction by the cosine law around the contact's normal.
fn cosine(contact: &Contact<f32>, seed: &mut u32) -> Vec3 {
    let mut random = || {
        *seed = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((*seed >> ((*seed >> 28) + 4)) ^ *seed).wrapping_mul(277_803_737);
        ((word >> 22) ^ word) as f32 / 4_294_967_296.0
    };
    let (r2, phi) = (random(), std::f32::consts::TAU * random());
    let normal = vec3(contact.normal);
    let side = normal.any_orthonormal_vector();
    let other = normal.cross(side);
    let r = r2.sqrt();
    (side * (r * phi.cos()) + other * (r * phi.sin()) + normal * (1.0 - r2).max(0.0).sqrt()).normalize()
}

/// The scene's diagonal in the normalised scene.
pub fn diagonal(packed: &Packed) -> f32 {
    let corners = packed.triangles.iter().flat_map(|t| [t.a, t.b, t.c]).map(numbers);
    let (least, greatest) = corners.fold((Vec3::MAX, Vec3::MIN), |(a, b), p| (a.min(p), b.max(p)));
    (greatest - least).length()
}

fn v3(v: Vec3) -> V3<f32> {
    V3::new(v.x, v.y, v.z)
}

fn vec3(v: V3<f32>) -> Vec3 {
    Vec3::new(v.x, v.y, v.z)
}
