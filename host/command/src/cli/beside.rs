//! The pictures before and after one, for layers that tell how things move.

use std::rc::Rc;

use super::options::View;
use super::sequence::{Instant, SequenceArgs};
use super::shot::Place;
use crate::error::Result;
use eyerays::layers::Layer;
use eyerays::scene::{Camera, Scene};

/// What a picture beside another one shows.
pub(super) struct Beside {
    /// None where it is the same.
    pub scene: Option<Rc<Scene>>,
    pub camera: Camera,
}

/// Do layers tell how things move?
pub(super) fn is_asked(layers: &[Layer]) -> bool {
    layers.iter().any(|layer| matches!(layer, Layer::MotionBack | Layer::MotionForward))
}

/// Gives each picture of a scene those before and after it, of the scene as it is then; without another one it stands still.
///
/// # Errors
/// There is no such camera in the other scenes.
pub(super) fn put(
    places: &mut [Place],
    (sequence, view): (&SequenceArgs, &View),
    (scene, camera, instant): (&Scene, &Camera, Option<Instant>),
    others: Option<[Scene; 2]>,
) -> Result<()> {
    let shots = |other: Option<Scene>, later: i8| -> Result<Vec<Beside>> {
        let (other, camera) = match other {
            Some(mut other) => {
                let camera = view.aim(&mut other)?;
                (Some(Rc::new(other)), camera)
            }
            None => (None, camera.clone()),
        };
        let shots = sequence.shots_beside(other.as_deref().unwrap_or(scene), camera, instant, later)?;
        Ok(shots.into_iter().map(|shot| Beside { scene: other.clone(), camera: shot.camera }).collect())
    };
    let [before, after] = others.map_or([None, None], |others| others.map(Some));
    let pairs = shots(before, -1)?.into_iter().zip(shots(after, 1)?);
    for (place, (before, after)) in places.iter_mut().zip(pairs) {
        place.beside = Some([before, after]);
    }
    Ok(())
}
