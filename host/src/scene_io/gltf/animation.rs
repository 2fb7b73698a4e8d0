//! Animations: what a file's channels make of its nodes at a moment (glTF 2.0, 3.11 and appendix C).

use std::collections::HashMap;
use std::rc::Rc;

use glam::DVec4;

use super::accessor::{Accessors, Elements};
use super::document::{Animation, AnimationSampler, Channel, Document, pick};
use super::notes::Notes;
use super::pointer::{self, Setting, Target};
use crate::math;
use crate::scene::{self, Unplaced};
use crate::scene_io::{AnimationWish, Moment};

/// The most keys of all curves of an animation, and weights of a moment, however often a file names them.
const MOST_KEYS: usize = 1 << 26;

/// What an animation makes of a file.
#[derive(Default)]
pub struct Pose {
    /// Nodes, by their numbers.
    nodes: HashMap<usize, Change>,
    /// What is of no node.
    pub settings: Vec<Setting>,
}

/// What takes the place of what a node says.
#[derive(Default)]
pub struct Change {
    pub translation: Option<[f64; 3]>,
    /// A quaternion.
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    /// Of morph targets.
    pub weights: Option<Vec<f64>>,
}

impl Change {
    /// Does it say where the node is?
    pub fn moves(&self) -> bool {
        self.translation.is_some() || self.rotation.is_some() || self.scale.is_some()
    }
}

impl Pose {
    /// That of a file at a moment. Without a wish it is the start of the first animation, which is said.
    ///
    /// # Errors
    /// There is no such animation, or a channel of it makes no sense.
    pub fn of(document: &Document, accessors: &Accessors, moment: &Moment, notes: &mut Notes) -> Unplaced<Pose> {
        let Some(number) = chosen(document, moment, notes)? else { return Ok(Pose::default()) };
        let animation = pick(&document.animations, number, "animations", "animation")?;
        let seconds = moment.seconds.unwrap_or(0.0);
        let mut keys = Keys { accessors, read: HashMap::new(), left: MOST_KEYS };
        let mut pose = Pose::default();
        for (place, channel) in animation.channels.iter().enumerate() {
            let here = format!("animations[{number}].channels[{place}]");
            let property = channel.target.extensions.property.as_ref().map(|of| &*of.pointer);
            let (node, path) = match (property, channel.target.node) {
                (Some(pointer), _) => match pointer::target(pointer, &here)? {
                    Target::Node(node, path) => (node, path),
                    Target::Property => {
                        pose.settings.push(set(pointer, channel, animation, (&mut keys, &here), seconds)?);
                        continue;
                    }
                },
                (None, Some(node)) => (node, &*channel.target.path),
                (None, None) => {
                    notes.left_out("targets", &format!("{here}.target: it names no node and is left out"));
                    continue;
                }
            };
            pick(&document.nodes, node, &format!("{here}.target.node"), "node")?;
            let change = pose.nodes.entry(node).or_default();
            change.follow((channel, path), animation, (&mut keys, &here), seconds, notes)?;
        }
        Ok(pose)
    }

    /// What it makes of a node, if anything.
    pub fn change(&self, node: usize) -> Option<&Change> {
        self.nodes.get(&node)
    }
}

/// The number of the animation that is asked for, if there is any.
fn chosen(document: &Document, moment: &Moment, notes: &mut Notes) -> Unplaced<Option<usize>> {
    let all = &document.animations;
    match &moment.animation {
        Some(AnimationWish::Rest) => Ok(None),
        _ if all.is_empty() => Ok(None),
        None => {
            if moment.seconds.is_none() {
                let (name, count) = (name(all, 0), all.len());
                let others = if count == 1 { String::new() } else { format!(" another of {count},") };
                notes.changed(
                    "animations",
                    &format!("its animation {name:?} stands at its start: --time moves it, --animation chooses{others} or none"),
                );
            }
            Ok(Some(0))
        }
        Some(AnimationWish::Named(wish)) => {
            let named = all.iter().position(|animation| animation.name.as_deref() == Some(wish));
            let number = named.or_else(|| wish.parse().ok().filter(|&number: &usize| number < all.len()));
            number.map(Some).ok_or_else(|| {
                // A file may have a million.
                let names: Vec<String> = (0..all.len().min(20)).map(|number| name(all, number)).collect();
                format!("animations: there is no {wish:?}; name one of {}, or none", names.join(", "))
            })
        }
    }
}

/// What an animation is called: its own name, or its number.
fn name(all: &[Animation], number: usize) -> String {
    let own = all.get(number).and_then(|animation| animation.name.clone()).filter(|name| !name.trim().is_empty());
    own.unwrap_or_else(|| number.to_string())
}

/// The animations of a file, each with its length. Those that make no sense may be of any length until they are asked for.
pub fn list(document: &Document, accessors: &Accessors) -> Vec<scene::Animation> {
    let last = |sampler: &AnimationSampler| {
        let times = accessors.open(sampler.input, &[1], "").ok()?;
        let [last] = times.vector(times.count.checked_sub(1)?);
        Some(f64::from(last)).filter(|last| last.is_finite())
    };
    let length = |animation: &Animation| animation.samplers.iter().filter_map(last).fold(0.0, f64::max);
    let of = |(number, animation): (usize, &Animation)| scene::Animation {
        name: name(&document.animations, number),
        seconds: length(animation),
    };
    document.animations.iter().enumerate().map(of).collect()
}

/// What a channel makes of a property.
fn set(
    pointer: &str,
    channel: &Channel,
    animation: &Animation,
    (keys, here): (&mut Keys, &str),
    seconds: f64,
) -> Unplaced<Setting> {
    let sampler = pick(&animation.samplers, channel.sampler, &format!("{here}.sampler"), "sampler")?;
    let owner = format!("{here}: its sampler's output");
    let width = keys.accessors.open(sampler.output, &[1, 2, 3, 4], &owner)?.width;
    let numbers = Curve::open(sampler, width, keys, here)?.at(seconds, false);
    Ok(Setting { owner: here.to_owned(), pointer: pointer.to_owned(), numbers })
}

impl Change {
    /// Takes what a channel says.
    fn follow(
        &mut self,
        (channel, path): (&Channel, &str),
        animation: &Animation,
        (keys, here): (&mut Keys, &str),
        seconds: f64,
        notes: &mut Notes,
    ) -> Unplaced<()> {
        let sampler = pick(&animation.samplers, channel.sampler, &format!("{here}.sampler"), "sampler")?;
        let width = match path {
            "translation" | "scale" => 3,
            "rotation" => 4,
            "weights" => 1,
            other => {
                notes.left_out("paths", &format!("{here}.target.path: animations of {other:?} are left out"));
                return Ok(());
            }
        };
        let curve = Curve::open(sampler, width, keys, here)?;
        let numbers = curve.at(seconds, path == "rotation");
        let vector = || [numbers[0], numbers[1], numbers[2]];
        match path {
            "translation" => self.translation = Some(vector()),
            "scale" => self.scale = Some(vector()),
            "rotation" => self.rotation = Some([numbers[0], numbers[1], numbers[2], numbers[3]]),
            _ => self.weights = Some(numbers),
        }
        Ok(())
    }
}

/// Lists of times, each read and checked once.
struct Keys<'a> {
    accessors: &'a Accessors<'a>,
    read: HashMap<usize, Rc<[f32]>>,
    left: usize,
}

impl Keys<'_> {
    /// The times of a list, which rise.
    fn times(&mut self, number: usize, owner: &str) -> Unplaced<Rc<[f32]>> {
        if let Some(times) = self.read.get(&number) {
            return Ok(times.clone());
        }
        let elements = self.accessors.open(number, &[1], owner)?;
        let here = format!("accessors[{number}]");
        if elements.count == 0 {
            return Err(format!("{here}.count: an animation has no key; leave it out"));
        }
        let left = self.left.checked_sub(elements.count);
        self.left = left.ok_or_else(|| format!("{here}: the keys of animations are too many; use fewer"))?;
        let mut times: Vec<f32> = Vec::new();
        for key in 0..elements.count {
            let [time] = elements.vector(key);
            if !time.is_finite() || times.last().is_some_and(|&last| last >= time) {
                return Err(format!("{here}: the time {time} of key {key} does not rise; write the animation again"));
            }
            times.push(time);
        }
        let times: Rc<[f32]> = times.into();
        self.read.insert(number, times.clone());
        Ok(times)
    }
}

/// How values go from key to key.
#[derive(Clone, Copy, PartialEq)]
enum Interpolation {
    Step,
    Linear,
    Cubic,
}

/// The values of a sampler over time.
struct Curve<'f> {
    times: Rc<[f32]>,
    values: Elements<'f>,
    /// Elements of the values that a key has of each part.
    elements: usize,
    interpolation: Interpolation,
}

impl<'f> Curve<'f> {
    fn open(sampler: &AnimationSampler, width: usize, keys: &mut Keys<'f>, here: &str) -> Unplaced<Self> {
        let interpolation = match sampler.interpolation.as_deref() {
            None | Some("LINEAR") => Interpolation::Linear,
            Some("STEP") => Interpolation::Step,
            Some("CUBICSPLINE") => Interpolation::Cubic,
            Some(other) => {
                let fault = format!("{here}: its sampler has the interpolation {other:?}");
                return Err(format!("{fault}, which is none of LINEAR, STEP and CUBICSPLINE; write it again"));
            }
        };
        let times = keys.times(sampler.input, &format!("{here}: its sampler's input"))?;
        let values = keys.accessors.open(sampler.output, &[width], &format!("{here}: its sampler's output"))?;
        let parts = if interpolation == Interpolation::Cubic { 3 } else { 1 };
        let (count, of_keys) = (values.count, times.len() * parts);
        // Of weights a key has as many as there are targets.
        let weights = count / of_keys;
        let left = keys.left.checked_sub(weights);
        keys.left = left.ok_or_else(|| format!("{here}: the weights of animations are too many; use fewer"))?;
        let fits = if width == 1 { count > 0 && count % of_keys == 0 } else { count == of_keys };
        if !fits {
            let fault = format!("{here}: its sampler has {count} values for {} keys", times.len());
            return Err(format!("{fault}; write the animation again"));
        }
        Ok(Curve { elements: weights, times, values, interpolation })
    }

    /// The numbers of a key: of its values, or with cubic splines of part 0 the tangents before them, and of part 2 those behind.
    fn key(&self, key: usize, part: usize) -> Vec<f64> {
        let (parts, part) = if self.interpolation == Interpolation::Cubic { (3, part) } else { (1, 0) };
        let first = (key * parts + part) * self.elements;
        let numbers = (first..first + self.elements).flat_map(|element| {
            let vector: [f32; 4] = self.values.vector(element);
            vector.into_iter().take(self.values.width).map(f64::from)
        });
        numbers.collect()
    }

    /// Its numbers at a time; those of turns are quaternions.
    fn at(&self, seconds: f64, turns: bool) -> Vec<f64> {
        let next = self.times.partition_point(|&time| f64::from(time) <= seconds);
        let value = |key| self.key(key, 1);
        if next == 0 || next == self.times.len() || self.interpolation == Interpolation::Step {
            return value(next.saturating_sub(1));
        }
        let [start, end] = [next - 1, next].map(|key| f64::from(self.times[key]));
        let (length, share) = (end - start, (seconds - start) / (end - start));
        let (from, to) = (value(next - 1), value(next));
        if self.interpolation == Interpolation::Cubic {
            let (out, into) = (self.key(next - 1, 2), self.key(next, 0));
            return (0..from.len())
                .map(|i| hermite([from[i], length * out[i], to[i], length * into[i]], share))
                .collect();
        }
        match (turns, &from[..], &to[..]) {
            (true, &[a, b, c, d], &[e, f, g, h]) => {
                turned(DVec4::new(a, b, c, d), DVec4::new(e, f, g, h), share).to_array().to_vec()
            }
            _ => from.iter().zip(&to).map(|(from, to)| from + (to - from) * share).collect(),
        }
    }
}

/// The cubic of two values, each before the slope that it has.
fn hermite([from, out, to, into]: [f64; 4], t: f64) -> f64 {
    let (square, cube) = (t * t, t * t * t);
    (2.0 * cube - 3.0 * square + 1.0) * from
        + (cube - 2.0 * square + t) * out
        + (3.0 * square - 2.0 * cube) * to
        + (cube - square) * into
}

/// The quaternion at a share of the shorter way from one to another, at an even speed (Shoemake, Animating Rotation with Quaternion
/// Curves, 1985).
fn turned(from: DVec4, to: DVec4, share: f64) -> DVec4 {
    /// Cosines of so small angles that a straight line is as good.
    const NEAR: f64 = 1.0 - 1e-9;
    let (Some(from), Some(to)) = (from.try_normalize(), to.try_normalize()) else { return from };
    let cosine = from.dot(to);
    let (to, cosine) = if cosine < 0.0 { (-to, -cosine) } else { (to, cosine) };
    if cosine > NEAR {
        return from + (to - from) * share;
    }
    let angle = math::acos(cosine);
    (from * math::sin((1.0 - share) * angle) + to * math::sin(share * angle)) / math::sin(angle)
}
