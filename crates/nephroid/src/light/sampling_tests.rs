//! Light as sampled from a point against the density claimed for it, by χ² tests. They share the level
//! `ALPHA` by Šidák's formula: on seeds chosen afresh, correct code would fail with probability 1 %.

use nephroid_testkit::{ALPHA, MeanTest, Outcome, Pcg32, SphereTest, sidak};

use super::{EnvironmentMapping, Light, LightKind};
use crate::camera::{Camera, FovAxis, Projection};
use crate::color::Rgb;
use crate::film::{FilmSettings, Filter};
use crate::handle::Arena;
use crate::material::Material;
use crate::math::{Affine2, DVec3, Ray, Transform, Vec2, Vec3};
use crate::medium::Boundary;
use crate::medium::Media;
use crate::scene::Scene;
use crate::shape::{Geometry, Mesh, Shape};
use crate::texture::{Bitmap, BitmapFilter, Image, Pixmap, Texture, Textures, Wrap};
use crate::world::World;

/// More than the tests of this file.
const TESTS: usize = 20;

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

fn empty() -> Scene {
    let projection =
        Projection::Perspective { fov_deg: 40.0, fov_axis: FovAxis::X, principal_point_offset: Vec2::ZERO };
    Scene {
        camera: Camera { to_world: Transform::IDENTITY, projection, medium: None },
        film: FilmSettings { width: 1, height: 1, crop: None, filter: Filter::Box },
        textures: Textures::default(),
        materials: Arena::default(),
        meshes: Arena::default(),
        shapes: Vec::new(),
        groups: Arena::default(),
        instances: Vec::new(),
        lights: Vec::new(),
        media: Media::default(),
    }
}

/// A world of one lamp.
fn lamp(geometry: Geometry, to_world: Transform, flip_normals: bool) -> World {
    let mut scene = empty();
    let black = scene.textures.constant(Rgb::BLACK);
    let emission = Some(scene.textures.constant(Rgb::WHITE));
    let material = scene.materials.push(Material::Diffuse { reflectance: black });
    let pyramid = Mesh {
        positions: vec![Vec3::X, Vec3::Y, -Vec3::X, -Vec3::Y, Vec3::Z],
        triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [0, 2, 1], [0, 3, 2]],
        ..Mesh::default()
    };
    let mesh = scene.meshes.push(pyramid);
    let geometry = if let Geometry::Mesh(_) = geometry { Geometry::Mesh(mesh) } else { geometry };
    let name = String::new();
    scene.shapes.push(Shape {
        name,
        geometry,
        to_world,
        material,
        emission,
        flip_normals,
        boundary: Boundary::default(),
    });
    World::new(scene).expect("a sound scene")
}

/// Tests the directions sampled at the origin. What faces away makes a sample fail, and the density
/// has to leave room for that.
#[track_caller]
fn test(name: &str, world: &World, seed: u64, pdf: impl Fn(Vec3) -> f32) {
    let emitter = &world.emitters()[0];
    let mut rng = Pcg32::new(seed);
    let (mut samples, mut differ) = (0, 0);
    let sample = || {
        let u = Vec2::from_array(rng.vec2_f32());
        let incident = emitter.sample_incident(world.lookup(), Vec3::ZERO, u)?;
        samples += 1;
        differ += u32::from((pdf(incident.wi) / incident.pdf_solid_angle - 1.0).abs() > 1e-2);
        Some(incident.wi.to_array().map(f64::from))
    };
    let density = |w: [f64; 3]| f64::from(pdf(Vec3::from_array(w.map(|c| c as f32)).normalize()));
    let sphere = SphereTest { samples: 25_000, resolution: [6, 8], ..Default::default() };
    judge(name, &sphere.run(sample, density));
    // Right at an edge the ray may miss.
    assert!(differ <= samples / 5000, "{name}: {differ} of {samples} densities differ");
}

/// The density that next event estimation claims for what a ray from the origin sees.
fn pdf_of_surface(world: &World, wi: Vec3) -> f32 {
    let Some(hit) = world.intersect(&Ray::new(Vec3::ZERO, wi)) else { return 0.0 };
    match world.emitted(&hit, -wi) {
        Some((light, _)) => world.emitters()[light].pdf_of_surface(Vec3::ZERO, &hit.point),
        None => 0.0,
    }
}

#[test]
fn surfaces_are_sampled_with_the_density_they_claim() {
    let above = |z: f64| Transform::translate(DVec3::new(0.1, -0.2, z));
    let tilted = |angle: f64| Transform::rotate(DVec3::new(1.0, 0.5, 0.2), angle).then(above(1.5));
    let ball = Geometry::Sphere { center: Vec3::ZERO, radius: 0.7 };
    let mesh = Geometry::Mesh(Arena::default().push(Mesh::default()));
    let cases = [
        ("a ball from outside", ball.clone(), above(1.5), false),
        ("a ball from close by", ball.clone(), above(0.75), false),
        ("a small ball", ball.clone(), above(30.0), false),
        ("a ball from inside", ball, above(0.3), true),
        ("a square from its edge", Geometry::Rectangle, tilted(200.0).then(above(-1.3)), false),
        ("a disk", Geometry::Disk, tilted(20.0), true),
        ("a cube", Geometry::Cube, tilted(50.0).then(above(1.0)), false),
        ("a pyramid", mesh, tilted(140.0), false),
    ];
    for (seed, (name, geometry, to_world, flip)) in (1..).zip(cases) {
        let world = lamp(geometry, to_world, flip);
        test(name, &world, seed, |wi| pdf_of_surface(&world, wi));
    }
}

/// A bitmap for a lamp that is all but black beside a bright corner.
#[test]
fn textured_lamps_are_sampled_where_they_are_bright() {
    let to_world = Transform::rotate(DVec3::new(1.0, 0.5, 0.2), 200.0)
        .then(Transform::translate(DVec3::new(0.1, -0.2, 1.2)));
    let world = screen(to_world);
    test("a textured square", &world, 9, |wi| pdf_of_surface(&world, wi));
    // All that it gives off to the side, by points uniform and by brightness, to 2 %: five standard errors.
    let emitter = &world.emitters()[0];
    let (mut by_light, mut evenly) = (MeanTest::new(), MeanTest::new());
    let mut rng = Pcg32::new(10);
    for _ in 0..20_000 {
        let u = Vec2::from_array(rng.vec2_f32());
        let incident = emitter.sample_incident(world.lookup(), Vec3::ZERO, u);
        by_light.push(incident.map_or(0.0, |i| f64::from(i.radiance.mean() / i.pdf_solid_angle)));
        let wi = crate::math::warp::square_to_sphere(u);
        let hit = world.intersect(&Ray::new(Vec3::ZERO, wi));
        let seen = hit.and_then(|hit| world.emitted(&hit, -wi)).map_or(0.0, |(_, seen)| seen.mean());
        evenly.push(4.0 * std::f64::consts::PI * f64::from(seen));
    }
    judge("a textured square", &by_light.welch(&evenly));
    assert!(by_light.variance() < 0.3 * evenly.variance());
}

fn screen(to_world: Transform) -> World {
    let mut scene = empty();
    let black = scene.textures.constant(Rgb::BLACK);
    let mut image = Image::filled(6, 4, Rgb::splat(0.05));
    image.pixels[7] = Rgb::new(9.0, 3.0, 1.0);
    image.pixels[22] = Rgb::new(1.0, 4.0, 1.0);
    let image = scene.textures.images.push(image.into());
    let bitmap = Bitmap {
        image,
        filter: BitmapFilter::Bilinear,
        wrap: Wrap::Clamp,
        to_uv: Affine2::from_scale(Vec2::new(1.5, 0.8)),
    };
    let emission = Some(scene.textures.push(Texture::Bitmap(bitmap)));
    let material = scene.materials.push(Material::Diffuse { reflectance: black });
    let shape = Shape::new("screen", Geometry::Rectangle, material);
    scene.shapes.push(Shape { to_world, emission, ..shape });
    World::new(scene).expect("a sound scene")
}

fn sky(kind: LightKind, images: &[Image]) -> World {
    let mut scene = empty();
    for image in images {
        scene.textures.images.push(image.clone().into());
    }
    scene.lights.push(Light { name: String::new(), kind, medium: None });
    World::new(scene).expect("a sound scene")
}

#[test]
fn skies_are_sampled_with_the_density_they_claim() {
    let world = sky(LightKind::Constant { radiance: Rgb::WHITE }, &[]);
    test("a constant sky", &world, 20, |wi| world.emitters()[0].pdf_of_sky(wi));

    let mut image = Image::filled(8, 4, Rgb::BLACK);
    for (i, pixel) in image.pixels.iter_mut().enumerate() {
        *pixel = Rgb::new(0.3, 1.0, 0.5) * (i * 5 % 7) as f32;
    }
    image.pixels[12] = Rgb::splat(100.0);
    let handle = Arena::default().push(Pixmap::from(image.clone()));
    // Its zenith along +z, as the cells of the test lie, and askew.
    for (seed, turn) in
        [(21, Transform::rotate(DVec3::X, 90.0)), (22, Transform::rotate(DVec3::new(0.3, 1.0, -0.5), 100.0))]
    {
        let kind = LightKind::Environment {
            image: handle,
            mapping: EnvironmentMapping::Equirectangular,
            scale: 2.0,
            to_world: turn,
        };
        let world = sky(kind, std::slice::from_ref(&image));
        test("an environment", &world, seed, |wi| world.emitters()[0].pdf_of_sky(wi));
    }

    let image = Image { width: 5, height: 5, pixels: image.pixels[..25].to_vec() };
    let turn = Transform::rotate(DVec3::new(0.3, 1.0, -0.5), 100.0);
    for (seed, to_world) in [(23, Transform::IDENTITY), (24, turn)] {
        let mapping = EnvironmentMapping::EqualArea;
        let kind = LightKind::Environment { image: handle, mapping, scale: 2.0, to_world };
        let world = sky(kind, std::slice::from_ref(&image));
        test("a square environment", &world, seed, |wi| world.emitters()[0].pdf_of_sky(wi));
    }

    let (direction, irradiance) = (Vec3::new(0.5, -0.2, 0.4), Rgb::WHITE);
    let kind = LightKind::Sun { direction, irradiance, angular_radius_deg: 35.0 };
    let world = sky(kind, &[]);
    test("a sun", &world, 25, |wi| world.emitters()[0].pdf_of_sky(wi));
}
