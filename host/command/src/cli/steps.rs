//! The steps of a ray as text.

use std::fmt::{self, Display, Formatter};
use std::path::Path;

use glam::Vec3;

use super::plural;
use crate::error::printable;
use eyerays::pick::{Pick, Surface};
use eyerays::scene::Camera;
use eyerays::trail::{Aim, Child, Fate, Outcome, Step, Target, Test, Trail, Visit};

/// What a pixel shows, and the steps of its ray by some methods.
pub(super) struct Told<'a> {
    pub path: &'a Path,
    pub size: (u32, u32),
    pub aim: Aim,
    pub camera: &'a Camera,
    /// What kernels multiply lengths by.
    pub scale: f64,
    pub pick: Option<&'a Pick>,
    pub trails: &'a [Trail],
}

impl Display for Told<'_> {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        let (Aim { x, y, sample }, (width, height)) = (self.aim, self.size);
        let through = sample.map_or_else(|| "the middle".to_owned(), |sample| format!("sample {sample}"));
        let (scene, camera) = (self.path.display().to_string(), printable(&self.camera.name));
        writeln!(out, "{}: {through} of pixel {x},{y} of {width}x{height}, camera \"{camera}\"", printable(&scene))?;
        match self.pick {
            Some(pick) => seen(out, pick)?,
            None => writeln!(out, "sees nothing")?,
        }
        writeln!(out, "  kernels   have lengths times {}", self.scale)?;
        self.trails.iter().try_for_each(|trail| way(out, trail))
    }
}

fn seen(out: &mut Formatter<'_>, pick: &Pick) -> fmt::Result {
    let Surface { primitive, kind, object, material, .. } = &pick.surface;
    writeln!(out, "sees {}, material {} \"{}\"", called(&pick.surface), material.number, printable(&material.name))?;
    if let Some(object) = object {
        writeln!(out, "  mesh      {} \"{}\"", object.number, printable(&object.name))?;
    }
    writeln!(out, "  {kind:<9} {primitive} of the scene, at u {:.6}, v {:.6}", pick.coordinates.0, pick.coordinates.1)?;
    if let Some(shared) = pick.surface.shared {
        writeln!(out, "  copy      {} of shared mesh {}, its triangle {}", shared.copy, shared.mesh, shared.triangle)?;
    }
    writeln!(out, "  distance  {}", length(pick.distance))?;
    writeln!(out, "  position  {}", vector(pick.position))?;
    let side = if pick.is_front { "front" } else { "back" };
    writeln!(
        out,
        "  normal    {}, shaded by {}; seen from the {side}",
        vector(pick.normal),
        vector(pick.shading_normal)
    )?;
    writeln!(out, "  error     {}: rays that leave start so far off the surface", length(pick.error))
}

/// A primitive, by its place in its mesh.
fn called(surface: &Surface) -> String {
    let Surface { kind, within, object, .. } = surface;
    match object {
        Some(object) => format!("{kind} {within} of \"{}\"", printable(&object.name)),
        None => format!("{kind} {within}"),
    }
}

fn way(out: &mut Formatter<'_>, trail: &Trail) -> fmt::Result {
    let (visits, tests) = (plural(trail.visits(), "node"), plural(trail.tests(), "primitive"));
    write!(out, "\n{}: {visits} visited, the deepest at depth {}, {tests} tested", trail.method, trail.deepest())?;
    match trail.packet {
        Some(region) => {
            let (right, bottom) = (region.x + region.width - 1, region.y + region.height - 1);
            writeln!(out, "; with the rays of the pixels {},{} to {right},{bottom}", region.x, region.y)?;
        }
        None => writeln!(out)?,
    }
    for (number, step) in (1..).zip(&trail.steps) {
        write!(out, "{number:>5}  ")?;
        match step {
            Step::Visit(visit) => visited(out, visit, trail.packet.is_some())?,
            Step::Test(test) => tested(out, test)?,
            Step::Drop { child, near } => {
                writeln!(out, "drop {}: it begins at {}, behind the closest hit", target(*child), length(*near))?;
            }
        }
    }
    match &trail.hit {
        Some(hit) => writeln!(out, "  hit  {} at t {}", called(&hit.surface), length(hit.place.t)),
        None => writeln!(out, "  hit  nothing"),
    }
}

fn visited(out: &mut Formatter<'_>, visit: &Visit, is_packet: bool) -> fmt::Result {
    write!(out, "visit node {}, depth {}", visit.node, visit.depth)?;
    if let Some(copy) = visit.copy {
        write!(out, ", in copy {copy}")?;
    }
    if is_packet {
        write!(out, ", {}", if visit.rays == 1 { "alone" } else { "together" })?;
    }
    writeln!(out)?;
    let each = is_packet && visit.rays > 1;
    visit.children.iter().try_for_each(|child| told(out, child, each))
}

/// A child whose box was tested, with how many rays of a packet meet it.
fn told(out: &mut Formatter<'_>, child: &Child, is_packet: bool) -> fmt::Result {
    let Child { child, near, far, rays, fate } = child;
    let span = format!("{} to {}", length(*near), length(*far));
    let is_met = near <= far;
    let what = match (fate, is_met) {
        (Fate::Missed, _) => "missed",
        (Fate::Next, true) => "entered, visited next",
        (Fate::Next, false) => "missed, but visited next",
        (Fate::Pushed, true) => "entered, pushed",
        (Fate::Pushed, false) => "missed, but pushed",
        (Fate::Alone, true) => "entered, visited alone",
        (Fate::Alone, false) => "missed, visited by others alone",
    };
    let of = if is_packet { format!("; {} meet it", plural(*rays as usize, "ray")) } else { String::new() };
    writeln!(out, "         {:<24} {span:<24} {what}{of}", target(*child))
}

fn target(target: Target) -> String {
    match target {
        Target::Node(number) => format!("node {number}"),
        Target::Leaf { number, primitives } => format!("leaf {number} of {}", plural(primitives as usize, "primitive")),
        Target::Copy(number) => format!("copy {number}"),
    }
}

fn tested(out: &mut Formatter<'_>, test: &Test) -> fmt::Result {
    let material = printable(&test.surface.material.name).to_string();
    write!(out, "test {}, \"{material}\": ", called(&test.surface))?;
    let Some(place) = test.contact else { return writeln!(out, "miss") };
    let what = match test.outcome {
        Outcome::Closest => "the closest so far",
        Outcome::Farther | Outcome::Miss => "not nearer",
    };
    writeln!(out, "hit at t {}, u {:.6}, v {:.6}, {what}", length(place.t), place.u, place.v)
}

fn vector(v: Vec3) -> String {
    v.to_array().map(|c| length(c.into())).join(", ")
}

/// A length with seven digits, which is what single precision has.
fn length(x: f64) -> String {
    const DIGITS: i32 = 6;
    let scientific = format!("{x:.6e}");
    let power = scientific.split_once('e').and_then(|(_, power)| power.parse::<i32>().ok());
    match power {
        // What is rounded to zero has no sign.
        Some(power) if (-4..=DIGITS).contains(&power) => format!("{:.*}", (DIGITS - power) as usize, x + 0.0),
        _ => scientific,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_have_seven_digits_and_powers_of_ten_where_they_are_far_from_one() {
        for (x, want) in [
            (0.0, "0.000000"),
            (-0.0, "0.000000"),
            (4.0, "4.000000"),
            (-12.345_678_9, "-12.34568"),
            (999_999.96, "1000000"),
            (0.000_123_456_78, "0.0001234568"),
            (1.5e-5, "1.500000e-5"),
            (123_456_789.0, "1.234568e8"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(length(x), want);
        }
    }
}
