//! A conference hall: a closed box of regular furniture, most of its triangles in chairs.

mod furniture;
mod room;
mod tableware;

use super::frame::Frame;
use super::model::{Finish, Light, Material, Model, View};
use super::random::Random;
use super::shape::at;

/// Half the length and the width of the room, and its height.
const HALF: (f64, f64, f64) = (10.0, 6.0, 4.6);
/// Half the length and the width of the table, and its height.
const TABLE: (f64, f64, f64) = (6.6, 1.3, 0.75);

/// What few triangles leave out, first to last.
pub const LEAST: [&str; 8] = ["tableware", "plants", "curtains", "lamps", "panels", "windows", "board", "doors"];

/// The hall of a seed.
pub fn model(seed: u64) -> Model {
    let mut random = Random::new(seed);
    let mut hall = Model::new(views(), &materials(&mut random));
    hall.ambient = [0.22, 0.22, 0.24];
    for (x, z, colour) in [(-4.4, 0.0, 0.4), (4.4, 0.0, 0.4), (0.0, 4.6, 0.2)] {
        let colour = [colour, colour * 0.95, colour * 0.85];
        hall.lights.push(Light { position: at(x, 2.72, z), colour });
    }
    room::build(&mut hall, &mut random);
    furniture::table(&mut hall);
    for seat in seats() {
        let seat = seat.moved(random.within(-0.06, 0.06), 0.0, random.within(-0.05, 0.12));
        furniture::chair(&mut hall, seat.turned(random.within(-0.03, 0.03)));
    }
    for place in seats() {
        tableware::place(&mut hall, place, &mut random);
    }
    tableware::carafes(&mut hall, &mut random);
    furniture::lamps(&mut hall);
    furniture::plants(&mut hall, &mut random);
    room::curtains(&mut hall, &mut random);
    hall
}

/// The floor under each chair, which faces along z.
fn seats() -> Vec<Frame> {
    let sides = (0..10).flat_map(|i| {
        let x = (f64::from(i) - 4.5) * 1.22;
        [Frame::at(x, 0.0, -TABLE.1 - 0.35), Frame::at(x, 0.0, TABLE.1 + 0.35).turned(0.5)]
    });
    let ends = [-1.0, 1.0].map(|end| Frame::at(end * (TABLE.0 + 0.4), 0.0, 0.0).turned(-end * 0.25));
    sides.chain(ends).collect()
}

fn views() -> [View; 5] {
    [
        View { eye: at(-9.2, 2.6, 4.8), target: at(1.0, 0.9, -0.8), fov: 60.0 },
        View { eye: at(8.9, 1.7, -4.6), target: at(-1.5, 1.0, 0.5), fov: 60.0 },
        View { eye: at(-8.6, 1.6, 0.25), target: at(4.0, 0.9, 0.0), fov: 55.0 },
        View { eye: at(0.3, 1.75, 5.2), target: at(-1.0, 1.0, -3.0), fov: 70.0 },
        View { eye: at(3.2, 1.25, -0.4), target: at(-1.2, 0.75, 0.25), fov: 65.0 },
    ]
}

fn materials(random: &mut Random) -> Vec<Material> {
    let seats = [[0.35, 0.06, 0.05], [0.05, 0.12, 0.3], [0.06, 0.22, 0.12], [0.28, 0.16, 0.07]];
    let fabrics = [[0.55, 0.42, 0.2], [0.32, 0.12, 0.14], [0.25, 0.33, 0.42], [0.5, 0.48, 0.42]];
    let mut pick = |colours: [[f64; 3]; 4]| colours[(random.bits() & 3) as usize];
    let (leather, fabric) = (pick(seats), pick(fabrics));
    let dull = |name, diffuse| Material { name, diffuse, specular: 0.0, shininess: 1.0, finish: Finish::Dull };
    let shiny = |name, diffuse, specular| Material { specular, shininess: 60.0, ..dull(name, diffuse) };
    let mirror = |name, diffuse, specular| Material { finish: Finish::Mirror, ..shiny(name, diffuse, specular) };
    vec![
        dull("plaster", [0.68, 0.66, 0.61]),
        dull("carpet", [0.24, 0.21, 0.2]),
        shiny("panel", [0.36, 0.22, 0.11], 0.1),
        mirror("table", [0.3, 0.15, 0.07], 0.14),
        shiny("leather", leather, 0.2),
        shiny("steel", [0.35, 0.35, 0.37], 0.5),
        mirror("mirror", [0.03, 0.03, 0.03], 0.88),
        mirror("pane", [0.02, 0.03, 0.06], 0.3),
        Material { finish: Finish::Glass, shininess: 200.0, ..shiny("glass", [0.95, 0.98, 0.96], 0.6) },
        dull("paper", [0.85, 0.85, 0.82]),
        shiny("shade", [0.7, 0.55, 0.2], 0.3),
        dull("leaf", [0.12, 0.34, 0.08]),
        dull("clay", [0.5, 0.24, 0.13]),
        dull("fabric", fabric),
    ]
}
