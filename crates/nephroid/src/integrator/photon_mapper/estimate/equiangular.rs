use crate::math::{Ray, Vec3, real};

/// Distances along a part of a ray by equal angles, seen from a point (Kulla and Fajardo 2012,
/// doi 10.1111/j.1467-8659.2012.03148.x).
pub(super) struct Equiangular {
    /// Where the ray is nearest to the point.
    nearest: f32,
    distance: f32,
    angles: [f32; 2],
}

impl Equiangular {
    /// Between two distances, of which the farther may be infinite.
    pub fn new(ray: &Ray, from: f32, to: f32, point: Vec3) -> Self {
        let to_point = point - ray.origin;
        let nearest = to_point.dot(ray.direction);
        // A point on the ray is taken for one beside it, by what rounding leaves of its place.
        let distance = (to_point - ray.direction * nearest).length().max(1e-4 * to_point.length());
        let angle = |t: f32| real::atan2(t - nearest, distance);
        let angles = [angle(from), if to.is_finite() { angle(to) } else { 0.5 * std::f32::consts::PI }];
        Self { nearest, distance, angles }
    }

    pub fn sample(&self, u: f32) -> f32 {
        let [a, b] = self.angles;
        self.nearest + self.distance * real::tan(a + (b - a) * u)
    }

    /// Density per length.
    pub fn pdf(&self, t: f32) -> f32 {
        let [a, b] = self.angles;
        let from_nearest = t - self.nearest;
        self.distance / ((b - a) * (self.distance * self.distance + from_nearest * from_nearest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The density is the derivative of the angle, so samples at even numbers have even shares of it; and it has
    /// the integral one.
    #[test]
    fn distances_have_their_density() {
        let ray = Ray::new(Vec3::new(0.3, -1.0, 0.0), Vec3::new(0.6, 0.8, 0.0));
        for (from, to, point) in [
            (0.0, 3.0, Vec3::new(1.0, 1.0, 0.5)),
            (1.0, 1.5, Vec3::ZERO),
            (0.0, f32::INFINITY, Vec3::new(-4.0, 0.0, 1.0)),
        ] {
            let around = Equiangular::new(&ray, from, to, point);
            let n = 4000;
            let at = |i: usize| around.sample(i as f32 / n as f32);
            for i in 0..n - 40 {
                let (a, b) = (f64::from(at(i)), f64::from(at(i + 1)));
                let share = f64::from(around.pdf(at(i)) + around.pdf(at(i + 1))) * 0.5 * (b - a);
                assert!((share * n as f64 - 1.0).abs() < 0.02, "{share} of step {i}");
            }
            assert!((at(0) - from).abs() < 1e-4);
        }
    }
}
