//! Lights. A [`Light`] is what the scene says of a light without a surface; area lights are shapes
//! with an emission. Either becomes an emitter of the world.

mod aim;
mod area;
mod emitter;
mod environment;
mod glow;
mod spot;

#[cfg(test)]
mod sampling_tests;

pub(crate) use aim::{Ball, MAX_BALLS, Targets};
pub(crate) use area::AreaEmitter;
pub use emitter::{Emission, Incident, Source, SphereSampling};
pub(crate) use emitter::{EmissionNumbers, Emitter, EmitterKind, Lookup, Target};
pub(crate) use environment::{ConstantSky, EnvironmentMap};
pub(crate) use glow::{Glow, Lattice};
pub(crate) use spot::Spot;

use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::{Transform, Vec3};
use crate::medium::Medium;
use crate::texture::{Pixmap, Texture};

/// A light without a surface, as a scene describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// What messages and the ledger call it.
    pub name: String,
    /// What it is.
    pub kind: LightKind,
    /// What its light starts in, if that is to be given rather than found.
    pub medium: Option<Handle<Medium>>,
}

/// The kinds of lights without a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// The same intensity in every direction.
    Point {
        /// Where.
        position: Vec3,
        /// W/sr.
        intensity: Rgb,
    },
    /// A cone about local +z with a linear edge between `beam_width_deg` and `cutoff_deg`.
    Spot {
        /// Its place and direction.
        to_world: Transform,
        /// W/sr along the axis.
        intensity: Rgb,
        /// Half-angle at which it ends.
        cutoff_deg: f32,
        /// Half-angle up to which it is full.
        beam_width_deg: f32,
        /// Multiplies the intensity, projected along the axis over the cone's square.
        texture: Option<Handle<Texture>>,
    },
    /// Parallel light from infinitely far away.
    Directional {
        /// The direction in which the light travels, unit length.
        direction: Vec3,
        /// W/m² on a surface facing it.
        irradiance: Rgb,
    },
    /// The same radiance from every direction of the sky.
    Constant {
        /// W/(m²·sr).
        radiance: Rgb,
    },
    /// Radiance from an equirectangular image around the scene.
    Environment {
        /// W/(m²·sr) before scaling. The first row is the zenith, local +y.
        image: Handle<Pixmap>,
        /// Multiplies the image.
        scale: f32,
        /// Turns it.
        to_world: Transform,
    },
}
