//! Spectra, and the colours that they, metals and glowing bodies become.

mod blackbody;
mod cie1931;
mod metals;
mod spectrum;

pub(crate) use blackbody::{blackbody, thermal_radiance};
pub(crate) use cie1931::{FIRST_NM, LAST_NM};
pub(crate) use metals::{Known, metal, names};
pub(crate) use spectrum::{Role, Spectrum, xyz_to_rgb};
