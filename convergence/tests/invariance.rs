//! Pictures that must not depend on the unit of length, on where the scene lies, on how many threads render it, or on
//! where the render was interrupted.
//!
//! The tests by chance share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct
//! code would fail somewhere in this file with probability 1 %. The others compare bits.

use nephroid::camera::{Camera, FovAxis, Projection};
use nephroid::color::Rgb;
use nephroid::film::{Aov, Film, FilmSettings, Filter};
use nephroid::handle::Arena;
use nephroid::integrator::{
    AutoConfig, DirectSource, FinalGather, Method, PathConfig, PhotonMapperConfig, PpmConfig, VcmConfig,
    VolumeEstimate,
};
use nephroid::light::{EnvironmentMapping, LightKind};
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec2, Vec3};
use nephroid::medium::Media;
use nephroid::observer::Silent;
use nephroid::scene::Scene;
use nephroid::session::{Place, RenderPlan, RenderSettings, Session};
use nephroid::shape::{Geometry, Mesh};
use nephroid::texture::{Image, Textures};
use nephroid::transport::VolumeKind;
use nephroid::world::World;
use nephroid_convergence::{Builder, balls_in_fog, iterations, light_tracer, means, session};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// As many as the pairs of means compared.
const TESTS: usize = 60;

/// A room, open to the sky in front, with surfaces of every shape and material and lights of every
/// kind, its unit of length `scale` and its place `place`.
fn room(scale: f64, place: Transform) -> World {
    let s = scale as f32;
    let whole = Transform::scale(DVec3::splat(scale)).then(place);
    let eye = Transform::look_at(DVec3::new(0.2, 1.1, 4.0), DVec3::new(0.0, 0.9, 0.0), DVec3::Y)
        .expect("a direction");
    // The camera is moved, not scaled: its directions would be the same.
    let eye = Transform(nephroid::math::DAffine3 { translation: eye.0.translation * scale, ..eye.0 });
    let projection =
        Projection::Perspective { fov_deg: 45.0, fov_axis: FovAxis::X, principal_point_offset: Vec2::ZERO };
    let mut b = Builder {
        scene: Scene {
            camera: Camera { to_world: eye.then(place), projection, medium: None },
            film: FilmSettings { width: 20, height: 20, crop: None, filter: Filter::Tent { radius: 1.0 } },
            textures: Textures::default(),
            materials: Arena::default(),
            meshes: Arena::default(),
            shapes: Vec::new(),
            groups: Arena::default(),
            instances: Vec::new(),
            lights: Vec::new(),
            media: Media::default(),
        },
    };
    shapes(&mut b);
    for shape in &mut b.scene.shapes {
        shape.to_world = shape.to_world.then(whole);
    }
    let at = |p: Vec3| whole.point(p);
    b.point_light(at(Vec3::new(-0.4, 1.6, 0.5)), 0.5 * s * s);
    let spot = Transform::look_at(DVec3::new(0.8, 1.9, 1.0), DVec3::new(0.2, 0.3, 0.0), DVec3::Y)
        .expect("a direction");
    b.light(LightKind::Spot {
        to_world: spot.then(whole),
        intensity: Rgb::new(2.0, 1.5, 1.0) * (s * s),
        cutoff_deg: 30.0,
        beam_width_deg: 20.0,
        texture: None,
    });
    let direction = place.vector(Vec3::new(0.2, -0.5, -1.0)).normalize();
    b.light(LightKind::Directional { direction, irradiance: Rgb::splat(0.7) });
    let mut image = Image::filled(4, 2, Rgb::splat(0.2));
    image.pixels[5] = Rgb::new(1.0, 0.7, 0.4);
    let image = b.scene.textures.images.push(image.into());
    b.light(LightKind::Environment {
        mapping: EnvironmentMapping::Equirectangular,
        image,
        scale: 0.5,
        to_world: place,
    });
    b.build()
}

fn shapes(b: &mut Builder) {
    let (white, glass, mirror) = (b.diffuse(0.7), b.glass(1.5), b.mirror(0.9));
    let tint = b.scene.textures.constant(Rgb::new(0.8, 0.4, 0.2));
    let red = b.scene.materials.push(Material::Diffuse { reflectance: tint });
    let (some, more) = (b.constant(0.3), b.constant(0.5));
    let glossy = b.scene.materials.push(Material::Phong {
        diffuse_reflectance: some,
        specular_reflectance: more,
        exponent: 30.0,
    });
    let (red, black) = (b.two_sided(red), b.diffuse(0.0));
    let floor = Transform::rotate(DVec3::X, -90.0);
    b.shape(Geometry::Plane, floor, white);
    let back = Transform::translate(DVec3::new(0.0, 0.0, -1.2));
    b.shape(Geometry::Rectangle, Transform::scale(DVec3::splat(2.0)).then(back), glossy);
    b.sphere(Vec3::new(-0.6, 0.4, 0.2), 0.4, glass);
    b.sphere(Vec3::new(0.5, 0.35, -0.5), 0.35, mirror);
    let cube = Transform::scale(DVec3::splat(0.2))
        .then(Transform::rotate(DVec3::Y, 30.0))
        .then(Transform::translate(DVec3::new(0.1, 0.2, 0.6)));
    b.shape(Geometry::Cube, cube, red);
    let (p0, p1) = (Vec3::new(0.8, 0.0, 0.3), Vec3::new(0.8, 0.7, 0.2));
    b.shape(Geometry::Cylinder { p0, p1, radius: 0.12 }, Transform::IDENTITY, red);
    let lying = floor.then(Transform::translate(DVec3::new(-0.2, 0.05, 1.0)));
    let veil = b.scene.materials.push(Material::Mask { opacity: more, inside: red });
    b.shape(Geometry::Disk, Transform::scale(DVec3::splat(0.3)).then(lying), veil);
    let mesh = Mesh {
        positions: [[-1.0, 0.5, -1.0], [-0.8, 1.4, -0.9], [-0.5, 0.6, -1.0], [-0.7, 0.8, -0.6]]
            .map(Vec3::from_array)
            .to_vec(),
        triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        ..Mesh::default()
    };
    b.mesh(mesh, red);
    let glow = b.constant(4.0);
    let ceiling = Transform::scale(DVec3::splat(0.3))
        .then(Transform::rotate(DVec3::X, 90.0))
        .then(Transform::translate(DVec3::new(0.0, 2.0, 0.0)));
    b.shape(Geometry::Rectangle, ceiling, black).emission = Some(glow);
    b.sphere(Vec3::new(-1.0, 1.2, 0.0), 0.1, black).emission = Some(glow);
}

/// The path tracer, paths from both ends, and photon mappers with everything that has a length in it.
/// So many paths are emitted for each map, or as many as a pilot finds to be needed.
fn methods(scale: f32, emit: Option<u64>) -> Vec<(&'static str, Method)> {
    let mapper = PhotonMapperConfig { photons: 2000, caustic_photons: 500, emit, ..Default::default() };
    let planned = PpmConfig { mapper: mapper.clone(), ..PpmConfig::default() };
    let planned = match emit {
        Some(_) => PpmConfig { plan_photons: false, samples_per_pixel: Some(1), ..planned },
        None => planned,
    };
    let limited = PhotonMapperConfig {
        final_gather: FinalGather::Off,
        max_radius: Some(0.3 * scale),
        ..mapper.clone()
    };
    let vcm = VcmConfig { mapper: mapper.clone(), light_paths: emit, ..VcmConfig::default() };
    vec![
        ("vcm", Method::Vcm(vcm.clone())),
        ("vcm, correlation", Method::Vcm(VcmConfig { correlation: true, connections: false, ..vcm })),
        ("auto", Method::Auto(AutoConfig { ppm: planned.clone(), ..AutoConfig::default() })),
        ("ppm", Method::Ppm(planned.clone())),
        (
            "ppm, limited radius",
            Method::Ppm(PpmConfig { mapper: limited.clone(), plan_photons: false, ..planned }),
        ),
        ("path", Method::Path(PathConfig::default())),
        ("ptracer", light_tracer(None)),
        ("photon mapper", Method::PhotonMapper(mapper.clone())),
        (
            "map on the spot",
            Method::PhotonMapper(PhotonMapperConfig {
                direct: DirectSource::Map,
                radius: Some(0.2 * scale),
                ..mapper
            }),
        ),
        ("limited radius", Method::PhotonMapper(limited)),
    ]
}

fn film(world: &World, method: Method, seed: u64) -> Film {
    session(world, method, 6, seed).film().clone()
}

/// Scales by powers of two change no bit.
#[test]
fn scales_by_powers_of_two_change_no_bit() {
    let unit = room(1.0, Transform::IDENTITY);
    let films: Vec<Film> = methods(1.0, None).into_iter().map(|(_, m)| film(&unit, m, 1)).collect();
    for exponent in [-10, 20] {
        let scale = libm::exp2(f64::from(exponent));
        let world = room(scale, Transform::IDENTITY);
        for ((name, method), reference) in methods(scale as f32, None).into_iter().zip(&films) {
            assert!(reference.mean_luminance() > 0.05);
            assert!(film(&world, method, 1) == *reference, "{name} at 2^{exponent}");
        }
    }
}

/// Other scales, turns and moves change nothing but the noise. The moves go a few hundred
/// times as far as the room is wide.
#[test]
fn scales_turns_and_moves_change_only_the_noise() {
    let turned = Transform::rotate(DVec3::new(1.0, -2.0, 0.7), 77.0);
    let moved = Transform::translate(DVec3::new(300.0, -200.0, 500.0));
    let places = [
        ("a thousandth", 1e-3, Transform::IDENTITY),
        ("a million", 1e6, Transform::IDENTITY),
        ("turned", 1.0, turned),
        ("moved", 1.0, moved),
        ("all of it", 0.3, turned.then(moved)),
    ];
    let unit = room(1.0, Transform::IDENTITY);
    // A progressive render has three iterations.
    let seeds_of = |method: &Method| if iterations(method) > 1 { 10 } else { 24 };
    let references: Vec<MeanTest> = methods(1.0, Some(4000))
        .iter()
        .map(|(_, m)| means(&unit, m, 4, 0..seeds_of(m)).into_iter().collect())
        .collect();
    for (first_seed, (place, scale, to_world)) in (1..).map(|i| 100 * i).zip(places) {
        let world = room(scale, to_world);
        for ((name, method), reference) in methods(scale as f32, Some(4000)).iter().zip(&references) {
            let seeds = first_seed..first_seed + seeds_of(method);
            let estimates: MeanTest = means(&world, method, 4, seeds).into_iter().collect();
            let outcome = estimates.welch(reference);
            assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}, {place}: {outcome}");
        }
    }
}

/// Any number of threads gives the same bits, and another seed gives others.
#[test]
fn threads_change_no_bit_and_seeds_do() {
    let world = room(1.0, Transform::IDENTITY);
    for (name, method) in methods(1.0, None) {
        let on = |threads: usize, seed: u64| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| film(&world, method.clone(), seed))
        };
        let alone = on(1, 1);
        for threads in [2, 7] {
            assert!(on(threads, 1) == alone, "{name} on {threads} threads");
        }
        assert!(on(2, 2) != alone, "{name} with another seed");
    }
}

/// The statistics of a render are part of its result.
#[test]
fn threads_change_nothing_in_the_statistics() {
    let world = room(1.0, Transform::IDENTITY);
    for (name, method) in methods(1.0, None) {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| session(&world, method.clone(), 2, 1).statistics().clone())
        };
        assert_eq!(on(1), on(5), "{name}");
    }
}

/// Balls in fog with all photon maps, read in each of the ways; the plan's numbers of samples are above one.
fn methods_in_fog() -> Vec<(&'static str, Method)> {
    let mapper = PhotonMapperConfig {
        photons: 1000,
        caustic_photons: 500,
        volume_photons: Some(500),
        ..PhotonMapperConfig::default()
    };
    let beams = PhotonMapperConfig { volume_kind: VolumeKind::Beams, ..mapper.clone() };
    let march = PhotonMapperConfig { volume_estimate: VolumeEstimate::March, ..mapper.clone() };
    let given = |mapper| {
        let plan = PpmConfig { plan_photons: false, samples_per_pixel: Some(3), ..PpmConfig::default() };
        Method::Ppm(PpmConfig { mapper, ..plan })
    };
    vec![
        ("ppm in fog", Method::Ppm(PpmConfig { mapper: mapper.clone(), ..PpmConfig::default() })),
        ("ppm with beams", given(beams)),
        ("ppm by marching", given(march)),
        ("vcm in fog", Method::Vcm(VcmConfig { mapper: mapper.clone(), ..VcmConfig::default() })),
        (
            "auto in fog",
            Method::Auto(AutoConfig {
                ppm: PpmConfig { mapper: mapper.clone(), ..PpmConfig::default() },
                ..AutoConfig::default()
            }),
        ),
        ("photon mapper in fog", Method::PhotonMapper(mapper)),
    ]
}

/// A plan follows from the scene, the settings and the seed: made again, by any number of threads, it is the same.
#[test]
fn plans_are_the_same_each_time() {
    let (room, fog) = (room(1.0, Transform::IDENTITY), balls_in_fog(12).build());
    let of_fog = methods_in_fog().into_iter().map(|named| (&fog, named));
    for (world, (name, method)) in methods(1.0, None).into_iter().map(|named| (&room, named)).chain(of_fog) {
        let plan = |threads: usize, seed: u64| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let settings = RenderSettings { method: method.clone(), samples_per_pixel: 6, seed };
            pool.install(|| RenderPlan::new(world, &settings, &Silent))
        };
        let first = plan(1, 1);
        for threads in [1, 2, 7] {
            assert_eq!(plan(threads, 1), first, "{name} on {threads} threads");
        }
        if name == "ppm" {
            assert_ne!(plan(1, 2), first, "trials of another seed find the same");
        }
    }
}

/// Three iterations in two sessions, cut after every step, and each step in a session of its own, the last one first:
/// the films are those of one session.
#[test]
fn parts_of_a_render_make_the_whole() {
    let (room, fog) = (room(1.0, Transform::IDENTITY), balls_in_fog(12).build());
    let of_fog = methods_in_fog().into_iter().map(|named| (&fog, named));
    for (world, (name, method)) in methods(1.0, None).into_iter().map(|named| (&room, named)).chain(of_fog) {
        let settings = RenderSettings { method, samples_per_pixel: 6, seed: 1 };
        let plan = RenderPlan::new(world, &settings, &Silent);
        let begin = |place: Place| {
            Session::with_plan(world, settings.clone(), plan)
                .with_aovs(&[Aov::Depth, Aov::Global])
                .starting_at(place)
        };
        // The place, the film and the further values after each step.
        let mut session =
            Session::new(world, settings.clone(), &Silent).with_aovs(&[Aov::Depth, Aov::Global]);
        let mut steps = vec![(session.place(), session.film().clone(), session.aovs().cloned())];
        while session.place().iteration < 2 || !session.iteration_is_complete() {
            assert!(session.step(&Silent), "nothing cancels");
            steps.push((session.place(), session.film().clone(), session.aovs().cloned()));
        }
        let (_, whole, aovs) = &steps[steps.len() - 1];
        assert!(whole.mean_luminance() > 0.01 && steps.len() >= 4, "{name}: something is rendered");
        for (done, (place, film, further)) in steps[..steps.len() - 1].iter().enumerate() {
            let mut rest =
                begin(*place).with_films(film.clone(), further.clone()).expect("films of one render");
            for _ in done + 1..steps.len() {
                assert!(rest.step(&Silent), "nothing cancels");
            }
            assert!(rest.film() == whole, "{name} from {place:?}");
            assert!(rest.aovs() == aovs.as_ref(), "further values of {name} from {place:?}");
        }
        let mut together: Option<Film> = None;
        for (place, ..) in steps[..steps.len() - 1].iter().rev() {
            let mut one = begin(*place);
            assert!(one.step(&Silent), "nothing cancels");
            match &mut together {
                None => together = Some(one.film().clone()),
                Some(film) => film.merge(one.film()).expect("films of one render"),
            }
        }
        assert!(together.as_ref() == Some(whole), "{name}, step by step");
    }
}
