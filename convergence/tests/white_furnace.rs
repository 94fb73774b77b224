//! Light of radiance 1 from everywhere, on surfaces that absorb nothing: all of them vanish, so every
//! pixel is 1, and n² inside glass of index n. Specular surfaces have to manage that without any
//! noise, pixel by pixel, at the rounding of single precision; for diffuse ones the tests share the
//! level [`ALPHA`] by Šidák's formula: with fresh seeds, correct code would fail with probability 1 %.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::integrator::{DirectSource, FinalGather, Method, PathConfig, PhotonMapperConfig, VcmConfig};
use nephroid::light::LightKind;
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::Geometry;
use nephroid::texture::Image;
use nephroid::world::World;
use nephroid_convergence::{Builder, every_method_but, means, render, session};
use nephroid_testkit::{ALPHA, MeanTest, Outcome, PixelTest, sidak};

/// More than the statistical tests of this file.
const TESTS: usize = 40;

/// For single precision along a path of some tens of surfaces.
const ROUNDING: f64 = 2e-5;

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

fn seen_from(origin: Vec3, target: Vec3, fov_deg: f32, side: u32) -> Builder {
    let mut b = Builder::seen_from(origin, target, fov_deg, side);
    b.light(LightKind::Constant { radiance: Rgb::WHITE });
    b
}

fn photon_mapper(config: PhotonMapperConfig) -> Method {
    Method::PhotonMapper(PhotonMapperConfig { emit: Some(1000), ..config })
}

fn methods() -> Vec<(&'static str, Method)> {
    let mapper = PhotonMapperConfig { emit: Some(1000), ..PhotonMapperConfig::default() };
    let methods = every_method_but(&["volpath", "ppm"], &mapper).into_iter();
    methods.map(|contestant| (contestant.method.name(), contestant.method)).collect()
}

#[track_caller]
fn expect_every_pixel(name: &str, image: &Image, exact: f64) {
    expect_within(name, image, exact, ROUNDING);
}

/// In glass the rays of photon mapping that look for lamps follow what carries less than a 64th by chance: of the 64ths that
/// are left so of a pixel some are won and some lost.
const CHANCE: f64 = 0.03;

fn expect_every_pixel_in_glass(name: &str, image: &Image, exact: f64) {
    let by_chance = ["photonmapper", "ppm", "vcm", "auto"].contains(&name);
    expect_within(name, image, exact, if by_chance { CHANCE } else { ROUNDING });
    let count = image.pixels.len() as f64;
    let mean = image.pixels.iter().map(|pixel| f64::from(pixel.mean())).sum::<f64>() / count;
    assert!((mean / exact - 1.0).abs() < 0.1 * CHANCE, "{name}: the mean is {mean} and not {exact}");
}

fn expect_within(name: &str, image: &Image, exact: f64, tolerance: f64) {
    for (i, pixel) in image.pixels.iter().enumerate() {
        for value in pixel.to_array() {
            let error = (f64::from(value) / exact - 1.0).abs();
            assert!(error < tolerance, "{name}: pixel {i} is {value} and not {exact}");
        }
    }
}

/// Four balls that all but touch, so that paths go from one to the next many times, a disk, a cube,
/// and a tube with its ends in two of the balls.
fn arrangement(material: Handle<Material>, b: &mut Builder) {
    let s = 0.5f32.sqrt();
    for center in
        [Vec3::new(1.0, 0.0, -s), Vec3::new(-1.0, 0.0, -s), Vec3::new(0.0, 1.0, s), Vec3::new(0.0, -1.0, s)]
    {
        b.sphere(center, 0.95, material);
    }
    let tilt = Transform::rotate(DVec3::new(1.0, 1.0, 0.0), 70.0);
    b.shape(Geometry::Disk, tilt.then(Transform::translate(DVec3::new(1.5, 1.5, 0.0))), material);
    let tube = Geometry::Cylinder { p0: Vec3::new(-1.0, 0.0, -s), p1: Vec3::new(0.0, -1.0, s), radius: 0.3 };
    b.shape(tube, Transform::IDENTITY, material);
    let cube = Transform::rotate(DVec3::new(1.0, 2.0, 3.0), 40.0)
        .then(Transform::scale(DVec3::splat(0.4)))
        .then(Transform::translate(DVec3::new(-1.5, 1.8, 0.2)));
    b.shape(Geometry::Cube, cube, material);
}

/// Item 44 of the report: a path that met the mirror again where it left it would go on inside until
/// it is lost, and leave a black dot.
#[test]
fn mirrors_vanish_without_a_black_dot() {
    for scale in [1e-3f32, 1.0, 1e5] {
        let mut b = seen_from(Vec3::new(0.0, 1.0, 9.0) * scale, Vec3::ZERO, 50.0, 64);
        let mirror = b.mirror(1.0);
        let mirror = b.two_sided(mirror);
        arrangement(mirror, &mut b);
        for shape in &mut b.scene.shapes {
            shape.to_world = shape.to_world.then(Transform::scale(DVec3::splat(f64::from(scale))));
        }
        let world = b.build();
        for (name, method) in methods() {
            expect_every_pixel(&format!("{name}, scale {scale}"), &render(&world, method, 4, 1), 1.0);
        }
    }
}

#[test]
fn glass_vanishes_in_every_pixel() {
    let mut b = seen_from(Vec3::new(0.0, 1.0, 9.0), Vec3::ZERO, 50.0, 48);
    let glass = b.glass(1.5);
    arrangement(glass, &mut b);
    // An open tube or disk of glass is no body: light would come out of its index for nothing.
    b.scene.shapes.retain(|s| !matches!(s.geometry, Geometry::Disk | Geometry::Cylinder { .. }));
    let world = b.build();
    for (name, method) in methods() {
        expect_every_pixel_in_glass(name, &render(&world, method, 4, 2), 1.0);
    }
}

#[test]
fn thin_glass_vanishes_in_every_pixel() {
    let mut b = seen_from(Vec3::new(0.0, 1.0, 9.0), Vec3::ZERO, 50.0, 48);
    let one = b.constant(1.0);
    let (specular_reflectance, specular_transmittance) = (one, one);
    let thin =
        Material::ThinDielectric { int_ior: 1.5, ext_ior: 1.0, specular_reflectance, specular_transmittance };
    let thin = b.scene.materials.push(thin);
    arrangement(thin, &mut b);
    let world = b.build();
    for (name, method) in methods() {
        expect_every_pixel_in_glass(name, &render(&world, method, 4, 3), 1.0);
    }
}

/// Radiance is n² times as large in a medium of index n, and 1 again behind it.
#[test]
fn radiance_is_n_squared_inside_glass() {
    for n in [1.33f32, 1.5, 2.4] {
        let mut b = seen_from(Vec3::new(0.1, -0.2, 0.05), Vec3::X, 100.0, 16);
        let glass = b.glass(n);
        b.sphere(Vec3::ZERO, 1.0, glass);
        let world = b.build();
        for (name, method) in methods() {
            expect_every_pixel_in_glass(name, &render(&world, method, 4, 4), f64::from(n * n));
        }
    }
}

/// In a closed room: a wall that emits ½ and reflects ½ has radiance 1 everywhere, and a glass
/// ball in the room changes nothing of that but the n² inside it. Photons cross the ball as they are,
/// whereas radiance is scaled.
#[test]
fn a_glass_ball_in_a_glowing_room_changes_nothing() {
    for (n, origin, exact) in [(1.5f32, Vec3::new(0.2, 0.0, 0.1), 2.25), (1.5, Vec3::new(0.0, 0.0, 1.5), 1.0)]
    {
        let mut b = Builder::seen_from(origin, Vec3::new(0.0, 0.1, -1.0), 100.0, 8);
        let (wall, glass, glow) = (b.diffuse(0.5), b.glass(n), b.constant(0.5));
        let room = b.sphere(Vec3::ZERO, 2.0, wall);
        room.flip_normals = true;
        room.emission = Some(glow);
        b.sphere(Vec3::ZERO, 1.0, glass);
        let world = b.build();
        for (name, method) in methods_of_fixed_radius(0.3) {
            room_test(&format!("{name} from {origin}"), &world, &method, exact);
        }
    }
}

/// Path tracing, photon mapping in all ways to read its maps, and vertex connection and merging.
fn methods_of_fixed_radius(radius: f32) -> Vec<(String, Method)> {
    let mut methods = vec![("path".to_string(), Method::Path(PathConfig::default()))];
    for direct in [DirectSource::Rays, DirectSource::Map] {
        for final_gather in [FinalGather::Off, FinalGather::Rays(2)] {
            let config = PhotonMapperConfig {
                direct,
                final_gather,
                radius: Some(radius),
                emit: Some(2000),
                ..Default::default()
            };
            methods.push((format!("{direct:?} {final_gather:?}"), Method::PhotonMapper(config)));
        }
    }
    let vcm = VcmConfig { light_paths: Some(500), ..VcmConfig::default() };
    methods.push(("vcm".to_string(), Method::Vcm(vcm.clone())));
    methods.push(("vcm that merges".to_string(), Method::Vcm(VcmConfig { connections: false, ..vcm })));
    methods
}

#[track_caller]
fn room_test(name: &str, world: &World, method: &Method, exact: f64) {
    let estimates: MeanTest = means(world, method, 4, 0..30).into_iter().collect();
    judge(name, &estimates.within(exact, ROUNDING));
}

/// A white matt ball and a white matt plane: pixel by pixel within the noise, and in the mean.
#[test]
fn white_matt_surfaces_vanish_in_the_mean() {
    let mut b = seen_from(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 30.0, 16);
    let white = b.diffuse(1.0);
    b.sphere(Vec3::ZERO, 1.0, white);
    // A bowl, in which light is handed on.
    b.sphere(Vec3::new(0.0, 0.0, -4.0), 1.0, white);
    b.shape(Geometry::Plane, Transform::translate(DVec3::new(0.0, 0.0, -5.0)), white);
    let world = b.build();
    let gather = PhotonMapperConfig { final_gather: FinalGather::Rays(2), ..Default::default() };
    let on_one_ball = PhotonMapperConfig { max_depth: Some(2), ..gather };
    let path = Method::Path(PathConfig::default());
    expect_pixels_in_the_noise("path", &world, path, 1024);
    // Photons from an endless plane have nowhere to lie: the ball alone.
    let mut b = seen_from(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 30.0, 16);
    let white = b.diffuse(1.0);
    b.sphere(Vec3::ZERO, 1.0, white);
    expect_pixels_in_the_noise("photon mapper", &b.build(), photon_mapper(on_one_ball), 1024);
}

#[track_caller]
fn expect_pixels_in_the_noise(name: &str, world: &World, method: Method, samples: u32) {
    let session = session(world, method, samples, 5);
    let film = session.film();
    let luminance: Vec<f32> = film.develop().pixels.iter().map(|p| p.luminance()).collect();
    let variance: Vec<f32> = film.variance().iter().map(|&v| v as f32).collect();
    let test = PixelTest { outliers: 0.0, relative_bias: ROUNDING };
    judge(name, &test.run(&luminance, &vec![1.0; luminance.len()], &variance));
}

/// Photons from the sky: direct light of the map on a ball, where their density is uniform.
#[test]
fn photons_from_the_sky_light_a_white_ball_to_one() {
    let mut b = seen_from(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 10.0, 8);
    let white = b.diffuse(1.0);
    b.sphere(Vec3::ZERO, 1.0, white);
    let world = b.build();
    for radius in [None, Some(0.2)] {
        let config = PhotonMapperConfig {
            direct: DirectSource::Map,
            emit: Some(100_000),
            neighbours: 30,
            radius,
            ..Default::default()
        };
        room_test(&format!("radius {radius:?}"), &world, &Method::PhotonMapper(config), 1.0);
    }
}

/// Nothing but an infinite plane has no bounds to aim a sky at; it is lit by it all the same, and
/// reflects its albedo.
#[test]
fn a_lone_infinite_plane_under_a_sky_reflects_its_albedo() {
    for (name, method) in methods() {
        let mut b = seen_from(Vec3::new(0.0, 0.0, 1.0), Vec3::ZERO, 20.0, 8);
        let grey = b.diffuse(0.5);
        b.shape(Geometry::Plane, Transform::IDENTITY, grey);
        let world = b.build();
        let mean: MeanTest =
            (0..16).map(|seed| f64::from(render(&world, method.clone(), 64, seed).mean().g)).collect();
        judge(name, &mean.against(0.5));
    }
}
