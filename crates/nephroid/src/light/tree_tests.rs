//! Choosing one of many lights. Probabilities are exact to rounding; χ² and t-tests share the level `ALPHA` by Šidák's
//! formula: on seeds chosen afresh, correct code would fail with probability 1 %.

use nephroid_testkit::{ALPHA, MeanTest, Pcg32, goodness_of_fit, sidak};

use super::{Asker, EnvironmentMapping, Light, LightKind};
use crate::camera::{Camera, FovAxis, Projection};
use crate::color::Rgb;
use crate::film::{FilmSettings, Filter};
use crate::material::Material;
use crate::math::{DVec3, Ray, Transform, Vec2, Vec3, warp};
use crate::sampling::{Key, Sampler, Sequence, Stream};
use crate::scene::Scene;
use crate::shape::{Geometry, Shape};
use crate::texture::Image;
use crate::transport::{DirectLights, direct_light};
use crate::world::World;

/// The tests of this file.
const TESTS: usize = 10;

fn place(rng: &mut Pcg32, width: f64) -> Transform {
    let [x, y] = rng.vec2().map(|u| u - 0.5);
    let axis = warp::square_to_sphere(Vec2::from_array(rng.vec2_f32())).as_dvec3();
    Transform::scale(DVec3::splat(0.02 + 0.05 * rng.next_f64()))
        .then(Transform::rotate(axis, 360.0 * rng.next_f64()))
        .then(Transform::translate(DVec3::new(width * x, width * y, 0.3 + 3.0 * rng.next_f64())))
}

/// A glossy floor under lamps of all kinds, some of which give no light, spread over a square of this width.
fn scene(lamps: u32, width: f64, all_kinds: bool) -> World {
    let camera = Camera {
        to_world: Transform::translate(DVec3::new(0.0, 0.0, 1.0)),
        projection: Projection::Orthographic,
        medium: None,
    };
    let film = FilmSettings { width: 1, height: 1, crop: None, filter: Filter::Box };
    let mut scene = Scene::new(camera, film);
    let grey = scene.textures.constant(Rgb::splat(0.4));
    let black = scene.textures.constant(Rgb::BLACK);
    let paper = scene.materials.push(Material::Diffuse { reflectance: black });
    let glossy = scene.materials.push(Material::Phong {
        diffuse_reflectance: grey,
        specular_reflectance: grey,
        exponent: 20.0,
    });
    let floor = Shape::new("floor", Geometry::Rectangle, glossy);
    scene.shapes.push(Shape { to_world: Transform::scale(DVec3::splat(width)), ..floor });
    let image = scene
        .textures
        .images
        .push(Image { width: 2, height: 1, pixels: vec![Rgb::WHITE, Rgb::splat(0.1)] }.into());
    let mut rng = Pcg32::new(1);
    for i in 0..lamps {
        let to_world = place(&mut rng, width);
        let strength = if i % 50 == 49 { 0.0 } else { rng.next_f32() };
        let intensity = Rgb::new(strength, 0.5 * strength, 0.2);
        let intensity = if strength > 0.0 { intensity } else { Rgb::BLACK };
        let position = to_world.point(Vec3::ZERO);
        let mapping = EnvironmentMapping::Equirectangular;
        let kind = match i % 8 {
            0 if all_kinds => LightKind::Point { position, intensity },
            1 if all_kinds => {
                let (cutoff_deg, beam_width_deg) = (10.0 + 60.0 * rng.next_f32(), 5.0);
                LightKind::Spot { to_world, intensity, cutoff_deg, beam_width_deg, texture: None }
            }
            2 if all_kinds => LightKind::Goniometric { to_world, intensity, table: image, mapping },
            3 if all_kinds => LightKind::Projector {
                to_world,
                image,
                scale: intensity,
                unit: Default::default(),
                fov_deg: 20.0 + 60.0 * rng.next_f32(),
                fov_axis: FovAxis::X,
            },
            other => {
                let geometry = match other {
                    4 => Geometry::Sphere { center: Vec3::ZERO, radius: 1.0 },
                    5 => Geometry::Disk,
                    6 => Geometry::Cube,
                    _ => Geometry::Rectangle,
                };
                let emission = Some(scene.textures.constant(intensity * 50.0));
                let flip_normals = other == 5;
                scene.shapes.push(Shape {
                    to_world,
                    emission,
                    flip_normals,
                    ..Shape::new("lamp", geometry, paper)
                });
                continue;
            }
        };
        scene.lights.push(Light { name: String::new(), kind, medium: None });
    }
    let sun = LightKind::Sun {
        direction: Vec3::new(0.3, 0.2, 1.0),
        irradiance: Rgb::splat(0.3),
        angular_radius_deg: 8.0,
    };
    for kind in [LightKind::Constant { radiance: Rgb::splat(0.02) }, sun] {
        scene.lights.push(Light { name: String::new(), kind, medium: None });
    }
    World::new(scene).expect("a sound scene")
}

fn asker(rng: &mut Pcg32, number: u32) -> Asker {
    let [x, y] = rng.vec2_f32().map(|u| 10.0 * (u - 0.5));
    let position = Vec3::new(x, y, 4.0 * rng.next_f32());
    let normal = warp::square_to_sphere(Vec2::from_array(rng.vec2_f32()));
    if number.is_multiple_of(2) { Asker { position, normal } } else { Asker::in_space(position) }
}

#[test]
fn probabilities_add_up_and_no_lamp_that_gives_light_is_left_out() {
    let world = scene(1000, 8.0, true);
    let mut rng = Pcg32::new(2);
    let (mut never, mut dark) = (0, 0);
    for i in 0..100 {
        let from = asker(&mut rng, i);
        let mut sum = 0.0;
        for (light, emitter) in world.emitters().iter().enumerate() {
            let probability = world.chance_of_asking(light, &from);
            sum += f64::from(probability);
            let u = Vec2::from_array(rng.vec2_f32());
            let lit = emitter.sample_incident(world.lookup(), from.position, u);
            let lit = lit.is_some_and(|incident| !incident.radiance.is_black());
            assert!(!lit || probability > 0.0, "light {light} at {from:?}");
            never += u32::from(probability == 0.0);
            dark += u32::from(!lit);
        }
        assert!((sum - 1.0).abs() < 1e-4, "{sum} at {from:?}");
    }
    // A good share of what cannot give light is known to.
    assert!(never > dark / 4, "{never} of {dark}");
}

#[test]
fn lamps_are_asked_as_often_as_is_said() {
    let world = scene(60, 8.0, true);
    let mut rng = Pcg32::new(3);
    for i in 0..4 {
        let from = asker(&mut rng, i);
        let n = 40_000;
        let mut counts = vec![0u64; world.light_count()];
        for _ in 0..n {
            let (light, probability) = world.ask(&from, rng.next_f32()).expect("lamps");
            let said = world.chance_of_asking(light, &from);
            assert!((said / probability - 1.0).abs() < 1e-5, "{said} is not {probability}");
            counts[light] += 1;
        }
        let expected: Vec<f64> = (0..world.light_count())
            .map(|light| f64::from(world.chance_of_asking(light, &from)) * f64::from(n))
            .collect();
        let outcome = goodness_of_fit(&counts, &expected);
        assert!(outcome.passes(sidak(ALPHA, TESTS)), "{outcome}");
    }
}

/// Lamps and rays from the BSDF find the same light with the weights of both, whichever lamps are asked.
#[test]
fn one_of_many_lamps_stands_for_all() {
    let world = scene(400, 8.0, false);
    let hit = world.intersect(&Ray::new(Vec3::new(0.3, -0.2, 0.1), Vec3::NEG_Z)).expect("the floor");
    let wo = Vec3::new(0.3, 0.1, 1.0).normalize();
    let bsdf = world.bsdf(&hit, wo);
    let estimate = |lights, samples: u64| {
        let mut test = MeanTest::new();
        for i in 0..samples {
            let mut sampler = Sampler::new(Sequence::Independent, Key::new(3, 0, Stream::Camera), i);
            let inside = world.camera_surroundings();
            test.push(f64::from(direct_light(&world, &hit, &bsdf, wo, inside, lights, &mut sampler).mean()));
        }
        test
    };
    let (one, all) = (estimate(DirectLights::One, 60_000), estimate(DirectLights::All, 600));
    let relative = [&one, &all].map(|test| test.standard_error() / test.mean());
    assert!(relative.iter().all(|error| *error < 0.02), "{relative:?}");
    let outcome = one.welch(&all);
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{outcome}: {} and {}", one.mean(), all.mean());
}

/// What the tree is for: at the same count, far less noise than by power.
#[test]
fn lamps_close_by_are_asked_more() {
    let world = scene(1000, 60.0, true);
    let from = Asker { position: Vec3::new(0.3, -0.2, 0.0), normal: Vec3::Z };
    let irradiance = |light: usize| {
        let incident =
            world.emitters()[light].sample_incident(world.lookup(), from.position, Vec2::splat(0.5));
        incident.map_or(0.0, |i| f64::from(i.radiance.mean() * i.wi.z.max(0.0) / i.pdf_solid_angle))
    };
    // Of the estimate E/p: ∑ E²/p.
    let second_moment = |chance: &dyn Fn(usize) -> f64| -> f64 {
        let lights = (0..world.light_count()).filter(|light| irradiance(*light) > 0.0);
        lights.map(|light| irradiance(light).powi(2) / chance(light)).sum()
    };
    let mean: f64 = (0..world.light_count()).map(irradiance).sum();
    let variance = |chance: &dyn Fn(usize) -> f64| second_moment(chance) / (mean * mean) - 1.0;
    let by_tree = variance(&|light| f64::from(world.chance_of_asking(light, &from)));
    let table = world.lights_by_power().expect("lamps");
    let by_power = variance(&|light| f64::from(table.pmf(light)));
    assert!(by_tree < 0.2 * by_power, "{by_tree} and {by_power}");
}
