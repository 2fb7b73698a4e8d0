//! What `info` and `check` tell.

mod program;

use std::fs;

use eyerays::job::Job;
use eyerays::scene_io;
use eyerays_bvh::Quality;
use program::{Place, SCENE, TRIANGLE, has_gpu, shipped};

#[test]
fn check_tells_what_is_in_a_scene_and_writes_nothing() {
    let place = Place::new(&[]);
    for (name, parts) in [
        ("cornell", ["2 lights", "cameras \"front\", \"inside\", \"ball\""]),
        ("whitted", ["2 triangles, 2 spheres, 3 materials, 1 light;", "mesh 2: sphere (glass), 1 sphere, ["]),
        ("glass", ["2 lights", "\"above\""]),
        ("lights", ["28 lights", "4 materials"]),
    ] {
        let outcome = place.succeed(&["check", &shipped(name)]);
        assert!(outcome.stderr.is_empty(), "{}", outcome.stderr);
        for part in parts {
            assert!(outcome.text().contains(part), "{part}: {}", outcome.text());
        }
    }
    assert!(place.names().is_empty());
}

/// The thesis' table 7.1, with the library's own numbers.
#[test]
fn info_tells_the_hierarchies_of_a_scene() {
    let place = Place::new(&[]);
    let path = shipped("whitted");
    let (scene, _) = scene_io::load(path.as_ref()).unwrap();
    let table = place.succeed(&["info", &path]);
    let json = place.succeed(&["info", &path, "--json"]).json();
    let rows = table.text().lines().skip_while(|line| !line.starts_with("BVH")).skip(1);
    let rows = rows.take_while(|line| !line.starts_with("memory of the host"));
    let rows: Vec<Vec<&str>> = rows.map(|line| line.split_whitespace().collect()).collect();
    for (row, (name, quality)) in
        [("fast", Quality::Fast), ("medium", Quality::Medium), ("high", Quality::High)].into_iter().enumerate()
    {
        let want = Job::new(&scene, scene.settings, quality).unwrap();
        let want = want.statistics();
        let counts = [want.primitives, want.nodes, want.leaves, want.depth as usize].map(|n| n.to_string());
        assert_eq!(rows[row][0], name);
        assert_eq!(rows[row][1..5], counts, "{name}");
        assert_eq!(rows[row][5], format!("{:.1}", want.sah_cost), "{name}");
        let hierarchy = &json["hierarchies"][row];
        assert_eq!(hierarchy["bvh"], name);
        for (key, count) in ["primitives", "nodes", "leaves", "depth"].into_iter().zip(counts) {
            assert_eq!(hierarchy[key].to_string(), count, "{name}, {key}");
        }
        assert!(hierarchy["node_bytes"].as_u64().unwrap() >= 64);
        assert_eq!(hierarchy["primitive_bytes"], 48 * (scene.mesh.triangles.len() + scene.spheres.len()));
    }
    assert_eq!(rows.len(), 3);
    let one = place.succeed(&["info", &path, "--bvh", "medium", "--json"]).json()["hierarchies"].take();
    assert_eq!(one.as_array().map(Vec::len), Some(1));
    assert_eq!(one[0]["bvh"], "medium");
    // What it takes of the host.
    let bytes = &json["host"]["bytes"];
    assert_eq!(bytes["primitives"], json["hierarchies"][2]["primitive_bytes"]);
    assert_eq!(bytes["the scene as read"], scene.bytes());
    let held = format!("primitives {:>40}", bytes["primitives"].as_u64().unwrap());
    assert!(table.text().lines().any(|line| line.starts_with(&held)), "{}", table.text());
    // What a GPU would run and hold for it.
    let last = table.text().lines().skip_while(|line| !line.starts_with("kernel of a GPU")).collect::<Vec<_>>();
    let kernels = json["gpu"]["kernels"].as_array().unwrap();
    assert_eq!((kernels.len(), last.len()), (8, 1 + 8 + 3), "{last:?}");
    for (kernel, line) in kernels.iter().zip(&last[1..]) {
        assert!(line.contains(kernel["name"].as_str().unwrap()), "{line}");
        assert!(line.contains(&kernel["instructions"].to_string()), "{line}");
    }
    let nodes = json["gpu"]["scene_bytes"]["hierarchy"].as_u64().unwrap();
    assert!(nodes > 0 && last[10].contains(&format!("hierarchy {nodes}")), "{last:?}");
}

/// Users place cameras and lights by these figures.
#[test]
fn check_and_info_tell_where_the_meshes_are_and_the_default_camera() {
    let place = Place::new(&[("scene.toml", &format!("{SCENE}center = [0, 2, 0]\n")), ("mesh.obj", TRIANGLE)]);
    let text = place.succeed(&["check", "scene.toml"]);
    let lines: Vec<&str> = text.text().lines().collect();
    let [_, bounds, camera, mesh, material] = lines[..] else { panic!("{lines:?}") };
    assert_eq!(material, "material 1: default");
    let json = place.succeed(&["info", "scene.toml", "--bvh", "fast", "--json"]).json();
    assert_eq!(json["meshes"][0]["triangles"], 80);
    assert_eq!(json["materials"][0], "default");
    let [least, greatest] = [0, 1].map(|corner| json["bounds"][corner][1].as_f64().unwrap());
    assert!((least - 1.0).abs() < 0.1 && (greatest - 3.0).abs() < 0.1, "{json}");
    assert!(bounds.starts_with("bounds: [") && bounds.contains("] to ["), "{bounds}");
    assert!(
        mesh.starts_with("mesh 1: sphere, 80 triangles, [") && mesh.ends_with(&bounds["bounds: ".len()..]),
        "{mesh}"
    );
    assert!(place.succeed(&["info", "scene.toml", "--bvh", "fast"]).text().contains(bounds));
    // The default camera is the one that the scene has when it names none.
    let own =
        camera.strip_prefix("default camera: ").unwrap().replace(", target", "\ntarget").replace(", fov", "\nfov");
    let (before, after) = SCENE.split_once("[[camera]]").unwrap();
    let sphere = after.split_once("[[mesh]]").unwrap().1;
    let bare = format!("{before}[[mesh]]{sphere}center = [0, 2, 0]\n");
    fs::write(place.path("bare.toml"), &bare).unwrap();
    fs::write(place.path("own.toml"), format!("{bare}\n[[camera]]\nname = \"own\"\n{own}\n")).unwrap();
    for name in ["bare", "own"] {
        let (scene, picture) = (format!("{name}.toml"), format!("{name}.exr"));
        place.succeed(&["render", &scene, "-o", &picture, "--device", "cpu"]);
    }
    place.succeed(&["diff", "bare.exr", "own.exr"]);
    assert!(
        place
            .succeed(&["check", "mesh.obj"])
            .text()
            .contains("mesh 1: mesh.obj, 1 triangle, [0.0, 0.0, 0.0] to [1.0, 1.0, 0.0]")
    );
}

#[test]
fn info_lists_what_adapters_support() {
    if !has_gpu() {
        return;
    }
    let place = Place::new(&[]);
    let text = place.succeed(&["info"]);
    for part in ["driver", "SPIR-V passthrough", "subgroup", "largest buffer"] {
        assert!(text.text().contains(part), "{}", text.text());
    }
    let adapters = place.succeed(&["info", "--json"]).json()["adapters"].take();
    for key in ["index", "name", "backend", "kind", "passthrough", "subgroup", "max_buffer", "max_binding"] {
        assert!(!adapters[0][key].is_null(), "{key}: {adapters}");
    }
}
