//! The walks of light: photons from the lights, paths from the camera, and direct light.

mod camera_pass;
mod direct;
mod ledger;
mod photon_pass;
mod recorder;
mod roulette;
mod walk;

pub(crate) use camera_pass::{CameraPass, Exposure, PixelSample, camera_pass, pixel_key};
pub use direct::DirectLights;
pub(crate) use direct::{Partner, direct_light, light_pdf, sample_lights, sky_by_bsdf};
pub use ledger::{Balance, Ledger};
pub use photon_pass::{Extras, MapPlan, PhotonPass, PhotonPlan, PhotonTargets, photon_pass};
pub use recorder::{Bounces, RecordedPass, RecordedPhoton, record_photon_pass};
pub(crate) use roulette::survival;
pub use walk::{LightChoice, PhotonKind, WalkSettings};
