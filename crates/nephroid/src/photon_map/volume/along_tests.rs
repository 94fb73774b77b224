//! Photons along rays against brute force and closed forms.

use super::testing::{KERNELS, clouds, map_of, photon_at};
use super::{VolumeMap, VolumePhoton};
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
