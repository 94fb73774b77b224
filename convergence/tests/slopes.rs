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
    DirectSource, FinalGather, Method, PhotonMapperConfig, PpmConfig, Show, VolumeEstimate,
};
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::medium::Phase;
use nephroid::shape::Geometry;
use nephroid::transport::VolumeKind;
use nephroid::world::World;
use nephroid_convergence::{
    Builder, Part, Series, grey_fog, light_tracer, log_slope, medium_view, path, pixel_origins,
    polygon_irradiance, volpath,
};
use nephroid_testkit::{ALPHA, MeanTest, Tolerance, integrate, sidak};

/// More than the slopes that are tested.
const TESTS: usize = 20;

const SEEDS: u64 = 16;

/// Pixels of a picture's side.
const SIDE: u32 = 8;

fn numbers() -> Vec<u64> {
    let octaves = if std::env::var_os("NEPHROID_LONG").is_some() { 4..=12 } else { 3..=8 };
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
    println!("{name}: {:.3} ± {:.3}, expected {from:.3} to {to:.3}", slope.mean(), slope.standard_error());
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

/// Renders and judges. `of_noise` and `of_bias` are the dimensions that count for the variance and for the bias.
fn judge_progressive(name: &str, world: &World, config: PhotonMapperConfig, exact: &[f64], d: f64) {
    let method = Method::Ppm(PpmConfig {
        mapper: config,
        plan_photons: false,
        plan_neighbours: false,
        samples_per_pixel: Some(1),
    });
    let series = Series::render(world, &method, &numbers(), 0..SEEDS, exact);
    let errors = series.errors(None);
    println!(
        "{name}: mse {:.5?} variance {:.5?} bias² {:.5?}",
        errors.mse, errors.variance, errors.bias_sq
    );
    println!("bias {:.3}", log_slope(&series.iterations, &errors.bias_sq));
    let [of_noise, of_bias] = expected(d);
    judge(&format!("{name}, noise"), &series.slope(Part::Variance), of_noise, of_noise);
    judge(name, &series.slope(Part::Mse), of_noise, of_bias);
}

/// The mean over each pixel of a function of the place on the film's plane, by a rule of 3 × 3 points of Gauss.
fn over_pixels(world: &World, width: f64, value: impl Fn(DVec3) -> f64) -> Vec<f64> {
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

fn floor(b: &mut Builder, half: f64) {
    let white = b.diffuse(1.0);
    let to_world = Transform::scale(DVec3::splat(half)).then(Transform::rotate(DVec3::X, -90.0));
    b.shape(Geometry::Rectangle, to_world, white);
}

/// A floor under a point light, where irradiance is (1 + r²)^(−3/2) a unit below it: blurred by .4 it is 8 % too dark
/// in the middle.
#[test]
fn surfaces() {
    const HALF: f64 = 0.7;
    let mut b = Builder::parallel_view(Vec3::new(0.0, 0.5, 0.0), Vec3::ZERO, HALF, SIDE, SIDE);
    floor(&mut b, 2.0);
    b.point_light(Vec3::Y, 1.0);
    let world = b.build();
    let exact = over_pixels(&world, 2.0 * HALF / f64::from(SIDE), |p| {
        let r_sq = p.x * p.x + p.z * p.z;
        libm::pow(1.0 + r_sq, -1.5) / PI
    });
    let config = PhotonMapperConfig {
        emit: Some(800),
        neighbours: 60,
        direct: DirectSource::Map,
        final_gather: FinalGather::Off,
        show: Show::Direct,
        ..PhotonMapperConfig::default()
    };
    judge_progressive("surfaces", &world, config, &exact, 2.0);
}

/// Fog around a point light, of which a part beside the light is seen by parallel rays.
fn beside_a_light() -> (World, Vec<f64>) {
    const HALF: f64 = 0.3;
    const REACH: f64 = 3.0;
    const SIGMA: f64 = 0.5;
    let center = Vec3::new(0.6, 0.0, 3.5);
    let mut b = Builder::parallel_view(center, Vec3::new(0.6, 0.0, 0.0), HALF, SIDE, SIDE);
    b.point_light(Vec3::ZERO, 1.0);
    let fog = b.medium(grey_fog(SIGMA as f32, 0.8, Phase::Isotropic));
    let ball = Geometry::Sphere { center: Vec3::ZERO, radius: REACH as f32 };
    b.filled(ball, Transform::IDENTITY, fog);
    let world = b.build();
    let exact = over_pixels(&world, 2.0 * HALF / f64::from(SIDE), |p| {
        let b_sq = p.x * p.x + p.y * p.y;
        let half = (REACH * REACH - b_sq).sqrt();
        let at = |z: f64| {
            let d_sq = b_sq + z * z;
            0.8 * SIGMA / (4.0 * PI) * libm::exp(-SIGMA * (half - z + d_sq.sqrt())) / d_sq
        };
        integrate(at, &[-half, -0.5, 0.0, 0.5, half], Tolerance::relative(1e-7)).value
    });
    (world, exact)
}

fn in_fog(kind: VolumeKind, estimate: VolumeEstimate, count: u64, k: u32) -> PhotonMapperConfig {
    PhotonMapperConfig {
        volume_neighbours: Some(k),
        max_depth: Some(2),
        beam_crossings: k as f32,
        emit: Some(count),
        ..medium_view(kind, estimate, count)
    }
}

#[test]
fn points_in_media_by_beam() {
    let (world, exact) = beside_a_light();
    judge_progressive(
        "points by beam",
        &world,
        in_fog(VolumeKind::Points, VolumeEstimate::Beam, 800, 8),
        &exact,
        2.0,
    );
}

#[test]
fn points_in_media_by_march() {
    let (world, exact) = beside_a_light();
    judge_progressive(
        "points by march",
        &world,
        in_fog(VolumeKind::Points, VolumeEstimate::March, 800, 8),
        &exact,
        3.0,
    );
}

#[test]
fn beams_in_media() {
    let (world, exact) = beside_a_light();
    judge_progressive("beams", &world, in_fog(VolumeKind::Beams, VolumeEstimate::Beam, 100, 8), &exact, 1.0);
}

/// What does not blur has noise alone, ∝ 1/N: a floor under a square lamp that lies a unit above.
#[test]
fn unbiased() {
    const HALF: f64 = 0.7;
    let mut b = Builder::parallel_view(Vec3::new(0.0, 0.5, 0.0), Vec3::ZERO, HALF, SIDE, SIDE);
    floor(&mut b, 2.0);
    let (black, glow) = (b.diffuse(0.0), b.constant(1.0));
    let lamp = Transform::scale(DVec3::splat(0.5)).then(Transform::rotate(DVec3::X, 90.0));
    b.shape(Geometry::Rectangle, lamp.then(Transform::translate(DVec3::Y)), black).emission = Some(glow);
    let world = b.build();
    let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(x, z)| DVec3::new(x, 1.0, z));
    let exact = over_pixels(&world, 2.0 * HALF / f64::from(SIDE), |p| {
        polygon_irradiance(&corners, DVec3::new(p.x, 0.0, p.z), DVec3::Y) / PI
    });
    for method in [path(), volpath(None), light_tracer(None)] {
        let name = method.name();
        let series = Series::render(&world, &method, &numbers(), 0..SEEDS, &exact);
        judge(name, &series.slope(Part::Mse), -1.0, -1.0);
    }
}
