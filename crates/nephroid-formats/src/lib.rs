//! Files to and from the types of `nephroid`: scenes in, images out, errors that point.

pub mod diagnostic;
pub mod film_file;
pub mod fit;
pub mod gltf;
pub mod ies;
pub mod image;
mod integrator_request;
mod log;
pub mod mesh;
pub mod mitsuba;
pub mod mitsuba_writer;
mod number;
mod open;
pub mod pbrt;
pub mod photons;
mod sandbox;
pub mod scene;
mod scene_file;
mod spectra;
pub mod vfs;
pub mod volume;

pub use integrator_request::{AovLayer, IntegratorParameter, IntegratorRequest, ParameterValue};
pub use sandbox::{OutsideSandbox, SandboxFiles};
pub use scene_file::{Options, Origins, SceneFile};
