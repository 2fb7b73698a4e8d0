//! Lenses, projections, pixel filters and transparent pictures by the command line.

mod program;

use std::fs::File;
use std::io::BufReader;

use eyerays::film::Film;
use program::{Place, SCENE, opacity};

fn place() -> Place {
    Place::new(&[("scene.toml", SCENE)])
}

const RENDER: [&str; 4] = ["render", "scene.toml", "--device", "cpu"];

fn hash(place: &Place, options: &[&str]) -> String {
    let found = place.succeed(&[&RENDER, options, &["-o", "a.png", "--json"]].concat());
    found.json()["film_hash"].as_str().expect("a text").to_owned()
}

#[test]
fn options_of_a_lens_are_those_of_the_scene_file() {
    let lens = "aperture = 0.2\nfocus = 3.5\nblades = 5\n";
    let with_lens = SCENE.replace("target = [0, 0, 0]\n", &format!("target = [0, 0, 0]\n{lens}"));
    let place = Place::new(&[("scene.toml", SCENE), ("lens.toml", &with_lens)]);
    let by_options = hash(&place, &["--aperture", "0.2", "--focus", "3.5", "--blades", "5", "--samples", "3"]);
    let found = place.succeed(&["render", "lens.toml", "--device", "cpu", "--samples", "3", "-o", "b.png", "--json"]);
    assert_eq!(found.json()["film_hash"], by_options);
    // The sphere's nearest point is 3 before the eye.
    let pinhole = hash(&place, &["--samples", "3"]);
    assert_ne!(by_options, pinhole);
    assert_eq!(hash(&place, &["--samples", "3", "--aperture", "0"]), pinhole);
    let near = hash(&place, &["--aperture", "0.2", "--focus", "3", "--samples", "3"]);
    assert_ne!(near, hash(&place, &["--aperture", "0.2", "--samples", "3"]), "the target is the default");
}

/// A wall straight across the view, whose distance is known: any pixel of it will do.
#[test]
fn a_lens_is_sharp_where_a_pixel_shows_something() {
    let wall = "[[mesh]]\nshape = \"quad\"\ncorners = [[-9, -9, -2], [9, -9, -2], [9, 9, -2], [-9, 9, -2]]\n";
    let place = Place::new(&[("scene.toml", &format!("{SCENE}\n{wall}"))]);
    let options = |focus: [&'static str; 2]| [&["--aperture", "0.3", "--samples", "2"][..], &focus].concat();
    let by_distance = hash(&place, &options(["--focus", "6"]));
    assert_eq!(hash(&place, &options(["--focus-on", "1,2"])), by_distance);
    assert_ne!(hash(&place, &options(["--focus-on", "12,9"])), by_distance, "there the sphere is nearer");
}

#[test]
fn what_no_camera_has_is_refused_in_a_line() {
    let place = place();
    let refused =
        |options: &[&str], wants: &[&str]| place.refuse(&[&RENDER, options, &["-o", "a.png"]].concat(), wants);
    refused(&["--focus", "2"], &["--focus: the camera has no lens; add --aperture or --f-stop"]);
    refused(&["--aperture", "-1"], &["--aperture -1 is no radius"]);
    refused(&["--aperture", "0.1", "--focus", "0"], &["--focus 0 is no distance"]);
    refused(&["--aperture", "0.1", "--blades", "2"], &["--blades 2: a lens has 3 to 32, or 0"]);
    refused(&["--aperture", "0.1", "--focus-on", "0,0"], &["--focus-on 0,0: the picture shows nothing there"]);
    refused(&["--aperture", "0.1", "--focus-on", "99,0"], &["is not within"]);
    refused(&["--aperture", "0.1", "--projection", "fisheye"], &["has no lens"]);
    refused(&["--projection", "equirectangular", "--fov", "90"], &["--fov: an equirectangular image shows all around"]);
    refused(&["--projection", "fisheye", "--fov", "361"], &["--fov 361 is not between 0 and 360"]);
    let radiance = [&RENDER[..], &["--transparent", "-o", "a.hdr"]].concat();
    place.refuse(&radiance, &["--transparent is for .png and .exr files, not for HDR; leave it out or write .exr"]);
}

#[test]
fn keys_of_a_lens_without_one_are_refused_by_their_line() {
    for (keys, want) in [
        ("focus = 3.0", "focus is of a lens; set aperture or f_stop, too"),
        ("aperture = 0.1\nf_stop = 2.0", "f_stop says the aperture; remove one of both"),
        ("aperture = 0.1\nblades = 2", "at least 3 blades"),
        ("aperture = 0.1\nfocus_on = [0, 0, 9]", "is to be sharp behind its eye"),
        ("aperture = -0.1", "\"aperture\" must be a finite number of at least 0"),
        ("projection = \"fisheye\"\naperture = 0.1", "an image of all around has no lens"),
        ("projection = \"equirectangular\"\nfov = 90", "an equirectangular camera has no fov"),
        ("projection = \"fisheye\"\nshift_x = 0.1", "can't be shifted"),
        ("mapping = \"equisolid\"", "this is of a fisheye"),
        ("fov = 40\nfocal_length = 50", "a focal_length says the fov"),
        ("orthographic = 2\nf_stop = 2", "f_stop is of a perspective camera"),
    ] {
        let scene = SCENE.replace("target = [0, 0, 0]\n", &format!("target = [0, 0, 0]\n{keys}\n"));
        Place::new(&[("scene.toml", &scene)]).refuse_scene("scene.toml", &["scene.toml:", want]);
    }
}

/// A PNG has the light of what is opaque by itself, an EXR what a share of the pixel sends; parts come together as ever.
#[test]
fn transparent_pictures_tell_how_opaque_they_are() {
    let place = Place::new(&[("scene.toml", &format!("ambient = [1, 1, 1]\n{SCENE}"))]);
    let render = |options: &[&str]| place.succeed(&[&RENDER, options].concat());
    render(&["--transparent", "--samples", "4", "-o", "a.png"]);
    let reader = png::Decoder::new(BufReader::new(File::open(place.path("a.png")).unwrap()));
    let mut reader = reader.read_info().unwrap();
    assert_eq!(reader.info().color_type, png::ColorType::Rgba);
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    let pixels: Vec<&[u8]> = pixels.chunks(4).collect();
    assert_eq!(pixels[0], [0, 0, 0, 0]);
    assert!(pixels.iter().any(|pixel| pixel[3] == 255) && pixels.iter().any(|pixel| (1..255).contains(&pixel[3])));
    // In light from everywhere a sphere has no dark edge: straight colours do not fade.
    let bright = pixels.iter().filter(|pixel| pixel[3] > 0).map(|pixel| pixel[0]).min().unwrap();
    assert!(bright > 20, "{bright}");
    let film = |name: &'static str, more: &[&str]| {
        render(&[&["--transparent", "--samples", "2", "-o", name], more].concat());
    };
    film("left.film", &["--tile", "0,0,11,18"]);
    film("right.film", &["--tile", "11,0,13,18"]);
    film("whole.film", &[]);
    place.succeed(&["merge", "right.film", "left.film", "-o", "merged.film"]);
    let developed = |name| Film::read(&mut File::open(place.path(name)).unwrap()).unwrap().develop().unwrap();
    let (merged, whole) = (developed("merged.film"), developed("whole.film"));
    assert!(merged.alpha.is_some() && merged.bits_equal(&whole) && merged.hash() == whole.hash());
    place.refuse(&["merge", "left.film", "right.film", "-o", "merged.hdr"], &["for .png and .exr files"]);
}

#[test]
fn filters_are_those_of_their_names() {
    let place = place();
    let of = |name| hash(&place, &["--samples", "4", "--pixel-filter", name]);
    let names = ["box", "tent", "gaussian", "blackman-harris"];
    let hashes = names.map(of);
    assert_eq!(hashes[0], hash(&place, &["--samples", "4"]), "whitted's own");
    assert!((0..4).all(|i| !hashes[i + 1..].contains(&hashes[i])));
    let path = ["--integrator", "path", "--sampler", "sobol", "--spp", "4"];
    let own = hash(&place, &path);
    assert_eq!(own, hash(&place, &[&path[..], &["--pixel-filter", "blackman-harris"]].concat()));
    assert_ne!(own, hash(&place, &[&path[..], &["--pixel-filter", "box"]].concat()));
}

/// What films keep of shadow catchers and holes goes through files: parts come together, and so does what noise decides about.
#[test]
fn films_of_shadow_catchers_are_kept_and_merged() {
    let floor =
        "[[mesh]]\nshape = \"quad\"\ncorners = [[-3, -1, 3], [3, -1, 3], [3, -1, -3], [-3, -1, -3]]\ncatcher = true\n";
    let lit = SCENE.replace(
        "[render]\n",
        "[background]\ncolor = [1, 1, 1]\n\n[render]\nintegrator = \"path\"\nsampler = \"sobol\"\n",
    );
    let place = Place::new(&[("scene.toml", &format!("{lit}\n{floor}"))]);
    let render = |options: &[&str]| place.succeed(&[&RENDER, options].concat());
    render(&["--spp", "7", "-o", "whole.png"]);
    render(&["--spp", "7", "--samples-from", "0", "--samples-to", "3", "-o", "a.film"]);
    render(&["--spp", "7", "--samples-from", "3", "--samples-to", "7", "-o", "b.film"]);
    place.succeed(&["merge", "b.film", "a.film", "-o", "merged.png"]);
    let [whole, merged] = ["whole.png", "merged.png"].map(|name| opacity(&place.path(name)));
    assert_eq!(merged, whole);
    assert!(whole.iter().any(|alpha| (25..230).contains(alpha)));

    let noise = ["--noise", "0.2", "--spp", "96"];
    render(&[&noise[..], &["-o", "noisy.png"]].concat());
    render(&[&noise[..], &["-o", "noisy.film"]].concat());
    place.succeed(&["merge", "noisy.film", "-o", "again.png"]);
    let [noisy, again] = ["noisy.png", "again.png"].map(|name| opacity(&place.path(name)));
    assert_eq!(again, noisy);
}
