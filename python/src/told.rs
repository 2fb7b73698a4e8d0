//! What is told of hits, a row each.

use std::ops::Range;

use eyerays::batch::Hit;
use eyerays::queries::{Crossings, Hits, Nearest, Place};
use glam::{DVec3, Vec3};

/// Hits by their numbers.
pub trait Told: Sync {
    /// What was met, with its distance.
    fn hit(&self, row: usize) -> Option<Hit>;
    /// The object, and which of its triangles.
    fn surface(&self, hit: &Hit) -> Option<(u32, u32)>;
    /// Where.
    fn place(&self, row: usize) -> Option<Place>;
}

impl Told for Hits {
    fn hit(&self, row: usize) -> Option<Hit> {
        Hits::hit(self, row)
    }

    fn surface(&self, hit: &Hit) -> Option<(u32, u32)> {
        Hits::surface(self, hit)
    }

    fn place(&self, row: usize) -> Option<Place> {
        Hits::place(self, row)
    }
}

impl Told for Nearest {
    fn hit(&self, row: usize) -> Option<Hit> {
        Nearest::hit(self, row)
    }

    fn surface(&self, hit: &Hit) -> Option<(u32, u32)> {
        Nearest::surface(self, hit)
    }

    fn place(&self, row: usize) -> Option<Place> {
        Nearest::place(self, row)
    }
}

impl Told for Crossings {
    fn hit(&self, row: usize) -> Option<Hit> {
        Crossings::hit(self, row)
    }

    fn surface(&self, hit: &Hit) -> Option<(u32, u32)> {
        Crossings::surface(self, hit)
    }

    fn place(&self, row: usize) -> Option<Place> {
        Crossings::place(self, row)
    }
}

/// Hits, and where they are told of.
pub struct Block<'a, T> {
    /// What has been met.
    pub told: &'a T,
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

/// What is told of a row.
struct Row {
    t: f64,
    uv: [f32; 2],
    /// The object, and which of its triangles.
    surface: (i64, i64),
    place: Place,
}

const NOWHERE: Place = Place { point: DVec3::NAN, normal: Vec3::NAN, error: f64::NAN };
/// Rows that a thread fills.
const TASK: usize = 2048;

impl Column<'_> {
    /// Some of the rows.
    pub fn rows(&mut self, range: Range<usize>) -> Column<'_> {
        let [some] = rows!(self, rows => [&mut rows[range]]);
        some
    }

    fn split(self, at: usize) -> [Self; 2] {
        rows!(self, rows => <[_; 2]>::from(rows.split_at_mut(at)))
    }

    fn needs_surface(&self) -> bool {
        use Column::{LongObject, LongTriangle, Object, Triangle};
        matches!(self, Triangle(_) | LongTriangle(_) | Object(_) | LongObject(_))
    }

    fn needs_place(&self) -> bool {
        matches!(self, Column::Normal(_) | Column::Point(_) | Column::Error(_))
    }

    fn set(&mut self, to: usize, row: &Row) {
        match self {
            // What is met is not infinitely far.
            Column::T(rows) if row.t.is_finite() => rows[to] = row.t.min(f32::MAX.into()) as f32,
            Column::T(rows) => rows[to] = f32::INFINITY,
            Column::LongT(rows) => rows[to] = row.t,
            Column::Triangle(rows) => rows[to] = row.surface.1 as i32,
            Column::LongTriangle(rows) => rows[to] = row.surface.1,
            Column::Object(rows) => rows[to] = row.surface.0 as i32,
            Column::LongObject(rows) => rows[to] = row.surface.0,
            Column::Uv(rows) => rows[to] = row.uv,
            Column::Normal(rows) => rows[to] = row.place.normal.to_array(),
            Column::Point(rows) => rows[to] = row.place.point.to_array(),
            Column::Error(rows) => rows[to] = row.place.error as f32,
        }
    }
}

/// Tells so many rows of a block into columns that are as long.
pub fn tell<T: Told>(block: &Block<'_, T>, rows: Range<usize>, mut columns: Vec<Column<'_>>) {
    if rows.len() > TASK {
        let (half, middle) = (rows.len() / 2, rows.start + rows.len() / 2);
        let (first, second) = columns.into_iter().map(|column| <(_, _)>::from(column.split(half))).unzip();
        let (before, after) = (rows.start..middle, middle..rows.end);
        rayon::join(|| tell(block, before, first), || tell(block, after, second));
        return;
    }
    let surfaces = columns.iter().any(Column::needs_surface);
    let places = columns.iter().any(Column::needs_place);
    for (to, row) in rows.enumerate() {
        let row = block.row(row, surfaces, places);
        columns.iter_mut().for_each(|column| column.set(to, &row));
    }
}

impl<T: Told> Block<'_, T> {
    fn row(&self, row: usize, surfaces: bool, places: bool) -> Row {
        let Some(hit) = self.told.hit(row) else {
            return Row { t: f64::INFINITY, uv: [f32::NAN; 2], surface: (-1, -1), place: NOWHERE };
        };
        let surface = if surfaces { self.told.surface(&hit).unwrap_or_default() } else { (0, 0) };
        let place = if places { self.told.place(row).unwrap_or(NOWHERE) } else { NOWHERE };
        Row {
            t: hit.t,
            uv: hit.coordinates,
            surface: (surface.0.into(), surface.1.into()),
            place: Place { point: place.point + self.offset, ..place },
        }
    }
}
