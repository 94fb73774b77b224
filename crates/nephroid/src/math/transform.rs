use super::real::{cos_deg, sin_deg};
use super::{DAffine3, DMat3, DVec3, Vec3};

/// An affine map, in double precision: transforms are composed while a scene is read and applied
/// once, when the world is built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform(pub DAffine3);

impl Transform {
    /// Leaves everything where it is.
    pub const IDENTITY: Self = Self(DAffine3::IDENTITY);

    /// Moves by an offset.
    pub fn translate(offset: DVec3) -> Self {
        Self(DAffine3::from_translation(offset))
    }

    /// Stretches each axis by a factor.
    pub fn scale(factors: DVec3) -> Self {
        Self(DAffine3::from_scale(factors))
    }

    /// Turns about an axis (any length but zero) by an angle; exact at multiples of a right angle
    /// about a coordinate axis (Rodrigues' formula).
    pub fn rotate(axis: DVec3, degrees: f64) -> Self {
        let a = axis / axis.length();
        let (sin, cos) = (sin_deg(degrees), cos_deg(degrees));
        let turn = |v: DVec3| v * cos + a.cross(v) * sin + a * (a.dot(v) * (1.0 - cos));
        Self(DAffine3::from_mat3(DMat3::from_cols(turn(DVec3::X), turn(DVec3::Y), turn(DVec3::Z))))
    }

    /// Camera space to world: `+z` looks from `origin` to `target`, `+x` points to the *left* of the
    /// picture and `+y` up, as Mitsuba has it. `None` if the directions are degenerate.
    pub fn look_at(origin: DVec3, target: DVec3, up: DVec3) -> Option<Self> {
        let forward = (target - origin).try_normalize()?;
        let left = up.cross(forward).try_normalize()?;
        let up = forward.cross(left);
        Some(Self(DAffine3::from_mat3_translation(DMat3::from_cols(left, up, forward), origin)))
    }

    /// First `self`, then `next`.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        Self(next.0 * self.0)
    }

    /// Whether it is finite and can be undone.
    pub fn is_invertible(&self) -> bool {
        let d = self.0.matrix3.determinant();
        self.0.is_finite() && d != 0.0 && d.is_finite() && self.0.inverse().is_finite()
    }

    /// The map back; meaningless unless [`Self::is_invertible`].
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self(self.0.inverse())
    }

    /// Whether it mirrors space (negative determinant).
    pub fn is_mirrored(&self) -> bool {
        self.0.matrix3.determinant() < 0.0
    }

    /// The one factor by which it scales lengths; `None` if it stretches or shears by more than a
    /// part in 10⁵.
    pub fn uniform_scale(&self) -> Option<f64> {
        let m = self.0.matrix3;
        let lengths = [m.x_axis.length(), m.y_axis.length(), m.z_axis.length()];
        let s = lengths[0];
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-5 * s;
        let orthogonal = m.x_axis.dot(m.y_axis).abs() <= 1e-5 * s * s
            && m.y_axis.dot(m.z_axis).abs() <= 1e-5 * s * s
            && m.z_axis.dot(m.x_axis).abs() <= 1e-5 * s * s;
        (close(lengths[1], s) && close(lengths[2], s) && orthogonal).then_some(s)
    }

    /// Maps a point.
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.0.transform_point3(p.as_dvec3()).as_vec3()
    }

    /// Maps a direction or edge, without normalising.
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.0.transform_vector3(v.as_dvec3()).as_vec3()
    }

    /// Maps a normal by the inverse transpose, to unit length; zero stays zero.
    pub fn normal(&self, n: Vec3) -> Vec3 {
        let m = self.0.matrix3.inverse().transpose();
        (m * n.as_dvec3()).normalize_or_zero().as_vec3()
    }
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        let t = Transform::rotate(DVec3::X, -90.0);
        assert_eq!(t.point(Vec3::Z), Vec3::Y);
        assert_eq!(t.point(Vec3::Y), -Vec3::Z);
    }

    #[test]
    fn composition_is_in_reading_order() {
        let t = Transform::scale(DVec3::splat(2.0)).then(Transform::translate(DVec3::X));
        assert_eq!(t.point(Vec3::ONE), Vec3::new(3.0, 2.0, 2.0));
        assert_eq!(t.uniform_scale(), Some(2.0));
        assert_eq!(Transform::scale(DVec3::new(1.0, 2.0, 1.0)).uniform_scale(), None);
    }

    #[test]
    fn normals_stay_perpendicular_under_a_stretch() {
        let t = Transform::scale(DVec3::new(3.0, 1.0, 1.0));
        let n = t.normal(Vec3::new(1.0, 1.0, 0.0).normalize());
        assert!(n.dot(t.vector(Vec3::new(1.0, -1.0, 0.0))).abs() < 1e-6);
    }

    #[test]
    fn look_at_faces_the_target() {
        let t = Transform::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, DVec3::Y).unwrap();
        assert_eq!(t.vector(Vec3::Z), -Vec3::Z);
        assert_eq!(t.vector(Vec3::X), -Vec3::X);
        assert_eq!(t.vector(Vec3::Y), Vec3::Y);
        assert!(Transform::look_at(DVec3::ZERO, DVec3::Y, DVec3::Y).is_none());
    }

    #[test]
    fn flat_and_infinite_transforms_are_not_invertible() {
        assert!(!Transform::scale(DVec3::new(1.0, 0.0, 1.0)).is_invertible());
        assert!(!Transform::scale(DVec3::new(1.0, f64::NAN, 1.0)).is_invertible());
        assert!(Transform::scale(DVec3::splat(1e-6)).is_invertible());
    }
}
