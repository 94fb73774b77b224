//! Two-pass photon mapping (Jensen 1996, 2001; the report's §2 in its corrected form): photons from
//! the lights into a global and a caustic map
//! (and one of the light of caustics a bounce later), then camera paths that estimate radiance from them.

mod config;
mod estimate;
mod guide;
mod guides;

pub use config::{DirectSource, FinalGather, PhotonMapperConfig, Show};
pub(crate) use estimate::PhotonMapper;
use guides::Guides;

use crate::observer::{Observer, Phase, Work};
use crate::photon_map::PhotonMap;
use crate::transport::{Ledger, PhotonPlan, photon_pass};
use crate::world::World;

/// The photon maps of one iteration.
pub(crate) struct Maps {
    pub global: PhotonMap,
    pub caustic: PhotonMap,
    /// Light of caustics after one more bounce; empty unless gather rays are sent.
    pub afterglow: PhotonMap,
    guides: Guides,
    pub ledger: Ledger,
}

impl Maps {
    /// Emits the photons of an iteration and arranges them. `None` if cancelled.
    pub fn build(
        world: &World,
        config: &PhotonMapperConfig,
        plan: &PhotonPlan,
        gathers: bool,
        seed: u64,
        iteration: u64,
        observer: &dyn Observer,
    ) -> Option<Self> {
        let settings = config.walk_settings();
        let extras = config.extras(gathers);
        let pass = photon_pass(world, &settings, plan, extras, seed, iteration, observer)?;
        let work = Work::begin(observer, Phase::Maps, 3);
        let build = |photons| {
            let map = PhotonMap::build(photons);
            work.advance(1);
            map
        };
        let (global, (caustic, afterglow)) = rayon::join(
            || build(pass.global),
            || rayon::join(|| build(pass.caustic), || build(pass.afterglow)),
        );
        Some(Self::new([global, caustic, afterglow], gathers, pass.ledger))
    }

    /// Of the global, the caustic and the afterglow map.
    pub fn new([global, caustic, afterglow]: [PhotonMap; 3], gathers: bool, ledger: Ledger) -> Self {
        let guides = if gathers { Guides::new(&global) } else { Guides::none() };
        Self { global, caustic, afterglow, guides, ledger }
    }
}
