//! Whether the error that a render states is the error that it has.
//!
//! Renders go on until they state an error of 10 % and of 5 %, and at each the true error is taken against a closed form, or
//! against two long renders by a method without bias, as the mean of (a − r)(a − s)/d, which their noise is not in. It
//! must lie in the interval as often as a binomial test at α = 1 % allows for a probability of 90 %; more often is not
//! held against it, for what makes an interval wide is not all chance.
//!
//! `NEPHROID_LONG=1` goes on to 3 %, with twenty seeds instead of two.

use std::f64::consts::PI;

use nephroid::film::Film;
use nephroid::integrator::{DirectSource, FinalGather, Method, PhotonMapperConfig, PpmConfig, Show};
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::observer::Silent;
use nephroid::session::{Convergence, RenderSettings, Session};
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_convergence::{
    Builder, light_tracer, over_pixels, path, polygon_irradiance, progressive, under_a_light,
};
use nephroid_testkit::{ALPHA, binomial_test};

const SIDE: u32 = 32;

fn is_long() -> bool {
    std::env::var_os("NEPHROID_LONG").is_some()
}

fn targets() -> &'static [f64] {
    if is_long() { &[0.1, 0.05, 0.03] } else { &[0.1, 0.05] }
}

fn luminances(film: &Film) -> Vec<f64> {
    film.develop().pixels.iter().map(|p| f64::from(p.luminance())).collect()
}

/// E of a picture against two that are independent, or the same that is exact.
fn true_error(picture: &[f64], truths: &[Vec<f64>; 2]) -> f64 {
    let count = picture.len() as f64;
    let mean = truths.concat().iter().sum::<f64>() / (2.0 * count);
    let term = |pixel: usize| {
        let [r, s] = [truths[0][pixel], truths[1][pixel]];
        (picture[pixel] - r) * (picture[pixel] - s) / (0.25 * (r + s) * (r + s) + 0.01 * mean * mean)
    };
    libm::sqrt(((0..picture.len()).map(term).sum::<f64>() / count).max(0.0))
}

fn session(world: &World, method: Method, seed: u64) -> Session<'_> {
    Session::new(world, RenderSettings { method, samples_per_pixel: 1 << 16, seed }, &Silent)
}

/// Renders until so large an error is stated.
fn until(session: &mut Session<'_>, target: f64) {
    while session.quality().is_none_or(|quality| quality.error > target) {
        assert!(session.step(&Silent), "nothing cancels");
    }
}

/// Renders of a method without bias that state no more than 4 %, for two seeds.
fn references(world: &World, method: &Method) -> [Vec<f64>; 2] {
    [1001, 1002].map(|seed| {
        let mut session = session(world, method.clone(), seed);
        until(&mut session, if is_long() { 0.015 } else { 0.04 });
        luminances(session.film())
    })
}

fn judge(name: &str, world: &World, methods: &[Method], truths: &[Vec<f64>; 2]) {
    let seeds = if is_long() { 20 } else { 2 };
    for method in methods {
        let (mut inside, mut trials, mut found) = (0, 0, String::new());
        for seed in 0..seeds {
            let mut session = session(world, method.clone(), seed);
            for &target in targets() {
                until(&mut session, target);
                let quality = session.quality().expect("it was stated");
                let [low, high] = quality.interval;
                let error = true_error(&luminances(session.film()), truths);
                inside += u64::from((low..=high).contains(&error));
                trials += 1;
                found += &format!(
                    "\n{:.4} in {low:.4} to {high:.4}: {error:.4} (noise {:.4}, bias {:.4}, {} estimates)",
                    quality.error, quality.noise, quality.bias, quality.estimates
                );
            }
        }
        let outcome = binomial_test(inside, trials, 0.9);
        let name = format!("{name}, {}", method.name());
        assert!(10 * inside >= 9 * trials || outcome.passes(ALPHA), "{name}: {outcome}{found}");
    }
}

/// All that is seen is light that half of the squared radius blurs less, and the truth is known.
#[test]
fn blurred_light() {
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
    let Method::Ppm(plan) = progressive(config) else { unreachable!("it is progressive") };
    let method = Method::Ppm(PpmConfig { samples_per_pixel: Some(1), ..plan });
    judge("blurred light", &world, &[method], &[exact.clone(), exact]);
}

/// Soft light of a square lamp, for which samples are spread as evenly as they can be.
#[test]
fn even_light() {
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
    judge("even light", &world, &[path(), light_tracer(None)], &[exact.clone(), exact]);
}

/// The caustic of a glass ball under a point light, which only photons and light paths find.
#[test]
fn caustic() {
    let mut b = Builder::parallel_view(Vec3::new(0.0, 0.2, 0.0), Vec3::ZERO, 0.7, SIDE, SIDE);
    b.white_floor(0.8);
    let glass = b.glass(1.5);
    b.sphere(Vec3::new(0.1, 0.8, 0.0), 0.4, glass);
    b.point_light(Vec3::new(0.3, 3.0, 0.2), 10.0);
    let world = b.build();
    let truths = references(&world, &light_tracer(None));
    judge("caustic", &world, &[Method::Ppm(PpmConfig::default()), light_tracer(None)], &truths);
}

/// A room with a lamp that is seen, and light from wall to wall.
#[test]
fn room() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 1.9), Vec3::ZERO, 60.0, SIDE);
    let (grey, black) = (b.diffuse(0.6), b.diffuse(0.0));
    let glow = b.constant(5.0);
    b.shape(Geometry::Cube, Transform::scale(DVec3::splat(2.0)), grey).flip_normals = true;
    b.sphere(Vec3::new(0.5, 1.2, -0.5), 0.3, black).emission = Some(glow);
    b.sphere(Vec3::new(-0.6, -0.8, -0.4), 0.6, grey);
    let world = b.build();
    let truths = references(&world, &path());
    judge("room", &world, &[path(), Method::Ppm(PpmConfig::default())], &truths);
}

/// Goes on with what a file keeps after every number of steps, and states the same.
#[test]
fn interrupted_renders_state_the_same() {
    let (world, _) = under_a_light(12, 0.7);
    for method in [Method::Ppm(PpmConfig::default()), path(), light_tracer(None)] {
        let mut whole = session(&world, method.clone(), 1);
        let mut parted = session(&world, method.clone(), 1);
        for _ in 0..9 {
            assert!(whole.step(&Silent) && parted.step(&Silent), "nothing cancels");
            let convergence = Convergence::from_numbers(parted.convergence().numbers());
            let (film, place) = (parted.film().clone(), parted.place());
            let again =
                session(&world, method.clone(), 1).with_films(film, None).expect("a film of the same");
            parted = again.starting_at(place).with_convergence(convergence);
            assert_eq!(parted.quality(), whole.quality());
            assert_eq!(parted.error_image(), whole.error_image());
        }
        assert!(whole.quality().is_some_and(|quality| quality.estimates >= 9));
    }
}

#[test]
fn the_photon_mapper_states_nothing() {
    let (world, _) = under_a_light(8, 0.7);
    let mut session = session(&world, Method::default(), 1);
    (0..8).for_each(|_| assert!(session.step(&Silent), "nothing cancels"));
    assert!(session.quality().is_none() && session.error_image().is_none());
}
