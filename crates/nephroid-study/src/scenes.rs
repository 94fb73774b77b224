//! Scenes built in code, for experiments that no file is needed for.

use nephroid::camera::{Camera, Projection};
use nephroid::color::Rgb;
use nephroid::film::{FilmSettings, Filter};
use nephroid::light::{Light, LightKind};
use nephroid::material::Material;
use nephroid::math::{Transform, Vec3};
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
