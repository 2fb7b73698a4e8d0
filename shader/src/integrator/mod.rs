//! What a wave's hits are turned into: each integrator is a file with the stage that shades a hit and decides which rays
//! go on. The host's file of the same name has its stages in their order.

mod distributed;
mod draws;
mod feature;
mod medium;
mod occlusion;
mod path;
mod photon;
mod sampled;
mod vertex;
mod whitted;

pub use photon::emit;
pub use sampled::{Exchange, ScatterContext, scatter};
pub use whitted::{Wave, shade};
