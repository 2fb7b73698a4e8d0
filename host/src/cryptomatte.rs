//! Cryptomatte: how much of each pixel every object or material has, by its name, for those who put pictures together (Friedman and Jones,
//! Fully Automatic ID Mattes with Support for Motion Blur and Transparency, 2015; in files as its specification 1.2.0 has it).

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io::Cursor;

use rayon::prelude::*;

/// The names that a pixel keeps: those with the largest shares.
pub const RANKS: usize = 6;

/// The shares of names in the pixels of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Cryptomatte {
    /// What files call it.
    layer: &'static str,
    /// All names that there are.
    names: Vec<String>,
    /// Of each pixel, row by row: names by their place, and their shares, the largest first; 0 of none.
    pixels: Vec<[(u32, f32); RANKS]>,
}

/// Counts whose samples a pixel shows.
pub(crate) struct Counter<'n> {
    layer: &'static str,
    names: Vec<&'n str>,
    /// The place in `names` of what has a number.
    of_number: Vec<u32>,
    /// Of each pixel, places in `names` with how many samples show them.
    pixels: Vec<Vec<(u32, u32)>>,
    samples: u32,
}

impl<'n> Counter<'n> {
    /// Of so many pixels, and things by these names; those of one name are one. Files call it `layer`.
    pub fn new(layer: &'static str, names: impl Iterator<Item = &'n str>, pixels: usize) -> Self {
        let mut counter =
            Counter { layer, names: Vec::new(), of_number: Vec::new(), pixels: vec![Vec::new(); pixels], samples: 0 };
        let mut places = HashMap::new();
        for name in names {
            let place = *places.entry(name).or_insert_with(|| {
                counter.names.push(name);
                counter.names.len() as u32 - 1
            });
            counter.of_number.push(place);
        }
        counter
    }

    /// Counts a sample of each pixel: the number of what it shows, if it shows anything.
    pub fn add(&mut self, seen: impl IndexedParallelIterator<Item = Option<usize>>) {
        let of_number = &self.of_number;
        self.pixels.par_iter_mut().zip(seen).for_each(|(pixel, seen)| {
            let Some(&place) = seen.and_then(|number| of_number.get(number)) else { return };
            match pixel.iter_mut().find(|(own, _)| *own == place) {
                Some((_, count)) => *count += 1,
                None => pixel.push((place, 1)),
            }
        });
        self.samples += 1;
    }

    /// Shares of the samples.
    pub fn done(self) -> Cryptomatte {
        let samples = f64::from(self.samples.max(1));
        let ranked = |mut pixel: Vec<(u32, u32)>| {
            // Equal shares by their names' places, whatever came first.
            pixel.sort_unstable_by_key(|&(place, count)| (u32::MAX - count, place));
            let mut ranks = [(0, 0.0); RANKS];
            for (rank, (place, count)) in ranks.iter_mut().zip(pixel) {
                *rank = (place, (f64::from(count) / samples) as f32);
            }
            ranks
        };
        let pixels: Vec<_> = self.pixels.into_par_iter().map(ranked).collect();
        let names = self.names.into_iter().map(str::to_owned).collect();
        Cryptomatte { layer: self.layer, names, pixels }
    }
}

impl Cryptomatte {
    /// How many pixels there are.
    pub fn pixels(&self) -> usize {
        self.pixels.len()
    }

    /// The share of a name in each pixel, row by row; 0 where it has less than [`RANKS`] others have.
    pub fn share(&self, name: &str) -> Vec<f32> {
        let place = self.names.iter().position(|own| own == name);
        let of = |pixel: &[(u32, f32); RANKS]| {
            let found = pixel.iter().find(|&&(own, share)| share > 0.0 && Some(own as usize) == place);
            found.map_or(0.0, |&(_, share)| share)
        };
        self.pixels.iter().map(of).collect()
    }

    /// The channels that a file has of it, in its order: a channel of ids and one of shares for each rank.
    pub(crate) fn channels(&self) -> Vec<(String, Vec<f32>)> {
        let ids: Vec<f32> = self.names.iter().map(|name| id(name)).collect();
        let rank = |rank: usize| {
            let letters = [["R", "G"], ["B", "A"]][rank % 2];
            let id = |pixel: &[(u32, f32); RANKS]| match pixel[rank] {
                (place, share) if share > 0.0 => ids[place as usize],
                _ => 0.0,
            };
            let values = [
                self.pixels.par_iter().map(id).collect(),
                self.pixels.par_iter().map(|pixel| pixel[rank].1).collect::<Vec<f32>>(),
            ];
            letters.map(|letter| format!("{}{:02}.{letter}", self.layer, rank / 2)).into_iter().zip(values)
        };
        (0..RANKS).flat_map(rank).collect()
    }

    /// What a file says of it, by attributes.
    pub(crate) fn attributes(&self) -> [(String, String); 4] {
        let key = format!("{:08x}", hash(self.layer));
        let ranks = self.pixels.iter().flatten().filter(|(_, share)| *share > 0.0);
        let places: BTreeSet<u32> = ranks.map(|&(place, _)| place).collect();
        let names = places.into_iter().map(|place| self.names[place as usize].as_str());
        let seen: BTreeMap<&str, String> = names.map(|name| (name, hex(name))).collect();
        let manifest = in_ascii(&serde_json::to_string(&seen).expect("names are texts"));
        let values = [
            ("name", self.layer.to_owned()),
            ("hash", "MurmurHash3_32".to_owned()),
            ("conversion", "uint32_to_float32".to_owned()),
            ("manifest", manifest),
        ];
        values.map(|(what, value)| (format!("cryptomatte/{}/{what}", &key[..7]), value))
    }
}

/// A JSON text without other characters, which attributes of EXR files have no place for.
fn in_ascii(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for character in json.chars() {
        match character.is_ascii() {
            true => text.push(character),
            false => text.extend(character.encode_utf16(&mut [0; 2]).iter().map(|unit| format!("\\u{unit:04x}"))),
        }
    }
    text
}

fn hash(name: &str) -> u32 {
    murmur3::murmur3_32(&mut Cursor::new(name), 0).expect("memory is read without faults")
}

/// The bits of a name's number.
fn bits(name: &str) -> u32 {
    let hash = hash(name);
    match hash >> 23 & 0xff {
        // Neither subnormal nor infinite nor NaN.
        0 | 0xff => hash ^ 1 << 23,
        _ => hash,
    }
}

/// The number that stands for a name in pixels.
pub fn id(name: &str) -> f32 {
    f32::from_bits(bits(name))
}

fn hex(name: &str) -> String {
    format!("{:08x}", bits(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of MurmurHash3_32 with the seed 0 that other programs give.
    #[test]
    fn names_have_the_hashes_that_others_give_them() {
        let known = [
            ("", 0),
            ("hello", 0x248b_fa47),
            ("hello, world", 0x149b_bb7f),
            ("The quick brown fox jumps over the lazy dog", 0x2e4f_f723),
        ];
        for (name, wanted) in known {
            assert_eq!(hash(name), wanted, "{name:?}");
        }
        assert_eq!((bits("hello"), id("hello").to_bits()), (0x248b_fa47, 0x248b_fa47));
        // That of no text would be a subnormal number.
        assert_eq!(bits(""), 1 << 23);
    }

    #[test]
    fn all_numbers_of_names_are_numbers_that_pixels_keep() {
        assert!((0..100_000).all(|i| id(&format!("name {i}")).is_normal()));
    }

    #[test]
    fn shares_are_ranked_and_things_of_one_name_are_one() {
        let mut counter = Counter::new("CryptoObject", ["cup", "table", "cup", "sky"].into_iter(), 2);
        for seen in [[Some(0), None], [Some(2), Some(1)], [Some(1), None], [Some(0), None]] {
            counter.add(seen.into_par_iter());
        }
        let matte = counter.done();
        assert_eq!((matte.share("cup"), matte.share("table")), (vec![0.75, 0.0], vec![0.25, 0.25]));
        assert_eq!((matte.share("sky"), matte.share("lamp")), (vec![0.0; 2], vec![0.0; 2]));
        let channels = matte.channels();
        let names: Vec<&str> = channels.iter().map(|(name, _)| name.as_str()).collect();
        let first = ["00.R", "00.G", "00.B", "00.A", "01.R"].map(|ending| format!("CryptoObject{ending}"));
        assert_eq!(names[..5], first);
        assert_eq!((names.len(), names[11]), (12, "CryptoObject02.A"));
        let values: Vec<&[f32]> = channels.iter().map(|(_, values)| &values[..]).collect();
        assert_eq!(values[0], [id("cup"), id("table")]);
        assert_eq!((values[1], values[2], values[3]), (&[0.75, 0.25][..], &[id("table"), 0.0][..], &[0.25, 0.0][..]));
    }

    #[test]
    fn a_pixel_keeps_the_names_with_the_largest_shares() {
        let names: Vec<String> = (0..9).map(|i| format!("{i}")).collect();
        let mut counter = Counter::new("CryptoObject", names.iter().map(String::as_str), 1);
        for name in (0..9).flat_map(|i| std::iter::repeat_n(i, i + 1)) {
            counter.add([Some(name)].into_par_iter());
        }
        let matte = counter.done();
        let shares: Vec<f32> = names.iter().map(|name| matte.share(name)[0]).collect();
        assert_eq!(shares, [0.0, 0.0, 0.0, 4.0 / 45.0, 5.0 / 45.0, 6.0 / 45.0, 7.0 / 45.0, 8.0 / 45.0, 9.0 / 45.0]);
    }

    #[test]
    fn a_file_says_how_names_became_numbers() {
        let mut counter = Counter::new("CryptoObject", ["a \"cup\"", "Stühle 🪑"].into_iter(), 1);
        counter.add([Some(0)].into_par_iter());
        counter.add([Some(1)].into_par_iter());
        let said: BTreeMap<String, String> = counter.done().attributes().into();
        let key = &format!("{:08x}", hash("CryptoObject"))[..7];
        let of = |what: &str| said[&format!("cryptomatte/{key}/{what}")].as_str();
        assert_eq!((of("name"), of("hash"), of("conversion")), ("CryptoObject", "MurmurHash3_32", "uint32_to_float32"));
        let manifest: BTreeMap<String, String> = serde_json::from_str(of("manifest")).unwrap();
        for name in ["a \"cup\"", "Stühle 🪑"] {
            assert_eq!(manifest[name], format!("{:08x}", id(name).to_bits()));
        }
        assert!(of("manifest").is_ascii());
    }
}
