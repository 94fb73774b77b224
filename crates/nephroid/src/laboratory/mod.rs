//! Looking into a render: its photons one by one, and what the estimate of a pixel saw.
//!
//! All that is random is keyed by (seed, iteration, path), so a photon pass or a camera sample can be run
//! again with somebody watching, and renders keep nothing for it.

mod catalogue;
mod inspect;
mod inspect_probe;
mod photons;
mod picture;

pub use inspect::{Inspector, PixelReport};
pub use inspect_probe::{Contribution, InspectedSample, LookUpReport, MediumPassed, RayLight, SurfaceMet};
pub use photons::{MapPhoton, MapPhotons, record_photons};
pub use picture::{LegendEntry, PhotonColor, PhotonPicture, photon_picture};
