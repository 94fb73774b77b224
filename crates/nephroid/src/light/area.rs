use std::f32::consts::PI;

use super::emitter::{Emission, Incident, Lookup, Source};
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::{Frame, Ray, Vec2, Vec3, warp};
use crate::sampling::Discrete;
use crate::shape::{Primitive, SurfacePoint};
use crate::texture::{Texture, Textures};

/// A surface that emits the same radiance in every direction of the side its normal points to.
#[derive(Clone, Debug)]
pub(crate) struct AreaEmitter {
    pieces: Vec<Primitive>,
    by_area: Discrete,
    area: f32,
    radiance: Handle<Texture>,
    flipped: bool,
}

impl AreaEmitter {
    /// `None` if the pieces have no area.
    pub fn new(pieces: Vec<Primitive>, radiance: Handle<Texture>, flipped: bool) -> Option<Self> {
        let by_area = Discrete::new(pieces.iter().map(|p| f64::from(p.area())))?;
        let area = by_area.total() as f32;
        Some(Self { pieces, by_area, area, radiance, flipped })
    }

    /// πAL with the texture's mean for L, in W; exact for constant radiance.
    pub fn power(&self, textures: &Textures) -> Rgb {
        textures.mean(self.radiance) * (PI * self.area)
    }

    /// A point uniformly by area.
    fn sample_point(&self, lookup: Lookup<'_>, u: Vec2) -> SurfacePoint {
        let (piece, _, x) = self.by_area.sample(u.x);
        let point = self.pieces[piece].sample(Vec2::new(x, u.y), lookup.meshes);
        if self.flipped { point.flipped() } else { point }
    }

    /// The sphere and 1 − cos of the cone it fills from `p`, if that is how `p` samples it: a sphere
    /// seen from outside that shines outward.
    fn cone(&self, p: Vec3) -> Option<(&crate::shape::Sphere, f32)> {
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

    /// Uniform over the surface, cosine-distributed about its normal.
    pub fn emit(&self, lookup: Lookup<'_>, u_position: Vec2, u_direction: Vec2) -> Emission {
        let point = self.sample_point(lookup, u_position);
        let direction = Frame::from_normal(point.ng).to_world(warp::square_to_cosine_hemisphere(u_direction));
        Emission {
            ray: Ray::new(point.position, direction),
            surface: Some(point),
            power: lookup.textures.eval(self.radiance, point.uv) * (PI * self.area),
        }
    }
}
