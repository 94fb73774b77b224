//! Densities at points against brute force and closed forms.

use std::f32::consts::PI;

use nephroid_testkit::{ALPHA, sidak, z_test};

use super::testing::{KERNELS, clouds, map_of, mean_and_deviation, photon_at};
use super::{VolumeMap, VolumePhoton, VolumeQuery};
use crate::math::real::pow;
use crate::math::{Bounds, Vec3};
use crate::photon_map::testing::Rng;
use crate::photon_map::{Bandwidth, Gathered, Kernel, NearestList};

fn at(position: Vec3) -> VolumeQuery {
    VolumeQuery { position, medium: 0, max_photon_depth: None }
}

/// The sum of power times weight, and what the search did.
fn density(
    map: &VolumeMap,
    query: &VolumeQuery,
    kernel: Kernel,
    bandwidth: Bandwidth,
    neighbors: &mut NearestList,
) -> (f32, Gathered) {
    let mut sum = 0.0;
    let gathered = map.at(query, kernel, bandwidth, neighbors, |photon, w| sum += photon.power.r * w);
    (sum, gathered)
}

/// Sorts all photons. Also gives the weight that each would have in the middle.
fn brute_force(map: &VolumeMap, center: Vec3, kernel: Kernel, bandwidth: Bandwidth) -> Vec<(f32, f32)> {
    let mut all: Vec<f32> =
        (0..map.len() as u32).map(|i| map.photon(i).position.distance_squared(center)).collect();
    all.sort_by(f32::total_cmp);
    let (k, radius) = match bandwidth {
        Bandwidth::Fixed { radius } => (usize::MAX, radius),
        Bandwidth::Nearest { k, max_radius } => (k as usize, max_radius),
        Bandwidth::Part { .. } => panic!("a part has a test of its own"),
    };
    all.retain(|d_sq| *d_sq <= radius * radius);
    let mut radius_sq = radius * radius;
    if k < usize::MAX && all.len().min(k) >= 3 && all[all.len().min(k) - 1] > 0.0 {
        all.truncate(k);
        radius_sq = all.pop().unwrap_or(radius_sq);
    }
    all.into_iter().map(|d| (kernel.weight_3d(d, radius_sq), kernel.weight_3d(0.0, radius_sq))).collect()
}

#[test]
fn points_find_what_brute_force_finds() {
    let mut rng = Rng::new(3);
    let mut neighbors = NearestList::new();
    // Where there are gaps the search ends before them: they have a test of their own.
    let even = ["outlier", "clusters", "thin"];
    for (name, points) in clouds().into_iter().filter(|(name, _)| !even.iter().any(|e| name.contains(e))) {
        let map = map_of(points.iter().map(|p| photon_at(*p)).collect(), 20);
        let bounds = if points.is_empty() { Bounds::of([Vec3::ZERO]) } else { map.bounds() };
        let size = bounds.extent().length().max(f32::MIN_POSITIVE);
        for i in 0..60 {
            let center = bounds.min + rng.point() * bounds.extent();
            let kernel = KERNELS[i % 5];
            let bandwidth = match i % 3 {
                0 => Bandwidth::Fixed { radius: 0.1 * size },
                1 => Bandwidth::Nearest { k: 20, max_radius: 0.2 * size },
                _ => Bandwidth::Nearest { k: 300, max_radius: 0.1 * size },
            };
            let mut ours = Vec::new();
            map.at(&at(center), kernel, bandwidth, &mut neighbors, |_, w| ours.push(w));
            ours.sort_by(|a, b| b.total_cmp(a));
            let mut expected = brute_force(&map, center, kernel, bandwidth);
            expected.sort_by(|a, b| b.0.total_cmp(&a.0));
            let shown = format!("{name} {center} {kernel} {bandwidth:?}");
            if expected.first().is_some_and(|(_, most)| !most.is_finite()) {
                assert!(ours.is_empty(), "{shown}");
                continue;
            }
            assert_eq!(ours.len(), expected.len(), "{shown}");
            for (ours, (expected, most)) in ours.iter().zip(&expected) {
                assert!((ours - expected).abs() <= 2e-6 * most, "{shown}: {ours} {expected}");
            }
        }
    }
}

/// Points at which the unit cube is asked, far enough from each other and from its sides.
const SIDE: usize = 4;

/// Means over the queries of maps of uniform photons, whose true density is one, for each estimator; and
/// the deviations of these means. Queries of one map may be correlated, so deviations are taken between maps.
fn means(seed: u64, maps: usize, n: usize, estimators: &[&Estimator]) -> Vec<(f64, f64)> {
    let mut rng = Rng::new(seed);
    let mut neighbors = NearestList::new();
    let mut values = vec![Vec::new(); estimators.len()];
    for _ in 0..maps {
        let map = map_of((0..n).map(|_| photon_at(rng.point())).collect(), 20);
        for (values, estimator) in values.iter_mut().zip(estimators) {
            let coordinate = |i: usize| 0.3 + 0.4 * (i % SIDE) as f32 / (SIDE - 1) as f32;
            let point = |i| Vec3::new(coordinate(i), coordinate(i / SIDE), coordinate(i / SIDE / SIDE));
            let one = |i| f64::from(estimator(&map, point(i), &mut neighbors));
            values.push((0..SIDE.pow(3)).map(one).sum::<f64>() / SIDE.pow(3) as f64);
        }
    }
    values.iter().map(|values| mean_and_deviation(values)).collect()
}

/// A density at a point.
type Estimator = dyn Fn(&VolumeMap, Vec3, &mut NearestList) -> f32;

/// 20 means, of which the right ones fail together with a probability of `ALPHA`.
#[test]
fn every_kernel_reproduces_a_uniform_density() {
    let n = 4000;
    let radius_of = |count: f32| pow(count / (n as f32 * 4.0 / 3.0 * PI), 1.0 / 3.0);
    let bandwidths = [
        Bandwidth::Nearest { k: 10, max_radius: 0.3 },
        Bandwidth::Nearest { k: 40, max_radius: 0.3 },
        // Stops half of the searches.
        Bandwidth::Nearest { k: 10, max_radius: radius_of(9.5) },
        Bandwidth::Fixed { radius: radius_of(30.0) },
    ];
    let all: Vec<_> = bandwidths.iter().flat_map(|b| KERNELS.map(|kernel| (kernel, *b))).collect();
    let estimators: Vec<_> = all
        .iter()
        .map(|&(kernel, bandwidth)| {
            move |map: &VolumeMap, p: Vec3, neighbors: &mut NearestList| {
                density(map, &at(p), kernel, bandwidth, neighbors).0
            }
        })
        .collect();
    let estimators: Vec<&Estimator> = estimators.iter().map(|e| e as _).collect();
    for (what, (mean, deviation)) in all.iter().zip(means(4, 150, n, &estimators)) {
        assert!(deviation < 0.006, "too few samples: {deviation}");
        let outcome = z_test(mean, 1.0, deviation);
        assert!(outcome.passes(sidak(ALPHA, 20)), "{what:?}: {outcome}");
    }
}

#[test]
fn counting_the_photon_that_sets_the_radius_is_found_out() {
    let all_k = |map: &VolumeMap, p: Vec3, neighbors: &mut NearestList| {
        let mut count = 0.0;
        let nearest = Bandwidth::Nearest { k: 10, max_radius: 1.0 };
        let gathered = map.at(&at(p), Kernel::Box, nearest, neighbors, |photon, _| count += photon.power.r);
        let last = 1.0 / map.emitted() as f32;
        (count + last) * Kernel::Box.weight_3d(0.0, gathered.radius * gathered.radius)
    };
    let (mean, deviation) = means(5, 150, 4000, &[&all_k])[0];
    assert!(
        (mean - 10.0 / 9.0).abs() < 4.0 * deviation && mean > 1.0 + 10.0 * deviation,
        "{mean} ± {deviation}"
    );
}

#[test]
fn photons_too_deep_or_of_other_media_neither_count_nor_shrink_the_radius() {
    let mut rng = Rng::new(6);
    let photons: Vec<_> = (0..4000u16)
        .map(|i| VolumePhoton { depth: 1 + i % 3, medium: i / 3 % 2, ..photon_at(rng.point()) })
        .collect();
    let wanted: Vec<_> = photons.iter().copied().filter(|p| p.depth <= 2 && p.medium == 1).collect();
    // A power of two, so that powers are kept exactly.
    let build = |photons| VolumeMap::build(super::VolumePhotons::new(4096, photons), 20);
    let (all, wanted) = (build(photons), build(wanted));
    let mut neighbors = NearestList::new();
    let plain = VolumeQuery { medium: 1, ..at(Vec3::splat(0.5)) };
    let limited = VolumeQuery { max_photon_depth: Some(2), ..plain };
    for bandwidth in [Bandwidth::Nearest { k: 30, max_radius: 1.0 }, Bandwidth::Fixed { radius: 0.2 }] {
        let mut ask = |map: &VolumeMap, query: &VolumeQuery| {
            density(map, query, Kernel::Gaussian, bandwidth, &mut neighbors)
        };
        let (expected, gathered) = ask(&wanted, &plain);
        let (sum, found) = ask(&all, &limited);
        assert!(gathered == found && (sum - expected).abs() < 1e-4 * expected, "{sum} {expected}");
        assert!(ask(&all, &plain).1 != gathered);
        for nothing in
            [VolumeQuery { max_photon_depth: Some(0), ..plain }, VolumeQuery { medium: 2, ..plain }]
        {
            assert_eq!((ask(&all, &nothing).0, ask(&all, &nothing).1.count), (0.0, 0));
        }
    }
}

#[test]
fn another_part_of_the_medium_beyond_a_gap_does_not_thin_the_density() {
    let mut rng = Rng::new(7);
    let near = (0..30).map(|_| photon_at(rng.point()));
    let photons: Vec<_> = near.chain((0..100).map(|i| photon_at(Vec3::X * (5.0 + i as f32)))).collect();
    let map = map_of(photons, 20);
    let nearest = Bandwidth::Nearest { k: 60, max_radius: 50.0 };
    let (_, gathered) = density(&map, &at(Vec3::splat(0.5)), Kernel::Box, nearest, &mut NearestList::new());
    assert!(gathered.count == 29 && gathered.radius < 1.0, "{gathered:?}");
}

#[test]
fn estimates_stay_finite_in_odd_places() {
    let beam = map_of(vec![photon_at(Vec3::ZERO); 128], 20);
    let nothing = map_of(vec![], 20);
    let mut neighbors = NearestList::new();
    let mut ask = |map, b, kernel| density(map, &at(Vec3::ZERO), kernel, b, &mut neighbors);
    let (sum, gathered) = ask(&beam, Bandwidth::Nearest { k: 50, max_radius: 2.0 }, Kernel::Box);
    assert_eq!(gathered, Gathered { radius: 2.0, count: 128 });
    assert!((sum * 8.0 * 4.0 / 3.0 * PI - 1.0).abs() < 1e-5, "{sum}");
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-30, 1e30, 1.0] {
        for k in [0, 2, 50, u32::MAX] {
            for kernel in KERNELS {
                for b in [Bandwidth::Fixed { radius }, Bandwidth::Nearest { k, max_radius: radius }] {
                    let (sum, _) = ask(&beam, b, kernel);
                    assert!(sum >= 0.0 && sum.is_finite(), "{b:?} {kernel}: {sum}");
                    assert_eq!(ask(&nothing, b, kernel).0, 0.0);
                }
            }
        }
    }
}
