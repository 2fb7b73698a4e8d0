//! Curved sheets, cut into exactly as many triangles as they are given.
//!
//! A sheet is cut into rings across `v`, each ring into segments along `u`, and two rings are zipped together, so
//! that they need not have as many segments: between rings of a and b segments lie a + b triangles. Nothing is
//! left over, and triangles are about as high as wide everywhere.

use glam::DVec3;

use super::random::Random;

/// How finely a sheet is measured.
const PROBES: usize = 12;
/// The step by which normals are found.
const STEP: f64 = 1.0 / 4096.0;

type Surface = Box<dyn Fn(f64, f64) -> DVec3>;

/// A surface over the unit square, seen from the side that u × v points to.
pub struct Patch {
    surface: Surface,
    /// Whether u = 1 is u = 0.
    wraps: bool,
    /// Whether it has no normals of its own.
    flat: bool,
    /// Lengths along u at even steps of v; a pole's is 0.
    lengths: [f64; PROBES + 1],
    height: f64,
    least_rows: usize,
    least_segments: usize,
}

/// What a patch is cut into.
pub trait Sink {
    /// Takes a vertex and its normal, zero for a flat one, and numbers it.
    fn vertex(&mut self, position: DVec3, normal: Option<DVec3>) -> u64;
    /// Takes a triangle of vertices.
    fn triangle(&mut self, corners: [u64; 3], normals: bool);
}

impl Patch {
    /// A curved sheet with edges.
    pub fn open(surface: impl Fn(f64, f64) -> DVec3 + 'static) -> Self {
        Self::new(Box::new(surface), false).least(2, 2)
    }

    /// A sheet that closes along u.
    pub fn tube(surface: impl Fn(f64, f64) -> DVec3 + 'static) -> Self {
        Self::new(Box::new(surface), true).least(2, 6)
    }

    /// The plane parallelogram at `corner`, seen from `across` × `up`.
    pub fn quad(corner: DVec3, across: DVec3, up: DVec3) -> Self {
        let surface = move |u, v| corner + across * u + up * v;
        Patch { flat: true, ..Self::new(Box::new(surface), false).least(1, 1) }
    }

    fn new(surface: Surface, wraps: bool) -> Self {
        let at = |i: usize| i as f64 / PROBES as f64;
        let mut lengths = [0.0; PROBES + 1];
        for (row, length) in lengths.iter_mut().enumerate() {
            let step = |i: usize| (surface(at(i + 1), at(row)) - surface(at(i), at(row))).length();
            *length = (0..PROBES).map(step).sum::<f64>();
            if *length < 1e-6 {
                *length = 0.0;
            }
        }
        let column = |i: usize| {
            (0..PROBES).map(|row| (surface(at(i), at(row + 1)) - surface(at(i), at(row))).length()).sum::<f64>()
        };
        let height = (0..PROBES).map(column).sum::<f64>() / PROBES as f64;
        Patch { surface, wraps, flat: false, lengths, height, least_rows: 1, least_segments: 1 }
    }

    /// Cut into at least so many rows and segments.
    pub fn least(self, rows: usize, segments: usize) -> Self {
        let poles = [0, PROBES].iter().filter(|&&end| self.lengths[end] == 0.0).count();
        Patch { least_rows: rows.max(poles), least_segments: segments.max(if self.wraps { 3 } else { 1 }), ..self }
    }

    /// Without normals of its own.
    pub fn faceted(self) -> Self {
        Patch { flat: true, ..self }
    }

    /// Whether it is a plane that more triangles would not change.
    pub fn is_plane(&self) -> bool {
        self.least_rows * self.least_segments == 1
    }

    /// Whether it has no edge: such a sheet has an even number of triangles.
    pub fn is_closed(&self) -> bool {
        self.wraps && self.lengths[0] == 0.0 && self.lengths[PROBES] == 0.0
    }

    /// About its area.
    pub fn area(&self) -> f64 {
        self.lengths.iter().sum::<f64>() / (PROBES + 1) as f64 * self.height
    }

    /// The fewest triangles it is cut into.
    pub fn fewest(&self) -> u64 {
        self.fewest_of(self.least_rows)
    }

    fn fewest_of(&self, rows: usize) -> u64 {
        let segments = (0..=rows).map(|ring| self.weight(ring, rows) * self.least_of(ring, rows));
        segments.sum()
    }

    /// How many triangles a segment more makes.
    fn weight(&self, ring: usize, rows: usize) -> u64 {
        if ring == 0 || ring == rows { 1 } else { 2 }
    }

    fn least_of(&self, ring: usize, rows: usize) -> u64 {
        let pole = ring == 0 && self.lengths[0] == 0.0 || ring == rows && self.lengths[PROBES] == 0.0;
        if pole { 0 } else { self.least_segments as u64 }
    }

    /// Segments of each ring that make `count` triangles, at least [`Patch::fewest`] and even if it is closed.
    fn rings(&self, count: u64) -> Vec<u64> {
        let width = self.lengths.iter().sum::<f64>() / (PROBES + 1) as f64;
        let square = (count as f64 / 2.0 * self.height / width).sqrt() as usize;
        let most = (count / (2 * self.least_segments as u64)) as usize;
        let mut rows = square.clamp(self.least_rows, most.max(self.least_rows));
        while self.fewest_of(rows) > count {
            rows -= 1;
        }
        // A pole takes no segment, so that it must not be the last to be asked.
        let backwards = self.lengths[PROBES] == 0.0;
        let order = |i: usize| if backwards { rows - i } else { i };
        let share = |i: usize| self.weight(i, rows) as f64 * self.length(i, rows);
        let total: f64 = (0..=rows).map(|i| share(order(i))).sum();
        let spare = count - self.fewest_of(rows);
        let (mut segments, mut sum, mut used) = (vec![0; rows + 1], 0.0, 0);
        for ring in (0..=rows).map(order) {
            sum += share(ring);
            let last = ring == order(rows) || ring == order(rows - 1) && self.least_of(order(rows), rows) == 0;
            let target = if last { spare } else { ((spare as f64 * (sum / total)) as u64).min(spare) };
            let more = if self.length(ring, rows) > 0.0 { (target - used) / self.weight(ring, rows) } else { 0 };
            used += more * self.weight(ring, rows);
            segments[ring] = self.least_of(ring, rows) + more;
        }
        segments
    }

    fn length(&self, ring: usize, rows: usize) -> f64 {
        let at = ring as f64 / rows as f64 * PROBES as f64;
        let below = (at as usize).min(PROBES - 1);
        let share = at - below as f64;
        self.lengths[below] * (1.0 - share) + self.lengths[below + 1] * share
    }

    /// Cuts it into exactly `count` triangles.
    pub fn cut(&self, count: u64, sink: &mut dyn Sink) {
        let rings = self.rings(count);
        let rows = rings.len() - 1;
        let mut below = self.ring(rings[0], 0.0, sink);
        for (row, &segments) in rings.iter().enumerate().skip(1) {
            let above = self.ring(segments, row as f64 / rows as f64, sink);
            self.zip(&below, &above, sink);
            below = above;
        }
    }

    fn ring(&self, segments: u64, v: f64, sink: &mut dyn Sink) -> Ring {
        let ends = if self.wraps && segments > 0 { segments } else { segments + 1 };
        let mut first = 0;
        for i in 0..ends {
            let u = if segments == 0 { 0.0 } else { i as f64 / segments as f64 };
            let normal = (!self.flat).then(|| if segments == 0 { self.pole(v) } else { self.normal(u, v) });
            let number = sink.vertex((self.surface)(u, v), normal);
            if i == 0 {
                first = number;
            }
        }
        Ring { first, segments, ends }
    }

    /// Each triangle stands on the ring that is behind.
    fn zip(&self, below: &Ring, above: &Ring, sink: &mut dyn Sink) {
        let (mut i, mut j) = (0, 0);
        while i < below.segments || j < above.segments {
            let step = i < below.segments
                && (j == above.segments || (2 * i + 1) * above.segments <= (2 * j + 1) * below.segments);
            let third = if step { below.vertex(i + 1) } else { above.vertex(j + 1) };
            sink.triangle([below.vertex(i), third, above.vertex(j)], !self.flat);
            if step {
                i += 1;
            } else {
                j += 1;
            }
        }
    }

    fn normal(&self, u: f64, v: f64) -> DVec3 {
        let difference = |along: &dyn Fn(f64) -> DVec3, at: f64, wraps: bool| {
            let (least, most) =
                if wraps { (at - STEP, at + STEP) } else { ((at - STEP).max(0.0), (at + STEP).min(1.0)) };
            along(most) - along(least)
        };
        let across = difference(&|u| (self.surface)(u, v), u, self.wraps);
        let up = difference(&|v| (self.surface)(u, v), v, false);
        across.cross(up).normalize_or_zero()
    }

    fn pole(&self, v: f64) -> DVec3 {
        let beside = if v < 0.5 { STEP } else { 1.0 - STEP };
        let normals = (0..8).map(|i| self.normal((f64::from(i) + 0.5) / 8.0, beside));
        normals.sum::<DVec3>().normalize_or_zero()
    }
}

struct Ring {
    first: u64,
    segments: u64,
    ends: u64,
}

impl Ring {
    fn vertex(&self, i: u64) -> u64 {
        self.first + i % self.ends
    }
}

/// Makes the next leaf, of about this edge.
type Leaf = dyn Fn(&mut Random, f64) -> [DVec3; 3];

/// Loose triangles: leaves, blades of grass.
pub struct Leaves {
    leaf: Box<Leaf>,
    seed: u64,
    area: f64,
}

impl Leaves {
    /// Triangles as `leaf` makes them of edges of the given length, which together cover `area`.
    pub fn new(seed: u64, area: f64, leaf: impl Fn(&mut Random, f64) -> [DVec3; 3] + 'static) -> Self {
        Leaves { leaf: Box::new(leaf), seed, area }
    }

    /// What they cover.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Makes `count` of them.
    pub fn cut(&self, count: u64, sink: &mut dyn Sink) {
        let mut random = Random::new(self.seed);
        let edge = (2.0 * self.area / count.max(1) as f64).sqrt();
        for _ in 0..count {
            let corners = (self.leaf)(&mut random, edge).map(|corner| sink.vertex(corner, None));
            sink.triangle(corners, false);
        }
    }
}
