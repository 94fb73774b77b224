//! Ends of paths at lamps: the densities with which light is said to start and land, against how many paths do.
//!
//! The tests of the file share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct code would fail
//! somewhere in this file with probability 1 %.

use nephroid_testkit::{ALPHA, MeanTest, sidak};

use super::densities::Place;
use super::lamp::LampEnd;
use crate::camera::{Camera, FovAxis, Projection};
use crate::color::Rgb;
use crate::film::{FilmSettings, Filter};
use crate::handle::{Arena, Handle};
use crate::light::{Asker, EnvironmentMapping, Light, LightKind, Source};
use crate::material::Material;
use crate::math::{DVec3, Ray, Transform, Vec2, Vec3};
use crate::medium::{Boundary, Media};
use crate::sampling::{Key, Sampler, Sequence, Stream};
use crate::scene::Scene;
use crate::shape::{Geometry, Shape};
use crate::texture::{Image, Texture, Textures};
use crate::transport::{
    DirectLights, Event, Ledger, MapKind, Next, Scatterer, Start, WalkSettings, choice, walk,
};
use crate::world::{Surroundings, Vantage, World};

/// Lamps that are tested.
const TESTS: usize = 16;

/// Means of so many pieces of work.
const PIECES: u64 = 32;
const PATHS: u64 = 4096;

/// The receiver: [-½, ½]² in the plane z = 0. It is the first shape.
const AREA: f64 = 1.0;

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

fn shape(scene: &mut Scene, geometry: Geometry, to_world: Transform, emission: Option<Handle<Texture>>) {
    let reflectance = scene.textures.constant(Rgb::splat(0.5));
    let material = scene.materials.push(Material::Diffuse { reflectance });
    let name = format!("shape {}", scene.shapes.len());
    let (flip_normals, boundary) = (false, Boundary::default());
    scene.shapes.push(Shape { name, geometry, to_world, material, emission, flip_normals, boundary });
}

fn light(scene: &mut Scene, kind: LightKind) {
    let name = format!("light {}", scene.lights.len());
    scene.lights.push(Light { name, kind, medium: None });
}

/// The receiver under a square and a ball that shine, a point and a parallel beam and the sky; and with what makes photons
/// start unevenly if asked for. Where there is an endless plane no light is aimed.
fn scene(uneven: bool, plane: bool) -> World {
    let mut scene = empty();
    let half = |size: f64| Transform::scale(DVec3::new(size, size, 1.0));
    shape(&mut scene, Geometry::Rectangle, half(0.5), None);
    let glow = scene.textures.constant(Rgb::new(2.0, 3.0, 4.0));
    let down = Transform::rotate(DVec3::new(1.0, 0.3, 0.0), 160.0);
    let lamp = half(0.3).then(down).then(Transform::translate(DVec3::new(0.3, -0.4, 1.2)));
    shape(&mut scene, Geometry::Rectangle, lamp, Some(glow));
    let ball = Geometry::Sphere { center: Vec3::new(-0.9, 0.5, 0.8), radius: 0.25 };
    shape(&mut scene, ball, Transform::IDENTITY, Some(glow));
    light(&mut scene, LightKind::Point { position: Vec3::new(0.9, 0.8, 0.5), intensity: Rgb::splat(0.7) });
    let direction = Vec3::new(0.4, 0.1, -1.0).normalize();
    light(&mut scene, LightKind::Directional { direction, irradiance: Rgb::splat(0.9) });
    if uneven {
        let to_world = Transform::look_at(DVec3::new(-0.5, -0.9, 1.0), DVec3::ZERO, DVec3::Z).expect("a way");
        let (cutoff_deg, beam_width_deg, texture) = (35.0, 10.0, None);
        let intensity = Rgb::splat(3.0);
        light(&mut scene, LightKind::Spot { to_world, intensity, cutoff_deg, beam_width_deg, texture });
        let mut image = Image::filled(8, 4, Rgb::splat(0.1));
        image.pixels[2] = Rgb::new(3.0, 2.0, 1.0);
        let image = scene.textures.images.push(image.into());
        let upright = Transform::rotate(DVec3::X, 90.0);
        light(
            &mut scene,
            LightKind::Environment {
                image,
                mapping: EnvironmentMapping::Equirectangular,
                scale: 1.0,
                to_world: upright,
            },
        );
    } else {
        light(&mut scene, LightKind::Constant { radiance: Rgb::splat(0.3) });
    }
    if plane {
        shape(&mut scene, Geometry::Plane, Transform::translate(DVec3::new(0.0, 0.0, -1.0)), None);
    }
    World::new(scene).expect("a sound scene")
}

/// For each light what of its paths lands on the receiver first, as a number for each piece of work: how many, or their
/// power, of one path that is sent.
fn landed(world: &World, by_power: bool) -> Vec<Vec<f64>> {
    let mut all = vec![Vec::new(); world.light_count()];
    for piece in 0..PIECES {
        let mut sums = vec![0.0; world.light_count()];
        for path in 0..PATHS {
            let mut sampler =
                Sampler::new(Sequence::Independent, Key::new(3, piece, Stream::LightPaths), path);
            let mut books = Ledger::new(world.light_count()).lights;
            let (settings, map) = (WalkSettings::default(), MapKind::Global);
            let (mut from, mut power) = (0, 0.0);
            walk(world, &settings, map, path, &mut sampler, &mut books, |event, _| match event {
                Event::Start(Start { light, power: started, .. }) => {
                    (from, power) = (*light, f64::from(started.mean()));
                    Next::Continue
                }
                Event::Surface(_, lit) => {
                    if matches!(lit.scatterer, Scatterer::Surface { hit, .. } if hit.shape == 0) {
                        sums[from] += if by_power { power } else { 1.0 };
                    }
                    Next::Stop
                }
                _ => Next::Stop,
            });
        }
        all.iter_mut().zip(sums).for_each(|(light, sum)| light.push(sum / PATHS as f64));
    }
    all
}

/// The same as densities have it: the receiver's points ask the light.
fn said(world: &World, light: usize) -> Vec<f64> {
    let emitter = &world.emitters()[light];
    let sum = |piece: u64| {
        let mut sum = 0.0;
        for number in 0..PATHS {
            let mut sampler = Sampler::new(Sequence::Independent, Key::new(4, piece, Stream::Pilot), number);
            let place = (sampler.next_2d() - 0.5).extend(1e-3);
            let hit = world.intersect(&Ray::new(place, Vec3::NEG_Z)).expect("the receiver");
            let (point, from) = (hit.point, hit.point.position);
            let asker = Asker::on(&point);
            let u = sampler.next_2d();
            let Some(incident) = emitter.sample_incident(world.lookup(), from, u) else { continue };
            let (wi, radiance) = (incident.wi, incident.radiance);
            // Nothing lands on its back.
            if wi.dot(point.ng) <= 0.0 {
                continue;
            }
            let vantage = Vantage::Surface(&point);
            let seen =
                world.light_through(vantage, Surroundings::default(), wi, &incident.source, &mut sampler);
            let lamp = match &incident.source {
                source if incident.dirac => LampEnd::dirac(world, light, source, wi, radiance, &asker),
                Source::Surface(lit) => LampEnd::on_surface(world, light, lit, radiance, &asker),
                _ => LampEnd::in_sky(world, light, wi, radiance, &asker),
            };
            let [_, here] = Place::Surface { position: from, ng: point.ng }.between(&lamp.place);
            // What is asked of this light alone comes with the density of the point over the chance of the light.
            let asked = choice(world, light, &asker, DirectLights::One);
            let exact = emitter.sample_incident(world.lookup(), from, u).map_or(0.0, |i| i.pdf_solid_angle);
            let per_solid_angle = match &lamp.place {
                Place::Surface { position, ng } => {
                    let way = from - *position;
                    lamp.node.arrival * way.length_squared() / ng.dot(way.normalize()).abs()
                }
                _ => lamp.node.arrival,
            };
            let right = (per_solid_angle / (asked * exact) - 1.0).abs() < 1e-3;
            assert!(right, "light {light} is asked with {per_solid_angle}, not {asked} times {exact}");
            sum += f64::from(seen.mean() * asked * lamp.leaving * here);
        }
        AREA * sum / PATHS as f64
    };
    (0..PIECES).map(sum).collect()
}

#[track_caller]
fn agree(name: &str, found: &[f64], exact: &[f64]) {
    let (found, exact): (MeanTest, MeanTest) =
        (found.iter().copied().collect(), exact.iter().copied().collect());
    let noise = [&found, &exact].map(|test| test.standard_error() / test.mean());
    assert!(noise.iter().all(|noise| *noise < 0.06), "{name}: {noise:?}");
    let outcome = found.welch(&exact);
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

/// Where light is not aimed and shines evenly, so many paths start as densities say.
#[test]
fn so_many_paths_land_as_densities_say() {
    let world = scene(false, true);
    assert!(world.aims().global.is_none());
    for (light, found) in landed(&world, false).iter().enumerate() {
        agree(&world.emitters()[light].name, found, &said(&world, light));
    }
}

/// Where some of it is aimed, or starts unevenly, paths have the power that is missing.
#[test]
fn so_much_power_lands_as_densities_say() {
    for plane in [false, true] {
        let world = scene(true, plane);
        for (light, found) in landed(&world, true).iter().enumerate() {
            let (sent, table) = match &world.aims().global {
                Some(aim) => (aim.sent[light], Some(&aim.lights)),
                None => (world.emitters()[light].power.mean(), world.lights_by_power()),
            };
            let chance = table.map_or(0.0, |table| table.pmf(light));
            let power = f64::from(sent / chance);
            let said: Vec<f64> = said(&world, light).iter().map(|share| share * power).collect();
            agree(&format!("{}, plane: {plane}", world.emitters()[light].name), found, &said);
        }
    }
}
