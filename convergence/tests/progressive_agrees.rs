//! All integrators against one another, in scenes that have everything between them: light tracing where nothing is seen
//! by mirrors or through glass, photon mapping, and progressive photon mapping and vertex connection and merging in
//! iterations from the 20th on.
//!
//! Photon maps blur, and more so where surfaces meet; with as few photons as are sent here, that is forgiven as stated
//! beside each scene: so much of the whole picture and twice that of a quarter of it. Beyond that the tests of the file
//! share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct code would fail somewhere with
//! probability 1 %. The difference of whole pictures has a standard error
//! below 2.5 % everywhere, which is asserted, and mostly below 1 %; about eight of them are found.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::integrator::{FinalGather, Method, PhotonMapperConfig, PpmConfig, VcmConfig};
use nephroid::light::{EnvironmentMapping, LightKind};
use nephroid::material::Material;
use nephroid::math::{Affine2, DVec3, Transform, Vec2, Vec3};
use nephroid::medium::{Coefficient, GridValues, Medium, Phase};
use nephroid::shape::Geometry;
use nephroid::texture::{Checkerboard, Image, Texture};
use nephroid::world::World;
use nephroid_convergence::{
    Builder, block_samples, boxed, cloud_over_floor, facing, foggy_niche, forgiving, light_tracer,
    photon_mapper, progressive, renders, single_iterations, volpath,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// Pixels of a picture's side, and of a block's: four blocks and the whole are compared.
const SIDE: usize = 16;
const BLOCK: usize = 8;

/// Scenes, ways, and parts of a picture.
const TESTS: usize = 9 * 5 * 5;

/// Seeds of each method.
const SEEDS: u64 = 8;

/// The blocks and, last, the whole.
fn parts(pictures: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut parts = block_samples(pictures, SIDE, BLOCK);
    parts.extend(block_samples(pictures, SIDE, SIDE));
    parts
}

#[track_caller]
fn agree(name: &str, found: &[Vec<f64>], exact: &[Vec<f64>], bias: f64) {
    let (found, exact) = (parts(found), parts(exact));
    let last = found.len() - 1;
    for (part, (found, exact)) in found.iter().zip(&exact).enumerate() {
        let forgiven = if part == last { bias } else { 2.0 * bias };
        let exact: MeanTest = forgiving(found, exact, forgiven).into_iter().collect();
        let found: MeanTest = found.iter().copied().collect();
        let outcome = found.welch(&exact);
        assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}, part {part}: {outcome}");
        let deviation = libm::hypot(found.standard_error(), exact.standard_error()) / exact.mean();
        assert!(part < last || deviation < 0.025, "{name}: too few samples, {deviation}");
    }
}

/// How a method's pictures are made.
enum Pictures {
    /// Of so many camera samples.
    Samples(u32),
    /// See [`late`].
    Late,
}

/// The ways to see a scene, path tracing aside: what each is called, how far it may be off and how its pictures are made.
/// `specular` where mirrors or glass are seen, which light tracing leaves black; `bias` is what photons blur.
fn ways(specular: bool, bias: f64) -> Vec<(String, Method, f64, Pictures)> {
    let mut ways = Vec::new();
    if !specular {
        ways.push(("ptracer".to_string(), light_tracer(None), 0.0, Pictures::Samples(64)));
    }
    // Maps that few paths reach stay small: they would take most of the time.
    let mapper = PhotonMapperConfig { volume_photons: Some(10_000), emit_max: 10, ..photon_mapper(10_000) };
    let once = Method::PhotonMapper(mapper.clone());
    ways.push(("photon mapper".to_string(), once, bias, Pictures::Samples(8)));
    for final_gather in [FinalGather::Auto, FinalGather::Off] {
        let Method::Ppm(config) = progressive(PhotonMapperConfig { final_gather, ..mapper.clone() }) else {
            unreachable!("it is progressive")
        };
        let method = Method::Ppm(PpmConfig { samples_per_pixel: Some(6), ..config });
        ways.push((format!("ppm, gather {final_gather:?}"), method, bias, Pictures::Late));
    }
    let vcm = VcmConfig { mapper, light_paths: Some(8000), ..VcmConfig::default() };
    ways.push(("vcm".to_string(), Method::Vcm(vcm), bias, Pictures::Late));
    ways
}

fn all_agree(b: Builder, specular: bool, bias: f64) {
    let world = b.build();
    assert_eq!(world.remarks(), []);
    let exact = renders(&world, &volpath(None), 96, 0..SEEDS);
    for (first, (name, method, bias, pictures)) in (1..).map(|i| 100 * i).zip(ways(specular, bias)) {
        let found = match pictures {
            Pictures::Samples(samples) => renders(&world, &method, samples, first..first + SEEDS),
            Pictures::Late => late(&world, &method),
        };
        agree(&name, &found, &exact, bias);
    }
}

/// Means of the iterations 20 and 21.
fn late(world: &World, method: &Method) -> Vec<Vec<f64>> {
    let iterations = [20, 21].map(|i| single_iterations(world, method, i, 300..300 + SEEDS));
    let mean = |seed: usize| {
        (0..SIDE * SIDE)
            .map(|pixel| iterations.iter().map(|pictures| pictures[seed][pixel]).sum::<f64>() / 2.0)
            .collect()
    };
    (0..SEEDS as usize).map(mean).collect()
}

fn coloured(b: &mut Builder, color: Rgb) -> Handle<Material> {
    let reflectance = b.scene.textures.constant(color);
    b.scene.materials.push(Material::Diffuse { reflectance })
}

fn room() -> Builder {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 36.0, SIDE as u32);
    b.niche(0.6);
    b
}

#[test]
fn in_a_diffuse_room() {
    let mut b = room();
    b.ceiling_lamp(0.3, 10.0);
    let (red, green) = (coloured(&mut b, Rgb::new(0.8, 0.1, 0.1)), coloured(&mut b, Rgb::new(0.1, 0.7, 0.2)));
    let turned = Transform::rotate(DVec3::Y, 25.0);
    b.shape(Geometry::Cube, turned.then(boxed(DVec3::new(-0.4, -0.6, -0.2), DVec3::splat(0.4))), red);
    b.sphere(Vec3::new(0.45, -0.6, 0.2), 0.4, green);
    all_agree(b, false, 0.015);
}

/// Under a lamp so large that paths find it through the glass.
#[test]
fn with_a_mirror_and_a_glass_ball() {
    let mut b = room();
    b.ceiling_lamp(0.9, 1.0);
    let (glass, mirror) = (b.glass(1.5), b.mirror(0.9));
    b.sphere(Vec3::new(-0.45, -0.55, 0.2), 0.4, glass);
    b.sphere(Vec3::new(0.45, -0.55, -0.2), 0.4, mirror);
    all_agree(b, true, 0.02);
}

#[test]
fn with_glossy_surfaces() {
    let mut b = room();
    b.ceiling_lamp(0.5, 4.0);
    let (some, more) = (b.constant(0.2), b.constant(0.6));
    let glossy = b.scene.materials.push(Material::Phong {
        diffuse_reflectance: some,
        specular_reflectance: more,
        exponent: 15.0,
    });
    b.sphere(Vec3::new(0.0, -0.4, 0.0), 0.55, glossy);
    all_agree(b, false, 0.015);
}

#[test]
fn under_a_spot_and_a_sky() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 1.5, 4.0), Vec3::ZERO, 36.0, SIDE as u32);
    let (white, grey) = (b.diffuse(0.8), b.diffuse(0.5));
    b.shape(Geometry::Rectangle, facing(DVec3::NEG_Y, 2.0, DVec3::X, -90.0), white);
    b.sphere(Vec3::new(0.0, -0.3, 0.0), 0.7, grey);
    let spot = Transform::look_at(DVec3::new(2.0, 3.0, 1.0), DVec3::ZERO, DVec3::Y).expect("a direction");
    b.light(LightKind::Spot {
        to_world: spot,
        intensity: Rgb::new(12.0, 10.0, 8.0),
        cutoff_deg: 25.0,
        beam_width_deg: 15.0,
        texture: None,
    });
    let mut image = Image::filled(4, 2, Rgb::splat(0.2));
    image.pixels[1] = Rgb::new(1.0, 0.7, 0.4);
    let image = b.scene.textures.images.push(image.into());
    b.light(LightKind::Environment {
        mapping: EnvironmentMapping::Equirectangular,
        image,
        scale: 1.0,
        to_world: Transform::IDENTITY,
    });
    all_agree(b, false, 0.02);
}

#[test]
fn with_textures_and_masks() {
    let mut b = room();
    b.ceiling_lamp(0.4, 6.0);
    let (color0, color1) = (b.constant(0.1), b.scene.textures.constant(Rgb::new(0.9, 0.8, 0.5)));
    let to_uv = Affine2::from_scale(Vec2::splat(2.0));
    let board = Texture::Checkerboard(Checkerboard { color0, color1, to_uv });
    let reflectance = b.scene.textures.push(board);
    let tiles = b.scene.materials.push(Material::Diffuse { reflectance });
    let (half, white) = (b.constant(0.5), b.diffuse(0.8));
    let paper = b.two_sided(white);
    let veil = b.scene.materials.push(Material::Mask { opacity: half, inside: paper });
    b.shape(Geometry::Rectangle, facing(DVec3::new(0.0, -0.6, 0.0), 0.7, DVec3::X, -90.0), tiles);
    b.shape(Geometry::Rectangle, facing(DVec3::new(0.1, 0.1, 0.2), 0.5, DVec3::X, -60.0), veil);
    all_agree(b, false, 0.025);
}

#[test]
fn in_fog() {
    all_agree(
        foggy_niche(SIDE as u32, Rgb::splat(0.8), Rgb::splat(0.9), Phase::HenyeyGreenstein { g: 0.3 }),
        false,
        0.025,
    );
}

#[test]
fn with_a_cloud() {
    all_agree(cloud_over_floor(SIDE as u32, true, false), false, 0.025);
}

#[test]
fn with_gas_that_gives_off_light() {
    let mut b = room();
    let cells = (0..27).map(|i| (i % 4) as f32 / 3.0).collect();
    let (low, size) = (DVec3::splat(-0.5), DVec3::splat(1.0));
    let grid = b.grid(low, low + size, [3, 3, 3], GridValues::Grey(cells));
    let gas =
        Medium { sigma_t: grid, ..Medium::homogeneous("gas", Rgb::BLACK, Rgb::splat(0.6), Phase::Isotropic) };
    let gas = Medium { emission: Coefficient::Constant(Rgb::new(2.0, 1.5, 1.0)), ..gas };
    let gas = b.medium(gas);
    b.box_of(low, low + size, gas);
    all_agree(b, false, 0.025);
}

/// Glass and water that overlap, over a floor.
#[test]
fn with_nested_dielectrics() {
    let mut b = Builder::seen_from(Vec3::new(0.3, 5.0, 0.2), Vec3::ZERO, 12.0, SIDE as u32);
    for (ior, from, to, priority) in [(1.5, 0.0, 1.0, 1), (1.33, 0.9, 2.0, 0)] {
        let material = b.glass(ior);
        let to_world =
            boxed(DVec3::new(0.0, 0.5 * (from + to), 0.0), DVec3::new(3.0, 0.5 * (to - from), 3.0));
        b.shape(Geometry::Cube, to_world, material).boundary.priority = Some(priority);
    }
    let (white, black, radiance) = (b.diffuse(0.5), b.diffuse(0.0), b.constant(5.0));
    b.shape(Geometry::Rectangle, facing(DVec3::new(0.0, -0.5, 0.0), 3.0, DVec3::X, -90.0), white);
    let lamp = facing(DVec3::new(0.0, 6.0, 0.0), 1.0, DVec3::X, 90.0);
    b.shape(Geometry::Rectangle, lamp, black).emission = Some(radiance);
    all_agree(b, true, 0.02);
}
