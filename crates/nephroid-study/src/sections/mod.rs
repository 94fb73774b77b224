//! The sections, in the order of the report.

mod against_time;
mod ambient_fog;
mod bounce_limit;
mod caustic_photons;
mod direct_by_map;
mod energy;
mod fog_in_glass;
mod fog_steps;
mod fog_volume;
mod kernel_profiles;
mod kernels_compared;
mod kernels_sharp;
mod light_sampling;
mod mirror_wall;
mod mistakes;
mod nearest_photon;
mod neighbours;
mod phong;
mod photon_count;
mod rays_per_pixel;
mod self_hits;
mod sphere_in_glass;
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
    mirror_wall::SECTION,
    nearest_photon::SECTION,
    energy::SECTION,
    direct_by_map::SECTION,
    sphere_in_glass::SECTION,
    phong::SECTION,
    photon_count::SECTION,
    caustic_photons::SECTION,
    neighbours::SECTION,
    rays_per_pixel::SECTION,
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
