//! Files that ask for more memory than there is, or than they are worth: refused in a line, or read without it.
#![cfg(target_os = "linux")]

mod program;

use std::fs;
use std::io::{Read, Write};
use std::process::Command;

use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use flate2::{Compress, Compression, Crc, FlushCompress};
use program::{Outcome, Place, TRIANGLE, shipped};

/// What a refusal ends with where the limit is `ulimit -v`.
const TAKEN: &str = "the limit on address space (ulimit -v) leaves ";

/// The program with so many kilobytes of address space, not yet started.
fn limited(place: &Place, kilobytes: u32, arguments: &[&str]) -> Command {
    let program = place.command(arguments);
    let mut limited = Command::new("sh");
    limited.args(["-c", &format!("ulimit -v {kilobytes}; exec \"$0\" \"$@\"")]).arg(program.get_program());
    limited.args(program.get_args()).current_dir(place.path("")).env_remove("RUST_LOG");
    limited
}

fn run(place: &Place, kilobytes: u32, arguments: &[&str]) -> Outcome {
    limited(place, kilobytes, arguments).output().expect("the shell starts").into()
}

#[test]
fn scenes_larger_than_the_memory() {
    let sphere = "[[mesh]]\nshape = \"sphere\"\nsubdivisions = 8\n";
    let place = Place::new(&[("scene.toml", &sphere.repeat(10))]);
    for arguments in [&["check", "scene.toml"][..], &["render", "scene.toml", "--device", "cpu", "-o", "out.png"]] {
        let arguments = [arguments, &["--instances", "never"]].concat();
        let wants = ["error: scene.toml:", "triangles", "about ", TAKEN];
        place.refuse_run(&mut limited(&place, 4_000_000, &arguments), &wants);
    }
}

#[test]
fn small_files_that_would_take_much_memory() {
    let place = Place::new(&[
        ("materials.obj", &format!("mtllib many.mtl\n{TRIANGLE}")),
        ("many.mtl", &"newmtl a\n".repeat(1_000_000)),
        ("list.toml", &format!("a = [{}]\n", "0,".repeat(15_000_000))),
        (
            "zeros.gltf",
            r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
            "accessors":[{"componentType":5126,"count":30000000,"type":"VEC3"}]}"#,
        ),
    ]);
    // Holes of the file system's: no disk is taken.
    for (name, bytes) in [("large.gltf", 1 << 30), ("large.eyerays", 1 << 34)] {
        fs::File::create(place.path(name)).unwrap().set_len(bytes).unwrap();
    }
    let texels = 1 << 34;
    fs::write(place.path("texels.eyerays"), header(&place, texels)).unwrap();
    let file = fs::File::options().write(true).open(place.path("texels.eyerays")).unwrap();
    file.set_len(192 + texels).unwrap();
    for kilobytes in [1_000_000, 2_000_000, 3_000_000] {
        for (name, wants) in [
            ("materials.obj", ["many.mtl: its materials may take about ", TAKEN]),
            ("list.toml", ["list.toml: its values may take about ", TAKEN]),
            ("zeros.gltf", ["zeros.gltf: meshes[0].primitives[0]: 10000000 triangles", TAKEN]),
            ("large.gltf", ["large.gltf: the JSON holds 1073741824 bytes", "split the file"]),
            ("large.eyerays", ["large.eyerays: this is no binary scene", "eyerays convert"]),
            ("texels.eyerays", ["texels.eyerays: its 17179869208 bytes take about 17.2 GB", TAKEN]),
        ] {
            let outcome = run(&place, kilobytes, &["check", name]);
            assert_eq!((outcome.code, outcome.stderr.lines().count()), (Some(2), 1), "{name}: {}", outcome.stderr);
            assert!(wants.iter().all(|want| outcome.stderr.contains(want)), "{name}: {}", outcome.stderr);
        }
    }
}

/// The header of a binary scene of nothing but texels.
fn header(place: &Place, texels: u64) -> Vec<u8> {
    place.succeed(&["convert", &shipped("whitted"), "whitted.eyerays", "-q"]);
    let mut header = fs::read(place.path("whitted.eyerays")).unwrap();
    header.truncate(168);
    header[48..].fill(0);
    header[144..152].copy_from_slice(&texels.to_le_bytes());
    header
}

/// A zlib stream of so many MiB of zeros, of a thousandth of that: one block, compressed once.
fn zeros(mebibytes: u32) -> Vec<u8> {
    const BLOCK: usize = 1 << 20;
    let (mut compress, mut block) = (Compress::new(Compression::best(), false), Vec::with_capacity(BLOCK));
    compress.compress_vec(&vec![0; BLOCK], &mut block, FlushCompress::Full).unwrap();
    assert_eq!(compress.total_in(), BLOCK as u64);
    // Adler's sums of zeros: 1, and as many of that as there are bytes.
    let sum = (((u64::from(mebibytes) << 20) % 65_521) << 16) as u32 | 1;
    let last_block = [1, 0, 0, 0xff, 0xff];
    [&[0x78, 0xda][..], &block.repeat(mebibytes as usize), &last_block, &sum.to_be_bytes()].concat()
}

fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let mut crc = Crc::new();
    crc.update(kind);
    crc.update(data);
    [&(data.len() as u32).to_be_bytes()[..], kind, data, &crc.sum().to_be_bytes()].concat()
}

/// A grey pixel whose colour profile is this stream.
fn png(profile: &[u8]) -> Vec<u8> {
    let mut pixel = ZlibEncoder::new(Vec::new(), Compression::best());
    pixel.write_all(&[0, 128]).unwrap();
    [
        b"\x89PNG\r\n\x1a\n".to_vec(),
        chunk(b"IHDR", &[0, 0, 0, 1, 0, 0, 0, 1, 8, 0, 0, 0, 0]),
        chunk(b"iCCP", &[b"a\0\0", profile].concat()),
        chunk(b"IDAT", &pixel.finish().unwrap()),
        chunk(b"IEND", b""),
    ]
    .concat()
}

#[test]
fn a_profile_that_unpacks_to_gigabytes_is_left_out_of_a_picture_of_one_pixel() {
    let mut unpacked = Vec::new();
    ZlibDecoder::new(&zeros(3)[..]).read_to_end(&mut unpacked).unwrap();
    assert!(unpacked.len() == 3 << 20 && unpacked.iter().all(|&byte| byte == 0));
    let place = Place::new(&[
        ("mesh.obj", "mtllib mesh.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n"),
        ("mesh.mtl", "newmtl a\nmap_Kd bomb.png\n"),
    ]);
    let bomb = png(&zeros(2048));
    assert!(bomb.len() < 4 << 20, "{} bytes", bomb.len());
    fs::write(place.path("bomb.png"), bomb).unwrap();
    for arguments in [&["diff", "bomb.png", "bomb.png"][..], &["check", "mesh.obj", "--strict"]] {
        let outcome = run(&place, 1_000_000, arguments);
        assert_eq!((outcome.code, outcome.stderr.as_str()), (Some(0), ""), "{arguments:?}");
    }
}
