//! The report's mistakes, for pictures and numbers of what they do. Nothing else uses them.

use nephroid::math::{Ray, Vec2, Vec3};
use nephroid::scene::Scene;

/// A latitude, which [`square_to_sphere`](nephroid::math::warp::square_to_sphere) would count from the equator, taken for an
/// angle from the pole. All directions are on one side, most of them near the pole; of a lamp's surroundings the half is
/// dark.
///
/// The report does not say what its mistake of section 2.4 was, but that it was "when creating the ray from the angles":
/// this is the nearest such mistake that leaves a part of the scene without photons.
pub fn latitude_from_the_pole(u: Vec2) -> Vec3 {
    let latitude = libm::asin(2.0 * f64::from(u.x) - 1.0);
    let longitude = std::f64::consts::TAU * f64::from(u.y);
    let across = libm::sin(latitude);
    let (x, y) = (across * libm::cos(longitude), across * libm::sin(longitude));
    Vec3::new(x as f32, y as f32, libm::cos(latitude) as f32)
}

/// Equation 2.2 of the report with photons of 1 W: all of the nearest `k`, the one that sets the radius with them, over the
/// disc. Takes squared distances in m², of `k` photons or more, and gives W/m².
pub fn density_of_all(mut distances_sq: Vec<f64>, k: usize) -> f64 {
    distances_sq.sort_by(f64::total_cmp);
    k as f64 / (std::f64::consts::PI * distances_sq[k - 1])
}

/// Photons without the 4π of a point light's sphere carry this part of their power (Fig 2.10).
pub const WITHOUT_SPHERE: f32 = std::f32::consts::FRAC_1_PI / 4.0;

/// The cosine of direct light left out (Fig 2.11).
pub fn no_cosine(_: f32) -> f32 {
    1.0
}

/// Where a ray first meets a sphere, in single precision and with nothing done against rounding (Fig 2.13): a ray that
/// starts on the sphere may meet it again where it starts.
pub fn meets_sphere(ray: &Ray, center: Vec3, radius: f32) -> Option<f32> {
    let from = ray.origin - center;
    let b = from.dot(ray.direction);
    let root = b * b - (from.length_squared() - radius * radius);
    if root < 0.0 {
        return None;
    }
    let root = root.sqrt();
    [-b - root, -b + root].into_iter().find(|&t| t > 0.0)
}

/// The name of the sphere that is filled with fog.
pub const GLASS: &str = "glass sphere";

/// The scene of Fig 3.9 with the fog inside the glass, too.
pub fn fog_in_glass(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for shape in scene.shapes.iter_mut().filter(|shape| shape.name == GLASS) {
        shape.boundary.interior = shape.boundary.exterior;
    }
    scene
}

/// The distance at which a photon interacts that is asked at steps of one length only, at each with the chance that it would
/// have interacted on the way there (Fig 3.8). `None` if it does not before `end`.
pub fn distance_by_steps(sigma_t: f64, step: f64, end: f64, mut next: impl FnMut() -> f64) -> Option<f64> {
    let chance = -libm::expm1(-sigma_t * step);
    (1..).map(|i| f64::from(i) * step).take_while(|&d| d < end).find(|_| next() < chance)
}

/// Whether a photon interacts within a depth if the report's two sentences are both followed: its distance is drawn from
/// the exponential law, and then it interacts there with the probability 1 − e^(−τ) of having done so.
pub fn interacts_twice(depth: f64, u: [f64; 2]) -> bool {
    let drawn = -libm::log1p(-u[0]);
    drawn < depth && u[1] < -libm::expm1(-drawn)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_a_sphere_before_them() {
        let ray = Ray::new(Vec3::new(0.0, 0.0, -3.0), Vec3::Z);
        assert_eq!(meets_sphere(&ray, Vec3::ZERO, 1.0), Some(2.0));
        assert_eq!(meets_sphere(&Ray::new(Vec3::ZERO, Vec3::Z), Vec3::ZERO, 1.0), Some(1.0));
        assert_eq!(meets_sphere(&Ray::new(Vec3::new(0.0, 0.0, 3.0), Vec3::Z), Vec3::ZERO, 1.0), None);
        assert_eq!(meets_sphere(&Ray::new(Vec3::new(2.0, 0.0, -3.0), Vec3::Z), Vec3::ZERO, 1.0), None);
    }

    #[test]
    fn steps_are_multiples_of_one_length() {
        let mut tried = [0.9, 0.9, 0.1].into_iter();
        let d = distance_by_steps(1.0, 0.5, 9.0, || tried.next().unwrap());
        assert_eq!(d, Some(1.5));
        assert_eq!(distance_by_steps(1.0, 0.5, 0.4, || 0.0), None);
    }

    #[test]
    fn the_wrong_directions_are_of_one_side() {
        for i in 0..100 {
            let u = Vec2::new((i as f32 + 0.5) / 100.0, (7 * i % 100) as f32 / 100.0);
            let w = latitude_from_the_pole(u);
            assert!(w.z >= 0.0 && (w.length() - 1.0).abs() < 1e-6, "{w}");
        }
    }
}
