//! Rays a second of Eyerays, Embree and obvhs: the same rays in the same run, one contestant after the other
//! in every repeat. With `--builds`, the times that building takes. Prints Markdown.

mod builds;
mod contest;
mod embree;
mod hierarchies;
mod own;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;
use contest::{RayTracer, differing, hits};
use embree3::BuildQuality;
use eyerays::job::Job;
use eyerays::method::{Method, Order, Traversal};
use eyerays::scene::{Settings};
use eyerays::scene_io;
use eyerays::view::View;
use eyerays_bvh::Quality;
use eyerays_command::bench::Kind;
use eyerays_command::bench::rays::{AO_SHARE, CameraRays, PrimaryHits, diagonal};
use eyerays_shader::data::Primitive;
use own::Own;

#[derive(Parser)]
struct Options {
    /// Scenes with their views and lights
    #[arg(required = true)]
    scenes: Vec<PathBuf>,
    /// How far ambient occlusion looks, in world units [default: 20 % of the diagonal]
    #[arg(long)]
    ao_length: Option<f64>,
    /// Threads
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Pixels along an edge
    #[arg(long, default_value_t = 512)]
    size: u32,
    /// Repeats of each measurement
    #[arg(long, default_value_t = 5)]
    repeat: usize,
    /// Effort of every hierarchy; with --builds of the only one that is timed [default: medium]
    #[arg(long)]
    quality: Option<String>,
    /// Views to follow rays from, from the first on
    #[arg(long, default_value_t = 5)]
    views: usize,
    /// Contestants whose names contain this
    #[arg(long, default_value = "")]
    only: String,
    /// Kinds of rays whose names contain this
    #[arg(long, default_value = "")]
    kind: String,
    /// Times building at every quality instead
    #[arg(long)]
    builds: bool,
}

/// Qualities by their names, and what is closest to each among Embree's.
const QUALITIES: [(&str, Quality, BuildQuality); 4] = [
    ("linear", Quality::Linear, BuildQuality::LOW),
    ("fast", Quality::Fast, BuildQuality::LOW),
    ("medium", Quality::Medium, BuildQuality::MEDIUM),
    ("high", Quality::High, BuildQuality::HIGH),
];

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    if options.builds {
        builds::heading();
        return options.scenes.iter().try_for_each(|path| builds::builds(&options, path));
    }
    println!(
        "| scene | rays | contestant | Mrays/s, median of views | least | greatest | x Embree | x obvhs CWBVH | hits | other than {} |",
        REFERENCE
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for path in &options.scenes {
        contest(&options, path)?;
    }
    Ok(())
}

/// Whose answers the others' are compared with.
const REFERENCE: &str = "Eyerays wide";

/// What a contestant reached in a view.
struct Score {
    /// Millions of rays a second.
    rate: f64,
    hits: usize,
    /// Rays whose answers are not those of [`REFERENCE`].
    others: Option<usize>,
}

/// The primitives of a scene in the order of their numbers, each once though it may be split.
fn primitives(packed: &Job) -> Vec<Primitive> {
    let mut all = packed.primitives().to_vec();
    all.sort_unstable_by_key(Primitive::number);
    all.dedup_by_key(|p| p.number());
    all
}

fn contest(options: &Options, path: &std::path::Path) -> Result<(), Box<dyn Error>> {
    let (scene, _) = scene_io::load(path)?;
    let settings = Settings { size: (options.size, options.size), samples: 1, ..scene.settings };
    let asked = options.quality.as_deref().unwrap_or("medium");
    let found = QUALITIES.iter().find(|(name, ..)| *name == asked);
    let &(_, quality, embree_quality) = found.ok_or("--quality is linear, fast, medium or high")?;
    let packed = Job::new(&scene, settings, quality)?;
    let ao_length =
        options.ao_length.map_or(AO_SHARE * diagonal(&packed), |length| length * packed.normalisation().scale) as f32;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build()?;
    let embree = embree::Embree::of(&primitives(&packed), embree_quality, options.threads)
        .map_err(|e| format!("Embree: {e:?}"))?;
    // obvhs has no other primitives.
    let triangles = packed
        .primitives()
        .iter()
        .all(Primitive::is_triangle)
        .then(|| (hierarchies::Binary::new(&packed, quality), hierarchies::Compressed::new(&packed, quality)));
    let mut names: Vec<(&'static str, bool)> = Vec::new();
    let kinds = [Kind::Primary, Kind::Shadow, Kind::Ao, Kind::Diffuse];
    let mut scores: Vec<Vec<Vec<Score>>> = Vec::new();
    for camera in scene.cameras.iter().take(options.views) {
        let rays = CameraRays::of(&packed, &View::new(&packed, camera)?, Order::Tiled);
        let own = |name, method, packet| Own { name, packed: &packed, traversal: Traversal::from(method), packet };
        let methods = [
            own("Eyerays if-if", Method::IfIf, false),
            own("Eyerays while-while", Method::WhileWhile, false),
            own("Eyerays wide", Method::Wide, false),
            own("Eyerays packet", Method::Packet, true),
        ];
        let (single, packet) = (embree::Single(&embree), embree::Packet(&embree));
        let mut all: Vec<&dyn RayTracer> = vec![&single, &packet];
        if let Some((binary, compressed)) = &triangles {
            all.extend([binary as &dyn RayTracer, compressed]);
        }
        all.extend(methods.iter().map(|m| m as &dyn RayTracer));
        all.retain(|c| c.name().contains(&options.only));
        names = all.iter().map(|c| (c.name(), c.is_packet())).collect();
        scores.resize_with(all.len(), || kinds.iter().map(|_| Vec::new()).collect());
        let sight = PrimaryHits::new(&packed, &rays, options.threads)?;
        for (k, kind) in kinds.iter().enumerate().filter(|(_, k)| k.name().contains(&options.kind)) {
            let stream = sight.rays(*kind, ao_length)?;
            let mut times = vec![Vec::new(); all.len()];
            let mut found = vec![contest::Answers::new(); all.len()];
            for repeat in 0..=options.repeat {
                for (c, contestant) in all.iter().enumerate() {
                    let (seconds, what) = contestant.cast(&pool, &stream, kind.question());
                    // The first warms caches.
                    if repeat > 0 {
                        times[c].push(seconds);
                    }
                    found[c] = what;
                }
            }
            let reference = all.iter().position(|c| c.name() == REFERENCE);
            for (c, mut times) in times.into_iter().enumerate() {
                scores[c][k].push(Score {
                    rate: stream.len() as f64 / median(&mut times) / 1e6,
                    hits: hits(&found[c]),
                    others: reference.map(|r| differing(&stream, &found[r], &found[c])),
                });
            }
        }
    }
    let scene = path.file_stem().unwrap_or_default().to_string_lossy();
    for (k, kind) in kinds.iter().enumerate() {
        let kind = kind.name();
        let rates: Vec<Vec<f64>> = scores.iter().map(|kinds| kinds[k].iter().map(|view| view.rate).collect()).collect();
        let of = |name: &str| names.iter().position(|n| n.0 == name).map(|c| &rates[c]);
        for (c, &(name, is_packet)) in names.iter().enumerate().filter(|(c, _)| !rates[*c].is_empty()) {
            let peer = of(if is_packet { "Embree rtcIntersect16" } else { "Embree rtcIntersect1" });
            let (embree, obvhs) = (ratio(&rates[c], peer), ratio(&rates[c], of("obvhs CWBVH")));
            let least = rates[c].iter().copied().fold(f64::MAX, f64::min);
            let most = rates[c].iter().copied().fold(0.0, f64::max);
            let middle = median(&mut rates[c].clone());
            let hits: usize = scores[c][k].iter().map(|view| view.hits).sum();
            let others: Option<usize> = scores[c][k].iter().map(|view| view.others).sum();
            let others = others.map_or(String::new(), |n| n.to_string());
            println!(
                "| {scene} | {kind} | {name} | {middle:.2} | {least:.2} | {most:.2} | {embree} | {obvhs} | {hits} | {others} |"
            );
        }
    }
    Ok(())
}

/// The median over views of how much faster one is.
fn ratio(rates: &[f64], peer: Option<&Vec<f64>>) -> String {
    peer.map_or("".to_owned(), |peer| {
        let mut ratios: Vec<f64> = rates.iter().zip(peer).map(|(a, b)| a / b).collect();
        format!("{:.2}", median(&mut ratios))
    })
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}
