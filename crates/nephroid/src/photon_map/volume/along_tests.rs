//! Photons along rays against brute force and closed forms.

use nephroid_testkit::{ALPHA, sidak, z_test};

use super::testing::{KERNELS, clouds, map_of, mean_and_deviation, photon_at};
use super::{VolumeMap, VolumePhoton, VolumePhotons};
use crate::bvh::Simd;
use crate::math::{Bounds, Ray, Vec2, Vec3, warp};
use crate::photon_map::testing::Rng;
use crate::photon_map::{Kernel, PhotonIndex};

/// Distance, photon and weight.
type Call = (f32, VolumePhoton, f32);

fn calls(map: &VolumeMap, simd: Simd, ray: &Ray, t_max: f32, kernel: Kernel) -> Vec<Call> {
    let mut calls = Vec::new();
    map.along_by(simd, ray, t_max, 0, kernel, |t, photon, weight| calls.push((t, *photon, weight)));
    calls
}

/// Looks at every photon. Also gives the weight that each would have on the ray, for its rounding is in proportion
/// to that.
fn brute_force(map: &VolumeMap, ray: &Ray, t_max: f32, kernel: Kernel) -> Vec<(Call, f32)> {
    let Some(cloud) = map.cloud(0) else { return Vec::new() };
    let one = |place: u32| {
        let radius = cloud.radii.of_block(place as usize / 8);
        let v = cloud.index.position(place) - ray.origin;
        let t = v.x * ray.direction.x + v.y * ray.direction.y + v.z * ray.direction.z;
        let w = v - ray.direction * t;
        let dist_sq = w.x * w.x + w.y * w.y + w.z * w.z;
        let passes = radius > 0.0 && 0.0 < t && t < t_max && dist_sq <= radius * radius;
        let weight = |dist_sq| kernel.weight_2d(dist_sq, radius * radius);
        passes.then(|| ((t, cloud.photon(place), weight(dist_sq)), weight(0.0)))
    };
    (0..cloud.index.len() as u32).filter_map(one).collect()
}

/// Rays past, through and from the middle of a cloud, along axes, and straight through some of its photons.
fn rays(points: &[Vec3]) -> Vec<(Ray, f32)> {
    let mut rng = Rng::new(2);
    let bounds =
        if points.is_empty() { Bounds::of([Vec3::ZERO]) } else { Bounds::of(points.iter().copied()) };
    let size = bounds.extent().length().max(f32::MIN_POSITIVE);
    let mut rays = Vec::new();
    for i in 0..60 {
        let direction = match i % 6 {
            0 => Vec3::X,
            1 => -Vec3::Y,
            2 => Vec3::splat(1.0).normalize(),
            _ => warp::square_to_sphere(Vec2::new(rng.next(), rng.next())),
        };
        let through = match points {
            [] => Vec3::ZERO,
            _ if i % 2 == 0 => points[i * 31 % points.len()],
            _ => bounds.min + rng.point() * bounds.extent(),
        };
        let before = [0.0, 0.1, 3.0, 1000.0][i / 6 % 4] * size;
        let t_max = [f32::INFINITY, before + 0.2 * size, before][i % 3];
        rays.push((Ray::new(through - direction * before, direction), t_max));
    }
    rays
}

#[test]
fn rays_find_what_brute_force_finds_in_order_and_bits() {
    let mut found = 0;
    for (name, points) in clouds() {
        for k in [2, 20] {
            let map = map_of(points.iter().map(|p| photon_at(*p)).collect(), k);
            for (i, (ray, t_max)) in rays(&points).into_iter().enumerate() {
                let kernel = KERNELS[i % 5];
                let expected = brute_force(&map, &ray, t_max, kernel);
                let ours = calls(&map, Simd::detect(), &ray, t_max, kernel);
                assert_eq!(ours.len(), expected.len(), "{name} {i}");
                for (ours, (expected, most)) in ours.iter().zip(&expected) {
                    assert_eq!((ours.0, ours.1), (expected.0, expected.1), "{name}");
                    assert!((ours.2 - expected.2).abs() <= 1e-6 * most, "{name} {ours:?} {expected:?}");
                }
                assert_eq!(calls(&map, Simd::Portable, &ray, t_max, kernel), ours, "{name}");
                found += ours.len();
            }
        }
    }
    assert!(found > 20_000, "{found}");
}

/// The sum of power times weight.
fn flux(map: &VolumeMap, ray: &Ray, t_max: f32, kernel: Kernel) -> f64 {
    let mut sum = 0.0;
    map.along(ray, t_max, 0, kernel, |_, photon, weight| sum += f64::from(photon.power.r * weight));
    sum
}

/// A map of uniform photons has the density 1 W/m³, so a ray of length t in it passes t W/m². Rays start
/// in the inner half of the cube, in any direction, and the deviation is taken between maps, as rays of one
/// may be correlated. All five means together fail with a probability of `ALPHA`.
#[test]
fn rays_in_uniform_light_pass_photons_in_proportion_to_their_length() {
    const LENGTH: f32 = 0.2;
    let mut rng = Rng::new(5);
    let mut values = KERNELS.map(|_| Vec::new());
    for _ in 0..60 {
        let map = map_of((0..4000).map(|_| photon_at(rng.point())).collect(), 12);
        let mut ray = || {
            let direction = warp::square_to_sphere(Vec2::new(rng.next(), rng.next()));
            Ray::new(Vec3::splat(0.35) + 0.3 * rng.point(), direction)
        };
        let rays: Vec<Ray> = (0..40).map(|_| ray()).collect();
        for (values, kernel) in values.iter_mut().zip(KERNELS) {
            let sum: f64 = rays.iter().map(|ray| flux(&map, ray, LENGTH, kernel)).sum();
            values.push(sum / rays.len() as f64 / f64::from(LENGTH));
        }
    }
    for (values, kernel) in values.iter().zip(KERNELS) {
        let (mean, deviation) = mean_and_deviation(values);
        assert!(deviation < 0.01, "too few samples: {deviation}");
        let outcome = z_test(mean, 1.0, deviation);
        assert!(outcome.passes(sidak(ALPHA, 5)), "{kernel}: {outcome}");
    }
}

/// Parallel rays on a grid that covers all: each photon's kernel integrates to one over it, whatever its radius.
/// No chance enters; the grid has 50 rays to a radius, which for the box, whose rim is the sharpest, is
/// off by some 10⁻⁴ for each of 60 photons.
#[test]
fn parallel_rays_together_see_the_power_of_all_photons() {
    let mut rng = Rng::new(6);
    // Half of them a hundred times as dense.
    let photons: Vec<_> =
        (0..60).map(|i| photon_at(rng.point() * if i % 2 == 0 { 1.0 } else { 0.2 })).collect();
    let map = map_of(photons, 10);
    let direction = Vec3::new(1.0, -2.0, 0.5).normalize();
    let (s, t) = direction.any_orthonormal_pair();
    let (center, size) = map.bounds().bounding_sphere();
    let reach = size + map.default_max_radius(10);
    let least =
        (0..8).map(|block| map.cloud(0).expect("a cloud").radii.of_block(block)).fold(reach, f32::min);
    let n = (50.0 * 2.0 * reach / least).ceil().min(700.0) as usize;
    for kernel in KERNELS {
        let mut sum = 0.0;
        for i in 0..n * n {
            let offset = |i: usize| ((i as f32 + 0.5) / n as f32 * 2.0 - 1.0) * reach;
            let origin = center + s * offset(i % n) + t * offset(i / n) - direction * 2.0 * reach;
            sum += flux(&map, &Ray::new(origin, direction), f32::INFINITY, kernel);
        }
        let spacing = 2.0 * f64::from(reach) / n as f64;
        let total: f64 = (0..60).map(|i| f64::from(map.photon(i).power.r)).sum();
        let seen = sum * spacing * spacing / total;
        assert!((seen - 1.0).abs() < 1e-3, "{kernel}: {seen}");
    }
}

#[test]
fn a_ray_ends_at_its_own_end_and_ignores_other_media() {
    let mut rng = Rng::new(7);
    let photons: Vec<_> = (0..2048)
        .map(|i| VolumePhoton { medium: 7 * (i % 2), light: i as u32, ..photon_at(rng.point()) })
        .collect();
    let both = map_of(photons.clone(), 20);
    let ray = Ray::new(Vec3::new(-1.0, 0.4, 0.5), Vec3::X);
    let mut found = 0;
    for medium in [0, 7] {
        let own: Vec<_> = photons.iter().copied().filter(|p| p.medium == medium).collect();
        let alone = VolumeMap::build(VolumePhotons::new(2048, own), 20);
        let calls = |map: &VolumeMap, ray: &Ray, t_max| {
            let mut calls = Vec::new();
            map.along(ray, t_max, medium, Kernel::Box, |t, p, w| {
                calls.push((t, p.position, p.light, p.medium, w));
            });
            calls
        };
        let expected = calls(&alone, &ray, 1.5);
        assert_eq!(calls(&both, &ray, 1.5), expected);
        assert_eq!(calls(&both, &Ray { t_max: 1.5, ..ray }, f32::INFINITY), expected);
        assert!(expected.iter().all(|call| call.3 == medium && call.0 < 1.5));
        found += expected.len();
    }
    assert!(found > 50, "{found}");
    map_of(photons, 20).along(&ray, 9.0, 3, Kernel::Box, |_, _, _| panic!("no such medium"));
}

#[test]
fn rays_that_are_none_find_nothing() {
    let map = map_of((0..100).map(|i| photon_at(Vec3::splat(i as f32))).collect(), 9);
    let nan = Vec3::splat(f32::NAN);
    for (origin, direction, t_max) in [
        (nan, Vec3::X, 1.0),
        (Vec3::ZERO, nan, 1.0),
        (Vec3::ZERO, Vec3::X, 0.0),
        (Vec3::ZERO, Vec3::X, -1.0),
        (Vec3::INFINITY, Vec3::X, 1.0),
    ] {
        assert_eq!(flux(&map, &Ray::new(origin, direction), t_max, Kernel::Box), 0.0);
    }
}
