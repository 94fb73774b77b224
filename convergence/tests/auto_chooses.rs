//! What a render by `auto` chooses: never what cannot find the light, the same each time, and something for every scene
//! there is.

use nephroid::color::Rgb;
use nephroid::integrator::{AutoConfig, Choice, Method, PhotonMapperConfig, Pick, PpmConfig};
use nephroid::light::LightKind;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::observer::Silent;
use nephroid::session::{RenderPlan, RenderSettings};
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_convergence::{Builder, boxed, render};

/// Seeds that each choice is made with: what is tested holds for all.
const SEEDS: u64 = 4;

fn auto(max_depth: Option<u32>) -> Method {
    let mapper = PhotonMapperConfig { max_depth, ..PhotonMapperConfig::default() };
    Method::Auto(AutoConfig { ppm: PpmConfig { mapper, ..PpmConfig::default() }, ..AutoConfig::default() })
}

fn plan(world: &World, seed: u64) -> RenderPlan {
    let settings = RenderSettings { method: auto(None), samples_per_pixel: 1, seed };
    RenderPlan::new(world, &settings, &Silent)
}

fn choices(world: &World) -> impl Iterator<Item = Choice> {
    (1..=SEEDS).map(|seed| plan(world, seed).choice.expect("a choice"))
}

fn room(side: u32) -> Builder {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 36.0, side);
    b.niche(0.6);
    b
}

/// No path meets a point, and shadow rays stop at glass.
#[test]
fn a_point_in_glass_is_never_left_to_paths() {
    let mut b = room(24);
    let glass = b.glass(1.5);
    b.sphere(Vec3::new(0.0, 0.3, 0.0), 0.25, glass);
    b.point_light(Vec3::new(0.0, 0.3, 0.0), 1.0);
    for choice in choices(&b.build()) {
        assert_ne!(choice.pick, Pick::Path, "{choice:?}");
        assert!(choice.path.is_infinite(), "{choice:?}");
    }
}

/// The same beside a lamp that lights most of the room: it is a small share of all light that would be missing.
#[test]
fn nor_a_point_in_glass_in_a_bright_room() {
    let mut b = room(24);
    b.ceiling_lamp(0.5, 4.0);
    let glass = b.glass(1.5);
    b.sphere(Vec3::new(0.5, -0.6, 0.3), 0.2, glass);
    b.point_light(Vec3::new(0.5, -0.6, 0.3), 0.05);
    for choice in choices(&b.build()) {
        assert_ne!(choice.pick, Pick::Path, "{choice:?}");
    }
}

/// Paths meet a small lamp through glass, but so seldom that they would take for ever.
#[test]
fn a_small_lamp_behind_glass_is_never_left_to_paths() {
    let mut b = room(24);
    let (glass, black, glow) = (b.glass(1.5), b.diffuse(0.0), b.constant(1000.0));
    b.sphere(Vec3::new(0.0, 0.3, 0.0), 0.25, glass);
    b.sphere(Vec3::new(0.0, 0.3, 0.0), 0.02, black).emission = Some(glow);
    for choice in choices(&b.build()) {
        assert_ne!(choice.pick, Pick::Path, "{choice:?}");
    }
}

/// Where paths find everything at once, photons are of no use.
#[test]
fn a_diffuse_ball_under_a_sky_is_left_to_paths() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.5, 5.0), Vec3::ZERO, 30.0, 24);
    let (white, grey) = (b.diffuse(0.8), b.diffuse(0.5));
    b.sphere(Vec3::ZERO, 1.0, white);
    b.shape(Geometry::Cube, boxed(DVec3::new(0.0, -1.5, 0.0), DVec3::new(3.0, 0.5, 3.0)), grey);
    b.light(LightKind::Constant { radiance: Rgb::WHITE });
    for choice in choices(&b.build()) {
        assert_eq!(choice.pick, Pick::Path, "{choice:?}");
        assert!(choice.path.is_finite() && choice.path > 0.0, "{choice:?}");
    }
}

/// On any number of threads, and of each seed its own.
#[test]
fn a_plan_is_the_same_each_time() {
    let mut b = room(24);
    b.ceiling_lamp(0.3, 10.0);
    let glass = b.glass(1.5);
    b.sphere(Vec3::new(0.0, -0.3, 0.0), 0.4, glass);
    let world = b.build();
    let on = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| plan(&world, seed))
    };
    let first = on(1, 1);
    assert_eq!(on(1, 1), first);
    assert_eq!(on(3, 1), first);
    assert_ne!(on(1, 2), first);
}

/// Dark scenes, scenes without lamps, pictures of one pixel and paths too short to bring anything.
#[test]
fn there_is_a_choice_for_every_scene() {
    let without_lamps = |side| room(side).build();
    let black = |side| {
        let mut b = room(side);
        b.ceiling_lamp(0.3, 0.0);
        b.build()
    };
    let behind_a_wall = |side| {
        let mut b = room(side);
        b.point_light(Vec3::new(0.0, 0.0, -5.0), 1.0);
        b.build()
    };
    let lit = |side| {
        let mut b = room(side);
        b.ceiling_lamp(0.3, 10.0);
        b.build()
    };
    let nothing = |side| Builder::seen_from(Vec3::ZERO, Vec3::X, 36.0, side).build();
    let empty_under_a_sky = |side| {
        let mut b = Builder::seen_from(Vec3::ZERO, Vec3::X, 36.0, side);
        b.light(LightKind::Constant { radiance: Rgb::WHITE });
        b.build()
    };
    for side in [1, 5] {
        for (name, world, light) in [
            ("without lamps", without_lamps(side), false),
            ("black", black(side), false),
            ("nothing", nothing(side), false),
            ("behind a wall", behind_a_wall(side), false),
            ("empty", empty_under_a_sky(side), true),
            ("lit", lit(side), true),
        ] {
            for max_depth in [None, Some(1), Some(2)] {
                let image = render(&world, auto(max_depth), 1, 1);
                let mean = image.pixels.iter().map(|pixel| pixel.luminance()).sum::<f32>();
                // A pixel may see the lamp itself, or not.
                if light && max_depth == Some(1) {
                    assert!(mean.is_finite(), "{name}, {side}");
                } else {
                    assert_eq!(mean > 0.0, light, "{name}, {side}, {max_depth:?}: {mean}");
                }
            }
        }
    }
}

/// A mirror that shows a lamp to a path that may not be longer.
#[test]
fn what_is_chosen_keeps_to_the_longest_path() {
    let mut b = room(16);
    b.ceiling_lamp(0.3, 10.0);
    let mirror = b.mirror(1.0);
    let turned = Transform::rotate(DVec3::X, -60.0).then(Transform::translate(DVec3::new(0.0, -0.9, 0.0)));
    b.shape(Geometry::Rectangle, turned, mirror);
    let world = b.build();
    let mean = |max_depth| {
        let image = render(&world, auto(Some(max_depth)), 4, 1);
        image.pixels.iter().map(|pixel| pixel.luminance()).sum::<f32>() / image.pixels.len() as f32
    };
    let means = [1, 2, 3, 6].map(mean);
    assert!(means.windows(2).all(|pair| pair[0] < pair[1]), "{means:?}");
}
