//! Tells how rays are followed, as a wish asks.

use std::sync::Arc;

use eyerays::device_scene::{DeviceScene, NodeBox};
use eyerays::error::Result;
use eyerays::job::Job;
use eyerays::method::{Method, Traversal};
use eyerays::scene::{Camera, Scene, Settings};
use eyerays::trail::{self, Aim, Step, Trail};

use crate::news::{Told, Way};
use crate::wish::{Lesson, Wish};

/// What was told last.
#[derive(Default)]
pub(super) struct Teacher {
    asked: Option<Asked>,
    told: Arc<Told>,
}

/// What it was told of: another is another lesson.
struct Asked {
    lesson: Lesson,
    camera: Camera,
    size: (u32, u32),
    traversal: Traversal,
    job: Job,
}

impl Asked {
    fn is_same(&self, other: &Asked) -> bool {
        let is_same_ray = (&self.camera, self.size, self.traversal) == (&other.camera, other.size, other.traversal);
        self.lesson == other.lesson
            && std::ptr::eq::<DeviceScene>(&*self.job, &*other.job)
            && (is_same_ray || self.lesson.pixel.is_none())
    }
}

impl Teacher {
    /// Tells what a wish asks, seen by a camera; while that moves, what was told before.
    pub fn tell(&mut self, wish: &Wish, job: &Job, (scene, camera): (&Scene, &Camera)) -> Arc<Told> {
        let Wish { lesson, size, device, is_moving, .. } = wish;
        if *lesson == Lesson::default() {
            // Nothing is asked, mostly: pictures of a moving camera come by the thousand.
            if self.asked.take().is_some() {
                self.told = Arc::default();
            }
            return self.told.clone();
        }
        let (camera, traversal) = (camera.clone(), device.traversal);
        let asked = Asked { lesson: *lesson, camera, size: *size, traversal, job: job.clone() };
        let is_told = |before: &Asked| before.is_same(&asked) || *is_moving && before.lesson == *lesson;
        if !self.asked.as_ref().is_some_and(is_told) {
            let boxes = lesson.level.map_or(Vec::new(), |level| job.boxes(level));
            let way = lesson.pixel.map(|pixel| way(&asked, scene, pixel));
            (self.told, self.asked) = (Arc::new(Told { boxes, way }), Some(asked));
        }
        self.told.clone()
    }
}

fn way(asked: &Asked, scene: &Scene, pixel: (u32, u32)) -> Way {
    match trail(asked, scene, pixel) {
        Ok(trail) => Way { pixel, text: trail.to_string(), entered: entered(&trail, &asked.job) },
        Err(error) => Way { pixel, text: error.to_string(), entered: Vec::new() },
    }
}

fn trail(asked: &Asked, scene: &Scene, (x, y): (u32, u32)) -> Result<Trail> {
    let job = asked.job.with(Settings { size: asked.size, ..*asked.job.settings() })?;
    trail::follow(&job, scene, &asked.camera, Aim::middle(x, y), asked.traversal)
}

/// The boxes that a ray enters.
fn entered(trail: &Trail, job: &Job) -> Vec<(NodeBox, u32)> {
    if trail.method == Method::Wide {
        return Vec::new();
    }
    let visits = trail.steps.iter().filter_map(|step| match step {
        Step::Visit(visit) if visit.copy.is_none() => Some(visit),
        _ => None,
    });
    let boxes = visits.flat_map(|visit| {
        let children = job.children(visit.node).into_iter().flatten().zip(&visit.children);
        children.filter(|(_, child)| child.near <= child.far).map(|(bounds, _)| (bounds, visit.depth))
    });
    boxes.collect()
}
