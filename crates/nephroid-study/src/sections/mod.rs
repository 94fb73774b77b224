//! The sections, in the order of the report.

mod against_time;
mod ambient_fog;
mod fog_in_glass;
mod fog_steps;
mod fog_volume;
mod kernel_profiles;
mod kernels_compared;
mod kernels_sharp;
mod light_sampling;
mod mistakes;
mod photon_count;
mod self_hits;
mod three_lights;
mod tone_maps;
mod two_lights;

use crate::section::Section;

/// Every section, in the order of the page.
pub const SECTIONS: &[Section] = &[
    light_sampling::SECTION,
    three_lights::SECTION,
    two_lights::SECTION,
    photon_count::SECTION,
    mistakes::POWER,
    mistakes::COSINE,
    mistakes::SAMPLING,
    self_hits::SECTION,
    tone_maps::SECTION,
    ambient_fog::SECTION,
    fog_volume::SECTION,
    fog_steps::SECTION,
    fog_in_glass::SECTION,
    fog_in_glass::PHOTONS,
    kernel_profiles::SECTION,
    kernels_compared::SECTION,
    kernels_sharp::SECTION,
    against_time::SECTION,
];
