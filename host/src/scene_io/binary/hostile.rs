//! Files of strangers: refused in a line, or whole, whatever their hash.

use std::sync::LazyLock;

use proptest::prelude::*;

use super::header::Header;
use super::tests::{EXAMPLE, moving, packed, read, sign, text};
use super::write;
use crate::device_scene::hierarchy;
use crate::quality::Bvh;

/// Asserts that a file is a scene, which is packed or refused in a line, or is refused in a line itself.
fn assert_tame(bytes: &[u8], what: &str) {
    let fault = match read(bytes) {
        // What there is of a hierarchy is checked with the primitives.
        Ok(scene) => {
            assert_eq!(scene.check(), Ok(()), "{what}");
            packed(&scene).err().map(|error| error.message())
        }
        Err(fault) => Some(fault),
    };
    assert!(fault.as_ref().is_none_or(|fault| !fault.is_empty() && !fault.contains('\n')), "{what}: {fault:?}");
}

/// A scene of few bytes, each of which can be changed in its turn.
static SMALL: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let scene = text("../scenes/whitted.toml");
    let bvh = hierarchy(&scene, Bvh::Fast.quality()).expect("a hierarchy");
    let mut bytes = Vec::new();
    write(&scene, Some((Bvh::Fast, &bvh)), &mut bytes).expect("a scene in range");
    bytes
});

/// The same of one that moves.
static MOVING: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut bytes = Vec::new();
    write(&moving(), None, &mut bytes).expect("a scene in range");
    bytes
});

/// Where the bytes of its poses are, and what it says of them.
fn poses() -> impl Iterator<Item = usize> {
    let (_, sections) = Header::read(&MOVING).expect("a scene");
    let text = std::str::from_utf8(&MOVING[sections[0].clone()]).expect("a text");
    let [start, end] = ["[motion]", "[textures]"].map(|table| sections[0].start + text.find(table).expect("a table"));
    (start..end).chain(sections[12].clone())
}

/// Where its sections begin and end.
fn edges() -> Vec<usize> {
    let (_, sections) = Header::read(&SMALL).expect("a scene");
    sections.iter().flat_map(|section| [section.start, section.end]).collect()
}

#[test]
fn no_byte_can_be_changed_unseen_and_none_does_harm_under_a_right_hash() {
    let first = edges()[0];
    assert!(first > size_of::<Header>(), "something lies between");
    let moving = poses().map(|at| (&*MOVING, at));
    for (file, at) in (0..SMALL.len()).map(|at| (&*SMALL, at)).chain(moving) {
        let old = file[at];
        let others: &[u8] = if at < first { &[old ^ 1, old ^ 0x80, 0, 0xff] } else { &[old ^ 0x80] };
        for &new in others.iter().filter(|&&new| new != old) {
            let mut bytes = file.clone();
            bytes[at] = new;
            assert!(read(&bytes).is_err(), "byte {at} as {new} is accepted");
            sign(&mut bytes);
            assert_tame(&bytes, &format!("byte {at} as {new}"));
        }
    }
}

#[test]
fn a_file_that_is_cut_anywhere_or_longer_is_refused() {
    for end in (0..SMALL.len()).chain(SMALL.len() + 1..SMALL.len() + 100) {
        let mut bytes = SMALL.clone();
        bytes.resize(end, 0);
        assert!(read(&bytes).is_err(), "{end} bytes are accepted");
    }
}

#[test]
fn counts_beyond_the_file_or_all_numbers_are_refused_before_memory_is_taken() {
    const FIRST: usize = 48;
    for at in (FIRST..size_of::<Header>()).step_by(8) {
        let old = u64::from_le_bytes(SMALL[at..at + 8].try_into().expect("eight bytes"));
        let with = |count: u64| {
            let mut bytes = SMALL.clone();
            bytes[at..at + 8].copy_from_slice(&count.to_le_bytes());
            bytes
        };
        for count in [u64::MAX, u64::MAX / 12 + 1, u64::MAX / 64 + 1, 1 << 63, 1 << 40, old + 1_000_000] {
            let fault = read(&with(count)).expect_err("accepted");
            assert!(fault.contains("are not what its header tells"), "{count} at byte {at}: {fault}");
        }
        // A few more or fewer may end at the same multiple of 64 bytes.
        for count in [0, old.saturating_sub(1), old + 1, old + 2] {
            let mut bytes = with(count);
            sign(&mut bytes);
            assert_tame(&bytes, &format!("{count} at byte {at}"));
        }
    }
}

/// A change to a file: bytes from `at` on, in shares of the file.
#[derive(Debug, Clone)]
enum Change {
    Put(f64, Vec<u8>),
    Flip(f64, u8),
    Cut(f64),
    Insert(f64, Vec<u8>),
    Copy(f64, f64, usize),
}

fn change() -> impl Strategy<Value = Change> {
    // The header and the description are a small part of a file, and where most can go wrong.
    let at = || prop_oneof![0.0..0.03f64, 0.0..1.0f64];
    let number = prop_oneof![Just(0u64), Just(1), Just(u64::MAX), Just(1 << 40), any::<u64>()];
    let float = prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(-1.0), Just(3e38), Just(1e-45)];
    prop_oneof![
        (at(), prop::collection::vec(any::<u8>(), 1..16)).prop_map(|(at, bytes)| Change::Put(at, bytes)),
        (at(), number).prop_map(|(at, number)| Change::Put(at, number.to_le_bytes().into())),
        (at(), float).prop_map(|(at, float)| Change::Put(at, float.to_le_bytes().into())),
        (at(), "[-0-9a-z\"=\\[\\]\n]{1,8}").prop_map(|(at, text)| Change::Put(at, text.into())),
        (at(), 0..8u8).prop_map(|(at, bit)| Change::Flip(at, bit)),
        at().prop_map(Change::Cut),
        (at(), prop::collection::vec(any::<u8>(), 1..200)).prop_map(|(at, bytes)| Change::Insert(at, bytes)),
        (at(), at(), 1..300usize).prop_map(|(from, to, count)| Change::Copy(from, to, count)),
    ]
}

fn changed(mut bytes: Vec<u8>, change: &Change) -> Vec<u8> {
    let place = |at: f64, bytes: &[u8]| (at * bytes.len() as f64) as usize;
    let put = |to: usize, new: &[u8], bytes: &mut [u8]| {
        let end = (to + new.len()).min(bytes.len());
        bytes[to..end].copy_from_slice(&new[..end - to]);
    };
    match change {
        // On a word, where numbers are.
        Change::Put(at, new) => put(place(*at, &bytes) & !3, new, &mut bytes),
        Change::Flip(at, bit) => {
            if let Some(byte) = bytes.get_mut(place(*at, &EXAMPLE)) {
                *byte ^= 1 << bit;
            }
        }
        Change::Cut(at) => bytes.truncate(place(*at, &bytes)),
        Change::Insert(at, new) => {
            let at = place(*at, &bytes);
            bytes.splice(at..at, new.iter().copied());
        }
        Change::Copy(from, to, count) => {
            let from = place(*from, &bytes);
            let piece = bytes[from..(from + count).min(bytes.len())].to_vec();
            put(place(*to, &bytes), &piece, &mut bytes);
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, failure_persistence: None, ..Default::default() })]

    /// Signed, so that the hash does not hide what comes after it; and unsigned.
    #[test]
    fn a_mutated_file_is_refused_in_a_line_or_whole(
        changes in prop::collection::vec(change(), 1..4),
        is_signed in prop::bool::weighted(0.8),
    ) {
        let mut bytes = changes.iter().fold(EXAMPLE.clone(), changed);
        if is_signed {
            sign(&mut bytes);
        }
        assert_tame(&bytes, "mutated");
    }
}
