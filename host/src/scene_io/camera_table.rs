//! `[[camera]]` of a TOML scene.

use std::collections::HashSet;

use glam::{DVec3, Vec3};

use super::keys::Keys;
use super::table::Table;
use crate::error::Result;
use crate::scene::Range;
use crate::scene::{Camera, Focus, Lens, Mapping, Projection, Stereo};

/// Reads every `[[camera]]` as it is after so many seconds. Those with keys move until the last of all.
///
/// # Errors
/// A name given twice, a view that has no direction or no upright, a number out of range, or an unknown key.
pub fn cameras(tables: Vec<Table>, seconds: f64) -> Result<(Vec<Camera>, Option<f32>)> {
    let mut names = HashSet::new();
    let (mut cameras, mut last) = (Vec::new(), None);
    for mut table in tables {
        let (camera, keys) = camera(&mut table, seconds)?;
        last = last.into_iter().chain(keys).reduce(f32::max);
        if !names.insert(camera.name.clone()) {
            let fault = format!("a second camera {:?}; rename one", camera.name);
            return Err(table.fault_of("name", fault));
        }
        table.done()?;
        cameras.push(camera);
    }
    Ok((cameras, last))
}

/// A camera after so many seconds, and the time of its last key if it has any.
fn camera(table: &mut Table, seconds: f64) -> Result<(Camera, Option<f32>)> {
    let name = table.name("name")?;
    let eye = table.triple("eye", Range::ANY)?;
    let target = table.triple("target", Range::ANY)?;
    let up = table.triple("up", Range::ANY)?.unwrap_or(Vec3::Y);
    let own = [eye.unwrap_or(Vec3::ZERO), target.unwrap_or(Vec3::ZERO), up];
    let keys = Keys::read(table, [("eye", Range::ANY), ("target", Range::ANY), ("up", Range::ANY)], own)?;
    let last = keys.as_ref().map(Keys::last);
    let name = table.need("name", name)?;
    let [eye, target, up] = match keys {
        Some(keys) => keys.at(seconds),
        None => [table.need("eye", eye)?, table.need("target", target)?, up],
    };
    let sensor = table.number("sensor", Range::LENGTH)?.unwrap_or(Lens::SENSOR);
    let projection = projection(table, sensor)?;
    let camera = Camera {
        up,
        shift: shift(table, projection)?,
        lens: lens(table, projection, sensor)?,
        clip: clip(table)?,
        stereo: stereo(table, projection)?,
        ..Camera::new(name, eye, target, projection)
    };
    let named = format!("camera {:?}", camera.name);
    if camera.forward() == DVec3::ZERO {
        let fault = format!("{named} looks at its own eye; move its target");
        return Err(table.fault_of("target", fault));
    }
    if !camera.is_upright() {
        let fault = format!("{named} has its up along its view; turn up aside");
        let key = if table.has("up") { "up" } else { "target" };
        return Err(table.fault_of(key, fault));
    }
    if camera.lens.is_some() && camera.focus_distance() <= 0.0 {
        let fault = format!("{named} is to be sharp behind its eye; move the point before it");
        return Err(table.fault_of("focus_on", fault));
    }
    Ok((camera, last))
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Perspective,
    Orthographic,
    Equirectangular,
    Fisheye,
}

fn projection(table: &mut Table, sensor: f32) -> Result<Projection> {
    let words = [
        ("perspective", Kind::Perspective),
        ("orthographic", Kind::Orthographic),
        ("equirectangular", Kind::Equirectangular),
        ("fisheye", Kind::Fisheye),
    ];
    let height = table.number("orthographic", Range::LENGTH)?;
    let kind = table.word("projection", &words)?;
    let kind = kind.unwrap_or(if height.is_some() { Kind::Orthographic } else { Kind::Perspective });
    if height.is_some() && kind != Kind::Orthographic {
        return Err(table.fault_of("orthographic", "this is the height of an orthographic image; remove it"));
    }
    if kind != Kind::Fisheye && table.has("mapping") {
        return Err(table.fault_of("mapping", "this is of a fisheye; remove it, or set projection to \"fisheye\""));
    }
    let has_angle = matches!(kind, Kind::Perspective | Kind::Fisheye);
    if let Some(key) = ["fov", "focal_length"].into_iter().find(|&key| !has_angle && table.has(key)) {
        let image = if kind == Kind::Orthographic { "an orthographic" } else { "an equirectangular" };
        return Err(table.fault_of(key, format!("{image} camera has no fov; remove one of both")));
    }
    Ok(match kind {
        Kind::Perspective => Projection::Perspective { fov: field_of_view(table, sensor)? },
        Kind::Orthographic => Projection::Orthographic { height: table.need("orthographic", height)? },
        Kind::Equirectangular => Projection::Equirectangular,
        Kind::Fisheye => {
            let fov = table.number("fov", Range::CIRCLE)?.unwrap_or(180.0);
            Projection::Fisheye { fov, mapping: table.choice::<Mapping>("mapping")?.unwrap_or_default() }
        }
    })
}

/// In degrees, or by a focal length.
fn field_of_view(table: &mut Table, sensor: f32) -> Result<f32> {
    let fov = table.number("fov", Range::CONE)?;
    match (fov, table.number("focal_length", Range::LENGTH)?) {
        (Some(_), Some(_)) => Err(table.fault_of("fov", "a focal_length says the fov; remove one of both")),
        (_, Some(focal_length)) => Ok(Lens::field_of_view(focal_length, sensor)),
        (fov, None) => Ok(fov.unwrap_or(45.0)),
    }
}

fn shift(table: &mut Table, projection: Projection) -> Result<[f32; 2]> {
    let shift = [table.number("shift_x", Range::SHIFT)?, table.number("shift_y", Range::SHIFT)?];
    if !projection.is_flat() && shift.iter().any(Option::is_some) {
        let key = if shift[0].is_some() { "shift_x" } else { "shift_y" };
        return Err(table.fault_of(key, "an image of all around can't be shifted; remove it"));
    }
    Ok(shift.map(|share| share.unwrap_or(0.0)))
}

fn clip(table: &mut Table) -> Result<[f32; 2]> {
    let near = table.number("clip_near", Range::AMOUNT)?.unwrap_or(Camera::ALL[0]);
    let far = table.number("clip_far", Range::LENGTH)?.unwrap_or(Camera::ALL[1]);
    if near >= far {
        return Err(table.fault_of("clip_far", format!("it ends at {far}, before it begins at {near}; swap them")));
    }
    Ok([near, far])
}

fn stereo(table: &mut Table, projection: Projection) -> Result<Option<Stereo>> {
    let layout = table.choice("stereo")?;
    let distance = table.number("eye_distance", Range::LENGTH)?;
    let convergence = table.number("convergence", Range::LENGTH)?;
    let Some(layout) = layout else {
        let idle = [("eye_distance", distance), ("convergence", convergence)].into_iter().find(|(_, of)| of.is_some());
        let fault = |(key, _)| table.fault_of(key, format!("{key} is of two eyes; set stereo, too"));
        return idle.map_or(Ok(None), |idle| Err(fault(idle)));
    };
    let stereo = Stereo { layout, distance: distance.unwrap_or(Stereo::HUMAN), convergence };
    match stereo.misfit(projection) {
        Some((key, why)) => Err(table.fault_of(key, format!("{why}; remove it"))),
        None => Ok(Some(stereo)),
    }
}

/// Keys that only say how a lens is.
const OF_A_LENS: [&str; 7] =
    ["focus", "focus_on", "blades", "blade_rotation", "blade_roundness", "anamorphic", "metre"];

fn lens(table: &mut Table, projection: Projection, sensor: f32) -> Result<Option<Lens>> {
    let radius = table.number("aperture", Range::AMOUNT)?;
    let f_stop = table.number("f_stop", Range::LENGTH)?;
    let radius = match (radius, f_stop, projection) {
        (Some(_), Some(_), _) => {
            return Err(table.fault_of("aperture", "f_stop says the aperture; remove one of both"));
        }
        (_, Some(f_stop), Projection::Perspective { fov }) => {
            // Scenes are in metres unless they say otherwise.
            let metre = table.number("metre", Range::LENGTH)?.unwrap_or(1.0);
            Some(Lens::radius_of(f_stop, fov, sensor) * metre)
        }
        (_, Some(_), _) => return Err(table.fault_of("f_stop", "f_stop is of a perspective camera; set aperture")),
        (radius, None, _) => radius,
    };
    let Some(radius) = radius else {
        return match OF_A_LENS.into_iter().find(|&key| table.has(key)) {
            Some(key) => Err(table.fault_of(key, format!("{key} is of a lens; set aperture or f_stop, too"))),
            None => Ok(None),
        };
    };
    if !projection.is_flat() {
        let key = if table.has("aperture") { "aperture" } else { "f_stop" };
        return Err(table.fault_of(key, "an image of all around has no lens; remove it"));
    }
    let lens = Lens {
        focus: focus(table)?,
        blades: blades(table)?,
        rotation: table.number("blade_rotation", Range::ANY)?.unwrap_or(0.0),
        roundness: table.number("blade_roundness", Range::SHARE)?.unwrap_or(0.0),
        ratio: table.number("anamorphic", Range::LENGTH)?.unwrap_or(1.0),
        ..Lens::round(radius)
    };
    Ok((radius > 0.0).then_some(lens))
}

fn focus(table: &mut Table) -> Result<Focus> {
    let distance = table.number("focus", Range::LENGTH)?;
    let point = table.triple("focus_on", Range::ANY)?;
    match (distance, point) {
        (Some(_), Some(_)) => Err(table.fault_of("focus", "focus_on says the focus; remove one of both")),
        (Some(distance), _) => Ok(Focus::Distance(distance)),
        (_, Some(point)) => Ok(Focus::Point(point)),
        (None, None) => Ok(Focus::Target),
    }
}

fn blades(table: &mut Table) -> Result<u32> {
    let blades = table.whole("blades", 0, Lens::MOST_BLADES)?.unwrap_or(0);
    if !Lens::can_have(blades) {
        return Err(table.fault_of("blades", "a lens has at least 3 blades, or 0 for a circle"));
    }
    Ok(blades)
}
