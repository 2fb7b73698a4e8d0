//! Lights without extent (KHR_lights_punctual). Their candela and lux are taken as they are, but for those that Blender wrote:
//! exposure is the viewer's.

use std::f64::consts::FRAC_PI_4;

use glam::{DVec3, Vec3};
use serde_json::Value;

use super::document::{self, pick};
use super::node::Placed;
use super::notes::Notes;
use crate::scene::{Falloff, Light, LightGroups, Unplaced, normal};
use crate::scene_io::LightUnit;

/// The widest half angle of a spot in degrees: 90 make no cone.
const WIDEST: f64 = 89.9;

/// The light of a node in world units, if it has one and that shines; `all` are those of the file.
///
/// # Errors
/// There is no such light, it is of an unknown type, or out of range.
pub fn read(placed: &Placed, all: &[document::Light], unit: LightUnit, notes: &mut Notes) -> Unplaced<Option<Light>> {
    let Some(of) = &placed.node.extensions.light else { return Ok(None) };
    let owner = format!("nodes[{}].extensions.KHR_lights_punctual.light", placed.number);
    let number = of.light.ok_or_else(|| format!("{owner}: there is none; name a light"))?;
    let light = pick(all, number, &owner, "light")?;
    let here = format!("extensions.KHR_lights_punctual.lights[{number}]");
    let colour = colour(light, unit)
        .ok_or_else(|| format!("{here}: its colour or intensity is below 0 or too large; repair it"))?;
    if colour == Vec3::ZERO {
        return Ok(None);
    }
    let view = View::of(placed);
    let is_placed = view.as_ref().is_some_and(|view| view.eye.is_finite());
    let Some(view) = view.filter(|_| is_placed) else {
        notes.left_out(
            "light",
            &format!(
                "nodes[{}]: its light is left out, as its transform gives it no place or direction",
                placed.number
            ),
        );
        return Ok(None);
    };
    if light.range.is_some() {
        notes.left_out(
            "range",
            "ranges of lights are left out: light fades with the square of the distance, and never ends",
        );
    }
    let group = group(light, number, notes);
    Ok(Some(match light.kind.as_str() {
        "point" => Light::Point { position: view.eye, colour, group, illuminant: None },
        "directional" => Light::Directional { direction: view.direction, colour, group, illuminant: None },
        "spot" => {
            let angles = angles(&light.spot);
            let [outer, inner] = angles.ok_or_else(|| format!("{here}.spot: an angle is out of range; repair it"))?;
            if inner > outer {
                let text = format!("{here}.spot: innerConeAngle is more than outerConeAngle, which takes its place");
                notes.changed("spot", &text);
            }
            let inner = inner.min(outer);
            let (falloff, illuminant) = (Falloff::Gltf, None);
            Light::Spot { position: view.eye, target: view.target(), colour, outer, inner, falloff, group, illuminant }
        }
        other => return Err(format!("{here}.type: {other:?} is none of point, directional and spot; repair it")),
    }))
}

/// The group that its writer gave it, as exporters keep what artists add.
fn group(light: &document::Light, number: usize, notes: &mut Notes) -> String {
    match light.extras.get("group").and_then(Value::as_str) {
        Some(name) if LightGroups::can_be(name) => name.to_owned(),
        Some(name) => {
            let rule = LightGroups::RULE;
            let text = format!("the group {name:?} of light {number}'s extras is left out, and others like it: {rule}");
            notes.left_out("groups", &text);
            String::new()
        }
        None => String::new(),
    }
}

fn colour(light: &document::Light, unit: LightUnit) -> Option<Vec3> {
    let intensity = light.intensity.unwrap_or(1.0) * unit.factor(light.kind == "directional");
    let colour = Vec3::from_array(light.color.unwrap_or([1.0; 3]).map(|share| (share * intensity) as f32));
    (colour.is_finite() && colour.min_element() >= 0.0).then_some(colour)
}

/// The outer and the inner half angle in degrees.
fn angles(spot: &document::Spot) -> Option<[f32; 2]> {
    let outer = spot.outer_cone_angle.unwrap_or(FRAC_PI_4).to_degrees().min(WIDEST) as f32;
    let inner = spot.inner_cone_angle.unwrap_or(0.0).to_degrees() as f32;
    (outer > 0.0 && inner >= 0.0).then_some([outer, inner])
}

/// Where a node is and where it looks, which is along its negative z axis.
pub struct View {
    /// World units.
    pub eye: Vec3,
    /// Of unit length.
    pub direction: Vec3,
    /// Of unit length, or zero.
    pub up: Vec3,
}

impl View {
    /// That of a node; none if its transform leaves no direction.
    pub fn of(placed: &Placed) -> Option<Self> {
        let unit = |axis: DVec3| normal::unit(placed.world.transform_vector3(axis));
        let direction = unit(DVec3::NEG_Z);
        let eye = placed.world.w_axis.truncate().as_vec3();
        (direction != Vec3::ZERO && direction.is_finite()).then(|| View { eye, direction, up: unit(DVec3::Y) })
    }

    /// A point ahead: one unit away, or so far that single precision tells it from the eye.
    pub fn target(&self) -> Vec3 {
        let distance = (self.eye.abs().max_element() * 1e-3).max(1.0);
        self.eye + self.direction * distance
    }
}
