use std::f32::consts::PI;

use super::emitter::{Emission, EmissionNumbers};
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::{Bounds, Ray, Vec2, Vec3};
use crate::medium::Medium;
use crate::sampling::Discrete;

/// The share of starts that are spread evenly, in case trial points missed some of the light.
const EVENLY: f64 = 0.1;

/// Where the light of a medium starts: a lattice over bounds around all of it, whose cells are chosen by the light
/// that trial points found in them.
///
/// It knows neither the medium's shape nor how bright it is at a point: an [`Emission`] of it has the power that it
/// would have in a medium that gives off 1 W/(m³·sr) there.
#[derive(Clone, Debug)]
pub(crate) struct Glow {
    medium: Handle<Medium>,
    lattice: Lattice,
    cells: Discrete,
}

/// Bounds and how often they are divided along each axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lattice {
    pub bounds: Bounds,
    pub cells: usize,
}

impl Lattice {
    pub fn count(&self) -> usize {
        self.cells.pow(3)
    }

    /// Volume of a cell, m³.
    pub fn volume(&self) -> f64 {
        let extent = self.bounds.extent().as_dvec3();
        extent.x * extent.y * extent.z / self.count() as f64
    }

    /// The point of a cell at a place in [0, 1)³.
    pub fn point(&self, cell: usize, place: Vec3) -> Vec3 {
        let n = self.cells;
        let corner = Vec3::new((cell % n) as f32, (cell / n % n) as f32, (cell / (n * n)) as f32);
        self.bounds.min + self.bounds.extent() * ((corner + place) / n as f32)
    }
}

impl Glow {
    /// Of the light that was found in each cell; `None` if there is none.
    pub fn new(medium: Handle<Medium>, lattice: Lattice, found: &[f64]) -> Option<Self> {
        let (total, even) = (found.iter().sum::<f64>(), EVENLY / found.len() as f64);
        let cells = (total > 0.0)
            .then(|| Discrete::new(found.iter().map(|light| (1.0 - EVENLY) * light / total + even)))??;
        Some(Self { medium, lattice, cells })
    }

    pub fn medium(&self) -> Handle<Medium> {
        self.medium
    }

    pub fn middle(&self) -> Vec3 {
        self.lattice.bounds.center()
    }

    /// A photon's start. What is left of the number that chooses a cell tells a coordinate in it: of 24 bits up to 15
    /// choose, and the others are finer than anything in a medium that the lattice does not resolve.
    pub fn emit(&self, u: EmissionNumbers, sphere: impl FnOnce(Vec2) -> Vec3) -> Emission {
        let (cell, probability, rest) = self.cells.sample(u.target);
        let position = self.lattice.point(cell, u.position.extend(rest));
        let power = 4.0 * PI * self.lattice.volume() as f32 / probability;
        Emission::whole(Ray::new(position, sphere(u.direction)), None, Rgb::splat(power))
    }
}
