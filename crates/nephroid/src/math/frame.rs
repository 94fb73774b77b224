use super::Vec3;

/// An orthonormal basis around a unit normal: local directions have `z` along the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First tangent.
    pub s: Vec3,
    /// Second tangent.
    pub t: Vec3,
    /// The normal.
    pub n: Vec3,
}

impl Frame {
    /// The frame of a unit normal, with tangents of no particular orientation.
    #[inline]
    pub fn from_normal(n: Vec3) -> Self {
        let (s, t) = orthonormal_pair(n);
        Self { s, t, n }
    }

    /// The frame of a unit normal whose first tangent is as near to a direction as can be; `None` if that is along
    /// the normal or has no length.
    #[inline]
    pub fn along(n: Vec3, direction: Vec3) -> Option<Self> {
        let direction = direction.try_normalize()?;
        let across = direction - n * n.dot(direction);
        // Rounding alone leaves as much of what is along the normal.
        let s = across.try_normalize().filter(|_| across.length_squared() > 1e-10)?;
        // Once more, for what little there was may not be square.
        let s = (s - n * n.dot(s)).normalize();
        Some(Self { s, t: n.cross(s), n })
    }

    /// Turned the shortest way until the normal is `n`, which must not be opposite to it.
    #[must_use]
    pub fn turned_to(&self, n: Vec3) -> Self {
        let (cos, axis) = (self.n.dot(n), self.n.cross(n));
        // Rodrigues' rotation, with the sine in the length of the axis.
        let turn = |v: Vec3| v * cos + axis.cross(v) + axis * (axis.dot(v) / (1.0 + cos));
        Self { s: turn(self.s), t: turn(self.t), n }
    }

    /// World direction to local.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// Local direction to world.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

/// Two unit vectors that form a right-handed basis with the unit vector `n`, without a branch on
/// its direction (Duff et al. 2017, *Building an Orthonormal Basis, Revisited*, JCGT 6(1), listing 3).
#[inline]
pub fn orthonormal_pair(n: Vec3) -> (Vec3, Vec3) {
    let sign = 1.0f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Vec2, warp};

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for i in 0..1000 {
            let u = Vec2::new((i as f32 * 0.618_034).fract(), i as f32 / 1000.0);
            let n = warp::square_to_sphere(u);
            let f = Frame::from_normal(n);
            assert!(f.s.dot(f.t).abs() < 1e-6 && f.s.dot(n).abs() < 1e-6);
            assert!((f.s.cross(f.t) - n).length() < 1e-6);
            let v = Vec3::new(0.3, -0.5, 0.8);
            assert!((f.to_local(f.to_world(v)) - v).length() < 1e-6);
        }
    }

    #[test]
    fn a_frame_along_a_direction_is_one() {
        for i in 1..1000 {
            let u = |k: f32| Vec2::new((i as f32 * k).fract(), i as f32 / 1000.0);
            let (n, d) = (warp::square_to_sphere(u(0.618_034)), warp::square_to_sphere(u(0.37)));
            for d in [d * 1e-12, d * 1e12, n + 1e-4 * n.any_orthonormal_vector()] {
                let f = Frame::along(n, d).expect("not along the normal");
                assert!(f.s.dot(f.t).abs() < 1e-6 && f.s.dot(n).abs() < 1e-6 && f.s.dot(d) > 0.0);
                assert!((f.s.cross(f.t) - n).length() < 1e-6);
            }
            assert!(Frame::along(n, n * 3.0).is_none() && Frame::along(n, Vec3::ZERO).is_none());
        }
    }

    #[test]
    fn a_turned_frame_stays_one_and_turns_no_more_than_its_normal() {
        for i in 0..200 {
            let n = |k: f32| warp::square_to_sphere(Vec2::new((k * 0.618_034).fract(), (k * 0.37).fract()));
            let (a, b) = (n(i as f32), (n(i as f32) + 0.3 * n(i as f32 + 0.5)).normalize());
            let (from, to) = (Frame::from_normal(a), Frame::from_normal(a).turned_to(b));
            assert!(to.s.dot(to.t).abs() < 1e-6 && (to.s.cross(to.t) - b).length() < 1e-6);
            assert!(from.s.dot(to.s) >= a.dot(b) - 1e-6, "the shortest way");
        }
    }
}
