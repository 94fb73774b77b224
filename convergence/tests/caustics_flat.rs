//! Caustics of flat surfaces: the floor below a glass plate, the floor of a pool, and the light a
//! plane mirror throws back.
//!
//! All tests together reject a correct program with a probability of [`ALPHA`]; seeds are fixed.

use std::f64::consts::PI;

use nephroid::color::Rgb;
use nephroid::integrator::{Method, PhotonMapperConfig, Show};
use nephroid::light::LightKind;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_convergence::{
    Builder, blurred, derivative, fresnel, light_tracer, map_view, mean_radiances, path, pixel_origins,
    renders, root,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// Rings about the axis, of equal area and up to the radius 1, whose mean each test looks at.
const RINGS: usize = 4;
/// The plate and the pool by a fixed radius, by neighbours and by light tracing; the mirror, where one sum is tested and
/// not rings, the same; and the pool from above.
const TESTS: usize = 6 * RINGS + 3 + 1;

fn level() -> f64 {
    sidak(ALPHA, TESTS)
}

/// Reflectance of floors.
const ALBEDO: f64 = 0.5;
const INDEX: f64 = 1.5;
/// Height of the light over the floor.
const HEIGHT: f64 = 2.0;
/// Half the angle of the lamp's cone, within which it is a point light of 1 W/sr.
const CUTOFF: f64 = 50.0;

fn square(half: f64, y: f64) -> Transform {
    Transform::scale(DVec3::splat(half))
        .then(Transform::rotate(DVec3::X, -90.0))
        .then(Transform::translate(DVec3::new(0.0, y, 0.0)))
}

/// A grey floor, seen straight down from height `eye` over |x|, |z| ≤ 1.
fn floor(eye: f32) -> Builder {
    let mut b = Builder::parallel_view(Vec3::new(0.0, eye, 0.0), Vec3::ZERO, 1.0, 32, 32);
    let grey = b.diffuse(ALBEDO as f32);
    b.shape(Geometry::Rectangle, square(8.0, 0.0), grey);
    b
}

/// A lamp at (0, [`HEIGHT`], 0) that shines down, with the intensity 1 up to [`CUTOFF`]: where the
/// floor is looked at there is no telling it from a point light, and no photon flies up.
fn lamp(b: &mut Builder) {
    let at = DVec3::new(0.0, HEIGHT, 0.0);
    let to_world = Transform::look_at(at, DVec3::ZERO, DVec3::Z).expect("the light looks down");
    b.light(LightKind::Spot {
        to_world,
        intensity: Rgb::WHITE,
        cutoff_deg: CUTOFF as f32,
        beam_width_deg: CUTOFF as f32,
        texture: None,
    });
}

/// The plate lies between y = 1 and 1.5.
const PLATE: (f64, f64) = (1.0, 1.5);

fn under_a_plate(light: impl FnOnce(&mut Builder)) -> World {
    let mut b = floor(0.7);
    let glass = b.glass(INDEX as f32);
    let (low, high) = PLATE;
    let to_world = Transform::scale(DVec3::new(8.0, 0.5 * (high - low), 8.0))
        .then(Transform::translate(DVec3::new(0.0, 0.5 * (low + high), 0.0)));
    b.shape(Geometry::Cube, to_world, glass);
    light(&mut b);
    b.build()
}

/// Water of index [`INDEX`] up to y = 1, as wide as the floor.
const DEPTH: f64 = 1.0;

fn pool(eye: f32) -> World {
    let mut b = floor(eye);
    let water = b.glass(INDEX as f32);
    b.shape(Geometry::Rectangle, square(8.0, DEPTH), water);
    lamp(&mut b);
    b.build()
}

/// E(r) = T sin t / (r dr/dt), for light of 1 W/sr that leaves at the angle t to the axis and lands at
/// `landing(t)`, `transmitted(sin t)` of it; t is found by bisection.
fn by_jacobian(landing: impl Fn(f64) -> f64, transmitted: impl Fn(f64) -> f64, r: f64) -> f64 {
    let r = r.max(1e-4);
    let t = root(|t| landing(t) - r, 1e-9, 0.5 * PI - 1e-9);
    let sin = libm::sin(t);
    transmitted(sin) * sin / (r * derivative(&landing, t, 1e-4 * t))
}

/// tan t in air plus tan t′ in glass, by their heights.
fn refracted_reach(t: f64, air: f64, glass: f64) -> f64 {
    let sin = libm::sin(t) / INDEX;
    air * libm::tan(t) + glass * sin / (1.0 - sin * sin).sqrt()
}

/// Irradiance below the plate: light reflected 2m times in it has passed it 1 + 2m times and carries
/// (1 − F)² F^2m.
fn below_plate(r: f64, orders: i32) -> f64 {
    let thick = PLATE.1 - PLATE.0;
    let order = |m: i32| {
        let landing = |t| refracted_reach(t, HEIGHT - thick, f64::from(1 + 2 * m) * thick);
        let share = |sin| {
            let f = fresnel(sin, INDEX);
            (1.0 - f) * (1.0 - f) * f.powi(2 * m)
        };
        by_jacobian(landing, share, r)
    };
    (0..orders).map(order).sum()
}

/// Irradiance on the floor of the pool. Power crosses the water's surface as it is, but for what is
/// reflected: there is no n² in it.
fn in_pool(r: f64) -> f64 {
    by_jacobian(|t| refracted_reach(t, HEIGHT - DEPTH, DEPTH), |sin| 1.0 - fresnel(sin, INDEX), r)
}

/// How a map is read: with a fixed radius, whose expectation is known, or by neighbours within an
/// allowance for their bias.
#[derive(Clone, Copy)]
enum Reading {
    Fixed(f64),
    Nearest { k: u32, bias: f64 },
}

impl Reading {
    fn method(self, show: Show, paths: u64) -> Method {
        let config = map_view(show, paths);
        Method::PhotonMapper(match self {
            Self::Fixed(radius) => PhotonMapperConfig { radius: Some(radius as f32), ..config },
            Self::Nearest { k, .. } => PhotonMapperConfig { neighbours: k, ..config },
        })
    }

    /// The expectation of the irradiance at (x, z), and the relative bias to allow on it: pixels 1/16
    /// wide add E″/24 · 4e-3, below 3e-4.
    fn expectation(self, exact: impl Fn(f64, f64) -> f64, p: DVec3) -> f64 {
        match self {
            Self::Fixed(r) => blurred(exact, p.x, p.z, r),
            Self::Nearest { .. } => exact(p.x, p.z),
        }
    }

    fn bias(self) -> f64 {
        match self {
            Self::Fixed(_) => 3e-4,
            Self::Nearest { bias, .. } => bias + 3e-4,
        }
    }
}

/// With 100 000 paths in a cone of 2.24 sr, 10 000 photons a m² or so land where the floor is looked
/// at; k = 100 lie within r = .056, the Laplacian of E over E is below 6, and r²/12 of it 1.6e-3.
const READINGS: [Reading; 2] = [Reading::Fixed(0.1), Reading::Nearest { k: 100, bias: 2e-3 }];

/// A function of the distance from the axis, by a table.
fn around_axis(irradiance: impl Fn(f64) -> f64) -> impl Fn(f64, f64) -> f64 {
    let table: Vec<f64> = (0..=2000).map(|i| irradiance(f64::from(i) * 1e-3)).collect();
    move |x, z| {
        let r = (x * x + z * z).sqrt() * 1e3;
        let i = r as usize;
        table[i] + (r - i as f64) * (table[i + 1] - table[i])
    }
}

/// Tests the caustic light in rings around the axis, each render's mean of measured over expected.
fn test_rings(world: &World, irradiance: impl Fn(f64) -> f64) {
    let exact = around_axis(irradiance);
    for reading in READINGS {
        let pictures = renders(world, &reading.method(Show::Caustic, 100_000), 2, 1..17);
        judge_rings(world, &pictures, |p| reading.expectation(&exact, p), reading.bias());
    }
}

fn judge_rings(world: &World, pictures: &[Vec<f64>], expected: impl Fn(DVec3) -> f64, bias: f64) {
    let expected: Vec<(usize, f64)> = pixel_origins(world)
        .into_iter()
        .map(|p| (((p.x * p.x + p.z * p.z) * RINGS as f64) as usize, expected(p)))
        .collect();
    for ring in 0..RINGS {
        let ratio = |picture: &Vec<f64>| {
            let pixels = picture.iter().zip(&expected).filter(|(_, e)| e.0 == ring);
            let (sum, of) = pixels.fold((0.0, 0.0), |(s, o), (l, e)| (s + l * PI / ALBEDO, o + e.1));
            sum / of
        };
        let test: MeanTest = pictures.iter().map(ratio).collect();
        test.within(1.0, bias).assert_passes(level());
    }
}

/// The numbers known of old: E(0) is I n² T / (n (h − d) + d)² for one passage, and .22118 where t = .4.
#[test]
fn the_plates_jacobian_has_the_values_known() {
    let axis = 0.96f64 * 0.96 / (1.5f64 + 0.5 / INDEX).powi(2);
    assert!((axis - 0.274_20).abs() < 5e-6);
    assert!((below_plate(0.0, 1) / axis - 1.0).abs() < 1e-6);
    assert!((below_plate(0.768_605, 1) - 0.221_180).abs() < 1e-6);
    assert!((below_plate(0.5, 8) - 0.249_81).abs() < 5e-6);
}

/// Light below a glass plate under a lamp, all orders of reflection in the glass.
#[test]
fn a_glass_plate_concentrates_light_by_its_jacobian() {
    test_rings(&under_a_plate(lamp), |r| below_plate(r, 4));
}

/// Light tracing blurs nothing. Paths are cut off before light is reflected in the glass twice, or thrown back to the
/// floor: after L S S D E of the plate, and L S D E of the pool.
#[test]
fn light_tracing_finds_the_same() {
    let plate = around_axis(|r| below_plate(r, 1));
    let pool_floor = around_axis(in_pool);
    for (world, exact, max_depth) in
        [(under_a_plate(lamp), &plate as &dyn Fn(f64, f64) -> f64, 5), (pool(0.7), &pool_floor, 4)]
    {
        let pictures = renders(&world, &light_tracer(Some(max_depth)), 48, 41..57);
        judge_rings(&world, &pictures, |p| exact(p.x, p.z), 3e-4);
    }
}

/// To next event estimation the glass is in the way: paths from the camera that meet no light by
/// chance, and nobody meets a point, see exactly nothing.
#[test]
fn path_tracing_sees_nothing_of_it() {
    let world = under_a_plate(|b| b.point_light(Vec3::new(0.0, HEIGHT as f32, 0.0), 1.0));
    let direct = Method::PhotonMapper(PhotonMapperConfig { show: Show::Direct, ..Default::default() });
    for method in [path(), direct] {
        assert_eq!(mean_radiances(&world, &method, 16, 1..2), [0.0]);
    }
}

/// The floor of a pool: a factor n² on photons would show here, where they do not leave the water.
#[test]
fn power_crosses_the_surface_of_a_pool_without_a_factor() {
    test_rings(&pool(0.7), in_pool);
}

/// From above, at normal incidence, the floor's radiance is (1 − F) / n² of that in the water.
#[test]
fn radiance_leaves_the_pool_divided_by_the_square_of_the_index() {
    let reading = Reading::Fixed(0.1);
    let world = pool(1.5);
    let origins = pixel_origins(&world);
    let exact = |x: f64, z: f64| in_pool((x * x + z * z).sqrt());
    let sum: f64 = origins.iter().map(|&p| reading.expectation(exact, p)).sum();
    let radiance = 0.96 / (INDEX * INDEX) * ALBEDO / PI * sum / origins.len() as f64;
    let radiances = mean_radiances(&world, &reading.method(Show::Caustic, 100_000), 2, 21..37);
    let test: MeanTest = radiances.into_iter().collect();
    test.within(radiance, reading.bias()).assert_passes(level());
}

/// A mirror of reflectance .8 in the plane x = −1.2 shows the light at (0, 1, 0) once more at
/// (−2.4, 1, 0): the caustic map holds that light, next event estimation the rest.
#[test]
fn a_plane_mirror_is_a_second_light() {
    let mut b = floor(0.7);
    let mirror = b.mirror(0.8);
    let to_world = Transform::scale(DVec3::splat(3.0))
        .then(Transform::rotate(DVec3::Y, 90.0))
        .then(Transform::translate(DVec3::new(-1.2, 3.0, 0.0)));
    b.shape(Geometry::Rectangle, to_world, mirror);
    b.point_light(Vec3::Y, 1.0);
    let world = b.build();
    let from = |light_x: f64, x: f64, z: f64| {
        let distance_sq = (x - light_x) * (x - light_x) + 1.0 + z * z;
        1.0 / (distance_sq * distance_sq.sqrt())
    };
    let origins = pixel_origins(&world);
    let mean = |f: &dyn Fn(DVec3) -> f64| origins.iter().map(|&p| f(p)).sum::<f64>() / origins.len() as f64;
    let image = |x, z| 0.8 * from(-2.4, x, z);
    let direct = mean(&|p| from(0.0, p.x, p.z));
    for (reading, show, direct) in [
        (READINGS[0], Show::Caustic, 0.0),
        (READINGS[1], Show::Caustic, 0.0),
        (READINGS[0], Show::All, direct),
    ] {
        let exact = direct + mean(&|p| reading.expectation(image, p));
        let radiances = mean_radiances(&world, &reading.method(show, 100_000), 4, 1..17);
        let test: MeanTest = radiances.into_iter().map(|l| PI / ALBEDO * l).collect();
        test.within(exact, reading.bias()).assert_passes(level());
    }
}
