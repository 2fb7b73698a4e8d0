//! The tables of albedos are the integrals of what facets do. `EYERAYS_ALBEDOS=write` makes them anew.

use eyerays_shader::material::{
    BRUSHED, EVEN, GLASS, Ggx, MOST_BEND, STARTS, cosine_coordinate, fresnel, reflect, refract,
};
use eyerays_shader::real::V3;
use std::f64::consts::FRAC_PI_2;

use super::surface::{V, albedos};

/// Steps of the height and of the angle of facets' normals.
const STEPS: u32 = 128;

/// The mean over facets that are seen from a unit direction of a pair of numbers.
fn mean_of_facets(ggx: Ggx<f64>, w: V, of: impl Fn(V) -> (f64, f64)) -> (f64, f64) {
    let middle = |i: u32| ((f64::from(i) + 0.5) / f64::from(STEPS) * 4_294_967_296.0) as u32;
    let mut sum = (0.0, 0.0);
    for i in 0..STEPS {
        for j in 0..STEPS {
            let (a, b) = of(ggx.visible(w, (middle(i), middle(j))));
            sum = (sum.0 + a, sum.1 + b);
        }
    }
    let count = f64::from(STEPS * STEPS);
    (sum.0 / count, sum.1 / count)
}

/// The share of light between two directions, on either side, that other facets let pass where those that the viewer sees send it.
fn unshadowed(ggx: Ggx<f64>, w: V, to: V) -> f64 {
    let (cosine, own, other) = (to.z.abs(), ggx.stretched(w), ggx.stretched(to));
    cosine * (own + w.z) / (own * cosine + other * w.z)
}

/// What facets reflect: by one less Schlick's fifth power, and by that.
fn reflected(ggx: Ggx<f64>, w: V) -> (f64, f64) {
    mean_of_facets(ggx, w, |h| {
        let to = reflect(-w, h);
        let fifth = (1.0 - w.dot(h)).max(0.0).powi(5);
        if to.z > 0.0 { (unshadowed(ggx, w, to) * (1.0 - fifth), unshadowed(ggx, w, to) * fifth) } else { (0.0, 0.0) }
    })
}

/// What facets of glass reflect and what they let pass, of energy.
fn shared(ggx: Ggx<f64>, w: V, eta: f64) -> (f64, f64) {
    mean_of_facets(ggx, w, |h| {
        let refraction = refract(-w, h, eta);
        let (share, to, through) = (fresnel(&refraction, eta), reflect(-w, h), refraction.direction);
        let mirrored = if to.z > 0.0 { share * unshadowed(ggx, w, to) } else { 0.0 };
        let passes = !refraction.total && through.z < 0.0;
        (mirrored, if passes { (1.0 - share) * unshadowed(ggx, w, through) } else { 0.0 })
    })
}

fn direction(cosine: f64, cosine_of_azimuth: f64) -> V {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    V3::new(sine * cosine_of_azimuth, sine * (1.0 - cosine_of_azimuth * cosine_of_azimuth).max(0.0).sqrt(), cosine)
}

/// The cosine of a coordinate, by bisection.
fn cosine_at(coordinate: f64, roughness: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if cosine_coordinate(middle, roughness) < coordinate { low = middle } else { high = middle }
    }
    high.max(1e-9)
}

fn place(i: u32, entries: u32) -> f64 {
    f64::from(i) / f64::from(entries - 1)
}

fn roughness(i: u32, entries: u32) -> f64 {
    place(i, entries).powi(2).max(f64::from(Ggx::<f64>::LEAST))
}

/// The index on the near side over that on the far one.
fn eta(i: u32) -> f64 {
    let bend = place(i % GLASS[0], GLASS[0]) * f64::from(MOST_BEND);
    let outside = (1.0 - bend) / (1.0 + bend);
    if i < GLASS[0] { outside } else { 1.0 / outside }
}

/// The mean over all directions by their cosine of what is linear between entries over the cosine's coordinate.
fn mean(row: &[(f64, f64)], roughness: f64) -> (f64, f64) {
    const COUNT: u32 = 4096;
    let mut sum = (0.0, 0.0);
    for i in 0..COUNT {
        let cosine = ((f64::from(i) + 0.5) / f64::from(COUNT)).sqrt();
        let at = cosine_coordinate(cosine, roughness) * (row.len() - 1) as f64;
        let first = (at as usize).min(row.len() - 2);
        let (a, b, rest) = (row[first], row[first + 1], at - first as f64);
        sum = (sum.0 + a.0 + (b.0 - a.0) * rest, sum.1 + a.1 + (b.1 - a.1) * rest);
    }
    (sum.0 / f64::from(COUNT), sum.1 / f64::from(COUNT))
}

fn rounded((a, b): (f64, f64)) -> (f64, f64) {
    let step = |x: f64| (x * 65_536.0).round().clamp(0.0, 65_535.0) / 65_536.0;
    (step(a), step(b))
}

/// One of the tables' rows over the cosine, and the roughness that its coordinates are of.
struct Row {
    roughness: f64,
    entries: Vec<(f64, f64)>,
}

impl Row {
    fn new(roughness: f64, entries: u32, of: impl Fn(f64) -> (f64, f64)) -> Self {
        let at = |i| rounded(of(cosine_at(place(i, entries), roughness)));
        Row { roughness, entries: (0..entries).map(at).collect() }
    }

    fn mean(&self) -> (f64, f64) {
        rounded(mean(&self.entries, self.roughness))
    }
}

fn even(i: u32) -> Row {
    let alpha = roughness(i, EVEN[0]);
    Row::new(alpha, EVEN[1], |cosine| reflected(Ggx { x: alpha, y: alpha }, direction(cosine, 1.0)))
}

fn glass(i: u32) -> Row {
    let (alpha, eta) = (roughness(i % GLASS[1], GLASS[1]), eta(i / GLASS[1]));
    Row::new(alpha, GLASS[2], |cosine| shared(Ggx { x: alpha, y: alpha }, direction(cosine, 1.0), eta))
}

fn brushed(i: u32) -> Row {
    let (pair, azimuth) = (i / BRUSHED[2], place(i % BRUSHED[2], BRUSHED[2]));
    let rough = roughness(pair / BRUSHED[1], BRUSHED[0]);
    let fine = (rough * place(pair % BRUSHED[1], BRUSHED[1]).powi(2)).max(f64::from(Ggx::<f64>::LEAST));
    Row::new(rough, BRUSHED[3], |cosine| reflected(Ggx { x: rough, y: fine }, direction(cosine, azimuth)))
}

/// The mean of rows over evenly spaced cosines of the azimuth, linear between them.
fn mean_over_azimuths(rows: &[&Row]) -> (f64, f64) {
    const COUNT: u32 = 1024;
    let means: Vec<(f64, f64)> = rows.iter().map(|row| mean(&row.entries, row.roughness)).collect();
    let mut sum = (0.0, 0.0);
    for i in 0..COUNT {
        let at = ((f64::from(i) + 0.5) / f64::from(COUNT) * FRAC_PI_2).cos() * (rows.len() - 1) as f64;
        let first = (at as usize).min(rows.len() - 2);
        let (a, b, rest) = (means[first], means[first + 1], at - first as f64);
        sum = (sum.0 + a.0 + (b.0 - a.0) * rest, sum.1 + a.1 + (b.1 - a.1) * rest);
    }
    rounded((sum.0 / f64::from(COUNT), sum.1 / f64::from(COUNT)))
}

/// The mean share that a smooth interface lets pass from outside.
fn passed(i: u32) -> f64 {
    let eta = eta(i);
    let at = |i: u32| ((f64::from(i) + 0.5) / 4096.0).sqrt();
    let share = |i| fresnel(&refract(-direction(at(i), 1.0), V3::new(0.0, 0.0, 1.0), eta), eta);
    1.0 - (0..4096).map(share).sum::<f64>() / 4096.0
}

/// A table by its rows, of which some are not made.
struct Table {
    rows: Vec<Option<Row>>,
    length: u32,
}

impl Table {
    fn new(count: u32, length: u32, takes: &impl Fn(u32) -> bool, of: impl Fn(u32) -> Row) -> Self {
        Table { rows: (0..count).map(|i| takes(i).then(|| of(i))).collect(), length }
    }

    fn entries(&self) -> Vec<Option<(f64, f64)>> {
        let of = |row: &Option<Row>| match row {
            Some(row) => row.entries.iter().copied().map(Some).collect(),
            None => vec![None; self.length as usize],
        };
        self.rows.iter().flat_map(of).collect()
    }

    fn means(&self) -> Vec<Option<(f64, f64)>> {
        self.rows.iter().map(|row| row.as_ref().map(Row::mean)).collect()
    }

    /// The means of so many rows each, unless one of them is not made.
    fn means_over_azimuths(&self, count: u32) -> Vec<Option<(f64, f64)>> {
        let of = |rows: &[Option<Row>]| {
            let made: Option<Vec<&Row>> = rows.iter().map(Option::as_ref).collect();
            made.map(|rows| mean_over_azimuths(&rows))
        };
        self.rows.chunks(count as usize).map(of).collect()
    }
}

/// All tables, of some of their rows only.
fn tables(takes: impl Fn(u32) -> bool) -> Vec<Option<(f64, f64)>> {
    let even = Table::new(EVEN[0], EVEN[1], &takes, even);
    let glass = Table::new(2 * GLASS[0] * GLASS[1], GLASS[2], &takes, glass);
    let brushed = Table::new(BRUSHED[0] * BRUSHED[1] * BRUSHED[2], BRUSHED[3], &takes, brushed);
    let smooth = (0..GLASS[0]).map(|i| Some(rounded((passed(i), 0.0)))).collect();
    let parts = [
        even.entries(),
        even.means(),
        glass.entries(),
        glass.means(),
        smooth,
        brushed.entries(),
        brushed.means_over_azimuths(BRUSHED[2]),
    ];
    parts.concat()
}

fn word((a, b): (f64, f64)) -> u32 {
    let half = |x: f64| (x * 65_536.0) as u32;
    half(a) | half(b) << 16
}

#[test]
fn the_tables_hold_the_integrals_of_what_facets_do() {
    if std::env::var("EYERAYS_ALBEDOS").is_ok_and(|v| v == "write") {
        let bytes: Vec<u8> = tables(|_| true).into_iter().flat_map(|of| word(of.unwrap()).to_le_bytes()).collect();
        std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/src/material/albedo.bin"), bytes).unwrap();
        return;
    }
    // Every 37th row, and all azimuths of one pair of roughnesses.
    let tables = tables(|i| i % 37 == 5 || i / BRUSHED[2] == 40);
    assert_eq!(tables.len(), STARTS[7] as usize);
    assert_eq!(albedos().len(), tables.len());
    let mut compared = 0;
    for (i, (&got, want)) in albedos().iter().zip(tables).enumerate() {
        let Some(want) = want else { continue };
        let of = |half: u32| f64::from(half) / 65_536.0;
        let (a, b) = (of(got & 0xffff), of(got >> 16));
        // Rounding, and the last bits of another platform's sines.
        let error = (a - want.0).abs().max((b - want.1).abs());
        assert!(error < 2.0 / 65_536.0, "entry {i}: {a} and {b}, not {want:?}");
        compared += 1;
    }
    assert!(compared > 500, "{compared}");
}
