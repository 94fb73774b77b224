//! Files to and from the types of `nephroid`: scenes in, images out, errors that point.

pub mod image;
