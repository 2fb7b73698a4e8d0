//! The steps of the rays of pixels, against tests of every primitive, layers, and what other ways to ask say.

use eyerays::choice::Named;
use eyerays::job::Job;
use eyerays::layers::{self, Layer, Shown, Values};
use eyerays::method::{Layout, Method, Traversal};
use eyerays::pick::{Names, pick, pick_by};
use eyerays::quality::Bvh;
use eyerays::render::{Backend, Choice, DeviceWish};
use eyerays::scene::{Camera, Object, Primitives, Projection, Sampler, Scene, Settings, Visibility};
use eyerays::scene_io::{self, Instancing, Loading};
use eyerays::stream::{Stream, StreamRay};
use eyerays::trail::{Aim, Contact, Outcome, Step, Target, Trail, follow};
use eyerays::view::View;
use eyerays_shader::camera::{self, Pixel};
use eyerays_shader::data::{Launch, Order, Tuning};
use eyerays_shader::ray::Ray;
use eyerays_shader::real::V3;
use eyerays_tests::brute_force::brute_force;
use eyerays_tests::{model, shipped};
use glam::Vec3;

const SIZE: (u32, u32) = (21, 14);

/// Scenes of triangles, and of spheres and disks, too.
const SCENES: [&str; 4] = ["cornell", "glass", "lights", "whitted"];

fn packed(scene: &Scene) -> Job {
    let settings = Settings { size: SIZE, samples: 1, spp: 0, sampler: Sampler::Regular, ..scene.settings };
    Job::new(scene, settings, Bvh::Medium.quality()).unwrap()
}

fn pixels() -> impl Iterator<Item = (u32, u32)> {
    (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y)))
}

/// Every method; the hybrids early and late.
fn traversals() -> Vec<Traversal> {
    let tuned = |method: Method| {
        [(8, 25), (1, 0), (2, 70), (63, 100)]
            .map(|(stack, cut)| Traversal { tuning: Tuning::new(stack, cut), ..method.into() })
    };
    let is_hybrid =
        |method: &Method| method.name().contains('-') && !matches!(method, Method::IfIf | Method::WhileWhile);
    let mut all: Vec<Traversal> = Method::ALL.map(Traversal::from).into();
    all.extend(Method::ALL.into_iter().filter(is_hybrid).flat_map(tuned));
    all.extend([Layout::Indexed, Layout::Compact].map(|layout| Traversal { layout, ..Method::WhileWhile.into() }));
    all
}

fn trail(job: &Job, scene: &Scene, (x, y): (u32, u32), traversal: impl Into<Traversal>) -> Trail {
    follow(job, scene, &scene.cameras[0], Aim::middle(x, y), traversal)
        .unwrap_or_else(|error| panic!("{x},{y}: {error}"))
}

/// The rays through the middles of pixels, as kernels make them.
fn rays(job: &Job, scene: &Scene) -> Stream {
    let view = View::new(job, &scene.cameras[0]).unwrap();
    let frame = view.launch(job, view.region(), 0, 1, Order(0));
    let ray = |(x, y)| {
        let pixel = Pixel { x, y, inside: true, index: 0, sample: 0 };
        let ray = camera::ray::<f32>(&frame, Launch(0), &[], pixel);
        let vector = |v: V3<f32>| Vec3::new(v.x, v.y, v.z);
        let origin = vector(Ray::from_afar(ray.origin, ray.direction).origin);
        StreamRay { origin, direction: vector(ray.direction), limit: f32::MAX, source_primitive: StreamRay::NOWHERE }
    };
    Stream::new(pixels().map(ray).collect::<Vec<_>>().into_iter())
}

#[test]
fn every_method_ends_where_a_test_of_every_primitive_does() {
    for name in SCENES {
        let scene = shipped(name);
        let job = packed(&scene);
        let (want, mut hits) = (brute_force(&job, &rays(&job, &scene)), 0);
        for (at, [t, u, v, primitive]) in pixels().zip(want) {
            for traversal in traversals() {
                let trail = trail(&job, &scene, at, traversal);
                let Some(hit) = trail.hit else {
                    assert_eq!(primitive, StreamRay::NOWHERE, "{name} {at:?} {traversal:?}");
                    continue;
                };
                hits += 1;
                assert_eq!(hit.surface.primitive, primitive as usize, "{name} {at:?} {traversal:?}");
                let distance = f64::from(f32::from_bits(t)) / job.normalisation().scale;
                assert!(hit.place.t >= distance && (hit.place.u.to_bits(), hit.place.v.to_bits()) == (u, v));
                let closest = trail.steps.iter().rev().find_map(|step| match step {
                    Step::Test(test) if test.outcome == Outcome::Closest => Some((&test.surface, test.contact)),
                    _ => None,
                });
                assert_eq!(closest, Some((&hit.surface, Some(hit.place))), "{name} {at:?} {traversal:?}");
            }
        }
        assert!(hits > 1000, "{name}: {hits}");
    }
}

/// Of each method, and of pictures that are no whole blocks.
#[test]
fn layers_count_the_steps_that_trails_have() {
    for (name, traversal) in SCENES.into_iter().flat_map(|name| traversals().into_iter().map(move |of| (name, of))) {
        let scene = shipped(name);
        let job = packed(&scene);
        let choice = Choice { device: DeviceWish::Cpu, threads: 2, traversal, ..Choice::default() };
        let view = View::new(&job, &scene.cameras[0]).unwrap();
        let mut session = Backend::new(&choice).unwrap().open(&job).unwrap();
        let picture = session.render(&view, 1, &|_| ()).unwrap();
        let wanted = [Layer::Visits, Layer::Tests, Layer::Deepest, Layer::Idle];
        let layers = layers::render(&mut session, Shown::of(&scene), &picture, &wanted).unwrap();
        let [visits, tests, deepest, idle] = [0, 1, 2, 3].map(|i| match &layers[i].1 {
            Values::Numbers(numbers) => numbers.clone(),
            other => panic!("{other:?}"),
        });
        for (i, at) in pixels().enumerate().step_by(5) {
            let trail = trail(&job, &scene, at, traversal);
            let counts = (trail.visits() as u32, trail.tests() as u32, trail.deepest());
            assert_eq!((visits[i], tests[i], deepest[i]), counts, "{name} {at:?} {traversal:?}");
        }
        // Nobody waits for who goes farther.
        let steps: Vec<u32> = visits.iter().zip(&tests).map(|(visits, tests)| visits + tests).collect();
        for (i, (x, y)) in pixels().enumerate() {
            let block = pixels().zip(&steps).filter(|((a, b), _)| (a / 8, b / 4) == (x / 8, y / 4));
            let longest = block.map(|(_, &steps)| steps).max().unwrap();
            assert_eq!(idle[i], longest - steps[i], "{name} {x},{y} {traversal:?}");
        }
    }
}

/// A method that is left to us is what a CPU takes.
#[test]
fn a_trail_of_auto_is_that_of_packets() {
    let scene = shipped("cornell");
    let job = packed(&scene);
    let [auto, packet] = [Method::Auto, Method::Packet].map(|method| trail(&job, &scene, (11, 9), method));
    assert_eq!(auto, packet);
    let block = packet.packet.unwrap();
    assert_eq!((block.x, block.y, block.width, block.height), (8, 8, 8, 4));
}

/// Nothing is visited that no visit before has led to.
#[test]
fn every_node_is_a_child_that_was_met_before() {
    let scene = shipped("lights");
    let job = packed(&scene);
    for at in pixels() {
        for method in Method::ALL {
            let mut waiting = vec![0];
            for step in trail(&job, &scene, at, method).steps {
                let Step::Visit(visit) = step else { continue };
                let place = waiting.iter().position(|&node| node == visit.node);
                waiting.swap_remove(place.unwrap_or_else(|| panic!("{method} {at:?}: node {}", visit.node)));
                waiting.extend(visit.children.iter().filter_map(|child| match child.child {
                    Target::Node(number) if child.rays > 0 => Some(number),
                    _ => None,
                }));
            }
        }
    }
}

/// What layers tell of the same place, and the closed form of a point on a ray.
#[test]
fn a_pick_is_what_layers_have_of_its_pixel() {
    for name in SCENES {
        let scene = shipped(name);
        let job = packed(&scene);
        let camera = &scene.cameras[0];
        let view = View::new(&job, camera).unwrap();
        let choice = Choice { device: DeviceWish::Cpu, threads: 2, ..Choice::default() };
        let mut session = Backend::new(&choice).unwrap().open(&job).unwrap();
        let picture = session.render(&view, 1, &|_| ()).unwrap();
        let wanted = [Layer::Object, Layer::Material, Layer::Position, Layer::Normal];
        let layers = layers::render(&mut session, Shown::of(&scene), &picture, &wanted).unwrap();
        let [Values::Numbers(objects), Values::Numbers(materials)] = [&layers[0].1, &layers[1].1] else { panic!() };
        let [Values::Vectors(positions), Values::Vectors(normals)] = [&layers[2].1, &layers[3].1] else { panic!() };
        for (i, (x, y)) in pixels().enumerate() {
            let Some(seen) = pick(&job, &scene, camera, x, y).unwrap() else {
                assert_eq!(objects[i], 0);
                continue;
            };
            assert_eq!(seen.surface.object.as_ref().unwrap().number, objects[i], "{name} {x},{y}");
            assert_eq!(seen.surface.material.number, materials[i], "{name} {x},{y}");
            let object = &scene.objects[objects[i] as usize - 1];
            assert_eq!(
                (&seen.surface.object.as_ref().unwrap().name, seen.surface.kind),
                (&object.name, object.primitives.noun())
            );
            assert_eq!(seen.surface.material.name, scene.materials[materials[i] as usize - 1].name);
            assert_eq!(seen.position.to_array(), positions.pixels[i], "{name} {x},{y}");
            assert_eq!(seen.shading_normal.to_array(), normals.pixels[i], "{name} {x},{y}");
            let from = (seen.position - camera.eye).as_dvec3();
            let size = f64::from(scene.bounds()[1].distance(scene.bounds()[0]));
            assert!((from.length() - seen.distance).abs() < 1e-5 * size, "{name} {x},{y}: {}", seen.distance);
            assert!(seen.normal.dot(from.as_vec3()) <= 0.0 && (seen.normal.length() - 1.0).abs() < 1e-5);
            assert!(seen.error > 0.0 && seen.error < 1e-3 * size, "{name} {x},{y}: {}", seen.error);
        }
    }
}

/// Pieces of chess, each held once or as often as it stands there: the same surfaces at the same places.
#[test]
fn rays_go_into_copies_of_meshes_by_every_method() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/chess.glb");
    let [copied, flat] = [Instancing::Always, Instancing::Never].map(|instancing| {
        let loading = Loading { instancing, ..Loading::default() };
        scene_io::load_as(path.as_ref(), loading).unwrap().0
    });
    let (jobs, mut inside) = ([&copied, &flat].map(packed), 0);
    for at in pixels().step_by(7) {
        let want = trail(&jobs[1], &flat, at, Method::IfIf).hit;
        for traversal in traversals() {
            let hit = trail(&jobs[0], &copied, at, traversal).hit;
            inside += usize::from(hit.as_ref().is_some_and(|hit| hit.surface.shared.is_some()));
            let seen = |hit: Option<Contact>| hit.map(|hit| (hit.place.t, hit.surface.object, hit.surface.material));
            assert_eq!(seen(hit), seen(want.clone()), "{at:?} {traversal:?}");
        }
    }
    assert!(inside > 100, "{inside}");
}

/// A box that goes to the right before a wall.
fn passing(time: f32) -> Scene {
    let mut scene = model::empty();
    model::add_wall(&mut scene, model::matt(Vec3::ONE), Vec3::new(0.0, 0.0, -2.0), 4.0);
    let first = scene.mesh.triangles.len();
    let least = Vec3::new(2.0 * time - 1.5, -0.5, -0.5);
    model::add_box(&mut scene, model::matt(Vec3::X), least, least + 1.0);
    let object = |name: &str, triangles| Object {
        name: name.into(),
        primitives: Primitives::Triangles(triangles),
        bounds: [Vec3::ZERO; 2],
        visibility: Visibility::default(),
    };
    scene.objects = vec![object("wall", 0..first), object("box", first..scene.mesh.triangles.len())];
    let (eye, projection) = (Vec3::new(0.0, 0.5, 5.0), Projection::Perspective { fov: 45.0 });
    scene.cameras = vec![Camera::new("front", eye, Vec3::ZERO, projection)];
    scene
}

/// Each has its own, so that no two of a block are followed together.
#[test]
fn rays_at_their_times_go_alone_and_see_what_is_there_then() {
    let scene = passing(0.0).over(&[passing(0.5), passing(1.0)], 1.0).unwrap().scene;
    let settings = Settings { size: SIZE, spp: 16, sampler: Sampler::Sobol, ..scene.settings };
    let job = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
    let (names, camera) = (Names::of(&scene), &scene.cameras[0]);
    let mut seen = [0, 0];
    for sample in 0..16 {
        let aim = Aim { sample: Some(sample), ..Aim::middle(10, 6) };
        let pick = pick_by(&job, &names, camera, aim).unwrap().unwrap();
        seen[usize::from(pick.surface.object.as_ref().unwrap().name == "box")] += 1;
        for method in Method::ALL {
            let trail = follow(&job, &scene, camera, aim, method).unwrap();
            let hit = trail.hit.unwrap();
            assert_eq!((hit.surface, hit.place.t), (pick.surface.clone(), pick.distance), "{method} {sample}");
            assert_eq!(trail.packet, None);
        }
    }
    assert!(seen[0] > 2 && seen[1] > 2, "{seen:?}");
    let opening = trail(&job, &scene, (10, 6), Method::Auto);
    assert_eq!((opening.method, opening.hit.unwrap().surface.object.unwrap().name), (Method::IfIf, "wall".into()));
}

/// Samples lie elsewhere in their pixel than its middle, and are those of the picture.
#[test]
fn a_sample_has_a_trail_and_a_pick_of_its_own() {
    let scene = shipped("whitted");
    let settings = Settings { size: SIZE, spp: 8, sampler: Sampler::Sobol, ..scene.settings };
    let job = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
    let (names, camera) = (Names::of(&scene), &scene.cameras[0]);
    let distances = (0..8).filter_map(|sample| {
        let aim = Aim { sample: Some(sample), ..Aim::middle(10, 12) };
        let seen = pick_by(&job, &names, camera, aim).unwrap()?;
        let hit = follow(&job, &scene, camera, aim, Method::IfIf).unwrap().hit.unwrap();
        assert_eq!((hit.surface, hit.place.t), (seen.surface, seen.distance));
        Some(seen.distance)
    });
    let mut distances: Vec<f64> = distances.collect();
    assert_eq!(distances.len(), 8);
    distances.sort_by(f64::total_cmp);
    distances.dedup();
    assert_eq!(distances.len(), 8, "no two samples are alike");
    let beyond = Aim { sample: Some(8), ..Aim::middle(0, 0) };
    let refused = pick_by(&job, &names, camera, beyond).unwrap_err().to_string();
    assert_eq!(refused, "the pixel has no sample 8: give one from 0 to 7");
}

#[test]
fn pixels_outside_the_picture_are_refused_with_its_range() {
    let scene = shipped("cornell");
    let job = packed(&scene);
    let refused = pick(&job, &scene, &scene.cameras[0], 21, 3).unwrap_err().to_string();
    let want = "the pixel 21,3 is not in the picture of 21x14: give a column from 0 to 20 and a row from 0 to 13";
    assert_eq!(refused, want);
}
