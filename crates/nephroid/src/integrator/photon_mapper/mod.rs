//! Two-pass photon mapping (Jensen 1996, 2001; the report's §2 in its corrected form): photons from
//! the lights into a global and a caustic map (and where gather rays are sent one of the light of caustics a
//! bounce later, and one of the light of media), and in media into maps of their own, then camera paths that
//! estimate radiance from them.

mod camera_plan;
mod config;
mod estimate;
mod guide;
mod guides;
mod turn;
mod volume_index;

pub use camera_plan::CameraPlan;
pub use config::{DirectSource, FinalGather, PhotonMapperConfig, Show, VolumeEstimate};
pub(crate) use estimate::PhotonMapper;
pub(crate) use guides::Guides;
pub(crate) use turn::Turn;
pub(crate) use volume_index::VolumeIndex;

use crate::observer::{Observer, Phase, Work};
use crate::photon_map::{Blur, PhotonMap};
use crate::transport::{Ledger, PhotonPlan, photon_pass, volume_pass};
use crate::world::World;

/// The photon maps of one iteration.
pub(crate) struct Maps {
    pub global: PhotonMap,
    pub caustic: PhotonMap,
    /// Light of caustics after one more bounce; empty unless gather rays are sent.
    pub afterglow: PhotonMap,
    /// Light that surfaces have from media; empty unless gather rays are sent.
    pub haze: PhotonMap,
    /// Light in media but for caustics, and those.
    pub volumes: [VolumeIndex; 2],
    /// How wide its estimates are.
    pub blur: Blur,
    pub ledger: Ledger,
}

impl Maps {
    /// Emits the photons of an iteration and arranges them. `None` if cancelled.
    pub fn build(
        world: &World,
        config: &PhotonMapperConfig,
        plan: &PhotonPlan,
        turn: &Turn,
        observer: &dyn Observer,
    ) -> Option<Self> {
        let settings = config.walk_settings();
        let extras = config.extras(turn.gathers);
        let pass = photon_pass(world, &settings, plan, extras, turn.seed, turn.iteration, observer)?;
        let volumes = Self::volumes(world, config, plan, turn, observer)?;
        let work = Work::begin(observer, Phase::Maps, 4);
        let map = |photons| {
            let map = PhotonMap::build(photons);
            work.advance(1);
            map
        };
        let ((global, caustic), (afterglow, haze)) = rayon::join(
            || rayon::join(|| map(pass.global), || map(pass.caustic)),
            || rayon::join(|| map(pass.afterglow), || map(pass.haze)),
        );
        Some(Self::new([global, caustic, afterglow, haze], volumes, turn.blur, pass.ledger))
    }

    /// The maps of light in media of an iteration. `None` if cancelled.
    pub fn volumes(
        world: &World,
        config: &PhotonMapperConfig,
        plan: &PhotonPlan,
        turn: &Turn,
        observer: &dyn Observer,
    ) -> Option<[VolumeIndex; 2]> {
        let (settings, targets) = (config.walk_settings(), config.targets());
        let [all, caustics] =
            volume_pass(world, &settings, plan, &targets, turn.seed, turn.iteration, observer)?;
        let build = |photons| VolumeIndex::build(photons, config, turn.blur);
        Some(rayon::join(|| build(all), || build(caustics)).into())
    }

    /// Of the global, the caustic, the afterglow and the haze map, and those of light in media.
    pub fn new(
        [global, caustic, afterglow, haze]: [PhotonMap; 4],
        volumes: [VolumeIndex; 2],
        blur: Blur,
        ledger: Ledger,
    ) -> Self {
        Self { global, caustic, afterglow, haze, volumes, blur, ledger }
    }
}
