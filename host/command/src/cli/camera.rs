//! Which camera is asked for, and how it is held.

use eyerays::scene::Camera;
use glam::Vec3;

use crate::error::{Error, Result};

/// This way up, or another for who looks along it: no option can turn a camera that was given its place by one.
pub(super) fn upright(up: Vec3, along: Vec3) -> Vec3 {
    [up, Vec3::Y, Vec3::Z].into_iter().find(|&up| along.cross(up).length() != 0.0).unwrap_or(up)
}

/// The camera with this name, or this number.
pub(super) fn pick<'a>(cameras: &'a [Camera], wish: &str) -> Result<&'a Camera> {
    let named = cameras.iter().find(|c| c.name == wish);
    let numbered = || wish.parse::<usize>().ok().and_then(|i| cameras.get(i));
    named.or_else(numbered).ok_or_else(|| {
        let list: Vec<String> = cameras.iter().enumerate().map(|(i, c)| format!("{i} \"{}\"", c.name)).collect();
        Error::new(format!("no camera is \"{wish}\": the scene has {}", list.join(", ")))
    })
}

/// `X,Y,Z`.
pub(super) fn vector(text: &str) -> std::result::Result<Vec3, String> {
    let parts: Option<Vec<f32>> =
        text.split(',').map(|p| p.trim().parse().ok().filter(|x: &f32| x.is_finite())).collect();
    match parts.as_deref() {
        Some([x, y, z]) => Ok(Vec3::new(*x, *y, *z)),
        _ => Err("write three finite numbers, for example 1,2.5,-3".to_owned()),
    }
}
