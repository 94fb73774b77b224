//! Final gathering against closed forms and against path tracing.
//!
//! All tests together reject a correct program with a probability of [`ALPHA`]; seeds are fixed.

use std::f64::consts::PI;

use nephroid::integrator::{FinalGather, Method, PhotonMapperConfig};
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_convergence::{Builder, block_samples, forgiving, mean_radiances, path, photon_mapper, renders};
use nephroid_testkit::{ALPHA, MeanTest, Outcome, sidak};

/// Pixels of the room's picture along a side, and of a block.
const SIDE: usize = 32;
const BLOCK: usize = 8;
const BLOCKS: usize = (SIDE / BLOCK) * (SIDE / BLOCK);
/// Two furnaces; the room by gather rays, in blocks and whole, and from the maps on the spot.
const TESTS: usize = 2 + BLOCKS + 2;

fn level() -> f64 {
    sidak(ALPHA, TESTS)
}

/// A sphere of radius 1 and albedo ρ, a point light of 1 W/sr at its centre: L = ρ / (π (1 − ρ)).
/// The light within is uniform, and so is the light on a sphere of what gather rays read from the map:
/// the ball around a point of a sphere cuts out π r² of it. What rays land nearer than the map resolves
/// goes on, and is exact. One per mille is allowed for the normals that are too far off, of photons
/// within r = .022.
#[test]
fn a_furnace_is_as_bright_by_gather_rays_as_it_is() {
    for albedo in [0.5f64, 0.8] {
        let mut b = Builder::seen_from(Vec3::new(0.3, 0.1, 0.0), Vec3::X, 90.0, 8);
        let grey = b.diffuse(albedo as f32);
        b.sphere(Vec3::ZERO, 1.0, grey).flip_normals = true;
        b.point_light(Vec3::ZERO, 1.0);
        let world = b.build();
        let config = PhotonMapperConfig { final_gather: FinalGather::Rays(4), ..photon_mapper(50_000) };
        let radiances = mean_radiances(&world, &Method::PhotonMapper(config), 16, 1..13);
        let test: MeanTest = radiances.into_iter().collect();
        test.within(albedo / (PI * (1.0 - albedo)), 1e-3).assert_passes(level());
    }
}

/// A room of 2 by 2 by 2 with grey walls of several albedos, open towards +z, a square lamp below its
/// ceiling, a mirror ball and a glass ball.
fn room() -> World {
    let mut b = Builder::seen_from(Vec3::new(0.0, 1.0, 3.9), Vec3::new(0.0, 1.0, 0.0), 40.0, SIDE as u32);
    let wall = |degrees: f64, axis: DVec3, to: DVec3| {
        Transform::rotate(axis, degrees).then(Transform::translate(to))
    };
    for (albedo, to_world) in [
        (0.7, wall(-90.0, DVec3::X, DVec3::ZERO)),
        (0.7, wall(90.0, DVec3::X, DVec3::new(0.0, 2.0, 0.0))),
        (0.7, wall(0.0, DVec3::X, DVec3::new(0.0, 1.0, -1.0))),
        (0.3, wall(90.0, DVec3::Y, DVec3::new(-1.0, 1.0, 0.0))),
        (0.5, wall(-90.0, DVec3::Y, DVec3::new(1.0, 1.0, 0.0))),
    ] {
        let grey = b.diffuse(albedo);
        b.shape(Geometry::Rectangle, to_world, grey);
    }
    let (black, radiance) = (b.diffuse(0.0), b.constant(1.0));
    let lamp = Transform::scale(DVec3::splat(0.6)).then(wall(90.0, DVec3::X, DVec3::new(0.0, 1.98, 0.0)));
    b.shape(Geometry::Rectangle, lamp, black).emission = Some(radiance);
    let (mirror, glass) = (b.mirror(0.9), b.glass(1.5));
    b.sphere(Vec3::new(-0.45, 0.4, -0.4), 0.4, mirror);
    b.sphere(Vec3::new(0.45, 0.4, 0.2), 0.4, glass);
    b.build()
}

/// Tests whether two sets of pictures have the same mean, up to `bias` of the second's.
fn agree(a: &[f64], b: &[f64], bias: f64) -> Outcome {
    let forgiven: MeanTest = forgiving(a, b, bias).into_iter().collect();
    a.iter().copied().collect::<MeanTest>().welch(&forgiven)
}

fn blocks(pictures: &[Vec<f64>]) -> Vec<Vec<f64>> {
    block_samples(pictures, SIDE, BLOCK)
}

fn whole(pictures: &[Vec<f64>]) -> Vec<f64> {
    block_samples(pictures, SIDE, SIDE).remove(0)
}

/// Blocks of 8 by 8 pixels, by gather rays and by paths, agree to 1 %: what gather rays read off the
/// maps near edges is too dark by a part of a kernel, and blurred in caustics. Walls
/// have 40 m of edges around 20 m², of which .17 r is lost along each: with r = .03, for 6 of 50 000
/// photons, 1 % of the light of two bounces or more, and the whole picture agrees to .5 %.
///
/// From the maps on the spot, with 60 photons, r = .09 and 3 % of all indirect light is lost: 2 % of the
/// whole.
#[test]
fn a_room_with_glass_and_mirror_is_what_paths_make_it() {
    let world = room();
    let paths = renders(&world, &path(), 64, 1..17);
    let gathered = renders(&world, &Method::PhotonMapper(photon_mapper(50_000)), 16, 21..37);
    for (a, b) in blocks(&gathered).iter().zip(&blocks(&paths)) {
        agree(a, b, 0.01).assert_passes(level());
    }
    agree(&whole(&gathered), &whole(&paths), 0.005).assert_passes(level());
    let config = PhotonMapperConfig { final_gather: FinalGather::Off, ..photon_mapper(50_000) };
    let on_the_spot = renders(&world, &Method::PhotonMapper(config), 4, 41..49);
    agree(&whole(&on_the_spot), &whole(&paths), 0.02).assert_passes(level());
}
