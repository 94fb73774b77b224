//! Lights. A [`Light`] is what the scene says of a light without a surface; area lights are shapes
//! with an emission. Either becomes an emitter of the world.

mod aim;
mod area;
mod emitter;
mod environment;
mod extent;
mod glow;
mod goniometric;
mod projector;
mod sky;
mod sphere_image;
mod spot;
mod tiles;
mod tree;

#[cfg(test)]
mod emission_tests;
#[cfg(test)]
mod sampling_tests;
#[cfg(test)]
mod tree_tests;

pub(crate) use aim::{Ball, MAX_BALLS, Targets};
pub(crate) use area::AreaEmitter;
pub use emitter::{Emission, Incident, Source, SphereSampling};
pub(crate) use emitter::{EmissionNumbers, Emitter, EmitterKind, Lookup, Target};
pub(crate) use environment::{ConstantSky, EnvironmentMap, Sun};
pub(crate) use glow::{Glow, Lattice};
pub(crate) use goniometric::Goniometric;
pub(crate) use projector::Projector;
pub use sky::{SkySettings, sun_sky};
pub(crate) use spot::Spot;
pub(crate) use tree::{Asker, LightTree};

use crate::camera::FovAxis;
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
    /// Radiance from an image around the scene.
    Environment {
        /// W/(m²·sr) before scaling.
        image: Handle<Pixmap>,
        /// How directions lie in the image.
        mapping: EnvironmentMapping,
        /// Multiplies the image.
        scale: f32,
        /// Turns it.
        to_world: Transform,
    },
    /// A disc at infinity, evenly bright, such as the sun: seen by cameras and in mirrors.
    Sun {
        /// The direction *towards* its middle.
        direction: Vec3,
        /// W/m² on a surface facing its middle.
        irradiance: Rgb,
        /// Half of the angle that it is wide, below 90°; at 0 it is as `Directional`. The sun's is 0.2666°.
        angular_radius_deg: f32,
    },
    /// A point whose intensity depends on the direction, by a table of all of them.
    Goniometric {
        /// Its place and how its table is turned.
        to_world: Transform,
        /// W/sr where the table is 1.
        intensity: Rgb,
        /// Multiplies the intensity in the direction, in local space, in which light leaves.
        table: Handle<Pixmap>,
        /// How directions lie in the table.
        mapping: EnvironmentMapping,
    },
    /// A pinhole that shows an image in a frustum about local +z, as a camera at its place would have seen it: the
    /// first row is on top, towards local +y, and the first column towards local +x.
    Projector {
        /// Its place and direction.
        to_world: Transform,
        /// What is shown.
        image: Handle<Pixmap>,
        /// Multiplies the image.
        scale: Rgb,
        /// What the image says.
        unit: ProjectorUnit,
        /// Opening angle along `fov_axis`.
        fov_deg: f32,
        /// What of the image the angle spans.
        fov_axis: FovAxis,
    },
}

/// How the directions of a sphere lie in a rectangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EnvironmentMapping {
    /// By longitude and latitude. The first row is local +y; the first column begins at −z, and columns go by +x, +z and
    /// −x. Rows lie from pole to pole, the first and the last on them, as Mitsuba's `envmap` has it.
    #[default]
    Equirectangular,
    /// A square whose parts are as large as their solid angles (Clarberg 2008, *Fast Equal-Area Mapping of the
    /// (Hemi)Sphere using SIMD*, doi 10.1080/2151237X.2008.10129263), in the layout of pbrt-v4: the middle is local +z,
    /// all corners are −z, and the first row lies towards −y.
    EqualArea,
}

/// What the image of a projector says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProjectorUnit {
    /// W/sr, as pbrt's `projection` has it: a screen across the axis is darker towards its edges.
    Intensity,
    /// W/m² on the plane z = 1 of local space: a screen across the axis shows the image evenly. Mitsuba 3's `projector`
    /// has this times π, so that a white screen there shows the image's values.
    #[default]
    Irradiance,
}
