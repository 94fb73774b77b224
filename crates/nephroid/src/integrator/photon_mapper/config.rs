use super::camera_plan::CameraPlan;
use crate::light::SphereSampling;
use crate::photon_map::{Bandwidth, Kernel, PhotonMap};
use crate::transport::{DirectLights, Extras, Fog, LightChoice, PhotonTargets, VolumeKind, WalkSettings};

/// Settings of the photon mapper. No length in it has a default in scene units.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotonMapperConfig {
    /// Photons wanted in the global map.
    pub photons: u64,
    /// Photons wanted in the caustic map.
    pub caustic_photons: u64,
    /// Paths to emit for each map, whatever they store; overrides the two numbers above.
    pub emit: Option<u64>,
    /// At most this multiple of a wanted number is emitted, and the map is thinner then.
    pub emit_max: u64,
    /// Photons of an estimate, k: the radius is where the k-th lies, or the last found if there are
    /// fewer, and those within count.
    pub neighbours: u32,
    /// A fixed radius in scene units instead of k neighbours.
    pub radius: Option<f32>,
    /// Largest radius of k neighbours, in scene units; by default twice that which holds k photons
    /// at the map's mean density.
    pub max_radius: Option<f32>,
    /// How photons are weighted by their distance.
    pub kernel: Kernel,
    /// Multiplies k so that kernels blur equally wide.
    pub equal_bandwidth: bool,
    /// Where direct light comes from.
    pub direct: DirectSource,
    /// Which lights are sampled for it.
    pub direct_lights: DirectLights,
    /// Whether indirect light is gathered by rays.
    pub final_gather: FinalGather,
    /// Segments of a path from light to lens; `None` without end.
    pub max_depth: Option<u32>,
    /// Which lights photon paths start from.
    pub light_choice: LightChoice,
    /// How lights that shine everywhere are sampled, where they are not aimed.
    pub sphere_sampling: SphereSampling,
    /// Whether photons are sent only where they can meet a surface, those for the caustic map only where
    /// they can meet a specular one.
    pub aim: bool,
    /// Photons wanted in each map of light in media, or beams; by default as many as suit the kind.
    pub volume_photons: Option<u64>,
    /// What these maps hold.
    pub volume_kind: VolumeKind,
    /// How the light of points is summed along a ray.
    pub volume_estimate: VolumeEstimate,
    /// Photons of an estimate in a medium, k: in the ball around a photon for the beam estimate, and around a point
    /// for the march. By default as many as suit the estimate.
    pub volume_neighbours: Option<u32>,
    /// Beams that a ray passes within their radius.
    pub beam_crossings: f32,
    /// Length of the steps of the report's march, in scene units; by default the 128th part of the scene.
    pub march_step: Option<f32>,
    /// Where light comes from that a medium scatters once.
    pub single_scatter: DirectSource,
    /// What media do to light.
    pub fog: Fog,
    /// What part of the light the picture shows.
    pub show: Show,
}

impl Default for PhotonMapperConfig {
    fn default() -> Self {
        Self {
            photons: 200_000,
            caustic_photons: 200_000,
            emit: None,
            emit_max: 100,
            neighbours: 60,
            radius: None,
            max_radius: None,
            kernel: Kernel::Epanechnikov,
            equal_bandwidth: false,
            direct: DirectSource::Rays,
            direct_lights: DirectLights::One,
            final_gather: FinalGather::Auto,
            max_depth: None,
            light_choice: LightChoice::Power,
            sphere_sampling: SphereSampling::SolidAngle,
            aim: true,
            volume_photons: None,
            volume_kind: VolumeKind::Points,
            volume_estimate: VolumeEstimate::Beam,
            volume_neighbours: None,
            beam_crossings: 50.0,
            march_step: None,
            single_scatter: DirectSource::Rays,
            fog: Fog::Volume,
            show: Show::All,
        }
    }
}

/// Where direct light comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DirectSource {
    /// Next event estimation: rays to the lights.
    #[default]
    Rays,
    /// Photons, for comparison: they find their way through glass, and blur shadows.
    Map,
}

/// How the light that photons leave in a medium is summed along a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VolumeEstimate {
    /// The beam radiance estimate: each photon near the ray, blurred across it (Jarosz et al. 2008).
    #[default]
    Beam,
    /// The photons near points of the ray, in steps as long as the estimate blurs, each with the exact integral
    /// of its transmittance and a point by chance.
    March,
    /// The report's march: steps of one length, σ_s L_i Δx + e^(−σ_t Δx) L for each. Too bright by
    /// τ / (1 − e^(−τ)) for steps of optical depth τ.
    MarchReport,
}

/// Whether indirect light on surfaces comes from rays that read the maps where they land, rather
/// than from the maps on the spot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FinalGather {
    /// The maps on the spot.
    Off,
    /// So many rays that a pixel has 64, between 1 and 16 a camera sample that reads the maps, and fewer where indirect
    /// light is less than half of all; off where direct light comes from the map or the picture shows one map.
    #[default]
    Auto,
    /// So many rays for each camera sample that reads the maps.
    Rays(u32),
}

/// What part of the light the picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Show {
    /// Everything.
    #[default]
    All,
    /// Direct light; with the caustics, where it comes from the map.
    Direct,
    /// Global and caustic light.
    Indirect,
    /// What the global map holds.
    Global,
    /// What the caustic map holds.
    Caustic,
    /// What media scatter and give off.
    Medium,
}

impl PhotonMapperConfig {
    pub(crate) fn walk_settings(&self) -> WalkSettings {
        WalkSettings {
            // One segment at least lies between the photon and the lens.
            max_photon_depth: self.max_depth.map(|depth| depth.saturating_sub(1)),
            light_choice: self.light_choice,
            sphere_sampling: self.sphere_sampling,
            aim: self.aim,
            fog: self.fog,
        }
    }

    /// Whether light that comes from lamps straight is shown.
    pub(crate) fn shows_direct(&self) -> bool {
        matches!(self.show, Show::All | Show::Direct)
    }

    /// Caustics count as direct light where that comes from photons, which are not stopped by glass.
    pub(crate) fn shows_caustics(&self) -> bool {
        matches!(self.show, Show::All | Show::Indirect | Show::Caustic)
            || (self.show == Show::Direct && self.direct == DirectSource::Map)
    }

    /// Whether light that media send to the camera is shown.
    pub(crate) fn shows_media(&self) -> bool {
        matches!(self.show, Show::All | Show::Medium)
    }

    /// Photons or beams wanted in each map of light in media.
    pub fn volume_photons(&self) -> u64 {
        self.volume_photons.unwrap_or(match self.volume_kind {
            VolumeKind::Points => 200_000,
            VolumeKind::Beams => 20_000,
        })
    }

    /// Photons of an estimate in a medium.
    pub(crate) fn volume_neighbours(&self) -> u32 {
        self.volume_neighbours.unwrap_or(match self.volume_estimate {
            VolumeEstimate::Beam => 8,
            VolumeEstimate::March | VolumeEstimate::MarchReport => self.neighbours,
        })
    }

    pub(crate) fn targets(&self) -> PhotonTargets {
        let shows_global = matches!(self.show, Show::All | Show::Indirect | Show::Global)
            || (self.show == Show::Direct && self.direct == DirectSource::Map);
        PhotonTargets {
            global: if shows_global { self.photons } else { 0 },
            // Gather rays leave the light of caustics on other surfaces to photons of the same paths,
            // and rays of glossy lobes see caustics.
            caustic: if self.shows_caustics() || shows_global { self.caustic_photons } else { 0 },
            emit: self.emit,
            emit_max: self.emit_max,
            store_direct: self.direct == DirectSource::Map,
            volume: if self.shows_media() { self.volume_photons() } else { 0 },
            volume_kind: self.volume_kind,
            store_single_scatter: self.single_scatter == DirectSource::Map,
        }
    }

    /// What photon passes store besides, where gather rays are sent or not.
    pub(crate) fn extras(&self, gathers: bool) -> Extras {
        Extras { direct: self.direct == DirectSource::Map, unseen: gathers }
    }

    /// The camera samples of an iteration that has so many of each pixel.
    pub(crate) fn camera_plan(&self, samples_per_pixel: u32) -> CameraPlan {
        let samples_per_pixel = samples_per_pixel.max(1);
        let stride = reading_stride(samples_per_pixel);
        CameraPlan {
            samples_per_pixel,
            stride,
            gather_rays: self.gather_rays(samples_per_pixel / stride),
            neighbours: [self.neighbours; 2],
            merging_radius: 0.0,
        }
    }

    /// Gather rays of each camera sample that reads the maps; `None` reads them on the spot.
    fn gather_rays(&self, samples_per_pixel: u32) -> Option<u32> {
        match self.final_gather {
            FinalGather::Off | FinalGather::Rays(0) => None,
            FinalGather::Rays(n) => Some(n),
            FinalGather::Auto => {
                let single_map = matches!(self.show, Show::Global | Show::Caustic | Show::Direct);
                let on_the_spot = single_map || self.direct == DirectSource::Map;
                (!on_the_spot).then(|| (64 / samples_per_pixel.max(1)).clamp(1, 16))
            }
        }
    }

    /// Whether fewer gather rays are sent where they count for little.
    pub(crate) fn spares_gather_rays(&self) -> bool {
        self.final_gather == FinalGather::Auto
    }

    /// The width of estimates from a map.
    pub(crate) fn bandwidth(&self, map: &PhotonMap, neighbours: u32) -> Bandwidth {
        if let Some(radius) = self.radius {
            return Bandwidth::Fixed { radius };
        }
        let factor = if self.equal_bandwidth { self.kernel.equal_bandwidth_factor() } else { 1.0 };
        let k = ((neighbours as f32 * factor).round() as u32).max(2);
        Bandwidth::Nearest { k, max_radius: self.max_radius.unwrap_or_else(|| map.default_max_radius(k)) }
    }
}

/// Of how many camera samples one reads the maps, and counts for the others, which bring direct light
/// and emission only: what a map shows hardly changes within a pixel. At least 4 samples of a pixel
/// read. The steps of a session are whole multiples, so that a render may stop after any of them.
fn reading_stride(samples_per_pixel: u32) -> u32 {
    [4, 2]
        .into_iter()
        .find(|s| samples_per_pixel.is_multiple_of(*s) && samples_per_pixel >= 4 * s)
        .unwrap_or(1)
}
