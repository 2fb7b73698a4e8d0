//! A scene that stays on a device while what is asked of it changes.

use std::thread;

use eyerays::device_scene::Feature;
use eyerays::gpu::{AdapterRequest, Gpu, Renderer, wgpu};
use eyerays::job::Job;
use eyerays::method::Traversal;
use eyerays::quality::Bvh;
use eyerays::render::{Backend, Choice, DeviceWish};
use eyerays::scene::{Light, Settings};
use eyerays::view::View;
use eyerays_tests::shipped;

fn job(name: &str) -> (Job, View) {
    let scene = shipped(name);
    let settings = Settings { size: (40, 30), samples: 2, spp: 0, ..scene.settings };
    let job = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
    let view = View::new(&job, &scene.cameras[0]).unwrap();
    (job, view)
}

fn backends() -> Vec<Backend> {
    let gpu = eyerays_tests::gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() });
    let devices = [DeviceWish::Cpu].into_iter().chain(gpu.map(|_| DeviceWish::Gpu));
    devices.map(|device| Backend::new(&Choice { device, threads: 2, ..Choice::default() }).unwrap()).collect()
}

#[test]
fn a_session_that_turns_has_the_pictures_of_new_ones() {
    let (first, view) = job("whitted");
    let fewer = Settings { bounces: 0, ..*first.settings() };
    let jobs = [
        first.clone(),
        first.with(fewer).unwrap(),
        first.showing(Some(Feature::Normal)),
        first.showing(Some(Feature::Albedo)),
        first.clone(),
    ];
    for backend in backends() {
        let mut session = backend.open(&first).unwrap();
        for (i, job) in jobs.iter().enumerate() {
            session.turn(job).unwrap();
            let own = session.render(&view, 1, &|_| ()).unwrap().picture;
            let new = backend.render(job, &view, 1, &|_| ()).unwrap().picture;
            assert!(own.bits_equal(&new), "{}, job {i}", backend.description());
        }
    }
}

#[test]
fn a_session_turns_to_another_scene() {
    let ((first, _), (second, view)) = (job("glass"), job("lights"));
    for backend in backends() {
        let mut session = backend.open(&first).unwrap();
        session.turn(&second).unwrap();
        let own = session.render(&view, 1, &|_| ()).unwrap().picture;
        let new = backend.render(&second, &view, 1, &|_| ()).unwrap().picture;
        assert!(own.bits_equal(&new), "{}", backend.description());
    }
}

#[test]
fn a_session_owns_all_that_it_takes_and_works_on_any_thread() {
    for backend in backends() {
        let (job, view) = job("cornell");
        let want = backend.render(&job, &view, 1, &|_| ()).unwrap().picture;
        let mut session = backend.open(&job).unwrap();
        drop((backend, job));
        let rendered = thread::spawn(move || session.render(&view, 1, &|_| ()).unwrap().picture);
        assert!(rendered.join().unwrap().bits_equal(&want));
    }
}

#[test]
fn a_device_that_a_window_has_opened_renders_the_same() {
    let Some(own) = eyerays_tests::gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) else { return };
    let adapter = &eyerays_tests::adapter(&own);
    let open = |descriptor| pollster::block_on(adapter.request_device(&descriptor)).unwrap();
    let (device, queue) = open(Gpu::descriptor(adapter));
    let shared = Gpu::from_wgpu(adapter, device, queue).unwrap();
    assert_eq!((shared.report.exact, shared.report.timestamps), (own.report.exact, own.report.timestamps));
    let (job, view) = job("cornell");
    let [one, other] = [&own, &shared].map(|gpu| {
        let mut renderer = Renderer::new(gpu, &job, true, Traversal::default()).unwrap();
        renderer.render(&view, &|_| ()).unwrap().film.develop().unwrap()
    });
    assert!(one.bits_equal(&other));
    let (device, queue) = open(wgpu::DeviceDescriptor::default());
    let refused = Gpu::from_wgpu(adapter, device, queue).err().unwrap().to_string();
    assert!(refused.contains("open it by Gpu::descriptor"), "{refused}");
}

#[test]
fn lights_that_were_changed_stay_so_where_a_renderer_turns() {
    let Some(gpu) = eyerays_tests::gpu(&AdapterRequest { exact: true, ..AdapterRequest::default() }) else { return };
    let (job, view) = job("lights");
    let mut lights = shipped("lights").lights;
    for light in &mut lights {
        if let Light::Point { colour, .. } | Light::Spot { colour, .. } = light {
            *colour *= 0.5;
        }
    }
    let mut renderer = Renderer::new(&gpu, &job, true, Traversal::default()).unwrap();
    let rendered = |renderer: &mut Renderer| renderer.render(&view, &|_| ()).unwrap().film.develop().unwrap();
    let before = rendered(&mut renderer);
    renderer.set_lights(&lights).unwrap();
    let dimmed = rendered(&mut renderer);
    renderer.turn(&job.showing(Some(Feature::Normal))).unwrap();
    renderer.turn(&job).unwrap();
    assert!(rendered(&mut renderer).bits_equal(&dimmed) && !dimmed.bits_equal(&before));
}
