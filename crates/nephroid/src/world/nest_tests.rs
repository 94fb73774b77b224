//! Overlapping shapes against closed forms: Snell's and Fresnel's laws of what is really there, the layers of fog
//! that are left of overlapping ones.

use super::*;
use crate::camera::{Camera, Projection};
use crate::film::{FilmSettings, Filter};
use crate::light::Source;
use crate::material::Transport;
use crate::math::{DVec3, Transform};
use crate::medium::{Medium, Phase};
use crate::sampling::{Key, Sampler, Sequence, Stream};
use crate::shape::{Geometry, Shape};

/// A scene with a camera at a height.
fn scene(height: f64) -> Scene {
    let to_world = Transform::translate(DVec3::new(0.0, 0.0, height));
    let camera = Camera { to_world, projection: Projection::Orthographic, medium: None };
    Scene::new(camera, FilmSettings { width: 1, height: 1, crop: None, filter: Filter::Box })
}

fn glass(scene: &mut Scene, ior: f32) -> Handle<Material> {
    let white = scene.textures.constant(Rgb::WHITE);
    scene.materials.push(Material::Dielectric {
        int_ior: ior,
        ext_ior: 1.0,
        specular_reflectance: white,
        specular_transmittance: white,
    })
}

/// A wide slab between two heights.
fn slab(scene: &mut Scene, from: f64, to: f64, priority: Option<u32>, material: Handle<Material>) {
    let to_world = Transform::scale(DVec3::new(50.0, 50.0, 0.5 * (to - from)))
        .then(Transform::translate(DVec3::new(0.0, 0.0, 0.5 * (from + to))));
    let boundary = Boundary { priority, ..Boundary::default() };
    scene.shapes.push(Shape { to_world, boundary, ..Shape::new("slab", Geometry::Cube, material) });
}

/// Glass from 0 to 1 and water from 0.9 to 2.
fn glass_of_water(camera: f64, priorities: [Option<u32>; 2]) -> World {
    let mut scene = scene(camera);
    let (hard, wet) = (glass(&mut scene, 1.5), glass(&mut scene, 1.33));
    slab(&mut scene, 0.0, 1.0, priorities[0], hard);
    slab(&mut scene, 0.9, 2.0, priorities[1], wet);
    World::new(scene).expect("a sound scene")
}

fn sampler() -> Sampler {
    Sampler::new(Sequence::Independent, Key::new(3, 0, Stream::Camera), 0)
}

/// Where a ray leaves that goes straight on wherever it can, what it carries by then, and how many surfaces it saw.
fn through(world: &World, mut ray: Ray) -> (Ray, f64, u32) {
    let (mut inside, mut carried, mut surfaces) = (Surroundings::default(), 1.0, 0);
    while let Some(hit) = world.intersect(&ray) {
        let wo = -ray.direction;
        let bsdf = world.bsdf_within(&hit, wo, &inside);
        let wi = if bsdf.is_null() {
            ray.direction
        } else {
            let [_, refracted] = bsdf.dirac_lobes(wo, Transport::Flux);
            let refracted = refracted.expect("no total reflection");
            carried *= f64::from(refracted.weight.g);
            surfaces += 1;
            refracted.wi
        };
        inside = world.cross(inside, &hit, ray.direction, wi);
        ray = leave(&hit.point, wi);
    }
    assert_eq!(inside, Surroundings::default(), "outside of everything");
    (ray, carried, surfaces)
}

/// The tangent of the angle in each layer, by Snell's law.
fn tangent(sin: f64, ior: f64) -> f64 {
    let s = sin / ior;
    s / (1.0 - s * s).sqrt()
}

/// What passes from index `a` to `b`, unpolarised, by Fresnel's equations; `sin` is that in vacuum.
fn passes(sin: f64, a: f64, b: f64) -> f64 {
    let cos = |n: f64| (1.0 - (sin / n) * (sin / n)).sqrt();
    let s = (a * cos(a) - b * cos(b)) / (a * cos(a) + b * cos(b));
    let p = (b * cos(a) - a * cos(b)) / (b * cos(a) + a * cos(b));
    1.0 - 0.5 * (s * s + p * p)
}

#[test]
fn a_glass_of_water_has_three_surfaces() {
    // The height at which glass turns to water; of equal priorities the first shape is the higher.
    for (priorities, turn) in [([7, 2], 1.0), ([0, 1], 0.9), ([4, 4], 1.0)] {
        let world = glass_of_water(-3.0, priorities.map(Some));
        for sin in [0.0f64, 0.3, 0.8, 0.99] {
            let cos = (1.0 - sin * sin).sqrt();
            let offset = tangent(sin, 1.5) * turn + tangent(sin, 1.33) * (2.0 - turn);
            let share = passes(sin, 1.0, 1.5) * passes(sin, 1.5, 1.33) * passes(sin, 1.33, 1.0);
            for up in [1.0, -1.0] {
                let direction = Vec3::new(sin as f32, 0.0, (up * cos) as f32);
                let start = if up > 0.0 { 0.0 } else { 2.0 };
                let from = DVec3::new(-sin, 0.1, start - up * cos);
                let (ray, carried, surfaces) = through(&world, Ray::new(from.as_vec3(), direction));
                assert_eq!(surfaces, 3, "{priorities:?}, {sin}");
                assert!((f64::from(ray.origin.x) - offset).abs() < 1e-5, "{priorities:?}, {sin}: {ray:?}");
                assert!((ray.direction - direction).length() < 2e-6, "{priorities:?}, {sin}: {ray:?}");
                assert!((carried - share).abs() < 1e-5, "{priorities:?}, {sin}: {carried}, not {share}");
            }
        }
    }
    // Without priorities there are four, and the light goes from glass into water in glass.
    let world = glass_of_water(-3.0, [None, None]);
    let up = Ray::new(Vec3::new(0.0, 0.0, -1.0), Vec3::Z);
    assert_eq!(through(&world, up).2, 4);
}

#[test]
fn what_starts_inside_knows_it_and_shadow_rays_pass_what_is_not_there() {
    // In the glass, in both, in the water; and whether light comes from there to heights of 0.5, 0.95 and 1.5.
    for (height, clear) in
        [(0.5, [true, true, false]), (0.95, [true, true, false]), (1.2, [false, false, true])]
    {
        let world = glass_of_water(height, [Some(1), Some(0)]);
        let inside = world.camera_surroundings();
        for (goal, expected) in [0.5, 0.95, 1.5].into_iter().zip(clear) {
            let (from, to) = (Vec3::new(0.0, 0.0, height as f32), Vec3::new(0.7, 0.2, goal));
            let source = Source::Point(to);
            let wi = (to - from).normalize();
            for inside in [inside, inside.blind()] {
                let light = world.light_through(Vantage::Space(from), inside, wi, &source, &mut sampler());
                assert_eq!(light, if expected { Rgb::WHITE } else { Rgb::BLACK }, "{height} to {goal}");
            }
        }
    }
}

/// Fog of one extinction from 0 to 2 and of another one from 1 to 3, in a third.
fn fogs(camera: f64, priorities: [u32; 2], exterior: bool) -> World {
    let mut scene = scene(camera);
    let null = scene.materials.push(Material::Null);
    let fog = |sigma_t| Medium::homogeneous("fog", Rgb::splat(sigma_t), Rgb::WHITE, Phase::Isotropic);
    let [low, high, around] = [0.5, 0.2, 0.05].map(|sigma_t| scene.media.list.push(fog(sigma_t)));
    for (medium, from, priority) in [(low, 0.0, priorities[0]), (high, 1.0, priorities[1])] {
        slab(&mut scene, from, from + 2.0, Some(priority), null);
        if let Some(shape) = scene.shapes.last_mut() {
            shape.boundary.interior = Some(medium);
            shape.boundary.exterior = exterior.then_some(around);
        }
    }
    World::new(scene).expect("a sound scene")
}

#[test]
fn of_overlapping_fogs_the_higher_is_there() {
    for (priorities, thickness) in [([2, 1], [2.0, 1.0]), ([1, 2], [1.0, 2.0]), ([1, 1], [2.0, 1.0])] {
        for (camera, exterior, around) in [(-1.0, false, 0.0), (-1.0, true, 2.0), (5.0, true, 2.0)] {
            let world = fogs(camera, priorities, exterior);
            let (a, b) = (Vec3::new(0.0, 0.0, -1.0), Vec3::new(0.0, 0.0, 4.0));
            let (from, to) = if camera < 0.0 { (a, b) } else { (b, a) };
            let wi = (to - from).normalize();
            let inside = world.camera_surroundings();
            let light =
                world.light_through(Vantage::Space(from), inside, wi, &Source::Point(to), &mut sampler());
            let exact = libm::exp(-0.5 * thickness[0] - 0.2 * thickness[1] - 0.05 * around);
            assert!((f64::from(light.g) - exact).abs() < 1e-4, "{priorities:?}, {exterior}: {light:?}");
        }
        // From where both overlap.
        let world = fogs(1.5, priorities, true);
        let inside = world.camera_surroundings();
        let expected = if priorities[1] > priorities[0] { 1 } else { 0 };
        assert_eq!(inside.medium().map(Handle::index), Some(expected));
        let (from, to) = (Vec3::new(0.0, 0.0, 1.5), Vec3::new(0.0, 0.0, 4.0));
        let light =
            world.light_through(Vantage::Space(from), inside, Vec3::Z, &Source::Point(to), &mut sampler());
        let exact = libm::exp(-0.5 * (thickness[0] - 1.5).max(0.0) - 0.2 * thickness[1].min(1.5) - 0.05);
        assert!((f64::from(light.g) - exact).abs() < 1e-4, "{priorities:?}: {light:?}, not {exact}");
    }
}

/// A ball that names no media, in fog, is clear, and behind it the fog goes on.
#[test]
fn the_medium_around_comes_back() {
    let mut scene = scene(-5.0);
    let fog = Medium::homogeneous("fog", Rgb::splat(0.1), Rgb::WHITE, Phase::Isotropic);
    scene.camera.medium = Some(scene.media.list.push(fog));
    let null = scene.materials.push(Material::Null);
    slab(&mut scene, 0.0, 2.0, Some(1), null);
    slab(&mut scene, 1.0, 3.0, Some(2), null);
    let world = World::new(scene).expect("a sound scene");
    let (from, to) = (Vec3::new(0.0, 0.0, -1.0), Vec3::new(0.0, 0.0, 4.0));
    let inside = world.camera_surroundings();
    let light =
        world.light_through(Vantage::Space(from), inside, Vec3::Z, &Source::Point(to), &mut sampler());
    assert!((f64::from(light.g) - libm::exp(-0.2)).abs() < 1e-4, "{light:?}");
}
