//! From a scene's primitives to what rays are followed in: Eyerays and Embree in turns, with the same threads.

use std::error::Error;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use eyerays::job::Job;
use eyerays::scene_io;

use crate::embree::Embree;
use crate::{Options, QUALITIES, median, primitives};

/// What the columns of [`builds`] say.
pub fn heading() {
    println!("| scene | primitives | threads | quality | Eyerays, ms | Embree, ms | x Embree |");
    println!("|---|---|---|---|---|---|---|");
}

/// Times both at every quality. Eyerays' time holds splitting, checks, packing and the nodes that a CPU walks; Embree's the
/// copy of the primitives.
pub fn builds(options: &Options, path: &Path) -> Result<(), Box<dyn Error>> {
    let (scene, _) = scene_io::load(path)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build()?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let is_asked = |quality: &str| options.quality.as_deref().is_none_or(|asked| asked == quality);
    for (quality, own, embree) in QUALITIES.into_iter().filter(|(quality, ..)| is_asked(quality)) {
        let (mut times, mut peers, mut count) = (Vec::new(), Vec::new(), 0);
        // The first warms caches.
        for repeat in 0..=options.repeat {
            let start = Instant::now();
            let packed = pool.install(|| -> eyerays::error::Result<Job> {
                let packed = Job::new(&scene, scene.settings, own)?;
                black_box(packed.bvh8());
                Ok(packed)
            })?;
            let time = start.elapsed();
            let primitives = primitives(&packed);
            drop(packed);
            let start = Instant::now();
            black_box(Embree::of(&primitives, embree, options.threads).map_err(|e| format!("Embree: {e:?}"))?);
            let peer = start.elapsed();
            count = primitives.len();
            if repeat > 0 {
                times.push(time.as_secs_f64() * 1e3);
                peers.push(peer.as_secs_f64() * 1e3);
            }
        }
        let (time, peer) = (median(&mut times), median(&mut peers));
        println!("| {name} | {count} | {} | {quality} | {time:.0} | {peer:.0} | {:.2} |", options.threads, time / peer);
    }
    Ok(())
}
