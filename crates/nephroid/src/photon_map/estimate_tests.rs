//! Estimates where the answer is known.

use std::f32::consts::PI;

use super::testing::{Rng, photon_at};
use super::{
    Bandwidth, BruteForce, Gathered, Kernel, NearestList, Photon, PhotonIndex, PhotonMap, Photons, Query,
    gather, gather_both,
};
use crate::color::Rgb;
use crate::math::{Vec2, Vec3, warp};

/// The cone is the one at whose rim the k-th photon would still weigh something.
const KERNELS: [Kernel; 5] =
    [Kernel::Box, Kernel::Cone { k: 1.1 }, Kernel::Gaussian, Kernel::Epanechnikov, Kernel::Biweight];

/// Queries to a side of the unit square.
const SIDE: usize = 16;

fn up(position: Vec3) -> Query {
    Query { position, normal: Vec3::Z, max_photon_depth: None }
}

/// Irradiance and what the gather did.
fn irradiance(map: &PhotonMap, query: &Query, kernel: Kernel, bandwidth: Bandwidth) -> (f32, Gathered) {
    let mut sum = Rgb::BLACK;
    let mut scratch = NearestList::new();
    let add = |photon: &Photon, weight| sum += photon.power * weight;
    let gathered = gather(map, query, kernel, bandwidth, &mut scratch, add);
    (sum.r, gathered)
}

/// One watt in `n` photons, uniform on the unit square, seen from above.
fn uniform_square(n: usize, rng: &mut Rng) -> PhotonMap {
    let photons = (0..n).map(|_| photon_at(Vec3::new(rng.next(), rng.next(), 0.0), Vec3::Z)).collect();
    PhotonMap::build(Photons::new(n as u64, photons))
}

/// Points of the unit square as far as possible from its edges and from each other.
fn grid() -> impl Iterator<Item = Vec3> {
    let coordinate = |i: usize| (i as f32 + 0.5) / SIDE as f32;
    (0..SIDE * SIDE).map(move |i| Vec3::new(coordinate(i % SIDE), coordinate(i / SIDE), 0.0))
}

/// Mean of an estimator over the queries of `maps` independent maps of `n` photons, and the mean's
/// standard deviation, both relative to the true irradiance 1. Queries of one map may be correlated:
/// the deviation is taken between maps.
fn mean_and_deviation(values_of_maps: &[f64]) -> (f64, f64) {
    let n = values_of_maps.len() as f64;
    let mean = values_of_maps.iter().sum::<f64>() / n;
    let variance = values_of_maps.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Whether a mean is 1 within 0.3 %. Four standard deviations must fit into that, so a right
/// estimator fails with a probability below 6.4e-5, one in 16 000, for each seed.
fn is_right((mean, deviation): (f64, f64)) -> bool {
    assert!(4.0 * deviation <= 0.003, "too few samples: deviation {deviation}");
    (mean - 1.0).abs() <= 0.003
}

/// Irradiance at a point from above.
type Estimator = dyn Fn(&PhotonMap, Vec3, &mut NearestList) -> f32;

/// Runs estimators on the same maps; returns the mean and its deviation for each.
fn run(seed: u64, maps: usize, photons_per_query: usize, estimators: &[&Estimator]) -> Vec<(f64, f64)> {
    let mut rng = Rng::new(seed);
    let mut values = vec![Vec::new(); estimators.len()];
    let mut scratch = NearestList::new();
    for _ in 0..maps {
        let map = uniform_square(photons_per_query * SIDE * SIDE, &mut rng);
        for (values, estimator) in values.iter_mut().zip(estimators) {
            let total: f64 = grid().map(|p| f64::from(estimator(&map, p, &mut scratch))).sum();
            values.push(total / (SIDE * SIDE) as f64);
        }
    }
    values.iter().map(|v| mean_and_deviation(v)).collect()
}

fn assert_uniform_irradiance(
    seed: u64,
    maps: usize,
    photons_per_query: usize,
    kernels: &[Kernel],
    bandwidths: &[Bandwidth],
) {
    for &bandwidth in bandwidths {
        let estimators = kernels.iter().map(|&kernel| {
            move |map: &PhotonMap, p: Vec3, scratch: &mut NearestList| {
                let mut sum = 0.0;
                gather(map, &up(p), kernel, bandwidth, scratch, |photon, w| sum += photon.power.r * w);
                sum
            }
        });
        let estimators: Vec<_> = estimators.collect();
        let estimators: Vec<&Estimator> = estimators.iter().map(|e| e as _).collect();
        for (kernel, result) in kernels.iter().zip(run(seed, maps, photons_per_query, &estimators)) {
            assert!(is_right(result), "{kernel}, {bandwidth:?}: {result:?}");
        }
    }
}

/// The radius of a disc with that many photons on average.
fn radius_of(count: f32, photons_per_query: usize) -> f32 {
    (count / (PI * (photons_per_query * SIDE * SIDE) as f32)).sqrt()
}

// The checks below, 18 at 1 in 16 000, would fail by chance for one choice of seeds in 900. The
// nearest 10 take the most samples, as their relative variance is 1/8 for the box and .23 for the
// biweight; they are left to the kernels most unlike each other.

#[test]
fn the_nearest_10_reproduce_uniform_irradiance() {
    let nearest = Bandwidth::Nearest { k: 10, max_radius: 1.0 };
    assert_uniform_irradiance(10, 1700, 30, &[KERNELS[0], KERNELS[1], KERNELS[4]], &[nearest]);
}

#[test]
fn a_largest_radius_that_stops_half_the_searches_changes_no_mean() {
    let nearest = Bandwidth::Nearest { k: 10, max_radius: radius_of(9.5, 30) };
    assert_uniform_irradiance(11, 1700, 30, &[KERNELS[0], KERNELS[1], KERNELS[4]], &[nearest]);
}

#[test]
fn the_nearest_50_and_a_fixed_radius_reproduce_uniform_irradiance() {
    let nearest = Bandwidth::Nearest { k: 50, max_radius: 1.0 };
    let fixed = Bandwidth::Fixed { radius: radius_of(50.0, 100) };
    assert_uniform_irradiance(50, 270, 100, &KERNELS, &[nearest, fixed]);
}

#[test]
fn counting_the_photon_that_sets_the_radius_is_found_out() {
    let all_k = |k: usize| {
        move |map: &PhotonMap, p: Vec3, scratch: &mut NearestList| {
            map.index().nearest(p, 1.0, k, |_, d| Some(d), scratch);
            let r_sq = scratch.get(k - 1).unwrap().dist_sq;
            scratch.iter().map(|n| map.photon(n.place).power.r * Kernel::Box.weight_2d(n.dist_sq, r_sq)).sum()
        }
    };
    for (k, maps, photons_per_query) in [(10, 1000, 30), (50, 180, 100)] {
        let result = run(12, maps, photons_per_query, &[&all_k(k)])[0];
        assert!(!is_right(result), "k = {k}: {result:?}");
        let expected = k as f64 / (k as f64 - 1.0);
        assert!((result.0 - expected).abs() < 0.003, "k = {k}: {result:?}");
    }
}

#[test]
fn a_sphere_in_uniform_light_looks_uniform_at_large_radii() {
    // 20 maps of 20 000 photons on the unit sphere, r = .44: 968 photons a query, deviation of the
    // mean over all .032/√20 = .7 % from one query a map, less from 20 that overlap little; 1.5 %
    // is over 4σ of .35 %. A disc in the tangent plane would give +5.4 %.
    let mut rng = Rng::new(20);
    let n = 20_000;
    let mut values = Vec::new();
    for _ in 0..20 {
        let mut on_sphere = || warp::square_to_sphere(Vec2::new(rng.next(), rng.next()));
        let photons: Vec<_> = (0..n).map(|_| on_sphere()).map(|p| photon_at(p, p)).collect();
        let map = PhotonMap::build(Photons::new(n, photons));
        let total: f64 = (0..20)
            .map(|_| {
                let p = on_sphere();
                let query = Query { position: p, normal: p, max_photon_depth: None };
                f64::from(irradiance(&map, &query, Kernel::Box, Bandwidth::Fixed { radius: 0.44 }).0)
            })
            .sum();
        values.push(total / 20.0 * 4.0 * std::f64::consts::PI);
    }
    let (mean, deviation) = mean_and_deviation(&values);
    assert!(4.0 * deviation < 0.015 && (mean - 1.0).abs() < 0.015, "{mean} ± {deviation}");
}

/// More neighbours than the part of the sphere has that looks the query's way: the search runs into
/// the end of the cap of 26°, and the radius must be the cap's and not the largest allowed, which
/// would make the sphere eight times too dark. Photons spread over a cap that ends at r count n − 1 in
/// πr² but for what the chord of the last one falls short of the cap: 1 % is allowed for that and the
/// noise, whose deviation is 0.2 % for 20 maps of 2000 photons and 300 queries.
#[test]
fn a_small_sphere_with_fewer_photons_than_neighbours_is_not_dark() {
    let mut rng = Rng::new(14);
    let (mut sum, mut n) = (0.0, 0.0);
    for _ in 0..20 {
        let photons: Vec<_> = (0..2000)
            .map(|_| warp::square_to_sphere(Vec2::new(rng.next(), rng.next())))
            .map(|p| photon_at(p, p))
            .collect();
        let map = PhotonMap::build(Photons::new(2000, photons));
        for _ in 0..300 {
            let p = warp::square_to_sphere(Vec2::new(rng.next(), rng.next()));
            let query = Query { position: p, normal: p, max_photon_depth: None };
            let bandwidth = Bandwidth::Nearest { k: 500, max_radius: 1.3 };
            sum += f64::from(irradiance(&map, &query, Kernel::Box, bandwidth).0);
            n += 1.0;
        }
    }
    let mean = sum / n * 4.0 * std::f64::consts::PI;
    assert!((mean - 1.0).abs() < 0.01, "{mean}");
}

#[test]
fn photons_of_other_surfaces_neither_count_nor_shrink_the_radius() {
    let mut rng = Rng::new(30);
    let mut layer = |normal: Vec3, place: fn(Vec3) -> Vec3| -> Vec<_> {
        (0..2000).map(|_| photon_at(place(rng.point()), normal)).collect()
    };
    let alone = layer(Vec3::Z, |p| p.with_z(0.0));
    let others = [
        ("the other side", layer(-Vec3::Z, |p| p.with_z(0.0))),
        ("a wall in the corner", layer(Vec3::X, |p| p.with_x(0.5))),
        ("a slope", layer(Vec3::new(0.5, 0.0, 0.75f32.sqrt()), |p| p.with_z(0.0))),
        ("a shelf above", layer(Vec3::Z, |p| p.with_z(0.05))),
    ];
    let query = up(Vec3::new(0.5, 0.5, 0.0));
    for bandwidth in [Bandwidth::Nearest { k: 50, max_radius: 0.4 }, Bandwidth::Fixed { radius: 0.1 }] {
        let map_of = |photons| PhotonMap::build(Photons::new(2000, photons));
        let expected = irradiance(&map_of(alone.clone()), &query, Kernel::Epanechnikov, bandwidth);
        assert!((expected.0 - 1.0).abs() < 0.5);
        for (what, other) in &others {
            let map = map_of([alone.as_slice(), other].concat());
            let (e, gathered) = irradiance(&map, &query, Kernel::Epanechnikov, bandwidth);
            assert_eq!(gathered, expected.1, "{what}");
            assert!((e - expected.0).abs() < 1e-5, "{what}");
        }
    }
}

#[test]
fn photons_too_deep_neither_count_nor_shrink_the_radius() {
    let mut rng = Rng::new(31);
    let photons: Vec<_> = (0..3000u16)
        .map(|i| Photon { depth: 1 + i % 3, ..photon_at(rng.point().with_z(0.0), Vec3::Z) })
        .collect();
    let shallow = photons.iter().copied().filter(|p| p.depth <= 2).collect();
    let all: PhotonMap = PhotonMap::build(Photons::new(1, photons));
    let shallow: PhotonMap = PhotonMap::build(Photons::new(1, shallow));
    let query = up(Vec3::new(0.5, 0.5, 0.0));
    let limited = Query { max_photon_depth: Some(2), ..query };
    let bandwidth = Bandwidth::Nearest { k: 40, max_radius: 1.0 };
    let expected = irradiance(&shallow, &query, Kernel::Gaussian, bandwidth);
    assert_eq!(irradiance(&all, &limited, Kernel::Gaussian, bandwidth), expected);
    assert!(irradiance(&all, &query, Kernel::Gaussian, bandwidth).1.radius < expected.1.radius);
    let none = Query { max_photon_depth: Some(0), ..query };
    assert_eq!(
        irradiance(&all, &none, Kernel::Gaussian, bandwidth),
        (0.0, Gathered { radius: 1.0, count: 0 })
    );
}

#[test]
fn scaling_a_scene_by_a_power_of_two_scales_the_estimate_exactly() {
    let mut rng = Rng::new(32);
    let photons: Vec<_> = (0..5000).map(|_| photon_at(rng.point().with_z(0.25), Vec3::Z)).collect();
    let at_scale = |scale: f32, bandwidth| {
        let scaled = photons.iter().map(|p| Photon { position: p.position * scale, ..*p }).collect();
        let query = up(Vec3::new(0.5, 0.5, 0.25) * scale);
        let (e, gathered) =
            irradiance(&PhotonMap::build(Photons::new(1, scaled)), &query, Kernel::Biweight, bandwidth);
        (e * scale * scale, gathered.radius / scale, gathered.count)
    };
    for scale in [1.0 / 1024.0, 1_048_576.0] {
        let fixed = |scale: f32| Bandwidth::Fixed { radius: 0.1 * scale };
        let nearest = |scale: f32| Bandwidth::Nearest { k: 50, max_radius: 0.5 * scale };
        assert_eq!(at_scale(scale, fixed(scale)), at_scale(1.0, fixed(1.0)));
        assert_eq!(at_scale(scale, nearest(scale)), at_scale(1.0, nearest(1.0)));
    }
}

#[test]
fn any_index_gives_the_same_calls() {
    let mut rng = Rng::new(33);
    let photons: Vec<_> = (0..4000u32)
        .map(|i| Photon { light: i, ..photon_at(rng.point() * Vec3::new(1.0, 1.0, 1e-3), Vec3::Z) })
        .collect();
    let photons = Photons::new(4000, photons);
    let tree: PhotonMap = PhotonMap::build(photons.clone());
    let oracle: PhotonMap<BruteForce> = PhotonMap::build(photons);
    fn calls<I: PhotonIndex>(map: &PhotonMap<I>, query: &Query, bandwidth: Bandwidth) -> Vec<(Photon, f32)> {
        let mut calls = Vec::new();
        let mut scratch = NearestList::new();
        gather(map, query, Kernel::Cone { k: 1.0 }, bandwidth, &mut scratch, |p, w| calls.push((*p, w)));
        calls
    }
    for _ in 0..50 {
        let query = up(rng.point() * Vec3::new(1.0, 1.0, 1e-3));
        let nearest = Bandwidth::Nearest { k: 30, max_radius: 0.1 };
        assert_eq!(calls(&tree, &query, nearest), calls(&oracle, &query, nearest));
        let [mut ours, mut theirs] = [
            calls(&tree, &query, Bandwidth::Fixed { radius: 0.05 }),
            calls(&oracle, &query, Bandwidth::Fixed { radius: 0.05 }),
        ];
        ours.sort_by_key(|call| call.0.light);
        theirs.sort_by_key(|call| call.0.light);
        assert_eq!(ours, theirs);
    }
}

#[test]
fn estimates_stay_finite_in_odd_places() {
    let query = up(Vec3::ZERO);
    let beam: PhotonMap = PhotonMap::build(Photons::new(128, vec![photon_at(Vec3::ZERO, Vec3::Z); 128]));
    let nearest = |k, max_radius| Bandwidth::Nearest { k, max_radius };
    // All photons in the query's own place: everything within the largest radius counts.
    let (e, gathered) = irradiance(&beam, &query, Kernel::Box, nearest(50, 2.0));
    assert_eq!(gathered, Gathered { radius: 2.0, count: 128 });
    assert!((e - 1.0 / (4.0 * PI)).abs() < 1e-6);
    let nothing: PhotonMap = PhotonMap::build(Photons::default());
    let mut bandwidths = vec![nearest(0, 1.0), nearest(u32::MAX, 1.0), nearest(50, 1e-30)];
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-30, 1e30] {
        bandwidths.extend([Bandwidth::Fixed { radius }, nearest(50, radius)]);
    }
    for bandwidth in bandwidths {
        for kernel in KERNELS {
            assert_eq!(irradiance(&nothing, &query, kernel, bandwidth).0, 0.0);
            let (e, _) = irradiance(&beam, &query, kernel, bandwidth);
            assert!(e.is_finite() && e >= 0.0, "{kernel} {bandwidth:?}: {e}");
        }
    }
    // One photon sets the radius, so at least two must be found.
    let pair = vec![photon_at(Vec3::X, Vec3::Z), photon_at(Vec3::X * 2.0, Vec3::Z)];
    let pair: PhotonMap = PhotonMap::build(Photons::new(1, pair));
    assert_eq!(irradiance(&pair, &query, Kernel::Box, nearest(0, 9.0)).1, Gathered { radius: 2.0, count: 1 });
}

/// The tops of two balls side by side, in one plane and far apart, each with 200 photons: a search for 300
/// that did not end at the gap between them would spread those of both over a disc that reaches the other.
/// The radius is the disc's but for the last photon of 200, half a percent in the mean.
#[test]
fn a_gap_between_two_surfaces_ends_the_search() {
    // Tops: discs of radius .1 with 200 photons each, 2 apart.
    let mut rng = Rng::new(15);
    let top = |x: f32, rng: &mut Rng| {
        let p = warp::square_to_disk(Vec2::new(rng.next(), rng.next())) * 0.1;
        photon_at(Vec3::new(x + p.x, p.y, 0.0), Vec3::Z)
    };
    let photons: Vec<_> = (0..400).map(|i| top((i % 2 * 2) as f32, &mut rng)).collect();
    let map = PhotonMap::build(Photons::new(200, photons));
    let nearest = Bandwidth::Nearest { k: 300, max_radius: 10.0 };
    let (e, gathered) = irradiance(&map, &up(Vec3::ZERO), Kernel::Box, nearest);
    // All but the last of the 200 of this disc, over nearly all of it.
    assert_eq!(gathered.count, 199);
    let expected = 1.0 / (PI * 0.01);
    assert!((e / expected - 1.0).abs() < 0.03, "{e} is not {expected}: {gathered:?}");
}

/// What half of the squared radius would find is what a look-up of that radius does find.
#[test]
fn half_of_the_squared_radius_is_a_look_up_of_its_own() {
    let mut rng = Rng::new(8);
    let map = uniform_square(4000, &mut rng);
    for kernel in [Kernel::Box, Kernel::Cone { k: 1.0 }, Kernel::Epanechnikov] {
        for p in grid() {
            let radius = 0.1;
            let (mut half, mut scratch) = (0.0, NearestList::new());
            let bandwidth = Bandwidth::Fixed { radius };
            let gathered = gather_both(&map, &up(p), kernel, bandwidth, &mut scratch, |photon, weights| {
                half += photon.power.r * weights.half;
            });
            let narrow = Bandwidth::Fixed { radius: radius / 2f32.sqrt() };
            let (found, _) = irradiance(&map, &up(p), kernel, narrow);
            assert!(gathered.count > 0 && (half / found - 1.0).abs() < 0.02, "{half} {found}");
        }
    }
}
