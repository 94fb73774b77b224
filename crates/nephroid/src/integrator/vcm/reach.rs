//! How near photons must lie to be merged with a path.

use std::f32::consts::PI;

use super::densities::Kind;
use crate::math::Vec3;
use crate::photon_map::{GridTree, NearestList, PhotonIndex};
use crate::world::World;

/// Photons by whose distance the density at a point is judged.
const NEIGHBOURS: usize = 8;

/// The largest radius, in radii that hold the photons wanted at their mean density.
const MOST: f32 = 1.0;

/// Within which distances photons are merged with camera paths: at the first surface that is not specular as
/// [`Self::at_first`] tells, and at those behind it, where nobody sees the blur, the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reach {
    /// Behind the first surface.
    pub radius: f32,
    /// The number of light paths; 0 where nothing is merged.
    pub paths: f32,
}

impl Reach {
    /// η of a radius, in m²: the number of light paths times the area.
    pub fn area(&self, radius: f32) -> f32 {
        self.paths * PI * radius * radius
    }

    /// How far from the surface before it a path must be that merges behind the first: nearer, a corner would be blurred
    /// into itself.
    pub fn apart(&self) -> f32 {
        2.0 * self.radius
    }

    /// The radius at the first surface that the camera sees and is not specular, or at one behind it, `far` from the vertex
    /// before or not; 0 where nothing is merged.
    pub fn radius_at(&self, is_first: bool, at_first: f32, far: bool) -> f32 {
        match (is_first, far) {
            (true, _) => at_first,
            (false, true) => self.radius,
            (false, false) => 0.0,
        }
    }

    /// η at vertex `m` of a path, of which `first` is the one that the camera sees first and is not specular, with the
    /// radius `at_first` there; 0 where nothing is merged. Light that came straight from a lamp is not: lamps are asked
    /// for it.
    pub fn area_at(&self, kind: Kind, m: usize, first: usize, at_first: f32, far: bool) -> f64 {
        if m < 2 || kind != Kind::Surface {
            return 0.0;
        }
        let radius = self.radius_at(m == first, at_first, far);
        f64::from(self.area(radius))
    }
}

/// The radius at the first surface that the camera sees and is not specular.
#[derive(Clone, Copy, Debug)]
pub(super) struct AtFirst<'a> {
    pub density: &'a Density,
    /// How much narrower it is than in the first iteration.
    pub factor: f32,
}

impl AtFirst<'_> {
    /// At a point so far along the way from the camera: at least that of a pixel there.
    pub fn radius(&self, world: &World, point: Vec3, distance: f32, found: &mut NearestList) -> f32 {
        let radius = self.density.radius_at(point, found);
        if radius == 0.0 { 0.0 } else { self.factor * radius.max(world.camera().pixel_radius(distance)) }
    }
}

/// How densely photons lie, as those of a trial tell.
#[derive(Clone, Debug)]
pub(crate) struct Density {
    index: GridTree,
    /// What makes a distance of [`NEIGHBOURS`] of them the radius that is wanted in the first iteration.
    scale: f32,
    most: f32,
}

impl Density {
    /// Of the photons of some light paths, with the radius that holds as many as are wanted at their mean density, when so
    /// many of as many more paths are.
    pub fn new(places: &[Vec3], wanted: u32, more: f32) -> Self {
        let (index, _) = GridTree::build(places.len(), |i| places[i]);
        let scale = (wanted as f32 / (NEIGHBOURS as f32 * more)).sqrt();
        let typical = match places.len() {
            0 => 0.0,
            count => (wanted as f32 * index.covered_area() / (PI * count as f32 * more)).sqrt(),
        };
        Self { index, scale, most: MOST * typical }
    }

    /// The radius that holds the photons wanted at their mean density, in the first iteration.
    pub fn typical(&self) -> f32 {
        self.most / MOST
    }

    /// The radius in the first iteration around a point.
    pub fn radius_at(&self, point: Vec3, found: &mut NearestList) -> f32 {
        if self.most <= 0.0 {
            return 0.0;
        }
        let limit = self.most / self.scale;
        self.index.nearest(point, limit * limit, NEIGHBOURS, |_, dist_sq| Some(dist_sq), found);
        let farthest = found.get(NEIGHBOURS - 1).map_or(limit, |neighbor| neighbor.dist_sq.sqrt());
        (farthest * self.scale).min(self.most)
    }
}
