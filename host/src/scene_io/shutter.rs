//! Scenes while the shutter is open: read at several moments.

use std::path::Path;

use glam::{DVec3, Vec3};

use super::budget::Budget;
use super::load::Loading;
use super::table::Table;
use super::{Instant, Moment, Shutter, Warning, WarningKind};
use crate::error::{Error, Result};
use crate::scene::{Camera, Instance, Light, Moved, Range, Scene};

/// Pictures a second where nobody says otherwise.
const RATE: f64 = 24.0;

/// Steps that a motion is first looked at, and the most that it is followed by.
const STEPS: (usize, usize) = (4, 32);

/// How far things may be from the straight way between two steps, as a share of the scene's largest edge: less than half a pixel of
/// most pictures.
const STRAIGHT: f64 = 1.0 / 8192.0;

/// Reads `[shutter]`: `seconds` or `frames` (of `fps`) in which it is open, and `rolling`.
///
/// # Errors
/// Neither or both, one that closes before it opens, a number out of range, or an unknown key.
pub fn read(mut table: Table) -> Result<Shutter> {
    let rate = table.number("fps", Range::LENGTH)?.map_or(RATE, f64::from);
    let seconds = table.two("seconds", Range::ANY)?;
    let frames = table.two("frames", Range::ANY)?;
    let rolling = table.number("rolling", Range::SHARE)?.unwrap_or(1.0).into();
    let (key, [open, close]) = match (seconds, frames) {
        (Some(_), Some(_)) => {
            return Err(table.fault_of("frames", "seconds says when it is open, too; remove one of both"));
        }
        (None, None) => return Err(table.fault("it does not say when it is open; add frames = [0.0, 0.5]")),
        (Some(seconds), None) => ("seconds", seconds.to_array().map(f64::from)),
        (None, Some(frames)) => ("frames", frames.to_array().map(|frame| f64::from(frame) / rate)),
    };
    if close < open {
        return Err(table.fault_of(key, "it closes before it opens; swap both"));
    }
    table.done()?;
    Ok(Shutter { open, close, rolling })
}

/// A scene that is read by `read` as it is while a shutter is open, if it is.
///
/// # Errors
/// Those of `read`, and a scene that changes in more than where things are.
pub fn over(
    path: &Path,
    budget: Budget,
    (loading, shutter): (Loading, Option<Shutter>),
    read: impl Fn(Loading) -> Result<(Scene, Vec<Warning>)>,
) -> Result<(Scene, Vec<Warning>)> {
    let Some(shutter) = shutter.filter(|of| of.is_open() && loading.instant == Instant::Alone) else {
        return read(loading);
    };
    let start = loading.moment.seconds.unwrap_or(0.0);
    let at = |share: f64, instant| {
        let moment = Moment { seconds: Some(start + shutter.at(share)), ..loading.moment.clone() };
        read(Loading { moment, instant, ..loading.clone() })
    };
    let (opening, mut warnings) = at(0.0, Instant::Opening)?;
    if opening.animations.is_empty() {
        warnings.push(Warning::new(WarningKind::Idle, path, "nothing moves in it: the shutter shows nothing"));
        return read(loading).map(|(scene, _)| (scene, warnings));
    }
    let cameras = opening.cameras.clone();
    // All moments are held until what moves is known.
    let room = |scenes: usize| budget.check_bytes((scenes as u64).saturating_mul(opening.bytes() as u64));
    room(STEPS.0 + 1).map_err(|why| {
        Error::file(
            path,
            format!("while the shutter is open its scenes would {why}; close the shutter, or make it smaller"),
        )
    })?;
    let steps = (1..=STEPS.1).rev().find(|&steps| room(steps + 1).is_ok()).unwrap_or(1);
    let (opening, later) = followed(opening, steps, |share| {
        let (scene, _) = at(share, Instant::Later)?;
        // One that was made to frame the scene stands still.
        Ok(if scene.cameras.is_empty() { Scene { cameras: cameras.clone(), ..scene } } else { scene })
    })?;
    let moving = opening.moving(&later);
    let is_flat = loading.instancing.flattens(&opening, &moving, &budget).map_err(|fault| Error::file(path, fault))?;
    let settled = |scene: Scene| if is_flat.contains(&true) { scene.flattened_where(&is_flat) } else { scene };
    let later: Vec<Scene> = later.into_iter().map(settled).collect();
    let Moved { scene, left } =
        settled(opening).over(&later, shutter.rolling as f32).map_err(|error| Error::file(path, error.message()))?;
    if let Some(name) = left.first() {
        let others = if left.len() == 1 { String::new() } else { format!(" and {} more", left.len() - 1) };
        let fault = format!(
            "{name:?}{others} stands still while the shutter is open, since it is a whole sphere or disk; tessellate makes a mesh of those"
        );
        warnings.push(Warning::new(WarningKind::LeftOut, path, fault));
    }
    Ok((scene, warnings))
}

/// A scene that was written with its motion, or without one, by a shutter that somebody asks for.
///
/// # Errors
/// It is open at another time than the one that the scene was written with.
pub fn kept(path: &Path, scene: Scene, asked: Option<Shutter>) -> Result<(Scene, Vec<Warning>)> {
    let idle = |fault: &str| vec![Warning::new(WarningKind::Idle, path, fault)];
    match (asked.map(|shutter| shutter.is_open()), &scene.motion) {
        (Some(true), Some(_)) => {
            let fault =
                "it was written with its shutter; leave --shutter out, or convert its scene again with this one";
            Err(Error::file(path, fault))
        }
        (Some(true), None) => Ok((scene, idle("it was written as it is at one moment: the shutter shows nothing"))),
        (Some(false), _) => Ok((Scene { motion: None, ..scene }, Vec::new())),
        (None, _) => Ok((scene, Vec::new())),
    }
}

/// The scene at the ends of so many even steps, `most` at most, that everything goes straight in each, but for what no eye sees.
fn followed(opening: Scene, most: usize, at: impl Fn(f64) -> Result<Scene>) -> Result<(Scene, Vec<Scene>)> {
    let first = STEPS.0;
    let mut scenes = vec![opening];
    for step in 1..=first {
        scenes.push(at(step as f64 / first as f64)?);
    }
    let [least, greatest] = scenes[0].bounds();
    let most_off = STRAIGHT * f64::from((greatest - least).max_element());
    while 2 * (scenes.len() - 1) <= most && !is_straight(&scenes, most_off) {
        let steps = 2 * (scenes.len() - 1);
        let mut finer = Vec::with_capacity(steps + 1);
        for (step, scene) in scenes.into_iter().enumerate() {
            if step > 0 {
                finer.push(at((2 * step - 1) as f64 / steps as f64)?);
            }
            finer.push(scene);
        }
        scenes = finer;
    }
    while scenes.len() > 2 && is_straight(&scenes, most_off) {
        scenes = scenes.into_iter().step_by(2).collect();
    }
    let mut scenes = scenes.into_iter();
    let opening = scenes.next().expect("it has the opening");
    Ok((opening, scenes.collect()))
}

/// Is every second scene in the middle of those beside it?
fn is_straight(scenes: &[Scene], most_off: f64) -> bool {
    scenes.windows(3).step_by(2).all(|three| off(&three[0], &three[1], &three[2]) <= most_off)
}

/// How far things are from the middle between where they are before and after. Scenes of other shapes are refused elsewhere.
fn off(before: &Scene, middle: &Scene, after: &Scene) -> f64 {
    let between = |a: Vec3, b: Vec3, c: Vec3| ((a.as_dvec3() + c.as_dvec3()) / 2.0 - b.as_dvec3()).length();
    let vertices = before.mesh.positions.iter().zip(&middle.mesh.positions).zip(&after.mesh.positions);
    let vertices = vertices.map(|((&a, &b), &c)| between(a, b, c)).fold(0.0, f64::max);
    let reach: Vec<f64> =
        before.shared.iter().map(|shared| reach(&before.mesh.positions[shared.vertices.clone()])).collect();
    let copy = |((a, b), c): ((&Instance, &Instance), &Instance)| {
        let rows = (0..3).map(|row| between(a.rows[row], b.rows[row], c.rows[row])).sum::<f64>();
        between(a.translation, b.translation, c.translation) + rows * reach.get(a.mesh as usize).unwrap_or(&0.0)
    };
    let copies = before.instances.iter().zip(&middle.instances).zip(&after.instances).map(copy).fold(0.0, f64::max);
    let camera = |((a, b), c): ((&Camera, &Camera), &Camera)| {
        let distance = f64::from(a.eye.distance(a.target)).max(f64::from(f32::MIN_POSITIVE));
        // A target's way is seen from the eye, as far as it is.
        between(a.eye, b.eye, c.eye) + between(a.target, b.target, c.target).min(distance)
    };
    let cameras = before.cameras.iter().zip(&middle.cameras).zip(&after.cameras).map(camera).fold(0.0, f64::max);
    let [least, greatest] = before.bounds();
    let edge = f64::from((greatest - least).max_element());
    let light = |((a, b), c): ((&Light, &Light), &Light)| {
        let ((from, start), (place, way), (to, end)) = (a.stance(), b.stance(), c.stance());
        let turn = |ways: (DVec3, DVec3, DVec3)| ((ways.0 + ways.2).normalize_or_zero() - ways.1).length();
        let turned = start.zip(way).zip(end).map_or(0.0, |((a, b), c)| turn((a, b, c)));
        between(from, place, to) + turned * edge
    };
    let lights = before.lights.iter().zip(&middle.lights).zip(&after.lights).map(light).fold(0.0, f64::max);
    vertices.max(copies).max(cameras).max(lights)
}

/// How far the vertices of a mesh are from its zero.
fn reach(positions: &[Vec3]) -> f64 {
    positions.iter().map(|place| f64::from(place.length())).fold(0.0, f64::max)
}
