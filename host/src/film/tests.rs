//! Films in parts, and films in files.

use proptest::prelude::*;

use super::*;
use crate::cpu::Renderer;
use crate::job::Job;
use crate::method::Traversal;
use crate::quality::Bvh;
use crate::render::Precision;
use crate::scene::{self, Integrator, Scene, Settings, Transport};
use crate::scene_io;

const SIZE: (u32, u32) = (17, 11);
const SPP: u32 = 9;

fn cornell() -> Scene {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/cornell_path.toml");
    scene_io::load(path.as_ref()).unwrap().0
}

/// A scene by an integrator, and how it is seen.
fn posed(scene: &Scene, integrator: Integrator) -> (Job, View) {
    let transport = Transport { integrator, ..scene.settings.transport };
    let settings = Settings { size: SIZE, spp: SPP, bounces: 2, transport, ..scene.settings };
    let packed = Job::new(scene, settings, Bvh::Fast.quality()).unwrap();
    let view = View::new(&packed, &scene.cameras[0]).unwrap();
    (packed, view)
}

fn rendered(renderer: &Renderer, view: &View) -> Film {
    let mut film = renderer.start(view);
    renderer.add::<f32>(view, &mut film, view.whole(), &|_| (), &()).unwrap();
    film
}

/// Cuts a part at some place of an axis, if it is long enough there.
fn cut(part: &Part, axis: usize, share: f64) -> Option<[Part; 2]> {
    let Region { x, y, width, height } = part.region;
    let length = [width, height, part.samples.len() as u32][axis];
    if length < 2 {
        return None;
    }
    let at = (1.0 + share * f64::from(length - 1)).min(f64::from(length - 1)) as u32;
    let with = |region, samples| Part { region, samples };
    let (start, end) = (part.samples.start, part.samples.end);
    Some(match axis {
        0 => [(x, at), (x + at, width - at)].map(|(x, width)| with(Region { x, y, width, height }, start..end)),
        1 => [(y, at), (y + at, height - at)].map(|(y, height)| with(Region { x, y, width, height }, start..end)),
        _ => [start..start + at, start + at..end].map(|samples| with(part.region, samples)),
    })
}

/// Parts of a view: the cuts are of the part with this number among those so far.
fn partition(view: &View, cuts: &[(usize, usize, f64)]) -> Vec<Part> {
    let mut parts = vec![view.whole()];
    for &(number, axis, share) in cuts {
        let number = number % parts.len();
        if let Some([a, b]) = cut(&parts[number], axis, share) {
            parts[number] = a;
            parts.push(b);
        }
    }
    parts
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Into tiles and samples, merged in any order, by way of files.
    #[test]
    fn any_partition_is_the_one_picture(
        cuts in prop::collection::vec((0usize..64, 0usize..3, 0.0..1.0), 0..12),
        order in prop::collection::vec(any::<u32>(), 13),
        whitted: bool,
    ) {
        let integrator = if whitted { Integrator::Distributed } else { Integrator::Path };
        let (packed, view) = posed(&cornell(), integrator);
        let renderer = Renderer::new(&packed, Traversal::default(), 2).unwrap();
        let whole = rendered(&renderer, &view);
        let mut parts: Vec<(u32, Part)> = order.into_iter().zip(partition(&view, &cuts)).collect();
        parts.sort_by_key(|(order, _)| *order);
        let mut films = parts.iter().map(|(_, Part { region, samples })| {
            let film = rendered(&renderer, &view.part(*region, samples.clone()).unwrap());
            read(&written(&film)).unwrap()
        });
        let mut film = films.next().unwrap();
        films.for_each(|part| film.merge(part).unwrap());
        prop_assert_eq!(film.coverage().parts(), &[view.whole()]);
        prop_assert!(film.missing(&view).is_empty());
        prop_assert_eq!((&film.sums, film.rays()), (&whole.sums, whole.rays()));
        prop_assert!(film.develop().unwrap().bits_equal(&whole.develop().unwrap()));
    }

    /// Any byte of a film may be any other.
    #[test]
    fn a_damaged_film_is_refused_or_was_not_hurt(at in 0.0..1.0, value: u8) {
        let film = small();
        let mut bytes = written(&film);
        let at = (at * bytes.len() as f64) as usize;
        bytes[at] = value;
        if let Ok(read) = read(&bytes) {
            prop_assert_eq!(read.sums, film.sums);
        }
    }
}

fn written(film: &Film) -> Vec<u8> {
    let mut bytes = Vec::new();
    film.write(&mut bytes).unwrap();
    bytes
}

fn read(mut bytes: &[u8]) -> Result<Film> {
    Film::read(&mut bytes)
}

/// Of two samples, with an identity.
fn small() -> Film {
    let scene = cornell();
    let (packed, view) = posed(&scene, Integrator::Path);
    let view = view.part(Region { x: 2, y: 3, width: 7, height: 5 }, 4..6).unwrap();
    let mut film = rendered(&Renderer::new(&packed, Traversal::default(), 1).unwrap(), &view);
    film.identity = Identity::of(scene_io::fingerprint(&scene).unwrap(), &packed, &view, Precision::Exact).unwrap();
    film
}

#[test]
fn a_film_that_was_read_is_the_one_that_was_written() {
    let film = small();
    let again = read(&written(&film)).unwrap();
    assert_eq!((again.size, again.window, again.words), (film.size, film.window, film.words));
    assert_eq!((&again.sums, &again.identity, again.secondary), (&film.sums, &film.identity, film.secondary));
    assert_eq!(again.coverage, film.coverage);
}

#[test]
fn a_film_that_is_cut_off_is_refused_wherever_that_is() {
    let bytes = written(&small());
    for length in (0..bytes.len()).step_by(3) {
        assert!(read(&bytes[..length]).is_err(), "{length} of {}", bytes.len());
    }
    assert!(read(&[&bytes[..], &[0]].concat()).is_err());
    assert!(read(b"P6 1 1").unwrap_err().message().contains("no film"));
}

#[test]
fn films_of_other_pictures_are_refused_by_name() {
    let scene = cornell();
    let identity = |scene: &Scene, change: &dyn Fn(&mut Settings), precision| {
        let mut settings = scene.settings;
        change(&mut settings);
        let packed = Job::new(scene, settings, Bvh::Fast.quality()).unwrap();
        let view = View::new(&packed, &scene.cameras[0]).unwrap();
        Identity::of(scene_io::fingerprint(scene).unwrap(), &packed, &view, precision).unwrap()
    };
    let as_it_is = |_: &mut Settings| ();
    let own = identity(&scene, &as_it_is, Precision::Exact);
    let mut painted = scene.clone();
    painted.materials[0].diffuse.x *= 0.5;
    let mut turned = scene.clone();
    turned.cameras[0].eye.x += 0.1;
    for (what, other) in [
        ("scene", identity(&painted, &as_it_is, Precision::Exact)),
        ("camera", identity(&turned, &as_it_is, Precision::Exact)),
        ("precision", identity(&scene, &as_it_is, Precision::Reference)),
        ("size", identity(&scene, &|settings| settings.size.0 += 1, Precision::Exact)),
        ("bounces", identity(&scene, &|settings| settings.bounces += 1, Precision::Exact)),
        ("seed", identity(&scene, &|settings| settings.transport.seed += 1, Precision::Exact)),
        ("sampler", identity(&scene, &|settings| settings.sampler = scene::Sampler::Random, Precision::Exact)),
        ("filter", identity(&scene, &|settings| settings.filter = scene::Filter::Nearest, Precision::Exact)),
    ] {
        let Err(Error::OtherFilm { what: found, .. }) = own.check(&other) else { panic!("{what} is not told") };
        // A camera's lens is for an image's size.
        assert!(found == what || (what == "size" && found == "camera"), "{what}: {found}");
    }
    // More samples are of the same picture, where their places do not depend on how many there are.
    assert!(own.check(&identity(&scene, &|settings| settings.spp *= 4, Precision::Exact)).is_ok());
    let grid = |edge: u32| {
        let regular = move |settings: &mut Settings| {
            (settings.samples, settings.spp, settings.sampler) = (edge, 0, scene::Sampler::Jittered);
        };
        identity(&scene, &regular, Precision::Exact)
    };
    assert!(grid(2).check(&grid(3)).is_err());
}

#[test]
fn films_that_have_samples_in_common_are_refused_and_stay_as_they_are() {
    let film = small();
    let mut other = film.clone();
    let error = other.merge(film.clone()).unwrap_err().message();
    assert!(error.contains("samples 4 to 6 of the 7x5 pixels at 2,3"), "{error}");
    assert_eq!(other.sums, film.sums);
}
