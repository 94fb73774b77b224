//! The mistakes of the report's section 2.4, for pictures of what they do. Nothing else uses them.

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
