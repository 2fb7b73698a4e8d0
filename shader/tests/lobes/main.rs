//! What closures promise to integrators: densities are those of samples, scattering is reciprocal, and light is conserved.

mod albedo;
mod chi_square;
mod finish;
mod furnace;
mod hair;
mod integral;
mod reciprocity;
mod surface;
mod tables;
