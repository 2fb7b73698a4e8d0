//! The GPU of this process, opened once.

use std::sync::OnceLock;

use eyerays::error::Result;
use eyerays::gpu::Gpu;
use eyerays::render::{Backend, Choice, DeviceWish};

/// The GPU in hardware that is exact, if there is one.
pub fn hardware() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    GPU.get_or_init(|| open(DeviceWish::Auto).ok().flatten()).as_ref()
}

/// Any GPU that is exact, such as one in software.
///
/// # Errors
/// If there is none.
pub fn any() -> Result<Gpu> {
    static GPU: OnceLock<Result<Gpu>> = OnceLock::new();
    let opened = GPU.get_or_init(|| match hardware() {
        Some(gpu) => Ok(gpu.clone()),
        None => open(DeviceWish::Gpu).map(|gpu| gpu.expect("a GPU was asked for")),
    });
    opened.clone()
}

fn open(device: DeviceWish) -> Result<Option<Gpu>> {
    Backend::new(&Choice { device, ..Choice::default() }).map(|backend| backend.gpu().cloned())
}
