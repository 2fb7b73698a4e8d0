//! Embree 3.13 in its robust mode.

use embree3::{
    BufferData, BufferUsage, BuildQuality, Config, Device, Format, Geometry, GeometryBuilder, GeometryKind, Hit16,
    IntersectContext, Ray, Ray16, RayHit, RayHit16, Scene, SceneFlags, ValidMask, ValidMaskN,
};
use eyerays::stream::{Question, Stream};
use eyerays_shader::data::Primitive;

use crate::contest::{Answers, RayTracer, tasks};

const PACKET: usize = 16;

/// The scene as Embree has it.
pub struct Embree {
    scene: Scene<'static>,
}

impl Embree {
    /// Triangles, spheres and disks, each kind as Embree's own, built by so many threads.
    pub fn of(primitives: &[Primitive], quality: BuildQuality, threads: usize) -> Result<Embree, embree3::Error> {
        let device = Device::with_config(Config { threads: threads as u32, ..Config::default() })?;
        let mut scene = device.create_scene()?;
        scene.set_flags(SceneFlags::ROBUST);
        scene.set_build_quality(quality);
        let geometry = |kind| {
            let mut geometry = Geometry::new(&device, kind);
            // A scene of low quality takes each geometry's own.
            geometry.set_build_quality(quality);
            geometry
        };
        let of = |is_kind: fn(&Primitive) -> bool| -> Vec<Primitive> {
            primitives.iter().copied().filter(is_kind).collect()
        };
        let corners: Vec<[f32; 3]> =
            of(Primitive::is_triangle).iter().flat_map(Primitive::vertices).map(|p| p.to_array()).collect();
        if !corners.is_empty() {
            let indices: Vec<[u32; 3]> = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let mut mesh = geometry(GeometryKind::TRIANGLE);
            fill(&mut mesh, BufferUsage::VERTEX, Format::FLOAT3, &corners)?;
            fill(&mut mesh, BufferUsage::INDEX, Format::UINT3, &indices)?;
            scene.attach_geometry(&mesh.commit());
        }
        let round = |p: &Primitive| p.centre().extend(p.radius()).to_array();
        let spheres: Vec<[f32; 4]> = of(Primitive::is_sphere).iter().map(round).collect();
        if !spheres.is_empty() {
            let mut points = geometry(GeometryKind::SPHERE_POINT);
            fill(&mut points, BufferUsage::VERTEX, Format::FLOAT4, &spheres)?;
            scene.attach_geometry(&points.commit());
        }
        let disks = of(Primitive::is_disk);
        if !disks.is_empty() {
            let (places, normals): (Vec<[f32; 4]>, Vec<[f32; 3]>) =
                disks.iter().map(|d| (round(d), d.normal().to_array())).unzip();
            let mut points = geometry(GeometryKind::ORIENTED_DISC_POINT);
            fill(&mut points, BufferUsage::VERTEX, Format::FLOAT4, &places)?;
            fill(&mut points, BufferUsage::NORMAL, Format::FLOAT3, &normals)?;
            scene.attach_geometry(&points.commit());
        }
        scene.commit();
        Ok(Embree { scene })
    }
}

/// Copies one record a vertex or a triangle.
fn fill<T: BufferData + Copy>(
    geometry: &mut GeometryBuilder<'_>,
    usage: BufferUsage,
    format: Format,
    records: &[T],
) -> Result<(), embree3::Error> {
    geometry.set_new_buffer::<T>(usage, 0, format, size_of::<T>(), records.len())?.copy_from_slice(records);
    Ok(())
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

    fn cast(&self, pool: &rayon::ThreadPool, stream: &Stream, question: Question) -> (f64, Answers) {
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

    fn cast(&self, pool: &rayon::ThreadPool, stream: &Stream, question: Question) -> (f64, Answers) {
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
