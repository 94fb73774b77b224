//! What fills the space where a path is: media change where surfaces that name some are crossed.

use super::nest::Nest;
use super::{Hit, RayHit, Surfaced, World, leave};
use crate::color::{Rgb, Wavelength};
use crate::handle::Handle;
use crate::light::{Asker, Source};
use crate::math::{Ray, Vec3, offset_origin};
use crate::medium::{Boundary, Matter, Medium};
use crate::sampling::Sampler;
use crate::shape::SurfacePoint;

/// What fills the space that a path is in, and of what wavelength its light is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Surroundings {
    pub(super) medium: Option<Handle<Medium>>,
    /// The medium around all shapes that have a priority, known while the path is inside of any.
    pub(super) outside: Option<Handle<Medium>>,
    /// Whether the path takes no notice of media.
    pub(super) blind: bool,
    /// The shapes with priorities that it is inside of.
    pub(super) nest: Nest,
    /// The wavelength of all the light on the path, if it has been taken apart.
    pub(super) wavelength: Option<Wavelength>,
}

impl Surroundings {
    /// Inside a medium or, with `None`, outside of all.
    pub fn of(medium: Option<Handle<Medium>>) -> Self {
        Self { medium, ..Self::default() }
    }

    /// The same for a path that takes no notice of media.
    pub fn blind(self) -> Self {
        Self { medium: None, outside: None, blind: true, ..self }
    }

    /// The medium, if there is one.
    pub fn medium(self) -> Option<Handle<Medium>> {
        self.medium
    }
}

/// Where a shadow ray starts.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Vantage<'a> {
    /// On a surface.
    Surface(&'a SurfacePoint),
    /// Between surfaces.
    Space(Vec3),
}

impl Vantage<'_> {
    pub fn position(&self) -> Vec3 {
        match self {
            Self::Surface(point) => point.position,
            Self::Space(position) => *position,
        }
    }

    /// As one that asks lights.
    pub fn asker(&self) -> Asker {
        match self {
            Self::Surface(point) => Asker::on(point),
            Self::Space(position) => Asker::in_space(*position),
        }
    }

    /// The ray to where light comes from in direction `wi`, short of it. Its direction has the length of the way
    /// where that is finite.
    pub fn shadow_ray(&self, wi: Vec3, source: &Source) -> Ray {
        let origin = match self {
            Self::Surface(p) => offset_origin(p.position, p.error, p.ng, wi),
            Self::Space(position) => *position,
        };
        match end_of(wi, source) {
            None => Ray::new(origin, wi),
            Some(end) => Ray { origin, direction: end - origin, t_max: SHADOW_END },
        }
    }
}

/// Where shadow rays to a light end that is not infinitely far away.
fn end_of(wi: Vec3, source: &Source) -> Option<Vec3> {
    match source {
        Source::Infinity => None,
        Source::Point(p) => Some(*p),
        Source::Surface(s) => Some(offset_origin(s.position, s.error, s.ng, -wi)),
    }
}

/// The shortening of shadow rays that keeps them off the light they end at; relative, as both ends
/// have been moved off their surfaces already.
const SHADOW_END: f32 = 1.0 - 1e-5;

impl World {
    /// Whether there is any medium that a path may be in.
    pub fn has_media(&self) -> bool {
        !self.matters.is_empty()
    }

    /// What is inside, if it is a medium.
    #[inline]
    pub(crate) fn matter(&self, inside: Surroundings) -> Option<&Matter> {
        inside.medium.map(|medium| &self.matters[medium.index()])
    }

    /// What the camera stands in.
    pub fn camera_surroundings(&self) -> Surroundings {
        self.camera_surroundings
    }

    /// What the light of a lamp starts in.
    pub fn light_surroundings(&self, light: usize) -> Surroundings {
        self.light_surroundings.get(light).copied().unwrap_or_default()
    }

    /// Whether a medium ends at a surface that light passes.
    pub(crate) fn ends_medium(&self, hit: &Hit) -> bool {
        let boundary = &self.surfaces[hit.shape as usize].boundary;
        boundary.is_some_and(|b| b.interior != b.exterior) && self.may_pass(hit)
    }

    /// What a path is in that leaves a surface along `direction`, having come along `before`: what it was
    /// in, but where it crossed a surface that names media.
    #[inline]
    pub(crate) fn cross(
        &self,
        inside: Surroundings,
        hit: &Hit,
        before: Vec3,
        direction: Vec3,
    ) -> Surroundings {
        let Surfaced { boundary, rank, .. } = &self.surfaces[hit.shape as usize];
        if boundary.is_none() && *rank == 0 {
            return inside;
        }
        let ahead = direction.dot(hit.point.ng);
        if before.dot(hit.point.ng) * ahead <= 0.0 {
            return inside;
        }
        match boundary {
            _ if *rank != 0 => self.cross_ranked(inside, hit.shape, *rank, ahead),
            Some(boundary) if !inside.blind => Surroundings { medium: beyond(boundary, ahead), ..inside },
            _ => inside,
        }
    }

    /// The share of light from `source` in direction `wi` that reaches a point, right in the mean. `inside` is what
    /// the shadow ray starts in.
    pub(crate) fn light_through(
        &self,
        from: Vantage<'_>,
        inside: Surroundings,
        wi: Vec3,
        source: &Source,
        sampler: &mut Sampler,
    ) -> Rgb {
        let ray = from.shadow_ray(wi, source);
        if !self.has_ranks() && (self.matters.is_empty() || inside.blind) {
            return if self.occluded(&ray) { Rgb::BLACK } else { Rgb::WHITE };
        }
        self.transmittance(ray, end_of(wi, source), inside, sampler)
    }

    /// The share of light that comes through to the end of a ray: null surfaces and those inside of shapes of higher
    /// priority are passed, all others stop it. Of a light that is not infinitely far away `end` is where the ray is
    /// aimed at anew behind each of them, for it begins there a little beside its way.
    fn transmittance(
        &self,
        ray: Ray,
        end: Option<Vec3>,
        mut inside: Surroundings,
        sampler: &mut Sampler,
    ) -> Rgb {
        let mut through = Rgb::WHITE;
        let mut ray = unit(ray);
        loop {
            let hit = self.nearest(&ray);
            if hit.is_some_and(|hit| self.stops(&ray, hit, &inside)) {
                return Rgb::BLACK;
            }
            if let Some(matter) = self.matter(inside) {
                let end = hit.map_or(ray.t_max, |hit| hit.t);
                through *= matter.transmittance(&ray, end, sampler);
            }
            let Some(hit) = hit else { return through };
            let (point, direction) = (self.surface(&ray, &hit), ray.direction);
            inside = self.cross(inside, &Hit::new(&hit, point), direction, direction);
            ray = leave(&point, direction);
            if let Some(end) = end {
                let left = end - ray.origin;
                // The surface lies just before the light.
                if left.dot(direction) <= 0.0 {
                    return through;
                }
                ray = unit(Ray { direction: left, t_max: SHADOW_END, ..ray });
            }
        }
    }

    /// Whether a surface stops a shadow ray.
    #[inline]
    fn stops(&self, ray: &Ray, hit: RayHit, inside: &Surroundings) -> bool {
        let Surfaced { invisible, rank, .. } = self.surfaces[hit.shape as usize];
        let hidden = || self.is_hidden(&Hit::new(&hit, self.surface(ray, &hit)), ray.direction, inside);
        !invisible && (rank == 0 || !hidden())
    }
}

/// The same ray with a direction of unit length.
fn unit(ray: Ray) -> Ray {
    let length = ray.direction.length();
    Ray { direction: ray.direction / length, t_max: ray.t_max * length, ..ray }
}

/// The medium on the side of a surface to which a direction with this cosine to its normal leads.
pub(super) fn beyond(boundary: &Boundary, cos: f32) -> Option<Handle<Medium>> {
    if cos > 0.0 { boundary.exterior } else { boundary.interior }
}
