//! Light that is smooth and curved, so that blur shows, and known at each pixel.

use std::f64::consts::PI;

use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::medium::Phase;
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_testkit::{Tolerance, integrate};

use crate::{Builder, blurred, grey_fog, pixel_origins};

/// The mean over each pixel of a function of the place on the film's plane, by a rule of 3 × 3 points of Gauss.
pub fn over_pixels(world: &World, width: f64, value: impl Fn(DVec3) -> f64) -> Vec<f64> {
    const POINTS: [(f64, f64); 3] =
        [(-0.774_596_669_241_483_4, 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.774_596_669_241_483_4, 5.0 / 18.0)];
    let to_world = world.scene().camera.to_world;
    let [right, up] = [DVec3::X, DVec3::Y].map(|axis| to_world.0.transform_vector3(axis).normalize());
    let at = |origin: &DVec3| {
        let mut sum = 0.0;
        for (x, wx) in POINTS {
            for (y, wy) in POINTS {
                sum += wx * wy * value(*origin + 0.5 * width * (x * right + y * up));
            }
        }
        sum
    };
    pixel_origins(world).iter().map(at).collect()
}

impl Builder {
    /// A white floor y = 0 from −`half` to `half`.
    pub fn white_floor(&mut self, half: f64) {
        let white = self.diffuse(1.0);
        let to_world = Transform::scale(DVec3::splat(half)).then(Transform::rotate(DVec3::X, -90.0));
        self.shape(Geometry::Rectangle, to_world, white);
    }
}

/// A white floor under a point light a unit above, seen over |x|, |z| ≤ `half`, and the irradiance of each pixel under a
/// kernel of radius `blur`. It is (1 + r²)^(−3/2): blurred by .4 it is 8 % too dark in the middle.
pub fn under_a_light(side: u32, half: f64) -> (World, impl Fn(f64) -> Vec<f64>) {
    let mut b = Builder::parallel_view(Vec3::new(0.0, 0.5, 0.0), Vec3::ZERO, half, side, side);
    b.white_floor(3.0);
    b.point_light(Vec3::Y, 1.0);
    let world = b.build();
    let again = world.clone();
    let irradiance = |x: f64, z: f64| libm::pow(1.0 + x * x + z * z, -1.5);
    let exact = move |blur: f64| {
        let at = |p: DVec3| match blur {
            0.0 => irradiance(p.x, p.z),
            r => blurred(irradiance, p.x, p.z, r),
        };
        over_pixels(&again, 2.0 * half / f64::from(side), at)
    };
    (world, exact)
}

/// Fog around a point light, of which a part beside the light is seen by parallel rays, and the radiance of each pixel
/// by light that was scattered once.
pub fn beside_a_light(side: u32) -> (World, Vec<f64>) {
    const MIDDLE: f64 = 0.8;
    const HALF: f64 = 0.3;
    const REACH: f64 = 3.0;
    const SIGMA: f64 = 0.5;
    const ALBEDO: f64 = 0.8;
    let from = Vec3::new(MIDDLE as f32, 0.0, REACH as f32 + 0.5);
    let mut b = Builder::parallel_view(from, from.with_z(0.0), HALF, side, side);
    b.point_light(Vec3::ZERO, 1.0);
    let fog = b.medium(grey_fog(SIGMA as f32, ALBEDO as f32, Phase::Isotropic));
    let ball = Geometry::Sphere { center: Vec3::ZERO, radius: REACH as f32 };
    b.filled(ball, Transform::IDENTITY, fog);
    let world = b.build();
    let exact = over_pixels(&world, 2.0 * HALF / f64::from(side), |p| {
        let b_sq = p.x * p.x + p.y * p.y;
        let half = (REACH * REACH - b_sq).sqrt();
        let at = |z: f64| {
            let d_sq = b_sq + z * z;
            ALBEDO * SIGMA / (4.0 * PI) * libm::exp(-SIGMA * (half - z + d_sq.sqrt())) / d_sq
        };
        integrate(at, &[-half, -0.5, 0.0, 0.5, half], Tolerance::relative(1e-7)).value
    });
    (world, exact)
}
