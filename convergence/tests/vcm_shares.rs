//! Vertex connection and merging where all its techniques find much of the same light, so that one which is weighed wrongly
//! is missed or counted twice.
//!
//! The tests of the file share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct code would fail
//! somewhere with probability 1 %. What merging blurs is forgiven, as stated.

use nephroid::color::Rgb;
use nephroid::integrator::{Method, PhotonMapperConfig, VcmConfig};
use nephroid::light::LightKind;
use nephroid::math::{DVec3, Vec3};
use nephroid::shape::{Geometry, Mesh};
use nephroid::world::World;
use nephroid_convergence::{Builder, facing, forgiving, iterated_renders, path, renders};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// More than scenes and ways.
const TESTS: usize = 40;

/// Pixels of a picture's side.
const SIDE: u32 = 8;

/// Seeds of each way.
const SEEDS: u64 = 16;

/// Each way with so many light paths: its name, what it is, and whether it merges.
fn ways(light_paths: u64, max_depth: Option<u32>) -> Vec<(&'static str, VcmConfig)> {
    let mapper = PhotonMapperConfig { max_depth, ..PhotonMapperConfig::default() };
    let all = VcmConfig { mapper, light_paths: Some(light_paths), ..VcmConfig::default() };
    vec![
        ("neither", VcmConfig { merging: false, connections: false, ..all.clone() }),
        ("connections alone", VcmConfig { merging: false, ..all.clone() }),
        ("merging alone", VcmConfig { connections: false, ..all.clone() }),
        ("correlation", VcmConfig { correlation: true, ..all.clone() }),
        ("all", all),
    ]
}

fn picture_means(pictures: &[Vec<f64>]) -> Vec<f64> {
    pictures.iter().map(|picture| picture.iter().sum::<f64>() / picture.len() as f64).collect()
}

/// The means of whole pictures are those that are given, but for blur.
#[track_caller]
fn agree(world: &World, config: VcmConfig, name: &str, exact: &[f64], blur: f64) {
    let forgiven = if config.merging { blur } else { 0.0 };
    let pictures = iterated_renders(world, &Method::Vcm(config), 4, 1, 100..100 + SEEDS);
    let found = picture_means(&pictures);
    let exact: MeanTest = forgiving(&found, exact, forgiven).into_iter().collect();
    let found: MeanTest = found.into_iter().collect();
    let outcome = found.welch(&exact);
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

/// A ball in a ball: both give off what they absorb, so radiance is one everywhere, though they reflect differently. What
/// lies within a distance r on a sphere is exactly πr² of it, so nothing is lost at any edge.
///
/// With few light paths the radius is large, so that much lies nearer than what is merged behind the first surface.
#[test]
fn a_ball_in_a_ball_that_shine_is_even() {
    for light_paths in [300, 3000] {
        let mut b = Builder::seen_from(Vec3::new(-0.75, 0.0, 0.0), Vec3::new(0.0, 0.3, 0.0), 80.0, SIDE);
        for (center, radius, albedo, flip) in
            [(Vec3::ZERO, 1.0, 0.75, true), (Vec3::new(0.3, 0.0, 0.0), 0.6, 0.5, false)]
        {
            let (material, glow) = (b.diffuse(albedo), b.constant(1.0 - albedo));
            let shape = b.sphere(center, radius, material);
            (shape.emission, shape.flip_normals) = (Some(glow), flip);
        }
        let world = b.build();
        for (name, config) in ways(light_paths, None) {
            agree(&world, config, &format!("{name} of {light_paths}"), &[1.0; 2], 0.001);
        }
    }
}

/// A floor and a wall at its end, one of which is seen; the floor's shading normals lean towards the wall.
fn bent(floor_is_seen: bool) -> Builder {
    let (from, to) = match floor_is_seen {
        true => (Vec3::new(0.0, 3.0, 0.0), Vec3::new(0.0, 0.0, -0.4)),
        false => (Vec3::new(0.0, 1.0, 3.0), Vec3::new(0.0, 0.6, -1.0)),
    };
    let mut b = Builder::parallel_view(from, to, 0.25, SIDE, SIDE);
    let grey = b.diffuse(0.8);
    let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let lean = Vec3::new(0.0, 1.0, -1.2).normalize();
    let floor = Mesh {
        positions: vec![corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        normals: vec![lean; 4],
        ..Mesh::default()
    };
    b.mesh(floor, grey);
    b.shape(Geometry::Rectangle, facing(DVec3::new(0.0, 1.0, -1.0), 1.0, DVec3::X, 0.0), grey);
    b.light(LightKind::Point { position: Vec3::new(0.0, 1.5, 0.3), intensity: Rgb::splat(3.0) });
    b
}

/// What comes by way of the floor is scattered there as its shading normal says, whoever finds it: merged, connected or seen.
#[test]
fn where_normals_lean() {
    for floor_is_seen in [true, false] {
        let world = bent(floor_is_seen).build();
        let exact = picture_means(&renders(&world, &path(), 256, 0..SEEDS));
        for (name, config) in ways(16_000, None) {
            agree(&world, config, &format!("{name}, floor: {floor_is_seen}"), &exact, 0.02);
        }
    }
}
