//! Which pictures are rendered: of several scenes, from several cameras, around a thing.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::Args;

use super::reading;
use crate::error::{Error, Result};
use crate::output::Destination;
use eyerays::scene::{Camera, Projection, Scene};
use glam::Vec3;

/// Several pictures of a scene.
#[derive(Args, Default)]
#[command(next_help_heading = "Pictures")]
pub(super) struct SequenceArgs {
    /// Render from every camera of the scene
    #[arg(long, conflicts_with_all = ["camera", "eye", "target", "focus_on"])]
    all_cameras: bool,
    /// Turn the camera around its target, all the way in N pictures
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    turntable: Option<u32>,
    /// The pictures A up to, but not including, B, counted from 0: of a turntable, or of an animation
    #[arg(long, value_name = "A..B", value_parser = frames)]
    frames: Option<Range<u32>>,
    /// The picture N of an animation, counted from 0
    #[arg(long, value_name = "N", conflicts_with = "frames")]
    frame: Option<u32>,
    /// Pictures of an animation a second [default: 24]
    #[arg(long, value_name = "F", value_parser = rate)]
    fps: Option<f64>,
}

/// A picture of a scene.
pub(super) struct Shot {
    pub camera: Camera,
    /// Its number in a turn or an animation.
    frame: Option<u32>,
}

/// A picture of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Instant {
    frame: u32,
    /// After the animation's start.
    pub seconds: f64,
    /// Pictures a second.
    pub rate: f64,
}

impl Instant {
    /// Pictures a second where nobody says otherwise.
    pub const RATE: f64 = 24.0;

    /// The start.
    pub const FIRST: Instant = Instant { frame: 0, seconds: 0.0, rate: Self::RATE };

    /// One whose picture has no number.
    pub fn unnumbered(seconds: f64, rate: f64) -> Instant {
        Instant { frame: 0, seconds, rate }
    }

    /// That of as many pictures later, by its seconds.
    pub fn later(self, pictures: f64) -> Instant {
        Instant { seconds: self.seconds + pictures / self.rate, ..self }
    }
}

impl Shot {
    /// One before the scene is known, to check names by.
    pub fn any() -> Shot {
        let projection = Projection::Perspective { fov: 60.0 };
        Shot { camera: Camera::new("camera", Vec3::Z, Vec3::ZERO, projection), frame: None }
    }
}

impl SequenceArgs {
    /// How many pictures there are of a camera.
    fn turn(&self) -> Result<Option<Range<u32>>> {
        let Some(count) = self.turntable else { return Ok(None) };
        let frames = self.frames.clone().unwrap_or(0..count);
        if frames.end > count {
            let Range { start, end } = frames;
            return Err(Error::new(format!("--frames {start}..{end}: the turn has the pictures 0..{count}")));
        }
        Ok(Some(frames))
    }

    /// The pictures of an animation, or one that says nothing of when. A turntable's stand still unless they are so many a second.
    ///
    /// # Errors
    /// Pictures a second without any picture of an animation, or too many.
    pub fn instants(&self) -> Result<Vec<Option<Instant>>> {
        const MOST: usize = 1_000_000;
        let frames = match (self.frame, &self.frames) {
            (Some(frame), _) => frame..frame.saturating_add(1),
            (None, Some(frames)) => frames.clone(),
            (None, None) if self.fps.is_some() => {
                return Err(Error::new("--fps: say which pictures of the animation, with --frames A..B or --frame N"));
            }
            (None, None) => return Ok(vec![None]),
        };
        if self.turntable.is_some() && self.fps.is_none() && self.frame.is_none() {
            return Ok(vec![None]);
        }
        if frames.len() > MOST {
            return Err(Error::new(format!(
                "--frames: {} pictures are too many; ask for {MOST} at most",
                frames.len()
            )));
        }
        self.turn()?;
        let rate = self.fps.unwrap_or(Instant::RATE);
        Ok(frames.map(|frame| Some(Instant { frame, seconds: f64::from(frame) / rate, rate })).collect())
    }

    /// The pictures of a scene, from this camera unless all are asked for; of an animation those of an instant.
    pub fn shots(&self, scene: &Scene, camera: Camera, instant: Option<Instant>) -> Result<Vec<Shot>> {
        self.shots_beside(scene, camera, instant, 0)
    }

    /// The same with each so many pictures later, of a scene as it is then.
    pub fn shots_beside(
        &self,
        scene: &Scene,
        camera: Camera,
        instant: Option<Instant>,
        later: i8,
    ) -> Result<Vec<Shot>> {
        let cameras = if self.all_cameras { scene.cameras.clone() } else { vec![camera] };
        let count = f64::from(self.turntable.unwrap_or(1));
        let frames = match instant {
            Some(Instant { frame, .. }) => Some(frame..frame.saturating_add(1)),
            None => self.turn()?,
        };
        Ok(cameras.into_iter().flat_map(|camera| turned(camera, frames.clone(), later, count)).collect())
    }

    /// Does a camera turn around a scene that stands still?
    pub fn only_turns(&self, instant: Option<Instant>) -> bool {
        self.turntable.is_some() && instant.is_none()
    }

    /// The name of a picture where none was given.
    fn default_name(&self) -> String {
        let camera = if self.all_cameras { "-{camera}" } else { "" };
        let is_one = self.turntable.is_none() && self.frames.is_none() && self.frame.is_none();
        let frame = if is_one { "" } else { "-{frame:04}" };
        format!("{{name}}{camera}{frame}.png")
    }

    /// Do pictures have names that only a scene or a frame tells?
    pub fn names_cameras(&self, output: Option<&OsStr>) -> bool {
        let own = OsString::from(self.default_name());
        let template = output.unwrap_or(&own).to_string_lossy();
        template.contains("{camera}") || template.contains("{frame")
    }

    /// Where the pictures of a scene go.
    ///
    /// # Errors
    /// Two go to the same place.
    pub fn destinations(&self, output: Option<&OsStr>, scene: &Path, shots: &[Shot]) -> Result<Vec<Destination>> {
        let own = OsString::from(self.default_name());
        let template = output.unwrap_or(&own);
        let places = shots.iter().map(|shot| match template.to_str() {
            Some(text) => Destination::from(OsString::from(filled(text, scene, shot))),
            // What is not Unicode has no places to fill.
            None => Destination::from(template.to_owned()),
        });
        let places: Vec<Destination> = places.collect();
        check_distinct(&places)?;
        Ok(places)
    }
}

/// Refuses two pictures in one place.
pub(super) fn check_distinct(places: &[Destination]) -> Result<()> {
    let mut names: Vec<String> = places.iter().map(Destination::to_string).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(Error::new(format!(
            "two pictures would be written to {}: put {{name}}, {{file}}, {{camera}} or {{frame:04}} into --output",
            pair[0]
        ))),
        None => Ok(()),
    }
}

/// A camera, or as many as a turn has of it, each where the picture so many later has it.
fn turned(camera: Camera, frames: Option<Range<u32>>, later: i8, count: f64) -> Vec<Shot> {
    match frames {
        None => vec![Shot { camera, frame: None }],
        Some(frames) => {
            let at = |frame: u32| (f64::from(frame) + f64::from(later)) / count;
            frames.map(|frame| Shot { camera: camera.turned(at(frame)), frame: Some(frame) }).collect()
        }
    }
}

/// A name with what stands in braces filled in; other braces stay.
fn filled(template: &str, scene: &Path, shot: &Shot) -> String {
    let mut text = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once('{') {
        text.push_str(before);
        let place = after.split_once('}').and_then(|(place, after)| Some((value(place, scene, shot)?, after)));
        match place {
            Some((value, after)) => {
                text.push_str(&value);
                rest = after;
            }
            None => {
                text.push('{');
                rest = after;
            }
        }
    }
    text + rest
}

fn value(place: &str, scene: &Path, shot: &Shot) -> Option<String> {
    let frame = shot.frame.unwrap_or(0);
    match place {
        "name" => Some(reading::stem(scene).into_owned()),
        // With its ending, which tells apart cup.obj and cup.glb.
        "file" => Some(reading::file_name(scene).into_owned()),
        // A camera may have any name, and a picture's has no folders of its own.
        "camera" => Some(shot.camera.name.replace(['/', '\\', '\0'], "_")),
        "frame" => Some(frame.to_string()),
        _ => {
            let width: usize = place.strip_prefix("frame:0")?.parse().ok().filter(|width| *width <= 20)?;
            Some(format!("{frame:0width$}"))
        }
    }
}

/// Endings of scenes in a folder.
const ENDINGS: [&str; 6] = ["toml", "gltf", "glb", "eyerays", "obj", "ply"];

/// The scenes that paths name: files, and those in folders by their names.
///
/// # Errors
/// A folder that can't be read or has none.
pub(super) fn scenes(paths: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut scenes = Vec::new();
    for path in paths {
        if !path.is_dir() {
            scenes.push(path.clone());
            continue;
        }
        let entries = fs::read_dir(path).map_err(|error| Error::file(path, format!("cannot be read: {error}")))?;
        let is_scene = |path: &PathBuf| {
            let ending = path.extension().unwrap_or_default();
            ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known)) && path.is_file()
        };
        let mut found: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(is_scene).collect();
        if found.is_empty() {
            return Err(Error::file(path, format!("the folder has no scene: none ends in .{}", ENDINGS.join(", ."))));
        }
        found.sort();
        scenes.extend(found);
    }
    Ok(scenes)
}

/// Pictures a second.
fn rate(text: &str) -> std::result::Result<f64, String> {
    let rate = text.parse().ok().filter(|rate: &f64| *rate > 0.0 && rate.is_finite());
    rate.ok_or_else(|| "write a number above 0, for example 25".to_owned())
}

/// `A..B`.
fn frames(text: &str) -> std::result::Result<Range<u32>, String> {
    let ends = text.split_once("..").and_then(|(a, b)| Some(a.trim().parse().ok()?..b.trim().parse().ok()?));
    let frames = ends.filter(|frames: &Range<u32>| !frames.is_empty());
    frames.ok_or_else(|| "write the first and the one after the last, for example 0..36".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(name: &str) -> Camera {
        let projection = Projection::Perspective { fov: 60.0 };
        Camera::new(name, Vec3::new(1.0, 2.0, 5.0), Vec3::X, projection)
    }

    fn shot(frame: Option<u32>) -> Shot {
        Shot { camera: camera("a/b"), frame }
    }

    #[test]
    fn names_are_filled_in() {
        for (template, frame, want) in [
            ("{name}-{camera}.png", None, "room-a_b.png"),
            ("x{frame:04}.exr", Some(7), "x0007.exr"),
            ("x{frame}.exr", Some(12), "x12.exr"),
            ("{what}{frame:4}{.png", Some(1), "{what}{frame:4}{.png"),
            ("{{name}}", None, "{room}"),
            ("{file}.png", None, "room.obj.png"),
        ] {
            assert_eq!(filled(template, "models/room.obj".as_ref(), &shot(frame)), want, "{template}");
        }
        // As one of standard input is called, too.
        assert_eq!(filled("{file}, {name}", "eyerays.obj".as_ref(), &shot(None)), "eyerays.obj, eyerays");
        assert_eq!(filled("{file}, {name}", "-".as_ref(), &shot(None)), "eyerays, eyerays");
    }

    #[test]
    fn two_pictures_in_one_place_are_refused() {
        let sequence = SequenceArgs { turntable: Some(3), ..SequenceArgs::default() };
        let shots = turned(camera("a"), Some(0..3), 0, 3.0);
        let places = |output: &str| sequence.destinations(Some(output.as_ref()), "s/room.toml".as_ref(), &shots);
        assert!(places("x.png").unwrap_err().message.contains("{frame:04}"));
        assert_eq!(places("{frame}.png").unwrap().len(), 3);
        let own = sequence.destinations(None, "s/room.toml".as_ref(), &shots).unwrap();
        assert_eq!(own[2].to_string(), "room-0002.png");
    }

    /// A quarter of a turn, seen from above, is to the other side of the target.
    #[test]
    fn a_turn_keeps_height_and_distance_and_ends_where_it_began() {
        let shots = turned(camera("a"), Some(0..4), 0, 4.0);
        assert_eq!(turned(camera("a"), Some(1..3), 1, 4.0)[0].camera, shots[2].camera);
        assert_eq!(shots[0].camera, camera("a"));
        for (shot, eye) in shots.iter().zip([[1.0, 2.0, 5.0], [6.0, 2.0, 0.0], [1.0, 2.0, -5.0], [-4.0, 2.0, 0.0]]) {
            assert!((shot.camera.eye - Vec3::from(eye)).length() < 1e-6, "{}", shot.camera.eye);
        }
    }

    #[test]
    fn pictures_of_an_animation_are_so_many_a_second() {
        let seconds = |args: &SequenceArgs| {
            let instants = args.instants().unwrap().into_iter();
            instants.map(|instant| instant.map(|instant| instant.seconds)).collect::<Vec<_>>()
        };
        let args = |fps, frame, frames, turntable| SequenceArgs { fps, frame, frames, turntable, all_cameras: false };
        assert_eq!(seconds(&args(None, None, None, None)), [None]);
        assert_eq!(seconds(&args(None, None, Some(3..5), None)), [Some(0.125), Some(4.0 / 24.0)]);
        assert_eq!(seconds(&args(Some(10.0), Some(7), None, None)), [Some(0.7)]);
        assert_eq!(seconds(&args(None, None, Some(3..5), Some(8))), [None], "of a turn that stands still");
        assert_eq!(seconds(&args(Some(2.0), None, Some(3..5), Some(8))), [Some(1.5), Some(2.0)]);
        assert!(args(Some(2.0), None, None, None).instants().is_err());
        assert!(args(Some(2.0), None, Some(3..9), Some(8)).instants().is_err());
    }

    #[test]
    fn frames_are_some_of_the_turn() {
        assert_eq!(frames("3..9"), Ok(3..9));
        assert!(["3", "9..3", "a..b", "3..=9"].iter().all(|text| frames(text).is_err()));
        let sequence = SequenceArgs { turntable: Some(8), frames: Some(3..9), ..SequenceArgs::default() };
        assert!(sequence.turn().unwrap_err().message.contains("0..8"));
    }
}
