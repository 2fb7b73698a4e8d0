//! Rays of one's own through a scene, all at once: how far it is to the next surface in every direction.

use std::error::Error;
use std::path::Path;

use eyerays::batch::{Batch, Ray};
use eyerays::cpu;
use eyerays::gpu::{AdapterRequest, Caster, Gpu};
use eyerays::job::Job;
use eyerays::method::{Layout, Method};
use eyerays::quality::Bvh;
use eyerays::scene_io;
use eyerays::stream::Question;
use glam::DVec3;

fn main() -> Result<(), Box<dyn Error>> {
    let (scene, _) = scene_io::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/cornell.toml"))?;
    let packed = Job::new(&scene, scene.settings, Bvh::Medium.quality())?;

    // From the middle of the room through the cells of a cube around it.
    let (edge, middle) = (22, DVec3::new(0.0, 1.0, 0.0));
    let cell = |i: u32| DVec3::new((i % edge).into(), (i / edge % edge).into(), (i / edge / edge).into());
    let ray = |i: u32| Ray::new(middle, cell(i) - DVec3::splat(f64::from(edge - 1) / 2.0));
    let count = edge * edge * edge;
    let rays: Vec<Ray> = (0..count).map(ray).collect();
    let batch = Batch::new(&packed, &rays);

    let (answers, _) = cpu::cast(&packed, Method::Wide.into(), 0, batch.stream(), Question::Closest)?;
    let hits = batch.hits(&packed, &answers);
    let distances: Vec<f64> = hits.iter().flatten().map(|hit| hit.t).collect();
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    println!("{} of {count} rays meet a surface, {mean:.3} away on average", distances.len());

    if let Ok(gpu) = Gpu::open(&AdapterRequest { software: true, exact: true, ..AdapterRequest::default() }) {
        let caster = Caster::new(&gpu, &packed, Layout::Gathered)?;
        let cast = caster.upload(batch.stream())?;
        caster.trace(&cast, true, Method::IfIf.into(), Question::Closest)?;
        let same = batch.hits(&packed, &caster.answers(&cast, Question::Closest)?) == hits;
        println!("{}: {}", gpu.report.name, if same { "the same hits" } else { "other hits" });
    }
    Ok(())
}
