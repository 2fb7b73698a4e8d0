//! Embree 3.13 in its robust mode.

use embree3::{
    BufferUsage, BuildQuality, Device, Format, Geometry, GeometryKind, Hit16, IntersectContext, Ray, Ray16, RayHit,
    RayHit16, Scene, SceneFlags, ValidMask, ValidMaskN,
};
use eyerays::device_scene::DeviceScene;
use eyerays::stream::{Question, Stream};
use eyerays_shader::data::numbers;

use crate::contest::{Found, RayTracer, tasks};

const PACKET: usize = 16;

/// The scene as Embree has it.
pub struct Embree {
    scene: Scene<'static>,
}

impl Embree {
    /// Triangles in the order of their primitives.
    pub fn new(packed: &DeviceScene, quality: BuildQuality) -> Result<Embree, embree3::Error> {
        let device = Device::new()?;
        let mut triangles: Vec<_> = packed.primitives().iter().collect();
        triangles.sort_unstable_by_key(|t| t.number());
        triangles.dedup_by_key(|t| t.number());
        let corners = triangles.iter().flat_map(|t| [t.a, t.b, t.c]).map(|p| numbers(p).to_array());
        let corners: Vec<[f32; 3]> = corners.collect();
        let indices: Vec<[u32; 3]> = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let mut mesh = Geometry::new(&device, GeometryKind::TRIANGLE);
        mesh.set_new_buffer::<[f32; 3]>(BufferUsage::VERTEX, 0, Format::FLOAT3, 12, corners.len())?
            .copy_from_slice(&corners);
        mesh.set_new_buffer::<[u32; 3]>(BufferUsage::INDEX, 0, Format::UINT3, 12, indices.len())?
            .copy_from_slice(&indices);
        let mut scene = device.create_scene()?;
        scene.set_flags(SceneFlags::ROBUST);
        scene.set_build_quality(quality);
        scene.attach_geometry(&mesh.commit());
        scene.commit();
        Ok(Embree { scene })
    }
}

/// One ray at a time.
pub struct Single<'a>(pub &'a Embree);

/// Sixteen neighbours at a time, with the coherent flag.
pub struct Packet<'a>(pub &'a Embree);

fn ray(stream: &Stream, i: usize) -> Ray {
    let r = stream.ray(i);
    Ray::segment(r.origin.to_array(), r.direction.to_array(), 0.0, r.limit)
}

impl RayTracer for Single<'_> {
    fn name(&self) -> &'static str {
        "Embree rtcIntersect1"
    }

    fn cast(&self, pool: &rayon::ThreadPool, stream: &Stream, question: Question) -> (f64, Found) {
        let scene = &self.0.scene;
        tasks(pool, stream, |first, answers| {
            let mut context = IntersectContext::incoherent();
            for (i, answer) in answers.iter_mut().enumerate() {
                let mut ray = ray(stream, first + i);
                *answer = match question {
                    Question::Closest => {
                        let mut hit = RayHit::from_ray(ray);
                        scene.intersect(&mut context, &mut hit);
                        if hit.hit.is_valid() { hit.ray.tfar } else { -1.0 }
                    }
                    Question::Occlusion => {
                        if scene.occluded(&mut context, &mut ray) {
                            0.0
                        } else {
                            -1.0
                        }
                    }
                };
            }
        })
    }
}

/// Sixteen rays from `first` on; a lane without one is no valid one.
fn packet(stream: &Stream, first: usize, count: usize) -> (Ray16, ValidMaskN<PACKET>) {
    let mut packet = Ray16::empty();
    let mut valid = [ValidMask::Invalid; PACKET];
    for (lane, valid) in valid.iter_mut().enumerate().take(count) {
        let r = stream.ray(first + lane);
        (packet.org_x[lane], packet.org_y[lane], packet.org_z[lane]) = r.origin.into();
        (packet.dir_x[lane], packet.dir_y[lane], packet.dir_z[lane]) = r.direction.into();
        packet.tnear[lane] = 0.0;
        packet.tfar[lane] = r.limit;
        packet.mask[lane] = u32::MAX;
        *valid = ValidMask::Valid;
    }
    (packet, ValidMaskN::new(valid))
}

impl RayTracer for Packet<'_> {
    fn name(&self) -> &'static str {
        "Embree rtcIntersect16"
    }

    fn is_packet(&self) -> bool {
        true
    }

    fn cast(&self, pool: &rayon::ThreadPool, stream: &Stream, question: Question) -> (f64, Found) {
        let scene = &self.0.scene;
        tasks(pool, stream, |first, answers| {
            let mut context = IntersectContext::coherent();
            for (chunk, answers) in answers.chunks_mut(PACKET).enumerate() {
                let (mut rays, valid) = packet(stream, first + chunk * PACKET, answers.len());
                match question {
                    Question::Closest => {
                        let mut hits = RayHit16 { ray: rays, hit: Hit16::new() };
                        scene.intersect16(&mut context, &mut hits, &valid);
                        for (lane, answer) in answers.iter_mut().enumerate() {
                            let missed = hits.hit.geomID[lane] == embree3::INVALID_ID;
                            *answer = if missed { -1.0 } else { hits.ray.tfar[lane] };
                        }
                    }
                    Question::Occlusion => {
                        scene.occluded16(&mut context, &mut rays, &valid);
                        for (lane, answer) in answers.iter_mut().enumerate() {
                            *answer = if rays.tfar[lane] < 0.0 { 0.0 } else { -1.0 };
                        }
                    }
                }
            }
        })
    }
}
