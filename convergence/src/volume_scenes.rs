//! Scenes with media in them that a path tracer can render.

use nephroid::color::Rgb;
use nephroid::light::LightKind;
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::medium::{GridValues, Phase};
use nephroid::shape::Geometry;

use crate::{Builder, between, boxed, facing};

/// Cells along each side of the clouds.
const CELLS: u32 = 6;

/// A niche full of fog under a lamp, seen from outside.
pub fn foggy_niche(side: u32, sigma_t: Rgb, albedo: Rgb, phase: Phase) -> Builder {
    Builder::filled_niche(side, 0.5, |b| b.fog(sigma_t, albedo, phase))
}

/// The niche with a ball of glass and a mirror in it, under a lamp so large that paths find it through them.
pub fn balls_in_fog(side: u32) -> Builder {
    let mut inside = None;
    let mut b = Builder::filled_niche(side, 0.9, |b| {
        *inside.insert(b.fog(Rgb::splat(0.5), Rgb::splat(0.9), Phase::Isotropic))
    });
    let (glass, mirror) = (b.glass(1.5), b.mirror(0.9));
    b.sphere(Vec3::new(-0.4, -0.5, 0.2), 0.4, glass).boundary = between(None, inside);
    b.sphere(Vec3::new(0.5, -0.5, -0.3), 0.4, mirror);
    b
}

/// The niche with a ball that is mostly glossy.
pub fn glossy_ball_in_fog(side: u32) -> Builder {
    let mut b = foggy_niche(side, Rgb::splat(1.0), Rgb::splat(0.9), Phase::Isotropic);
    let (some, more) = (b.constant(0.1), b.constant(0.8));
    let glossy = b.scene.materials.push(Material::Phong {
        diffuse_reflectance: some,
        specular_reflectance: more,
        exponent: 20.0,
    });
    b.sphere(Vec3::new(0.0, -0.2, 0.0), 0.7, glossy);
    b
}

/// A room full of fog with the camera in it, and a lamp in a clear ball.
pub fn lantern_in_fog(side: u32) -> Builder {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 0.9), Vec3::ZERO, 80.0, side);
    let fog = b.fog(Rgb::splat(0.8), Rgb::splat(0.8), Phase::Isotropic);
    let (wall, black, glow) = (b.diffuse(0.5), b.diffuse(0.0), b.constant(2.0));
    let room = b.shape(Geometry::Cube, Transform::IDENTITY, wall);
    (room.flip_normals, room.boundary) = (true, between(None, Some(fog)));
    let center = Vec3::new(-0.3, 0.2, -0.3);
    b.border(Geometry::Sphere { center, radius: 0.35 }, Transform::IDENTITY, between(None, Some(fog)));
    b.sphere(center, 0.25, black).emission = Some(glow);
    b
}

/// A cloud over a floor, lit by a lamp or by the sky.
pub fn cloud_over_floor(side: u32, coloured: bool, sky: bool) -> Builder {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.5, 4.0), Vec3::ZERO, 40.0, side);
    let value = |i: u32| {
        let (x, y, z) = (i % CELLS, i / CELLS % CELLS, i / CELLS / CELLS);
        ((x * 3 + y * 5 + z * 7) % 8) as f32 / 7.0
    };
    let cells = 0..CELLS * CELLS * CELLS;
    let (values, albedo) = if coloured {
        let rgb = |i| Rgb::new(value(i), value(i + 1), 0.3);
        (GridValues::Rgb(cells.map(rgb).collect()), Rgb::new(0.9, 0.8, 0.6))
    } else {
        (GridValues::Grey(cells.map(value).collect()), Rgb::splat(0.9))
    };
    let cloud = b.cloud(CELLS, values, 3.0, albedo, boxed(DVec3::splat(-0.8), DVec3::splat(1.6)));
    b.border(Geometry::Cube, boxed(DVec3::ZERO, DVec3::splat(0.8)), between(Some(cloud), None));
    let (floor, black, glow) = (b.diffuse(0.5), b.diffuse(0.0), b.constant(6.0));
    b.shape(Geometry::Rectangle, facing(DVec3::NEG_Y, 2.0, DVec3::X, -90.0), floor);
    if sky {
        b.light(LightKind::Constant { radiance: Rgb::new(0.5, 0.7, 1.0) });
    } else {
        let lamp = facing(DVec3::new(0.5, 2.0, 0.5), 0.6, DVec3::X, 90.0);
        b.shape(Geometry::Rectangle, lamp, black).emission = Some(glow);
    }
    b
}

/// A room in two halves of different media, with the camera in one and the lamp in the other, and a third medium in a
/// ball inside of that.
pub fn three_media(side: u32) -> Builder {
    let mut b = Builder::seen_from(Vec3::new(-0.9, 0.1, 0.9), Vec3::new(0.2, -0.1, 0.0), 80.0, side);
    let thin = b.fog(Rgb::splat(0.3), Rgb::splat(0.9), Phase::Isotropic);
    let forward = Phase::HenyeyGreenstein { g: 0.3 };
    let thick = b.fog(Rgb::new(0.6, 0.9, 1.2), Rgb::splat(0.8), forward);
    let core = b.fog(Rgb::splat(3.0), Rgb::new(0.9, 0.6, 0.3), Phase::Isotropic);
    let (wall, black, glow) = (b.diffuse(0.5), b.diffuse(0.0), b.constant(4.0));
    b.shape(Geometry::Cube, Transform::IDENTITY, wall).flip_normals = true;
    let curtain = facing(DVec3::ZERO, 1.2, DVec3::Y, 90.0);
    b.border(Geometry::Rectangle, curtain, between(Some(thin), Some(thick)));
    let ball = Geometry::Sphere { center: Vec3::new(0.4, -0.4, 0.0), radius: 0.35 };
    b.border(ball, Transform::IDENTITY, between(Some(core), Some(thick)));
    let lamp = facing(DVec3::new(0.5, 0.98, 0.0), 0.4, DVec3::X, 90.0);
    b.shape(Geometry::Rectangle, lamp, black).emission = Some(glow);
    b
}
