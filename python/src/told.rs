//! What is told of hits, a row each.

use std::ops::Range;

use eyerays::batch::Hit;
use eyerays::queries::{Place, Queries, Sink, Split};
use glam::{DVec3, Vec3};

/// Arrays of fields, and what is needed to fill them.
pub struct Columns<'a> {
    /// The arrays, all as long.
    pub arrays: Vec<Column<'a>>,
    /// Whose hits they are.
    pub queries: &'a Queries,
    /// What is added to places.
    pub offset: DVec3,
}

/// An array of a field, a row each.
pub enum Column<'a> {
    /// Distances, infinite where nothing is met.
    T(&'a mut [f32]),
    /// The same in double precision.
    LongT(&'a mut [f64]),
    /// Triangles of their objects; -1 where nothing is met.
    Triangle(&'a mut [i32]),
    /// The same in 64 bits.
    LongTriangle(&'a mut [i64]),
    /// Objects; -1 where nothing is met.
    Object(&'a mut [i32]),
    /// The same in 64 bits.
    LongObject(&'a mut [i64]),
    /// Weights of the second and the third vertex; NaN where nothing is met, as all that follows.
    Uv(&'a mut [[f32; 2]]),
    /// Unit normals.
    Normal(&'a mut [[f32; 3]]),
    /// Places.
    Point(&'a mut [[f64; 3]]),
    /// Bounds of errors.
    Error(&'a mut [f32]),
}

/// Does something with a column's rows and makes columns of the same kind of that.
macro_rules! rows {
    ($column:expr, $rows:ident => $made:expr) => {
        match $column {
            Column::T($rows) => $made.map(Column::T),
            Column::LongT($rows) => $made.map(Column::LongT),
            Column::Triangle($rows) => $made.map(Column::Triangle),
            Column::LongTriangle($rows) => $made.map(Column::LongTriangle),
            Column::Object($rows) => $made.map(Column::Object),
            Column::LongObject($rows) => $made.map(Column::LongObject),
            Column::Uv($rows) => $made.map(Column::Uv),
            Column::Normal($rows) => $made.map(Column::Normal),
            Column::Point($rows) => $made.map(Column::Point),
            Column::Error($rows) => $made.map(Column::Error),
        }
    };
}

const NOWHERE: Place = Place { point: DVec3::NAN, normal: Vec3::NAN, error: f64::NAN };

impl Column<'_> {
    /// Some of the rows.
    pub fn rows(&mut self, range: Range<usize>) -> Column<'_> {
        let [some] = rows!(self, rows => [&mut rows[range]]);
        some
    }

    fn split(self, at: usize) -> [Self; 2] {
        rows!(self, rows => <[_; 2]>::from(rows.split_at_mut(at)))
    }

    fn needs_place(&self) -> bool {
        matches!(self, Column::Normal(_) | Column::Point(_) | Column::Error(_))
    }

    /// Fills the rows with what is told of neighbours' hits, and of their places if these are needed.
    fn fill(self, queries: &Queries, hits: &[Option<Hit>], places: &[Place]) {
        let surface = |hit: &Hit| queries.surface(hit).unwrap_or_default();
        let object = |hit: &Option<Hit>| hit.as_ref().map_or(-1, |hit| i64::from(surface(hit).0));
        let triangle = |hit: &Option<Hit>| hit.as_ref().map_or(-1, |hit| i64::from(surface(hit).1));
        let t = |hit: &Option<Hit>| hit.as_ref().map_or(f64::INFINITY, |hit| hit.t);
        // What is met is not infinitely far.
        let short = |hit: &Option<Hit>| hit.as_ref().map_or(f32::INFINITY, |hit| hit.t.min(f32::MAX.into()) as f32);
        let uv = |hit: &Option<Hit>| hit.as_ref().map_or([f32::NAN; 2], |hit| hit.coordinates);
        match self {
            Column::T(rows) => set(rows, hits, short),
            Column::LongT(rows) => set(rows, hits, t),
            Column::Triangle(rows) => set(rows, hits, |hit| triangle(hit) as i32),
            Column::LongTriangle(rows) => set(rows, hits, triangle),
            Column::Object(rows) => set(rows, hits, |hit| object(hit) as i32),
            Column::LongObject(rows) => set(rows, hits, object),
            Column::Uv(rows) => set(rows, hits, uv),
            Column::Normal(rows) => set(rows, places, |place| place.normal.to_array()),
            Column::Point(rows) => set(rows, places, |place| place.point.to_array()),
            Column::Error(rows) => set(rows, places, |place| place.error as f32),
        }
    }
}

#[inline]
fn set<T, F>(rows: &mut [T], of: &[F], value: impl Fn(&F) -> T) {
    rows.iter_mut().zip(of).for_each(|(to, of)| *to = value(of));
}

/// Rows that a thread fills.
const TASK: usize = 2048;

impl Columns<'_> {
    /// Some of the rows.
    pub fn rows(&mut self, range: &Range<usize>) -> Columns<'_> {
        let arrays = self.arrays.iter_mut().map(|column| column.rows(range.clone())).collect();
        Columns { arrays, ..*self }
    }

    /// Tells of as many things as there are rows, with many threads: what each is, and where.
    pub fn tell<A: Sync>(
        self,
        of: &[A],
        hit: &(impl Fn(&A) -> Option<Hit> + Sync),
        place: &(impl Fn(&A) -> Option<Place> + Sync),
    ) {
        if of.len() <= TASK {
            let hits: Vec<_> = of.iter().map(hit).collect();
            return self.fill(&hits, |row| place(&of[row]));
        }
        let half = of.len() / 2;
        let ((first, second), (before, after)) = (self.split_at(half), of.split_at(half));
        rayon::join(|| first.tell(before, hit, place), || second.tell(after, hit, place));
    }

    fn fill(self, hits: &[Option<Hit>], place: impl Fn(usize) -> Option<Place>) {
        let Columns { arrays, queries, offset } = self;
        let moved = |place: Place| Place { point: place.point + offset, ..place };
        let rows = if arrays.iter().any(Column::needs_place) { 0..hits.len() } else { 0..0 };
        let places: Vec<Place> = rows.map(|row| place(row).map_or(NOWHERE, moved)).collect();
        arrays.into_iter().for_each(|column| column.fill(queries, hits, &places));
    }
}

impl Split for Columns<'_> {
    fn split_at(self, rows: usize) -> (Self, Self) {
        let Columns { arrays, queries, offset } = self;
        let (first, second) = arrays.into_iter().map(|column| <(_, _)>::from(column.split(rows))).unzip();
        (Columns { arrays: first, queries, offset }, Columns { arrays: second, queries, offset })
    }
}

impl Sink<Option<Hit>> for Columns<'_> {
    fn take(self, hits: &[Option<Hit>]) {
        let queries = self.queries;
        self.fill(hits, |row| queries.place(hits[row].as_ref()?));
    }
}
