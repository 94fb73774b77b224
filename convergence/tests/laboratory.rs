//! What the laboratory tells against what a render does: the same bits, or sums up to rounding.

use std::collections::BTreeMap;

use nephroid::color::Rgb;
use nephroid::film::{Aov, AovImage, Filter};
use nephroid::integrator::{
    Components, DirectSource, FinalGather, LightPart, MapName, Method, PathConfig, PhotonMapperConfig, Show,
};
use nephroid::laboratory::{InspectedSample, Inspector, PhotonColor, PhotonPicture, photon_picture};
use nephroid::material::Material;
use nephroid::math::{Transform, Vec3};
use nephroid::observer::Silent;
use nephroid::session::{RenderSettings, Session};
use nephroid::shape::Geometry;
use nephroid::texture::Image;
use nephroid::world::World;
use nephroid_convergence::{Builder, photons_of};

const SIDE: u32 = 12;

/// A closed room with a glass, a mirror and a glossy ball and two lamps, seen through a filter with
/// negative lobes.
fn room() -> World {
    let mut b = Builder::seen_from(Vec3::new(0.3, 0.2, 3.2), Vec3::new(0.0, -0.3, 0.0), 70.0, SIDE);
    b.scene.film.filter = Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 };
    let (white, glass, mirror) = (b.diffuse(0.7), b.glass(1.5), b.mirror(0.9));
    let (some, more) = (b.constant(0.3), b.constant(0.4));
    let glossy = b.scene.materials.push(Material::Phong {
        diffuse_reflectance: some,
        specular_reflectance: more,
        exponent: 20.0,
    });
    b.shape(Geometry::Cube, Transform::scale(nephroid::math::DVec3::new(2.0, 1.5, 4.0)), white)
        .flip_normals = true;
    b.sphere(Vec3::new(-0.8, -0.9, 0.3), 0.6, glass);
    b.sphere(Vec3::new(0.8, -0.9, -0.5), 0.6, mirror);
    b.sphere(Vec3::new(0.3, -1.2, 0.9), 0.3, glossy);
    b.point_light(Vec3::new(0.0, 1.2, 0.0), 2.0);
    let radiance = b.scene.textures.constant(Rgb::new(3.0, 2.0, 1.0));
    b.sphere(Vec3::new(-1.2, 0.8, 1.0), 0.15, white).emission = Some(radiance);
    b.build()
}

fn few_photons() -> PhotonMapperConfig {
    PhotonMapperConfig { photons: 3000, caustic_photons: 2000, ..PhotonMapperConfig::default() }
}

/// Every way in which look-ups are combined.
fn methods() -> Vec<Method> {
    let base = few_photons;
    let mut methods = vec![Method::Path(PathConfig::default())];
    for direct in [DirectSource::Rays, DirectSource::Map] {
        for final_gather in [FinalGather::Off, FinalGather::Auto, FinalGather::Rays(3)] {
            methods.push(Method::PhotonMapper(PhotonMapperConfig { direct, final_gather, ..base() }));
        }
        for show in [Show::Direct, Show::Global, Show::Caustic, Show::Indirect] {
            methods.push(Method::PhotonMapper(PhotonMapperConfig { direct, show, ..base() }));
        }
    }
    methods.push(Method::PhotonMapper(PhotonMapperConfig { max_depth: Some(4), ..base() }));
    methods
}

/// Renders so many iterations of 10 samples: two whole steps and one of two samples each.
fn rendered<'w>(world: &'w World, method: &Method, iterations: u64, aovs: &[Aov]) -> Session<'w> {
    let mut session = Session::new(world, settings(method), &Silent).with_aovs(aovs);
    while session.statistics().iterations < iterations || !session.iteration_is_complete() {
        assert!(session.step(&Silent), "nothing cancels");
    }
    session
}

fn settings(method: &Method) -> RenderSettings {
    RenderSettings { method: method.clone(), samples_per_pixel: 10, seed: 5 }
}

fn close(a: Rgb, b: Rgb, scale: f32) -> bool {
    (a - b).to_array().into_iter().all(|d| d.abs() <= 2e-5 * scale.max(1e-3))
}

#[test]
fn an_inspected_pixel_is_that_of_the_render_to_the_bit() {
    let world = room();
    for method in methods() {
        let image = rendered(&world, &method, 2, &[]).film().develop();
        for (x, y) in [(0, 0), (3, 9), (7, 8)] {
            let mut inspector = Inspector::new(&world, settings(&method), (x, y), &Silent);
            while inspector.iterations() < 2 {
                assert!(inspector.step(&Silent), "nothing cancels");
            }
            let report = inspector.finish();
            assert_eq!(report.samples.len(), 20);
            let pixel = image.pixels[(y * SIDE + x) as usize];
            assert_eq!(report.radiance, pixel, "{method:?} at {x}, {y}");
            assert!(close(report.light.total(), pixel, pixel.max_channel()), "{method:?} at {x}, {y}");
        }
    }
}

/// What rays and photons of a sample bring to each part.
fn told(sample: &InspectedSample) -> Components {
    let mut parts: BTreeMap<&str, Rgb> = BTreeMap::new();
    let contributions =
        sample.look_ups.iter().flat_map(|l| l.contributions.iter().map(|c| (c.part, c.radiance)));
    // What gather rays find in media is light of the surface that they left.
    let media = sample.media.iter().map(|passed| match passed.gather_ray {
        None => (LightPart::Medium, passed.light.total()),
        Some(_) => (LightPart::Global, passed.light.total()),
    });
    let rays = sample.rays.iter().map(|r| (r.part, r.radiance));
    for (part, radiance) in rays.chain(contributions).chain(media) {
        let name = match part {
            LightPart::Emitted => "emitted",
            LightPart::Direct => "direct",
            LightPart::Global => "global",
            LightPart::Caustic => "caustic",
            LightPart::Medium => "medium",
        };
        *parts.entry(name).or_insert(Rgb::BLACK) += radiance;
    }
    let part = |name| parts.get(name).copied().unwrap_or(Rgb::BLACK);
    Components {
        emitted: part("emitted"),
        direct: part("direct"),
        global: part("global"),
        caustic: part("caustic"),
        medium: part("medium"),
    }
}

#[test]
fn what_rays_and_photons_bring_adds_up_to_each_sample() {
    let world = room();
    let (mut photons, mut gathered) = (0, 0);
    for method in methods() {
        for pixel in [(3, 9), (7, 8)] {
            let mut inspector = Inspector::new(&world, settings(&method), pixel, &Silent);
            while inspector.iterations() < 1 {
                assert!(inspector.step(&Silent), "nothing cancels");
            }
            for sample in inspector.finish().samples {
                let (told, light) = (told(&sample), sample.light);
                let scale = light.total().max_channel();
                for part in LightPart::ALL {
                    let (told, light) = (told.part(part), light.part(part));
                    assert!(
                        close(told, light, scale),
                        "{method:?} {pixel:?} {part:?}: {told:?}, not {light:?}"
                    );
                }
                for look_up in &sample.look_ups {
                    let counted: u32 = look_up.contributions.iter().map(|c| c.photons).sum();
                    assert!(counted <= look_up.count && look_up.surface < sample.surfaces.len());
                    photons += counted;
                    gathered += usize::from(sample.surfaces[look_up.surface].gather_ray.is_some());
                    for c in &look_up.contributions {
                        let path = c.bounces.to_string();
                        let caustic = path.len() > 2 && path[1..path.len() - 1].chars().all(|l| l == 'S');
                        assert_eq!(caustic, look_up.map == MapName::Caustic, "{path} in {:?}", look_up.map);
                    }
                }
            }
        }
    }
    assert!(photons > 10_000 && gathered > 100, "{photons} photons, {gathered} look-ups of gather rays");
}

fn layer(session: &Session<'_>, aov: Aov) -> AovImage {
    session.aovs().and_then(|film| film.develop(aov)).expect("a value that was asked for")
}

fn sum_of_parts(session: &Session<'_>, pixel: usize) -> Rgb {
    [Aov::Direct, Aov::Global, Aov::Caustic, Aov::Emitted]
        .map(|aov| layer(session, aov))
        .iter()
        .map(|l| Rgb::new(l.channels[0][pixel], l.channels[1][pixel], l.channels[2][pixel]))
        .sum()
}

#[test]
fn the_parts_of_the_light_add_up_to_the_picture() {
    let world = room();
    for method in methods() {
        let plain = rendered(&world, &method, 2, &[]).film().develop();
        let session = rendered(&world, &method, 2, &Aov::ALL);
        let picture: Image = session.film().develop();
        assert_eq!(picture, plain, "{method:?}: further values change nothing");
        for (i, pixel) in picture.pixels.iter().enumerate() {
            let sum = sum_of_parts(&session, i);
            assert!(close(sum, *pixel, pixel.max_channel()), "{method:?}: {sum:?}, not {pixel:?}");
        }
    }
}

#[test]
fn further_values_have_the_same_bits_on_any_number_of_threads() {
    let world = room();
    let render = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| rendered(&world, &Method::PhotonMapper(few_photons()), 2, &Aov::ALL).aovs().cloned())
    };
    assert_eq!(render(1), render(5));
}

/// A floor of albedo 0.25, a unit below the camera, which looks straight down.
fn floor(glass: bool) -> World {
    let mut b = Builder::seen_from(Vec3::ZERO, Vec3::new(0.0, -1.0, 0.0), 10.0, 2);
    let grey = b.diffuse(0.25);
    let mut turned = Transform::rotate(nephroid::math::DVec3::X, -90.0);
    turned = turned.then(Transform::scale(nephroid::math::DVec3::splat(4.0)));
    let down = |y: f64| turned.then(Transform::translate(nephroid::math::DVec3::new(0.0, y, 0.0)));
    b.shape(Geometry::Rectangle, down(-1.0), grey);
    if glass {
        let glass = b.glass(1.5);
        b.shape(Geometry::Rectangle, down(-0.5), glass);
        b.shape(Geometry::Rectangle, down(-0.6), glass).flip_normals = true;
    }
    b.point_light(Vec3::new(0.0, -0.1, 0.0), 1.0);
    b.build()
}

#[test]
fn values_of_surfaces_are_those_of_the_scene() {
    let methods = [Method::Path(PathConfig::default()), Method::PhotonMapper(few_photons())];
    for (method, glass) in methods.iter().flat_map(|m| [(m, false), (m, true)]) {
        let world = floor(glass);
        let session = rendered(&world, method, 40, &Aov::ALL);
        let mean = |aov| {
            let mean = |c: &Vec<f32>| c.iter().sum::<f32>() / c.len() as f32;
            layer(&session, aov).channels.iter().map(mean).collect::<Vec<_>>()
        };
        // Through the plate as dim as light is: 2/(1+R)-fold reflections left aside, (1 − R)² at normal
        // incidence with R = 4 %. The path tracer chooses by chance: five standard errors are 0.01.
        let albedo = if glass { 0.25 * 0.96f32.powi(2) } else { 0.25 };
        let error = (mean(Aov::Albedo)[0] - albedo).abs();
        assert!(
            error < if glass { 0.012 } else { 1e-6 },
            "{method:?}: {:?}, not {albedo}",
            mean(Aov::Albedo)
        );
        let depth = if glass { 0.5 } else { 1.0 };
        assert!((mean(Aov::Depth)[0] / depth - 1.0).abs() < 0.01, "{:?}", mean(Aov::Depth));
        assert!((mean(Aov::Position)[1] + depth).abs() < 1e-6);
        assert!((mean(Aov::GeometricNormal)[1] - 1.0).abs() < 1e-6);
        let normal = mean(Aov::Normal)[1];
        assert!((normal - 4.0 * albedo).abs() < 0.05, "{normal}");
    }
}

#[test]
fn recorded_photons_are_those_of_the_maps() {
    let world = room();
    let config = few_photons();
    let method = Method::PhotonMapper(config.clone());
    let session = rendered(&world, &method, 1, &[]);
    let statistics = session.statistics();
    let recorded = photons_of(&world, &config, 10, 5, 0).expect("nothing cancels");
    assert_eq!(recorded.plan, statistics.plan.photons);
    let of = |map| recorded.photons.iter().filter(move |p| p.map == map);
    assert_eq!(of(MapName::Global).count() as u64, statistics.global.photons);
    assert_eq!(of(MapName::Caustic).count() as u64, statistics.caustic.photons);
    // Power that arrives cannot be more than is given off, and single photons carry a share of it.
    let emitted: f32 = world.lights().map(|(_, power)| power.mean()).sum();
    let caustic: f32 = of(MapName::Caustic).map(|p| p.photon.power.mean()).sum();
    assert!(caustic > 0.001 * emitted && caustic < 0.5 * emitted, "{caustic} of {emitted} W");
    assert!(of(MapName::Caustic).all(|p| p.bounces.count() + 1 == u32::from(p.photon.depth)));
    let again = photons_of(&world, &config, 10, 5, 1).expect("nothing cancels");
    assert_ne!(again.photons[0], recorded.photons[0], "another iteration, other photons");
}

#[test]
fn pictures_show_photons_where_they_lie() {
    let world = room();
    let config = few_photons();
    let photons = photons_of(&world, &config, 10, 5, 0).expect("nothing cancels").photons;
    let draw = |through_walls| {
        let options = PhotonPicture { color: PhotonColor::Map, size: 1, through_walls };
        photon_picture(&world, &photons, &options)
    };
    let shown = |through_walls| draw(through_walls).1.iter().map(|entry| entry.photons).sum::<usize>();
    let (seen, all) = (shown(false), shown(true));
    assert!(seen > 500 && all > seen + 100, "{seen} of {all}");
    assert_eq!(draw(false), draw(false));
    let of_global = |p: &&nephroid::laboratory::MapPhoton| p.map == MapName::Global;
    let one: Vec<_> = photons.iter().filter(of_global).take(1).copied().collect();
    for color in [PhotonColor::Map, PhotonColor::Bounce, PhotonColor::Light, PhotonColor::Power] {
        let options = PhotonPicture { color, size: 3, through_walls: true };
        let (image, legend) = photon_picture(&world, &one, &options);
        let lit = image.pixels.iter().filter(|p| !p.is_black()).count();
        let expected: usize = legend.first().map_or(0, |entry| entry.photons);
        assert!(lit <= 9 * expected && expected <= 1, "{color:?}: {lit} pixels of {expected} photons");
    }
}
