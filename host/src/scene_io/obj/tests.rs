//! A file is cut into blocks wherever it is, and no one sees it.

use proptest::prelude::*;

use super::*;
use crate::scene_io::tests::{Folder, budget};

fn parse_whole(sizes: Sizes, path: &Path, text: &[u8], bytes: u64) -> Result<Obj> {
    parse_by(sizes, text, Found::new(path, budget(bytes), &mut Images::new(Path::new(""), Loading::default()), true))
}

/// What was read, or why not, as text.
fn read(sizes: Sizes, path: &Path, text: &[u8], bytes: u64) -> String {
    match parse_whole(sizes, path, text, bytes) {
        Ok(obj) => format!("{obj:?}"),
        Err(error) => error.to_string(),
    }
}

/// Statements as files have them, and what they should not have.
const LINES: &[&str] = &[
    "v 0 0 0",
    "v 1 0 0",
    "v 1 1 0.5",
    "v 0 1 0",
    "v -2 1e3 7 1 0 0",
    "vn 0 0 2",
    "vn 1 1 nan",
    "vt 0 0",
    "vt 0.5 1 0",
    "f 1/-1 2/1/1 3",
    "f 1 2 3",
    "f -1 -2 -3",
    "f 1//1 2//1 3//2",
    "f 1/1 2/1 3/1",
    "f 1 2 3 4",
    "f 1 3 2 4",
    "f -1//-1 -2//-1 -3 -4",
    "usemtl a",
    "usemtl b",
    "usemtl",
    "mtllib a.mtl",
    "mtllib none.mtl",
    "o thing",
    "# a comment \\",
    "# \u{e9}",
    "",
    "  v 3 3 3",
    "\u{feff}v 9 9 9",
    "f 1 2 \\\n 3",
    "v\\\n 5 5 5",
    "\\\nv 6 6 6",
    "curv 1 2",
    "f 1 2 3 \\",
    "\u{a0}v 1 1 1",
];
/// Statements that end the reading.
const FAULTS: &[&str] = &[
    "v 1 2",
    "vt",
    "vt 0 nan",
    "f 1/99 2 3",
    "f 1 2",
    "f 1 2 999999",
    "vn 0 x 0",
    "mtllib",
    "mtllib ../a.mtl",
    "f 0 1 2",
];

fn texts() -> impl Strategy<Value = Vec<u8>> {
    let ends = prop::sample::select(vec!["\n", "\r\n", "\n\n"]);
    let line = (prop::sample::select(LINES), ends).prop_map(|(line, end)| [line, end].concat());
    let fault = prop::option::weighted(0.3, (prop::sample::select(FAULTS), 0..60usize));
    (prop::collection::vec(line, 1..60), fault, any::<bool>()).prop_map(|(mut lines, fault, is_latin)| {
        // Faces find what they name.
        lines.insert(0, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 0 1 0\nvt 0 0\nmtllib a.mtl\n".into());
        if let Some((fault, place)) = fault {
            lines.insert(place.min(lines.len() - 1) + 1, format!("{fault}\n"));
        }
        let mut text = lines.concat().into_bytes();
        if is_latin {
            text.extend_from_slice(b"o \xe6\nusemtl \xe6\n");
        }
        text
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..Default::default() })]

    /// The same mesh, materials and warnings, or the same error, whatever is read at a time.
    #[test]
    fn blocks_make_no_difference(text in texts(), window in 1..400usize, block in 1..100usize, memory in 500..40_000u64) {
        let folder = Folder::new(&[("a.mtl", b"newmtl a\nKd 1 0 0\nnewmtl b\n")]);
        let path = folder.path("a.obj");
        for bytes in [1 << 20, memory] {
            let whole = read(Sizes::USUAL, &path, &text, bytes);
            prop_assert_eq!(read(Sizes { window, block }, &path, &text, bytes), whole);
        }
    }

    /// Bytes that are no mesh end in one line, whatever is read at a time.
    #[test]
    fn garbage_is_told_in_a_line(text in prop::collection::vec(any::<u8>(), 0..300), block in 1..50usize) {
        let whole = read(Sizes::USUAL, Path::new("a.obj"), &text, 1 << 20);
        prop_assert!(!whole.contains('\n'), "{whole}");
        prop_assert_eq!(read(Sizes { window: 2 * block, block }, Path::new("a.obj"), &text, 1 << 20), whole);
    }
}

#[test]
fn a_line_that_is_too_long_is_told_where_it_starts() {
    let text = [&b"v 0 0 0\nv "[..], &vec![b' '; 5 << 20], b"\nf 1 1 1\n"].concat();
    for sizes in [Sizes::USUAL, Sizes { window: 1000, block: 100 }] {
        let error = parse_whole(sizes, Path::new("a.obj"), &text[..], 1 << 20).unwrap_err();
        assert_eq!(error.place().and_then(|(_, line)| line), Some(2), "{error}");
        assert!(error.message().contains("4194304 bytes"), "{error}");
    }
}

#[test]
fn blocks_end_where_lines_do() {
    let window = b"a\nbb \\\nccc\r\nd\\\r\ne\nf";
    let cut = |size| blocks::of(window, size).iter().map(|text| text.escape_ascii().to_string()).collect::<Vec<_>>();
    let lines = [r"a\n", r"bb \\\nccc\r\n", r"d\\\r\ne\n", "f"];
    assert_eq!(cut(1), lines);
    assert_eq!(cut(14), [[lines[0], lines[1]].concat(), [lines[2], lines[3]].concat()]);
    assert_eq!(cut(100).len(), 1);
}

#[test]
fn vertices_are_the_used_pairs_each_once() {
    let text =
        b"v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 1 0 0\nf 2//1 3//1 4//1\nf 2//2 4//1 3//1\nf 4 2//2 2//1\n";
    let mesh = parse(Path::new("a.obj"), &text[..], budget(1 << 20)).unwrap().mesh;
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 2, 1], [4, 3, 0]]);
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ZERO, Vec3::Y]);
    assert_eq!(mesh.normals, [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::X, Vec3::ZERO]);
}
