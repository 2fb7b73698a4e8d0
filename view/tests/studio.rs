//! A studio without a window: wishes become pictures.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use eyerays::choice::Named;
use eyerays::denoise::{self, Guides};
use eyerays::image::{self, Encoding};
use eyerays::job::Job;
use eyerays::layers::{self, Layer, Values};
use eyerays::method::Method;
use eyerays::quality::Bvh;
use eyerays::render::{Backend, Choice, DeviceWish, Display};
use eyerays::scene::{Integrator, Material, Settings};
use eyerays::scene_io;
use eyerays::trail::{self, Aim};
use eyerays::view::View;
use eyerays_view::{Answer, AsTheyAre, Ask, Device, Doing, Edits, Lesson, Picture, Shows, Studio, Wish};
use glam::Vec3;

const PATIENCE: Duration = Duration::from_secs(120);

fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name).with_extension("toml")
}

fn cpu() -> Device {
    Device::of(&Choice { device: DeviceWish::Cpu, threads: 2, ..Choice::default() })
}

fn wish(name: &str, size: (u32, u32)) -> Wish {
    Wish::new(scene(name), cpu(), size)
}

fn studio() -> Studio {
    Studio::new(Box::new(AsTheyAre::default()), None, None)
}

/// Steps until a wish has all that it asks for, or can't have it; the last picture.
fn done(studio: &mut Studio, wish: &Wish) -> Option<Picture> {
    let (start, mut last) = (Instant::now(), None);
    loop {
        let step = studio.step(wish, &|_| ());
        last = step.picture.or(last);
        if !step.goes_on {
            return last;
        }
        assert!(start.elapsed() < PATIENCE, "{:?}", studio.news().doing);
    }
}

fn bytes(picture: &Picture) -> &[[u8; 4]] {
    match &picture.display {
        Display::Pixels { bytes, .. } => bytes,
        Display::Texture(_) => panic!("there is no window that has the device"),
    }
}

/// What `eyerays render` makes of a scene.
fn rendered(name: &str, change: impl Fn(Settings) -> Settings) -> eyerays::picture::Picture {
    let (scene, _) = scene_io::load(&scene(name)).unwrap();
    let settings = change(scene.settings);
    let job = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
    let view = View::new(&job, &scene.cameras[0]).unwrap();
    let backend = Backend::new(&Choice { device: DeviceWish::Cpu, ..Choice::default() }).unwrap();
    backend.render(&job, &view, 1, &|_| ()).unwrap().picture
}

#[test]
fn after_so_many_samples_the_film_is_that_of_a_picture_of_so_many() {
    for (name, spp) in [("cornell_path", 9), ("whitted", 0), ("occlusion", 5)] {
        let (mut studio, size) = (studio(), (33, 21));
        let wish = Wish { most: 9.min(if spp == 0 { 9 } else { spp }), ..wish(name, size) };
        let shown = done(&mut studio, &wish).unwrap();
        let wanted = rendered(name, |settings| match settings.sampler.has_cells() {
            true => Settings { size, ..settings },
            false => Settings { size, spp, ..settings },
        });
        let film = studio.session().unwrap().film().unwrap();
        assert!(film.develop().unwrap().bits_equal(&wanted), "{name}");
        assert_eq!(bytes(&shown), image::screen(&wanted, &Encoding::default()).unwrap(), "{name}");
        assert_eq!((shown.size, studio.news().doing.clone()), (size, Doing::Done));
    }
}

#[test]
fn a_camera_that_moves_has_smaller_pictures_and_one_that_stands_still_all_of_them() {
    let mut studio = studio();
    let still = Wish { most: 2, ..wish("cornell_path", (64, 48)) };
    assert_eq!(done(&mut studio, &still).unwrap().size, (64, 48));
    let facts = studio.news().facts.clone().unwrap();
    let mut camera = facts.camera.clone();
    for step in 0..4 {
        camera.eye += Vec3::X * 0.01;
        let moving = Wish { is_moving: true, camera: Some(camera.clone()), ..still.clone() };
        let shown = done(&mut studio, &moving).unwrap();
        assert!(shown.size.0 <= 64 && shown.samples == 1, "{step}: {:?}", shown.size);
        assert_eq!(shown.camera, camera);
    }
    let rested = done(&mut studio, &Wish { camera: Some(camera), ..still }).unwrap();
    assert_eq!((rested.size, rested.samples), ((64, 48), 2));
}

#[test]
fn a_file_that_is_saved_is_read_again_and_a_fault_in_it_leaves_the_last_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::copy(scene("cornell"), &path).unwrap();
    let mut wish = Wish { most: 1, ..Wish::new(path.clone(), cpu(), (16, 16)) };
    let mut studio = studio();
    assert!(done(&mut studio, &wish).is_some());
    std::fs::write(&path, "[[camera]\n").unwrap();
    wish.source.version += 1;
    assert!(done(&mut studio, &wish).is_none());
    let fault = studio.news().fault.clone().unwrap();
    assert!(fault.contains("scene.toml") && !fault.contains('\n'), "{fault}");
    assert!(studio.news().facts.is_some());
    std::fs::copy(scene("whitted"), &path).unwrap();
    wish.source.version += 1;
    let shown = done(&mut studio, &wish).unwrap();
    assert_eq!(studio.news().fault, None);
    let wanted = rendered("whitted", |settings| Settings { size: (16, 16), ..settings });
    assert_eq!(bytes(&shown).len(), image::screen(&wanted, &Encoding::default()).unwrap().len());
}

#[test]
fn what_is_changed_by_hand_is_rendered_as_if_the_file_said_it() {
    let size = (24, 16);
    let mut studio = studio();
    let plain = Wish { most: 4, ..wish("whitted", size) };
    let before = done(&mut studio, &plain).unwrap();
    let own = studio.news().facts.clone().unwrap().own.clone();
    let green = Material { diffuse: Vec3::Y, ..own.materials[0].clone() };
    let edits = Edits { lights: [(0, 0.5)].into(), materials: [(0, green.clone())].into(), environment: None };
    let after = done(&mut studio, &Wish { edits: edits.clone(), ..plain.clone() }).unwrap();
    let (mut scene, _) = scene_io::load(&scene("whitted")).unwrap();
    edits.apply(&own, &mut scene);
    let settings = Settings { size, ..scene.settings };
    let job = Job::new(&scene, settings, Bvh::Fast.quality()).unwrap();
    let view = View::new(&job, &scene.cameras[0]).unwrap();
    let backend = Backend::new(&Choice { device: DeviceWish::Cpu, ..Choice::default() }).unwrap();
    let wanted = backend.render(&job, &view, 1, &|_| ()).unwrap().picture;
    assert_eq!(bytes(&after), image::screen(&wanted, &Encoding::default()).unwrap());
    assert_ne!(bytes(&after), bytes(&before));
    let again = done(&mut studio, &plain).unwrap();
    assert_eq!(bytes(&again), bytes(&before));
}

#[test]
fn another_integrator_another_look_and_another_size_are_other_pictures() {
    let mut studio = studio();
    let plain = Wish { most: 2, ..wish("cornell_path", (24, 16)) };
    let first = done(&mut studio, &plain).unwrap();
    let brighter = Wish { look: Encoding { exposure_ev: 2.0, ..Encoding::default() }, ..plain.clone() };
    assert_ne!(bytes(&done(&mut studio, &brighter).unwrap()), bytes(&first));
    let settings = studio.news().facts.clone().unwrap().settings;
    let transport = eyerays::scene::Transport { integrator: Integrator::Ao, ..settings.transport };
    let occlusion = Wish { settings: Some(Settings { transport, ..settings }), ..plain.clone() };
    assert_ne!(bytes(&done(&mut studio, &occlusion).unwrap()), bytes(&first));
    let wide = done(&mut studio, &Wish { size: (48, 16), ..plain.clone() }).unwrap();
    assert_eq!(wide.size, (48, 16));
    assert_eq!(bytes(&done(&mut studio, &plain).unwrap()), bytes(&first));
}

#[test]
fn what_can_not_be_had_is_refused_once_and_the_next_wish_is_served() {
    let mut studio = studio();
    let missing = Wish::new(PathBuf::from("no/such.toml"), cpu(), (16, 16));
    assert!(done(&mut studio, &missing).is_none());
    assert!(studio.news().fault.clone().unwrap().contains("no/such.toml"));
    let plain = Wish { most: 1, ..wish("whitted", (16, 16)) };
    assert!(done(&mut studio, &plain).is_some());
    assert_eq!(studio.news().fault, None);
    let mut lost = studio.news().facts.clone().unwrap().camera.clone();
    lost.eye = lost.target;
    assert!(done(&mut studio, &Wish { camera: Some(lost), ..plain.clone() }).is_none());
    assert!(studio.news().fault.is_some());
    assert!(done(&mut studio, &plain).is_some());
    assert_eq!(studio.news().fault, None);
}

#[test]
fn no_scene_is_nothing_to_do() {
    let mut studio = studio();
    assert!(done(&mut studio, &Wish::new(PathBuf::new(), cpu(), (16, 16))).is_none());
    assert_eq!((studio.news().fault.clone(), studio.news().doing.clone()), (None, Doing::Nothing));
}

#[test]
fn a_layer_takes_the_place_of_light_and_goes_again() {
    let size = (40, 30);
    let mut studio = studio();
    let plain = wish("whitted", size);
    let light = done(&mut studio, &plain).unwrap();
    let (scene, _) = scene_io::load(&scene("whitted")).unwrap();
    let settings = Settings { size, samples: 1, spp: 1, ..scene.settings };
    let job = Job::new(&scene, settings, Bvh::Medium.quality()).unwrap();
    let choice = Choice { device: DeviceWish::Cpu, traversal: Method::IfIf.into(), ..Choice::default() };
    let mut session = Backend::new(&choice).unwrap().open(&job).unwrap();
    let rendering = session.expose(&View::new(&job, &scene.cameras[0]).unwrap(), &|_| ()).unwrap();
    for layer in [Layer::Visits, Layer::Tests] {
        let neighbours = None;
        let shown = layers::Shown { scene: &scene, camera: &scene.cameras[0], neighbours };
        let values = layers::render(&mut session, shown, &rendering, &[layer]).unwrap();
        let Values::Numbers(numbers) = &values[0].1 else { panic!("they are counts") };
        let device = Device { traversal: Method::IfIf.into(), ..cpu() };
        let shown = done(&mut studio, &Wish { shows: Shows::Layer(layer), device, ..plain.clone() }).unwrap();
        let most = f64::from(*numbers.iter().max().unwrap());
        assert_eq!(studio.news().scale, Some([0.0, most]), "{layer}");
        let brightness = |pixel: &[u8; 4]| pixel[..3].iter().map(|&v| u32::from(v)).sum::<u32>();
        let brightest = bytes(&shown).iter().map(brightness).enumerate().max_by_key(|(_, bright)| *bright).unwrap().0;
        assert_eq!(f64::from(numbers[brightest]), most, "{layer}");
    }
    for &shows in Shows::VARIANTS.iter().filter(|shows| !matches!(shows, Shows::Light | Shows::Denoised)) {
        let shown = done(&mut studio, &Wish { shows, ..plain.clone() }).unwrap();
        assert_eq!(bytes(&shown).len(), 40 * 30, "{shows}");
        assert_ne!(bytes(&shown), bytes(&light), "{shows}");
    }
    assert_eq!(bytes(&done(&mut studio, &plain).unwrap()), bytes(&light));
}

#[test]
fn a_denoised_picture_has_the_bytes_of_a_file_and_the_noisy_one_comes_back() {
    let (mut studio, size, spp) = (studio(), (33, 21), 9);
    let plain = Wish { most: spp, ..wish("cornell_path", size) };
    let noisy = done(&mut studio, &plain).unwrap();
    let (scene, _) = scene_io::load(&scene("cornell_path")).unwrap();
    let job = Job::new(&scene, Settings { size, spp, ..scene.settings }, Bvh::Fast.quality()).unwrap();
    let choice = Choice { device: DeviceWish::Cpu, ..Choice::default() };
    let mut session = Backend::new(&choice).unwrap().open(&job).unwrap();
    let rendering = session.expose(&View::new(&job, &scene.cameras[0]).unwrap(), &|_| ()).unwrap();
    let wanted = [Layer::Albedo, Layer::Normal, Layer::Depth, Layer::Error];
    let shown = layers::Shown { scene: &scene, camera: &scene.cameras[0], neighbours: None };
    let layers = layers::render(&mut session, shown, &rendering, &wanted).unwrap();
    let [
        (_, Values::Colours(albedo)),
        (_, Values::Vectors(normal)),
        (_, Values::Lengths(depth)),
        (_, Values::Lengths(error)),
    ] = &layers[..]
    else {
        panic!("they are what they are")
    };
    let guides = Guides { albedo, normal, depth, error, opacity_error: None };
    let polished = denoise::denoise(&rendering.picture, &guides).unwrap();
    let denoised = Wish { shows: Shows::Denoised, ..plain.clone() };
    for look in [Encoding::default(), Encoding { exposure_ev: 1.0, ..Encoding::default() }] {
        let shown = done(&mut studio, &Wish { look, ..denoised.clone() }).unwrap();
        assert_eq!(bytes(&shown), image::screen(&polished, &look).unwrap());
        assert_eq!((studio.news().denoised, studio.news().samples), (Some(spp), spp));
    }
    assert_eq!(bytes(&done(&mut studio, &plain).unwrap()), bytes(&noisy));
    assert_ne!(bytes(&done(&mut studio, &denoised).unwrap()), bytes(&noisy));
}

#[test]
fn rays_are_followed_as_trails_tell_and_boxes_are_those_of_their_level() {
    let (mut studio, size) = (studio(), (40, 30));
    let device = Device { traversal: Method::IfIf.into(), ..cpu() };
    let plain = Wish { most: 1, device, ..wish("whitted", size) };
    let (scene, _) = scene_io::load(&scene("whitted")).unwrap();
    let job = Job::new(&scene, Settings { size, ..scene.settings }, Bvh::Fast.quality()).unwrap();
    let lesson = Lesson { level: Some(2), pixel: Some((20, 22)) };
    done(&mut studio, &Wish { lesson, ..plain.clone() }).unwrap();
    let told = studio.news().lesson.clone();
    let trail = trail::follow(&job, &scene, &scene.cameras[0], Aim::middle(20, 22), Method::IfIf).unwrap();
    let way = told.way.as_ref().unwrap();
    assert_eq!((way.text.clone(), way.pixel), (trail.to_string(), (20, 22)));
    // Each is visited, or begins behind a hit; the root's children are in front.
    assert!(way.entered.len() >= trail.deepest() as usize && way.entered[0].1 == 0, "{}", way.entered.len());
    assert_eq!(told.boxes, job.boxes(2));
    assert!(!told.boxes.is_empty());
    let outside = Lesson { level: None, pixel: Some((40, 0)) };
    done(&mut studio, &Wish { lesson: outside, ..plain.clone() });
    let told = studio.news().lesson.clone();
    assert!(told.boxes.is_empty() && told.way.as_ref().unwrap().text.contains("40"), "it tells what is wrong");
    done(&mut studio, &plain);
    assert!(studio.news().lesson.way.is_none());
}

#[test]
fn a_pixel_tells_what_is_there_and_how_far_it_is() {
    let mut studio = studio();
    let plain = Wish { most: 1, ..wish("whitted", (64, 48)) };
    assert!(matches!(studio.answer(&plain, Ask::What(1, 1)), Answer::Nothing(_)));
    done(&mut studio, &plain);
    let Answer::What(line) = studio.answer(&plain, Ask::What(32, 44)) else { panic!("the floor is there") };
    for told in ["material \"", " t ", "within", "normal ("] {
        assert!(line.contains(told) && !line.contains('\n'), "{line}");
    }
    let Answer::Focus(distance) = studio.answer(&plain, Ask::Focus(32, 44)) else { panic!("it is somewhere") };
    assert!(distance > 0.1 && distance.is_finite(), "{distance}");
    assert!(matches!(studio.answer(&plain, Ask::What(64, 0)), Answer::Nothing(_)));
}
