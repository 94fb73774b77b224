//! What a render decides before its first iteration.

use super::RenderSettings;
use crate::integrator::{CameraPlan, Method, progressive, vcm};
use crate::observer::{Observer, Phase, Work};
use crate::transport::PhotonPlan;
use crate::world::World;

/// What is done in each iteration, as trial paths with a seed of their own found it best: work is counted and never
/// timed, so each part of a render that is split comes to the same plan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderPlan {
    /// Photon paths; none where there are no photons.
    pub photons: PhotonPlan,
    /// Camera samples.
    pub camera: CameraPlan,
}

impl RenderPlan {
    /// Plans a render of a world.
    pub fn new(world: &World, settings: &RenderSettings, observer: &dyn Observer) -> Self {
        match &settings.method {
            Method::PhotonMapper(config) => {
                let _work = Work::begin(observer, Phase::Pilot, 1);
                let (walk, targets) = (config.walk_settings(), config.targets());
                Self {
                    photons: PhotonPlan::by_pilot(world, &walk, &targets, settings.seed),
                    camera: config.camera_plan(settings.samples_per_pixel),
                }
            }
            Method::Ppm(config) => {
                let _work = Work::begin(observer, Phase::Pilot, 1);
                let (photons, camera) = progressive::plan(world, config, settings.seed, observer);
                Self { photons, camera }
            }
            Method::Vcm(config) => {
                let _work = Work::begin(observer, Phase::Pilot, 1);
                let (photons, camera) = vcm::plan(world, config, settings.seed, observer);
                Self { photons, camera }
            }
            Method::Path(_) | Method::LightTracer(_) => {
                Self { photons: PhotonPlan::default(), camera: CameraPlan::plain(settings.samples_per_pixel) }
            }
        }
    }
}
