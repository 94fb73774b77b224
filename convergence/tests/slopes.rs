//! How fast renders converge: the slope of the logarithm of the mean squared error against that of the number of
//! iterations.
//!
//! Estimates that blur d dimensions over radii ∝ i^(−1/(4+d)) have a variance V Σ i^(d/(4+d)) / N² and a bias whose square
//! is B (Σ i^(−2/(4+d)) / N)² after N iterations: both ∝ N^(−4/(4+d)) in the end (Knaus and Zwicker 2011; Kaplanyan and
//! Dachsbacher 2013, doi 10.1145/2487228.2487233), and a few hundredths off before, as the sums are no integrals yet. A
//! mixture of both, of whatever shares, has a slope between the two, so the error's must lie there. Noise alone, which is
//! what seeds do not share, must have its own.
//!
//! Slopes have a standard error from the jackknife over the seeds. The tests of the file share the level [`ALPHA`] by
//! Šidák's formula: on seeds chosen afresh, correct code would fail somewhere with probability 1 %.
//!
//! `NEPHROID_LONG=1` goes from 2⁴ to 2¹² iterations instead of from 2³ to 2⁸.

use std::f64::consts::PI;

use nephroid::integrator::{
    DirectSource, FinalGather, Method, PhotonMapperConfig, PpmConfig, Show, VcmConfig, VolumeEstimate,
};
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::Geometry;
use nephroid::transport::VolumeKind;
use nephroid::world::World;
use nephroid_convergence::{
    Builder, Part, Series, beside_a_light, every_method, log_slope, medium_view, over_pixels,
    polygon_irradiance, progressive, under_a_light,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// More than the slopes that are tested.
const TESTS: usize = 20;

const SEEDS: u64 = 32;

/// Pixels of a picture's side.
const SIDE: u32 = 8;

fn is_long() -> bool {
    std::env::var_os("NEPHROID_LONG").is_some()
}

fn numbers() -> Vec<u64> {
    let octaves = if is_long() { 4..=12 } else { 3..=8 };
    octaves.map(|octave| 1 << octave).collect()
}

/// The slopes of the variance and of the squared bias over the same numbers of iterations.
fn expected(dimensions: f64) -> [f64; 2] {
    let mean = |n: u64, exponent: f64| {
        (1..=n).map(|i| libm::pow(i as f64, exponent / (4.0 + dimensions))).sum::<f64>() / n as f64
    };
    let numbers = numbers();
    let variance: Vec<f64> = numbers.iter().map(|&n| mean(n, dimensions) / n as f64).collect();
    let bias: Vec<f64> = numbers.iter().map(|&n| mean(n, -2.0).powi(2)).collect();
    [log_slope(&numbers, &variance), log_slope(&numbers, &bias)]
}

#[track_caller]
fn judge(name: &str, slope: &MeanTest, from: f64, to: f64) {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from).abs());
    let outcome = slope.within(middle, half / middle.abs());
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

/// Renders, and judges noise by itself and the error by the two that it is a mixture of.
fn judge_progressive(name: &str, world: &World, config: PhotonMapperConfig, exact: &[f64], d: f64) {
    let series = render(world, config, exact);
    let [of_noise, of_bias] = expected(d);
    judge(&format!("{name}, noise"), &series.slope(Part::Variance), of_noise, of_noise);
    judge(name, &series.slope(Part::Mse), of_noise, of_bias);
}

/// With one camera sample of each pixel to an iteration.
fn render(world: &World, config: PhotonMapperConfig, exact: &[f64]) -> Series {
    let Method::Ppm(plan) = progressive(config) else { unreachable!("it is progressive") };
    let method = Method::Ppm(PpmConfig { samples_per_pixel: Some(1), ..plan });
    Series::render(world, &method, &numbers(), 0..SEEDS, exact)
}

/// On the spot, where irradiance bends.
#[test]
fn surfaces() {
    let (world, exact) = under_a_light(SIDE, 0.7);
    let exact: Vec<f64> = exact(0.0).into_iter().map(|e| e / PI).collect();
    let config = PhotonMapperConfig {
        emit: Some(1200),
        neighbours: 60,
        direct: DirectSource::Map,
        final_gather: FinalGather::Off,
        show: Show::Direct,
        ..PhotonMapperConfig::default()
    };
    judge_progressive("surfaces", &world, config, &exact, 2.0);
}

/// Fog that shows from the map what it scatters once.
fn in_fog(kind: VolumeKind, estimate: VolumeEstimate, paths: u64) -> PhotonMapperConfig {
    PhotonMapperConfig {
        volume_neighbours: Some(60),
        beam_crossings: 5.0,
        max_depth: Some(2),
        emit: Some(paths),
        ..medium_view(kind, estimate, paths)
    }
}

/// With the few neighbours of the default, whose noise is most of the error. Photons share a radius by 32, in groups that
/// lie much alike in all iterations; where radii jump between them some per cent of bias are left that do not fall as the
/// rest does, so that beyond 2⁸ iterations noise alone is judged.
#[test]
fn points_in_media_along_rays() {
    let (world, exact) = beside_a_light(SIDE);
    let config = in_fog(VolumeKind::Points, VolumeEstimate::Beam, 1500);
    let series = render(&world, PhotonMapperConfig { volume_neighbours: Some(8), ..config }, &exact);
    let [of_noise, of_bias] = expected(2.0);
    judge("points along rays, noise", &series.slope(Part::Variance), of_noise, of_noise);
    if !is_long() {
        judge("points along rays", &series.slope(Part::Mse), of_noise, of_bias);
    }
}

/// Balls blur three dimensions, but a ray's steps shorten with their radius: noise falls faster than that of one ball, and
/// the error no slower than its blur.
#[test]
fn points_in_media_near_rays() {
    let (world, exact) = beside_a_light(SIDE);
    let config = in_fog(VolumeKind::Points, VolumeEstimate::March, 1500);
    let series = render(&world, config, &exact);
    let [of_noise, of_bias] = expected(3.0);
    judge("points near rays, noise", &series.slope(Part::Variance), -1.0, of_noise);
    judge("points near rays", &series.slope(Part::Mse), -1.0, of_bias);
}

#[test]
fn beams_in_media() {
    let (world, exact) = beside_a_light(SIDE);
    judge_progressive("beams", &world, in_fog(VolumeKind::Beams, VolumeEstimate::Beam, 150), &exact, 1.0);
}

/// Vertex connection and merging in uniform light, the inside of a ball of radius 2 and albedo ½ about a point of 3 W/sr,
/// where photons have no bias: of light that both ends find, some is merged, whose noise falls as that of photons does, and
/// the rest connected, ∝ 1/N.
#[test]
fn both_ends() {
    let mut b = Builder::seen_from(Vec3::ZERO, Vec3::new(0.3, 0.5, 1.0), 120.0, 4);
    let grey = b.diffuse(0.5);
    b.sphere(Vec3::ZERO, 2.0, grey).flip_normals = true;
    b.point_light(Vec3::ZERO, 3.0);
    let (world, exact) = (b.build(), [0.75 / PI; 16]);
    for connections in [true, false] {
        let method = Method::Vcm(VcmConfig { connections, light_paths: Some(400), ..VcmConfig::default() });
        let series = Series::render(&world, &method, &numbers(), 0..SEEDS, &exact);
        let [of_noise, _] = expected(2.0);
        for part in [Part::Variance, Part::Mse] {
            judge(&format!("both ends, connections: {connections}"), &series.slope(part), -1.0, of_noise);
        }
    }
}

/// What does not blur has noise alone, ∝ 1/N: a floor under a square lamp that lies a unit above.
#[test]
fn unbiased() {
    const HALF: f64 = 0.7;
    let mut b = Builder::parallel_view(Vec3::new(0.0, 0.5, 0.0), Vec3::ZERO, HALF, SIDE, SIDE);
    b.white_floor(2.0);
    let (black, glow) = (b.diffuse(0.0), b.constant(1.0));
    let lamp = Transform::scale(DVec3::splat(0.5)).then(Transform::rotate(DVec3::X, 90.0));
    b.shape(Geometry::Rectangle, lamp.then(Transform::translate(DVec3::Y)), black).emission = Some(glow);
    let world = b.build();
    let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, z)| DVec3::new(x, 1.0, z));
    let exact = over_pixels(&world, 2.0 * HALF / f64::from(SIDE), |p| {
        polygon_irradiance(&corners, DVec3::new(p.x, 0.0, p.z), DVec3::Y) / PI
    });
    let methods = every_method(&PhotonMapperConfig::default());
    for method in
        methods.into_iter().filter(|contestant| !contestant.blurs).map(|contestant| contestant.method)
    {
        let name = method.name();
        let series = Series::render(&world, &method, &numbers(), 0..SEEDS, &exact);
        judge(name, &series.slope(Part::Mse), -1.0, -1.0);
    }
}
