//! `render --denoise`.

mod program;

use eyerays::denoise::Oidn;
use eyerays::image;
use program::{Place, shipped};

fn rendered(place: &Place, spp: &str, more: &[&str]) {
    let scene = shipped("cornell_path");
    let render = ["render", &scene, "--device", "cpu", "--size", "48x36", "--spp", spp, "--sampler", "sobol"];
    place.succeed(&[&render[..], more].concat());
}

/// The root mean square of what a picture is off from another.
fn off(place: &Place, picture: &str, other: &str) -> f64 {
    let told = place.run(&["diff", picture, other, "--json"]).json();
    told["comparison"]["rmse"].as_f64().expect("a number")
}

/// Beside many samples, which are other ones, it is nearer than what it was made of; that is a layer, bit for bit.
#[test]
fn noise_is_taken_off_and_the_noisy_picture_kept() {
    let place = Place::new(&[]);
    rendered(&place, "1024", &["--seed", "5", "-o", "many.exr"]);
    rendered(&place, "16", &["-o", "noisy.exr"]);
    rendered(&place, "16", &["-o", "denoised.exr", "--denoise"]);
    rendered(&place, "16", &["-o", "denoised.png", "--denoise"]);
    let [noisy, denoised] = ["noisy.exr", "denoised.exr"].map(|picture| off(&place, picture, "many.exr"));
    println!("{noisy:.4} became {denoised:.4}");
    assert!(denoised < 0.8 * noisy, "{noisy} became {denoised}");
    let kept = image::read_layer(&place.path("denoised.exr"), "noisy").unwrap();
    assert!(kept.bits_equal(&image::read(&place.path("noisy.exr")).unwrap()));
    let shown = image::read(&place.path("denoised.png")).unwrap();
    assert!(!shown.bits_equal(&image::read(&place.path("noisy.exr")).unwrap()));
}

/// Kept films go on and are denoised once they are whole; parts are not.
#[test]
fn only_whole_pictures_with_noise_are_denoised() {
    let place = Place::new(&[]);
    rendered(&place, "4", &["-o", "kept.film"]);
    rendered(&place, "4", &["-o", "a.exr", "--reproducible", "--denoise", "--checkpoint", "kept.film", "--resume"]);
    rendered(&place, "4", &["-o", "b.exr", "--reproducible", "--denoise"]);
    let [a, b] = ["a.exr", "b.exr"].map(|name| image::read(&place.path(name)).unwrap());
    assert!(a.bits_equal(&b));
    let scene = shipped("cornell_path");
    let refused =
        |more: &[&str], want: &str| place.refuse(&[&["render", &scene, "--device", "cpu"], more].concat(), &[want]);
    refused(&["--integrator", "whitted", "--denoise", "-o", "c.png"], "emits light");
    refused(&["--denoise", "-o", "c.film"], "--denoise are for pictures, not for films");
    let whitted = shipped("whitted");
    place.refuse(
        &["render", &whitted, "--denoise", "--device", "cpu", "-o", "c.png"],
        &["whitted have no noise; leave it out"],
    );
    let single = ["render", &scene, "--denoise", "--device", "cpu", "--size", "8x8", "--spp", "1", "-o", "c.png"];
    place.refuse(&single, &["render two or more"]);
}

/// Where it is not, a line says so before anything is rendered.
#[test]
fn open_image_denoise_is_taken_where_it_is_found() {
    let place = Place::new(&[]);
    let scene = shipped("cornell_path");
    let render = ["render", &scene, "--device", "cpu", "--size", "48x36", "--spp", "16", "--sampler", "sobol"];
    let render = [&render[..], &["--denoise=oidn", "-o", "oidn.exr", "--json"]].concat();
    let Ok(oidn) = Oidn::find() else {
        place.refuse(&render, &["OpenImageDenoise", "is not found: install it"]);
        return;
    };
    let told = place.succeed(&render).json();
    assert_eq!(told["picture"]["denoised"], format!("Open Image Denoise {}", oidn.version()));
    rendered(&place, "1024", &["--seed", "5", "-o", "many.exr"]);
    let kept = image::read_layer(&place.path("oidn.exr"), "noisy").unwrap();
    let many = image::read(&place.path("many.exr")).unwrap();
    let noisy = eyerays::compare::compare(&kept, &many).unwrap().rmse;
    assert!(off(&place, "oidn.exr", "many.exr") < 0.8 * noisy);
}
