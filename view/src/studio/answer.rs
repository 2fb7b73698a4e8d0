//! What a pixel shows, in words.

use eyerays::error::Result;
use eyerays::job::Job;
use eyerays::layers;
use eyerays::line::one_line;
use eyerays::pick::{self, Pick};
use eyerays::scene::{Camera, Scene};

use crate::news::Answer;

/// What a pixel of a camera's picture shows, if it shows anything.
pub(super) fn what((job, scene): (&Job, &Scene), camera: &Camera, (x, y): (u32, u32)) -> Result<Option<Answer>> {
    Ok(pick::pick(job, scene, camera, x, y)?.map(|pick| Answer::What(line(&pick))))
}

/// How far that is.
pub(super) fn focus(job: &Job, camera: &Camera, at: (u32, u32)) -> Result<Option<Answer>> {
    Ok(layers::depth(job, camera, at)?.map(Answer::Focus))
}

/// Object, material, primitive, distance and place, in a line.
fn line(pick: &Pick) -> String {
    let Pick { surface, distance, position, normal, error, .. } = pick;
    let object =
        surface.object.as_ref().map_or("no object".to_owned(), |object| format!("\"{}\"", one_line(&object.name)));
    let (kind, within, primitive) = (surface.kind, surface.within, surface.primitive);
    let shared = surface.shared.as_ref().map_or(String::new(), |_| ", a copy".to_owned());
    let [at, facing] = [position, normal].map(|v| format!("({:.5}, {:.5}, {:.5})", v.x, v.y, v.z));
    let material = one_line(&surface.material.name);
    format!(
        "{object}{shared}: {kind} {within} of it, {primitive} of the scene; material \"{material}\"; t {distance:.7} at {at} within {error:.1e}; normal {facing}"
    )
}
