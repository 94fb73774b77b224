//! The right transport by itself: paths where photons are of no use, photons where paths fail, and both together where
//! each does a part. Which it is follows from trials before the first iteration, as lightweight photon mapping (Grittmann et
//! al. 2018, doi 10.1111/cgf.13481) and efficiency-aware importance sampling (Grittmann et al. 2022,
//! doi 10.1145/3528223.3530126) learn which techniques are worth their cost.

mod choice;
mod path_trial;

pub use choice::{AutoConfig, Choice, Pick};

use super::photon_mapper::{CameraPlan, DirectSource, PhotonMapperConfig, Show};
use super::vcm::{self, VcmConfig};
use super::{Effort, PathConfig, progressive};
use crate::observer::Observer;
use crate::transport::{Fog, PhotonPlan};
use crate::world::World;

/// So many times the work that trials tell of is what paths from the camera take, measured against methods with photons
/// on a dozen scenes: the more evenly spread samples of these count for more than in a trial.
const WORK_OF_PATHS: f64 = 1.3;

/// Camera samples of an iteration of paths.
const PATH_SAMPLES: u32 = 4;

/// Plans a render, and says how.
pub(crate) fn plan(
    world: &World,
    config: &AutoConfig,
    seed: u64,
    observer: &dyn Observer,
) -> (PhotonPlan, CameraPlan, Choice) {
    let (photons, camera, of_ppm) = progressive::plan(world, &config.ppm, seed, observer);
    let mut work = Choice::nothing_tried();
    // What saw no light at all tells nothing.
    work.ppm = if of_ppm.variance > 0.0 { of_ppm.work() } else { f64::INFINITY };
    if config.maps_only || needs_maps(&config.ppm.mapper) {
        return (photons, camera, Choice { pick: Pick::Ppm, asked_for: true, ..work });
    }
    let vcm_config = VcmConfig { mapper: config.ppm.mapper.clone(), ..VcmConfig::default() };
    let (vcm_photons, vcm_camera) = vcm::plan_beside(world, &vcm_config, (&photons, &camera), seed, observer);
    let paths = vcm_photons.global.paths;
    let (density, _) = vcm::density(world, &vcm_config, paths, seed, observer);
    let tried = vcm::trial(world, &vcm_config, (&vcm_photons, &vcm_camera), &density, seed, observer);
    // What media scatter to the camera has maps in both, so that the trial tells nothing of paths in fog; they find all of it
    // that no specular surface hides.
    let seen = !world.has_media() || !world.has_dirac_surfaces();
    let path_config = PathConfig {
        max_depth: config.ppm.mapper.max_depth,
        direct_lights: config.ppm.mapper.direct_lights,
        media: world.has_media(),
    };
    let of_path = path_trial::trial(world, &path_config, seed);
    if let Some(tried) = tried {
        work.vcm = tried.merging.map(Effort::work);
        work.paths_are_known = seen;
        // What a lamp without extent sends by specular surfaces they never find, however little of it the trial saw.
        let hidden = photons.caustic.expected_photons > 0 && world.has_dirac_lamps();
        if seen && !hidden && tried.paths.variance.is_finite() {
            work.path = WORK_OF_PATHS * of_path.work().max(tried.paths.variance * of_path.rays);
        }
    } else {
        // All is dark, or nearly so: whatever there is, photons may find.
        return (photons, camera, Choice::nothing_tried());
    }
    let choice = work.picked();
    match choice.pick {
        Pick::Path => (PhotonPlan::default(), CameraPlan::plain(PATH_SAMPLES), choice),
        Pick::Ppm => (photons, camera, choice),
        Pick::Vcm { .. } => (vcm_photons, vcm_camera, choice),
    }
}

/// Whether settings ask for something that only photon maps have.
fn needs_maps(mapper: &PhotonMapperConfig) -> bool {
    mapper.show != Show::All
        || mapper.direct != DirectSource::Rays
        || mapper.single_scatter != DirectSource::Rays
        || mapper.fog != Fog::Volume
}
