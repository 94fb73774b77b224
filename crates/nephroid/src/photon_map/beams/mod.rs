//! Photon beams: the ways of photons through media, and which of them pass close to a ray.
//!
//! The estimate is Beam × Beam 1D of Jarosz, Nowrouzezahrai, Sadeghi and Jensen 2011, *A Comprehensive
//! Theory of Volumetric Radiance Estimation Using Photon Points and Beams*, ACM TOG 30(1),
//! doi 10.1145/1899404.1899409. Geometry alone: no media, no phase functions.
//!
//! # What is estimated, and what is blurred
//!
//! A beam, the segment p + s ω with 0 < s < L, is spread along the one direction n̂ = d × ω / sin θ that is
//! perpendicular to the ray o + t d *and* to the beam, with the kernel K of one dimension. The ray crosses
//! the strip so made at one point, at an angle whose sine is sin θ, so the integral of the strip's density
//! over the ray is K(u) / sin θ, where u is the distance of the two lines. That is the weight of
//! [`BeamMap::along`], and nothing in it is approximate.
//!
//! In the coordinates p − o = t d − s ω + u n̂ the element of volume is sin θ dt ds du. So for beams of any
//! one direction and length, with uniform origins of density ρ in space, the mean of the weights is
//! ρ ∫dt ∫ds ∫K(u) du = ρ L t_max: length of beams in a unit of volume times the length of the ray, exactly,
//! for each angle, each radius and each kernel that integrates to one. Radii may differ from beam to
//! beam; only a dependence on u or on the query would spoil it.
//!
//! # The ends
//!
//! Nearest points beyond an end of the beam or of the ray do not count. This brings no bias along either:
//! the blur moves each point of a beam sideways, along n̂, and no further than the radius; what comes of
//! the point at s is found at s. So light neither leaks past the end of a beam nor lacks before it, and
//! the share of a beam's length that a ray sees is right up to the last bit of it. What remains is
//! the bias of any blur: half the second derivative, along n̂, of the true density times the kernel's
//! variance; and beside a wall, whose far side has no beams, rays within a radius that see the wall across
//! n̂ lose up to a half.
//!
//! # Nearly parallel beams
//!
//! The weight grows beyond bounds as sin θ → 0. Its mean is right, and for beams of all directions its
//! variance is finite: the mean of 1/sin θ over the sphere makes it π/2 times that of beams at right angles.
//! But weights beyond w come in proportion to w⁻³, and the third moment is infinite: such are fireflies. And a
//! ray exactly along a bundle, as a parallel projection along a parallel light has it, would find nothing. So pairs with sin θ < τ are
//! estimated with a kernel of *two* dimensions, Beam × Beam 2D: the beam is a cylinder with the density
//! K₂(distance from its axis), whose integral over the stretch of the ray inside is estimated with one
//! point of the stretch. Its mean is the same ρ L t_max for beams of any one direction, so a choice by the angle
//! alone leaves the sum right. The weight is at most the length of the overlap times K₂.
//!
//! τ is the radius over the mean length of the beams: as seen across such an angle a beam is
//! shorter than it is wide. It is kept between √ε, below which sin θ has no digits left, and ⅛.

mod along;
mod beam;
mod block;
mod map;
mod parallel;
mod pieces;
mod width;

#[cfg(test)]
mod along_tests;
#[cfg(test)]
mod map_tests;
#[cfg(test)]
mod mean_tests;
#[cfg(test)]
mod testing;

pub use beam::{Beam, Beams};
pub use map::BeamMap;
pub use width::BeamWidth;
