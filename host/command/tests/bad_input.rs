//! Whatever is wrong with what the program is given: one line that says what and where, exit code 2, and
//! nothing half-written.

mod program;

use std::fs;

use program::{Place, SCENE, TRIANGLE, has_gpu};

#[test]
fn missing_files_folders_and_unknown_kinds() {
    let place = Place::new(&[("mesh.stl", "solid\n"), ("scene", SCENE)]);
    fs::create_dir(place.path("folder.toml")).unwrap();
    place.refuse_scene("missing.toml", &["no such file"]);
    place.refuse_scene("missing.obj", &["no such file"]);
    place.refuse_scene("missing/scene.toml", &["no such file"]);
    place.refuse_scene("folder.toml", &["folder"]);
    place.refuse_scene("mesh.stl", &["unknown kind", ".toml", ".obj"]);
    place.refuse_scene("scene", &["unknown kind"]);
}

#[cfg(unix)]
#[test]
fn unreadable_files() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new(&[("secret.obj", TRIANGLE), ("secret.toml", SCENE)]);
    for name in ["secret.obj", "secret.toml"] {
        fs::set_permissions(place.path(name), fs::Permissions::from_mode(0o000)).unwrap();
        if fs::read(place.path(name)).is_ok() {
            return eprintln!("skipped: this user may read every file");
        }
        place.refuse_scene(name, &["no permission to read"]);
    }
}

#[test]
fn empty_files_and_files_without_triangles() {
    let place = Place::new(&[
        ("empty.obj", ""),
        ("empty.toml", ""),
        ("blank.toml", "\n\n"),
        ("points.obj", "v 0 0 0\nv 1 0 0\n"),
        ("nothing.toml", "[render]\nsize = [8, 8]\n"),
        ("mesh_of_points.toml", "[[mesh]]\nfile = \"points.obj\"\n"),
    ]);
    place.refuse_scene("empty.obj", &["empty"]);
    place.refuse_scene("empty.toml", &["empty"]);
    place.refuse_scene("blank.toml", &["no [[mesh]]"]);
    place.refuse_scene("points.obj", &["no face"]);
    place.refuse_scene("nothing.toml", &["no [[mesh]]"]);
    place.refuse(&["check", "mesh_of_points.toml"], &["points.obj", "no face"]);
}

#[test]
fn faces_of_vertices_that_do_not_exist() {
    for (index, why) in [
        ("4", "vertex 4 does not exist, 3 precede"),
        ("0", "vertex 0 does not exist"),
        ("-4", "vertex -4 does not exist"),
        ("4294967297", "does not exist"),
        ("99999999999999999999", "no whole number"),
        ("x", "no whole number"),
    ] {
        let mesh = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {index}\n");
        Place::new(&[("mesh.obj", &mesh)]).refuse_scene("mesh.obj", &["mesh.obj:4: ", why]);
    }
}

#[test]
fn coordinates_that_are_no_finite_numbers() {
    for word in ["nan", "inf", "-inf", "1e39", "-1e39"] {
        let mesh = TRIANGLE.replace("v 1 0 0", &format!("v 1 {word} 0"));
        Place::new(&[("mesh.obj", &mesh)]).refuse_scene("mesh.obj", &["mesh.obj:2: ", word, "no finite number"]);
        let scene = format!("{SCENE}center = [0, {word}, 0]\n");
        let lines = scene.lines().count();
        Place::new(&[("scene.toml", &scene)]).refuse_scene("scene.toml", &[&format!("scene.toml:{lines}: "), "finite"]);
    }
}

#[test]
fn a_strict_check_takes_a_warning_for_an_error() {
    let place = Place::new(&[
        ("mesh.obj", &format!("mtllib mesh.mtl\nusemtl red\n{TRIANGLE}")),
        ("mesh.mtl", "newmtl red\nKd 1 0\n"),
    ]);
    let outcome = place.succeed(&["check", "mesh.obj"]);
    assert!(outcome.stderr.starts_with("warning: mesh.mtl:2: Kd (Kd takes three numbers"), "{}", outcome.stderr);
    let outcome = place.run(&["check", "mesh.obj", "--strict"]);
    assert_eq!((outcome.code, outcome.stdout.len()), (Some(2), 0));
    let lines: Vec<&str> = outcome.stderr.lines().collect();
    assert!(
        lines.len() == 2 && lines[1].starts_with("error: mesh.obj: 1 warning under --strict"),
        "{}",
        outcome.stderr
    );
    place.refuse(&["check", "mesh.obj", "--strict", "--quiet"], &["1 warning under --strict"]);
    Place::new(&[("mesh.obj", TRIANGLE)]).succeed(&["check", "mesh.obj", "--strict"]);
}

#[test]
fn names_that_leave_the_folder_of_their_file_are_read_only_where_that_is_allowed() {
    let outside = Place::new(&[("secret.mtl", "newmtl red\nKd 1 0\n")]);
    std::fs::create_dir(outside.path("model")).unwrap();
    let absolute = outside.path("secret.mtl").display().to_string();
    for name in ["../secret.mtl", "sub/../../secret.mtl", "..\\secret.mtl", &absolute] {
        std::fs::write(outside.path("model/mesh.obj"), format!("{TRIANGLE}mtllib {name}\n")).unwrap();
        std::fs::create_dir_all(outside.path("model/sub")).unwrap();
        let check = ["check", "model/mesh.obj"];
        let said = outside.succeed(&check).stderr;
        assert!(said.contains("mesh.obj:5: material file") && said.contains("not found"), "{said}");
        let said = outside.succeed(&[&check[..], &["--allow-outside"]].concat()).stderr;
        assert!(said.contains("secret.mtl:2: Kd (Kd takes three numbers"), "{said}");
    }
}

#[test]
fn a_scene_may_name_any_path_and_its_meshes_may_not() {
    let outside = Place::new(&[("mesh.obj", TRIANGLE)]);
    let name = outside.path("mesh.obj").display().to_string();
    let place = Place::new(&[("scene.toml", &format!("[[mesh]]\nfile = {name:?}\n"))]);
    place.succeed(&["check", "scene.toml"]);
}

#[test]
fn misspelt_keys_and_sections() {
    for (from, to, want) in [
        ("size", "sise", ["scene.toml:2: ", "\"sise\"", "\"size\""]),
        ("target", "tarjet", ["scene.toml:7: ", "\"tarjet\"", "\"target\""]),
        ("[render]", "[rendr]", ["scene.toml:1: ", "\"rendr\"", "\"render\""]),
        ("\"sphere\"", "\"spere\"", ["scene.toml:10: ", "\"spere\"", "\"sphere\""]),
    ] {
        Place::new(&[("scene.toml", &SCENE.replace(from, to))]).refuse_scene("scene.toml", &want);
    }
    let broken = SCENE.replace("size = [24, 18]", "size = [24, 18");
    Place::new(&[("scene.toml", &broken)]).refuse_scene("scene.toml", &["scene.toml:"]);
}

#[test]
fn cameras_that_look_at_themselves() {
    let scene = SCENE.replace("target = [0, 0, 0]", "target = [0, 0, 4]");
    Place::new(&[("scene.toml", &scene)]).refuse_scene("scene.toml", &["scene.toml:7: ", "camera \"front\"", "move"]);
    let place = Place::new(&[("scene.toml", SCENE)]);
    let render = ["render", "scene.toml", "-o", "out.png", "--eye", "1,2,3", "--target", "1,2,3"];
    place.refuse(&render, &["--eye", "--target", "looks at itself"]);
}

#[test]
fn pictures_of_no_size_or_too_large() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    for (size, why) in
        [("0x0", "empty"), ("0x9", "empty"), ("100000x100000", "too large"), ("4294967295x4294967295", "too large")]
    {
        place.refuse(&["render", "scene.toml", "-o", "out.png", "--size", size], &[size, why]);
    }
    for size in ["[0, 0]", "[100000, 100000]", "[30000, 30000]"] {
        let scene = SCENE.replace("[24, 18]", size);
        Place::new(&[("scene.toml", &scene)]).refuse_scene("scene.toml", &[]);
    }
}

#[test]
fn outputs_that_cannot_be_written() {
    let place = Place::new(&[("scene.toml", SCENE), ("file", "")]);
    fs::create_dir(place.path("folder.png")).unwrap();
    for (output, why) in [
        ("missing/out.png", "the folder does not exist"),
        ("file/out.png", "the folder does not exist"),
        ("folder.png", "is a directory"),
        ("out.jpg", "\"jpg\""),
        ("out", "no extension"),
        ("", ""),
    ] {
        place.refuse(&["render", "scene.toml", "-o", output], &[output, why]);
        place.refuse(&["diff", "a.png", "b.png", "-o", output], &[output, why]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let full = ["render", "scene.toml", "--device", "cpu", "-o", "/dev/full"];
    place.refuse(&full, &["/dev/full", "no space left"]);
    let stdout = fs::File::options().write(true).open("/dev/full").unwrap();
    let mut command = place.command(&["render", "scene.toml", "--device", "cpu", "-o", "-"]);
    let output = command.stdout(stdout).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("standard output: no space left"));
}

#[cfg(unix)]
#[test]
fn a_read_only_picture_stays() {
    use std::os::unix::fs::PermissionsExt;
    let place = Place::new(&[("scene.toml", SCENE), ("out.png", "precious")]);
    fs::set_permissions(place.path("out.png"), fs::Permissions::from_mode(0o400)).unwrap();
    if fs::File::options().write(true).open(place.path("out.png")).is_ok() {
        return eprintln!("skipped: this user may write every file");
    }
    place.refuse(&["render", "scene.toml", "-o", "out.png"], &["out.png", "no permission"]);
}

#[test]
fn adapters_that_do_not_exist() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    for adapter in ["nosuch", "99"] {
        let render = ["render", "scene.toml", "-o", "out.png", "--adapter", adapter];
        let named = format!("no adapter matches \"{adapter}\"");
        let why = if has_gpu() { named.as_str() } else { "there is no GPU" };
        place.refuse(&render, &[why]);
        place.refuse(&[&render[..], &["--device", "gpu"]].concat(), &[why]);
        place.refuse(&["diff", "scene.toml", "--adapter", adapter], &[why]);
    }
}

/// Vulkan's loader alone is asked on Linux, so that a machine can be made to have no GPU.
#[cfg(target_os = "linux")]
#[test]
fn machines_without_a_gpu() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    let bare = |arguments: &[&str]| {
        let mut command = place.command(arguments);
        command.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent");
        command
    };
    let why = ["there is no GPU", "--device cpu"];
    place.refuse_run(&mut bare(&["render", "scene.toml", "-o", "out.png", "--device", "gpu"]), &why);
    place.refuse_run(&mut bare(&["diff", "scene.toml"]), &why);
    let auto = bare(&["render", "scene.toml", "-o", "out.png"]).output().unwrap();
    let summary = String::from_utf8(auto.stderr).unwrap();
    assert!(auto.status.success() && summary.contains("CPU") && summary.contains(why[0]), "{summary}");
    let info = bare(&["info"]).output().unwrap();
    assert!(info.status.success() && String::from_utf8_lossy(&info.stdout).contains("no GPU"));
}

/// On devices whose buffers four million triangles fill, such as lavapipe's.
#[test]
fn meshes_larger_than_the_buffers_of_a_device() {
    if !has_gpu() {
        return;
    }
    let sphere = "[[mesh]]\nshape = \"sphere\"\nsubdivisions = 8\n";
    let place = Place::new(&[("scene.toml", &sphere.repeat(3))]);
    let buffer = place.succeed(&["info", "--json"]).json()["adapters"][0]["max_binding"].as_u64().unwrap();
    let size = 3 * 20 * 4u64.pow(8) * 48;
    if buffer >= size {
        return eprintln!("skipped: buffers of {buffer} bytes hold the mesh");
    }
    let render = "render scene.toml -o out.png --device gpu --bvh fast --size 8x8 --instances never";
    let render: Vec<&str> = render.split(' ').collect();
    place.refuse(&render, &["primitives", &size.to_string(), &buffer.to_string(), "--device cpu"]);
}

#[test]
fn outputs_that_would_replace_an_input() {
    let mesh = format!("mtllib mesh.mtl\n{TRIANGLE}");
    let meshes = "[[mesh]]\nfile = \"mesh.obj\"\n";
    let place = Place::new(&[
        ("scene.toml", SCENE),
        ("kept.png", "samples = 1\n"),
        ("mesh.obj", &mesh),
        ("mesh.mtl", "newmtl red\n"),
        ("meshes.toml", meshes),
    ]);
    let render = ["render", "scene.toml", "--device", "cpu", "-o"];
    for name in ["a.png", "b.png"] {
        place.succeed(&[&render[..], &[name]].concat());
        place.refuse(&["diff", "a.png", "b.png", "-o", name], &[name, "would replace the input"]);
    }
    place.refuse(&[&render[..], &["./kept.png", "--settings", "kept.png"]].concat(), &["kept.png", "would replace"]);
    let bench = ["bench", "scene.toml", "--device", "cpu", "--format", "json", "-o", "scene.toml"];
    place.refuse(&bench, &["scene.toml", "would replace"]);
    for name in ["mesh.obj", "./mesh.mtl"] {
        let bench = ["bench", "meshes.toml", "--device", "cpu", "--format", "json", "-o", name];
        place.refuse(&bench, &[name, "would replace the input"]);
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("scene.toml", place.path("link.png")).unwrap();
        place.refuse(&[&render[..], &["link.png"]].concat(), &["link.png", "would replace the input scene.toml"]);
    }
}

#[test]
fn options_that_contradict_each_other() {
    let place = Place::new(&[("scene.toml", SCENE), ("a.png", "")]);
    for (options, wants) in [
        (&["--device", "gpu", "--precision", "reference"][..], &["--device cpu", "--precision exact"][..]),
        (&["--no-passthrough"], &["--precision fast"]),
        (&["--scheduling", "persistent", "--method", "packet"], &["--scheduling persistent", "if-if"]),
        (&["--triangle", "moller"], &["--triangle moller", "--precision fast"]),
        (&["--triangle", "moller", "--precision", "reference"], &["--triangle moller", "--precision fast"]),
        (&["--device", "cpu", "--precision", "fast", "--triangle", "moller"], &["--triangle moller", "--device cpu"]),
        (&["--device", "cpu", "--adapter", "0"], &["--adapter"]),
        (&["--json", "-o", "-"], &["--json", "name a file"]),
        (&["--half", "-o", "a.hdr"], &["--half", ".exr"]),
        (&["--half"], &["--half", ".exr"]),
        (&["--tone", "agx", "-o", "a.exr"], &["--tone", "EXR", ".png"]),
        (&["--tone", "neutral", "-o", "a.hdr"], &["--tone", "HDR", ".png"]),
        (&["--layers", "depth", "-o", "a.png"], &["--layers", "PNG", ".exr"]),
        (&["--layers", "colour", "-o", "-"], &["--layers", "PNG", ".exr"]),
    ] {
        place.refuse(&[&["render", "scene.toml"], options].concat(), wants);
    }
    place.refuse(&["diff", "scene.toml", "--precision", "reference"], &["reference precision"]);
    place.refuse(&["diff", "a.png"], &["a.png", "second"]);
}

#[test]
fn options_out_of_range() {
    let place = Place::new(&[("scene.toml", SCENE)]);
    for [option, value] in [
        ["--samples", "0"],
        ["--samples", "65"],
        ["--bounces", "65536"],
        ["--min-contribution", "1.5"],
        ["--min-contribution", "nan"],
        ["--fov", "0"],
        ["--fov", "180"],
        ["--fov", "nan"],
        ["--threads", "0"],
        ["--threads", "100000"],
        ["--exposure", "1000"],
        ["--exposure", "nan"],
        ["--bits", "12"],
        ["--camera", "nosuch"],
        ["--camera", "7"],
    ] {
        place.refuse(&["render", "scene.toml", "-o", "out.png", option, value], &[]);
    }
    place.refuse(&["render", "scene.toml", "--camera", "nosuch"], &["scene.toml: ", "\"nosuch\"", "0 \"front\""]);
    place.refuse(&["render", "scene.toml", "--camera", "1"], &["scene.toml: ", "\"1\"", "0 \"front\""]);
}

#[test]
fn pictures_that_cannot_be_compared() {
    let place = Place::new(&[("scene.toml", SCENE), ("text.png", "no picture")]);
    place.succeed(&["render", "scene.toml", "--device", "cpu", "-o", "a.png"]);
    place.succeed(&["render", "scene.toml", "--device", "cpu", "-o", "b.png", "--size", "23x18"]);
    place.refuse(&["diff", "a.png", "missing.png"], &["missing.png", "no such file"]);
    place.refuse(&["diff", "a.png", "text.png"], &["text.png"]);
    place.refuse(&["diff", "a.png", "b.png", "-o", "map.png"], &["24x18", "23x18"]);
    place.refuse(&["diff", "a.png", "b.png", "--flip"], &["24x18", "23x18"]);
    place.refuse(&["diff", "a.png", "a.png", "--flip-map", "map.txt"], &["map.txt", ".png"]);
    place.refuse(&["diff", "a.png", "a.png", "--flip-map", "a.png"], &["a.png", "would replace"]);
    place.refuse(&["diff", "a.png", "a.png", "--flip-map", "c.png", "-o", "c.png"], &["c.png", "same file"]);
    place.refuse(&["diff", "a.png", "a.png", "--flip-map", "-", "-o", "-"], &["--flip-map -", "name a file"]);
    place.refuse(&["diff", "a.png", "a.png", "--flip-map", "-", "--json"], &["--json", "name a file"]);
    place.refuse(&["diff", "a.png", "a.png", "--tolerance=-1"], &["--tolerance"]);
    place.refuse(&["diff", "a.png", "a.png", "--tolerance", "nan"], &["--tolerance"]);
}

#[test]
fn lights_and_cameras_beyond_all_numbers() {
    let light = format!("{SCENE}\n[[light]]\nkind = \"point\"\nposition = [1e38, 0, 0]\n");
    let place = Place::new(&[("scene.toml", &light)]);
    place.refuse_scene("scene.toml", &["light 1", "too far"]);
    place.refuse(&["info", "scene.toml"], &["scene.toml: light 1", "too far"]);
}

#[test]
fn benchmarks_that_can_not_be() {
    let dark = SCENE.replace("[[mesh]]", "[[nothing]]");
    let place = Place::new(&[("scene.toml", SCENE), ("dark.toml", &dark), ("old.md", "an older table")]);
    for (more, wants) in [
        (&["missing.toml"][..], &["missing.toml", "no such file"][..]),
        (&["dark.toml"], &["dark.toml"]),
        (&["--camera", "back"], &["scene.toml", "\"back\"", "0 \"front\""]),
        (&["-o", "table.txt"], &["table.txt", ".md", ".csv", ".json"]),
        (&["-o", "missing/table.md"], &["missing/table.md", "folder does not exist"]),
        (&["--size", "0x10"], &["0x10"]),
        (&["--size", "8192x8192"], &["8192x8192", "16777216 pixels"]),
        (&["--ao-length", "0"], &["--ao-length"]),
        (&["--ao-length", "inf"], &["--ao-length"]),
        (&["--stack-max", "64"], &["--stack-max 64"]),
        (&["--cut", "101"], &["--cut 101"]),
        (&["--threads", "0"], &["--threads 0"]),
        (&["--adapter", "0"], &["--adapter", "--device cpu"]),
    ] {
        place.refuse(&[&["bench", "scene.toml", "--device", "cpu"], more].concat(), wants);
    }
    place.refuse(&["bench", "missing.toml", "--device", "cpu", "-o", "old.md"], &["missing.toml"]);
    for more in [&["--repeat", "0"][..], &["--methods", "fastest"], &["--kinds", ""], &["--precision", "reference"]] {
        let outcome = place.run(&[&["bench", "scene.toml", "--device", "cpu"], more].concat());
        assert_eq!(outcome.code, Some(2), "{more:?}");
        assert!(outcome.stdout.is_empty() && outcome.stderr.starts_with("error: "), "{}", outcome.stderr);
    }
    assert_eq!(place.run(&["bench"]).code, Some(2));
}
