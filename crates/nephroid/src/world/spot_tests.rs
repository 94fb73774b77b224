//! What is told of a place on a shape when a material asks: colours of vertices, and where texture coordinates go.

use super::*;
use crate::camera::{Camera, Projection};
use crate::film::{FilmSettings, Filter};
use crate::math::{DVec3, Transform};
use crate::shape::{Geometry, Group, Instance, Mesh, Shape};

/// A triangle in the plane z = 0 with a colour at each corner.
fn triangle() -> Mesh {
    Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        colors: vec![Rgb::new(1.0, 0.0, 0.0), Rgb::new(0.0, 1.0, 0.0), Rgb::new(0.0, 0.0, 1.0)],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    }
}

fn empty() -> Scene {
    let camera = Camera { to_world: Transform::IDENTITY, projection: Projection::Orthographic, medium: None };
    Scene::new(camera, FilmSettings { width: 1, height: 1, crop: None, filter: Filter::Box })
}

/// The triangle at a place, seen in its own colours.
fn world(to_world: Transform, by_instance: bool, masked: bool) -> World {
    let mut scene = empty();
    let reflectance = scene.textures.push(Texture::VertexColor);
    let mut material = scene.materials.push(Material::Diffuse { reflectance });
    if masked {
        let opacity = scene.textures.push(Texture::Channel { of: reflectance, channel: 1 });
        material = scene.materials.push(Material::Mask { opacity, inside: material });
    }
    let mesh = scene.meshes.push(triangle());
    let shape = Shape::new("triangle", Geometry::Mesh(mesh), material);
    if by_instance {
        let group = scene.groups.push(Group { name: "group".into(), shapes: vec![shape] });
        scene.instances.push(Instance { name: "instance".into(), group, to_world });
    } else {
        scene.shapes.push(Shape { to_world, ..shape });
    }
    World::new(scene).expect("a sound scene")
}

/// A ray that meets the triangle where its corners weigh 0.5, 0.3 and 0.2.
fn ray(to_world: &Transform) -> Ray {
    let target = to_world.point(Vec3::new(0.3, 0.2, 0.0));
    let n = to_world.normal(Vec3::Z);
    Ray::new(target + n * 2.0, -n)
}

fn places() -> [Transform; 3] {
    let turn = Transform::rotate(DVec3::new(1.0, 2.0, 3.0), 40.0);
    [
        Transform::IDENTITY,
        turn.then(Transform::translate(DVec3::new(5.0, 6.0, 7.0))),
        Transform::scale(DVec3::new(-1.0, 2.0, 0.5)).then(turn),
    ]
}

#[test]
fn materials_see_the_colours_of_vertices() {
    for place in places() {
        for by_instance in [false, true] {
            let world = world(place, by_instance, false);
            let ray = ray(&place);
            let hit = world.intersect(&ray).expect("the ray meets the triangle");
            let albedo = world.bsdf(&hit, hit.point.ng).diffuse_albedo();
            let off = albedo.zip(Rgb::new(0.5, 0.3, 0.2), |a, b| (a - b).abs());
            assert!(off.max_channel() < 1e-5, "{albedo:?}, by instance: {by_instance}");
        }
    }
}

#[test]
fn masks_see_them_too() {
    for by_instance in [false, true] {
        let place = Transform::IDENTITY;
        let world = world(place, by_instance, true);
        // Where the surface is there, by a hash of the ray: 3 of 10 times.
        let toward = ray(&place);
        let rays = (0..2000).map(|i| Ray { direction: toward.direction * (1.0 + i as f32 * 1e-3), ..toward });
        let hits: Vec<Hit> = rays.filter_map(|ray| world.intersect(&ray)).collect();
        assert!(hits.iter().all(|hit| (world.opacity(hit) - 0.3).abs() < 1e-5));
        // Eight standard errors are 0.08.
        assert!((hits.len() as f64 / 2000.0 - 0.3).abs() < 0.08, "{}", hits.len());
    }
}

/// One shape of each kind.
fn geometries(scene: &mut Scene) -> Vec<Geometry> {
    let uvs = vec![Vec2::new(0.1, 0.2), Vec2::new(0.9, 0.3), Vec2::new(0.4, 2.0)];
    let (with, without) = (Mesh { uvs, ..triangle() }, triangle());
    vec![
        Geometry::Sphere { center: Vec3::new(0.2, 0.1, -0.5), radius: 0.8 },
        Geometry::Cylinder { p0: Vec3::new(-1.0, 0.0, 0.1), p1: Vec3::new(1.0, 0.4, 0.0), radius: 0.7 },
        Geometry::Rectangle,
        Geometry::Disk,
        Geometry::Cube,
        Geometry::Plane,
        Geometry::Mesh(scene.meshes.push(with)),
        Geometry::Mesh(scene.meshes.push(without)),
    ]
}

/// Neighbouring hits are as far apart as their texture coordinates say.
#[test]
fn tangents_are_limits_of_differences() {
    let mut compared = 0;
    for number in 0..8 {
        for (stretched, place) in [(false, places()[0]), (false, places()[1]), (true, places()[2])] {
            for flip_normals in [false, true] {
                let mut scene = empty();
                let reflectance = scene.textures.push(Texture::VertexColor);
                let material = scene.materials.push(Material::Diffuse { reflectance });
                let geometry = geometries(&mut scene).swap_remove(number);
                let infinite = geometry == Geometry::Plane;
                let shape = Shape { flip_normals, ..Shape::new("shape", geometry, material) };
                if stretched && !infinite {
                    let group = scene.groups.push(Group { name: "group".into(), shapes: vec![shape] });
                    scene.instances.push(Instance { name: "it".into(), group, to_world: place });
                } else {
                    scene.shapes.push(Shape { to_world: place, ..shape });
                }
                let world = World::new(scene).expect("a sound scene");
                let target = |x: f32, y: f32| place.point(Vec3::new(x, y, 0.0));
                let eye = target(0.3, 0.2) + place.normal(Vec3::Z) * 4.0 + Vec3::new(0.1, 0.2, 0.3);
                let meet = |x: f32, y: f32| world.intersect(&Ray::new(eye, (target(x, y) - eye).normalize()));
                for i in 0..20 {
                    let (x, y) = (0.2 + 0.01 * i as f32, 0.35 - 0.012 * i as f32);
                    let Some(hit) = meet(x, y) else { continue };
                    let [dp_du, dp_dv] = world.scenery.tangents(hit.shape, &hit.spot, hit.point.uv);
                    for near in [meet(x + 2e-3, y), meet(x, y + 2e-3)].into_iter().flatten() {
                        let (d, e) = (near.point.uv - hit.point.uv, near.point.position - hit.point.position);
                        let off = (e - dp_du * d.x - dp_dv * d.y).length();
                        assert!(off < 0.03 * e.length(), "shape {number}: {off} of {}", e.length());
                        compared += 1;
                    }
                }
            }
        }
    }
    assert!(compared > 1200, "{compared}");
}
