//! The sections, in the order of the report.

mod bounce_limit;
mod energy;
mod kernel_profiles;
mod light_sampling;
mod nearest_photon;
mod photon_count;
mod three_lights;
mod tone_maps;
mod two_lights;

use crate::section::Section;

/// Every section, in the order of the page.
pub const SECTIONS: &[Section] = &[
    light_sampling::SECTION,
    bounce_limit::SECTION,
    three_lights::SECTION,
    two_lights::SECTION,
    nearest_photon::SECTION,
    energy::SECTION,
    photon_count::SECTION,
    tone_maps::SECTION,
    kernel_profiles::SECTION,
];
