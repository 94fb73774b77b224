//! The caustics in a cup: the floor of an upright mirror cylinder of radius 1. Parallel light draws the
//! nephroid, light from the rim the cardioid.
//!
//! Seen from above, light that comes down at a slant moves in the plane as light in a circle does, and
//! how far it has come in the plane when it reaches the floor depends on where and how steeply it
//! started. All is counted for one reflection, to which the photons' depth is limited.
//!
//! All tests together reject a correct program with a probability of [`ALPHA`]; seeds are fixed.

use std::f64::consts::PI;

use nephroid::color::Rgb;
use nephroid::integrator::{Method, PhotonMapperConfig, Show};
use nephroid::light::LightKind;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_convergence::{Builder, epanechnikov, map_view, pixel_origins, renders};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// Pixels along the axis of symmetry, from x = −1 to 1.
const PIXELS: u32 = 64;
/// Two cups: each pixel of the inner [`TESTED`] by a fixed radius and their sum, and two stretches by neighbours.
const TESTS: usize = 2 * (1 + TESTED + 2);
const TESTED: usize = 44;
/// The fixed radius, in radii of the cup.
const RADIUS: f64 = 0.05;

fn level() -> f64 {
    sidak(ALPHA, TESTS)
}

const MIRROR: f64 = 0.9;
const ALBEDO: f64 = 0.5;

/// Where light lands on the floor, (x, z), and how many W per unit of its two parameters it brings there.
type Landing = ([f64; 2], f64);

/// A way of lighting the cup, which is 1 high.
struct Cup {
    light: LightKind,
    /// Where the caustic has its cusp on the x axis.
    cusp: f64,
    /// Light of the parameters (a, s) in [−π/2, π/2] × [0, 2], after one reflection.
    ray: fn(f64, f64) -> Option<Landing>,
    /// Irradiance on the x axis, by the Jacobian.
    on_axis: fn(f64) -> f64,
}

fn unit(angle: f64) -> [f64; 2] {
    [libm::cos(angle), libm::sin(angle)]
}

/// Parallel light of 1 W/m² at 45°, along (1, −1, 0)/√2. It meets the wall at the angle a, at the
/// height s, and goes s further in the plane, towards π + 2a. The wall's part da ds gets
/// sin 45° cos a da ds W. It is reflected again if its chord 2 cos a is shorter than s, there is no wall
/// above s = 1, and light did not come in if the wall behind, 2 cos a away and so much higher, was in
/// the way.
fn parallel_ray(a: f64, s: f64) -> Option<Landing> {
    let chord = 2.0 * libm::cos(a);
    let ([wx, wz], [dx, dz]) = (unit(a), unit(PI + 2.0 * a));
    (s < chord.min(1.0) && s + chord > 1.0)
        .then(|| ([wx + s * dx, wz + s * dz], MIRROR * 0.5f64.sqrt() * libm::cos(a)))
}

/// E = Σ cos 45° cos a / |cos a − 2s|, with a = 0 and s = 1 − x, and beyond the cusp also the pair
/// cos a = 1/2x, s = x.
fn parallel_on_axis(x: f64) -> f64 {
    let pair = if x > 0.5 { 2.0 / (4.0 * x * x - 1.0) } else { 0.0 };
    MIRROR * 0.5f64.sqrt() * (1.0 / (2.0 * x - 1.0).abs() + pair)
}

/// The height of the light over the rim's point (−1, 0): just clear of the wall.
const LAMP: f64 = 1.02;

/// Irradiance per unit length and angle at the distance l in the plane from a point light of 1 W/sr,
/// [`LAMP`] above the floor: l times that on the floor itself.
fn from_lamp(l: f64) -> f64 {
    let distance_sq = l * l + LAMP * LAMP;
    LAMP * l / (distance_sq * distance_sq.sqrt())
}

/// The lamp's cone, in degrees from its axis: wide enough for all light that comes to the pixels
/// tested.
const CUTOFF: f64 = 50.0;

fn lamp_axis() -> DVec3 {
    DVec3::new(1.0, -0.36, 0.0).normalize()
}

/// A point light of 1 W/sr at (−1, 0) sends light at the angle a, which meets the wall at 2a after
/// 2 cos a and goes s further, towards π + 3a.
fn lamp_ray(a: f64, s: f64) -> Option<Landing> {
    let chord = 2.0 * libm::cos(a);
    let ([ox, oz], [wx, wz], [dx, dz]) = (unit(a), unit(2.0 * a), unit(PI + 3.0 * a));
    let direction = DVec3::new((chord + s) * ox, -LAMP, (chord + s) * oz).normalize();
    let lit = direction.dot(lamp_axis()) > libm::cos(CUTOFF.to_radians());
    (lit && s < chord).then(|| ([wx + s * dx, wz + s * dz], MIRROR * from_lamp(chord + s)))
}

/// E = Σ [`from_lamp`] / |2 cos a − 3s|, with a = 0 and s = 1 − x, and beyond the cusp also the pair
/// sin² a = (3 − 1/x)/4, s = 2x cos a.
fn lamp_on_axis(x: f64) -> f64 {
    let mut sum = from_lamp(3.0 - x) / (3.0 * x - 1.0).abs();
    if x > 1.0 / 3.0 {
        let chord = 2.0 * (1.0 - (3.0 - 1.0 / x) / 4.0).sqrt();
        sum += 2.0 * from_lamp(chord * (1.0 + x)) / (chord * (3.0 * x - 1.0));
    }
    MIRROR * sum
}

fn nephroid() -> Cup {
    let light =
        LightKind::Directional { direction: Vec3::new(1.0, -1.0, 0.0).normalize(), irradiance: Rgb::WHITE };
    Cup { light, cusp: 0.5, ray: parallel_ray, on_axis: parallel_on_axis }
}

fn cardioid() -> Cup {
    let position = DVec3::new(-1.0, LAMP, 0.0);
    let light = LightKind::Spot {
        to_world: Transform::look_at(position, position + lamp_axis(), DVec3::Z).expect("not upwards"),
        intensity: Rgb::WHITE,
        cutoff_deg: CUTOFF as f32,
        beam_width_deg: CUTOFF as f32,
        texture: None,
    };
    Cup { light, cusp: 1.0 / 3.0, ray: lamp_ray, on_axis: lamp_on_axis }
}

fn scene(cup: &Cup) -> World {
    let mut b = Builder::parallel_view(Vec3::Y * 0.5, Vec3::ZERO, 1.0, PIXELS, 1);
    let (mirror, grey) = (b.mirror(MIRROR as f32), b.diffuse(ALBEDO as f32));
    let wall = Geometry::Cylinder { p0: Vec3::ZERO, p1: Vec3::Y, radius: 1.0 };
    b.shape(wall, Transform::IDENTITY, mirror).flip_normals = true;
    b.shape(Geometry::Disk, Transform::rotate(DVec3::X, -90.0), grey);
    b.light(cup.light.clone());
    b.build()
}

fn measure(world: &World, config: PhotonMapperConfig, seeds: std::ops::Range<u64>) -> Vec<Vec<f64>> {
    // Light, wall, floor, lens.
    let method = Method::PhotonMapper(PhotonMapperConfig { max_depth: Some(3), ..config });
    let mut pictures = renders(world, &method, 8, seeds);
    pictures.iter_mut().flatten().for_each(|l| *l *= PI / ALBEDO);
    // The picture may run against x.
    if pixel_origins(world)[0].x > 0.0 {
        pictures.iter_mut().for_each(|picture| picture.reverse());
    }
    pictures
}

/// The x of a pixel's middle.
fn middle(pixel: usize) -> f64 {
    (2 * pixel + 1) as f64 / f64::from(PIXELS) - 1.0
}

/// The expectation of each pixel under the kernel of radius [`RADIUS`], the mean over 4 by 4 points of
/// it: the sum over rays, wherever they meet one another. A fold of light is no singularity here.
fn expectation(cup: &Cup) -> Vec<f64> {
    const ANGLES: u32 = 2400;
    const LENGTHS: u32 = 1600;
    const SUB: u32 = 4;
    let step = 2.0 / f64::from(PIXELS * SUB);
    let mut sums = vec![0.0; (PIXELS * SUB) as usize];
    for i in 0..ANGLES {
        let a = ((f64::from(i) + 0.5) / f64::from(ANGLES) - 0.5) * PI;
        for j in 0..LENGTHS {
            let s = 2.0 * (f64::from(j) + 0.5) / f64::from(LENGTHS);
            let Some(([x, z], power)) = (cup.ray)(a, s).filter(|([_, z], _)| z.abs() < 2.0 * RADIUS) else {
                continue;
            };
            let first = ((x - RADIUS + 1.0) / step).max(0.0) as usize;
            let last = (((x + RADIUS + 1.0) / step) as usize + 1).min(sums.len());
            for (column, sum) in (first..last).zip(&mut sums[first.min(last)..last]) {
                let dx = (column as f64 + 0.5) * step - 1.0 - x;
                let rows = [-1.5, -0.5, 0.5, 1.5].map(|row| z - row * step);
                let kernel = rows.map(|dz| epanechnikov(dx * dx + dz * dz, RADIUS)).iter().sum::<f64>();
                *sum += power * kernel / 4.0;
            }
        }
    }
    let cell = PI / f64::from(ANGLES) * 2.0 / f64::from(LENGTHS);
    sums.chunks(SUB as usize).map(|c| c.iter().sum::<f64>() * cell / f64::from(SUB)).collect()
}

fn brightest(profile: &[f64]) -> f64 {
    let best = (0..profile.len()).max_by(|&a, &b| profile[a].total_cmp(&profile[b]));
    middle(best.expect("there are pixels"))
}

/// Every pixel against the expectation, up to the sum's coarseness; the brightest, which lies within
/// the kernel's radius of the cusp, inside the fold; and stretches away from the caustic against the
/// Jacobian.
///
/// `stretches` are on either side of the cusp. There k = 150 of the photons lie within r = .04 or so,
/// E ∝ 1/|x − cusp| is blurred by r²/6 |x − cusp|², and the allowance is twice that at .2: 1.5 %.
fn test_cup(cup: &Cup, paths: u64, stretches: [(f64, f64); 2]) {
    let world = scene(cup);
    let config = map_view(Show::Caustic, paths);
    let fixed = PhotonMapperConfig { radius: Some(RADIUS as f32), ..config.clone() };
    let pictures = measure(&world, fixed, 1..17);
    let exact = expectation(cup);
    let outer = (PIXELS as usize - TESTED) / 2;
    let sum: MeanTest = pictures.iter().map(|p| p[outer..outer + TESTED].iter().sum()).collect();
    sum.within(exact[outer..outer + TESTED].iter().sum(), 3e-3).assert_passes(level());
    for pixel in outer..outer + TESTED {
        let test: MeanTest = pictures.iter().map(|p| p[pixel]).collect();
        test.within(exact[pixel], 3e-3).assert_passes(level());
    }
    let means: Vec<f64> =
        (0..exact.len()).map(|i| pictures.iter().map(|p| p[i]).sum::<f64>() / 16.0).collect();
    assert!((brightest(&means) - cup.cusp).abs() < RADIUS + 1.0 / f64::from(PIXELS));

    let pictures = measure(&world, PhotonMapperConfig { neighbours: 150, ..config }, 21..37);
    for (from, to) in stretches {
        let pixels: Vec<usize> = (0..exact.len()).filter(|&i| (from..to).contains(&middle(i))).collect();
        let of: f64 = pixels.iter().map(|&i| (cup.on_axis)(middle(i))).sum();
        let test: MeanTest =
            pictures.iter().map(|p| pixels.iter().map(|&i| p[i]).sum::<f64>() / of).collect();
        test.within(1.0, 0.015).assert_passes(level());
    }
}

/// Parallel light: the cusp is half a radius from the centre.
#[test]
fn parallel_light_draws_the_nephroid() {
    test_cup(&nephroid(), 200_000, [(0.1, 0.3), (0.65, 0.8)]);
}

/// Light on the rim: the cusp is a third of a radius from the centre, on the side away from the light.
#[test]
fn light_on_the_rim_draws_the_cardioid() {
    test_cup(&cardioid(), 200_000, [(-0.1, 0.15), (0.5, 0.65)]);
}
