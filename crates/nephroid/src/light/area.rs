use std::f32::consts::PI;

use super::aim::{Cones, Targets};
use super::emitter::{Emission, EmissionNumbers, Incident, Lookup, Source};
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::{Bounds, Frame, Ray, Vec2, Vec3, warp};
use crate::sampling::Discrete;
use crate::shape::{Primitive, Sphere, SurfacePoint};
use crate::texture::{Texture, Textures};

/// A surface that emits the same radiance in every direction of the side its normal points to.
#[derive(Clone, Debug)]
pub(crate) struct AreaEmitter {
    pieces: Vec<Primitive>,
    by_area: Discrete,
    area: f32,
    middle: Vec3,
    radiance: Handle<Texture>,
    flipped: bool,
    /// Its own index, if none of its light can meet it.
    convex: Option<u32>,
}

impl AreaEmitter {
    /// `None` if the pieces have no area.
    pub fn new(
        pieces: Vec<Primitive>,
        radiance: Handle<Texture>,
        flipped: bool,
        convex: Option<u32>,
    ) -> Option<Self> {
        let by_area = Discrete::new(pieces.iter().map(|p| f64::from(p.area())))?;
        let area = by_area.total() as f32;
        let middle = pieces.iter().fold(Bounds::EMPTY, |all, piece| all.union(piece.bounds())).center();
        Some(Self { middle, pieces, by_area, area, radiance, flipped, convex })
    }

    /// πAL with the texture's mean for L, in W; exact for constant radiance.
    pub fn power(&self, textures: &Textures) -> Rgb {
        textures.mean(self.radiance) * (PI * self.area)
    }

    /// The radiance that a point of it gives off.
    pub fn radiance(&self, textures: &Textures, point: &SurfacePoint) -> Rgb {
        textures.eval(self.radiance, point.uv)
    }

    /// The largest radiance that is seen of it, of any channel.
    pub fn brightest(&self, textures: &Textures) -> f32 {
        textures.brightest(self.radiance)
    }

    /// The centre of its bounds.
    pub fn middle(&self) -> Vec3 {
        self.middle
    }

    /// A point uniformly by area.
    fn sample_point(&self, lookup: Lookup<'_>, u: Vec2) -> SurfacePoint {
        let (piece, _, x) = self.by_area.sample(u.x);
        let point = self.pieces[piece].sample(Vec2::new(x, u.y), lookup.meshes);
        if self.flipped { point.flipped() } else { point }
    }

    /// The sphere and 1 − cos of the cone it fills from `p`, if that is how `p` samples it: a sphere
    /// seen from outside that shines outward.
    fn cone(&self, p: Vec3) -> Option<(&Sphere, f32)> {
        match &self.pieces[..] {
            [Primitive::Sphere(sphere)] if !self.flipped => Some((sphere, sphere.cone_one_minus_cos(p)?)),
            _ => None,
        }
    }

    pub fn sample_incident(&self, lookup: Lookup<'_>, p: Vec3, u: Vec2) -> Option<Incident> {
        let (point, cone) = match self.cone(p) {
            Some((sphere, width)) => (sphere.sample_cone(p, width, u), Some(width)),
            None => (self.sample_point(lookup, u), None),
        };
        let to_light = point.position - p;
        let wi = to_light.try_normalize()?;
        let cos = -wi.dot(point.ng);
        if cos <= 0.0 {
            return None;
        }
        let pdf_solid_angle = match cone {
            Some(width) => 1.0 / (2.0 * PI * width),
            None => to_light.length_squared() / (cos * self.area),
        };
        Some(Incident {
            wi,
            radiance: lookup.textures.eval(self.radiance, point.uv),
            pdf_solid_angle,
            dirac: false,
            source: Source::Surface(point),
        })
    }

    /// Density of the direction from `p` to a point of the surface, per unit solid angle.
    pub fn pdf_incident(&self, p: Vec3, point: &SurfacePoint) -> f32 {
        if let Some((_, width)) = self.cone(p) {
            return 1.0 / (2.0 * PI * width);
        }
        let to_light = point.position - p;
        let distance_sq = to_light.length_squared();
        let cos = to_light.dot(point.ng).abs() / distance_sq.sqrt();
        if cos > 0.0 { distance_sq / (cos * self.area) } else { 0.0 }
    }

    /// Uniform over the surface, and cosine-distributed about its normal or, as far as they are less than
    /// half of the hemisphere, uniform over the targets seen from there; `whole` is the power of the light.
    pub fn emit(
        &self,
        lookup: Lookup<'_>,
        u: EmissionNumbers,
        targets: Option<&Targets>,
        whole: Rgb,
    ) -> Emission {
        if let (Some(targets), [Primitive::Sphere(sphere)], false) = (targets, &self.pieces[..], self.flipped)
        {
            let ball = (sphere.center, sphere.radius);
            if let Some(cones) = Cones::seen_from(targets, ball, self.convex, 2.0 * PI, |_, _| true) {
                return self.emit_from_ball(lookup, u, sphere, &cones, whole);
            }
        }
        let point = self.sample_point(lookup, u.position);
        let exitance = lookup.textures.eval(self.radiance, point.uv) * (PI * self.area);
        let above = |axis: Vec3, sin: f32| axis.dot(point.ng) > -sin;
        let cones = targets.and_then(|t| Cones::seen_from(t, (point.position, 0.0), self.convex, PI, above));
        let Some(cones) = cones else {
            let local = warp::square_to_cosine_hemisphere(u.direction);
            let direction = Frame::from_normal(point.ng).to_world(local);
            return Emission::whole(Ray::new(point.position, direction), Some(point), exitance);
        };
        match cones.sample(u.target, u.direction).filter(|direction| direction.dot(point.ng) > 0.0) {
            Some(direction) => Emission {
                ray: Ray::new(point.position, direction),
                surface: Some(point),
                power: exitance * (direction.dot(point.ng) / PI * cones.solid_angle()),
                emitted: exitance,
            },
            None => Emission::elsewhere(point.position, exitance),
        }
    }

    /// The direction first, and then a point of the half that faces it, uniform as seen along it: all
    /// points send the same, which points chosen first do not.
    fn emit_from_ball(
        &self,
        lookup: Lookup<'_>,
        u: EmissionNumbers,
        sphere: &Sphere,
        cones: &Cones,
        whole: Rgb,
    ) -> Emission {
        let Some(direction) = cones.sample(u.target, u.direction) else {
            return Emission::elsewhere(sphere.center, whole);
        };
        let normal = Frame::from_normal(direction).to_world(warp::square_to_cosine_hemisphere(u.position));
        let point = sphere.point(normal.normalize());
        Emission {
            ray: Ray::new(point.position, direction),
            surface: Some(point),
            power: lookup.textures.eval(self.radiance, point.uv) * (0.25 * self.area * cones.solid_angle()),
            emitted: whole,
        }
    }
}
