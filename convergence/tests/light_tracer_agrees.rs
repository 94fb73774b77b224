//! Light tracing against path tracing, which is unbiased as well, in scenes without mirrors and glass, and in those where
//! only lamps are seen by them.
//!
//! The tests of the file share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct code would fail
//! somewhere with probability 1 %.

use nephroid::camera::{FovAxis, Projection};
use nephroid::color::Rgb;
use nephroid::film::{Crop, Filter};
use nephroid::handle::Handle;
use nephroid::integrator::{Method, PhotonMapperConfig};
use nephroid::light::{EnvironmentMapping, LightKind};
use nephroid::material::Material;
use nephroid::math::{Affine2, DVec3, Transform, Vec2, Vec3};
use nephroid::medium::{Coefficient, Phase};
use nephroid::shape::{Geometry, Mesh};
use nephroid::texture::{Bitmap, BitmapFilter, Image, Texture, Wrap};
use nephroid_convergence::{
    Builder, between, blocks, boxed, cloud_over_floor, every_method_but, facing, foggy_niche, lantern_in_fog,
    three_media, volpath,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// Pixels of a picture's side, and of a block's: nine blocks and the whole are compared, channel by channel.
const SIDE: u32 = 24;
const BLOCK: usize = 8;
const PARTS: usize = 10 * 3;

/// More than the pairs of pictures.
const PAIRS: usize = 32;

/// The methods that do not blur and know of media, but for path tracing, by which they are judged.
fn methods(max_depth: Option<u32>) -> Vec<Method> {
    let mut methods = every_method_but(&["volpath"], &PhotonMapperConfig { max_depth, ..Default::default() });
    methods.retain(|contestant| contestant.media && !contestant.blurs);
    methods.into_iter().map(|contestant| contestant.method).collect()
}

/// Light tracing and path tracing see the same. Means are of twelve seeds each.
fn agree(name: &str, b: Builder, max_depth: Option<u32>) {
    let world = b.build();
    let pictures = |method: &Method, seed| blocks(&world, method, 24, seed..seed + 12, BLOCK);
    let exact = pictures(&volpath(max_depth), 200);
    for method in methods(max_depth) {
        let traced = pictures(&method, 100);
        assert_eq!(traced.len(), PARTS);
        for (part, (traced, exact)) in traced.iter().zip(&exact).enumerate() {
            let [traced, exact]: [MeanTest; 2] =
                [traced, exact].map(|samples| samples.iter().copied().collect());
            if traced.mean() == 0.0 && exact.mean() == 0.0 {
                continue;
            }
            let outcome = traced.welch(&exact);
            let level = sidak(ALPHA, PAIRS * PARTS);
            assert!(outcome.passes(level), "{name}, {}, part {part}: {outcome}", method.name());
        }
    }
}

fn coloured(b: &mut Builder, color: Rgb) -> Handle<Material> {
    let reflectance = b.scene.textures.constant(color);
    b.scene.materials.push(Material::Diffuse { reflectance })
}

fn glossy(b: &mut Builder, diffuse: f32, specular: f32, exponent: f32) -> Handle<Material> {
    let (diffuse_reflectance, specular_reflectance) = (b.constant(diffuse), b.constant(specular));
    b.scene.materials.push(Material::Phong { diffuse_reflectance, specular_reflectance, exponent })
}

/// A niche with coloured things in it under a lamp.
fn coloured_room() -> Builder {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 36.0, SIDE);
    b.niche(0.6);
    b.ceiling_lamp(0.3, 10.0);
    let (red, green) = (coloured(&mut b, Rgb::new(0.8, 0.1, 0.1)), coloured(&mut b, Rgb::new(0.1, 0.7, 0.2)));
    b.shape(
        Geometry::Cube,
        Transform::rotate(DVec3::Y, 25.0).then(boxed(DVec3::new(-0.4, -0.6, -0.2), DVec3::splat(0.4))),
        red,
    );
    b.sphere(Vec3::new(0.45, -0.6, 0.2), 0.4, green);
    b
}

#[test]
fn in_a_coloured_room_with_paths_of_any_length() {
    agree("room", coloured_room(), None);
    for max_depth in 1..5 {
        agree(&format!("room, {max_depth} segments"), coloured_room(), Some(max_depth));
    }
}

/// A floor and a ball with Phong's lobes, under a lamp in a dim sky.
#[test]
fn on_glossy_surfaces() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 1.5, 4.0), Vec3::ZERO, 36.0, SIDE);
    let (floor, ball, black) =
        (glossy(&mut b, 0.3, 0.5, 12.0), glossy(&mut b, 0.2, 0.7, 5.0), b.diffuse(0.0));
    b.shape(Geometry::Rectangle, facing(DVec3::NEG_Y, 2.0, DVec3::X, -90.0), floor);
    b.sphere(Vec3::new(0.0, -0.2, 0.0), 0.8, ball);
    let glow = b.constant(5.0);
    let lamp = facing(DVec3::new(0.5, 2.5, -0.5), 0.5, DVec3::X, 90.0);
    b.shape(Geometry::Rectangle, lamp, black).emission = Some(glow);
    b.light(LightKind::Constant { radiance: Rgb::new(0.2, 0.3, 0.5) });
    agree("glossy", b, None);
}

/// A coarse ball of triangles, whose normals are interpolated and lean a lot.
fn smooth_ball(center: Vec3, radius: f32) -> Mesh {
    let (rows, columns) = (4, 6);
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..columns {
            let (t, p) = (
                std::f64::consts::PI * f64::from(row) / f64::from(rows),
                std::f64::consts::TAU * f64::from(column) / f64::from(columns),
            );
            let at = DVec3::new(libm::sin(t) * libm::cos(p), libm::cos(t), -libm::sin(t) * libm::sin(p));
            mesh.positions.push(center + radius * at.as_vec3());
        }
    }
    let index = |row: u32, column: u32| row * columns + column % columns;
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let [a, b, c, d] = [(row, column), (row + 1, column), (row + 1, column + 1), (row, column + 1)]
            .map(|(r, c)| index(r, c));
        if row < rows - 1 {
            mesh.triangles.push([a, b, c]);
        }
        if row > 0 {
            mesh.triangles.push([a, c, d]);
        }
    }
    mesh.normals = mesh.positions.iter().map(|p| (*p - center).normalize()).collect();
    mesh
}

/// A floor whose normals all lean to the back: what the factors do is not levelled out.
fn leaning_floor() -> Mesh {
    let corners = [[-1.5, -1.0, 1.5], [1.5, -1.0, 1.5], [1.5, -1.0, -1.5], [-1.5, -1.0, -1.5]];
    Mesh {
        positions: corners.map(Vec3::from_array).to_vec(),
        normals: vec![Vec3::new(0.2, 1.0, -0.35).normalize(); 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// Light goes to the floor from the balls and back, so that power is corrected on the way and at its end.
#[test]
fn with_interpolated_normals() {
    for phong in [false, true] {
        let mut b = Builder::seen_from(Vec3::new(0.0, 1.0, 4.0), Vec3::ZERO, 36.0, SIDE);
        let (floor, white) = (b.diffuse(0.8), b.diffuse(0.9));
        let ball = if phong { glossy(&mut b, 0.3, 0.6, 8.0) } else { white };
        b.mesh(leaning_floor(), floor);
        b.mesh(smooth_ball(Vec3::new(-0.6, -0.3, 0.0), 0.7), ball);
        b.mesh(smooth_ball(Vec3::new(0.8, -0.3, 0.2), 0.6), white);
        b.point_light(Vec3::new(0.3, 2.0, 1.5), 6.0);
        b.light(LightKind::Constant { radiance: Rgb::splat(0.3) });
        agree(&format!("smooth, phong {phong}"), b, None);
    }
}

/// Hills on a floor, and a ball whose normals an image tilts.
#[test]
fn on_surfaces_that_images_bend() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 1.0, 4.0), Vec3::ZERO, 36.0, SIDE);
    let mut bitmap = |pixels: Vec<Rgb>, times: f32| {
        let image = b.scene.textures.images.push(Image { width: 4, height: 4, pixels }.into());
        let to_uv = Affine2::from_scale(Vec2::splat(times));
        let (filter, wrap) = (BitmapFilter::Bilinear, Wrap::Repeat);
        b.scene.textures.push(Texture::Bitmap(Bitmap { image, filter, wrap, to_uv }))
    };
    let hills = (0..16).map(|i| Rgb::splat((i * 7 % 16) as f32 / 15.0)).collect();
    let tilts = |i: i32| Rgb::new((i * 5 % 16) as f32 / 15.0, (i * 11 % 16) as f32 / 15.0, 1.0);
    let (heights, normals) = (bitmap(hills, 2.0), bitmap((0..16).map(tilts).collect(), 1.0));
    let (inside, white) = (b.diffuse(0.8), b.diffuse(0.9));
    let floor = b.scene.materials.push(Material::BumpMap { heights, scale: 0.15, inside });
    let ball =
        b.scene.materials.push(Material::NormalMap { normals, scale: 0.6, against_v: false, inside: white });
    b.shape(Geometry::Rectangle, facing(DVec3::NEG_Y, 1.5, DVec3::X, -90.0), floor);
    b.sphere(Vec3::new(-0.6, -0.3, 0.0), 0.7, ball);
    b.mesh(smooth_ball(Vec3::new(0.8, -0.3, 0.2), 0.6), white);
    b.point_light(Vec3::new(0.3, 2.0, 1.5), 6.0);
    b.light(LightKind::Constant { radiance: Rgb::splat(0.3) });
    agree("bent", b, None);
}

#[test]
fn under_spots_suns_and_skies() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 1.0, 4.0), Vec3::ZERO, 40.0, SIDE);
    let (floor, ball) = (b.diffuse(0.7), b.diffuse(0.5));
    b.shape(Geometry::Rectangle, facing(DVec3::NEG_Y, 1.5, DVec3::X, -90.0), floor);
    b.sphere(Vec3::new(0.0, -0.3, 0.0), 0.6, ball);
    let at = DVec3::new(1.0, 2.0, 1.0);
    b.light(LightKind::Spot {
        to_world: Transform::look_at(at, DVec3::ZERO, DVec3::Z).expect("it looks down"),
        intensity: Rgb::new(5.0, 1.0, 1.0),
        cutoff_deg: 25.0,
        beam_width_deg: 10.0,
        texture: None,
    });
    let direction = Vec3::new(0.4, -1.0, -0.3).normalize();
    b.light(LightKind::Directional { direction, irradiance: Rgb::new(0.2, 1.0, 0.2) });
    let pixels = (0..32).map(|i| Rgb::new(0.1, 0.1 * (i % 8) as f32, 0.5 + (i / 8) as f32 * 0.2)).collect();
    let image = b.scene.textures.images.push(Image { width: 8, height: 4, pixels }.into());
    b.light(LightKind::Environment {
        mapping: EnvironmentMapping::Equirectangular,
        image,
        scale: 0.8,
        to_world: Transform::rotate(DVec3::X, 20.0),
    });
    agree("lights", b, None);
}

#[test]
fn through_a_thin_lens() {
    let mut b = coloured_room();
    b.scene.camera.projection = Projection::ThinLens {
        fov_deg: 36.0,
        fov_axis: FovAxis::X,
        principal_point_offset: Vec2::new(0.03, -0.05),
        aperture_radius: 0.4,
        focus_distance: 3.2,
    };
    agree("lens", b, None);
}

#[test]
fn in_a_window_with_wide_filters() {
    for filter in [Filter::Gaussian { std_dev: 1.2 }, Filter::Mitchell { b: 0.2, c: 0.5 }] {
        let mut b = coloured_room();
        (b.scene.film.width, b.scene.film.height, b.scene.film.filter) = (48, 36, filter);
        b.scene.film.crop = Some(Crop { x: 20, y: 12, width: SIDE, height: SIDE });
        agree(&format!("{filter:?}"), b, None);
    }
}

#[test]
fn in_fog_that_scatters_evenly_or_forward() {
    let albedo = Rgb::new(0.9, 0.7, 0.5);
    for phase in [Phase::Isotropic, Phase::HenyeyGreenstein { g: 0.8 }] {
        agree(&format!("{phase:?}"), foggy_niche(SIDE, Rgb::new(0.5, 0.8, 1.2), albedo, phase), None);
    }
    for max_depth in [2, 3] {
        let b = foggy_niche(SIDE, Rgb::splat(1.0), albedo, Phase::Isotropic);
        agree(&format!("fog, {max_depth} segments"), b, Some(max_depth));
    }
}

#[test]
fn with_media_in_media_and_clouds() {
    agree("lantern", lantern_in_fog(SIDE), None);
    agree("three media", three_media(SIDE), None);
    agree("cloud", cloud_over_floor(SIDE, true, true), None);
}

/// Gas that gives off light, scatters some and stands over a floor: it is seen by camera rays, and shines on the floor and
/// on itself by light paths.
#[test]
fn with_gas_that_gives_off_light() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.8, 4.0), Vec3::ZERO, 36.0, SIDE);
    let floor = b.diffuse(0.6);
    b.shape(Geometry::Rectangle, facing(DVec3::NEG_Y, 1.5, DVec3::X, -90.0), floor);
    let gas = b.fog(Rgb::splat(1.0), Rgb::splat(0.7), Phase::Isotropic);
    let b = {
        b.border(Geometry::Cube, boxed(DVec3::ZERO, DVec3::splat(0.6)), between(Some(gas), None));
        b.with_media(|medium| medium.emission = Coefficient::Constant(Rgb::new(1.0, 0.6, 0.3)))
    };
    agree("gas", b, None);
}

#[test]
fn with_masks() {
    let mut b = coloured_room();
    let (cloth, opacity) = (coloured(&mut b, Rgb::new(0.2, 0.3, 0.9)), b.constant(0.4));
    let cloth = b.two_sided(cloth);
    let veil = b.scene.materials.push(Material::Mask { opacity, inside: cloth });
    b.shape(Geometry::Rectangle, facing(DVec3::new(0.2, 0.1, 0.6), 0.6, DVec3::Y, 20.0), veil);
    b.shape(Geometry::Rectangle, facing(DVec3::new(0.0, 0.5, 0.0), 0.7, DVec3::X, 80.0), veil);
    agree("masks", b, None);
}

/// In a black room only lamps are seen, straight, in a mirror and through glass, in fog that takes light and gives some.
#[test]
fn lamps_are_seen_by_mirrors_and_through_glass_in_fog() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.6, 3.0), Vec3::ZERO, 40.0, SIDE);
    let fog = b.fog(Rgb::new(0.1, 0.2, 0.3), Rgb::BLACK, Phase::Isotropic);
    let (black, glow, mirror, glass) = (b.diffuse(0.0), b.constant(2.0), b.mirror(0.8), b.glass(1.5));
    b.shape(Geometry::Rectangle, facing(DVec3::NEG_Y, 1.5, DVec3::X, -90.0), mirror).boundary =
        between(None, Some(fog));
    b.sphere(Vec3::new(0.5, -0.2, 0.5), 0.5, glass).boundary = between(None, Some(fog));
    b.shape(Geometry::Rectangle, facing(DVec3::new(-0.2, 0.4, -1.0), 0.7, DVec3::X, 0.0), black).emission =
        Some(glow);
    b.light(LightKind::Constant { radiance: Rgb::splat(0.5) });
    let room = b.border(
        Geometry::Sphere { center: Vec3::ZERO, radius: 4.0 },
        Transform::IDENTITY,
        between(Some(fog), None),
    );
    room.name = "fog".into();
    let b = b.with_media(|medium| medium.emission = Coefficient::Constant(Rgb::new(0.05, 0.02, 0.0)));
    agree("mirrors", b, None);
}
