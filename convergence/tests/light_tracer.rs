//! Light tracing against closed forms, and what it promises besides: bits, depth, and what it leaves out.
//!
//! All tests together reject a correct program with a probability of [`ALPHA`]; seeds are fixed.

use std::f64::consts::PI;

use nephroid::camera::{FovAxis, Projection};
use nephroid::color::Rgb;
use nephroid::film::{Crop, Film, Filter};
use nephroid::integrator::{LightTracerConfig, Method};
use nephroid::math::{DVec3, Transform, Vec2, Vec3};
use nephroid::medium::Phase;
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_convergence::{
    Builder, block_samples, facing, foggy_niche, grey_fog, light_tracer, path, polygon_irradiance, renders,
    session,
};
use nephroid_testkit::{ALPHA, MeanTest, Tolerance, integrate, sidak};

/// Pixels of a picture's side, and of a block's.
const SIDE: u32 = 16;
const BLOCK: usize = 4;
const BLOCKS: usize = 16;

/// Pictures of which every block is tested, and the fog, one mean.
const TESTS: usize = 5 * BLOCKS + 1;

fn level() -> f64 {
    sidak(ALPHA, TESTS)
}

const ALBEDO: f64 = 0.5;
const HEIGHT: f64 = 1.5;
/// Half the width of the floor that is seen.
const HALF: f64 = 1.0;

/// A floor seen straight down from a pinhole, from which the picture's side spans 2 · [`HALF`].
fn floor() -> Builder {
    let fov = 2.0 * libm::atan(HALF / HEIGHT).to_degrees();
    let mut b = Builder::seen_from(Vec3::Y * HEIGHT as f32, Vec3::ZERO, fov as f32, SIDE);
    let grey = b.diffuse(ALBEDO as f32);
    b.shape(Geometry::Rectangle, facing(DVec3::ZERO, 1.3, DVec3::X, -90.0), grey);
    b
}

/// Tests the means of blocks against those of `irradiance` at points of the floor, 64 for each block.
fn judge_floor(world: &World, irradiance: impl Fn(DVec3) -> f64) {
    let pictures = renders(world, &light_tracer(None), 256, 1..17);
    let to_world = world.scene().camera.to_world;
    let blocks = block_samples(&pictures, SIDE as usize, BLOCK);
    for (i, block) in blocks.iter().enumerate() {
        let place = |block: usize, k: usize| (block as f64 * 8.0 + k as f64 + 0.5) / 32.0;
        let points = (0..64).map(|k| {
            let (x, y) = (place(i % 4, k % 8), place(i / 4, k / 8));
            let local = DVec3::new((1.0 - 2.0 * x) * HALF, (1.0 - 2.0 * y) * HALF, HEIGHT);
            irradiance(to_world.0.transform_point3(local))
        });
        let exact = ALBEDO / PI * points.sum::<f64>() / 64.0;
        let test: MeanTest = block.iter().copied().collect();
        test.within(exact, 5e-4).assert_passes(level());
    }
}

#[test]
fn a_point_light_above_a_floor() {
    let mut b = floor();
    let lamp = DVec3::new(0.6, 1.5, -0.4);
    b.point_light(lamp.as_vec3(), 2.0);
    judge_floor(&b.build(), |p| {
        let d = lamp - p;
        2.0 * d.y / (d.length_squared() * d.length())
    });
}

/// The lamp is seen as well, from behind, where it is black: it is narrow and out of the picture.
#[test]
fn a_rectangle_above_a_floor() {
    let mut b = floor();
    let (black, glow) = (b.diffuse(0.0), b.constant(3.0));
    let center = DVec3::new(1.6, 1.2, 0.3);
    let to_world = facing(center, 0.4, DVec3::X, 90.0);
    b.shape(Geometry::Rectangle, to_world, black).emission = Some(glow);
    let corner = |x: f64, z: f64| center + 0.4 * DVec3::new(x, 0.0, z);
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    judge_floor(&b.build(), |p| 3.0 * polygon_irradiance(&corners, p, DVec3::Y));
}

/// A ball that glows ½ and reflects ½ has the radiance 1 inside, for cameras of all kinds, with crop windows and filters,
/// those with negative lobes among them. Emission is seen by camera rays, and the rest is brought by light paths.
#[test]
fn a_furnace_is_even_for_all_cameras_and_filters() {
    let pinhole = Projection::Perspective {
        fov_deg: 100.0,
        fov_axis: FovAxis::X,
        principal_point_offset: Vec2::new(0.1, -0.05),
    };
    let lens = Projection::ThinLens {
        fov_deg: 80.0,
        fov_axis: FovAxis::Y,
        principal_point_offset: Vec2::ZERO,
        aperture_radius: 0.3,
        focus_distance: 1.1,
    };
    let stretched = Transform::scale(DVec3::new(0.3, 0.4, -0.5));
    for (projection, filter, to_world) in [
        (pinhole, Filter::Gaussian { std_dev: 0.5 }, Transform::IDENTITY),
        (lens, Filter::Box, stretched),
        (Projection::Orthographic, Filter::Mitchell { b: 0.0, c: 0.5 }, stretched),
    ] {
        let mut b = Builder::seen_from(Vec3::new(0.2, 0.1, -0.3), Vec3::ZERO, 50.0, 40);
        (b.scene.film.filter, b.scene.film.height) = (filter, 30);
        b.scene.film.crop = Some(Crop { x: 5, y: 7, width: SIDE, height: SIDE });
        b.scene.camera.projection = projection;
        b.scene.camera.to_world = to_world.then(b.scene.camera.to_world);
        let (wall, glow) = (b.diffuse(0.5), b.constant(0.5));
        let room = b.sphere(Vec3::ZERO, 1.5, wall);
        (room.flip_normals, room.emission) = (true, Some(glow));
        let pictures = renders(&b.build(), &light_tracer(None), 256, 1..17);
        for block in block_samples(&pictures, SIDE as usize, BLOCK) {
            block.iter().copied().collect::<MeanTest>().against(1.0).assert_passes(level());
        }
    }
}

/// Parallel lines of sight through fog beside a point light: ∫ σ/(4π) e^(−σ(d + s)) / d² along each.
#[test]
fn fog_scatters_a_point_light_once() {
    const SIGMA: f64 = 0.5;
    let mut b = Builder::parallel_view(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, 0.5, 8, 8);
    b.point_light(Vec3::new(1.2, 0.0, 0.0), 1.0);
    let fog = b.medium(grey_fog(SIGMA as f32, 1.0, Phase::Isotropic));
    b.fill(fog);
    let along = |x: f64, y: f64| {
        let across_sq = (1.2 - x) * (1.2 - x) + y * y;
        let at = |s: f64| {
            let d_sq = across_sq + (2.0 - s) * (2.0 - s);
            SIGMA / (4.0 * PI) * libm::exp(-SIGMA * (s + d_sq.sqrt())) / d_sq
        };
        integrate(at, &[0.0, 2.0, 30.0], Tolerance::relative(1e-6)).value
    };
    let places = (0..16).map(|i| (f64::from(i) + 0.5) / 16.0 - 0.5);
    let exact = places.clone().flat_map(|x| places.clone().map(move |y| (x, y))).map(|(x, y)| along(x, y));
    let exact = exact.sum::<f64>() / 256.0;
    let pictures = renders(&b.build(), &light_tracer(Some(2)), 512, 1..17);
    let means: MeanTest = pictures.iter().map(|p| p.iter().sum::<f64>() / p.len() as f64).collect();
    means.within(exact, 5e-4).assert_passes(level());
}

/// What is seen in mirrors and through glass is black, and what lamps send by them is not.
#[test]
fn mirrors_show_lamps_and_nothing_else() {
    let scene = |glow: f32| {
        let mut b = Builder::seen_from(Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, -0.5), 20.0, 8);
        let (mirror, wall, emission) = (b.mirror(1.0), b.diffuse(0.5), b.constant(glow));
        b.shape(Geometry::Rectangle, facing(DVec3::ZERO, 3.0, DVec3::X, -90.0), mirror);
        let room = b.sphere(Vec3::ZERO, 4.0, wall);
        room.flip_normals = true;
        if glow > 0.0 {
            room.emission = Some(emission);
        } else {
            b.point_light(Vec3::new(0.0, 2.0, 0.0), 1.0);
        }
        b.build()
    };
    let mean = |glow: f32, method: &Method| {
        let world = scene(glow);
        assert!(LightTracerConfig::misses(&world));
        renders(&world, method, 4, 0..1)[0].iter().sum::<f64>() / 64.0
    };
    assert!(mean(0.0, &path()) > 1e-3);
    assert_eq!(mean(0.0, &light_tracer(None)), 0.0);
    assert!((mean(0.5, &light_tracer(None)) - 0.5).abs() < 1e-6);
    assert!(!LightTracerConfig::misses(&floor().build()));
}

/// In a scene with surfaces, media, a lens and a filter with negative lobes.
#[test]
fn threads_change_no_bit() {
    let mut b = foggy_niche(SIDE, Rgb::splat(1.0), Rgb::WHITE, Phase::Isotropic);
    b.scene.film.filter = Filter::Mitchell { b: 0.3, c: 0.3 };
    let world = b.build();
    let film = |threads, seed| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        pool.install(|| session(&world, light_tracer(None), 150, seed).film().clone())
    };
    let one = film(1, 3);
    assert!(one.mean_luminance() > 0.01);
    for threads in [2, 7] {
        assert!(film(threads, 3) == one, "{threads} threads");
    }
    assert!(film(2, 4) != one);
}

/// A step is one estimate, whose spread tells the noise: of 64 seeds, each with 16 steps, the variance that the film
/// reports is in the mean that among them. A χ² with 63 degrees of freedom for each of 16 blocks of which pixels are nearly
/// independent has a relative deviation of .18 for a pixel, and 1.1 % for all 256; noise of the reports is less.
#[test]
fn the_variance_is_that_of_steps() {
    let mut b = floor();
    b.point_light(Vec3::new(0.6, 1.5, -0.4), 2.0);
    let world = b.build();
    let films: Vec<_> =
        (0..64).map(|seed| session(&world, light_tracer(None), 64, seed).film().clone()).collect();
    let pixels = (SIDE * SIDE) as usize;
    let told: f64 = films.iter().flat_map(Film::variance).sum::<f64>() / 64.0;
    let found: f64 = (0..pixels)
        .map(|i| {
            let values: MeanTest =
                films.iter().map(|film| f64::from(film.develop().pixels[i].luminance())).collect();
            values.variance()
        })
        .sum();
    // Five deviations: wrong once in a million.
    assert!((told / found - 1.0).abs() < 0.06, "{told} is told, {found} found");
}
