//! Participating media. A [`Medium`] is what the scene says; `Matter` is what the world makes of it:
//! distances to collisions, transmittance, and how light is scattered.

mod cells;
mod check;
mod cloud;
mod distance;
mod field;
mod grid;
mod majorant;
mod matter;
mod phase;
mod profile;
mod uniform;

#[cfg(test)]
mod matter_tests;
#[cfg(test)]
mod profile_tests;
#[cfg(test)]
mod testing;

pub(crate) use check::{check_boundary, check_grid, check_medium, check_start};
pub use grid::{Grid, GridValues};
pub(crate) use matter::{Matter, Passage};
pub use phase::{Phase, PhaseSample};
pub(crate) use profile::Profile;

use crate::color::Rgb;
use crate::handle::{Arena, Handle};
use crate::math::Transform;

/// The media of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Media {
    /// What shapes, lights and the camera refer to.
    pub list: Arena<Medium>,
    /// What coefficients refer to.
    pub grids: Arena<Grid>,
}

/// What fills a part of space, as a scene describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// What messages and the ledger call it.
    pub name: String,
    /// Extinction σ_t per length, in 1/m.
    pub sigma_t: Coefficient,
    /// The part of the extinction that is scattering, σ_s / σ_t.
    pub albedo: Coefficient,
    /// Radiance that is added per length, in W/(m³·sr), whatever the extinction.
    pub emission: Coefficient,
    /// How it scatters.
    pub phase: Phase,
    /// Radiance that the ambient approximation takes to be scattered everywhere in every direction, in
    /// W/(m²·sr): L_i of the report's first method, phase function included.
    pub ambient: Rgb,
}

/// A quantity that is the same everywhere or given on a grid.
#[derive(Clone, Debug, PartialEq)]
pub enum Coefficient {
    /// The same everywhere.
    Constant(Rgb),
    /// Interpolated between the cells of a grid. An extinction ends at the sides of the grid; other
    /// quantities go on with their value there.
    Grid {
        /// The values.
        grid: Handle<Grid>,
        /// From [0, 1]³, which the grid fills, to the world.
        to_world: Transform,
        /// Multiplies the values.
        scale: f32,
    },
}

impl Coefficient {
    /// Nothing of it.
    pub const ZERO: Self = Self::Constant(Rgb::BLACK);
}

impl Medium {
    /// A medium that is the same everywhere: extinction in 1/m, albedo without unit.
    pub fn homogeneous(name: impl Into<String>, sigma_t: Rgb, albedo: Rgb, phase: Phase) -> Self {
        Self {
            name: name.into(),
            sigma_t: Coefficient::Constant(sigma_t),
            albedo: Coefficient::Constant(albedo),
            emission: Coefficient::ZERO,
            phase,
            ambient: Rgb::BLACK,
        }
    }
}

/// What lies on both sides of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Boundary {
    /// What is behind it, where its normals point away from; nothing named is vacuum if the other side
    /// names something.
    pub interior: Option<Handle<Medium>>,
    /// What is in front of it.
    pub exterior: Option<Handle<Medium>>,
    /// What the light that it emits starts in, if that is to be given rather than found.
    pub light: Option<Handle<Medium>>,
    /// Of overlapping shapes that have one, the highest is what is there (Schmidt and Budge 2002).
    pub priority: Option<u32>,
}

impl Boundary {
    /// Whether the medium changes where light crosses.
    pub fn is_named(&self) -> bool {
        self.interior.is_some() || self.exterior.is_some()
    }
}
