//! Files to and from the types of `nephroid`: scenes in, images out, errors that point.

pub mod diagnostic;
pub mod film_file;
pub mod image;
pub mod mesh;
pub mod mitsuba;
pub mod photons;
pub mod vfs;
pub mod volume;
