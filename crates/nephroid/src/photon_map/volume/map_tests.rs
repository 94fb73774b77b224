//! What the map keeps, what it takes, and its radii.

use super::testing::{clouds, map_of, photon_at};
use super::{VolumeMap, VolumePhoton, VolumePhotons};
use crate::color::Rgb;
use crate::math::real::pow;
use crate::math::{Ray, Vec3};
use crate::photon_map::testing::Rng;
use crate::photon_map::{Kernel, PhotonIndex};

fn cube(n: usize, size: f32) -> Vec<VolumePhoton> {
    let mut rng = Rng::new(1);
    (0..n).map(|_| photon_at(rng.point() * size)).collect()
}

#[test]
fn photons_are_kept_and_divided_by_the_paths_emitted() {
    let mut photons = VolumePhotons::new(5, cube(500, 1.0));
    photons.append(VolumePhotons::new(3, cube(500, 1.0)));
    assert_eq!((photons.emitted(), photons.stored()), (8, 1000));
    let numbered = |(i, p): (usize, &VolumePhoton)| VolumePhoton {
        light: i as u32,
        depth: (i / 3) as u16,
        medium: [4, 0, 9][i % 3],
        power: Rgb { r: (i % 256) as f32, g: 128.0, b: 0.0 },
        wi: if i % 2 == 0 { Vec3::X } else { -Vec3::Y },
        ..*p
    };
    let given: Vec<_> = photons.as_slice().iter().enumerate().map(numbered).collect();
    let map = VolumeMap::build(VolumePhotons::new(8, given.clone()), 20);
    assert_eq!((map.len(), map.emitted(), map.is_empty()), (1000, 8, false));
    let mut kept: Vec<_> = (0..1000).map(|place| map.photon(place)).collect();
    kept.sort_by_key(|p| p.light);
    for (kept, given) in kept.iter().zip(&given) {
        assert_eq!(*kept, VolumePhoton { power: given.power * 0.125, ..*given });
        assert!(map.bounds().union(crate::math::Bounds::of([kept.position])) == map.bounds());
    }
}

#[test]
fn memory_is_less_than_thirty_bytes_a_photon_and_has_a_bound_for_any_cloud() {
    let even = map_of(cube(100_000, 1.0), 50).memory_bytes() as f32 / 1e5;
    assert!((24.0..30.0).contains(&even), "{even}");
    for (name, points) in clouds().into_iter().filter(|(_, points)| points.len() > 250) {
        let map = map_of(points.iter().map(|p| photon_at(*p)).collect(), 20);
        let each = map.memory_bytes() as f32 / points.len() as f32;
        assert!(each <= 40.0, "{name}: {each}");
    }
}

#[test]
fn the_map_does_not_depend_on_the_number_of_threads() {
    let mut rng = Rng::new(2);
    let photons: Vec<_> = (0..40_000)
        .map(|i| VolumePhoton { medium: i % 5 / 4, ..photon_at((rng.point() * 60.0).floor()) })
        .collect();
    let built = [1, 2, 7].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| map_of(photons.clone(), 30))
    });
    assert!(built[0] == built[1] && built[0] == built[2]);
}

#[test]
fn a_ball_holds_about_k_photons() {
    let map = map_of(cube(20_000, 1.0), 50);
    let cloud = map.cloud(0).expect("a cloud");
    let (mut sum, mut n) = (0, 0);
    for place in (0..20_000).step_by(7) {
        let p = cloud.index.position(place);
        if (p - 0.5).abs().max_element() < 0.35 {
            let radius = cloud.radii.of_block(place as usize / 8);
            cloud.index.for_each_within(p, radius * radius, |_, _| sum += 1);
            n += 1;
        }
    }
    let mean = f64::from(sum) / f64::from(n);
    assert!((47.0..57.0).contains(&mean), "{mean}");
}

#[test]
fn the_largest_radius_follows_the_photons_and_the_scale() {
    let map = map_of(cube(20_000, 1.0), 50);
    let exact = 2.0 * pow(50.0f32 / 20_000.0 * 0.75 * std::f32::consts::FRAC_1_PI, 1.0 / 3.0);
    let largest = map.default_max_radius(50);
    // Near the sides balls are larger, as half of them is empty.
    assert!((1.0..1.15).contains(&(largest / exact)), "{largest} {exact}");
    for scale in [1.0 / 1024.0, 1_048_576.0] {
        assert_eq!(map_of(cube(20_000, scale), 50).default_max_radius(50), largest * scale);
    }
    assert_eq!(map.default_max_radius_in(0, 50), largest);
    assert_eq!(map.default_max_radius_in(1, 50), 0.0);
    assert_eq!(map_of(vec![], 50).default_max_radius(50), 0.0);
    assert_eq!(map_of(vec![photon_at(Vec3::ONE); 100], 50).default_max_radius(50), 0.0);
}

#[test]
fn a_stray_photon_has_no_huge_ball() {
    let stray = (0..40).map(|i| photon_at(Vec3::splat(100.0 * (i + 1) as f32)));
    let map = map_of(cube(4000, 1.0).into_iter().chain(stray).collect(), 50);
    let largest = map.default_max_radius(50);
    assert!(largest < 1.0, "{largest}");
    let radii = &map.cloud(0).expect("a cloud").radii;
    assert!((0..map.len() / 8).all(|block| radii.of_block(block) <= largest));
}

#[test]
fn scaling_by_a_power_of_two_scales_the_weights_exactly() {
    let at_scale = |scale: f32| {
        let map = map_of(cube(3000, scale), 20);
        let direction = Vec3::new(0.3, 0.5, 0.8).normalize();
        let ray = Ray::new(Vec3::splat(-0.1 * scale), direction);
        let mut calls = Vec::new();
        map.along(&ray, scale, 0, Kernel::Biweight, |t, p, w| {
            calls.push((t / scale, p.position / scale, w * scale * scale));
        });
        calls
    };
    let expected = at_scale(1.0);
    assert!(expected.len() > 20);
    assert!(at_scale(1.0 / 4096.0) == expected && at_scale(65_536.0) == expected);
}
