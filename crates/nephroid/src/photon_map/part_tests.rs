//! Estimates over a part of the radius of the nearest k, on surfaces and in media: against brute force, and in uniform
//! light.
//!
//! Together the means reject a correct program with a probability of [`ALPHA`]; seeds are fixed.

use std::f32::consts::PI;

use nephroid_testkit::{ALPHA, sidak, z_test};

use super::testing::{Rng, photon_at};
use super::{
    Bandwidth, Gathered, Kernel, NearestList, PhotonMap, Photons, Query, VolumeMap, VolumePhoton,
    VolumePhotons, VolumeQuery, gather,
};
use crate::color::Rgb;
use crate::math::Vec3;

/// The cone is the one at whose rim the k-th photon would still weigh something.
const KERNELS: [Kernel; 5] =
    [Kernel::Box, Kernel::Cone { k: 1.1 }, Kernel::Gaussian, Kernel::Epanechnikov, Kernel::Biweight];

/// More than the means that are tested.
const TESTS: usize = 400;

/// Photons of a watt on the unit square, or in the unit cube.
enum Light {
    Square(PhotonMap),
    Cube(VolumeMap),
}

impl Light {
    fn new(dimensions: u32, points: &[Vec3]) -> Self {
        let n = points.len() as u64;
        if dimensions == 2 {
            let photons = points.iter().map(|p| photon_at(p.with_z(0.0), Vec3::Z)).collect();
            return Self::Square(PhotonMap::build(Photons::new(n, photons)));
        }
        let photon = |&position| VolumePhoton {
            position,
            power: Rgb::WHITE,
            wi: Vec3::Z,
            depth: 1,
            light: 0,
            medium: 0,
        };
        Self::Cube(VolumeMap::build(VolumePhotons::new(n, points.iter().map(photon).collect()), 20))
    }

    /// The weights of the photons that count, and what the search did.
    fn weights(
        &self,
        position: Vec3,
        kernel: Kernel,
        bandwidth: Bandwidth,
        scratch: &mut NearestList,
        weights: &mut Vec<f32>,
    ) -> Gathered {
        weights.clear();
        match self {
            Self::Square(map) => {
                let query = Query { position: position.with_z(0.0), normal: Vec3::Z, max_photon_depth: None };
                gather(map, &query, kernel, bandwidth, scratch, |_, w| weights.push(w))
            }
            Self::Cube(map) => {
                let query = VolumeQuery { position, medium: 0, max_photon_depth: None };
                map.at(&query, kernel, bandwidth, scratch, |_, w| weights.push(w))
            }
        }
    }

    fn distance_sq(&self, point: Vec3, position: Vec3) -> f32 {
        match self {
            Self::Square(_) => point.with_z(0.0).distance_squared(position.with_z(0.0)),
            Self::Cube(_) => point.distance_squared(position),
        }
    }
}

/// The radius that holds so many of `n` photons in the mean.
fn radius_of(dimensions: u32, count: f32, n: usize) -> f32 {
    let share = count / n as f32;
    if dimensions == 2 { (share / PI).sqrt() } else { libm::cbrtf(share * 3.0 / (4.0 * PI)) }
}

/// All photons are sorted: those nearer than the part of the k-th's distance count, that one excepted.
#[test]
fn a_part_counts_what_brute_force_counts() {
    let mut rng = Rng::new(1);
    let (mut scratch, mut found) = (NearestList::new(), Vec::new());
    for (dimensions, n) in [2, 3].into_iter().flat_map(|d| [1, 2, 3, 4, 30, 3000].map(|n| (d, n))) {
        let points: Vec<Vec3> = (0..n).map(|_| rng.point()).collect();
        let light = Light::new(dimensions, &points);
        for i in 0..200 {
            let (position, kernel) = (rng.point(), KERNELS[i % 5]);
            let k = [2, 3, 10, 60][i / 5 % 4];
            let part = [1.0, 0.9, 0.5, 0.2][i / 20 % 4];
            let max_radius = radius_of(dimensions, 2.0 * k as f32, n).min(0.8);
            let least = [0.0, 0.3, 1.5][i % 3] * radius_of(dimensions, k as f32, n).min(0.4);
            let bandwidth = Bandwidth::Part { k, max_radius, part, least };
            let mut d_sq: Vec<f32> = points.iter().map(|p| light.distance_sq(*p, position)).collect();
            d_sq.sort_by(f32::total_cmp);
            let near = d_sq.iter().filter(|d| **d <= max_radius * max_radius).count().min(k as usize);
            let enough = near >= 3.min(k as usize);
            let whole = if enough { d_sq[near - 1].sqrt() } else { max_radius };
            let radius = (whole * part).max(least);
            // The photon that sets the radius counts only if what counts does not depend on it.
            let last = if enough && radius <= whole { near - 1 } else { n };
            let expected: Vec<f32> = d_sq[..last].iter().copied().filter(|d| *d <= radius * radius).collect();
            let gathered = light.weights(position, kernel, bandwidth, &mut scratch, &mut found);
            let shown = format!("{dimensions}D, {n} photons, {kernel}, {bandwidth:?}");
            assert!((gathered.radius / radius - 1.0).abs() < 1e-5, "{shown}: {} {radius}", gathered.radius);
            assert_eq!((found.len(), gathered.count as usize), (expected.len(), expected.len()), "{shown}");
            let weight = |d: f32| match dimensions {
                2 => kernel.weight_2d(d, radius * radius),
                _ => kernel.weight_3d(d, radius * radius),
            };
            found.sort_by(|a, b| b.total_cmp(a));
            for (found, d) in found.iter().zip(expected) {
                assert!((found - weight(d)).abs() <= 1e-5 * weight(0.0), "{shown}: {found} {}", weight(d));
            }
        }
    }
}

/// The means over maps of uniform photons, whose density is 1 W in a unit, for each of the bandwidths and kernels.
fn expect_uniform(dimensions: u32, maps: usize, n: usize, bandwidths: &[Bandwidth], seed: u64) {
    const SIDE: usize = 4;
    let (mut rng, mut scratch, mut weights) = (Rng::new(seed), NearestList::new(), Vec::new());
    let all: Vec<_> = bandwidths.iter().flat_map(|b| KERNELS.map(|kernel| (kernel, *b))).collect();
    let mut values = vec![Vec::new(); all.len()];
    for _ in 0..maps {
        let points: Vec<Vec3> = (0..n).map(|_| rng.point()).collect();
        let light = Light::new(dimensions, &points);
        for (values, (kernel, bandwidth)) in values.iter_mut().zip(&all) {
            let mut sum = 0.0;
            for i in 0..SIDE.pow(dimensions) {
                let place = |i: usize| 0.3 + 0.4 * (i % SIDE) as f32 / (SIDE - 1) as f32;
                let position = Vec3::new(place(i), place(i / SIDE), place(i / SIDE / SIDE));
                light.weights(position, *kernel, *bandwidth, &mut scratch, &mut weights);
                sum += weights.iter().map(|&w| f64::from(w)).sum::<f64>() / n as f64;
            }
            values.push(sum / SIDE.pow(dimensions) as f64);
        }
    }
    for ((kernel, bandwidth), values) in all.iter().zip(values) {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let deviation = (variance / count).sqrt();
        assert!(deviation < 0.08, "too few samples: {deviation}");
        let outcome = z_test(mean, 1.0, deviation);
        assert!(outcome.passes(sidak(ALPHA, TESTS)), "{dimensions}D, {kernel}, {bandwidth:?}: {outcome}");
    }
}

/// The largest radius holds one photon, two or three in the mean.
#[test]
fn a_part_is_right_where_few_photons_are() {
    for (dimensions, n, maps) in [(2, 500, 100), (3, 1000, 50)] {
        let part = |count| Bandwidth::Part {
            k: 10,
            max_radius: radius_of(dimensions, count, n),
            part: 0.7,
            least: 0.0,
        };
        expect_uniform(dimensions, maps, n, &[1.0, 2.0, 3.0].map(part), 20 + u64::from(dimensions));
    }
}
