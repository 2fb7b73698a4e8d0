//! What a pixel shows, in words.

use eyerays::error::Result;
use eyerays::job::Job;
use eyerays::layers;
use eyerays::line::one_line;
use eyerays::pick::{self, Pick};
use eyerays::scene::{Camera, Scene};

use crate::news::{Answer, Ask};

/// Answers a question about a pixel of a camera's picture.
pub(super) fn answer(job: &Job, scene: &Scene, camera: &Camera, ask: Ask) -> Answer {
    match told(job, scene, camera, ask) {
        Ok(Some(answer)) => answer,
        Ok(None) => Answer::Nothing("nothing is there".to_owned()),
        Err(error) => Answer::Nothing(error.to_string()),
    }
}

fn told(job: &Job, scene: &Scene, camera: &Camera, ask: Ask) -> Result<Option<Answer>> {
    Ok(match ask {
        Ask::What(x, y) => pick::pick(job, scene, camera, x, y)?.map(|pick| Answer::What(line(&pick))),
        Ask::Focus(x, y) => layers::depth(job, camera, (x, y))?.map(Answer::Focus),
    })
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
