//! What the camera and the lights stand in: found by rays to the boundaries around them, where the scene
//! does not say.

use std::collections::BTreeMap;

use super::nest::Nest;
use super::surroundings::beyond;
use super::{Hit, RayHit, Surfaced, Surroundings, World, leave};
use crate::handle::Handle;
use crate::light::{EmissionNumbers, EmitterKind};
use crate::material::Material;
use crate::math::{Ray, Vec2, warp};
use crate::medium::Medium;
use crate::sampling::{Key, Sampler, Sequence, Stream};
use crate::scene::{Remark, Subject};

/// Rays that look for boundaries around each camera, light and dielectric.
const PROBES: u64 = 64;

/// Surfaces that a probe ray may pass.
const MAX_SURFACES: u32 = 256;

/// What probe rays found: how many of them met which side of which shape first.
#[derive(Default)]
struct Votes(BTreeMap<(Option<usize>, u32), u32>);

impl Votes {
    /// What most met, of equals the medium that stands first in the scene, and the shapes that speak for it and for
    /// something else.
    fn count(&self) -> (Option<usize>, [Vec<u32>; 2]) {
        let mut totals = BTreeMap::<Option<usize>, u32>::new();
        for ((medium, _), votes) in &self.0 {
            *totals.entry(*medium).or_default() += votes;
        }
        let most = totals.iter().max_by_key(|(medium, votes)| (**votes, std::cmp::Reverse(**medium)));
        let winner = most.and_then(|(medium, _)| *medium);
        let shapes = |agree: bool| {
            let mut shapes: Vec<u32> =
                self.0.keys().filter(|(m, _)| (*m == winner) == agree).map(|(_, shape)| *shape).collect();
            shapes.sort_unstable();
            shapes.dedup();
            shapes
        };
        (winner, [shapes(true), shapes(false)])
    }
}

impl World {
    /// Finds what the camera and the lights stand in, and what seems to have been forgotten.
    pub(super) fn look_around(&mut self) {
        if !self.has_media() && !self.has_ranks() {
            return;
        }
        let mut remarks = Vec::new();
        let outside = match self.scene.camera.medium {
            Some(medium) => Surroundings::of(Some(medium)),
            None => {
                let found =
                    self.found(Subject::Camera, "the camera stands", self.camera_probes(), &mut remarks);
                found.unwrap_or_default()
            }
        };
        self.camera_surroundings =
            self.nested(outside, self.scene.camera.medium.is_some(), self.camera_probes());
        self.light_surroundings =
            (0..self.emitters.len()).map(|light| self.around_light(light, &mut remarks)).collect();
        // Without bounds around it, what light may meet lies in every direction.
        if self.light_surroundings.iter().any(|inside| inside.medium().is_some()) {
            self.aims.global = None;
        }
        for shape in 0..self.scene.shapes.len() {
            remarks.extend(self.forgotten_exterior(shape));
        }
        self.remarks = remarks;
    }

    fn around_light(&self, light: usize, remarks: &mut Vec<Remark>) -> Surroundings {
        let emitter = &self.emitters[light];
        let subject = self.lamps[light];
        let named = match subject {
            Subject::Shape(shape) => {
                let boundary = self.scene.shapes[shape].boundary;
                // In front of it, where it shines.
                let beside = boundary.is_named().then_some(boundary.exterior);
                boundary.light.map(Some).or(beside)
            }
            Subject::Light(number) => self.scene.lights[number].medium.map(Some),
            _ => None,
        };
        let outside = match named {
            Some(medium) => Surroundings::of(medium),
            // It comes from outside of everything.
            None if emitter.is_infinite() => return Surroundings::default(),
            None => {
                let found = self.found(subject, "its light starts", self.light_probes(light), remarks);
                // Where it sees no boundary, what the camera is said to stand in is around it as well.
                found.unwrap_or(Surroundings::of(self.scene.camera.medium))
            }
        };
        if emitter.is_infinite() {
            return outside;
        }
        self.nested(outside, named.is_some(), self.light_probes(light))
    }

    /// The same inside of the shapes with priorities that most of some rays begin in. What is `given` is not to be
    /// found in the highest of them.
    pub(super) fn nested(
        &self,
        outside: Surroundings,
        given: bool,
        rays: impl Iterator<Item = Ray>,
    ) -> Surroundings {
        if !self.has_ranks() {
            return outside;
        }
        let mut votes = BTreeMap::<(u32, Option<u32>), i32>::new();
        for ray in rays {
            for (shape, from_within) in self.first_sides(ray) {
                *votes.entry(shape).or_default() += if from_within { 1 } else { -1 };
            }
        }
        let around = votes.into_iter().filter(|(_, votes)| *votes > 0).map(|((shape, _), _)| shape);
        let nest = around.fold(Nest::default(), |nest, shape| nest.with(self.surfaces[shape as usize].rank));
        let there = self.ranked(nest.top()).filter(|_| !given);
        let medium = there.map_or(outside.medium, |there| there.interior);
        Surroundings { medium, outside: outside.medium, nest, ..outside }
    }

    /// The shapes with priorities along a ray, and whether it meets each from within first.
    fn first_sides(&self, mut ray: Ray) -> BTreeMap<(u32, Option<u32>), bool> {
        let mut sides = BTreeMap::new();
        for _ in 0..MAX_SURFACES {
            let ranked = |hit: &RayHit| self.surfaces[hit.shape as usize].rank != 0;
            let Some(hit) = self.scenery.nearest(&ray, ranked) else { break };
            let point = self.surface(&ray, &hit);
            sides.entry((hit.shape, hit.instance)).or_insert(ray.direction.dot(point.ng) > 0.0);
            ray = leave(&point, ray.direction);
        }
        sides
    }

    /// What most of some rays find; a remark where they do not agree. `None` if they meet no boundary.
    fn found(
        &self,
        subject: Subject,
        what: &str,
        rays: impl Iterator<Item = Ray>,
        remarks: &mut Vec<Remark>,
    ) -> Option<Surroundings> {
        let mut votes = Votes::default();
        for ray in rays {
            if let Some((medium, shape)) = self.first_boundary(ray) {
                *votes.0.entry((medium.map(Handle::index), shape)).or_default() += 1;
            }
        }
        if votes.0.is_empty() {
            return None;
        }
        let (winner, [for_it, against]) = votes.count();
        if !against.is_empty() {
            let place = match winner {
                Some(medium) => format!(
                    "in medium `{}`",
                    self.scene.media.list.iter().nth(medium).map_or("", |m| &m.name)
                ),
                None => "outside of all media".into(),
            };
            let message = format!(
                "{what} {place} by {}, but not by {}: name its medium, or close the boundary",
                self.names(&for_it),
                self.names(&against)
            );
            remarks.push(Remark { subject, message });
        }
        let medium =
            winner.and_then(|w| self.scene.media.list.iter_handles().nth(w)).map(|(handle, _)| handle);
        Some(Surroundings::of(medium))
    }

    /// The side of the first surface along a ray that names media: which medium that is, and the shape; of a shape
    /// with a priority what is outside. What light cannot pass ends the search.
    pub(super) fn first_boundary(&self, mut ray: Ray) -> Option<(Option<Handle<Medium>>, u32)> {
        for _ in 0..MAX_SURFACES {
            let hit = self.intersect(&ray)?;
            let Surfaced { boundary, rank, .. } = &self.surfaces[hit.shape as usize];
            if let Some(boundary) = boundary {
                // Inside of one with a priority is whatever is the highest there.
                let ahead = if *rank == 0 { -ray.direction.dot(hit.point.ng) } else { 1.0 };
                return Some((beyond(boundary, ahead), hit.shape));
            }
            if !self.may_pass(&hit) {
                return None;
            }
            ray = leave(&hit.point, ray.direction);
        }
        None
    }

    /// Whether light may go through a surface.
    pub(super) fn may_pass(&self, hit: &Hit) -> bool {
        self.material_of(hit.shape).is_clear(&self.scene.materials, &self.scene.textures)
    }

    fn camera_probes(&self) -> impl Iterator<Item = Ray> + '_ {
        let film = self.scene.film;
        let size = Vec2::new(film.width as f32, film.height as f32);
        (0..PROBES).map(move |i| {
            let mut s = numbers(i);
            // Half along the view, the other half all around from where that begins.
            let ray = self.camera().ray(s.next_2d() * size, Vec2::splat(0.5));
            if i % 2 == 0 { ray } else { Ray::new(ray.origin, warp::square_to_sphere(s.next_2d())) }
        })
    }

    fn light_probes(&self, light: usize) -> impl Iterator<Item = Ray> + '_ {
        let emitter = &self.emitters[light];
        (0..PROBES).map(move |i| {
            let mut s = numbers(i);
            if let EmitterKind::Point { position, .. } = emitter.kind {
                return Ray::new(position, warp::square_to_sphere(s.next_2d()));
            }
            let u = EmissionNumbers { position: s.next_2d(), direction: s.next_2d(), target: 0.5 };
            let emission = emitter.emit(self.lookup(), u, None, warp::square_to_sphere);
            match emission.surface {
                Some(point) => leave(&point, emission.ray.direction),
                None => emission.ray,
            }
        })
    }

    /// A remark on a dielectric in a medium that it does not name: the medium then goes on inside it.
    fn forgotten_exterior(&self, shape: usize) -> Option<Remark> {
        let surfaced = &self.surfaces[shape];
        if surfaced.boundary.is_some()
            || surfaced.rank != 0
            || !matches!(
                self.material_of(shape as u32),
                Material::Dielectric { .. } | Material::RoughDielectric { .. }
            )
        {
            return None;
        }
        let mut votes = Votes::default();
        for i in 0..PROBES {
            let mut s = numbers(i);
            let point = self.scenery.point_on(shape, s.next_1d(), s.next_2d());
            let point = if surfaced.flipped { point.flipped() } else { point };
            let outward = warp::square_to_sphere(s.next_2d());
            let outward = if outward.dot(point.ng) > 0.0 { outward } else { -outward };
            if let Some((medium, boundary)) = self.first_boundary(leave(&point, outward)) {
                *votes.0.entry((medium.map(Handle::index), boundary)).or_default() += 1;
            }
        }
        let medium = self.scene.media.list.iter().nth(votes.count().0?)?;
        let message = format!(
            "it lies in medium `{0}` and names no medium, so `{0}` fills it, too: name `{0}` as its exterior \
             to keep it clear, or as both to say that this is meant",
            medium.name
        );
        Some(Remark { subject: Subject::Shape(shape), message })
    }

    /// The names of a few shapes.
    fn names(&self, shapes: &[u32]) -> String {
        const MOST: usize = 4;
        let named: Vec<String> = shapes
            .iter()
            .take(MOST)
            .filter_map(|&i| self.scene.all_shapes().nth(i as usize))
            .map(|shape| format!("`{}`", shape.name))
            .collect();
        let more = shapes.len().saturating_sub(MOST);
        let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!("{}{rest}", named.join(", "))
    }
}

/// The numbers of a probe ray, the same for all.
fn numbers(index: u64) -> Sampler {
    Sampler::new(Sequence::Sobol, Key::new(0, 0, Stream::Pilot), index)
}
