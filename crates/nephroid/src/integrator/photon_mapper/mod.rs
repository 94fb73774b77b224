//! Two-pass photon mapping (Jensen 1996, 2001; the report's §2 in its corrected form): photons from
//! the lights into a global and a caustic map, then camera paths that estimate radiance from them.

mod config;
mod estimate;
mod guide;

pub use config::{DirectSource, FinalGather, PhotonMapperConfig, Show};
pub(crate) use estimate::{PhotonMapper, Scratch};

use crate::observer::{Observer, Phase, Work};
use crate::photon_map::PhotonMap;
use crate::transport::{Ledger, PhotonPass, PhotonPlan, photon_pass};
use crate::world::World;

/// The photon maps of one iteration.
pub(crate) struct Maps {
    pub global: PhotonMap,
    pub caustic: PhotonMap,
    pub ledger: Ledger,
}

impl Maps {
    /// Emits the photons of an iteration and arranges them. `None` if cancelled.
    pub fn build(
        world: &World,
        config: &PhotonMapperConfig,
        plan: &PhotonPlan,
        seed: u64,
        iteration: u64,
        observer: &dyn Observer,
    ) -> Option<Self> {
        let store_direct = config.direct == DirectSource::Map;
        let settings = config.walk_settings();
        let PhotonPass { global, caustic, ledger } =
            photon_pass(world, &settings, plan, store_direct, seed, iteration, observer)?;
        let work = Work::begin(observer, Phase::Maps, 2);
        let (global, caustic) = rayon::join(
            || {
                let map = PhotonMap::build(global);
                work.advance(1);
                map
            },
            || {
                let map = PhotonMap::build(caustic);
                work.advance(1);
                map
            },
        );
        Some(Self { global, caustic, ledger })
    }
}
