use std::f32::consts::PI;

use super::aim::{Cones, Targets, overlaps};
use super::emitter::{Emission, EmissionNumbers};
use super::extent::NormalCone;
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::real::{atan2, cos, sin, tan};
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
        // Not from the cosine, which tells narrow angles apart no better than .02°.
        let angle = atan2(Vec2::new(local.x, local.y).length(), local.z);
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

    /// The directions that it shines into.
    pub fn beam(&self) -> NormalCone {
        NormalCone::of_beam(self.frame.n, self.cutoff)
    }

    /// The part of a ray up to `end` inside the cone, whose points p have (p − a)·n ≥ |p − a| cos θ: a quadratic in
    /// the distance. `None` if there is none.
    pub fn lit_part(&self, ray: &Ray, end: f32) -> Option<[f32; 2]> {
        let (d, n) = (ray.direction.as_dvec3(), self.frame.n.as_dvec3());
        let v = (ray.origin - self.position).as_dvec3();
        let cos_sq = libm::cos(f64::from(self.cutoff)).powi(2);
        let (dn, vn) = (d.dot(n), v.dot(n));
        let (a, b) = (dn * dn - cos_sq, vn * dn - cos_sq * v.dot(d));
        let c = vn * vn - cos_sq * v.length_squared();
        let root = (b * b - a * c).max(0.0).sqrt();
        let (low, high) = (((-b - root) / a).min((-b + root) / a), ((-b - root) / a).max((-b + root) / a));
        let [from, to] = match a {
            // Along the cone, forward or back.
            a if a > 0.0 && dn > 0.0 => [high, f64::INFINITY],
            a if a > 0.0 => [f64::NEG_INFINITY, low],
            // Across it, or across its image behind the light.
            _ if b * b <= a * c || vn + 0.5 * (low + high) * dn <= 0.0 => return None,
            _ => [low, high],
        };
        // As wide as rounding may have made it too narrow.
        let margin = 1e-5 * (v.length() + from.abs().min(to.abs()));
        let (from, to) = ((from - margin).max(0.0) as f32, (to + margin).min(f64::from(end)) as f32);
        // Near the cone's own slope nothing can be said: all of it, then.
        if a.abs() < 1e-9 || from.is_nan() || to.is_nan() {
            return Some([0.0, end]);
        }
        (from < to).then_some([from, to])
    }

    /// W: the integral of the intensity, exact up to the texture, of which the mean counts.
    ///
    /// The linear edge from b to c counts 1 − (sin c − sin b)/(c − b) = 1 − cos m · sin(h)/h with the
    /// mean m and half the difference h, here without the loss of digits to 1 − ….
    pub fn power(&self, textures: &Textures) -> Rgb {
        let (c, b) = (self.cutoff, self.beam_width);
        let (mean, half) = (0.5 * (c + b), 0.5 * (c - b));
        // The series of 1 − sin(h)/h where its terms cancel.
        let flattened =
            if half > 0.1 { 1.0 - sin(half) / half } else { half * half / 6.0 * (1.0 - half * half / 20.0) };
        let drop = warp::one_minus_cos(mean);
        let tint = self.texture.map_or(Rgb::WHITE, |t| textures.mean(t));
        self.peak * tint * (2.0 * PI * (drop + (1.0 - drop) * flattened))
    }

    /// Uniform over the solid angle of the cone, or over those of the targets that it overlaps if they
    /// are less than half of it; `whole` is the power of the light.
    pub fn emit(
        &self,
        textures: &Textures,
        u: EmissionNumbers,
        targets: Option<&Targets>,
        whole: Rgb,
    ) -> Emission {
        let width = warp::one_minus_cos(self.cutoff);
        let Some(cones) = targets.and_then(|targets| self.cones(targets, PI * width)) else {
            let direction = self.frame.to_world(warp::square_to_cone(u.direction, width)).normalize();
            let power = self.intensity(textures, direction) / warp::square_to_cone_pdf(width);
            return Emission::whole(Ray::new(self.position, direction), None, power);
        };
        cones.emit(self.position, u, whole, |direction| self.intensity(textures, direction))
    }

    /// The targets that overlap the cone, unless they fill more than `limit`.
    fn cones(&self, targets: &Targets, limit: f32) -> Option<Cones> {
        let overlaps = overlaps(&self.frame, sin(self.cutoff), cos(self.cutoff));
        Cones::seen_from(targets, (self.position, 0.0), None, limit, overlaps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;
    use crate::sampling::{Key, Sampler, Sequence, Stream};

    fn numbers(direction: Vec2) -> EmissionNumbers {
        EmissionNumbers { position: Vec2::ZERO, direction, target: 0.0 }
    }

    /// The power of a cone of small angle θ is π θ² and of one that fades all the way a third of it;
    /// the mean over emitted light is the same.
    #[test]
    fn narrow_cones_have_their_power() {
        let textures = Textures::default();
        let askew = Transform::rotate(DVec3::new(1.0, 2.0, 3.0), 40.0);
        for cutoff_deg in [1e-3f32, 1e-2, 0.1, 1.0] {
            let theta = f64::from(cutoff_deg.to_radians());
            for (beam_width_deg, share) in [(cutoff_deg, 1.0), (0.0, 1.0 / 3.0)] {
                let spot = Spot::new(&askew, Rgb::WHITE, cutoff_deg, beam_width_deg, None);
                let exact = std::f64::consts::PI * theta * theta * share;
                assert!((f64::from(spot.power(&textures).g) / exact - 1.0).abs() < 1e-4);
                let n = 64u16;
                let grid = (0..n * n).map(|i| Vec2::new(f32::from(i / n), f32::from(i % n)) + 0.5);
                let sum: f64 = grid
                    .map(|u| spot.emit(&textures, numbers(u / f32::from(n)), None, Rgb::BLACK))
                    .map(|emission| f64::from(emission.power.g))
                    .sum();
                let mean = sum / f64::from(n * n);
                assert!((mean / exact - 1.0).abs() < 0.01, "{cutoff_deg}: {mean} of {exact}");
            }
        }
    }

    /// Along rays anywhere, the points that light falls on lie in the part, and about all of the part is lit.
    #[test]
    fn the_lit_part_of_a_ray_is_what_lies_in_the_cone() {
        let askew = Transform::rotate(DVec3::new(1.0, 2.0, 3.0), 40.0);
        let textures = Textures::default();
        for (cutoff, rays) in [(3.0, 4000u64), (30.0, 1000), (80.0, 1000)] {
            let spot = Spot::new(&askew, Rgb::WHITE, cutoff, cutoff, None);
            let mut lit = 0;
            for i in 0..rays {
                let mut s = Sampler::new(Sequence::Independent, Key::new(7, 0, Stream::Pilot), i);
                let ray = Ray::new(
                    warp::square_to_sphere(s.next_2d()) * (4.0 * s.next_1d()),
                    warp::square_to_sphere(s.next_2d()),
                );
                let end = if i % 3 == 0 { f32::INFINITY } else { 5.0 };
                let part = spot.lit_part(&ray, end);
                for k in 0..500 {
                    let t = (k as f32 + s.next_1d()) * 0.01;
                    let to_point = ray.at(t) - spot.position;
                    let is_lit = !spot.intensity(&textures, to_point.normalize()).is_black();
                    let inside = part.is_some_and(|[from, to]| (from..=to).contains(&t));
                    lit += u32::from(is_lit);
                    assert!(inside || !is_lit, "{part:?} lacks {t} of {ray:?}");
                    let near_end = part.is_some_and(|[a, b]| (t - a).abs().min((t - b).abs()) < 2e-3);
                    assert!(is_lit || !inside || near_end, "{part:?} has {t} of {ray:?}");
                }
            }
            assert!(lit > 500, "{lit} points at {cutoff}");
        }
    }

    /// Against the closed form as it is usually written, where that is precise.
    #[test]
    fn wide_cones_have_their_power() {
        for (c, b) in [(89.0f32, 89.0f32), (60.0, 20.0), (30.0, 29.0), (20.0, 0.0)] {
            let spot = Spot::new(&Transform::IDENTITY, Rgb::WHITE, c, b, None);
            let (c, b) = (f64::from(c).to_radians(), f64::from(b).to_radians());
            let fade = if c > b { (libm::sin(c) - libm::sin(b)) / (c - b) } else { libm::cos(c) };
            let exact = 2.0 * std::f64::consts::PI * (1.0 - fade);
            assert!((f64::from(spot.power(&Textures::default()).g) / exact - 1.0).abs() < 1e-5);
        }
    }
}
