//! Media that give off light, as lights that photons start from.

use rayon::prelude::*;

use super::{Surroundings, World};
use crate::color::Rgb;
use crate::handle::Handle;
use crate::light::{Emitter, EmitterKind, Glow, Lattice};
use crate::math::{Bounds, Ray, Vec3, warp};
use crate::medium::{Boundary, Coefficient, Medium};
use crate::sampling::{Discrete, Key, Sampler, Sequence, Stream};
use crate::scene::{Remark, Scene, Subject};

/// Cells along each axis of the lattice over a medium whose emission is the same everywhere, or on a grid.
const CELLS: usize = 16;
const CELLS_OF_GRID: usize = 32;

/// Points along each edge of the box around a medium from which it is found out whether it goes on outside.
const OUTSIDE: usize = 4;

/// Directions in which a boundary is looked for around a point. The first that finds one tells.
const DIRECTIONS: [Vec3; 6] = [
    Vec3::new(0.5313, 0.3971, 0.7483),
    Vec3::new(-0.6127, 0.7231, -0.3187),
    Vec3::new(0.2719, -0.8573, -0.4371),
    Vec3::new(-0.7919, -0.2311, 0.5651),
    Vec3::new(0.8837, 0.1373, -0.4473),
    Vec3::new(-0.1571, 0.3547, 0.9217),
];

impl World {
    /// What the surroundings are of a point from which light of a medium starts, and how much of it there is, in
    /// W/(m³·sr); `None` if the point lies in no light of that medium.
    pub(crate) fn glow(&self, medium: Handle<Medium>, position: Vec3) -> Option<(Surroundings, Rgb)> {
        let emission = self.matters[medium.index()].emission(position);
        if emission.is_black() {
            return None;
        }
        let inside = self.surroundings_of(position);
        (inside.medium() == Some(medium)).then_some((inside, emission))
    }

    /// Whether a light is a medium.
    #[inline]
    pub(crate) fn is_medium_light(&self, light: u32) -> bool {
        light as usize >= self.surface_lights
    }

    /// Whether photons start from any medium.
    pub(crate) fn glows(&self) -> bool {
        self.emitters.len() > self.surface_lights
    }

    /// What fills a point, found by the first boundary along a ray.
    fn surroundings_of(&self, position: Vec3) -> Surroundings {
        let rays = DIRECTIONS.map(|direction| Ray::new(position, direction.normalize()));
        let found = rays.into_iter().find_map(|ray| self.first_boundary(ray));
        self.nested(Surroundings::of(found.and_then(|(medium, _)| medium)), false, rays.into_iter().take(1))
    }

    /// Makes lights of the media that give off light.
    pub(super) fn kindle(&mut self) {
        let media = self.scene.media.list.iter_handles().map(|(medium, _)| medium);
        let glowing: Vec<_> = media
            .filter(|&medium| self.matters[medium.index()].emits() && self.is_anywhere(medium))
            .collect();
        for medium in glowing {
            match self.bounds_of(medium) {
                Some(bounds) => self.add_glow(medium, bounds),
                None => {
                    let message =
                        "it gives off light, but no shapes that name it close it in: it is seen, and \
                                   photons bring none of its light; name it as the interior of a closed shape"
                            .into();
                    self.remarks.push(Remark { subject: Subject::Medium(medium.index()), message });
                }
            }
        }
        if self.glows() {
            self.by_power = Discrete::new(self.emitters.iter().map(|e| f64::from(e.power.mean())));
            // What its light may meet lies in every direction.
            self.aims.global = None;
        }
    }

    /// Whether anything names a medium.
    fn is_anywhere(&self, medium: Handle<Medium>) -> bool {
        let Scene { camera, lights, .. } = &self.scene;
        let lights = lights.iter().map(|light| light.medium);
        let shapes = self.scene.all_shapes().flat_map(|shape| {
            let Boundary { interior, exterior, light, .. } = shape.boundary;
            [interior, exterior, light]
        });
        lights.chain(shapes).chain([camera.medium]).any(|named| named == Some(medium))
    }

    /// The bounds of the shapes that name a medium; `None` if there are none or if it goes on outside of them.
    fn bounds_of(&self, medium: Handle<Medium>) -> Option<Bounds> {
        let names = |shape: usize| {
            let boundary = self.surfaces[shape].boundary;
            boundary.is_some_and(|b| b.interior == Some(medium) || b.exterior == Some(medium))
        };
        let mut shapes = (0..self.surfaces.len()).filter(|&shape| names(shape));
        let bounds = shapes.try_fold(Bounds::EMPTY, |bounds, shape| {
            Some(bounds.union(self.scenery.bounds_of(shape, &self.scene)?))
        })?;
        if bounds.is_empty() || bounds.extent().min_element() <= 0.0 {
            return None;
        }
        let margin = 0.01 * bounds.extent().max_element();
        let around = Bounds { min: bounds.min - margin, max: bounds.max + margin };
        let at = |i: usize| (i as f32 + 0.5) / OUTSIDE as f32;
        let sides = (0..6).flat_map(|side| {
            let (axis, end) = (side / 2, (side % 2) as f32);
            (0..OUTSIDE * OUTSIDE).map(move |i| {
                let mut place = Vec3::splat(end);
                (place[(axis + 1) % 3], place[(axis + 2) % 3]) = (at(i % OUTSIDE), at(i / OUTSIDE));
                place
            })
        });
        let outside = |place: Vec3| self.surroundings_of(around.min + around.extent() * place);
        let goes_on = sides.filter(|place| outside(*place).medium() == Some(medium)).count();
        // A few may see through a gap in a mesh.
        (10 * goes_on < 6 * OUTSIDE * OUTSIDE).then_some(bounds)
    }

    fn add_glow(&mut self, medium: Handle<Medium>, bounds: Bounds) {
        let described = &self.scene.media.list[medium];
        let name = described.name.clone();
        let cells = match described.emission {
            Coefficient::Constant(_) => CELLS,
            Coefficient::Grid { .. } => CELLS_OF_GRID,
        };
        let lattice = Lattice { bounds, cells };
        let found: Vec<[f64; 3]> =
            (0..lattice.count()).into_par_iter().map(|cell| self.found_in(medium, &lattice, cell)).collect();
        let share = f64::from(warp::SPHERE_PDF).recip() * lattice.volume();
        let sum = |channel: usize| (share * found.iter().map(|light| light[channel]).sum::<f64>()) as f32;
        let power = Rgb::new(sum(0), sum(1), sum(2));
        let weights: Vec<f64> = found.iter().map(|light| light.iter().sum()).collect();
        let Some(glow) = Glow::new(medium, lattice, &weights) else { return };
        self.emitters.push(Emitter { name, kind: EmitterKind::Medium(Box::new(glow)), power });
        self.lamps.push(Subject::Medium(medium.index()));
        self.light_surroundings.push(Surroundings::of(Some(medium)));
    }

    /// The mean of what a medium gives off at eight points of a cell, one in each eighth of it.
    fn found_in(&self, medium: Handle<Medium>, lattice: &Lattice, cell: usize) -> [f64; 3] {
        let key = Key::new(0, 0, Stream::Pilot).with(medium.index() as u64);
        let mut s = Sampler::new(Sequence::Independent, key, cell as u64);
        let mut sum = [0.0; 3];
        for eighth in 0..8 {
            let corner = Vec3::new((eighth & 1) as f32, (eighth >> 1 & 1) as f32, (eighth >> 2) as f32);
            let place = 0.5 * (corner + s.next_2d().extend(s.next_1d()));
            if let Some((_, emission)) = self.glow(medium, lattice.point(cell, place)) {
                for (sum, value) in sum.iter_mut().zip(emission.to_array()) {
                    *sum += f64::from(value) / 8.0;
                }
            }
        }
        sum
    }
}
