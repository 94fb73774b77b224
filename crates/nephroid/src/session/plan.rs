//! What a render decides before its first iteration.

use super::RenderSettings;
use crate::integrator::{CameraPlan, Choice, Method, auto, progressive, vcm};
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
    /// What renders, if that was to be found.
    pub choice: Option<Choice>,
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
                    choice: None,
                }
            }
            Method::Ppm(config) => {
                let _work = Work::begin(observer, Phase::Pilot, 1);
                let (photons, camera, _) = progressive::plan(world, config, settings.seed, observer);
                Self { photons, camera, choice: None }
            }
            Method::Vcm(config) => {
                let _work = Work::begin(observer, Phase::Pilot, 1);
                let (photons, camera) = vcm::plan(world, config, settings.seed, observer);
                Self { photons, camera, choice: None }
            }
            Method::Auto(config) => {
                let _work = Work::begin(observer, Phase::Pilot, 1);
                let (photons, camera, choice) = auto::plan(world, config, settings.seed, observer);
                Self { photons, camera, choice: Some(choice) }
            }
            Method::Path(_) | Method::LightTracer(_) => {
                let camera = CameraPlan::plain(settings.samples_per_pixel);
                Self { photons: PhotonPlan::default(), camera, choice: None }
            }
        }
    }

    /// The integrator that renders where this one was asked for.
    pub(crate) fn method(&self, world: &World, asked: &Method) -> Method {
        match (asked, &self.choice) {
            (Method::Auto(config), Some(choice)) => choice.method(world, config),
            (Method::Auto(config), None) => Method::Ppm(config.ppm.clone()),
            _ => asked.clone(),
        }
    }
}
