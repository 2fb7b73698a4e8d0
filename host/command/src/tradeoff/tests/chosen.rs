//! Fronts, recommendations and what is tried, over records that were made up.

use std::cell::RefCell;

use proptest::prelude::*;

use super::*;
use crate::error::Error;
use eyerays::scene::{Filter, Integrator, Map, Material, Placement, Sampler, Settings, Texels, Texture, Transport};

/// Is it beaten?
fn is_beaten(point: (f64, f64), all: &[(f64, f64)]) -> bool {
    all.iter().any(|&(time, error)| time <= point.0 && error <= point.1 && (time, error) != point)
}

/// Few values, so that times and errors are often equal.
fn points() -> impl Strategy<Value = Vec<(f64, f64)>> {
    let time = prop_oneof![(1u32..6).prop_map(f64::from), 0.1..1e4];
    let error = prop_oneof![(0u32..6).prop_map(f64::from), 0.0..1.0, Just(f64::INFINITY)];
    proptest::collection::vec((time, error), 0..40)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

    #[test]
    fn nothing_beats_a_member_of_the_front_and_something_is_as_good_as_any_other(points in points()) {
        let members = front(&points);
        for (i, &point) in points.iter().enumerate() {
            if members.contains(&i) {
                prop_assert!(!is_beaten(point, &points), "{point:?}");
            } else {
                let is_covered = members.iter().any(|&m| points[m].0 <= point.0 && points[m].1 <= point.1);
                prop_assert!(is_covered, "{point:?}");
            }
        }
        let order = members.windows(2).map(|pair| (points[pair[0]], points[pair[1]]));
        for (first, second) in order {
            prop_assert!(first.0 < second.0 && first.1 > second.1);
        }
    }

    #[test]
    fn what_is_recommended_serves_the_wish_and_nothing_that_serves_it_is_better(
        points in points(), bound in prop_oneof![0.0..1.0, 0.0..1e4]
    ) {
        let records: Vec<Record> = points.iter().map(|&(time, error)| record(setting(), time, error)).collect();
        let serving = |wish| -> Vec<&Record> {
            records.iter().filter(|r| match wish {
                Wish::MaxError(most) => r.rmse <= most,
                Wish::Budget(most) => r.slowest_ms <= most,
            }).collect()
        };
        for wish in [Wish::MaxError(bound), Wish::Budget(bound)] {
            let best = recommended(&records, wish).map(|i| &records[i]);
            prop_assert_eq!(best.is_none(), serving(wish).is_empty());
            let Some(best) = best else { continue };
            prop_assert!(serving(wish).contains(&best));
            for other in serving(wish) {
                let is_better = match wish {
                    Wish::MaxError(_) => (other.time_ms, other.rmse) < (best.time_ms, best.rmse),
                    Wish::Budget(_) => (other.rmse, other.time_ms) < (best.rmse, best.time_ms),
                };
                prop_assert!(!is_better, "{other:?}");
            }
        }
    }

    /// Times and errors that each axis shares in as it likes: whatever they are, nothing is tried twice or is
    /// no value of the axes, the base is first, and no step from the front is left.
    #[test]
    fn a_search_ends_where_no_step_on_an_axis_improves_the_front(seed in proptest::array::uniform8(0.1f64..3.0)) {
        let (time, error) = model(seed);
        let measure = |s: &Setting| Record { slowest_ms: time(s), ..record(*s, time(s), error(s)) };
        let (records, stopped) = search(&axes(), setting(), 10_000, &mut |s| Ok(Some(measure(s)))).unwrap();
        prop_assert!(!stopped);
        prop_assert_eq!(records[0].setting, setting());
        for (i, one) in records.iter().enumerate() {
            prop_assert!(records[..i].iter().all(|other| other.setting != one.setting));
            let on = |axis| axes().along(axis, one.setting).contains(&one.setting);
            prop_assert!(Axis::ALL.into_iter().all(on));
        }
        let all: Vec<_> = records.iter().map(|r| (r.time_ms, r.rmse)).collect();
        for i in front(&all) {
            for axis in Axis::trading() {
                let line = axes().along(axis, records[i].setting);
                let here = line.iter().position(|s| *s == records[i].setting).unwrap();
                for near in [here.checked_sub(1), Some(here + 1)].into_iter().flatten().filter_map(|n| line.get(n)) {
                    let near = measure(near);
                    let is_new = !is_covered((near.time_ms, near.rmse), &all);
                    prop_assert!(!is_new, "{near:?}");
                }
            }
        }
    }
}

fn is_covered(point: (f64, f64), all: &[(f64, f64)]) -> bool {
    all.iter().any(|&(time, error)| time <= point.0 && error <= point.1)
}

/// A time that is a product of what the axes contribute, and an error that is a sum of it.
fn model(w: [f64; 8]) -> (impl Fn(&Setting) -> f64, impl Fn(&Setting) -> f64) {
    let time = move |s: &Setting| {
        let fast = if s.precision == Precision::Fast { w[0].min(0.95) } else { 1.0 };
        let moller = if s.triangle == TriangleTest::Moller { w[1].min(0.97) } else { 1.0 };
        let free = [w[2], w[3], w[4]][s.bvh as usize] * if s.layout == Layout::Compact { w[5] } else { 1.0 };
        let method = if s.method == Method::Wide { w[6] } else { 1.0 };
        let rays =
            f64::from(s.samples * s.samples) * (1.0 + f64::from(s.bounces) * (1.0 - f64::from(s.min_contribution)));
        fast * moller * free * method * rays
    };
    let error = move |s: &Setting| {
        let fast = if s.precision == Precision::Fast { 1e-6 } else { 0.0 };
        let moller = if s.triangle == TriangleTest::Moller { 1e-4 * w[7] } else { 0.0 };
        let left_out = 0.1 / f64::from(1 + s.bounces) + f64::from(s.min_contribution);
        fast + moller + left_out + 1.0 / f64::from(s.samples)
    };
    (time, error)
}

#[test]
fn a_search_changes_one_thing_at_a_time_and_then_takes_the_fastest_of_what_is_free() {
    let (time, error) = model([0.5, 0.5, 1.0, 2.0, 0.8, 0.7, 0.9, 1.0]);
    let tried = RefCell::new(Vec::new());
    search(&axes(), setting(), 10_000, &mut |s| {
        tried.borrow_mut().push(*s);
        Ok(Some(record(*s, time(s), error(s))))
    })
    .unwrap();
    let tried = tried.into_inner();
    let differing = |s: &Setting| Axis::ALL.into_iter().filter(|axis| axis.taken(setting(), s) != setting()).count();
    let single = 2 + 2 + 1 + 2 + 2 + 2 + 1;
    assert!(tried[0] == setting() && tried[1..=single].iter().all(|s| differing(s) == 1));
    assert!(tried.len() > single + 5);
    for combined in &tried[single + 1..] {
        assert_eq!((combined.method, combined.layout, combined.bvh), (Method::Wide, Layout::Compact, Bvh::High));
    }
}

/// Repetitions that overlap prove nothing.
#[test]
fn what_is_not_clearly_faster_is_not_taken() {
    let time =
        |s: &Setting| if s.method == Method::Wide { 95.0 } else { 100.0 } / if s.samples == 4 { 1.0 } else { 4.0 };
    let measure = |s: &Setting| record(*s, time(s), 1.0 / f64::from(s.samples));
    let (records, _) = search(&axes(), setting(), 10_000, &mut |s| Ok(Some(measure(s)))).unwrap();
    let combined = |r: &&Record| r.setting.samples < 4 && r.setting.precision == Precision::Fast;
    assert!(records.iter().any(|r| combined(&r)));
    assert!(records.iter().filter(combined).all(|r| r.setting.method == Method::Auto));
}

#[test]
fn a_search_stops_after_so_many_trials_and_goes_on_past_what_is_left_out() {
    let some = |s: &Setting| Ok((s.method != Method::Packet).then(|| record(*s, 1.0, 1.0)));
    let (records, stopped) = search(&axes(), setting(), 5, &mut { some }).unwrap();
    assert!(stopped && records.len() == 4, "the third method is the fifth of them, the second left out");
    let (records, stopped) = search(&axes(), setting(), 10_000, &mut { some }).unwrap();
    assert!(!stopped && records.iter().all(|r| r.setting.method != Method::Packet));
    let fails = |_: &Setting| Err(Error::new("the device was lost"));
    assert_eq!(search(&axes(), setting(), 5, &mut { fails }).unwrap_err().message, "the device was lost");
}

fn scene(reflection: f32) -> eyerays::scene::Scene {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/cornell.toml");
    let mut scene = eyerays::scene_io::load(&path).unwrap().0;
    let opaque =
        |m: Material| Material { reflection: glam::Vec3::splat(reflection), transmission: glam::Vec3::ZERO, ..m };
    scene.materials = scene.materials.into_iter().map(opaque).collect();
    scene
}

#[test]
fn bounces_are_tried_where_rays_are_followed() {
    let own = Settings { samples: 3, bounces: 6, min_contribution: 0.0, ..Settings::default() };
    let mirrors = Axes::of(&scene(0.5), &own, &[]);
    assert_eq!(
        (&mirrors.samples[..], &mirrors.bounces[..]),
        (&[(4, 0), (3, 0), (2, 0), (1, 0)][..], &[6, 4, 2, 1, 0][..])
    );
    assert_eq!(mirrors.min_contributions, [0.0, 1.0 / 1024.0, 1.0 / 256.0, 1.0 / 64.0]);
    let matt = Axes::of(&scene(0.0), &own, &[]);
    assert_eq!((matt.bounces, matt.min_contributions), (vec![6], vec![0.0]));
}

#[test]
fn the_reference_has_a_scenes_own_settings_and_no_less_than_is_tried() {
    let own = Settings { samples: 2, bounces: 4, min_contribution: 0.01, ..Settings::default() };
    let of = |axes: Axes| {
        let Settings { samples, bounces, min_contribution, size, .. } = axes.reference(own);
        assert_eq!(size, own.size);
        (samples, bounces, min_contribution)
    };
    assert_eq!(of(axes()), (4, 8, 1.0 / 1024.0));
    assert_eq!(
        of(Axes { samples: vec![(1, 0)], bounces: vec![1], min_contributions: vec![0.5], ..axes() }),
        (1, 4, 0.01)
    );
    let base = axes().base(Setting { samples: 3, method: Method::IfIf, ..setting() });
    assert_eq!(base, setting(), "what is not tried is replaced by the first of what is");
}

#[test]
fn where_light_is_sampled_it_is_tried_how() {
    let transport = Transport { integrator: Integrator::Path, clamp: 3.0, ..Transport::default() };
    let own = Settings { spp: 20, bounces: 2, sampler: Sampler::Regular, transport, ..Settings::default() };
    let path = Axes::of(&scene(0.0), &own, &[]);
    assert_eq!(path.samples, [(1, 20), (1, 5), (1, 1)]);
    assert_eq!(path.samplers, [Sampler::Sobol, Sampler::Jittered, Sampler::Regular, Sampler::Random]);
    assert_eq!((&path.bounces[..], &path.roulettes[..]), (&[2, 1, 0][..], &[65_535, 3, 0][..]));
    assert_eq!((&path.clamps[..], &path.min_contributions[..]), (&[0.0, 10.0, 3.0, 1.0][..], &[1.0 / 1024.0][..]));
    let best = path.reference(own).transport;
    assert_eq!((best.clamp, best.roulette, best.integrator), (0.0, 65_535, Integrator::Path));
    let both = Axes::of(&scene(0.5), &own, &[Integrator::Whitted, Integrator::Distributed]);
    assert_eq!(both.integrators, [Integrator::Distributed, Integrator::Whitted]);
    assert!(both.min_contributions.len() > 1 && both.roulettes == [3]);
    let occlusion = Axes::of(&scene(0.5), &own, &[Integrator::Ao]);
    assert_eq!((occlusion.bounces.len(), occlusion.clamps.len(), occlusion.roulettes.len()), (1, 1, 1));
    let mut hurried = path.clone();
    hurried.hurry(&own);
    assert_eq!(hurried.samples, [(1, 1)]);
}

#[test]
fn filters_are_tried_where_there_are_textures_and_the_reference_loses_least() {
    let plain = scene(0.0);
    let own = Settings { filter: Filter::Bilinear, ..plain.settings };
    assert_eq!(Axes::of(&plain, &own, &[]).filters, [Filter::Bilinear]);
    let mut covered = plain;
    let texels = Texels::Bytes(vec![[255; 4]]);
    let texture = Texture { name: "white".to_owned(), width: 1, height: 1, texels }.into();
    covered.materials[0].maps.base = Some(Map { texture, placement: Placement::default() });
    let axes = Axes::of(&covered, &own, &[]);
    assert_eq!(axes.filters, [Filter::Mipmap, Filter::Bilinear, Filter::Nearest]);
    assert_eq!(axes.reference(own).filter, Filter::Mipmap);
    let axes = Axes { filters: vec![Filter::Nearest], ..axes };
    assert_eq!(axes.reference(own).filter, Filter::Bilinear);
    let base = axes.base(Setting::of(&own));
    let nearest = Setting { filter: Filter::Nearest, ..Setting::of(&own) };
    assert_eq!((base, nearest.beside(&Setting::of(&own))), (nearest, "nearest".to_owned()));
    assert_eq!(nearest.settings(own).filter, Filter::Nearest);
    assert_eq!(nearest.preset(eyerays::render::DeviceWish::Cpu).filter, Some(Filter::Nearest));
}

#[test]
fn red_green_and_blue_are_tried_where_a_scene_has_wavelengths_and_the_reference_has_them() {
    let plain = scene(0.0);
    let by = |integrator, spectral| Settings {
        spectral,
        transport: eyerays::scene::Transport { integrator, ..plain.settings.transport },
        ..plain.settings
    };
    assert_eq!(Axes::of(&plain, &by(Integrator::Path, false), &[]).spectral, [None]);
    let own = by(Integrator::Path, true);
    let axes = Axes::of(&plain, &own, &[]);
    assert_eq!(axes.spectral, [Some(true), Some(false)]);
    assert!(axes.reference(own).spectral);
    let rgb = Setting { spectral: Some(false), ..Setting::of(&own) };
    assert_eq!(rgb.beside(&Setting::of(&own)), "red, green and blue");
    assert!(!rgb.settings(own).spectral && rgb.options().ends_with("--spectral=false"));
    assert_eq!(rgb.preset(eyerays::render::DeviceWish::Cpu).spectral, Some(false));
    // No other integrator has any.
    let whitted = Axes::of(&plain, &own, &[Integrator::Whitted]);
    assert!(!whitted.reference(own).spectral);
    assert!(!Setting { integrator: Integrator::Whitted, ..Setting::of(&own) }.settings(own).spectral);
}

#[test]
fn caustics_by_chance_are_tried_where_a_scene_has_photons_and_the_reference_has_them() {
    let plain = scene(0.0);
    let by = |integrator, caustics| Settings {
        caustics,
        transport: eyerays::scene::Transport { integrator, ..plain.settings.transport },
        ..plain.settings
    };
    assert_eq!(Axes::of(&plain, &by(Integrator::Path, 0.0), &[]).caustics, [None]);
    let own = by(Integrator::Path, 0.5);
    let axes = Axes::of(&plain, &own, &[]);
    assert_eq!(axes.caustics, [Some(0.5), Some(0.0)]);
    assert_eq!(axes.reference(own).caustics, 0.5);
    let chance = Setting { caustics: Some(0.0), ..Setting::of(&own) };
    assert_eq!(chance.beside(&Setting::of(&own)), "caustics by chance");
    assert_eq!(Setting::of(&own).beside(&chance), "0.5 photons a pixel");
    assert!(chance.settings(own).caustics == 0.0 && chance.options().ends_with("--caustics=0"));
    assert_eq!(chance.preset(eyerays::render::DeviceWish::Cpu).caustics, Some(0.0));
    // No other integrator asks for any.
    let whitted = Axes::of(&plain, &own, &[Integrator::Whitted]);
    assert_eq!(whitted.reference(own).caustics, 0.0);
    assert_eq!(Setting { integrator: Integrator::Whitted, ..Setting::of(&own) }.settings(own).caustics, 0.0);
}

/// Nothing is tried that can not be or that makes no difference.
#[test]
fn a_search_leaves_out_what_makes_no_difference() {
    let base = Setting { integrator: Integrator::Path, sampler: Sampler::Sobol, samples: 1, spp: 8, ..setting() };
    let axes = Axes {
        integrators: vec![Integrator::Path, Integrator::Whitted],
        samplers: vec![Sampler::Sobol, Sampler::Jittered],
        samples: vec![(1, 8), (1, 4), (1, 1)],
        roulettes: vec![65_535, 3],
        clamps: vec![0.0, 1.0],
        ..axes()
    };
    let tried = RefCell::new(Vec::new());
    let error = |s: &Setting| 1.0 / f64::from(s.spp) + f64::from(s.clamp) + 1.0 / f64::from(1 + s.bounces);
    let time = |s: &Setting| f64::from(s.spp) * (1.0 - 0.1 * f64::from(s.clamp)) * f64::from(1 + s.bounces);
    search(&axes, base, 10_000, &mut |s| {
        tried.borrow_mut().push(*s);
        Ok(Some(record(*s, time(s), error(s))))
    })
    .unwrap();
    let tried = tried.into_inner();
    assert!(tried.iter().any(|s| s.sampler == Sampler::Jittered) && tried.iter().any(|s| s.clamp == 1.0 && s.spp == 1));
    for s in &tried {
        assert!(s.sampler == Sampler::Sobol || s.spp != 8, "no grid has 8 cells");
        let is_path = s.integrator == Integrator::Path;
        assert!(!is_path || s.min_contribution == base.min_contribution, "{}", s.options());
        assert!(is_path && s.bounces > 0 || (s.roulette, s.clamp) == (base.roulette, base.clamp), "{}", s.options());
    }
}
