//! Progressive photon mapping in its memoryless form (Knaus and Zwicker 2011, doi 10.1145/1966394.1966404): iterations
//! of the photon mapper, each with few photons of its own and estimates that are narrower than those of the one
//! before. Their mean converges, and each is independent of all others.

mod config;

pub use config::PpmConfig;

use super::photon_mapper::{CameraPlan, Guides, Maps, Turn};
use crate::observer::Silent;
use crate::photon_map::Blur;
use crate::sampling::{Key, Stream};
use crate::transport::PhotonPlan;
use crate::world::World;

/// The seed of what is tried before a render.
fn pilot_seed(seed: u64) -> u64 {
    Key::new(seed, 0, Stream::Pilot).with(u64::MAX).hash()
}

/// What to do in each iteration.
pub(crate) fn plan(world: &World, config: &PpmConfig, seed: u64) -> (PhotonPlan, CameraPlan) {
    let mapper = &config.mapper;
    let photons = PhotonPlan::by_pilot(world, &mapper.walk_settings(), &mapper.targets(), seed);
    let camera = CameraPlan {
        samples_per_pixel: config.samples_per_pixel.unwrap_or(1),
        stride: 1,
        gather_rays: Some(1),
    };
    (photons, camera)
}

/// Guides for the gather rays of all iterations, from photons of their own: made once, for any guide is good
/// everywhere.
pub(crate) fn guides(world: &World, config: &PpmConfig, plan: &PhotonPlan, seed: u64) -> Guides {
    let turn = Turn { seed: pilot_seed(seed), iteration: 0, gathers: true, blur: Blur::WHOLE };
    let maps = Maps::build(world, &config.mapper, plan, &turn, &Silent);
    maps.map_or_else(Guides::none, |maps| Guides::new(&maps.global))
}
