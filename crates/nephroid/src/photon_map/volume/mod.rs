//! Photons in participating media: their map, and two ways to read it.
//!
//! [`VolumeMap::at`] is the density of photons around a point, as in Jensen and Christensen 1998 (*Efficient
//! Simulation of Light Transport in Scenes with Participating Media using Photon Maps*).
//! [`VolumeMap::along`] is that along a ray: the beam radiance estimate of Jarosz, Zwicker and Jensen 2008
//! (CGF 27(2), doi 10.1111/j.1467-8659.2008.01153.x), which needs no steps.
//!
//! Each medium has a [`Cloud`](cloud::Cloud) of its own, so photons of others cost nothing and cannot count. A
//! cloud is a tree of grids, which finds the nearest and arranges the photons; balls around eight
//! photons, eight such and so on, in the same order; and a radius for each 32.

mod along;
mod at;
mod balls;
mod cloud;
mod map;
mod payload;
mod photon;
mod radii;

#[cfg(test)]
mod along_tests;
#[cfg(test)]
mod at_tests;
#[cfg(test)]
mod map_tests;
#[cfg(test)]
mod testing;

pub use at::VolumeQuery;
pub use map::VolumeMap;
pub use photon::{VolumePhoton, VolumePhotons};
