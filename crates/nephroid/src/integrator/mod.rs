//! Integrators: each a configuration and one iteration.

pub(crate) mod auto;
mod blur_probe;
mod effort;
mod glances;
mod light_tracer;
mod path;
mod photon_mapper;
mod probe;
pub(crate) mod progressive;
mod quiet;
pub(crate) mod vcm;

pub use auto::{AutoConfig, Choice, Pick};
pub(crate) use blur_probe::BlurProbe;
pub(crate) use effort::Effort;
pub use light_tracer::LightTracerConfig;
pub(crate) use light_tracer::{Brought, LightTracer};
pub use path::PathConfig;
pub(crate) use path::PathTracer;
pub use photon_mapper::{CameraPlan, DirectSource, FinalGather, PhotonMapperConfig, Show, VolumeEstimate};
pub(crate) use photon_mapper::{Guides, Maps, PhotonMapper, Turn};
pub(crate) use probe::{AovProbe, Estimator, Found, LookUp, Met, Passed, Probe};
pub use probe::{FromVolume, LightPart, MapName, MediumLight};
pub use progressive::PpmConfig;
pub(crate) use quiet::Quiet;
pub use vcm::VcmConfig;

use crate::color::Rgb;
use crate::film::{Aov, Pixels};

/// The integrators and their configurations.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// Two-pass photon mapping.
    PhotonMapper(PhotonMapperConfig),
    /// Progressive photon mapping.
    Ppm(PpmConfig),
    /// Vertex connection and merging.
    Vcm(VcmConfig),
    /// Whatever trials find best.
    Auto(AutoConfig),
    /// Unbiased path tracing, the reference for surfaces and media.
    Path(PathConfig),
    /// Unbiased light tracing to the camera, the reference for caustics.
    LightTracer(LightTracerConfig),
}

impl Method {
    /// The name in scene files and on the command line.
    pub fn name(&self) -> &'static str {
        match self {
            Self::PhotonMapper(_) => "photonmapper",
            Self::Ppm(_) => "ppm",
            Self::Vcm(_) => "vcm",
            Self::Auto(_) => "auto",
            Self::Path(config) if config.media => "volpath",
            Self::Path(_) => "path",
            Self::LightTracer(_) => "ptracer",
        }
    }

    /// Whether its iterations are planned, short, and one estimate each.
    pub fn is_progressive(&self) -> bool {
        matches!(self, Self::Ppm(_) | Self::Vcm(_) | Self::Auto(_))
    }

    /// How photons are traced and read, if it is a method that does.
    pub fn mapper(&self) -> Option<&PhotonMapperConfig> {
        match self {
            Self::PhotonMapper(config) => Some(config),
            Self::Ppm(config) => Some(&config.mapper),
            Self::Vcm(config) => Some(&config.mapper),
            Self::Auto(config) => Some(&config.ppm.mapper),
            Self::Path(_) | Self::LightTracer(_) => None,
        }
    }

    /// Whether the variance of its films is that of all their noise, so that the error of a picture can be
    /// [told](crate::film::Quality). The photon mapper's samples of an iteration share photons, whose noise it does not show.
    pub fn tells_error(&self) -> bool {
        !matches!(self, Self::PhotonMapper(_))
    }

    /// How the errors of its pixels hang together.
    pub fn pixels(&self) -> Pixels {
        if matches!(self, Self::Path(_)) { Pixels::Apart } else { Pixels::Together }
    }
}

/// What was emitted and stored of one map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MapTotals {
    pub paths: u64,
    pub photons: usize,
    pub bytes: usize,
}

impl Default for Method {
    fn default() -> Self {
        Self::PhotonMapper(PhotonMapperConfig::default())
    }
}

/// Radiance by the kind of path that brought it, in W/(m²·sr).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Components {
    /// Lamps and sky seen directly or through specular surfaces.
    pub emitted: Rgb,
    /// Light that met one surface that is not specular, and came straight to it.
    pub direct: Rgb,
    /// All other light.
    pub global: Rgb,
    /// Light that came to such a surface by specular ones.
    pub caustic: Rgb,
    /// Light that a medium scattered or gave off towards the camera, directly or by specular surfaces.
    pub medium: Rgb,
}

impl Components {
    /// All of it.
    pub fn total(&self) -> Rgb {
        self.emitted + self.direct + self.global + self.caustic + self.medium
    }

    /// Its parts by the layers of a picture that show them.
    pub(crate) fn by_layer(&self) -> [(Aov, Rgb); 5] {
        [
            (Aov::Direct, self.direct),
            (Aov::Global, self.global),
            (Aov::Caustic, self.caustic),
            (Aov::Emitted, self.emitted),
            (Aov::Medium, self.medium),
        ]
    }

    /// Adds to one part of it.
    pub(crate) fn add(&mut self, part: LightPart, light: Rgb) {
        *match part {
            LightPart::Emitted => &mut self.emitted,
            LightPart::Direct => &mut self.direct,
            LightPart::Global => &mut self.global,
            LightPart::Caustic => &mut self.caustic,
            LightPart::Medium => &mut self.medium,
        } += light;
    }

    /// One part of it.
    pub fn part(&self, part: LightPart) -> Rgb {
        match part {
            LightPart::Emitted => self.emitted,
            LightPart::Direct => self.direct,
            LightPart::Global => self.global,
            LightPart::Caustic => self.caustic,
            LightPart::Medium => self.medium,
        }
    }
}

/// Sums over a picture of radiance by the kind of path that brought it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PictureSums {
    /// Lamps and sky.
    pub emitted: [f64; 3],
    /// Direct light.
    pub direct: [f64; 3],
    /// Indirect light.
    pub global: [f64; 3],
    /// Caustics.
    pub caustic: [f64; 3],
    /// Light from media.
    pub medium: [f64; 3],
    /// What was cut off, where samples are clamped: the others are as they were before.
    pub clamped: [f64; 3],
    /// Camera samples that were summed.
    pub samples: u64,
}

impl PictureSums {
    pub(crate) fn add(&mut self, c: &Components) {
        for (sum, value) in [
            (&mut self.emitted, c.emitted),
            (&mut self.direct, c.direct),
            (&mut self.global, c.global),
            (&mut self.caustic, c.caustic),
            (&mut self.medium, c.medium),
        ] {
            for (s, v) in sum.iter_mut().zip(value.to_array()) {
                *s += f64::from(v);
            }
        }
        self.samples += 1;
    }

    /// Counts light that a sample lost to a clamp.
    pub(crate) fn cut(&mut self, light: Rgb) {
        for (sum, value) in self.clamped.iter_mut().zip(light.to_array()) {
            *sum += f64::from(value);
        }
    }

    pub(crate) fn append(&mut self, more: &Self) {
        for (sum, value) in [
            (&mut self.emitted, more.emitted),
            (&mut self.direct, more.direct),
            (&mut self.global, more.global),
            (&mut self.caustic, more.caustic),
            (&mut self.medium, more.medium),
            (&mut self.clamped, more.clamped),
        ] {
            for (s, v) in sum.iter_mut().zip(value) {
                *s += v;
            }
        }
        self.samples += more.samples;
    }

    /// The share of light that a clamp took, channels averaged; 0 without light.
    pub fn clamped_share(&self) -> f64 {
        let total = |v: [f64; 3]| v.iter().sum::<f64>();
        let parts = [self.emitted, self.direct, self.global, self.caustic, self.medium];
        let all: f64 = parts.into_iter().map(total).sum();
        if all > 0.0 { total(self.clamped) / all } else { 0.0 }
    }

    /// Direct over indirect (global and caustic) light of the picture, channels averaged: 1.25 in the
    /// 2019 report's Cornell box. `None` without indirect light.
    pub fn direct_to_indirect(&self) -> Option<f64> {
        let total = |v: [f64; 3]| v.iter().sum::<f64>();
        let indirect = total(self.global) + total(self.caustic);
        (indirect > 0.0).then(|| total(self.direct) / indirect)
    }
}
