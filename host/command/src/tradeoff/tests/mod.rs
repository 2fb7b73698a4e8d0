mod chosen;
mod measured;
mod written;

use super::*;
use eyerays::method::{Layout, Method, TriangleTest};
use eyerays::quality::Bvh;
use eyerays::render::Precision;
use eyerays::scene::{Filter, Integrator, Sampler};

/// The default for four samples, eight bounces and 1/1024.
fn setting() -> Setting {
    Setting {
        precision: Precision::Exact,
        triangle: TriangleTest::Watertight,
        method: Method::Auto,
        layout: Layout::Gathered,
        bvh: Bvh::Medium,
        integrator: Integrator::Whitted,
        sampler: Sampler::Regular,
        filter: Filter::Mipmap,
        spectral: None,
        caustics: None,
        samples: 4,
        spp: 0,
        bounces: 8,
        min_contribution: 1.0 / 1024.0,
        roulette: 3,
        clamp: 0.0,
    }
}

fn record(setting: Setting, time_ms: f64, rmse: f64) -> Record {
    Record {
        setting,
        time_ms,
        spread: 0.1,
        slowest_ms: 1.1 * time_ms,
        build_ms: 3.0,
        wrong_primitives: 0.0,
        t_error_median_ulp: Some(0.3),
        t_error_max_ulp: Some(2.0),
        rmse,
        psnr_db: -20.0 * rmse.log10(),
        rmse_same_samples: Some(0.0),
        front: None,
        recommended: false,
    }
}

/// Three values of all that has an order, and all of the rest.
fn axes() -> Axes {
    Axes {
        arithmetic: vec![
            (Precision::Exact, TriangleTest::Watertight),
            (Precision::Fast, TriangleTest::Watertight),
            (Precision::Fast, TriangleTest::Moller),
        ],
        methods: vec![Method::Auto, Method::Packet, Method::Wide],
        layouts: vec![Layout::Gathered, Layout::Compact],
        bvhs: vec![Bvh::Medium, Bvh::Fast, Bvh::High],
        integrators: vec![Integrator::Whitted],
        samplers: vec![Sampler::Regular],
        filters: vec![Filter::Mipmap],
        spectral: vec![None],
        caustics: vec![None],
        samples: vec![(4, 0), (2, 0), (1, 0)],
        bounces: vec![8, 2, 0],
        min_contributions: vec![1.0 / 1024.0, 1.0 / 64.0],
        roulettes: vec![3],
        clamps: vec![0.0],
    }
}
