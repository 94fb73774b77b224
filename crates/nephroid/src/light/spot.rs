use std::f32::consts::PI;

use super::emitter::Emission;
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::real::{acos, cos, sin, tan};
use crate::math::{Frame, Ray, Transform, Vec2, Vec3, warp};
use crate::texture::{Texture, Textures};

/// A point light that shines into a cone, fading linearly in the angle near its edge.
#[derive(Clone, Debug)]
pub(crate) struct Spot {
    pub position: Vec3,
    frame: Frame,
    peak: Rgb,
    /// Radians.
    cutoff: f32,
    beam_width: f32,
    texture: Option<Handle<Texture>>,
}

impl Spot {
    /// Angles are half-angles, 0 ≤ beam width ≤ cutoff < 90°; the transform must be invertible.
    pub fn new(
        to_world: &Transform,
        peak: Rgb,
        cutoff_deg: f32,
        beam_width_deg: f32,
        texture: Option<Handle<Texture>>,
    ) -> Self {
        let axis = |v: Vec3| to_world.vector(v).normalize();
        Self {
            position: to_world.point(Vec3::ZERO),
            frame: Frame { s: axis(Vec3::X), t: axis(Vec3::Y), n: axis(Vec3::Z) },
            peak,
            cutoff: cutoff_deg.to_radians(),
            beam_width: beam_width_deg.to_radians(),
            texture,
        }
    }

    /// W/sr in a unit direction away from the light.
    pub fn intensity(&self, textures: &Textures, direction: Vec3) -> Rgb {
        let local = self.frame.to_local(direction);
        let angle = acos(local.z);
        if angle >= self.cutoff {
            return Rgb::BLACK;
        }
        let falloff = if angle <= self.beam_width {
            1.0
        } else {
            (self.cutoff - angle) / (self.cutoff - self.beam_width)
        };
        let tint = self.texture.map_or(Rgb::WHITE, |texture| {
            let scale = 0.5 / (local.z * tan(self.cutoff));
            textures.eval(texture, Vec2::new(0.5 + local.x * scale, 0.5 + local.y * scale))
        });
        self.peak * tint * falloff
    }

    /// W: the integral of the intensity, exact up to the texture, of which the mean counts.
    pub fn power(&self, textures: &Textures) -> Rgb {
        let (c, b) = (self.cutoff, self.beam_width);
        let fade = if c > b { (sin(c) - sin(b)) / (c - b) } else { cos(c) };
        let tint = self.texture.map_or(Rgb::WHITE, |t| textures.mean(t));
        self.peak * tint * (2.0 * PI * (1.0 - fade))
    }

    /// Uniform over the solid angle of the cone.
    pub fn emit(&self, textures: &Textures, u: Vec2) -> Emission {
        let cos_max = cos(self.cutoff);
        let direction = self.frame.to_world(warp::square_to_cone(u, cos_max)).normalize();
        Emission {
            ray: Ray::new(self.position, direction),
            surface: None,
            power: self.intensity(textures, direction) / warp::square_to_cone_pdf(cos_max),
        }
    }
}
