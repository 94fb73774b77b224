use super::{Coefficient, Grid};
use crate::color::Rgb;
use crate::handle::Arena;
use crate::math::{DAffine3, DVec3, Ray, Vec3};

/// A coefficient as light meets it.
#[derive(Clone, Debug)]
pub(super) enum Field {
    Constant(Rgb),
    Placed(Placed),
}

impl Field {
    pub fn new(coefficient: &Coefficient, grids: &Arena<Grid>) -> Self {
        match *coefficient {
            Coefficient::Constant(value) => Self::Constant(value),
            Coefficient::Grid { grid, to_world, scale } => {
                Self::Placed(Placed::new(&grids[grid], to_world.0, scale))
            }
        }
    }

    /// Its value at a point, which beside a grid is that at the grid's side.
    #[inline]
    pub fn at(&self, p: Vec3) -> Rgb {
        match self {
            Self::Constant(value) => *value,
            Self::Placed(placed) => placed.grid.eval_in_cells(placed.to_cells(p)),
        }
    }

    /// Whether it is zero everywhere.
    pub fn is_black(&self) -> bool {
        match self {
            Self::Constant(value) => value.is_black(),
            Self::Placed(placed) => placed.grid.values.iter().all(Rgb::is_black),
        }
    }
}

/// A grid at its place.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    /// With its values multiplied.
    pub grid: Grid,
    /// From the world to units of cells.
    to_cells: DAffine3,
}

impl Placed {
    fn new(grid: &Grid, to_world: DAffine3, scale: f32) -> Self {
        let cells = DVec3::from_array(grid.size.map(f64::from));
        Self {
            grid: Grid { values: grid.values.scaled(scale), ..grid.clone() },
            to_cells: DAffine3::from_scale(cells) * to_world.inverse(),
        }
    }

    #[inline]
    pub fn to_cells(&self, p: Vec3) -> Vec3 {
        self.to_cells.transform_point3(p.as_dvec3()).as_vec3()
    }

    /// Whether a point in units of cells lies in the grid, its sides included.
    #[inline]
    pub fn contains(&self, cells: Vec3) -> bool {
        let [x, y, z] = self.grid.size.map(|n| n as f32);
        cells.cmpge(Vec3::ZERO).all() && cells.cmple(Vec3::new(x, y, z)).all()
    }

    /// The part of a ray up to `t_max` inside the grid; `None` if it has no length.
    #[inline]
    pub fn crossing(&self, ray: &Ray, t_max: f32) -> Option<Crossing> {
        let origin = self.to_cells.transform_point3(ray.origin.as_dvec3());
        let direction = self.to_cells.transform_vector3(ray.direction.as_dvec3());
        let (mut enter, mut exit) = (0.0f64, f64::from(t_max));
        for axis in 0..3 {
            let (o, d, n) = (origin[axis], direction[axis], f64::from(self.grid.size[axis]));
            if d != 0.0 {
                let (a, b) = (-o / d, (n - o) / d);
                enter = enter.max(a.min(b));
                exit = exit.min(a.max(b));
            } else if !(0.0..=n).contains(&o) {
                return None;
            }
        }
        (enter < exit && exit.is_finite()).then(|| Crossing {
            start: enter as f32,
            length: (exit - enter) as f32,
            origin: (origin + direction * enter).as_vec3(),
            direction: direction.as_vec3(),
        })
    }
}

/// Where a ray passes through a grid. Measured from where it enters, so that a grid far away is seen as
/// finely as one near by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Length of the ray before it, in the world's units.
    pub start: f32,
    /// Length of the ray inside, in the world's units.
    pub length: f32,
    /// Where it enters, in units of cells.
    pub origin: Vec3,
    /// Cells for a unit of length in the world.
    pub direction: Vec3,
}

impl Crossing {
    /// The point after `s` of its length, in units of cells.
    #[inline]
    pub fn at(&self, s: f32) -> Vec3 {
        self.origin + self.direction * s
    }
}
