//! A round clearing under the sky: most triangles are in the one figure in its middle.

mod figure;
mod ground;
mod tree;

use glam::DVec3;

use super::model::{Finish, Light, Material, Model, View};
use super::patch::Leaves;
use super::random::Random;
use super::shape::at;

/// What of the triangles that are dealt out goes to the figure.
const FIGURE_SHARE: f64 = 0.68;

/// What few triangles leave out, first to last.
pub const LEAST: [&str; 2] = ["rocks", "mushrooms"];

/// The forest of a seed.
pub fn model(seed: u64) -> Model {
    let mut random = Random::new(seed);
    let mut forest = Model::new(views(), &materials(&mut random));
    forest.ambient = [0.3, 0.32, 0.36];
    forest.sky = Some([[0.85, 0.88, 0.9], [0.3, 0.5, 0.8]]);
    forest.lights.push(Light { position: at(20.0, 34.0, 26.0), colour: [0.72, 0.67, 0.55] });
    forest.lights.push(Light { position: at(-14.0, 9.0, 4.0), colour: [0.2, 0.22, 0.28] });
    let ground = ground::Ground::new(&mut random);
    figure::build(&mut forest, &mut random);
    for place in ring(&mut random) {
        tree::build(&mut forest, ground.on(place), &mut random);
    }
    ground.strew(&mut forest, &mut random);
    ground.build(&mut forest);
    forest.share("figure", FIGURE_SHARE);
    forest
}

/// Trees where the first of many places leave each other room.
fn ring(random: &mut Random) -> Vec<DVec3> {
    const TREES: usize = 32;
    let mut places: Vec<DVec3> = Vec::new();
    while places.len() < TREES {
        let place = at(random.within(-24.0, 24.0), 0.0, random.within(-24.0, 24.0));
        let apart = 2.4;
        if (10.5..23.0).contains(&place.length()) && places.iter().all(|p| p.distance(place) > apart) {
            places.push(place);
        }
    }
    places
}

/// The eyes of the views stay clear of whatever is strewn about.
fn views() -> [View; 5] {
    [
        View { eye: at(0.6, 1.9, 8.2), target: at(0.0, 2.1, 0.0), fov: 55.0 },
        View { eye: at(6.2, 2.4, 2.6), target: at(-0.8, 1.6, -0.4), fov: 60.0 },
        View { eye: at(1.5, 2.5, 3.0), target: at(0.0, 2.1, 0.0), fov: 48.0 },
        View { eye: at(2.8, 3.2, -4.4), target: at(-2.0, 1.0, 2.2), fov: 65.0 },
        View { eye: at(-6.4, 0.9, 4.6), target: at(0.4, 1.9, -0.6), fov: 55.0 },
    ]
}

/// Blades, needles and leaves: a triangle on `base` towards `tip`, and its edge for the size.
fn blade(base: DVec3, tip: DVec3, aside: DVec3, edge: f64) -> [DVec3; 3] {
    // Few leaves would be as large as the tree.
    let edge = edge.min(0.75);
    let side = tip.cross(aside).normalize_or(DVec3::X) * (0.35 * edge);
    [base - side, base + side, base + tip * (1.4 * edge)]
}

/// Leaves in a ball that is pressed into `radii`, covering `area`.
fn bush(seed: u64, middle: DVec3, radii: DVec3, area: f64) -> Leaves {
    Leaves::new(seed, area, move |random, edge| {
        let out = random.direction();
        let base = middle + out * radii * (0.55 + 0.45 * random.unit());
        let tip = (out + random.direction()).normalize_or(DVec3::Y);
        blade(base, tip, random.direction(), edge)
    })
}

fn materials(random: &mut Random) -> Vec<Material> {
    let gowns = [[0.62, 0.6, 0.66], [0.5, 0.62, 0.68], [0.66, 0.52, 0.4], [0.55, 0.64, 0.5]];
    let gown = gowns[(random.bits() & 3) as usize];
    let shade = random.within(0.85, 1.15);
    let green = |g: [f64; 3]| g.map(|c| (c * shade * 1000.0).round() / 1000.0);
    let dull = |name, diffuse| Material { name, diffuse, specular: 0.0, shininess: 1.0, finish: Finish::Dull };
    let shiny = |name, diffuse, specular| Material { specular, shininess: 40.0, ..dull(name, diffuse) };
    let mirror = |name, diffuse, specular| Material { finish: Finish::Mirror, ..shiny(name, diffuse, specular) };
    let glass = |name, diffuse| Material { finish: Finish::Glass, shininess: 200.0, ..shiny(name, diffuse, 0.6) };
    vec![
        dull("stone", [0.42, 0.41, 0.39]),
        shiny("gown", gown, 0.15),
        shiny("skin", [0.72, 0.5, 0.38], 0.1),
        shiny("hair", [0.42, 0.24, 0.08], 0.25),
        glass("wing", [0.85, 0.94, 0.97]),
        glass("orb", [0.95, 0.98, 1.0]),
        mirror("silver", [0.08, 0.08, 0.09], 0.8),
        mirror("water", [0.04, 0.06, 0.07], 0.6),
        dull("bark", [0.27, 0.19, 0.13]),
        dull("leaf", green([0.17, 0.36, 0.09])),
        dull("needle", green([0.07, 0.22, 0.1])),
        dull("soil", green([0.22, 0.26, 0.1])),
        dull("blade", green([0.24, 0.4, 0.1])),
        shiny("cap", [0.62, 0.1, 0.06], 0.2),
        dull("stem", [0.78, 0.72, 0.6]),
    ]
}
