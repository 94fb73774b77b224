//! The report's mistakes, for pictures and numbers of what they do. Nothing else uses them.

use nephroid::math::{Vec2, Vec3};

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wrong_directions_are_of_one_side() {
        for i in 0..100 {
            let u = Vec2::new((i as f32 + 0.5) / 100.0, (7 * i % 100) as f32 / 100.0);
            let w = latitude_from_the_pole(u);
            assert!(w.z >= 0.0 && (w.length() - 1.0).abs() < 1e-6, "{w}");
        }
    }
}
