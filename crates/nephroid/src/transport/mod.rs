//! The walks of light: photons from the lights, paths from the camera, and direct light.

mod camera_pass;
mod direct;
mod emit;
mod history;
mod ledger;
mod light_pass;
mod photon_pass;
mod plan;
mod recorder;
mod roulette;
mod start;
mod walk;

pub(crate) use camera_pass::{CameraPass, Exposure, PixelSample, camera_pass, pixel_key};
pub use direct::DirectLights;
pub(crate) use direct::{
    Lit, Partner, Scatterer, choice, direct_light, light_pdf, one_light, sample_lights, sky_by_bsdf,
};
pub use history::PhotonKind;
pub use ledger::{Balance, Ledger};
pub(crate) use light_pass::{Connection, LightPass, Part, Splats, light_pass, splat};
pub use photon_pass::{Extras, InMedia, PhotonPass, photon_pass, volume_pass};
pub use plan::{MapPlan, PhotonPlan, PhotonTargets, VolumeKind};
pub use recorder::{
    Bounces, RecordedPass, RecordedPhoton, RecordedVolumePass, record_photon_pass, record_volume_pass,
};
pub(crate) use roulette::{effort, survival};
pub(crate) use start::Start;
pub(crate) use walk::{Bounce, Event, MapKind, Next, walk};
pub use walk::{Fog, LightChoice, WalkSettings};
