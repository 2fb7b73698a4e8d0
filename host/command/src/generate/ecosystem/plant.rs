//! A plant: a stem, and leaves that hang from it.

use glam::{DVec3, Vec3};

use crate::generate::circle::turn;
use crate::generate::random::Random;

/// Sides of a stem, and its segments.
const SIDES: usize = 6;
const SEGMENTS: usize = 12;
/// Triangles of a stem.
const STEM: usize = 2 * SIDES * SEGMENTS;
/// Places along a leaf where it bends, and its triangles.
const BENDS: usize = 4;
const LEAF: usize = 2 * BENDS;

/// A kind of plant, a unit high, which stands at the origin.
pub struct Plant {
    /// Its stem and its leaves.
    pub parts: [Part; 2],
}

/// What is of one material.
#[derive(Default)]
pub struct Part {
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Three of them each, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Linear RGB.
    pub colour: [f32; 3],
}

/// What makes leaves of a kind alike.
struct Habit {
    /// Length and width of the lowest.
    length: f64,
    width: f64,
    /// How far they bend down.
    droop: f64,
    /// How much they point up.
    rise: f64,
    /// How much of the stem is bare.
    bare: f64,
}

impl Plant {
    /// A kind of a number, of its own seed.
    pub fn new(kind: usize, random: &mut Random) -> Self {
        let habit = Habit {
            length: random.within(0.12, 0.5),
            width: random.within(0.02, 0.09),
            droop: random.within(0.0, 0.8),
            rise: random.within(-0.2, 0.9),
            bare: random.within(0.0, 0.5),
        };
        let leaning = DVec3::new(random.within(-0.15, 0.15), 0.0, random.within(-0.15, 0.15));
        let along = |share: f64| DVec3::Y * share + leaning * share * share;
        let mut leaves = Part { colour: green(random), ..Part::default() };
        for _ in 0..leaves_of(kind) {
            let share = random.within(habit.bare, 1.0);
            leaves.leaf(along(share), &habit, share, random);
        }
        let thick = random.within(0.008, 0.02);
        let colour = [0.16, 0.11, 0.06].map(|channel: f32| channel * random.within(0.6, 1.4) as f32);
        let mut stem = Part { colour, ..Part::default() };
        stem.stem(along, thick);
        Plant { parts: [stem, leaves] }
    }

    /// Its triangles.
    pub fn triangles(&self) -> usize {
        self.parts.iter().map(|part| part.triangles.len()).sum()
    }
}

/// Leaves of a kind: with their stem the kinds have from 1,700 to 7,000 triangles.
fn leaves_of(kind: usize) -> usize {
    (1_700 + 79 * kind - STEM) / LEAF
}

fn green(random: &mut Random) -> [f32; 3] {
    let (light, warm) = (random.within(0.5, 1.3), random.within(0.3, 1.0));
    [0.22 * light * warm, 0.30 * light, 0.07 * light].map(|channel| channel as f32)
}

impl Part {
    /// A tapering tube along a line.
    fn stem(&mut self, along: impl Fn(f64) -> DVec3, thick: f64) {
        for ring in 0..=SEGMENTS {
            let share = ring as f64 / SEGMENTS as f64;
            let radius = thick * (1.05 - share);
            for side in 0..SIDES {
                let (x, z) = turn(side as f64 / SIDES as f64);
                self.positions.push((along(share) + DVec3::new(x, 0.0, z) * radius).as_vec3());
            }
        }
        for ring in 0..SEGMENTS {
            for side in 0..SIDES {
                let at = |ring: usize, side: usize| (ring * SIDES + side % SIDES) as u32;
                let (a, b, c, d) = (at(ring, side), at(ring, side + 1), at(ring + 1, side + 1), at(ring + 1, side));
                self.triangles.extend([[a, d, c], [a, c, b]]);
            }
        }
    }

    /// A strip that bends down, wide in its middle; leaves near the top are shorter.
    fn leaf(&mut self, from: DVec3, habit: &Habit, share: f64, random: &mut Random) {
        let out = random.direction();
        let out = DVec3::new(out.x, 0.3 * out.y + habit.rise, out.z).normalize();
        let across = out.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
        let length = habit.length * (1.2 - share) * random.within(0.6, 1.2);
        let first = self.positions.len() as u32;
        for bend in 0..=BENDS {
            let t = bend as f64 / BENDS as f64;
            let middle = from + out * (length * t) - DVec3::Y * (habit.droop * length * t * t);
            // A parabola's width, and next to nothing at the ends.
            let half = across * (0.5 * habit.width * (4.0 * t * (1.0 - t) + 0.05));
            self.positions.extend([(middle - half).as_vec3(), (middle + half).as_vec3()]);
        }
        for bend in 0..BENDS as u32 {
            let [a, b, c, d] = [0, 1, 2, 3].map(|corner| first + 2 * bend + corner);
            self.triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_its_number_of_triangles_and_stands_on_the_ground() {
        for kind in 0..68 {
            let plant = Plant::new(kind, &mut Random::new(kind as u64));
            let wanted = 1_700 + 79 * kind;
            assert!((wanted - LEAF..=wanted).contains(&plant.triangles()), "{kind}");
            let lowest = plant.parts[0].positions.iter().map(|p| p.y).fold(1.0, f32::min);
            let highest = plant.parts[0].positions.iter().map(|p| p.y).fold(0.0, f32::max);
            assert_eq!((lowest, highest), (0.0, 1.0));
        }
    }
}
