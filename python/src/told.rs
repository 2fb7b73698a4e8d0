//! What is told of hits, a row each.

use std::ops::Range;

use eyerays::queries::{Answered, Hits, Place, Sink, Split};
use glam::{DVec3, Vec3};

/// Arrays of fields, and what is added to places.
pub struct Columns<'a> {
    /// The arrays, all as long.
    pub arrays: Vec<Column<'a>>,
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

    /// Fills the rows with what is told of neighbours, the first of which is `start`, and of their places if these are needed.
    fn fill(self, answers: &impl Answered, start: usize, places: &[Place]) {
        let t = |i| answers.hit(i).map_or(f64::INFINITY, |hit| hit.t);
        // What is met is not infinitely far.
        let short = |i| answers.hit(i).map_or(f32::INFINITY, |hit| hit.t.min(f32::MAX.into()) as f32);
        let surface = |i| answers.hit(i).map(|hit| answers.surface(&hit).unwrap_or_default());
        let object = |i| surface(i).map_or(-1, |(object, _)| i64::from(object));
        let triangle = |i| surface(i).map_or(-1, |(_, triangle)| i64::from(triangle));
        let uv = |i| answers.hit(i).map_or([f32::NAN; 2], |hit| hit.coordinates);
        match self {
            Column::T(rows) => set(rows, start.., short),
            Column::LongT(rows) => set(rows, start.., t),
            Column::Triangle(rows) => set(rows, start.., |i| triangle(i) as i32),
            Column::LongTriangle(rows) => set(rows, start.., triangle),
            Column::Object(rows) => set(rows, start.., |i| object(i) as i32),
            Column::LongObject(rows) => set(rows, start.., object),
            Column::Uv(rows) => set(rows, start.., uv),
            Column::Normal(rows) => set(rows, places, |place| place.normal.to_array()),
            Column::Point(rows) => set(rows, places, |place| place.point.to_array()),
            Column::Error(rows) => set(rows, places, |place| place.error as f32),
        }
    }
}

#[inline]
fn set<T, F>(rows: &mut [T], of: impl IntoIterator<Item = F>, value: impl Fn(F) -> T) {
    rows.iter_mut().zip(of).for_each(|(to, of)| *to = value(of));
}

/// Rows that a thread fills.
const TASK: usize = 2048;

impl Columns<'_> {
    /// Some of the rows.
    pub fn rows(&mut self, range: &Range<usize>) -> Columns<'_> {
        let arrays = self.arrays.iter_mut().map(|column| column.rows(range.clone())).collect();
        Columns { arrays, offset: self.offset }
    }

    /// Tells so many answers, a row each, with many threads.
    pub fn tell(self, answers: &impl Answered, range: Range<usize>) {
        if range.len() <= TASK {
            return self.tell_here(answers, range);
        }
        let (half, middle) = (range.len() / 2, range.start + range.len() / 2);
        let (first, second) = self.split_at(half);
        let (before, after) = (range.start..middle, middle..range.end);
        rayon::join(|| first.tell(answers, before), || second.tell(answers, after));
    }

    fn tell_here(self, answers: &impl Answered, range: Range<usize>) {
        let has_places = self.arrays.iter().any(Column::needs_place);
        let (start, placed) = (range.start, if has_places { range } else { 0..0 });
        let places: Vec<Place> = placed.map(|number| self.place(answers, number)).collect();
        self.arrays.into_iter().for_each(|column| column.fill(answers, start, &places));
    }

    fn place(&self, answers: &impl Answered, number: usize) -> Place {
        let place = answers.place(number).unwrap_or(NOWHERE);
        Place { point: place.point + self.offset, ..place }
    }
}

impl Split for Columns<'_> {
    fn split_at(self, rows: usize) -> (Self, Self) {
        let offset = self.offset;
        let (first, second) = self.arrays.into_iter().map(|column| <(_, _)>::from(column.split(rows))).unzip();
        (Columns { arrays: first, offset }, Columns { arrays: second, offset })
    }
}

impl Sink<Hits<'_>> for Columns<'_> {
    fn take(self, hits: &Hits<'_>) {
        let all = 0..hits.len();
        self.tell_here(hits, all);
    }
}
