//! The GPU of this process, opened once.

use std::sync::OnceLock;

use eyerays::error::{Error, Result};
use eyerays::gpu::Gpu;
use eyerays::render::{Backend, Choice, DeviceWish};

/// The GPU in hardware that is exact, if there is one.
pub fn hardware() -> Option<Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    if is_forked() { None } else { GPU.get_or_init(|| open(DeviceWish::Auto).ok().flatten()).clone() }
}

/// Any GPU that is exact, such as one in software.
///
/// # Errors
/// If there is none.
pub fn any() -> Result<Gpu> {
    static GPU: OnceLock<Result<Gpu>> = OnceLock::new();
    if is_forked() {
        return Err(Error::new("a GPU does not survive a fork; start processes by \"spawn\", or take device=\"cpu\""));
    }
    let opened = GPU.get_or_init(|| match hardware() {
        Some(gpu) => Ok(gpu),
        None => open(DeviceWish::Gpu).map(|gpu| gpu.expect("a GPU was asked for")),
    });
    opened.clone()
}

/// Has another process asked for a GPU before this one was forked from it?
fn is_forked() -> bool {
    static FIRST: OnceLock<u32> = OnceLock::new();
    let process = std::process::id();
    *FIRST.get_or_init(|| process) != process
}

fn open(device: DeviceWish) -> Result<Option<Gpu>> {
    Backend::new(&Choice { device, ..Choice::default() }).map(|backend| backend.gpu().cloned())
}
