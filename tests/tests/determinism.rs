//! One picture, whatever the threads, the hierarchy and the tiles.

use eyerays::cpu;
use eyerays::method::Traversal;
use eyerays::picture::Picture;
use eyerays::rays::Rays;
use eyerays::view::Region;
use eyerays_bvh::Quality;
use eyerays_tests::{Posed, SAMPLED, SHIPPED, assert_same_bits, pack, pack_in, settings, shipped, traversals};

/// Edges that no tile's edge divides.
const SIZE: (u32, u32) = (83, 61);

fn render<R: cpu::Number>(posed: &Posed, threads: usize) -> (Picture, Rays) {
    cpu::render::<R>(&posed.packed, &posed.view, Traversal::default(), threads, &|_| ()).unwrap()
}

/// The same picture at 1, 2 and 7 threads, and twice with each.
fn any_number_of_threads<R: cpu::Number>() {
    for name in SHIPPED.into_iter().chain(SAMPLED) {
        let scene = shipped(name);
        let packed = pack(&scene, &scene.cameras[0], settings(&scene, SIZE, 1));
        let (picture, rays) = render::<R>(&packed, 1);
        for threads in [1, 2, 2, 7, 7] {
            let (other, counted) = render::<R>(&packed, threads);
            assert_same_bits(&picture, &other, &format!("{name}, {threads} threads"));
            assert_eq!(rays, counted, "{name}, {threads} threads");
        }
    }
}

#[test]
fn threads_change_nothing_in_exact_precision() {
    any_number_of_threads::<f32>();
}

#[test]
fn threads_change_nothing_in_reference_precision() {
    any_number_of_threads::<f64>();
}

#[test]
fn a_better_hierarchy_changes_nothing() {
    for name in SHIPPED.into_iter().chain(SAMPLED) {
        let scene = shipped(name);
        for camera in &scene.cameras {
            let of = |quality| {
                let packed = pack_in(&scene, camera, settings(&scene, SIZE, 1), quality);
                render::<f32>(&packed, 2)
            };
            let (picture, rays) = of(Quality::Fast);
            for quality in [Quality::Medium, Quality::High] {
                let what = format!("{name}, camera {}, {quality:?}", camera.name);
                let (other, counted) = of(quality);
                assert_same_bits(&picture, &other, &what);
                assert_eq!(rays, counted, "{what}");
            }
        }
    }
}

#[test]
fn another_method_changes_nothing() {
    for name in SHIPPED.into_iter().chain(SAMPLED) {
        let scene = shipped(name);
        for camera in &scene.cameras {
            let packed = pack(&scene, camera, settings(&scene, (41, 31), 1));
            let (picture, rays) = render::<f32>(&packed, 2);
            for traversal in traversals() {
                let what = format!("{name}, camera {}, {traversal:?}", camera.name);
                let (other, counted) = cpu::render::<f32>(&packed, &packed.view, traversal, 2, &|_| ()).unwrap();
                assert_same_bits(&picture, &other, &what);
                assert_eq!(rays, counted, "{what}");
            }
        }
    }
}

/// Regions of one size that cover the image, in an order that jumps about.
fn tiles((width, height): (u32, u32), (columns, rows): (u32, u32)) -> Vec<Region> {
    let tops = (0..height).step_by(rows as usize);
    let corners = tops.flat_map(|y| (0..width).step_by(columns as usize).map(move |x| (x, y)));
    let mut tiles: Vec<Region> = corners
        .map(|(x, y)| Region { x, y, width: (width - x).min(columns), height: (height - y).min(rows) })
        .collect();
    tiles.sort_by_key(|tile| (tile.x * 37 + tile.y * 101) % 64);
    tiles
}

#[test]
fn tiles_of_any_size_in_any_order_give_the_same_pixels() {
    for name in SHIPPED.into_iter().chain(SAMPLED) {
        let scene = shipped(name);
        let camera = scene.cameras.get(1).unwrap_or(&scene.cameras[0]);
        let packed = pack(&scene, camera, settings(&scene, SIZE, 3));
        let (whole, rays) = render::<f32>(&packed, 2);
        let renderer = cpu::Renderer::new(&packed, Traversal::default(), 2).unwrap();
        for size in [(83, 61), (7, 5), (64, 1), (1, 61), (16, 32)] {
            let film_of = |tile| {
                let view = packed.view.part(tile, packed.view.range()).unwrap();
                let mut film = renderer.start(&view);
                renderer.add::<f32>(&view, &mut film, view.whole(), &|_| (), &()).unwrap();
                film
            };
            let mut films = tiles(SIZE, size).into_iter().map(film_of);
            let mut film = films.next().unwrap();
            films.for_each(|tile| film.merge(tile).unwrap());
            assert_same_bits(&whole, &film.develop().unwrap(), &format!("{name}, tiles of {size:?}"));
            assert_eq!(rays, film.rays(), "{name}, tiles of {size:?}");
        }
    }
}

/// Far more threads than cores, so that some wait for the film while others have it: none may take up a further tile meanwhile.
#[test]
fn threads_that_wait_for_the_film_end() {
    let scene = shipped("cornell");
    let posed = std::sync::Arc::new(pack(&scene, &scene.cameras[0], settings(&scene, (256, 256), 1)));
    let (told, ended) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        for _ in 0..60 {
            let rendered = cpu::render::<f32>(&posed.packed, &posed.view, Traversal::default(), 24, &|_| ());
            told.send(rendered.is_ok()).unwrap();
        }
    });
    for number in 0..60 {
        let is_ok = ended.recv_timeout(std::time::Duration::from_secs(120));
        assert_eq!(is_ok, Ok(true), "rendering {number} does not end");
    }
}
