//! Light that media scatter many times: fluence in a medium without bounds, what half spaces send back, and whole
//! renders of a foggy room by photons and by paths.
//!
//! The tests of the file share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct code would fail
//! somewhere in this file with probability 1 %.

use nephroid::color::Rgb;
use nephroid::integrator::{DirectSource, FinalGather, Method, PhotonMapperConfig, VolumeEstimate};
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::medium::{Medium, Phase};
use nephroid::shape::Geometry;
use nephroid::transport::{VolumeKind, WalkSettings};
use nephroid::world::World;
use nephroid_convergence::{
    Builder, collisions, expect_fair_books, forgiving, grey_fog, mean_radiances, photons, volpath,
};
use nephroid_testkit::{ALPHA, MeanTest, Outcome, Tolerance, integrate, sidak};
use std::f64::consts::PI;

/// More than the statistical tests of this file.
const TESTS: usize = 60;

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

/// Grosjean's fluence of an isotropic point source of power 1 in a medium without bounds, isotropic and of albedo a, at a
/// distance in mean free paths (1956; d'Eon and Irving 2011, doi 10.1145/2010324.1964951, section 5):
/// e^(−r)/(4πr²) + 3a/(2−a) e^(−κr)/(4πr), κ² = 3(1−a)/(2−a). Its energy is exact, its values good to about 1 %.
fn grosjean(albedo: f64, r: f64) -> f64 {
    let kappa = (3.0 * (1.0 - albedo) / (2.0 - albedo)).sqrt();
    let scattered = 3.0 * albedo / (2.0 - albedo) * libm::exp(-kappa * r) / (4.0 * PI * r);
    libm::exp(-r) / (4.0 * PI * r * r) + scattered
}

/// What is scattered in a shell is σ_s times the fluence there, σ_s ∫ φ dV; photons carry what is scattered.
/// With mean free paths of half a metre, so that a length that is forgotten shows.
#[test]
fn the_fluence_around_a_point_is_grosjeans() {
    const SIGMA_T: f32 = 2.0;
    for albedo in [0.5, 0.9] {
        let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 0.4), Vec3::ZERO, 40.0, 1);
        b.point_light(Vec3::ZERO, (0.25 / PI) as f32);
        let medium = b.medium(grey_fog(SIGMA_T, albedo, Phase::Isotropic));
        b.fill(medium);
        let world = b.build();
        // Around 1, 2 and 5 mean free paths.
        let shells = [(0.9, 1.1), (1.8, 2.2), (4.5, 5.5)];
        let mut found = [MeanTest::new(); 3];
        let mut absorbed = MeanTest::new();
        let albedo = f64::from(albedo);
        for seed in 0..12 {
            let pass = collisions(&world, &WalkSettings::default(), 4000, seed);
            let share = 1.0 / pass.emitted() as f64;
            let mut sums = [0.0; 3];
            let mut all = 0.0;
            for photon in pass.as_slice() {
                let r = f64::from(photon.position.length() * SIGMA_T);
                let power = f64::from(photon.power.mean()) * share;
                all += power * (1.0 - albedo) / albedo;
                for (sum, (from, to)) in sums.iter_mut().zip(shells) {
                    *sum += if from <= r && r < to { power } else { 0.0 };
                }
            }
            absorbed.push(all);
            found.iter_mut().zip(sums).for_each(|(test, sum)| test.push(sum));
        }
        // All of it is absorbed, where it is.
        judge("energy", &absorbed.within(1.0, 1e-6));
        for (test, (from, to)) in found.iter().zip(shells) {
            let shell = |r: f64| albedo * 4.0 * PI * r * r * grosjean(albedo, r);
            let exact = integrate(shell, &[from, to], Tolerance::relative(1e-9)).value;
            judge(&format!("albedo {albedo}, {from} to {to}"), &test.within(exact, 0.02));
        }
    }
}

/// Chandrasekhar's H function for isotropic scattering at the middles of even steps of μ in (0, 1), and at 1, from
/// 1/H(μ) = √(1−a) + a/2 ∫ ν H(ν)/(μ+ν) dν (*Radiative Transfer*, 1960, § 38), which converges for every a < 1.
struct H {
    albedo: f64,
    values: Vec<f64>,
}

impl H {
    fn new(albedo: f64) -> Self {
        const STEPS: usize = 400;
        let mut h = Self { albedo, values: vec![1.0; STEPS] };
        for _ in 0..60 {
            h.values = (0..STEPS).map(|i| h.at((i as f64 + 0.5) / STEPS as f64)).collect();
        }
        h
    }

    fn at(&self, mu: f64) -> f64 {
        let n = self.values.len() as f64;
        let nodes = self.values.iter().enumerate().map(|(i, h)| ((i as f64 + 0.5) / n, h));
        let sum: f64 = nodes.map(|(nu, h)| nu * h / (mu + nu)).sum();
        1.0 / ((1.0 - self.albedo).sqrt() + 0.5 * self.albedo * sum / n)
    }

    /// What is sent back of light that comes from the direction of cosine `mu0`.
    fn plane_albedo(&self, mu0: f64) -> f64 {
        1.0 - self.at(mu0) * (1.0 - self.albedo).sqrt()
    }

    /// Radiance towards `mu` for an irradiance of 1 on a surface that faces the light: with a flux πF = 1,
    /// I(μ) = a/4 F μ₀/(μ+μ₀) H(μ) H(μ₀).
    fn radiance(&self, mu: f64, mu0: f64) -> f64 {
        self.albedo / (4.0 * PI) * mu0 / (mu + mu0) * self.at(mu) * self.at(mu0)
    }
}

/// Light from a direction of cosine `mu0` onto the half space below z = 0, seen from above along a direction of
/// cosine `mu`.
fn half_space(medium: Medium, mu: f64, mu0: f64) -> World {
    let direction = |mu: f64| Vec3::new((1.0 - mu * mu).sqrt() as f32, 0.0, mu as f32);
    let mut b = Builder::parallel_view(direction(mu) * 5.0, Vec3::ZERO, 0.1, 4, 4);
    b.sunlight(-direction(mu0), 1.0);
    let medium = b.medium(medium);
    b.filled(Geometry::Plane, Transform::IDENTITY, medium);
    b.build()
}

/// The H function is right: its plane albedos at normal incidence are those of the tables, .1152 and .415.
#[test]
fn chandrasekhars_function_has_the_values_of_the_tables() {
    assert!((H::new(0.5).plane_albedo(1.0) - 0.1152).abs() < 1e-4, "{}", H::new(0.5).plane_albedo(1.0));
    assert!((H::new(0.9).plane_albedo(1.0) - 0.415).abs() < 1e-3, "{}", H::new(0.9).plane_albedo(1.0));
}

/// The share of the photons' power that escapes from a half space is its plane albedo.
#[test]
fn half_spaces_send_back_their_plane_albedo() {
    let settings = WalkSettings { aim: false, ..WalkSettings::default() };
    for (albedo, mu0) in [(0.5f32, 1.0), (0.9, 1.0), (0.9, 0.5)] {
        let world = half_space(grey_fog(2.0, albedo, Phase::Isotropic), 1.0, mu0);
        let (mut escaped, mut absorbed) = (MeanTest::new(), MeanTest::new());
        for seed in 0..20 {
            let ledger = photons(&world, &settings, 2000, seed).ledger;
            expect_fair_books(&world, &ledger);
            let book = ledger.lights[0];
            escaped.push(book.escaped[0] / book.emitted[0]);
            absorbed.push(book.absorbed_by_media[0] / book.emitted[0]);
        }
        let exact = H::new(f64::from(albedo)).plane_albedo(mu0);
        judge(&format!("escaped, {albedo} from {mu0}"), &escaped.within(exact, 1e-4));
        judge(&format!("absorbed, {albedo} from {mu0}"), &absorbed.within(1.0 - exact, 1e-4));
    }
}

/// The same seen by paths from the camera in single directions.
#[test]
fn half_spaces_are_seen_as_chandrasekhar_has_them() {
    for (albedo, mu, mu0) in [(0.5f32, 1.0, 1.0), (0.9, 1.0, 1.0), (0.9, 0.4, 0.8)] {
        let world = half_space(grey_fog(2.0, albedo, Phase::Isotropic), mu, mu0);
        let exact = H::new(f64::from(albedo)).radiance(mu, mu0);
        let test: MeanTest = mean_radiances(&world, &volpath(None), 64, 0..20).into_iter().collect();
        judge(&format!("{albedo}, {mu} from {mu0}"), &test.within(exact, 1e-3));
    }
}

/// A room of side 2, filled with fog, with matt walls, a lamp below the ceiling, and a matt ball.
fn foggy_room(medium: Medium) -> World {
    let mut b = Builder::seen_from(Vec3::new(0.0, -0.95, 0.0), Vec3::new(0.0, 1.0, -0.1), 80.0, 8);
    let medium = b.medium(medium);
    let (wall, black, glow) = (b.diffuse(0.6), b.diffuse(0.0), b.constant(5.0));
    let walls = b.shape(Geometry::Cube, Transform::IDENTITY, wall);
    walls.flip_normals = true;
    walls.boundary.exterior = Some(medium);
    b.sphere(Vec3::new(0.3, 0.4, -0.6), 0.4, wall);
    let place = Transform::scale(DVec3::splat(0.4))
        .then(Transform::rotate(DVec3::X, 180.0))
        .then(Transform::translate(DVec3::new(0.0, 0.2, 0.9)));
    b.shape(Geometry::Rectangle, place, black).emission = Some(glow);
    b.build()
}

/// Whole renders of a foggy room by photons have the mean of those by paths, to the 2 % that density estimates may be
/// off at corners and borders: with single scattering by rays and by the map, with and without gather rays, for points and
/// beams. Light that was scattered once and is brought by both would show: it is a third of this picture.
#[test]
fn photons_and_paths_agree_on_a_foggy_room() {
    let forward = Phase::HenyeyGreenstein { g: 0.5 };
    let coloured = Medium::homogeneous("fog", Rgb::new(0.2, 0.6, 1.2), Rgb::new(0.9, 0.8, 0.6), forward);
    for (name, medium) in [("isotropic", grey_fog(0.7, 0.8, Phase::Isotropic)), ("coloured", coloured)] {
        let world = foggy_room(medium);
        let exact = mean_radiances(&world, &volpath(None), 256, 0..10);
        let reference: MeanTest = exact.iter().copied().collect();
        for (kind, estimate, single_scatter, final_gather) in [
            (VolumeKind::Points, VolumeEstimate::Beam, DirectSource::Rays, FinalGather::Auto),
            (VolumeKind::Points, VolumeEstimate::Beam, DirectSource::Map, FinalGather::Off),
            (VolumeKind::Points, VolumeEstimate::March, DirectSource::Rays, FinalGather::Off),
            (VolumeKind::Beams, VolumeEstimate::Beam, DirectSource::Rays, FinalGather::Auto),
            (VolumeKind::Beams, VolumeEstimate::Beam, DirectSource::Map, FinalGather::Off),
        ] {
            let config = PhotonMapperConfig {
                photons: 10_000,
                caustic_photons: 1000,
                neighbours: 30,
                volume_photons: Some(if kind == VolumeKind::Beams { 2000 } else { 20_000 }),
                volume_kind: kind,
                volume_estimate: estimate,
                single_scatter,
                final_gather,
                ..PhotonMapperConfig::default()
            };
            let means = mean_radiances(&world, &Method::PhotonMapper(config), 16, 20..30);
            let test: MeanTest = forgiving(&exact, &means, 0.02).into_iter().collect();
            let case = format!("{name}: {kind:?}, {estimate:?}, {single_scatter:?}, {final_gather:?}");
            judge(&case, &test.welch(&reference));
        }
    }
}
