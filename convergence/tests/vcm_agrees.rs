//! Vertex connection and merging against path tracing, with each of its techniques left out in turn: under every kind of
//! lamp, by every kind of camera, in scenes in which paths find all light.
//!
//! Without merging nothing blurs, and the means must be those of paths; what photons blur at edges is forgiven otherwise,
//! so much of the whole picture and twice that of a quarter of it. Beyond that the tests of the file share the level
//! [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct code would fail somewhere with probability 1 %.

use nephroid::camera::{FovAxis, Projection};
use nephroid::color::Rgb;
use nephroid::film::Crop;
use nephroid::integrator::{Method, PhotonMapperConfig, VcmConfig};
use nephroid::light::{EnvironmentMapping, LightKind};
use nephroid::material::Material;
use nephroid::math::{Affine2, DVec3, Transform, Vec2, Vec3};
use nephroid::medium::Phase;
use nephroid::shape::{Geometry, Group, Instance, Mesh};
use nephroid::texture::{Checkerboard, Image, Texture};
use nephroid::world::World;
use nephroid_convergence::{
    Builder, between, block_samples, boxed, facing, forgiving, iterated_renders, renders, volpath,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// Pixels of a picture's side, and of a block's: four blocks and the whole are compared.
const SIDE: usize = 16;
const BLOCK: usize = 8;

/// More than scenes, ways, and parts of a picture.
const TESTS: usize = 20 * 5 * 5;

/// Seeds of each way.
const SEEDS: u64 = 8;

/// How far a mean may be off where photons are merged, relative.
const BLUR: f64 = 0.015;

/// What is named, left out or not, and how far its means may be off.
fn ways(max_depth: Option<u32>) -> Vec<(&'static str, Method, f64)> {
    let mapper = PhotonMapperConfig { max_depth, ..PhotonMapperConfig::default() };
    let all = VcmConfig { mapper, light_paths: Some(3000), ..VcmConfig::default() };
    let way = |name, config, bias| (name, Method::Vcm(config), bias);
    vec![
        way("neither", VcmConfig { merging: false, connections: false, ..all.clone() }, 0.0),
        way("connections alone", VcmConfig { merging: false, ..all.clone() }, 0.0),
        way("merging alone", VcmConfig { connections: false, ..all.clone() }, BLUR),
        way("correlation", VcmConfig { correlation: true, ..all.clone() }, BLUR),
        way("all", all, BLUR),
    ]
}

/// The blocks and, last, the whole.
fn parts(pictures: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut parts = block_samples(pictures, SIDE, BLOCK);
    parts.extend(block_samples(pictures, SIDE, SIDE));
    parts
}

#[track_caller]
fn all_agree(b: Builder) {
    all_agree_within(b, None, BLUR);
}

/// With paths of so many segments and so much blur.
#[track_caller]
fn all_agree_within(b: Builder, max_depth: Option<u32>, blur: f64) {
    let world = b.build();
    assert_eq!(world.remarks(), []);
    let exact = parts(&renders(&world, &volpath(max_depth), 64, 0..SEEDS));
    for (first, (name, method, bias)) in (1..).map(|i| 100 * i).zip(ways(max_depth)) {
        let found = parts(&iterated_renders(&world, &method, 2, 16, first..first + SEEDS));
        agree(name, &found, &exact, if bias > 0.0 { blur } else { 0.0 });
    }
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
        assert!(part < last || deviation < 0.03, "{name}: too few samples, {deviation}");
    }
}

/// A niche with a box and a ball in it, seen from the front.
fn room() -> Builder {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 36.0, SIDE as u32);
    furnish(&mut b);
    b
}

fn furnish(b: &mut Builder) {
    b.niche(0.6);
    let tint = b.scene.textures.constant(Rgb::new(0.8, 0.3, 0.1));
    let red = b.scene.materials.push(Material::Diffuse { reflectance: tint });
    let grey = b.diffuse(0.5);
    let turned = Transform::rotate(DVec3::Y, 25.0);
    b.shape(Geometry::Cube, turned.then(boxed(DVec3::new(-0.4, -0.6, -0.2), DVec3::splat(0.4))), red);
    b.sphere(Vec3::new(0.45, -0.6, 0.2), 0.4, grey);
}

/// The same without its front wall's lamp, lit through the open front.
fn lit_by(kind: LightKind) -> Builder {
    let mut b = room();
    b.light(kind);
    b
}

fn toward(from: DVec3, to: DVec3) -> Transform {
    Transform::look_at(from, to, DVec3::Y).expect("a direction")
}

#[test]
fn under_an_area_lamp() {
    let mut b = room();
    b.ceiling_lamp(0.3, 10.0);
    all_agree(b);
}

#[test]
fn with_paths_of_few_segments() {
    for max_depth in [1, 2, 3] {
        let mut b = room();
        b.ceiling_lamp(0.3, 10.0);
        let bright = facing(DVec3::new(0.0, 0.0, -0.99), 0.3, DVec3::X, 0.0);
        let (black, glow) = (b.diffuse(0.0), b.constant(1.0));
        b.shape(Geometry::Rectangle, bright, black).emission = Some(glow);
        all_agree_within(b, Some(max_depth), BLUR);
    }
}

#[test]
fn under_balls_that_shine() {
    let mut b = room();
    let (grey, glow) = (b.diffuse(0.4), b.constant(4.0));
    b.sphere(Vec3::new(-0.3, 0.5, 0.0), 0.25, grey).emission = Some(glow);
    b.sphere(Vec3::new(0.6, 0.2, -0.5), 0.1, grey).emission = Some(glow);
    all_agree(b);
}

#[test]
fn under_a_point() {
    all_agree(lit_by(LightKind::Point { position: Vec3::new(0.1, 0.6, 0.2), intensity: Rgb::splat(2.0) }));
}

#[test]
fn under_a_spot() {
    let to_world = toward(DVec3::new(0.3, 0.9, 0.8), DVec3::new(-0.2, -0.6, 0.0));
    all_agree(lit_by(LightKind::Spot {
        to_world,
        intensity: Rgb::new(12.0, 10.0, 8.0),
        cutoff_deg: 40.0,
        beam_width_deg: 20.0,
        texture: None,
    }));
}

#[test]
fn under_a_parallel_beam() {
    let direction = Vec3::new(0.3, -0.6, -1.0).normalize();
    all_agree(lit_by(LightKind::Directional { direction, irradiance: Rgb::splat(2.0) }));
}

/// Most photons miss what is seen, so that those which do not are merged from far around.
#[test]
fn under_a_constant_sky() {
    all_agree_within(lit_by(LightKind::Constant { radiance: Rgb::new(0.5, 0.7, 1.0) }), None, 0.06);
}

#[test]
fn under_an_environment_map() {
    let mut b = room();
    let mut image = Image::filled(8, 4, Rgb::splat(0.2));
    image.pixels[11] = Rgb::new(6.0, 5.0, 4.0);
    image.pixels[12] = Rgb::new(8.0, 5.0, 3.0);
    let image = b.scene.textures.images.push(image.into());
    b.light(LightKind::Environment {
        mapping: EnvironmentMapping::Equirectangular,
        image,
        scale: 1.0,
        to_world: Transform::IDENTITY,
    });
    all_agree(b);
}

/// Every lamp that paths may choose among.
#[test]
fn under_lamps_of_all_kinds() {
    let mut b = room();
    b.ceiling_lamp(0.4, 2.0);
    b.light(LightKind::Point { position: Vec3::new(0.6, 0.2, 0.4), intensity: Rgb::splat(0.3) });
    let direction = Vec3::new(-0.2, -0.4, -1.0).normalize();
    b.light(LightKind::Directional { direction, irradiance: Rgb::splat(0.5) });
    b.light(LightKind::Constant { radiance: Rgb::splat(0.2) });
    all_agree(b);
}

/// Photons from far away start in a ball around what is finite, and most of a plane lies outside of it.
#[test]
fn on_an_endless_plane() {
    for sky in [true, false] {
        let mut b = Builder::seen_from(Vec3::new(0.0, 3.0, 8.0), Vec3::ZERO, 60.0, SIDE as u32);
        let (white, grey) = (b.diffuse(0.8), b.diffuse(0.5));
        b.shape(Geometry::Plane, Transform::rotate(DVec3::X, -90.0), white);
        b.sphere(Vec3::new(0.0, 0.7, 0.0), 0.7, grey);
        if sky {
            b.light(LightKind::Constant { radiance: Rgb::WHITE });
        } else {
            let direction = Vec3::new(0.3, -0.6, -1.0).normalize();
            b.light(LightKind::Directional { direction, irradiance: Rgb::splat(2.0) });
        }
        all_agree(b);
    }
}

#[test]
fn through_veils() {
    let mut b = room();
    b.ceiling_lamp(0.4, 6.0);
    let (half, white) = (b.constant(0.5), b.diffuse(0.8));
    let paper = b.two_sided(white);
    let veil = b.scene.materials.push(Material::Mask { opacity: half, inside: paper });
    b.shape(Geometry::Rectangle, facing(DVec3::new(0.1, 0.1, 0.2), 0.5, DVec3::X, -60.0), veil);
    b.shape(Geometry::Rectangle, facing(DVec3::new(-0.4, 0.4, 0.0), 0.4, DVec3::X, -90.0), veil);
    all_agree(b);
}

#[test]
fn with_glossy_surfaces() {
    let mut b = room();
    b.ceiling_lamp(0.5, 4.0);
    let (some, more) = (b.constant(0.2), b.constant(0.6));
    let (diffuse_reflectance, specular_reflectance) = (some, more);
    let glossy =
        b.scene.materials.push(Material::Phong { diffuse_reflectance, specular_reflectance, exponent: 15.0 });
    let paper = b.two_sided(glossy);
    b.shape(Geometry::Rectangle, facing(DVec3::new(0.0, -0.2, 0.3), 0.5, DVec3::X, -50.0), paper);
    all_agree(b);
}

/// Under a lamp so large that paths find it by the mirror and through the glass.
#[test]
fn with_a_mirror_and_glass() {
    let mut b = room();
    b.ceiling_lamp(0.9, 1.0);
    let (glass, mirror) = (b.glass(1.5), b.mirror(0.9));
    b.sphere(Vec3::new(0.0, 0.3, 0.3), 0.3, glass);
    b.shape(Geometry::Rectangle, facing(DVec3::new(0.6, 0.2, -0.3), 0.4, DVec3::Y, -40.0), mirror);
    all_agree(b);
}

/// A ball of few triangles whose normals say that it is round.
#[test]
fn with_normals_that_bend() {
    let mut b = room();
    b.ceiling_lamp(0.4, 6.0);
    let grey = b.diffuse(0.7);
    let (golden, half) = (0.5 * (1.0 + 5.0f32.sqrt()), 1.0);
    let mut positions = Vec::new();
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let mut p = [0.0; 3];
            (p[i], p[j]) = (s * half, t * golden);
            positions.push(Vec3::from_array(p));
        }
    }
    let faces = (0..12).flat_map(|i| (i + 1..12).flat_map(move |j| (j + 1..12).map(move |k| [i, j, k])));
    let near = |a: u32, b: u32| positions[a as usize].distance(positions[b as usize]) < 2.1;
    let triangles = faces
        .filter(|[i, j, k]| near(*i, *j) && near(*j, *k) && near(*i, *k))
        .map(|[i, j, k]| {
            let [a, b, c] = [i, j, k].map(|v| positions[v as usize]);
            if (b - a).cross(c - a).dot(a) > 0.0 { [i, j, k] } else { [i, k, j] }
        })
        .collect();
    let normals = positions.iter().map(|p| p.normalize()).collect();
    let mesh = Mesh { positions, triangles, normals, ..Mesh::default() };
    let to_world = Transform::scale(DVec3::splat(0.25)).then(Transform::translate(DVec3::new(0.0, 0.1, 0.2)));
    b.mesh(mesh, grey).to_world = to_world;
    all_agree(b);
}

#[test]
fn by_a_thin_lens() {
    let mut b = room();
    b.ceiling_lamp(0.3, 10.0);
    let (fov_deg, fov_axis, principal_point_offset) = (36.0, FovAxis::X, Vec2::ZERO);
    b.scene.camera.projection = Projection::ThinLens {
        fov_deg,
        fov_axis,
        principal_point_offset,
        aperture_radius: 0.2,
        focus_distance: 3.5,
    };
    all_agree(b);
}

#[test]
fn by_parallel_rays() {
    let mut b = Builder::parallel_view(Vec3::new(0.2, 0.4, 4.0), Vec3::ZERO, 0.9, SIDE as u32, SIDE as u32);
    furnish(&mut b);
    b.ceiling_lamp(0.3, 10.0);
    all_agree(b);
}

#[test]
fn in_a_window_of_the_picture() {
    let mut b = room();
    b.ceiling_lamp(0.3, 10.0);
    (b.scene.film.width, b.scene.film.height) = (40, 30);
    let side = SIDE as u32;
    b.scene.film.crop = Some(Crop { x: 9, y: 12, width: side, height: side });
    all_agree(b);
}

#[test]
fn with_instances() {
    let mut b = room();
    let ball = b.scene.shapes.pop().expect("the ball");
    b.ceiling_lamp(0.3, 10.0);
    let group = b.scene.groups.push(Group { name: "ball".to_owned(), shapes: vec![ball] });
    for (x, stretch) in [(0.0, DVec3::ONE), (-0.4, DVec3::new(0.6, 0.8, 0.5))] {
        let to_world = Transform::scale(stretch).then(Transform::translate(DVec3::new(x, 0.1, 0.0)));
        b.scene.instances.push(Instance { name: format!("at {x}"), group, to_world });
    }
    all_agree(b);
}

/// A lamp with a pattern, above which it is dark, for it shines down alone.
#[test]
fn under_a_lamp_with_a_pattern() {
    let mut b = room();
    let (color0, color1) = (b.constant(1.0), b.scene.textures.constant(Rgb::new(12.0, 9.0, 5.0)));
    let to_uv = Affine2::from_scale(Vec2::splat(2.0));
    let board = Texture::Checkerboard(Checkerboard { color0, color1, to_uv });
    let (glow, black) = (b.scene.textures.push(board), b.diffuse(0.0));
    let lamp = facing(DVec3::new(0.0, 0.4, 0.0), 0.4, DVec3::X, 90.0);
    b.shape(Geometry::Rectangle, lamp, black).emission = Some(glow);
    all_agree(b);
}

/// Fog in a box that only a piece of wall with its back to the camera and what is behind it let light come from.
#[test]
fn with_fog_behind_a_screen() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 36.0, SIDE as u32);
    b.niche(0.6);
    let fog = b.fog(Rgb::new(1.5, 2.0, 2.5), Rgb::new(0.9, 0.8, 0.6), Phase::HenyeyGreenstein { g: 0.4 });
    let fill = boxed(DVec3::new(0.0, 0.2, -0.3), DVec3::new(0.6, 0.6, 0.3));
    b.border(Geometry::Cube, fill, between(Some(fog), None));
    let grey = b.diffuse(0.5);
    let paper = b.two_sided(grey);
    b.shape(Geometry::Rectangle, facing(DVec3::new(0.0, 0.1, 0.4), 0.75, DVec3::X, 0.0), paper);
    b.ceiling_lamp(0.3, 10.0);
    all_agree(b);
}

/// Without light paths it is a path tracer.
#[test]
fn without_light_paths() {
    let mut b = room();
    b.ceiling_lamp(0.3, 10.0);
    let world = b.build();
    let exact = parts(&renders(&world, &volpath(None), 64, 0..SEEDS));
    let method = Method::Vcm(VcmConfig { light_paths: Some(0), ..VcmConfig::default() });
    agree("no light paths", &parts(&iterated_renders(&world, &method, 64, 1, 100..100 + SEEDS)), &exact, 0.0);
}

/// Everything of a world in which nothing shines is black.
#[test]
fn without_lamps() {
    let world: World = room().build();
    for (name, method, _) in ways(None) {
        let pictures = iterated_renders(&world, &method, 2, 4, 0..1);
        assert!(pictures.iter().flatten().all(|value| *value == 0.0), "{name}");
    }
}
