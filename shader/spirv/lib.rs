//! The committed SPIR-V modules, embedded so that an installed program carries its kernels. Apart from their sources, whose native
//! code need not be built anew when a module is.

use std::io::Read;
use std::sync::LazyLock;

use flate2::read::ZlibDecoder;

static EXACT: LazyLock<Vec<u8>> = LazyLock::new(|| unpacked(include_bytes!(concat!(env!("OUT_DIR"), "/exact.zlib"))));
static FAST: LazyLock<Vec<u8>> = LazyLock::new(|| unpacked(include_bytes!(concat!(env!("OUT_DIR"), "/fast.zlib"))));

/// The kernel `numerics::evaluate`: what exact arithmetic is built from, see `numerics` of the kernels' own crate.
pub const NUMERICS: &[u8] = include_bytes!("numerics.spv");

/// The kernels `refit::*`: hierarchies whose triangles move, see `refit` of the kernels' own crate.
pub const REFIT: &[u8] = include_bytes!("refit.spv");

/// The kernel `screen::show`: what a screen shows of a film, see `screen` of the kernels' own crate.
pub const SCREEN: &[u8] = include_bytes!("screen.spv");

/// A hash of the sources that the modules were made of.
pub const SOURCE: &str = env!("EYERAYS_SOURCE");

/// Exact arithmetic, kernels `exact::*`, and `subgroup_exact::*` of methods that vote across a subgroup. Every float instruction
/// forbids contraction.
pub fn exact() -> &'static [u8] {
    &EXACT
}

/// Arithmetic at the device's own speed, kernels `fast::*` and `subgroup_fast::*`.
pub fn fast() -> &'static [u8] {
    &FAST
}

/// A program holds the modules compressed: they would be a quarter of it otherwise.
fn unpacked(compressed: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    ZlibDecoder::new(compressed).read_to_end(&mut bytes).expect("compressed by the build script");
    bytes
}
