/// The camera samples of an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraPlan {
    /// Of each pixel.
    pub samples_per_pixel: u32,
    /// Every so many-th of them reads the photon maps, and counts for the others.
    pub stride: u32,
    /// Gather rays of each sample that reads them; `None` reads them on the spot.
    pub gather_rays: Option<u32>,
    /// Photons of an estimate from the global and from the caustic map.
    pub neighbours: [u32; 2],
    /// The radius within which photons are merged with camera paths in the first iteration, where they are, behind the first
    /// surface that is not specular.
    pub merging_radius: f32,
}

impl CameraPlan {
    /// Samples that have no photon maps to read.
    pub(crate) fn plain(samples_per_pixel: u32) -> Self {
        Self {
            samples_per_pixel: samples_per_pixel.max(1),
            stride: 1,
            gather_rays: None,
            neighbours: [2; 2],
            merging_radius: 0.0,
        }
    }
}

impl Default for CameraPlan {
    fn default() -> Self {
        Self::plain(1)
    }
}
