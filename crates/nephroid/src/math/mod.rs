//! Vectors, frames, rays, boxes, transforms and the warps between sets of sample points.
//!
//! [`Vec2`], [`Vec3`] and the double-precision [`DVec3`] are glam's, re-exported: write
//! `nephroid::math::Vec3` and the version in use is this crate's business.

mod bounds;
mod frame;
mod ray;
pub mod real;
mod transform;
pub mod warp;

pub use bounds::Bounds;
pub use frame::{Frame, orthonormal_pair};
pub use glam::{Affine2, DAffine3, DMat3, DMat4, DVec3, Vec2, Vec3};
pub use ray::{Ray, gamma, offset_origin};
pub use transform::Transform;
