use std::f32::consts::{FRAC_PI_2, PI};

use crate::math::real::{atan2, cos, sin};
use crate::math::{Bounds, Vec3, warp};

/// Where the light of some lamps starts, where to, and how strong it is (Conty Estevez and Kulla 2018, *Importance Sampling of
/// Many Lights with Adaptive Tree Splitting*, doi 10.1145/3233305).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub bounds: Bounds,
    pub cone: NormalCone,
    /// The largest intensity, of those of several lamps the sum, in W/sr, as the mean of the channels.
    pub strength: f32,
}

/// A cone around all normals, and how far from its normal anything shines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NormalCone {
    pub axis: Vec3,
    /// Half-angle that the normals fill, θ_o.
    pub normals: f32,
    /// How far beyond them there is light, θ_e.
    pub beyond: f32,
}

impl NormalCone {
    /// Of a lamp that shines into all directions.
    pub const SPHERE: Self = Self { axis: Vec3::Z, normals: PI, beyond: FRAC_PI_2 };

    /// Of a surface that shines on the side of its normal.
    pub fn of_surface(normal: Vec3) -> Self {
        Self { axis: normal, normals: 0.0, beyond: FRAC_PI_2 }
    }

    /// Of a point that shines evenly within an angle and nowhere else.
    pub fn of_beam(axis: Vec3, angle: f32) -> Self {
        Self { axis, normals: angle, beyond: 0.0 }
    }

    /// A small cone around both.
    pub fn union(self, other: Self) -> Self {
        let (wide, narrow) = if self.normals >= other.normals { (self, other) } else { (other, self) };
        let beyond = wide.beyond.max(narrow.beyond);
        let between = atan2(wide.axis.cross(narrow.axis).length(), wide.axis.dot(narrow.axis));
        if (between + narrow.normals).min(PI) <= wide.normals {
            return Self { beyond, ..wide };
        }
        let normals = 0.5 * (wide.normals + between + narrow.normals);
        let across = (narrow.axis - wide.axis * wide.axis.dot(narrow.axis)).try_normalize();
        let Some(across) = across.filter(|_| normals < PI) else {
            return Self { axis: wide.axis, normals: PI, beyond };
        };
        let turn = normals - wide.normals;
        Self { axis: (wide.axis * cos(turn) + across * sin(turn)).normalize(), normals, beyond }
    }

    /// The solid angle that it shines into, each direction counted by the cosine beyond the normals: the paper's M_Ω.
    pub fn measure(&self) -> f32 {
        let (o, w) = (self.normals, (self.normals + self.beyond).min(PI));
        let within = 2.0 * PI * warp::one_minus_cos(o);
        within + FRAC_PI_2 * (2.0 * w * sin(o) - cos(o - 2.0 * w) - 2.0 * o * sin(o) + cos(o))
    }
}

impl Extent {
    /// Of a lamp by its power in W, the mean of the channels.
    pub fn new(bounds: Bounds, cone: NormalCone, power: f32) -> Self {
        Self { bounds, cone, strength: power / cone.measure() }
    }

    /// Of a lamp without extent.
    pub fn of_point(position: Vec3, cone: NormalCone, power: f32) -> Self {
        Self::new(Bounds::of([position]), cone, power)
    }

    pub fn union(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            cone: self.cone.union(other.cone),
            strength: self.strength + other.strength,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;
    use nephroid_testkit::Pcg32;

    #[test]
    fn unions_hold_both() {
        let mut rng = Pcg32::new(2);
        for i in 0..20_000 {
            let mut cone = || NormalCone {
                axis: warp::square_to_sphere(Vec2::from_array(rng.vec2_f32())),
                normals: rng.next_f32() * if i % 2 == 0 { 0.3 } else { PI },
                beyond: rng.next_f32() * FRAC_PI_2,
            };
            let (a, b) = (cone(), cone());
            let both = a.union(b);
            for part in [a, b] {
                assert!(both.beyond >= part.beyond);
                // The direction of the part farthest from the middle of both.
                let between = atan2(both.axis.cross(part.axis).length(), both.axis.dot(part.axis));
                let farthest = (between + part.normals).min(PI);
                assert!(farthest <= both.normals + 1e-3, "{a:?} {b:?} {both:?}");
            }
        }
    }

    #[test]
    fn a_surface_counts_for_its_cosine() {
        assert!((NormalCone::of_surface(Vec3::X).measure() - PI).abs() < 1e-5);
        assert!((NormalCone::SPHERE.measure() - 4.0 * PI).abs() < 1e-4);
        assert!(NormalCone::of_beam(Vec3::X, 0.0).measure().abs() < 1e-6);
    }
}
