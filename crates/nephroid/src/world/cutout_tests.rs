//! Masked surfaces against the closed form: k sheets of opacity o let (1 − o)^k of the light through.
//!
//! The tests by chance share the level [`ALPHA`]; seeds are fixed.

use nephroid_testkit::{ALPHA, Outcome, binomial_test, sidak};

use super::World;
use super::cutout::chance;
use crate::camera::{Camera, Projection};
use crate::color::Rgb;
use crate::film::{FilmSettings, Filter};
use crate::handle::{Arena, Handle};
use crate::material::Material;
use crate::math::{Affine2, DVec3, Ray, Transform, Vec2, Vec3};
use crate::medium::Boundary;
use crate::medium::Media;
use crate::sampling::{Key, Sampler, Sequence, Stream};
use crate::scene::Scene;
use crate::shape::{Geometry, Mesh, Shape};
use crate::texture::{Checkerboard, Texture, Textures};

/// Nine of sheets, each for shadow rays and closest hits; six of the order of hits; two shapes with four.
const TESTS: usize = 18 + 6 + 8;
const RAYS: u64 = 100_000;

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

/// Shapes at places, all of one masked material.
fn world(
    shapes: &[(Geometry, Transform)],
    mesh: Option<Mesh>,
    opacity: impl Fn(&mut Textures) -> Handle<Texture>,
) -> World {
    let mut scene = Scene {
        camera: Camera { to_world: Transform::IDENTITY, projection: Projection::Orthographic, medium: None },
        film: FilmSettings { width: 1, height: 1, crop: None, filter: Filter::Box },
        textures: Textures::default(),
        materials: Arena::default(),
        meshes: Arena::default(),
        shapes: Vec::new(),
        lights: Vec::new(),
        groups: Arena::default(),
        instances: Vec::new(),
        media: Media::default(),
    };
    let opacity = opacity(&mut scene.textures);
    let reflectance = scene.textures.constant(Rgb::splat(0.5));
    let inside = scene.materials.push(Material::Diffuse { reflectance });
    let material = scene.materials.push(Material::Mask { opacity, inside });
    if let Some(mesh) = mesh {
        scene.meshes.push(mesh);
    }
    for (geometry, to_world) in shapes {
        scene.shapes.push(Shape {
            name: String::new(),
            geometry: geometry.clone(),
            to_world: *to_world,
            material,
            emission: None,
            flip_normals: false,
            boundary: Boundary::default(),
        });
    }
    World::new(scene).unwrap()
}

fn grey(value: f32) -> impl Fn(&mut Textures) -> Handle<Texture> {
    move |textures| textures.constant(Rgb::splat(value))
}

/// `k` squares of side 4, each at the z of its number from one, one of them two triangles of a mesh.
fn sheets(k: u32, opacity: f32) -> World {
    let corners = [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]];
    let mesh = Mesh {
        positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let handle = Arena::default().push(mesh.clone());
    let at = |z: u32| Transform::translate(DVec3::new(0.0, 0.0, f64::from(z)));
    let shapes: Vec<_> = (1..=k)
        .map(|z| match z {
            2 => (Geometry::Mesh(handle), at(z)),
            _ => (Geometry::Rectangle, Transform::scale(DVec3::splat(2.0)).then(at(z))),
        })
        .collect();
    world(&shapes, Some(mesh), grey(opacity))
}

/// A ray about +z, whose numbers are those of nothing else.
fn ray(i: u64) -> Ray {
    let mut s = Sampler::new(Sequence::Independent, Key::new(11, 0, Stream::Camera), i);
    let (a, b) = (2.0 * s.next_2d() - Vec2::ONE, 2.0 * s.next_2d() - Vec2::ONE);
    Ray::new(a.extend(0.0), (0.1 * b).extend(1.0).normalize())
}

#[test]
fn sheets_let_through_what_their_opacities_leave() {
    for opacity in [0.05, 0.5, 0.9] {
        for k in [1, 2, 5] {
            let world = sheets(k, opacity);
            let exact = (1.0 - f64::from(opacity)).powi(k as i32);
            let unmet = (0..RAYS).filter(|&i| world.intersect(&ray(i)).is_none()).count();
            judge(&format!("rays, {k} of {opacity}"), &binomial_test(unmet as u64, RAYS, exact));
            // Not the same rays: to a point, and not of unit length.
            let shadow = |i| {
                let Ray { origin, direction, .. } = ray(RAYS + i);
                Ray { origin, direction: direction * 9.0, t_max: 0.99999 }
            };
            let lit = (0..RAYS).filter(|&i| !world.occluded(&shadow(i))).count();
            judge(&format!("shadow rays, {k} of {opacity}"), &binomial_test(lit as u64, RAYS, exact));
        }
    }
}

#[test]
fn a_ray_is_not_occluded_where_it_meets_nothing() {
    // Both ask the same question of the same candidates.
    let world = sheets(4, 0.3);
    for i in 0..10_000 {
        assert_eq!(world.intersect(&ray(i)).is_some(), world.occluded(&ray(i)));
    }
}

#[test]
fn the_first_sheet_that_is_there_is_met() {
    let (opacity, k) = (0.3f32, 6);
    let world = sheets(k, opacity);
    let mut first = vec![0; k as usize];
    for i in 0..RAYS {
        if let Some(hit) = world.intersect(&ray(i)) {
            assert!((hit.point.position.z - (hit.shape + 1) as f32).abs() < 1e-5);
            assert_eq!(world.opacity(&hit), opacity);
            first[hit.shape as usize] += 1;
        }
    }
    let o = f64::from(opacity);
    for (j, count) in (0i32..).zip(first) {
        judge(&format!("sheet {j}"), &binomial_test(count, RAYS, o * (1.0 - o).powi(j)));
    }
}

#[test]
fn both_sides_of_a_curved_shape_have_their_chance() {
    let opacity = 0.6f32;
    let lying =
        Geometry::Cylinder { p0: Vec3::new(-9.0, 0.0, 4.0), p1: Vec3::new(9.0, 0.0, 4.0), radius: 2.0 };
    for (name, geometry) in
        [("sphere", Geometry::Sphere { center: Vec3::Z * 4.0, radius: 2.0 }), ("cylinder", lying)]
    {
        let world = world(&[(geometry, Transform::IDENTITY)], None, grey(opacity));
        let (mut near, mut far, mut lit) = (0, 0, 0);
        for i in 0..RAYS {
            match world.intersect(&ray(i)) {
                Some(hit) if hit.point.ng.z < 0.0 => near += 1,
                Some(hit) => {
                    // Where it says, within the rounding of the step over the near side.
                    let off = hit.point.position - ray(i).at(hit.t);
                    assert!(off.length() < 1e-4, "{name}: {off}");
                    far += 1;
                }
                None => {}
            }
            lit += u64::from(!world.occluded(&ray(RAYS + i)));
        }
        let o = f64::from(opacity);
        judge(&format!("{name}, near"), &binomial_test(near, RAYS, o));
        judge(&format!("{name}, far"), &binomial_test(far, RAYS, o * (1.0 - o)));
        judge(&format!("{name}, through"), &binomial_test(RAYS - near - far, RAYS, (1.0 - o).powi(2)));
        judge(&format!("{name}, lit"), &binomial_test(lit, RAYS, (1.0 - o).powi(2)));
    }
}

#[test]
fn what_is_cut_out_by_zeros_and_ones_has_sharp_edges() {
    let board = |textures: &mut Textures| {
        let (color0, color1) = (textures.constant(Rgb::BLACK), textures.constant(Rgb::WHITE));
        let to_uv = Affine2::from_scale(Vec2::splat(3.0));
        textures.push(Texture::Checkerboard(Checkerboard { color0, color1, to_uv }))
    };
    let to_world = Transform::scale(DVec3::splat(2.0)).then(Transform::translate(DVec3::Z));
    let cut = world(&[(Geometry::Rectangle, to_world)], None, board);
    let whole = world(&[(Geometry::Rectangle, to_world)], None, grey(1.0));
    let none = world(&[(Geometry::Rectangle, to_world)], None, grey(0.0));
    let mut met = 0;
    for i in 0..10_000 {
        let hit = whole.intersect(&ray(i)).unwrap();
        let opacity = cut.scene().textures.eval(Handle::clone(&opacity_of(&cut)), hit.point.uv).r;
        assert_eq!(cut.intersect(&ray(i)).is_some(), opacity == 1.0, "{}", hit.point.uv);
        assert_eq!(cut.occluded(&ray(i)), opacity == 1.0);
        assert!(none.intersect(&ray(i)).is_none() && !none.occluded(&ray(i)));
        met += u32::from(opacity == 1.0);
    }
    assert!((3000..7000).contains(&met), "{met}");
}

fn opacity_of(world: &World) -> Handle<Texture> {
    let material = world.scene().shapes[0].material;
    let Material::Mask { opacity, .. } = world.scene().materials[material] else { panic!("not a mask") };
    opacity
}

#[test]
fn chances_do_not_know_the_unit_of_length() {
    for i in 0..1000 {
        let Ray { origin, direction, .. } = ray(i);
        let value = chance(&Ray::new(origin, direction), [i, 0]);
        assert_eq!(value, chance(&Ray::new(origin * 1024.0, direction), [i, 0]));
        assert_eq!(value, chance(&Ray::new(origin / 64.0, direction / 64.0), [i, 0]));
        assert_ne!(value, chance(&Ray::new(origin, direction), [i, 1]));
        assert!((0.0..1.0).contains(&value));
    }
}
