//! What the tests of media share.

use super::{VolumeMap, VolumePhoton, VolumePhotons};
use crate::color::Rgb;
use crate::math::Vec3;
use crate::photon_map::Kernel;
use crate::photon_map::testing::Rng;

/// The cone is the one at whose rim a photon still weighs something.
pub const KERNELS: [Kernel; 5] =
    [Kernel::Box, Kernel::Cone { k: 1.1 }, Kernel::Gaussian, Kernel::Epanechnikov, Kernel::Biweight];

/// A photon of one watt in medium 0.
pub fn photon_at(position: Vec3) -> VolumePhoton {
    VolumePhoton { position, power: Rgb::WHITE, wi: Vec3::Z, depth: 1, light: 0, medium: 0 }
}

/// As if each came of a path of its own.
pub fn map_of(photons: Vec<VolumePhoton>, k: u32) -> VolumeMap {
    VolumeMap::build(VolumePhotons::new(photons.len() as u64, photons), k)
}

/// Clouds that have broken trees, and some that are too small for one.
pub fn clouds() -> Vec<(&'static str, Vec<Vec3>)> {
    let mut rng = Rng::new(1);
    let mut random = |n: usize| -> Vec<Vec3> { (0..n).map(|_| rng.point()).collect() };
    let cluster = |(i, p): (usize, Vec3)| if i % 2 == 0 { p * 1e-4 } else { Vec3::ONE - p * 1e-2 };
    let dense_to_thin = |p: Vec3| p * crate::math::real::exp(-10.0 * p.x);
    vec![
        ("nothing", vec![]),
        ("one", random(1)),
        ("two", random(2)),
        ("seven", random(7)),
        ("nine", random(9)),
        ("a node and one", random(65)),
        ("a level and one", random(513)),
        ("a cloud", random(5000)),
        ("a plane", random(2000).into_iter().map(|p| p.with_y(0.5)).collect()),
        ("a line", random(1000).into_iter().map(|p| Vec3::splat(p.x)).collect()),
        ("one place", vec![Vec3::splat(0.5); 300]),
        ("two clusters", random(1500).into_iter().enumerate().map(cluster).collect()),
        ("dense to thin", random(3000).into_iter().map(dense_to_thin).collect()),
        ("an outlier", random(400).into_iter().chain([Vec3::splat(100.0)]).collect()),
        ("far from the origin", random(1000).into_iter().map(|p| p + Vec3::splat(1e4)).collect()),
        ("tiny", random(1000).into_iter().map(|p| p * 1e-10).collect()),
        ("huge", random(1000).into_iter().map(|p| p * 1e10).collect()),
    ]
}

/// The mean of independent values, and its standard deviation.
pub fn mean_and_deviation(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}
