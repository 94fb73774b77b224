//! Light that a medium scatters once, by every estimator, against integrals along a ray.
//!
//! The tests of the file share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct code would fail
//! somewhere in this file with probability 1 %.

use nephroid::color::Rgb;
use nephroid::integrator::{DirectSource, Method, PhotonMapperConfig, VcmConfig, VolumeEstimate};
use nephroid::math::{Transform, Vec3};
use nephroid::medium::{Medium, Phase};
use nephroid::shape::Geometry;
use nephroid::transport::VolumeKind;
use nephroid::world::World;
use nephroid_convergence::{Builder, KERNELS, channel_means, grey_fog, medium_view, medium_views, volpath};
use nephroid_testkit::{ALPHA, MeanTest, Outcome, Tolerance, integrate, sidak};
use std::f64::consts::PI;

/// More than the statistical tests of this file.
const TESTS: usize = 200;

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

/// Tests the mean of each channel.
#[track_caller]
fn judge_channels(name: &str, means: &[[f64; 3]], exact: [f64; 3], bias: f64) {
    for (channel, exact) in exact.into_iter().enumerate() {
        let test: MeanTest = means.iter().map(|mean| mean[channel]).collect();
        judge(&format!("{name}, channel {channel}"), &test.within(exact, bias));
    }
}

/// Single scattering by rays alone.
fn rays() -> PhotonMapperConfig {
    PhotonMapperConfig {
        single_scatter: DirectSource::Rays,
        max_depth: Some(2),
        ..medium_view(VolumeKind::Points, VolumeEstimate::Beam, 100)
    }
}

/// The methods that sample and do not estimate densities: they are right to the noise.
fn exact_methods() -> [(&'static str, Method); 3] {
    let mapper = PhotonMapperConfig { max_depth: Some(2), ..PhotonMapperConfig::default() };
    let vcm = Method::Vcm(VcmConfig { mapper, light_paths: Some(2000), ..VcmConfig::default() });
    [("rays", Method::PhotonMapper(rays())), ("volpath", volpath(Some(2))), ("vcm", vcm)]
}

/// How a medium is said to be where it is.
#[derive(Clone, Copy, Debug)]
enum Bounds {
    /// The camera and the light name it, and nothing ends it.
    None,
    /// It fills a ball beyond which next to nothing of it is seen.
    Ball,
}

/// A ray of the camera that passes a point light of intensity 1 W/sr at an angle of 60°, which is 2 away.
fn passing_ray(medium: Medium, bounds: Bounds) -> World {
    let mut b = Builder::seen_from(Vec3::ZERO, Vec3::X, 0.01, 1);
    b.point_light(Vec3::new(1.0, 3.0f32.sqrt(), 0.0), 1.0);
    let medium = b.medium(medium);
    match bounds {
        Bounds::None => b.fill(medium),
        Bounds::Ball => {
            b.filled(Geometry::Sphere { center: Vec3::ZERO, radius: 150.0 }, Transform::IDENTITY, medium);
        }
    }
    b.build()
}

/// ∫ σ_s/(4π) e^(−σ_t (s+d)) / d² ds along that ray, with albedo 1 and d the distance from the light.
fn passing_ray_exactly(sigma_t: f64) -> f64 {
    let at = |s: f64| {
        let d_sq = (s - 1.0) * (s - 1.0) + 3.0;
        sigma_t / (4.0 * PI) * libm::exp(-sigma_t * (s + d_sq.sqrt())) / d_sq
    };
    // To the ray's far end by s = x/(1−x).
    let in_x = |x: f64| at(x / (1.0 - x)) / ((1.0 - x) * (1.0 - x));
    integrate(in_x, &[0.0, 0.5, 0.9, 1.0], Tolerance::relative(1e-10)).value
}

/// σ_t = 1, .5 and .1 in one picture, with and without bounds.
#[test]
fn a_point_light_is_scattered_into_a_ray_that_passes_it() {
    let sigma_t = [1.0f32, 0.5, 0.1];
    let exact = sigma_t.map(|sigma| passing_ray_exactly(f64::from(sigma)));
    for (exact, published) in exact.into_iter().zip([0.00348499, 0.00708362, 0.00559989]) {
        assert!((exact / published - 1.0).abs() < 2e-6, "{exact}, not {published}");
    }
    let albedo = [1.0f32, 0.8, 0.3];
    let fog = Medium::homogeneous("fog", Rgb::from(sigma_t), Rgb::from(albedo), Phase::Isotropic);
    let exact = [0, 1, 2].map(|c| exact[c] * f64::from(albedo[c]));
    for bounds in [Bounds::None, Bounds::Ball] {
        let world = passing_ray(fog.clone(), bounds);
        for (name, method) in exact_methods() {
            let means = channel_means(&world, &method, 4096, 0..20);
            judge_channels(&format!("{name}, {bounds:?}"), &means, exact, 1e-4);
        }
    }
}

/// A channel that the fog leaves alone has nothing to be seen, however far a ray goes, and holds no march up.
#[test]
fn fog_without_bounds_may_leave_a_channel_alone() {
    let fog = Medium::homogeneous("fog", Rgb::new(1.0, 0.5, 0.0), Rgb::WHITE, Phase::Isotropic);
    let world = passing_ray(fog, Bounds::None);
    let exact = [passing_ray_exactly(1.0), passing_ray_exactly(0.5), 0.0];
    for (name, method) in exact_methods() {
        judge_channels(name, &channel_means(&world, &method, 4096, 0..20), exact, 1e-4);
    }
    for estimate in [VolumeEstimate::Beam, VolumeEstimate::March, VolumeEstimate::MarchReport] {
        let config = PhotonMapperConfig {
            march_step: Some(0.1),
            max_depth: Some(2),
            ..medium_view(VolumeKind::Points, estimate, 10_000)
        };
        // A single ray, blurred by about half a metre: 15 %.
        let means = channel_means(&world, &Method::PhotonMapper(config), 4, 0..20);
        judge_channels(&format!("{estimate:?}"), &means, exact, 0.15);
    }
}

/// Where next to nothing is taken, σ_s I (π−γ)/(4π D sin γ) = .0962250 σ_s; what 10⁻⁵ takes is below 10⁻³.
#[test]
fn thin_fog_scatters_what_the_angle_says() {
    const SIGMA: f32 = 1e-5;
    let world = passing_ray(grey_fog(SIGMA, 1.0, Phase::Isotropic), Bounds::None);
    let gamma = PI / 3.0;
    let exact = f64::from(SIGMA) * (PI - gamma) / (8.0 * PI * libm::sin(gamma));
    assert!((exact / f64::from(SIGMA) - 0.0962250).abs() < 1e-7);
    // Paths hardly ever collide in it.
    let means = channel_means(&world, &Method::PhotonMapper(rays()), 1024, 0..20);
    judge_channels("rays", &means, [exact; 3], 1e-3);
}

/// Half the width of the picture, its distance from the light, and how far from that the fog reaches, if it ends.
const HALF_WIDTH: f64 = 1.5;
const DISTANCE: f64 = 2.0;
const REACH: f64 = 6.0;

/// A point light of 1 W/sr in front of a camera with parallel rays, in fog.
fn light_ahead(medium: Medium, bounds: Bounds) -> World {
    let mut b = Builder::parallel_view(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, HALF_WIDTH, 12, 12);
    b.point_light(Vec3::ZERO, 1.0);
    let medium = b.medium(medium);
    match bounds {
        Bounds::None => b.fill(medium),
        Bounds::Ball => {
            let ball = Geometry::Sphere { center: Vec3::ZERO, radius: REACH as f32 };
            b.filled(ball, Transform::IDENTITY, medium);
        }
    }
    b.build()
}

/// The mean over that picture of ∫ σ_s p e^(−σ_t (s+d)) / d² ds, b away from the light. About the picture's middle the
/// square has an angle of 2π up to its sides, and beyond of 2π − 8 arccos(w/b).
fn light_ahead_exactly(sigma_t: f64, albedo: f64, bounds: Bounds, phase: impl Fn(f64) -> f64) -> f64 {
    let (w, area) = (HALF_WIDTH, 4.0 * HALF_WIDTH * HALF_WIDTH);
    let angle = |b: f64| 2.0 * PI - if b > w { 8.0 * libm::acos(w / b) } else { 0.0 };
    // Seen from the light, at an angle θ to the camera's rays: s = D + b / tan θ and |ds| = d²/b dθ. 1/d² goes, and 1/b
    // with the ring's length.
    let at = |b: f64, theta: f64| {
        let d = b / libm::sin(theta);
        let s = DISTANCE + d * libm::cos(theta);
        // Light that flies on along θ turns towards the camera, which lies at π.
        let scattered = if s > 0.0 { phase(-libm::cos(theta)) * libm::exp(-sigma_t * (s + d)) } else { 0.0 };
        albedo * sigma_t * scattered * angle(b) / area
    };
    let first = |b: f64| match bounds {
        Bounds::None => 0.0,
        Bounds::Ball => libm::asin(b / REACH),
    };
    let last = |b: f64| PI - libm::atan2(b, DISTANCE);
    let inner = |b: f64| integrate(|theta| at(b, theta), &[first(b), last(b)], Tolerance::relative(1e-7));
    let outer = |b: f64| inner(b).value;
    integrate(outer, &[0.0, w, 2.0f64.sqrt() * w], Tolerance::relative(1e-6)).value
}

/// Henyey and Greenstein's function of the cosine between the directions before and after.
fn henyey_greenstein(g: f64) -> impl Fn(f64) -> f64 {
    move |cos| {
        let distance_sq = 1.0 + g * g - 2.0 * g * cos;
        (1.0 - g * g) / (4.0 * PI * distance_sq * distance_sq.sqrt())
    }
}

/// The estimators that take light scattered once from maps. Beams are blurred by as much as the space is wide that they
/// are in, which is more than the picture unless fewer of them are asked for.
fn views() -> impl Iterator<Item = (String, PhotonMapperConfig)> {
    let limited = PhotonMapperConfig { max_depth: Some(2), beam_crossings: 8.0, ..Default::default() };
    medium_views(10_000).into_iter().skip(1).map(move |(name, config)| {
        let (max_depth, beam_crossings) = (limited.max_depth, limited.beam_crossings);
        (name, PhotonMapperConfig { max_depth, beam_crossings, ..config })
    })
}

/// With every estimator and every kernel. Over the plane across its rays, a kernel integrates to one, so that the mean
/// of a picture knows of blur only what passes its sides: that is below 1 % here. The march looks around points, where
/// k photons in front of a light of no size see less than the middle of the ball: 3 % are forgiven. Beams end where they
/// have gone across the scene, so that they are asked only where it has bounds.
#[test]
fn every_estimator_and_kernel_brings_light_scattered_once() {
    let (sigma_t, albedo) = ([1.0f32, 0.5, 2.0], [1.0f32, 0.8, 0.6]);
    let fog = Medium::homogeneous("fog", Rgb::from(sigma_t), Rgb::from(albedo), Phase::Isotropic);
    for bounds in [Bounds::None, Bounds::Ball] {
        let world = light_ahead(fog.clone(), bounds);
        let exact = [0, 1, 2]
            .map(|c| light_ahead_exactly(f64::from(sigma_t[c]), f64::from(albedo[c]), bounds, |_| 0.25 / PI));
        for (name, method) in exact_methods() {
            let means = channel_means(&world, &method, 64, 0..20);
            judge_channels(&format!("{name}, {bounds:?}"), &means, exact, 1e-4);
        }
        let bounded = matches!(bounds, Bounds::Ball);
        for (name, base) in views().filter(|(_, c)| bounded == (c.volume_kind == VolumeKind::Beams)) {
            for (number, kernel) in (0..).zip(KERNELS) {
                let config = PhotonMapperConfig { kernel, ..base.clone() };
                let seeds = 100 * number..100 * number + 12;
                let means = channel_means(&world, &Method::PhotonMapper(config), 4, seeds);
                let bias = if base.volume_estimate == VolumeEstimate::March { 0.03 } else { 0.01 };
                judge_channels(&format!("{name}, {kernel}"), &means, exact, bias);
            }
        }
    }
}

/// The same light, scattered mostly forward, mostly backward and as by small things.
#[test]
fn phase_functions_count_for_every_estimator() {
    const SIGMA: f64 = 1.0;
    let rayleigh = |cos: f64| 3.0 / (16.0 * PI) * (1.0 + cos * cos);
    let hg = |g: f32| (Phase::HenyeyGreenstein { g }, henyey_greenstein(f64::from(g)));
    type Value = Box<dyn Fn(f64) -> f64>;
    let lobes: [(Phase, Value); 3] = [
        (hg(0.8).0, Box::new(hg(0.8).1)),
        (hg(-0.8).0, Box::new(hg(-0.8).1)),
        (Phase::Rayleigh, Box::new(rayleigh)),
    ];
    for (phase, value) in lobes {
        let world = light_ahead(grey_fog(SIGMA as f32, 0.7, phase), Bounds::Ball);
        let exact = [light_ahead_exactly(SIGMA, 0.7, Bounds::Ball, &value); 3];
        for (name, method) in exact_methods() {
            let means = channel_means(&world, &method, 64, 0..20);
            judge_channels(&format!("{name}, {phase:?}"), &means, exact, 1e-4);
        }
        for (name, config) in views() {
            let bias = if config.volume_estimate == VolumeEstimate::March { 0.03 } else { 0.01 };
            let means = channel_means(&world, &Method::PhotonMapper(config), 4, 50..62);
            judge_channels(&format!("{name}, {phase:?}"), &means, exact, bias);
        }
    }
}
