//! Photons' starts against the light that is seen: whatever way they are sampled, in the mean they carry into each direction the
//! intensity there, and in all the power of the light. t-tests share the level `ALPHA` by Šidák's formula: on seeds chosen
//! afresh, correct code would fail with probability 1 %.

use std::f32::consts::PI;

use nephroid_testkit::{ALPHA, MeanTest, Pcg32, sidak};

use super::{
    Ball, Emission, EmissionNumbers, Emitter, EnvironmentMapping, Light, LightKind, ProjectorUnit, Targets,
};
use crate::camera::{Camera, FovAxis, Projection};
use crate::color::Rgb;
use crate::film::{FilmSettings, Filter};
use crate::math::{Bounds, DVec3, Transform, Vec2, Vec3, warp};
use crate::scene::Scene;
use crate::texture::{Image, Pixmap};
use crate::world::World;

/// Signs of the coordinates, and the longest of them.
const CELLS: usize = 24;

/// More than the tests of this file.
const TESTS: usize = 400;

fn cell(direction: Vec3) -> usize {
    let a = direction.abs();
    let longest = match a {
        a if a.x > a.y && a.x > a.z => 0,
        a if a.y > a.z => 1,
        _ => 2,
    };
    let signs = direction.to_array().iter().fold(0, |bits, c| 2 * bits + usize::from(*c > 0.0));
    8 * longest + signs
}

/// A world around the origin, of radius 1 or so, of one light at (2, 1, 0.5) or far away.
fn world(kind: impl FnOnce(&mut Scene, Transform) -> LightKind) -> World {
    let camera = Camera { to_world: Transform::IDENTITY, projection: Projection::Orthographic, medium: None };
    let film = FilmSettings { width: 1, height: 1, crop: None, filter: Filter::Box };
    let mut scene = Scene::new(camera, film);
    let place = Transform::scale(DVec3::splat(1.5))
        .then(Transform::rotate(DVec3::new(0.2, 1.0, 0.4), 250.0))
        .then(Transform::translate(DVec3::new(2.0, 1.0, 0.5)));
    let kind = kind(&mut scene, place);
    scene.lights.push(Light { name: String::new(), kind, medium: None });
    World::new(scene).expect("a sound scene")
}

fn image(scene: &mut Scene, width: u32, height: u32) -> crate::handle::Handle<Pixmap> {
    let value = |i| if i % 7 == 3 { Rgb::new(9.0, 5.0, 6.0) } else { Rgb::splat(0.2 + 0.1 * (i % 5) as f32) };
    let pixels = (0..width * height).map(value).collect();
    scene.textures.images.push(Image { width, height, pixels }.into())
}

fn worlds() -> Vec<(&'static str, World)> {
    let gain = Rgb::new(0.5, 1.0, 2.0);
    let environment = |mapping, width| {
        world(|scene, place| {
            let to_world = Transform::scale(DVec3::splat(1.0)).then(place);
            LightKind::Environment { image: image(scene, width, 4), mapping, scale: 0.7, to_world }
        })
    };
    let goniometric = |mapping, width| {
        world(|scene, to_world| LightKind::Goniometric {
            to_world,
            intensity: gain,
            table: image(scene, width, 4),
            mapping,
        })
    };
    let projector = |unit| {
        world(|scene, to_world| {
            let (image, fov_axis) = (image(scene, 5, 3), FovAxis::Y);
            LightKind::Projector { to_world, image, scale: gain, unit, fov_deg: 70.0, fov_axis }
        })
    };
    let sun = |angular_radius_deg| {
        let direction = Vec3::new(0.3, -0.4, 0.5);
        world(|_, _| LightKind::Sun { direction, irradiance: gain, angular_radius_deg })
    };
    vec![
        ("environment", environment(EnvironmentMapping::Equirectangular, 7)),
        ("square environment", environment(EnvironmentMapping::EqualArea, 4)),
        ("goniometric", goniometric(EnvironmentMapping::Equirectangular, 7)),
        ("square goniometric", goniometric(EnvironmentMapping::EqualArea, 4)),
        ("projector of intensity", projector(ProjectorUnit::Intensity)),
        ("projector of irradiance", projector(ProjectorUnit::Irradiance)),
        ("wide sun", sun(40.0)),
        ("sun", sun(0.27)),
    ]
}

/// W/sr that the light sends along a direction.
fn intensity(world: &World, emitter: &Emitter, direction: Vec3) -> f64 {
    if emitter.is_sky() {
        let radius = world.radius();
        let seen = emitter.sky_radiance(&world.scene().textures, -direction).mean();
        return f64::from(seen * PI * radius * radius);
    }
    let position = emitter.middle().expect("a place");
    let incident = emitter.sample_incident(world.lookup(), position + direction, Vec2::ZERO);
    incident.map_or(0.0, |incident| f64::from(incident.radiance.mean()))
}

fn emit(world: &World, rng: &mut Pcg32, targets: Option<&Targets>) -> Emission {
    let mut pair = || Vec2::from_array(rng.vec2_f32());
    let (position, direction, target) = (pair(), pair(), pair().x);
    let u = EmissionNumbers { position, direction, target };
    world.emitters()[0].emit(world.lookup(), u, targets, warp::square_to_sphere)
}

#[test]
fn photons_carry_the_intensity_into_each_direction_and_in_all_the_power() {
    for (number, (name, world)) in worlds().into_iter().enumerate() {
        let emitter = &world.emitters()[0];
        let mut rng = Pcg32::new(number as u64);
        let mut found = [MeanTest::new(); CELLS];
        let mut power = MeanTest::new();
        for _ in 0..40_000 {
            let emission = emit(&world, &mut rng, None);
            let carried = f64::from(emission.power.mean());
            power.push(carried);
            let at = (carried > 0.0).then(|| cell(emission.ray.direction));
            (0..).zip(&mut found).for_each(|(i, test)| test.push(if at == Some(i) { carried } else { 0.0 }));
        }
        // A hundredth for what is read between a projector's pixels; else rounding.
        let bias = if name == "projector of intensity" { 1e-2 } else { 1e-5 };
        let all = power.within(f64::from(emitter.power.mean()), bias);
        assert!(all.passes(sidak(ALPHA, TESTS)), "{name}: {all}");
        // The small sun is too rarely met by directions that are spread evenly.
        if name == "sun" {
            continue;
        }
        let mut exact = [MeanTest::new(); CELLS];
        for _ in 0..60_000 {
            let direction = warp::square_to_sphere(Vec2::from_array(rng.vec2_f32()));
            let value = 4.0 * f64::from(PI) * intensity(&world, emitter, direction);
            let at = cell(direction);
            (0..).zip(&mut exact).for_each(|(i, test)| test.push(if at == i { value } else { 0.0 }));
        }
        for (i, (a, b)) in found.iter().zip(&exact).enumerate() {
            if a.mean() == 0.0 && b.mean() == 0.0 {
                continue;
            }
            let outcome = a.welch(b);
            assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}, cell {i}: {outcome}");
        }
    }
}

/// What meets a ball carries the same in the mean, aimed there or not.
#[test]
fn aimed_photons_carry_what_others_bring_there() {
    let (center, radius) = (Vec3::new(0.1, -0.2, 0.1), 0.35);
    let bounds = Bounds { min: center - radius, max: center + radius };
    let targets = Targets { balls: vec![Ball::around(center, radius, bounds, None)] };
    let mut aimed_at_all = 0;
    for (number, (name, world)) in worlds().into_iter().enumerate() {
        let mut rng = Pcg32::new(100 + number as u64);
        let mut brought = |targets: Option<&Targets>| {
            let (mut test, mut aimed) = (MeanTest::new(), false);
            for _ in 0..60_000 {
                let emission = emit(&world, &mut rng, targets);
                let to = center - emission.ray.origin;
                let meets = to.cross(emission.ray.direction).length() < radius
                    && to.dot(emission.ray.direction) > 0.0;
                test.push(if meets { f64::from(emission.power.mean()) } else { 0.0 });
                aimed |= emission.power != emission.emitted;
            }
            (test, aimed)
        };
        let ((all, never), (aimed, sometimes)) = (brought(None), brought(Some(&targets)));
        assert!(!never);
        aimed_at_all += u32::from(sometimes);
        if all.mean() == 0.0 && aimed.mean() == 0.0 {
            continue;
        }
        let outcome = aimed.welch(&all);
        assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
    }
    assert!(aimed_at_all >= 5, "{aimed_at_all}");
}

/// E on a surface that faces the sun's middle, by its disk.
#[test]
fn a_sun_of_any_width_has_its_irradiance() {
    for angular_radius_deg in [0.0, 1e-3, 0.2666, 10.0, 80.0] {
        let direction = Vec3::new(0.3, -0.4, 0.5);
        let irradiance = Rgb::new(0.5, 1.0, 2.0);
        let world = world(|_, _| LightKind::Sun { direction, irradiance, angular_radius_deg });
        let (emitter, middle) = (&world.emitters()[0], direction.normalize());
        let n = 128u16;
        let mut sum = 0.0;
        for i in 0..n * n {
            let u = (Vec2::new(f32::from(i % n), f32::from(i / n)) + 0.5) / f32::from(n);
            let incident = emitter.sample_incident(world.lookup(), Vec3::ONE, u).expect("light");
            sum += f64::from(incident.radiance.g * incident.wi.dot(middle) / incident.pdf_solid_angle);
        }
        let found = sum / f64::from(n * n);
        assert!((found - 1.0).abs() < 1e-4, "{found} at {angular_radius_deg}");
        assert_eq!(emitter.is_sky(), angular_radius_deg > 0.0);
        assert!(!world.has_wide_sky());
        let beside = warp::square_to_cone(Vec2::new(1.0, 0.3), warp::one_minus_cos(1.01f32.to_radians()));
        let beside = crate::math::Frame::from_normal(middle).to_world(beside);
        assert_eq!(world.sky(beside).is_black(), angular_radius_deg < 1.01);
    }
}
