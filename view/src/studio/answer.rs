//! What is asked of a picture, and what a pixel shows in words.

use eyerays::error::{Error, Result};
use eyerays::job::Job;
use eyerays::layers;
use eyerays::line::one_line;
use eyerays::pick::{self, Pick};
use eyerays::scene::{Camera, Scene, Settings};

use super::Studio;
use crate::news::{Answer, Ask};
use crate::wish::Wish;

impl Studio {
    /// Answers a question about the picture of a wish.
    pub fn answer(&mut self, wish: &Wish, ask: Ask) -> Answer {
        match self.answered(wish, ask) {
            Ok(Some(answer)) => answer,
            Ok(None) => Answer::Nothing("nothing is there".to_owned()),
            Err(error) => Answer::Nothing(error.to_string()),
        }
    }

    fn answered(&mut self, wish: &Wish, ask: Ask) -> Result<Option<Answer>> {
        let set = self.set.as_ref().ok_or_else(|| Error::new("there is no scene yet"))?;
        let job = || set.job(wish).and_then(|job| job.with(Settings { size: wish.size, ..*job.settings() }));
        match ask {
            Ask::What(x, y) => what((&job()?, set.scene()), set.camera(wish), (x, y)),
            Ask::Focus(x, y) => focus(&job()?, set.camera(wish), (x, y)),
            Ask::Light => self.light(wish).map(|light| Some(Answer::Light(Box::new(light)))),
        }
    }
}

/// What a pixel of a camera's picture shows, if it shows anything.
fn what((job, scene): (&Job, &Scene), camera: &Camera, (x, y): (u32, u32)) -> Result<Option<Answer>> {
    Ok(pick::pick(job, scene, camera, x, y)?.map(|pick| Answer::What(line(&pick))))
}

/// How far that is.
fn focus(job: &Job, camera: &Camera, at: (u32, u32)) -> Result<Option<Answer>> {
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
