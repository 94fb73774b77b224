//! Photons on surfaces and in media, and beams of them: their maps, the search for the nearest ones and for those
//! that pass a ray, kernels, and the geometry of the radiance estimates. Knows neither materials nor media, nor how
//! photons come about.

mod beams;
mod block;
mod blur;
mod brute_force;
mod estimate;
mod grid_build;
mod grid_tree;
mod index;
mod kernel;
mod map;
mod payload;
mod photon;
mod volume;

#[cfg(test)]
mod estimate_tests;
#[cfg(test)]
mod index_tests;
#[cfg(test)]
mod part_tests;
#[cfg(test)]
mod testing;

pub use beams::{Beam, BeamMap, BeamWidth, Beams};
pub use blur::Blur;
pub use brute_force::BruteForce;
pub use estimate::{Bandwidth, Gathered, Query, Weights, gather, gather_both};
pub(crate) use estimate::{MAX_THICKNESS, MIN_NORMAL_COSINE};
pub use grid_tree::GridTree;
pub use index::{Item, NearestList, Neighbor, PhotonIndex};
pub use kernel::Kernel;
pub use map::PhotonMap;
pub use photon::{Photon, Photons};
pub use volume::{VolumeMap, VolumePhoton, VolumePhotons, VolumeQuery};
