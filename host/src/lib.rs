//! Eyerays: a ray tracer whose kernels are written once, for the CPU and for GPUs, with the same bits on both.
//!
//! A [`scene`] becomes a [`job::Job`]: normalised, checked, with its hierarchy. A [`view::View`] says from
//! where it is seen. [`render::Backend`] renders on the device that fits; [`cpu::Renderer`] and [`gpu::Renderer`] keep a
//! scene for many pictures.
//!
//! ```
//! use eyerays::job::Job;
//! use eyerays::quality::Bvh;
//! use eyerays::render::{Backend, Choice, DeviceWish};
//! use eyerays::scene::Settings;
//! use eyerays::scene_io;
//! use eyerays::view::View;
//!
//! # fn main() -> eyerays::error::Result<()> {
//! let (scene, _warnings) = scene_io::load("../scenes/cornell.toml".as_ref())?;
//! let settings = Settings { size: (32, 32), samples: 1, ..scene.settings };
//! let job = Job::new(&scene, settings, Bvh::Medium.quality())?;
//! let view = View::new(&job, &scene.cameras[0])?;
//! let backend = Backend::new(&Choice { device: DeviceWish::Cpu, ..Choice::default() })?;
//! let rendering = backend.render(&job, &view, 1, &|_pixels| ())?;
//! assert_eq!(rendering.picture.pixels.len(), 32 * 32);
//! # Ok(())
//! # }
//! ```

// A library says nothing; and a closed standard error makes these panic.
#![cfg_attr(not(test), warn(clippy::print_stderr, clippy::print_stdout))]
// A test's expectation may err by a platform's last bit.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod about;
pub mod batch;
pub mod choice;
pub mod compare;
pub mod cpu;
pub mod cryptomatte;
pub mod denoise;
pub mod device_scene;
pub mod error;
pub mod film;
pub mod fireflies;
pub mod gpu;
pub mod image;
pub mod integrator;
pub mod job;
pub mod layers;
pub mod line;
pub mod math;
pub mod memory;
pub mod method;
pub mod noise;
mod optics;
pub mod pick;
pub mod picture;
pub mod plan;
pub mod quality;
pub mod queries;
pub mod rays;
pub mod render;
pub mod scene;
pub mod scene_io;
pub mod spectrum;
pub mod stream;
mod team;
pub mod trail;
pub mod view;
pub mod watch;
mod why;
