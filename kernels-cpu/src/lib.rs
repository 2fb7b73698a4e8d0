//! The kernels for a CPU: here alone they are compiled natively, for each number, instruction set and traversal method.
//!
//! What renders is generic over [`Number`], whose functions are compiled once, with this crate. A program or a test that calls
//! them compiles no kernel of its own.

mod follow;
mod isa;
mod number;
mod records;
mod way;

pub use follow::Query;
pub use isa::Isa;
pub use number::{Between, Number, Queues, Shown};
pub use records::Records;
pub use way::Way;
