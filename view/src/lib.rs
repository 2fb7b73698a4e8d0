//! A window on Eyerays (thesis 4.2): the picture is there at once, follows the hand, and gets better while nobody moves.
//!
//! [`Wish`] says what is to be seen, a [`Studio`] makes pictures of that step by step, and a window shows them: on a GPU without their
//! leaving it.

// A library says nothing.
#![cfg_attr(not(test), warn(clippy::print_stderr, clippy::print_stdout))]

mod camera_text;
mod edits;
mod files;
mod live;
pub mod motion;
mod news;
mod reader;
mod shows;
mod studio;
mod window;
mod wish;
mod worker;

use std::path::PathBuf;
use std::sync::{Arc, Mutex};

use eframe::egui_wgpu::{RenderState, WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew};
use eframe::{NativeOptions, Renderer, egui};
use eyerays::error::{Error, Result};
use eyerays::gpu::{self, Around, Gpu, wgpu};
use eyerays::image::Encoding;

pub use edits::{Edits, Own};
pub use live::{Listening, listen};
pub use news::{Answer, Ask, Doing, Facts, Light, News, Picture, Rates, Told, Way};
pub use reader::{AsTheyAre, Read, Reader};
pub use shows::Shows;
pub use studio::{Step, Studio};
pub use wish::{Device, Lesson, Source, Wish};
pub use worker::Worker;

use window::{Asked, Ended, Window};

/// What a window is opened with.
pub struct Opening {
    /// A scene; without one the window waits for a file to be dropped.
    pub path: Option<PathBuf>,
    /// Who reads scenes.
    pub reader: Box<dyn Reader>,
    /// What renders.
    pub device: Device,
    /// A size of the picture that does not follow the window's.
    pub size: Option<(u32, u32)>,
    /// Samples of a pixel at most, where a scene's sampler has any number.
    pub most: Option<u32>,
    /// How light is shown.
    pub look: Encoding,
    /// What is held while a driver opens a GPU or compiles kernels.
    pub around: Option<Around>,
    /// Hears of what is picked and copied, in lines.
    pub told: Box<dyn Fn(&str)>,
}

/// What a window is as large as without a size of its picture.
const SIZE: (u32, u32) = (1280, 720);

/// Opens a window and returns when it is closed.
///
/// # Errors
/// There is no screen, or nothing that draws on it.
pub fn open(opening: Opening) -> Result<()> {
    let Opening { path, reader, device, size, most, look, around, told } = opening;
    let (width, height) = size.unwrap_or(SIZE);
    let title = path.as_deref().and_then(|path| path.file_name()).map(|name| name.to_string_lossy().into_owned());
    let title = title.map_or("Eyerays".to_owned(), |name| format!("{name} - Eyerays"));
    let wish = Wish::new(path.unwrap_or_default(), device, (width, height));
    let wish = Wish { look, most: most.unwrap_or(wish.most), ..wish };
    let ended = Ended::default();
    let told_end = ended.clone();
    run(&title, (width, height), around, move |context, state| {
        let gpu = Gpu::from_wgpu(&state.adapter, state.device.clone(), state.queue.clone());
        let shared = gpu.ok().map(|gpu| gpu.with_around(around));
        let (reader, renders) = (Arc::new(Mutex::new(reader)), shared.clone());
        let studio = move || Studio::new(Box::new(reader.clone()), renders.clone(), around);
        Box::new(Window::new(context, state, studio, Asked { shared, ended: told_end, wish, size, told }))
    })?;
    ended.take().map_or(Ok(()), Err)
}

/// Opens a window around a picture of so many columns and rows, and returns when it is closed. `around` is held while a driver opens a
/// device.
fn run(
    title: &str,
    (width, height): (u32, u32),
    around: Option<Around>,
    create: impl FnOnce(&egui::Context, RenderState) -> Box<dyn eframe::App>,
) -> Result<()> {
    let viewport = egui::ViewportBuilder::default().with_title(title).with_app_id("eyerays");
    let options = NativeOptions {
        viewport: viewport.with_inner_size([width as f32, height as f32 + window::STATUS_HEIGHT]),
        renderer: Renderer::Wgpu,
        wgpu_options: WgpuConfiguration { wgpu_setup: WgpuSetup::CreateNew(setup()), ..Default::default() },
        // The bytes of pictures are shown as they are.
        dithering: false,
        ..Default::default()
    };
    let held = around.map(|begin| begin());
    let create: eframe::AppCreator<'_> = Box::new(move |context| {
        let _held = held;
        let state = context.wgpu_render_state.clone().ok_or("the window has no device of wgpu")?;
        Ok(create(&context.egui_ctx, state))
    });
    eframe::run_native(title, options, create).map_err(|error| not_opened(&error))
}

/// A device for both the window and the kernels.
fn setup() -> WgpuSetupCreateNew {
    let mut setup = WgpuSetupCreateNew::without_display_handle();
    setup.instance_descriptor.backends = wgpu::Backends::PRIMARY;
    setup.instance_descriptor.flags = gpu::flags(setup.instance_descriptor.flags);
    setup.power_preference = wgpu::PowerPreference::HighPerformance;
    setup.device_descriptor = Arc::new(Gpu::descriptor);
    setup
}

/// Why there is no window, in a line.
fn not_opened(error: &eframe::Error) -> Error {
    let said = error.to_string().lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("; ");
    // The line of a library's source that found it out tells nobody anything.
    let said = match said.rsplit_once(".rs:") {
        Some((_, found)) => found.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start_matches(": "),
        None => &said,
    };
    let said = said.trim_end_matches('.');
    let remedy = "a window takes a screen (DISPLAY or WAYLAND_DISPLAY) and a driver of Vulkan, Metal or Direct3D 12 (Debian: mesa-vulkan-drivers); `eyerays render` takes neither";
    Error::new(format!("the window can't be opened: {said}: {remedy}"))
}
