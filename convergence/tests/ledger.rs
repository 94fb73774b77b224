//! The books of the photon pass: what every light gave off was absorbed, escaped, was cut off by a
//! limit or is in roulette's column, and the walks of light that cannot get away end all the same.
//!
//! The tests of the file share the level [`ALPHA`] by Šidák's formula; roulette's column is held to 4
//! standard errors, which correct code exceeds once in 16 000 books. On seeds chosen afresh, correct
//! code would fail somewhere in this file with probability 1 %.

use nephroid::camera::Projection;
use nephroid::color::Rgb;
use nephroid::integrator::{DirectSource, Method, PathConfig, PhotonMapperConfig};
use nephroid::light::{EnvironmentMapping, LightKind};
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::{Geometry, Mesh};
use nephroid::texture::Image;
use nephroid::transport::{Balance, DirectLights, Ledger, LightChoice, WalkSettings};
use nephroid::world::World;
use nephroid_convergence::{Builder, means, photons, render};
use nephroid_testkit::{ALPHA, MeanTest, Outcome, binomial_test, sidak};
use std::f64::consts::PI;

/// More than the statistical tests of this file.
const TESTS: usize = 120;

/// Of the sums of single-precision powers over a path.
const ROUNDING: f64 = 1e-5;

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

fn sum(power: [f64; 3]) -> f64 {
    power.iter().sum()
}

/// Every light on its own: nothing but rounding is missing, and roulette was fair.
#[track_caller]
fn expect_balance(world: &World, ledger: &Ledger) {
    for ((name, _), book) in world.lights().zip(&ledger.lights) {
        assert!(sum(book.emitted) > 0.0, "{name} gave off nothing");
        assert!(book.imbalance().abs() < ROUNDING, "{name}: {book:?}");
        assert!(book.roulette_z().abs() < 4.0, "{name}: roulette {}", book.roulette_z());
    }
}

fn octahedron() -> Mesh {
    Mesh {
        positions: vec![Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z],
        triangles: vec![
            [0, 1, 2],
            [1, 3, 2],
            [3, 4, 2],
            [4, 0, 2],
            [1, 0, 5],
            [3, 1, 5],
            [4, 3, 5],
            [0, 4, 5],
        ],
        ..Mesh::default()
    }
}

fn sky_image(b: &mut Builder) -> LightKind {
    let mut image = Image::filled(8, 4, Rgb::BLACK);
    for (i, pixel) in image.pixels.iter_mut().enumerate() {
        *pixel = Rgb::new(0.2, 0.3, 0.5) * (i * 7 % 11) as f32;
    }
    LightKind::Environment {
        mapping: EnvironmentMapping::Equirectangular,
        image: b.scene.textures.images.push(image.into()),
        scale: 0.3,
        to_world: Transform::rotate(DVec3::new(1.0, 2.0, 0.5), 70.0),
    }
}

/// The kinds of lights by name, each added by a function of its own.
type Kind = (&'static str, fn(&mut Builder));

const KINDS: [Kind; 11] = [
    ("point", |b| b.point_light(Vec3::new(0.3, 0.2, 1.5), 2.0)),
    ("spot", |b| {
        let to_world = Transform::look_at(DVec3::new(-0.5, 0.4, 2.0), DVec3::new(0.1, 0.0, 0.0), DVec3::Y)
            .expect("a direction");
        let intensity = Rgb::new(3.0, 2.0, 1.0);
        b.light(LightKind::Spot {
            to_world,
            intensity,
            cutoff_deg: 30.0,
            beam_width_deg: 15.0,
            texture: None,
        });
    }),
    ("directional", |b| {
        let direction = Vec3::new(0.3, 0.2, -1.0).normalize();
        b.light(LightKind::Directional { direction, irradiance: Rgb::new(0.5, 1.0, 1.5) });
    }),
    ("constant", |b| b.light(LightKind::Constant { radiance: Rgb::new(0.4, 0.3, 0.2) })),
    ("environment", |b| {
        let light = sky_image(b);
        b.light(light);
    }),
    ("rectangle", |b| {
        let place = Transform::scale(DVec3::new(0.3, 0.1, 1.0))
            .then(Transform::rotate(DVec3::X, 160.0))
            .then(Transform::translate(DVec3::new(0.5, -0.5, 1.0)));
        lamp(b, Geometry::Rectangle, place);
    }),
    ("disk", |b| {
        let place = Transform::scale(DVec3::new(0.2, 0.3, 1.0))
            .then(Transform::rotate(DVec3::X, 200.0))
            .then(Transform::translate(DVec3::new(-0.6, -0.6, 0.8)));
        lamp(b, Geometry::Disk, place);
    }),
    ("sphere", |b| {
        lamp(b, Geometry::Sphere { center: Vec3::new(0.7, 0.6, 0.7), radius: 0.3 }, Transform::IDENTITY);
    }),
    ("cylinder", |b| {
        let (p0, p1) = (Vec3::new(-0.8, 0.7, 0.6), Vec3::new(-0.2, 0.9, 0.9));
        lamp(b, Geometry::Cylinder { p0, p1, radius: 0.1 }, Transform::IDENTITY);
    }),
    ("cube", |b| {
        let place = Transform::scale(DVec3::splat(0.15))
            .then(Transform::rotate(DVec3::new(1.0, 1.0, 0.3), 50.0))
            .then(Transform::translate(DVec3::new(0.0, -0.1, 0.6)));
        lamp(b, Geometry::Cube, place);
    }),
    ("mesh", |b| {
        let mesh = b.scene.meshes.push(octahedron());
        let place =
            Transform::scale(DVec3::splat(0.2)).then(Transform::translate(DVec3::new(-0.5, 0.0, 1.1)));
        lamp(b, Geometry::Mesh(mesh), place);
    }),
];

/// Adds the kinds of lights that are wanted, by their names.
fn add_all(b: &mut Builder, wanted: impl Fn(&str) -> bool) {
    for (name, add) in KINDS.into_iter().filter(|(name, _)| wanted(name)) {
        let lights = b.scene.lights.len();
        add(b);
        match b.scene.lights.get_mut(lights) {
            Some(light) => light.name = name.into(),
            None => b.scene.shapes.last_mut().expect("a lamp").name = name.into(),
        }
    }
}

fn lamp(b: &mut Builder, geometry: Geometry, to_world: Transform) {
    let (black, glow) = (b.diffuse(0.0), b.constant(3.0));
    b.shape(geometry, to_world, black).emission = Some(glow);
}

const ALBEDO: f32 = 0.5;

/// A matt square [−1, 1]² seen straight from below the lights, so that only it is in the picture.
fn square() -> Builder {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 0.1), Vec3::ZERO, 40.0, 8);
    b.scene.camera.projection = Projection::Orthographic;
    let matt = b.diffuse(ALBEDO);
    b.shape(Geometry::Rectangle, Transform::IDENTITY, matt);
    b
}

/// Flux on the square as the picture shows it: radiance times π/ρ and the area.
fn flux_by_rays(world: &World, direct_lights: DirectLights) -> MeanTest {
    let config = PathConfig { max_depth: Some(2), direct_lights, media: false };
    let radiance = means(world, &Method::Path(config), 16, 0..20);
    radiance.into_iter().map(|l| l * PI / f64::from(ALBEDO) * 4.0).collect()
}

/// Flux on the square by photons that come straight from each light.
fn flux_by_photons(world: &World, light_choice: LightChoice, seeds: std::ops::Range<u64>) -> Vec<MeanTest> {
    let settings = WalkSettings { max_photon_depth: Some(1), light_choice, ..Default::default() };
    let mut tests = vec![MeanTest::new(); world.light_count()];
    for seed in seeds {
        let pass = photons(world, &settings, 11_000, seed);
        let mut flux = vec![0.0; tests.len()];
        for photon in pass.global.as_slice() {
            flux[photon.light as usize] += f64::from(photon.power.mean()) / pass.global.emitted() as f64;
        }
        tests.iter_mut().zip(flux).for_each(|(test, flux)| test.push(flux));
    }
    tests
}

/// Photons of every kind of light are worth what rays to it say.
#[test]
fn photons_and_rays_agree_on_every_kind_of_light() {
    for (name, add) in KINDS {
        let mut b = square();
        add(&mut b);
        let world = b.build();
        let by_photons = flux_by_photons(&world, LightChoice::Power, 0..30);
        judge(name, &by_photons[0].welch(&flux_by_rays(&world, DirectLights::One)));
    }
}

/// All kinds in one scene: the choice among them favours none, for photons and for rays.
#[test]
fn photons_and_rays_agree_on_all_lights_together() {
    let mut b = square();
    add_all(&mut b, |_| true);
    let world = b.build();
    let total = |tests: &[MeanTest]| tests.iter().map(MeanTest::mean).sum::<f64>();
    let by_power = flux_by_photons(&world, LightChoice::Power, 0..30);
    let equally = flux_by_photons(&world, LightChoice::Equal, 30..60);
    for ((light, _), (a, b)) in world.lights().zip(by_power.iter().zip(&equally)) {
        judge(light, &a.welch(b));
    }
    let (one, all) = (flux_by_rays(&world, DirectLights::One), flux_by_rays(&world, DirectLights::All));
    judge("one light and all lights", &one.welch(&all));
    let errors = |tests: &[MeanTest]| tests.iter().map(|t| t.standard_error().powi(2)).sum::<f64>();
    for (name, tests) in [("by power", &by_power), ("equally", &equally)] {
        let error = (errors(tests) + all.standard_error().powi(2)).sqrt();
        judge(name, &nephroid_testkit::z_test(total(tests), all.mean(), error));
    }
}

/// Lights give off the power by which they are chosen.
#[test]
fn lights_emit_the_power_that_they_say() {
    let mut b = square();
    add_all(&mut b, |_| true);
    let world = b.build();
    let settings = WalkSettings { light_choice: LightChoice::Equal, ..Default::default() };
    let mut tests = vec![MeanTest::new(); world.light_count()];
    for seed in 0..30 {
        let books = photons(&world, &settings, 11_000, seed).ledger.per_path();
        tests.iter_mut().zip(&books.lights).for_each(|(t, b)| t.push(sum(b.emitted) / 3.0));
    }
    for ((name, power), test) in world.lights().zip(&tests) {
        // The environment's power is that of its pixels, which interpolation smooths.
        let bias = if name == "environment" { 0.05 } else { ROUNDING };
        judge(name, &test.within(f64::from(power.mean()), bias));
    }
}

/// In the open: every light's books balance, with all kinds of surfaces and a limit of depth.
#[test]
fn the_books_of_every_light_balance() {
    let mut b = square();
    let (glass, mirror) = (b.glass(1.5), b.mirror(0.9));
    b.sphere(Vec3::new(-0.2, -0.6, 0.25), 0.25, glass);
    b.sphere(Vec3::new(0.2, 0.4, 0.2), 0.2, mirror);
    let tint = b.scene.textures.constant(Rgb::new(0.9, 0.5, 0.2));
    let (half, matt) = (b.constant(0.5), b.scene.materials.push(Material::Diffuse { reflectance: tint }));
    let glossy = b.scene.materials.push(Material::Phong {
        diffuse_reflectance: half,
        specular_reflectance: half,
        exponent: 20.0,
    });
    b.sphere(Vec3::new(0.9, -0.9, 0.3), 0.3, matt);
    b.sphere(Vec3::new(-0.9, -0.9, 0.3), 0.3, glossy);
    add_all(&mut b, |_| true);
    let world = b.build();
    for light_choice in [LightChoice::Power, LightChoice::Equal] {
        for max_photon_depth in [None, Some(3)] {
            let settings = WalkSettings { max_photon_depth, light_choice, ..Default::default() };
            let pass = photons(&world, &settings, 55_000, 7);
            expect_balance(&world, &pass.ledger);
            let whole = |part: fn(&Balance) -> [f64; 3]| -> f64 {
                pass.ledger.lights.iter().map(|b| sum(part(b))).sum()
            };
            assert!(whole(|b| b.escaped) > 0.0 && whole(|b| b.absorbed) > 0.0);
            assert_eq!(whole(|b| b.ended) > 0.0, max_photon_depth.is_some());
        }
    }
}

/// In a closed room: nothing escapes, and all is absorbed that roulette did not take.
#[test]
fn a_closed_room_absorbs_what_its_lights_emit() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 0.5), Vec3::ZERO, 40.0, 1);
    let (wall, glass) = (b.diffuse(0.7), b.glass(1.5));
    b.shape(Geometry::Cube, Transform::scale(DVec3::splat(3.0)), wall).flip_normals = true;
    b.sphere(Vec3::new(0.0, -1.0, 1.0), 0.5, glass);
    add_all(&mut b, |kind| !["directional", "constant", "environment"].contains(&kind));
    let world = b.build();
    let pass = photons(&world, &WalkSettings::default(), 80_000, 3);
    expect_balance(&world, &pass.ledger);
    let mut shares = vec![MeanTest::new(); world.light_count()];
    for book in &pass.ledger.lights {
        assert_eq!((sum(book.escaped), sum(book.ended)), (0.0, 0.0), "{book:?}");
    }
    for seed in 0..30 {
        let books = photons(&world, &WalkSettings::default(), 4000, seed).ledger;
        for (share, book) in shares.iter_mut().zip(&books.lights) {
            share.push((sum(book.absorbed) - sum(book.emitted)) / sum(books.lights[0].emitted));
        }
    }
    for ((name, _), share) in world.lights().zip(&shares) {
        judge(name, &share.against(0.0));
    }
}

/// A ball in the sky: the share of the light aimed at a sphere around its box, √3 times its radius,
/// that it absorbs is (1 − ρ)/3, from whatever direction the light comes.
#[test]
fn a_ball_absorbs_its_share_of_the_sky() {
    for (name, add) in &KINDS[2..5] {
        let mut b = Builder::seen_from(Vec3::ZERO, Vec3::X, 40.0, 1);
        let matt = b.diffuse(0.4);
        b.sphere(Vec3::ZERO, 2.0, matt);
        add(&mut b);
        let world = b.build();
        let mut test = MeanTest::new();
        for seed in 0..30 {
            let pass = photons(&world, &WalkSettings::default(), 5000, seed);
            expect_balance(&world, &pass.ledger);
            let book = pass.ledger.per_path().lights[0];
            test.push((sum(book.absorbed) - 0.2 * sum(book.emitted)) / sum(book.emitted));
        }
        judge(name, &test.against(0.0));
    }
}

/// Renders with every integrator, which must come to an end with numbers in every pixel.
#[track_caller]
fn expect_an_end(world: &World) {
    let mapper = |direct| PhotonMapperConfig { direct, emit: Some(500), ..Default::default() };
    let methods = [
        Method::Path(PathConfig::default()),
        Method::PhotonMapper(mapper(DirectSource::Rays)),
        Method::PhotonMapper(mapper(DirectSource::Map)),
    ];
    for method in methods {
        let image = render(world, method, 4, 1);
        assert!(image.pixels.iter().all(|p| p.is_finite() && p.min_channel() >= 0.0));
    }
}

/// Light that leaves the middle of a glass cube in a direction whose largest cosine is below
/// √(1 − 1/n²) is reflected totally for ever; only roulette ends it. The rest gets out.
#[test]
fn a_lamp_in_a_glass_cube_ends() {
    let n = 1.5f64;
    let mut b = Builder::seen_from(Vec3::new(0.1, 0.2, 0.3), Vec3::X, 90.0, 8);
    let glass = b.glass(n as f32);
    b.shape(Geometry::Cube, Transform::IDENTITY, glass);
    b.point_light(Vec3::ZERO, 1.0);
    let world = b.build();
    let mut escaped = MeanTest::new();
    for seed in 0..30 {
        let book = photons(&world, &WalkSettings::default(), 4000, seed).ledger.per_path().lights[0];
        assert!(book.imbalance().abs() < ROUNDING, "{book:?}");
        assert!(sum(book.absorbed).abs() < 1e-3 * sum(book.emitted));
        escaped.push(sum(book.escaped) / sum(book.emitted));
    }
    let exact = 3.0 * (1.0 - (1.0 - 1.0 / (n * n)).sqrt());
    // Just inside the cone light gets out so slowly that roulette makes it noisy without a bound.
    judge("escaped", &escaped.within(exact, 2e-3));
    expect_an_end(&world);
}

/// In a room of albedo 1 photons keep on bouncing; from the 64th bounce on each of them ends with
/// probability 1/20, and the others carry its power.
#[test]
fn photons_in_a_white_room_end() {
    const PATHS: u64 = 4000;
    let mut b = Builder::seen_from(Vec3::new(0.1, 0.2, 0.3), Vec3::X, 90.0, 8);
    let (white, glow) = (b.diffuse(1.0), b.constant(1.0));
    b.shape(Geometry::Cube, Transform::IDENTITY, white).flip_normals = true;
    b.scene.shapes[0].emission = Some(glow);
    let world = b.build();
    let pass = photons(&world, &WalkSettings::default(), PATHS, 1);
    let book = pass.ledger.lights[0];
    assert!(book.imbalance().abs() < ROUNDING, "{book:?}");
    assert!((sum(book.roulette) / sum(book.emitted) - 1.0).abs() < 1e-3, "{book:?}");
    let of = |depth: u16| pass.global.as_slice().iter().filter(move |p| p.depth == depth);
    assert_eq!((of(1).count() as u64, of(65).count() as u64), (PATHS, PATHS));
    for after in [1, 10, 30] {
        let share = libm::pow(0.95, f64::from(after));
        judge(&format!("{after}"), &binomial_test(of(65 + after).count() as u64, PATHS, share));
        let power = f64::from(of(1).next().unwrap().power.mean()) / share;
        assert!(of(65 + after).all(|p| (f64::from(p.power.mean()) / power - 1.0).abs() < 1e-3));
    }
    expect_an_end(&world);
}

/// Between two endless mirrors nothing is ever absorbed and almost nothing escapes.
#[test]
fn light_between_two_mirrors_ends() {
    let mut b = Builder::seen_from(Vec3::new(0.1, 0.2, 0.3), Vec3::X, 90.0, 8);
    let mirror = b.mirror(1.0);
    let down = Transform::rotate(DVec3::X, 180.0).then(Transform::translate(DVec3::new(0.0, 0.0, 1.0)));
    b.shape(Geometry::Plane, Transform::IDENTITY, mirror);
    b.shape(Geometry::Plane, down, mirror);
    b.point_light(Vec3::new(0.0, 0.0, 0.5), 1.0);
    b.sphere(Vec3::new(3.0, 0.0, 0.5), 0.2, mirror);
    let world = b.build();
    let pass = photons(&world, &WalkSettings::default(), 4000, 1);
    let book = pass.ledger.lights[0];
    assert!(book.imbalance().abs() < ROUNDING, "{book:?}");
    assert_eq!(pass.global.stored() + pass.caustic.stored(), 0);
    expect_an_end(&world);
}
