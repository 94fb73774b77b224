use super::camera_plan::CameraPlan;
use crate::integrator::Method;
use crate::photon_map::Blur;

/// What tells one iteration from others.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    pub seed: u64,
    pub iteration: u64,
    /// Whether gather rays are sent.
    pub gathers: bool,
    /// How wide its estimates are.
    pub blur: Blur,
}

impl Turn {
    /// An iteration of a render.
    pub fn new(method: &Method, camera: &CameraPlan, seed: u64, iteration: u64) -> Self {
        let blur = match method {
            Method::Ppm(_) => Blur::of_iteration(iteration),
            _ => Blur::WHOLE,
        };
        Self { seed, iteration, gathers: camera.gather_rays.is_some(), blur }
    }
}
