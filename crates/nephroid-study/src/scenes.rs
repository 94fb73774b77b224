//! Scenes built in code, for experiments that no file is needed for.

use nephroid::camera::{Camera, FovAxis, Projection};
use nephroid::color::Rgb;
use nephroid::film::{FilmSettings, Filter};
use nephroid::light::{Light, LightKind};
use nephroid::material::Material;
use nephroid::math::{DVec3, Transform, Vec2, Vec3};
use nephroid::scene::Scene;
use nephroid::shape::{Geometry, Shape};
use nephroid::world::World;

use crate::section::Stop;

/// Point lights in a closed sphere of radius 1 about the origin, of one reflectance: each light's place and its
/// intensity in W/sr.
pub fn lights_in_sphere(lights: &[(Vec3, f32)], reflectance: Rgb) -> Result<World, Stop> {
    let film = FilmSettings { width: 1, height: 1, crop: None, filter: Filter::Box };
    let camera = Camera { to_world: Transform::IDENTITY, projection: Projection::Orthographic, medium: None };
    let mut scene = Scene::new(camera, film);
    let reflectance = scene.textures.constant(reflectance);
    let material = scene.materials.push(Material::Diffuse { reflectance });
    let geometry = Geometry::Sphere { center: Vec3::ZERO, radius: 1.0 };
    scene.shapes.push(Shape { flip_normals: true, ..Shape::new("wall", geometry, material) });
    for (i, &(position, intensity)) in lights.iter().enumerate() {
        let kind = LightKind::Point { position, intensity: Rgb::splat(intensity) };
        scene.lights.push(Light { name: format!("lamp {}", i + 1), kind, medium: None });
    }
    World::new(scene).map_err(|errors| Stop::because(errors.to_string()))
}

/// A grey sphere of radius 1 about a lamp of 1 W/sr, seen from within in a square picture: with a reflectance ρ every point of
/// its wall has the radiance ρ/(π(1 − ρ)) W/(m²·sr).
pub fn furnace(reflectance: Rgb, side: u32) -> Result<World, Stop> {
    let mut scene = lights_in_sphere(&[(Vec3::ZERO, 1.0)], reflectance)?.scene().clone();
    let [eye, target] = [DVec3::new(0.3, 0.2, -0.1), DVec3::new(-0.5, -0.1, 0.6)];
    let to_world = Transform::look_at(eye, target, DVec3::Y);
    let to_world = to_world.ok_or_else(|| Stop::because("a camera cannot look along its own up"))?;
    let projection =
        Projection::Perspective { fov_deg: 90.0, fov_axis: FovAxis::X, principal_point_offset: Vec2::ZERO };
    scene.camera = Camera { to_world, projection, medium: None };
    scene.film = FilmSettings { width: side, height: side, ..scene.film };
    World::new(scene).map_err(|errors| Stop::because(errors.to_string()))
}
