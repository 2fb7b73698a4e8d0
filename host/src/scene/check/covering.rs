//! What surfaces are covered with.

use std::collections::HashSet;
use std::sync::Arc;

use rayon::prelude::*;

use super::super::{Alpha, Map, Material, Mesh, Scene, Unplaced};
use super::{Owner, Range, first};
use crate::error::{Error, Result};

/// Refuses pictures that are none, each looked at once.
pub(super) fn textures(scene: &Scene) -> Result<()> {
    let maps = scene.materials.iter().flat_map(|material| material.maps.all()).map(|map| &map.texture);
    let all = maps.chain(scene.environment.iter().map(|environment| &environment.texture));
    let mut seen = HashSet::new();
    for texture in all.filter(|texture| seen.insert(Arc::as_ptr(texture))) {
        texture.check()?;
    }
    Ok(())
}

/// Refuses opacity and maps that are out of range.
pub(super) fn material(owner: &Owner, material: &Material) -> Unplaced<()> {
    owner.number("opacity", material.opacity, Range::SHARE)?;
    if let Alpha::Mask(least) = material.alpha {
        owner.number("alpha_cutoff", least, Range::SHARE)?;
    }
    owner.number("strength of normals", material.maps.normal_scale, Range::ANY)?;
    owner.number("strength of the coat's normals", material.maps.finish.coat_normal_scale, Range::ANY)?;
    material.maps.all().try_for_each(|map| placed(owner, map))
}

fn placed(owner: &Owner, map: &Map) -> Unplaced<()> {
    let (name, placement) = (&map.texture.name, &map.placement);
    if placement.set > 1 {
        return owner
            .refuse(&format!("takes the texture {name:?} by coordinates {}; a mesh has 0 and 1", placement.set));
    }
    let odd = placement.transform.as_flattened().iter().find(|number| !number.is_finite());
    odd.map_or(Ok(()), |&number| owner.number(&format!("place of the texture {name:?}"), number, Range::ANY))
}

/// Refuses a mesh that has some of what each vertex may have, but not for each.
pub(super) fn counts(mesh: &Mesh) -> Result<()> {
    let vertices = mesh.positions.len();
    let all = [
        ("texture coordinates", mesh.coordinates[0].len()),
        ("second texture coordinates", mesh.coordinates[1].len()),
        ("tangents", mesh.tangents.len()),
        ("colors", mesh.colours.len()),
    ];
    let odd = all.iter().find(|&&(_, own)| own != 0 && own != vertices);
    odd.map_or(Ok(()), |(noun, own)| {
        Err(Error::new(format!("the mesh has {vertices} vertices and {own} {noun}: give each one, or none")))
    })
}

/// Refuses numbers of vertices that are out of range.
pub(super) fn vertices(mesh: &Mesh) -> Result<()> {
    for coordinates in &mesh.coordinates {
        let odd = coordinates.par_iter().position_first(|place| !place.is_finite());
        first(odd.map(|vertex| {
            format!(
                "vertex {vertex} has the texture coordinates {}, which are not finite: correct them",
                coordinates[vertex]
            )
        }))?;
    }
    let odd = mesh.tangents.par_iter().position_first(|tangent| !tangent.is_finite());
    first(odd.map(|vertex| format!("vertex {vertex} has the tangent {}, which is not finite", mesh.tangents[vertex])))?;
    let is_odd = |channel: &f32| !Range::SHARE.holds(*channel);
    let odd = mesh.colours.par_iter().position_first(|colour| colour.as_ref().iter().any(is_odd));
    first(odd.map(|vertex| {
        format!("vertex {vertex} has the color {}; its numbers must be {}", mesh.colours[vertex], Range::SHARE.says())
    }))
}
