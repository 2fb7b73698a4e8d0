//! A nave with aisles, a crossing under a dome and an apse; much of it is hidden behind columns and walls.

mod arch;
mod column;
mod crossing;
mod fittings;
mod nave;
mod vault;

use super::model::{Finish, Light, Material, Model, View};
use super::patch::Patch;
use super::random::Random;
use super::shape::at;

/// Half the nave's width between its walls, which is the radius of all that spans it.
const NAVE: f64 = 3.6;
/// The side of the arcade's wall towards the aisle, the aisle's middle, and its outer wall.
const AISLE: (f64, f64, f64) = (4.4, 6.2, 8.0);
/// The length of a bay.
const BAY: f64 = 4.0;
/// Where the nave, the crossing, the choir and the apse begin.
const ALONG: [f64; 4] = [-24.0, 4.0, 4.0 + 2.0 * NAVE, 8.0 + 2.0 * NAVE];
/// Where arcade, aisle vaults and nave vaults spring.
const SPRING: (f64, f64, f64) = (4.2, 5.0, 8.4);
/// Both sides of the axis.
const SIDES: [f64; 2] = [-1.0, 1.0];

/// What few triangles leave out, first to last.
pub const LEAST: [&str; 10] =
    ["crypt", "roof", "font", "lamps", "pews", "choir", "ribs", "colonnade", "arches", "windows"];

/// The cathedral of a seed.
pub fn model(seed: u64) -> Model {
    let mut random = Random::new(seed);
    let mut church = Model::new(views(), &materials(&mut random));
    church.ambient = [0.24, 0.24, 0.26];
    church.checker = Some(("marble", [0.2, 0.17, 0.16], 0.9));
    for (y, z, colour) in [(6.3, -15.0, 0.36), (11.0, 7.6, 0.36), (4.8, 13.4, 0.18)] {
        church.lights.push(Light { position: at(0.0, y, z), colour: [colour, colour * 0.93, colour * 0.8] });
    }
    shell(&mut church);
    nave::build(&mut church, &mut random);
    crossing::build(&mut church, &mut random);
    fittings::build(&mut church, &mut random);
    crossing::apse(&mut church);
    church
}

/// A box around it all, so that no ray leaves through a seam, and the floor.
fn shell(church: &mut Model) {
    let (x, low, high, front, back) = (9.0, -3.2, 19.5, -25.0, 20.0);
    let (wide, tall, long) = (at(2.0 * x, 0.0, 0.0), at(0.0, high - low, 0.0), at(0.0, 0.0, back - front));
    let corner = at(-x, low, front);
    let opposite = at(x, high, back);
    let planes = [
        Patch::quad(corner, wide, tall),
        Patch::quad(corner, long, wide),
        Patch::quad(corner, tall, long),
        Patch::quad(opposite, -tall, -wide),
        Patch::quad(opposite, -wide, -long),
        Patch::quad(opposite, -long, -tall),
    ];
    church.add_all("shell", "stone", 0.0, planes);
    church.add("floor", "marble", 0.0, Patch::quad(at(-x, 0.0, front), long, wide));
}

fn views() -> [View; 5] {
    [
        View { eye: at(0.3, 2.1, -22.5), target: at(0.0, 4.6, 0.0), fov: 62.0 },
        View { eye: at(-1.6, 1.7, -2.0), target: at(1.0, 6.2, 14.0), fov: 68.0 },
        View { eye: at(-6.3, 2.0, -23.0), target: at(-5.0, 2.6, 0.0), fov: 60.0 },
        View { eye: at(-2.2, 1.8, 4.6), target: at(1.2, 13.0, 9.2), fov: 75.0 },
        View { eye: at(2.6, 6.2, 12.6), target: at(-1.2, 3.6, -12.0), fov: 65.0 },
    ]
}

fn materials(random: &mut Random) -> Vec<Material> {
    let stones = [[0.54, 0.49, 0.41], [0.5, 0.49, 0.47], [0.56, 0.47, 0.39], [0.48, 0.49, 0.44]];
    let stone: [f64; 3] = stones[(random.bits() & 3) as usize];
    let dull = |name, diffuse| Material { name, diffuse, specular: 0.0, shininess: 1.0, finish: Finish::Dull };
    let shiny = |name, diffuse, specular| Material { specular, shininess: 60.0, ..dull(name, diffuse) };
    let mirror = |name, diffuse, specular| Material { finish: Finish::Mirror, ..shiny(name, diffuse, specular) };
    let glass = |name, diffuse| Material { finish: Finish::Glass, shininess: 200.0, ..shiny(name, diffuse, 0.6) };
    vec![
        dull("stone", stone),
        dull("vault", stone.map(|c| (c * 1120.0).round() / 1000.0)),
        dull("pillar", stone.map(|c| (c * 900.0).round() / 1000.0)),
        mirror("marble", [0.5, 0.47, 0.43], 0.16),
        mirror("blue", [0.05, 0.12, 0.4], 0.25),
        mirror("red", [0.4, 0.06, 0.06], 0.25),
        mirror("gold", [0.4, 0.27, 0.06], 0.4),
        glass("glass", [0.97, 0.95, 0.88]),
        glass("water", [0.9, 0.96, 0.97]),
        shiny("wood", [0.26, 0.14, 0.07], 0.1),
        dull("linen", [0.8, 0.78, 0.72]),
        shiny("iron", [0.1, 0.1, 0.11], 0.3),
    ]
}

/// One of the windows' colours.
fn pane(random: &mut Random) -> &'static str {
    ["blue", "red", "blue", "gold"][(random.bits() & 3) as usize]
}
