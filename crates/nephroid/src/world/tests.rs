//! Rays against whole scenes.

use super::*;
use crate::bvh::Simd;
use crate::camera::{Camera, Projection};
use crate::film::{FilmSettings, Filter};
use crate::handle::Arena;
use crate::math::{DVec3, Transform, Vec2, warp};
use crate::medium::Media;
use crate::sampling::{Key, Sampler, Sequence, Stream};
use crate::shape::{Geometry, Group, Instance, Mesh, Primitive, Shape, ShearedRay, Triangle};
use crate::texture::Textures;

fn sampler(i: u64) -> Sampler {
    Sampler::new(Sequence::Independent, Key::new(21, 0, Stream::Camera), i)
}

fn empty() -> Scene {
    let mut textures = Textures::default();
    let mut materials = Arena::default();
    materials.push(Material::Diffuse { reflectance: textures.constant(Rgb::WHITE) });
    Scene {
        camera: Camera { to_world: Transform::IDENTITY, projection: Projection::Orthographic, medium: None },
        film: FilmSettings { width: 1, height: 1, crop: None, filter: Filter::Box },
        textures,
        materials,
        meshes: Arena::default(),
        shapes: Vec::new(),
        groups: Arena::default(),
        instances: Vec::new(),
        lights: Vec::new(),
        media: Media::default(),
    }
}

fn shape(scene: &Scene, geometry: Geometry, to_world: Transform) -> Shape {
    let material = scene.materials.iter_handles().next().unwrap().0;
    Shape { to_world, ..Shape::new("", geometry, material) }
}

/// A closed, bumpy ball about the origin, of radius about 1 and `2·n·(n − 1)` triangles.
fn ball(n: u32) -> Mesh {
    let (rows, columns) = (n, n);
    let mut mesh = Mesh::default();
    let mut vertex = |theta: f32, phi: f32| {
        let (sin, cos) = crate::math::real::sin_cos(theta);
        let (sin_phi, cos_phi) = crate::math::real::sin_cos(phi);
        let r = 1.0 + 0.1 * crate::math::real::sin_cos(7.0 * phi).0 * sin * sin;
        mesh.positions.push(Vec3::new(sin * cos_phi, sin * sin_phi, cos) * r);
        mesh.uvs.push(Vec2::new(phi, theta));
        mesh.positions.len() as u32 - 1
    };
    let north = vertex(0.0, 0.0);
    let south = vertex(std::f32::consts::PI, 0.0);
    let ring: Vec<Vec<u32>> = (1..rows)
        .map(|row| {
            (0..columns)
                .map(|column| {
                    let turn = 2.0 * std::f32::consts::PI / columns as f32;
                    vertex(std::f32::consts::PI * row as f32 / rows as f32, column as f32 * turn)
                })
                .collect()
        })
        .collect();
    for c in 0..columns as usize {
        let d = (c + 1) % columns as usize;
        mesh.triangles.push([north, ring[0][c], ring[0][d]]);
        for pair in ring.windows(2) {
            mesh.triangles.push([pair[0][c], pair[1][c], pair[1][d]]);
            mesh.triangles.push([pair[0][c], pair[1][d], pair[0][d]]);
        }
        let last = &ring[ring.len() - 1];
        mesh.triangles.push([south, last[d], last[c]]);
    }
    mesh.compute_normals();
    mesh
}

/// Places that are hard on single precision, each a similarity or a stretch.
fn places() -> Vec<Transform> {
    vec![
        Transform::IDENTITY,
        Transform::rotate(DVec3::new(1.0, 2.0, 0.5), 33.0)
            .then(Transform::scale(DVec3::splat(300.0)))
            .then(Transform::translate(DVec3::new(1000.0, -2000.0, 500.0))),
        Transform::scale(DVec3::splat(1e-3)).then(Transform::translate(DVec3::new(0.5, 0.25, 0.0))),
        Transform::scale(DVec3::new(3.0, -1.0, 0.2)).then(Transform::translate(DVec3::new(0.0, 40.0, 0.0))),
    ]
}

/// The mesh as a shape of its own, or as an instance.
fn placed(mesh: &Mesh, place: Transform, as_instance: bool) -> World {
    let mut scene = empty();
    let geometry = Geometry::Mesh(scene.meshes.push(mesh.clone()));
    if as_instance {
        let shapes = vec![shape(&scene, geometry, Transform::IDENTITY)];
        let group = scene.groups.push(Group { name: "ball".into(), shapes });
        scene.instances.push(Instance { name: "i".into(), group, to_world: place });
    } else {
        let own = shape(&scene, geometry, place);
        scene.shapes.push(own);
    }
    World::new(scene).unwrap()
}

#[test]
fn a_million_rays_at_edges_and_vertices_find_no_gap() {
    let mesh = ball(40);
    let rays_each = 125_000;
    for (number, place) in places().into_iter().enumerate() {
        for as_instance in [false, true] {
            let mut world = placed(&mesh, place, as_instance);
            for i in 0..rays_each {
                let mut s = sampler(i);
                let corners = mesh.triangles[(s.next_1d() * mesh.triangles.len() as f32) as usize];
                let p = corners.map(|c| place.point(mesh.positions[c as usize]));
                let a = s.next_1d();
                let target = if i % 3 == 0 { p[0] } else { p[0] * a + p[1] * (1.0 - a) };
                let origin = place.point(warp::square_to_sphere(s.next_2d()) * (0.5 * s.next_1d()));
                world.scenery.simd = if i % 8 == 0 { Simd::Portable } else { Simd::detect() };
                for direction in [target - origin, (target - origin).normalize()] {
                    let ray = Ray::new(origin, direction);
                    let hit = world.nearest(&ray);
                    assert!(hit.is_some(), "place {number}, instance {as_instance}: {ray:?} to {target}");
                    assert!(world.occluded(&ray));
                }
            }
        }
    }
}

/// A bit of everything, some of it touching.
fn zoo() -> Scene {
    let mut scene = empty();
    let mesh = scene.meshes.push(ball(12));
    let at = |x: f64, y: f64, z: f64| Transform::translate(DVec3::new(x, y, z));
    let turned = Transform::rotate(DVec3::new(1.0, 0.3, 0.2), 40.0);
    let mut shapes = vec![
        shape(&scene, Geometry::Mesh(mesh), at(0.0, 0.0, 0.0)),
        shape(&scene, Geometry::Mesh(mesh), turned.then(at(1.5, 0.5, 0.0))),
        shape(&scene, Geometry::Cube, turned.then(at(-2.0, 0.0, 1.0))),
        shape(&scene, Geometry::Cube, Transform::scale(DVec3::splat(6.0))),
        shape(&scene, Geometry::Plane, at(0.0, 0.0, -2.0)),
        shape(&scene, Geometry::Disk, turned.then(at(0.0, 2.0, 0.0))),
        shape(&scene, Geometry::Sphere { center: Vec3::ONE, radius: 0.7 }, at(0.0, -3.0, 0.0)),
        shape(&scene, Geometry::Cylinder { p0: Vec3::ZERO, p1: Vec3::ONE, radius: 0.4 }, at(2.0, -2.0, 1.0)),
    ];
    for i in 0..9 {
        let place = Transform::scale(DVec3::splat(0.3)).then(turned).then(at(0.5 * f64::from(i), 3.0, 2.0));
        shapes.push(shape(&scene, Geometry::Rectangle, place));
    }
    scene.shapes = shapes;
    scene
}

fn random_ray(i: u64) -> Ray {
    let mut s = sampler(i);
    let origin = warp::square_to_sphere(s.next_2d()) * (5.0 * s.next_1d());
    Ray::new(origin, warp::square_to_sphere(s.next_2d()))
}

#[test]
fn the_tree_finds_what_trying_every_primitive_finds() {
    let world = World::new(zoo()).unwrap();
    let scenery = &world.scenery;
    let mut pieces = scenery.primitives.clone();
    for (number, mesh) in (0u32..).zip(scenery.meshes.as_slice()) {
        pieces.extend(
            (0..mesh.triangles.len() as u32).map(|i| Primitive::Triangle(Triangle::new(mesh, number, i))),
        );
    }
    for i in 0..20_000 {
        let ray = random_ray(i);
        let sheared = ShearedRay::new(ray.direction);
        let expected =
            pieces.iter().filter_map(|p| p.intersect(&ray, &sheared)).map(|h| h.t).reduce(f32::min);
        assert_eq!(world.nearest(&ray).map(|h| h.t), expected, "{ray:?}");
        let t = expected.unwrap_or(1.0);
        assert_eq!(world.occluded(&Ray { t_max: t * 1.001, ..ray }), expected.is_some());
        assert!(!world.occluded(&Ray { t_max: t, ..ray }));
    }
}

#[test]
fn rays_of_no_numbers_meet_nothing_and_do_no_harm() {
    let mut scene = zoo();
    scene.shapes.retain(|shape| shape.geometry != Geometry::Plane);
    let world = World::new(scene).unwrap();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for axis in 0..3 {
            let mut odd = Vec3::new(0.1, 0.2, 0.3);
            odd[axis] = bad;
            for ray in [Ray::new(odd, Vec3::X), Ray::new(Vec3::ZERO, odd)] {
                assert!(world.nearest(&ray).is_none() && !world.occluded(&ray), "{ray:?}");
            }
        }
    }
    assert!(world.nearest(&Ray::new(Vec3::ZERO, Vec3::ZERO)).is_none());
    assert!(world.nearest(&Ray { t_max: f32::NAN, ..Ray::new(Vec3::ZERO, Vec3::X) }).is_none());
}

#[test]
fn wide_and_portable_instructions_give_the_same_bits() {
    let mut scene = zoo();
    let shapes = std::mem::take(&mut scene.shapes);
    let (planes, shapes) = shapes.into_iter().partition(|s| s.geometry == Geometry::Plane);
    scene.shapes = planes;
    let group = scene.groups.push(Group { name: "zoo".into(), shapes });
    for place in places() {
        scene.instances.push(Instance { name: String::new(), group, to_world: place });
    }
    let wide = World::new(scene).unwrap();
    let mut portable = wide.clone();
    portable.scenery.simd = Simd::Portable;
    for i in 0..20_000 {
        let ray = random_ray(i);
        assert_eq!(wide.nearest(&ray), portable.nearest(&ray));
        let ray = Ray { t_max: 1.0, ..ray };
        assert_eq!(wide.occluded(&ray), portable.occluded(&ray));
    }
}

/// Instances show what copies would: distances to 10⁻⁴ of the size, normals to 10⁻³ where none is
/// interpolated. Rays that pass within that of an edge may differ, which is one in some hundred.
#[test]
fn an_instance_is_seen_like_a_copy() {
    for place in places() {
        let mut mesh = ball(20);
        mesh.normals.clear();
        let (copy, instance) = (placed(&mesh, place, false), placed(&mesh, place, true));
        let size = copy.bounds().extent().max_element();
        let (inner, outer) = (copy.bounds(), instance.bounds());
        assert!(outer.min.cmple(inner.min).all() && outer.max.cmpge(inner.max).all(), "{inner:?} {outer:?}");
        let mut odd = 0;
        for i in 0..5_000 {
            let mut s = sampler(i);
            let (center, radius) = copy.bounds().bounding_sphere();
            let origin = center + warp::square_to_sphere(s.next_2d()) * (2.0 * radius * s.next_1d());
            let ray = Ray::new(origin, warp::square_to_sphere(s.next_2d()));
            let same = match (copy.intersect(&ray), instance.intersect(&ray)) {
                (None, None) => true,
                (Some(a), Some(b)) => {
                    (a.t - b.t).abs() < 1e-4 * size
                        && a.point.ng.dot(b.point.ng) > 0.999
                        && a.point.uv.distance(b.point.uv) < 1e-2
                        && (a.point.position - b.point.position).length() < 1e-4 * size
                }
                _ => false,
            };
            odd += i32::from(!same);
        }
        assert!(odd < 50, "{odd} of 5000 rays differ");
    }
}

/// From a convex body a ray that leaves outward meets nothing, and one that goes inward meets the other
/// side, never the place where it starts.
#[test]
fn rays_that_leave_an_instance_do_not_meet_it_where_they_start() {
    let mut scene = empty();
    let sphere = Geometry::Sphere { center: Vec3::new(0.3, 0.0, 0.0), radius: 1.0 };
    let shapes = vec![shape(&scene, sphere, Transform::IDENTITY)];
    let group = scene.groups.push(Group { name: "ball".into(), shapes });
    for place in places() {
        let mut scene = scene.clone();
        scene.instances.push(Instance { name: String::new(), group, to_world: place });
        let world = World::new(scene).unwrap();
        let size = world.bounds().extent().max_element();
        let (center, radius) = world.bounds().bounding_sphere();
        let mut seen = 0;
        for i in 0..20_000 {
            let mut s = sampler(i);
            let from = warp::square_to_sphere(s.next_2d()) * radius;
            let to = warp::square_to_sphere(s.next_2d()) * (0.2 * radius);
            let Some(hit) = world.intersect(&Ray::new(center + from, (to - from).normalize())) else {
                continue;
            };
            seen += 1;
            let direction = warp::square_to_sphere(s.next_2d());
            let again = world.intersect(&leave(&hit.point, direction));
            let cos = direction.dot(hit.point.ng);
            if cos > 0.0 {
                assert!(again.is_none(), "met itself at {again:?}, from {hit:?}");
            } else {
                let far = again.is_some_and(|a| a.t > 1e-4 * size * -cos * 0.2);
                assert!(far || cos > -0.05, "{again:?} from {hit:?} along {direction}");
            }
        }
        assert!(seen > 1_000, "{seen}");
    }
}

#[test]
fn a_thousand_instances_cost_one_mesh() {
    let bytes = |n: usize| {
        let mut scene = empty();
        let mesh = scene.meshes.push(ball(71));
        let shapes = vec![shape(&scene, Geometry::Mesh(mesh), Transform::IDENTITY)];
        let group = scene.groups.push(Group { name: "ball".into(), shapes });
        for i in 0..n {
            let to_world = Transform::translate(DVec3::new(i as f64 * 3.0, 0.0, 0.0));
            scene.instances.push(Instance { name: String::new(), group, to_world });
        }
        let world = World::new(scene).unwrap();
        assert_eq!(world.primitive_count(), 2 * 71 * 70);
        assert_eq!(world.scenery.meshes.len(), 1);
        world.tree_bytes()
    };
    let (one, thousand) = (bytes(1), bytes(1000));
    assert!(one < 100 * 2 * 71 * 70, "{one} bytes for {} triangles", 2 * 71 * 70);
    assert!(thousand < one + 1000 * 200, "{one} {thousand}");
}

/// Clustering makes a chain of them, too deep to be gone through.
#[test]
fn thousands_of_triangles_in_one_place_are_met() {
    let mut scene = empty();
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let count = 4000;
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2]; count], ..Mesh::default() };
    let mesh = scene.meshes.push(mesh);
    scene.shapes.push(shape(&scene, Geometry::Mesh(mesh), Transform::IDENTITY));
    let world = World::new(scene).expect("a sound scene");
    assert_eq!(world.primitive_count(), count);
    let ray = |x: f32| Ray::new(Vec3::new(x, 0.25, 3.0), -Vec3::Z);
    assert_eq!(world.nearest(&ray(0.5)).map(|hit| hit.t), Some(3.0));
    assert!(world.occluded(&ray(0.5)));
    assert!(world.nearest(&ray(0.8)).is_none() && !world.occluded(&ray(0.8)));
}

/// A mesh that is shown at one place is moved there; at several, all but one get their own.
#[test]
fn meshes_are_in_memory_once_for_each_place() {
    let at = |x: f64| Transform::translate(DVec3::new(x, 0.0, 0.0));
    let turned = Transform::scale(DVec3::new(-1.0, 1.0, 1.0)).then(at(20.0));
    for places in [
        vec![at(10.0)],
        vec![turned],
        vec![at(10.0), turned],
        vec![at(10.0), Transform::IDENTITY, turned],
        vec![Transform::IDENTITY, at(10.0)],
        vec![Transform::IDENTITY, Transform::IDENTITY],
    ] {
        let mut scene = empty();
        let mesh = scene.meshes.push(ball(12));
        scene.shapes = places.iter().map(|&p| shape(&scene, Geometry::Mesh(mesh), p)).collect();
        let given = scene.clone();
        let world = World::new(scene).expect("a sound scene");
        let apart: Vec<_> = places.iter().filter(|&&p| p != Transform::IDENTITY).collect();
        let still = usize::from(apart.len() < places.len());
        assert_eq!(world.scene().meshes.len(), apart.len() + still);
        assert_eq!(given.meshes.as_slice(), [ball(12)], "what was given is another scene");
        for place in &places {
            let center = place.point(Vec3::ZERO);
            let ray = Ray::new(center + Vec3::new(0.1, -5.0, 0.2), Vec3::Y);
            let hit = world.intersect(&ray).expect("a ball is there");
            assert!(hit.point.position.distance(center) < 1.3 && hit.point.ng.y < 0.0);
        }
    }
}

#[test]
fn groups_that_cannot_be_shown_are_refused() {
    let mut scene = empty();
    let emission = Some(scene.textures.constant(Rgb::WHITE));
    let mut lamp = shape(&scene, Geometry::Rectangle, Transform::IDENTITY);
    lamp.emission = emission;
    let plane = shape(&scene, Geometry::Plane, Transform::IDENTITY);
    scene.shapes.push(shape(&scene, Geometry::Disk, Transform::IDENTITY));
    let group = scene.groups.push(Group { name: "bad".into(), shapes: vec![lamp, plane] });
    scene.groups.push(Group::default());
    let flat = Transform::scale(DVec3::new(1.0, 0.0, 1.0));
    scene.instances.push(Instance { name: String::new(), group, to_world: flat });
    let text = World::new(scene).unwrap_err().to_string();
    assert_eq!(
        text,
        "shape 1: a shape of a group cannot emit light: put the lamp beside the instances\n\
         shape 2: an infinite plane cannot be part of a group: use a rectangle\n\
         group 1: the group has no shape: instances of it would show nothing\n\
         instance 0: `to_world` is singular or not finite: no axis may be scaled to zero, and every number \
         must be finite"
    );
}
