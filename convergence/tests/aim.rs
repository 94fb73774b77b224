//! Aimed photons are worth what those are that go everywhere, and the books close over both.
//!
//! The tests of the file share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct
//! code would fail somewhere in this file with probability 1 %.

use nephroid::color::Rgb;
use nephroid::integrator::{Method, PathConfig, PhotonMapperConfig};
use nephroid::light::{EnvironmentMapping, LightKind};
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::observer::Silent;
use nephroid::photon_map::Photons;
use nephroid::session::{RenderSettings, Session};
use nephroid::shape::{Geometry, Mesh};
use nephroid::texture::Image;
use nephroid::transport::{LightChoice, PhotonPlan, WalkSettings};
use nephroid::world::World;
use nephroid_convergence::{Builder, means, photons};
use nephroid_testkit::{ALPHA, MeanTest, Outcome, sidak};

/// More than the statistical tests of this file.
const TESTS: usize = 300;

/// Of the sums of single-precision powers over a path.
const ROUNDING: f64 = 1e-5;

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
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

fn place(scale: f64, angle: f64, at: [f64; 3]) -> Transform {
    Transform::scale(DVec3::splat(scale))
        .then(Transform::rotate(DVec3::new(1.0, 0.6, 0.2), angle))
        .then(Transform::translate(DVec3::from_array(at)))
}

/// A floor, a matt ball, and glass and mirrors of which some lie behind others, seen from so far away
/// that the skies' whole sphere is much larger than what is in it. Something invisible lies over it.
fn still_life() -> Builder {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 20.0), Vec3::ZERO, 40.0, 1);
    let (matt, glass, mirror) = (b.diffuse(0.5), b.glass(1.5), b.mirror(0.9));
    let both = b.two_sided(mirror);
    b.shape(Geometry::Rectangle, Transform::IDENTITY, matt);
    b.sphere(Vec3::new(-0.6, -0.6, 0.2), 0.2, matt);
    b.sphere(Vec3::new(0.3, 0.2, 0.5), 0.3, glass);
    b.sphere(Vec3::new(0.2, 0.0, 1.1), 0.25, glass);
    b.shape(Geometry::Disk, place(0.3, 30.0, [-0.5, 0.5, 0.6]), both);
    let mesh = b.scene.meshes.push(octahedron());
    b.shape(Geometry::Mesh(mesh), place(0.25, 20.0, [0.6, -0.6, 0.4]), glass);
    let null = b.scene.materials.push(Material::Null);
    b.sphere(Vec3::new(0.2, 0.1, 1.2), 0.8, null);
    b
}

fn glow(b: &mut Builder, geometry: Geometry, to_world: Transform) {
    let black = b.diffuse(0.0);
    let light = b.scene.textures.constant(Rgb::new(3.0, 2.0, 1.0));
    b.shape(geometry, to_world, black).emission = Some(light);
}

fn spot(b: &mut Builder, from: DVec3, to: DVec3) {
    b.light(LightKind::Spot {
        to_world: Transform::look_at(from, to, DVec3::Y).expect("a direction"),
        intensity: Rgb::new(3.0, 2.0, 1.0),
        cutoff_deg: 50.0,
        beam_width_deg: 15.0,
        texture: None,
    });
}

/// A kind of light by name, added by a function of its own.
type Kind = (&'static str, fn(&mut Builder));

const KINDS: [Kind; 14] = [
    ("point", |b| {
        let intensity = Rgb::new(2.0, 1.0, 3.0);
        b.light(LightKind::Point { position: Vec3::new(2.0, -1.0, 6.0), intensity });
    }),
    ("spot", |b| spot(b, DVec3::new(-2.0, 1.0, 6.0), DVec3::ZERO)),
    ("spot at the edge", |b| spot(b, DVec3::new(0.0, 0.5, 5.0), DVec3::new(5.0, 0.0, 0.5))),
    ("directional", |b| {
        let direction = Vec3::new(0.3, 0.2, -1.0).normalize();
        b.light(LightKind::Directional { direction, irradiance: Rgb::new(0.5, 1.0, 1.5) });
    }),
    ("constant", |b| b.light(LightKind::Constant { radiance: Rgb::new(0.4, 0.3, 0.2) })),
    ("environment", |b| {
        let mut image = Image::filled(8, 4, Rgb::BLACK);
        for (i, pixel) in image.pixels.iter_mut().enumerate() {
            *pixel = Rgb::new(0.2, 0.3, 0.5) * (i * 7 % 11) as f32;
        }
        let image = b.scene.textures.images.push(image.into());
        let to_world = Transform::rotate(DVec3::new(1.0, 2.0, 0.5), 70.0);
        b.light(LightKind::Environment {
            mapping: EnvironmentMapping::Equirectangular,
            image,
            scale: 0.3,
            to_world,
        });
    }),
    ("rectangle", |b| glow(b, Geometry::Rectangle, place(0.5, 160.0, [0.5, -1.5, 6.0]))),
    ("disk", |b| glow(b, Geometry::Disk, place(0.7, 200.0, [-1.5, -0.5, 5.0]))),
    ("ball", |b| {
        glow(b, Geometry::Sphere { center: Vec3::ZERO, radius: 0.4 }, place(1.0, 0.0, [2.0, 1.0, 5.0]));
    }),
    ("ball among the glass", |b| {
        glow(b, Geometry::Sphere { center: Vec3::ZERO, radius: 0.15 }, place(1.0, 0.0, [-0.3, 0.1, 0.9]));
    }),
    ("hollow ball", |b| {
        glow(b, Geometry::Sphere { center: Vec3::ZERO, radius: 8.0 }, Transform::IDENTITY);
        b.scene.shapes.last_mut().expect("just added").flip_normals = true;
    }),
    ("cylinder", |b| {
        let (p0, p1) = (Vec3::new(-0.8, 1.7, 5.6), Vec3::new(-0.2, 1.9, 5.9));
        glow(b, Geometry::Cylinder { p0, p1, radius: 0.2 }, Transform::IDENTITY);
    }),
    ("cube", |b| glow(b, Geometry::Cube, place(0.3, 50.0, [1.0, -0.1, 5.0]))),
    ("mesh", |b| {
        let mesh = b.scene.meshes.push(octahedron());
        glow(b, Geometry::Mesh(mesh), place(0.4, 0.0, [-1.0, 0.0, 5.1]));
    }),
];

/// Flux in W of each channel, and of all on one side of the scene.
fn fluxes(photons: &Photons) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for photon in photons.as_slice() {
        let power = photon.power.to_array().map(f64::from);
        sum.iter_mut().zip(power).for_each(|(s, p)| *s += p);
        if photon.position.x > photon.position.y {
            sum[3] += power.iter().sum::<f64>();
        }
    }
    sum.map(|s| s / photons.emitted() as f64)
}

/// Flux of the global map and of the caustic map, by passes of different seeds; their books are checked.
fn flux(world: &World, aim: bool, paths: u64, light_choice: LightChoice) -> [MeanTest; 8] {
    let settings = WalkSettings { aim, light_choice, ..Default::default() };
    let mut tests = [MeanTest::new(); 8];
    for seed in 0..24 {
        let pass = photons(world, &settings, paths, seed + 100 * u64::from(aim));
        for book in &pass.ledger.lights {
            assert!(book.imbalance().abs() < ROUNDING, "{book:?}");
            assert!(book.roulette_z().abs() < 4.5, "roulette {}", book.roulette_z());
        }
        let values = [fluxes(&pass.global), fluxes(&pass.caustic)].concat();
        tests.iter_mut().zip(values).for_each(|(test, value)| test.push(value));
    }
    tests
}

const QUANTITIES: [&str; 8] = [
    "global red",
    "global green",
    "global blue",
    "global on one side",
    "caustic red",
    "caustic green",
    "caustic blue",
    "caustic on one side",
];

#[track_caller]
fn expect_the_same(name: &str, world: &World) {
    let everywhere = flux(world, false, 20_000, LightChoice::Power);
    let aimed = flux(world, true, 2000, LightChoice::Power);
    for ((quantity, a), b) in QUANTITIES.into_iter().zip(&everywhere).zip(&aimed) {
        assert!(a.mean() > 0.0 && b.mean() > 0.0, "{name}: no {quantity}");
        judge(&format!("{name}, {quantity}"), &a.welch(b));
    }
}

#[test]
fn aimed_photons_are_worth_the_same_for_every_kind_of_light() {
    for (name, add) in KINDS {
        let mut b = still_life();
        add(&mut b);
        expect_the_same(name, &b.build());
    }
}

/// Lights that see no glass, or hardly send anything, are chosen rarely and never left out.
#[test]
fn aimed_photons_are_worth_the_same_for_many_lights() {
    let mut b = still_life();
    KINDS.into_iter().filter(|(name, _)| !name.contains("ball")).for_each(|(_, add)| add(&mut b));
    spot(&mut b, DVec3::new(-3.0, 0.0, 0.5), DVec3::new(-9.0, 0.0, 0.5));
    let world = b.build();
    expect_the_same("all", &world);
    let (by_power, equally) =
        (flux(&world, true, 2000, LightChoice::Power), flux(&world, true, 6600, LightChoice::Equal));
    for ((quantity, a), b) in QUANTITIES.into_iter().zip(&by_power).zip(&equally) {
        judge(&format!("equally, {quantity}"), &a.welch(b));
    }
}

/// A lamp in a shell of glass, and beside it a mirror that only light from the shell can meet.
#[test]
fn aimed_photons_are_worth_the_same_from_within_glass() {
    let mut b = still_life();
    let glass = b.glass(1.5);
    let center = Vec3::new(0.0, 0.5, 3.0);
    b.sphere(center, 0.5, glass);
    b.sphere(center, 0.4, glass).flip_normals = true;
    glow(&mut b, Geometry::Sphere { center, radius: 0.1 }, Transform::IDENTITY);
    expect_the_same("lamp in a shell", &b.build());
}

/// What is infinite lies in no bounds, whether it is matt or a mirror.
#[test]
fn aimed_photons_do_not_miss_planes() {
    for (name, specular) in [("matt plane", false), ("mirror plane", true)] {
        for (light, add) in [KINDS[0], KINDS[3], KINDS[8]] {
            let mut b = still_life();
            let material = if specular { b.mirror(0.8) } else { b.diffuse(0.6) };
            let below = Transform::translate(DVec3::new(0.0, 0.0, -1.0));
            b.shape(Geometry::Plane, below, material);
            add(&mut b);
            expect_the_same(&format!("{name}, {light}"), &b.build());
        }
    }
}

/// A plane beyond the bounds of all else shades photons of the sun as it does rays to it.
#[test]
fn planes_outside_the_bounds_shade_photons_as_they_shade_rays() {
    let shaded = |above: bool| {
        let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 0.5), Vec3::ZERO, 40.0, 4);
        let matt = b.diffuse(0.5);
        let both = b.two_sided(matt);
        b.shape(Geometry::Rectangle, Transform::IDENTITY, matt);
        let height = if above { 50.0 } else { -50.0 };
        b.shape(Geometry::Plane, Transform::translate(DVec3::new(0.0, 0.0, height)), both);
        KINDS[3].1(&mut b);
        let world = b.build();
        let seen = means(&world, &Method::Path(PathConfig::default()), 4, 0..1)[0];
        let landed = |aim| {
            let settings = WalkSettings { aim, max_photon_depth: Some(1), ..Default::default() };
            let pass = photons(&world, &settings, 2000, 1);
            pass.global.as_slice().iter().filter(|p| p.position.z.abs() < 1.0).count()
        };
        (seen > 0.0, landed(true) > 0, landed(false) > 0)
    };
    assert_eq!(shaded(true), (false, false, false));
    assert_eq!(shaded(false), (true, true, true));
}

/// What photons of one light carry is the same wherever the balls they are aimed at overlap.
#[test]
fn aimed_photons_of_a_point_light_all_carry_the_same() {
    let mut b = still_life();
    KINDS[0].1(&mut b);
    let settings = WalkSettings { max_photon_depth: Some(2), ..Default::default() };
    let pass = photons(&b.build(), &settings, 4000, 1);
    let direct: Vec<f32> =
        pass.global.as_slice().iter().filter(|p| p.depth == 1).map(|p| p.power.g).collect();
    assert!(direct.len() > 1000 && direct.iter().all(|p| (p / direct[0] - 1.0).abs() < 1e-5));
}

fn plan(world: &World, aim: bool) -> PhotonPlan {
    let config = PhotonMapperConfig { aim, emit_max: 1_000_000, ..Default::default() };
    let settings = RenderSettings { method: Method::PhotonMapper(config), samples_per_pixel: 1, seed: 1 };
    Session::new(world, settings, &Silent).plan().photons
}

/// Water over a floor under a small lamp so far away that it sends a hundredth of its light there.
#[test]
fn a_far_lamp_emits_no_photons_past_the_scene() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 2.6, 3.5), Vec3::ZERO, 40.0, 1);
    let (matt, glass) = (b.diffuse(0.75), b.glass(1.33));
    let square = |z| Transform::scale(DVec3::splat(2.0)).then(Transform::translate(DVec3::new(0.0, 0.0, z)));
    b.shape(Geometry::Rectangle, square(-1.0), matt);
    b.shape(Geometry::Rectangle, square(0.0), glass);
    glow(
        &mut b,
        Geometry::Sphere { center: Vec3::ZERO, radius: 0.5 },
        Transform::translate(DVec3::new(3.0, -2.0, 9.0)),
    );
    let world = b.build();
    let (everywhere, aimed) = (plan(&world, false), plan(&world, true));
    assert!(aimed.global.paths * 20 < everywhere.global.paths, "{aimed:?} {everywhere:?}");
    assert!(aimed.caustic.paths * 20 < everywhere.caustic.paths, "{aimed:?} {everywhere:?}");
}

/// Nothing is lit indirectly here: the trial paths find nothing, and no more than they are emitted.
#[test]
fn a_map_that_trial_paths_do_not_reach_gets_no_more_of_them() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 2.6, 3.5), Vec3::ZERO, 40.0, 1);
    let matt = b.diffuse(0.75);
    b.shape(Geometry::Rectangle, Transform::IDENTITY, matt);
    b.point_light(Vec3::new(0.0, 0.0, 1.0), 1.0);
    let plan = plan(&b.build(), true).global;
    assert!((200_000..=1 << 18).contains(&plan.paths) && plan.limited, "{plan:?}");
}
