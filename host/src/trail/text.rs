//! The steps of a ray as text.

use std::fmt::{self, Display, Formatter};

use super::{Child, Fate, Outcome, Step, Target, Test, Trail, Visit};
use crate::line::{plural, printable, seven_digits};

/// A line a step, after one that counts them and before one that tells the hit.
impl Display for Trail {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        let (visits, tests) = (plural(self.visits(), "node"), plural(self.tests(), "primitive"));
        write!(out, "{}: {visits} visited, the deepest at depth {}, {tests} tested", self.method, self.deepest())?;
        match self.packet {
            Some(region) => {
                let (right, bottom) = (region.x + region.width - 1, region.y + region.height - 1);
                writeln!(out, "; with the rays of the pixels {},{} to {right},{bottom}", region.x, region.y)?;
            }
            None => writeln!(out)?,
        }
        for (number, step) in (1..).zip(&self.steps) {
            write!(out, "{number:>5}  ")?;
            match step {
                Step::Visit(visit) => visited(out, visit, self.packet.is_some())?,
                Step::Test(test) => tested(out, test)?,
                Step::Drop { child, near } => {
                    writeln!(
                        out,
                        "drop {}: it begins at {}, behind the closest hit",
                        target(*child),
                        seven_digits(*near)
                    )?;
                }
            }
        }
        match &self.hit {
            Some(hit) => writeln!(out, "  hit  {} at t {}", hit.surface, seven_digits(hit.place.t)),
            None => writeln!(out, "  hit  nothing"),
        }
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
    let span = format!("{} to {}", seven_digits(*near), seven_digits(*far));
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
    let material = printable(&test.surface.material.name);
    write!(out, "test {}, \"{material}\": ", test.surface)?;
    let Some(place) = test.contact else { return writeln!(out, "miss") };
    let what = match test.outcome {
        Outcome::Closest => "the closest so far",
        Outcome::Farther | Outcome::Miss => "not nearer",
    };
    writeln!(out, "hit at t {}, u {:.6}, v {:.6}, {what}", seven_digits(place.t), place.u, place.v)
}
