//! Every kind of surface, by every method, against path tracing: what photons are stored and read at, what is followed and
//! what is left out must make up the whole, whichever lobes a surface has.
//!
//! What photons blur at edges is forgiven, so much of the whole picture and twice that of a quarter of it. Beyond that the tests
//! of the file share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct code would fail somewhere with
//! probability 1 %.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::integrator::{Method, PhotonMapperConfig, VcmConfig};
use nephroid::material::{Distribution, Material, Metal, MetallicRoughness, Principled, Roughness};
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::Geometry;
use nephroid::world::World;
use nephroid_convergence::{
    Builder, block_samples, boxed, facing, forgiving, iterated_renders, progressive, renders, volpath,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// Pixels of a picture's side, and of a block's: four blocks and the whole are compared.
const SIDE: usize = 16;
const BLOCK: usize = 8;

/// More than materials, methods, and parts of a picture.
const TESTS: usize = 24 * 4 * 5;

const SEEDS: u64 = 6;

/// How far a mean may be off where photons are merged, relative.
const BLUR: f64 = 0.02;

const COPPER: Metal = Metal::Index { eta: Rgb::new(0.2, 0.92, 1.1), k: Rgb::new(3.9, 2.45, 2.14) };

fn rough(b: &mut Builder, alpha: f32) -> Roughness {
    Roughness::isotropic(Distribution::Ggx, b.constant(alpha))
}

/// A niche under a lamp, a box of a material in it and a ball of another one.
fn room(b: &mut Builder, on_box: Handle<Material>, on_ball: Handle<Material>) {
    b.niche(0.6);
    let turned = Transform::rotate(DVec3::Y, 25.0);
    b.shape(Geometry::Cube, turned.then(boxed(DVec3::new(-0.4, -0.6, -0.2), DVec3::splat(0.4))), on_box);
    b.sphere(Vec3::new(0.45, -0.6, 0.2), 0.39, on_ball);
}

fn seen() -> Builder {
    Builder::seen_from(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 36.0, SIDE as u32)
}

fn parts(pictures: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut parts = block_samples(pictures, SIDE, BLOCK);
    parts.extend(block_samples(pictures, SIDE, SIDE));
    parts
}

/// Photons of fixed numbers: what pilots find is no part of the question.
fn methods() -> Vec<(&'static str, Method)> {
    let mapper = PhotonMapperConfig { emit: Some(30_000), neighbours: 40, ..PhotonMapperConfig::default() };
    vec![
        ("photonmapper", Method::PhotonMapper(mapper.clone())),
        ("ppm", progressive(mapper.clone())),
        ("vcm", Method::Vcm(VcmConfig { mapper, light_paths: Some(3000), ..VcmConfig::default() })),
    ]
}

#[track_caller]
fn agree(name: &str, found: &[Vec<f64>], exact: &[Vec<f64>], bias: f64) {
    let last = found.len() - 1;
    for (part, (found, exact)) in found.iter().zip(exact).enumerate() {
        let forgiven = if part == last { bias } else { 2.0 * bias };
        let exact: MeanTest = forgiving(found, exact, forgiven).into_iter().collect();
        let found: MeanTest = found.iter().copied().collect();
        let outcome = found.welch(&exact);
        assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}, part {part}: {outcome}");
        let deviation = libm::hypot(found.standard_error(), exact.standard_error()) / exact.mean();
        assert!(part < last || deviation < 0.04, "{name}: too few samples, {deviation}");
    }
}

/// Under a lamp that paths find.
#[track_caller]
fn all_agree(
    of_box: impl Fn(&mut Builder) -> Handle<Material>,
    of_ball: impl Fn(&mut Builder) -> Handle<Material>,
) {
    let mut b = seen();
    let (on_box, on_ball) = (of_box(&mut b), of_ball(&mut b));
    room(&mut b, on_box, on_ball);
    b.ceiling_lamp(0.3, 10.0);
    agree_with_paths(b);
}

#[track_caller]
fn agree_with_paths(b: Builder) {
    let world: World = b.build();
    assert_eq!(world.remarks(), []);
    let exact = parts(&renders(&world, &volpath(None), 256, 0..SEEDS));
    for (first, (name, method)) in (1..).map(|i| 100 * i).zip(methods()) {
        let found = parts(&iterated_renders(&world, &method, 2, 32, first..first + SEEDS));
        agree(name, &found, &exact, BLUR);
    }
}

fn push(b: &mut Builder, material: Material) -> Handle<Material> {
    b.scene.materials.push(material)
}

fn metal(b: &mut Builder, alpha: f32) -> Handle<Material> {
    let (specular_reflectance, roughness) = (b.constant(1.0), rough(b, alpha));
    push(b, Material::RoughConductor { metal: COPPER, specular_reflectance, roughness })
}

fn plastic(b: &mut Builder, alpha: Option<f32>) -> Handle<Material> {
    let (diffuse_reflectance, specular_reflectance) = (b.constant(0.5), b.constant(1.0));
    let roughness = alpha.map(|alpha| rough(b, alpha));
    let (int_ior, ext_ior, nonlinear) = (1.8, 1.0, true);
    push(
        b,
        Material::Plastic {
            int_ior,
            ext_ior,
            diffuse_reflectance,
            specular_reflectance,
            nonlinear,
            roughness,
        },
    )
}

fn frosted(b: &mut Builder, alpha: f32) -> Handle<Material> {
    let (white, roughness) = (b.constant(1.0), rough(b, alpha));
    push(
        b,
        Material::RoughDielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: white,
            specular_transmittance: white,
            roughness,
        },
    )
}

#[test]
fn rough_metals() {
    all_agree(|b| metal(b, 0.3), |b| metal(b, 0.15));
}

#[test]
fn metals_that_are_nearly_mirrors() {
    all_agree(|b| metal(b, 0.05), |b| metal(b, 0.09));
}

#[test]
fn smooth_plastic() {
    all_agree(|b| plastic(b, None), |b| plastic(b, None));
}

#[test]
fn rough_plastic() {
    all_agree(|b| plastic(b, Some(0.05)), |b| plastic(b, Some(0.3)));
}

#[test]
fn frosted_glass() {
    all_agree(|b| frosted(b, 0.3), |b| frosted(b, 0.5));
}

#[test]
fn glass_that_is_hardly_rough() {
    all_agree(|b| b.diffuse(0.5), |b| frosted(b, 0.05));
}

#[test]
fn metal_under_a_coat() {
    let coated = |b: &mut Builder, alpha: Option<f32>, coat: Option<f32>| {
        let specular_reflectance = b.constant(1.0);
        let (roughness, coat_roughness) = (alpha.map(|a| rough(b, a)), coat.map(|a| rough(b, a)));
        push(
            b,
            Material::CoatedConductor {
                metal: COPPER,
                specular_reflectance,
                roughness,
                coat_ior: 1.5,
                coat_roughness,
            },
        )
    };
    all_agree(|b| coated(b, Some(0.3), None), |b| coated(b, Some(0.05), Some(0.2)));
}

#[test]
fn paper_that_light_goes_through() {
    let leaf = |b: &mut Builder| {
        let (reflectance, transmittance) = (b.constant(0.3), b.constant(0.5));
        push(b, Material::DiffuseTransmission { reflectance, transmittance })
    };
    all_agree(leaf, leaf);
}

#[test]
fn mixtures() {
    let mixed = |b: &mut Builder| {
        let weight = b.constant(0.4);
        let (first, second) = (b.diffuse(0.6), b.mirror(0.9));
        push(b, Material::Blend { weight, first, second })
    };
    let half_metal = |b: &mut Builder| {
        let weight = b.constant(0.5);
        let (first, second) = (plastic(b, None), metal(b, 0.05));
        push(b, Material::Blend { weight, first, second })
    };
    all_agree(mixed, half_metal);
}

#[test]
fn principled() {
    let of = |roughness: f32, metallic: f32, clearcoat: f32| {
        move |b: &mut Builder| {
            let mut p = Principled::plain(&mut b.scene.textures);
            p.roughness = b.constant(roughness);
            p.metallic = b.constant(metallic);
            p.clearcoat = b.constant(clearcoat);
            p.clearcoat_gloss = b.constant(0.8);
            push(b, Material::Principled(Box::new(p)))
        }
    };
    all_agree(of(0.4, 0.3, 0.8), of(0.2, 0.9, 0.0));
}

#[test]
fn metallic_roughness() {
    let of = |roughness: f32, metallic: f32| {
        move |b: &mut Builder| {
            let mut m = MetallicRoughness::plain(&mut b.scene.textures);
            m.roughness = b.constant(roughness);
            m.metallic = b.constant(metallic);
            push(b, Material::MetallicRoughness(Box::new(m)))
        }
    };
    all_agree(of(0.6, 0.2), of(0.2, 0.0));
}

/// A wall of nearly smooth metal opposite to the lamp: much of the light comes to the others by it, and it is the only surface
/// that photons are followed at.
#[test]
fn walls_that_are_nearly_mirrors() {
    let mut b = seen();
    let (wall, grey) = (metal(&mut b, 0.05), b.diffuse(0.5));
    b.niche(0.6);
    b.shape(Geometry::Rectangle, facing(DVec3::new(0.0, -0.98, 0.0), 0.9, DVec3::X, -90.0), wall);
    b.sphere(Vec3::new(0.3, -0.4, 0.0), 0.4, grey);
    b.ceiling_lamp(0.3, 10.0);
    agree_with_paths(b);
}

/// A point light that shines through a ball of glass at a wall of nearly smooth metal: only photons bring its light there, and
/// no path from the camera. All that find it find as much.
#[test]
fn light_of_a_point_through_glass_on_metal() {
    let mut b = seen();
    let (wall, glass) = (metal(&mut b, 0.09), b.glass(1.5));
    b.niche(0.5);
    b.shape(Geometry::Cube, boxed(DVec3::new(0.0, -0.9, 0.0), DVec3::new(0.9, 0.1, 0.9)), wall);
    b.sphere(Vec3::new(0.0, -0.1, 0.0), 0.4, glass);
    b.point_light(Vec3::new(0.1, 0.8, 0.1), 1.0);
    let world = b.build();
    let of = |method: &Method, first| parts(&iterated_renders(&world, method, 4, 32, first..first + SEEDS));
    let [(_, mapper), (_, ppm), (_, vcm)] = &methods()[..] else { unreachable!("there are three") };
    let exact = of(vcm, 0);
    agree("photonmapper", &of(mapper, 100), &exact, 2.0 * BLUR);
    agree("ppm", &of(ppm, 200), &exact, 2.0 * BLUR);
}
