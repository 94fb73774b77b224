//! Every material against the contract of `Bsdf`. Add a material to `zoo.rs` and it is tested here.
//!
//! The two statistical tests, `samples_follow_their_density` and `photons_and_camera_paths_are_adjoint`,
//! use fixed seeds; with other seeds each would reject correct code once in a hundred times.

mod check;
mod conventions;
mod energy;
mod rich;
mod rich_zoo;
mod sampling;
mod sides;
mod statistics;
mod symmetry;
mod zoo;
