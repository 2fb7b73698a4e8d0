//! The program as a person runs it: a process in a folder of its own.

// Every test program compiles this file and uses its own share of it.
#![allow(dead_code)]

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// One triangle.
pub const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A scene file of one triangle with a camera; more can be appended.
pub const SCENE: &str = "[render]\nsize = [24, 18]\n\n[[camera]]\nname = \"front\"\neye = [0, 0, 4]\ntarget = [0, 0, 0]\n\n\
    [[mesh]]\nshape = \"sphere\"\nsubdivisions = 1\n";

/// What a run left.
pub struct Outcome {
    pub code: Option<i32>,
    pub stdout: Vec<u8>,
    pub stderr: String,
}

impl Outcome {
    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.stdout).expect("text on standard output")
    }

    pub fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.stdout).expect("JSON on standard output")
    }
}

impl From<Output> for Outcome {
    fn from(output: Output) -> Self {
        let stderr = String::from_utf8(output.stderr).expect("text on standard error");
        Outcome { code: output.status.code(), stdout: output.stdout, stderr }
    }
}

/// A folder that the program runs in, gone after the test.
pub struct Place(TempDir);

impl Place {
    pub fn new(files: &[(&str, &str)]) -> Self {
        let place = Place(tempfile::tempdir().unwrap());
        for (name, content) in files {
            fs::write(place.path(name), content).unwrap();
        }
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The program, not yet started.
    pub fn command<A: AsRef<OsStr>>(&self, arguments: &[A]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_eyerays"));
        // A caller's wish to see a log would be more lines than the program's own.
        command.args(arguments).current_dir(self.0.path()).env_remove("RUST_LOG");
        command
    }

    pub fn run<A: AsRef<OsStr>>(&self, arguments: &[A]) -> Outcome {
        self.command(arguments).output().expect("the program starts").into()
    }

    /// Runs what must succeed.
    pub fn succeed<A: AsRef<OsStr>>(&self, arguments: &[A]) -> Outcome {
        let outcome = self.run(arguments);
        assert_eq!(outcome.code, Some(0), "{}", outcome.stderr);
        outcome
    }

    /// Runs what must be refused with one line that holds every one of `wants`, and checks that it neither
    /// leaves a file behind nor touches one.
    pub fn refuse<A: AsRef<OsStr>>(&self, arguments: &[A], wants: &[&str]) {
        self.refuse_run(&mut self.command(arguments), wants);
    }

    /// As [`Place::refuse`], of a command that was prepared.
    pub fn refuse_run(&self, command: &mut Command, wants: &[&str]) {
        let before = self.contents();
        let outcome: Outcome = command.output().expect("the program starts").into();
        assert_eq!(outcome.code, Some(2), "{command:?}: {}", outcome.stderr);
        let line = outcome.stderr.strip_suffix('\n').unwrap_or_else(|| panic!("{command:?}: no line end"));
        assert!(line.starts_with("error: ") && !line.contains('\n'), "{command:?}: no single line: {line}");
        for want in wants {
            assert!(line.contains(want), "{command:?}: {line}\nholds no {want:?}");
        }
        assert!(outcome.stdout.is_empty(), "{command:?}: wrote to standard output");
        assert_eq!(self.contents(), before, "{command:?}: files changed");
    }

    /// Renders the scene `name` where no picture is and where one is, and expects the same refusal.
    pub fn refuse_scene(&self, name: &str, wants: &[&str]) {
        let wants = [&[name], wants].concat();
        self.refuse(&["check", name], &wants);
        let render = ["render", name, "--device", "cpu", "-o", "picture.png"];
        self.refuse(&render, &wants);
        fs::write(self.path("picture.png"), "an older picture").unwrap();
        self.refuse(&render, &wants);
        fs::remove_file(self.path("picture.png")).unwrap();
    }

    /// Every file's name and bytes.
    fn contents(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let entries = fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap().path());
        let mut files: Vec<_> = entries.map(|path| (path.clone(), fs::read(path).unwrap_or_default())).collect();
        files.sort();
        files
    }

    /// Every file's name.
    pub fn names(&self) -> Vec<String> {
        let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
        self.contents().iter().map(|(path, _)| name(path)).collect()
    }
}

/// The pixels of a PNG of 8 bits: red, green, blue.
pub fn decoded(path: &Path) -> Vec<[u8; 3]> {
    let file = BufReader::new(File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    bytes.as_chunks().0.to_vec()
}

/// A scene that the project ships.
pub fn shipped(name: &str) -> String {
    format!("{}/../../scenes/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

/// Whether this machine has a GPU of any kind, as the program lists them. Without one the tests that
/// need it do nothing, unless `EYERAYS_REQUIRE_GPU` is `1`.
pub fn has_gpu() -> bool {
    let found = Place::new(&[]).succeed(&["info", "--json"]).json();
    let any = found["adapters"].as_array().is_some_and(|adapters| !adapters.is_empty());
    let required = std::env::var("EYERAYS_REQUIRE_GPU").is_ok_and(|value| value == "1");
    assert!(any || !required, "EYERAYS_REQUIRE_GPU=1, but there is no adapter");
    if !any {
        eprintln!("skipped: there is no adapter");
    }
    any
}

/// How opaque each pixel of a PNG of 8 bits is.
pub fn opacity(path: &Path) -> Vec<u8> {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    assert_eq!(reader.info().color_type, png::ColorType::Rgba);
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    pixels.chunks_exact(4).map(|pixel| pixel[3]).collect()
}
