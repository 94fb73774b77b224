//! What the camera and lamps stand in, as the world finds it; what is said where that is not clear; and which
//! medium a straight ray is in after each surface, told by how much of a lamp's light comes through.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::integrator::{Method, PhotonMapperConfig};
use nephroid::light::LightKind;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::medium::{Boundary, Medium, Phase};
use nephroid::scene::Subject;
use nephroid::shape::{Geometry, Group, Instance, Shape};
use nephroid::world::World;
use nephroid_convergence::{Builder, between, boxed, facing, means, volpath};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// The means of renders that are compared; all else is exact.
const TESTS: usize = 9;

/// A camera at the origin that looks along +z through a narrow angle.
fn looking() -> Builder {
    Builder::seen_from(Vec3::ZERO, Vec3::Z, 0.02, 2)
}

/// A medium that only absorbs.
fn smoke(b: &mut Builder, sigma_t: f32) -> Handle<Medium> {
    b.fog(Rgb::splat(sigma_t), Rgb::BLACK, Phase::Isotropic)
}

fn ball(b: &mut Builder, center: Vec3, radius: f32, boundary: Boundary) -> &mut Shape {
    b.border(Geometry::Sphere { center, radius }, Transform::IDENTITY, boundary)
}

fn point(b: &mut Builder, x: f32) {
    b.point_light(Vec3::new(x, 0.0, 0.0), 1.0);
}

fn camera(world: &World) -> Option<Handle<Medium>> {
    world.camera_surroundings().medium()
}

fn lamp(world: &World, light: usize) -> Option<Handle<Medium>> {
    world.light_surroundings(light).medium()
}

fn remarks(world: &World) -> Vec<(Subject, &str)> {
    world.remarks().iter().map(|r| (r.subject, r.message.as_str())).collect()
}

/// A lamp of radiance 1 at z = 10 that fills the picture.
fn with_target(mut b: Builder) -> World {
    let (black, one) = (b.diffuse(0.0), b.constant(1.0));
    let to_world = facing(DVec3::new(0.0, 0.0, 10.0), 1.0, DVec3::X, 180.0);
    b.shape(Geometry::Rectangle, to_world, black).emission = Some(one);
    b.build()
}

/// The share of the target's light that reaches the camera must be e^(−depth): what the photon mapper shows
/// is exact, and what paths bring is so in the mean.
fn assert_depth(world: &World, depth: f64, what: &str) {
    assert_depth_within(world, depth, 1e-4, what);
}

/// The same where the photon mapper chooses ways of so small a share by chance.
fn assert_depth_within(world: &World, depth: f64, share: f64, what: &str) {
    let exact = libm::exp(-depth);
    let mapper = Method::PhotonMapper(PhotonMapperConfig { emit: Some(64), ..Default::default() });
    let seen = means(world, &mapper, 1, 1..2)[0];
    assert!((seen / exact - 1.0).abs() < share, "{what}: {seen}, not {exact}");
    let paths: MeanTest = means(world, &volpath(None), 64, 0..16).into_iter().collect();
    let outcome = paths.within(exact, 1e-4);
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{what}: {outcome}");
}

#[test]
fn closed_boundaries_tell_what_is_inside_and_what_is_not() {
    let mut b = looking();
    let (small, large) = (smoke(&mut b, 1.0), smoke(&mut b, 2.0));
    ball(&mut b, Vec3::ZERO, 1.0, between(Some(small), Some(large)));
    ball(&mut b, Vec3::ZERO, 3.0, between(Some(large), None));
    for x in [0.5, 2.0, 5.0] {
        point(&mut b, x);
    }
    let to_world = Transform::translate(DVec3::new(-2.0, 0.0, 0.0));
    let intensity = Rgb::WHITE;
    b.light(LightKind::Spot { to_world, intensity, cutoff_deg: 20.0, beam_width_deg: 10.0, texture: None });
    let (black, one) = (b.diffuse(0.0), b.constant(1.0));
    b.sphere(Vec3::new(0.0, 2.0, 0.0), 0.3, black).emission = Some(one);
    let world = b.build();
    let area = (0..5).find(|&i| world.lights().nth(i).is_some_and(|(name, _)| name.starts_with("shape")));
    let area = area.expect("a lamp that is a shape");
    let others: Vec<_> = (0..5).filter(|&i| i != area).map(|i| lamp(&world, i)).collect();
    assert_eq!(others, [Some(small), Some(large), None, Some(large)]);
    assert_eq!(lamp(&world, area), Some(large));
    assert_eq!(camera(&world), Some(small));
    assert_eq!(remarks(&world), []);
}

/// Its walls say nothing, and the border in front is not closed.
#[test]
fn one_border_in_front_of_a_niche_is_enough() {
    let mut fog = None;
    let fill = |b: &mut Builder| *fog.insert(smoke(b, 1.0));
    let world = Builder::filled_niche(4, 0.5, fill).build();
    assert_eq!((lamp(&world, 0), camera(&world)), (fog, None));
    assert_eq!(remarks(&world), []);
}

/// Nothing bounds it, so it is everywhere.
#[test]
fn what_the_camera_names_fills_a_scene_without_borders() {
    let mut b = looking();
    let fog = smoke(&mut b, 0.1);
    b.scene.camera.medium = Some(fog);
    point(&mut b, 0.5);
    let world = with_target(b);
    assert_eq!([0, 1].map(|light| lamp(&world, light)), [Some(fog); 2]);
    assert_eq!(remarks(&world), []);
    assert_depth(&world, 1.0, "fog everywhere");
}

#[test]
fn what_is_named_is_not_looked_for() {
    let mut b = looking();
    let (here, there) = (smoke(&mut b, 1.0), smoke(&mut b, 2.0));
    ball(&mut b, Vec3::ZERO, 3.0, between(Some(here), None));
    b.scene.camera.medium = Some(there);
    point(&mut b, 1.0);
    point(&mut b, 1.0);
    b.scene.lights[1].medium = Some(there);
    let (black, one) = (b.diffuse(0.0), b.constant(1.0));
    for (y, boundary) in [
        (1.0, Boundary::default()),
        (1.5, Boundary { light: Some(there), ..Boundary::default() }),
        (2.0, between(Some(here), Some(there))),
        (2.5, between(Some(there), None)),
        (-1.0, Boundary { light: Some(here), ..between(Some(there), None) }),
    ] {
        let shape = b.sphere(Vec3::new(0.0, y, 0.0), 0.1, black);
        (shape.emission, shape.boundary) = (Some(one), boundary);
    }
    let world = b.build();
    let mut found: Vec<_> =
        world.lights().enumerate().map(|(i, (name, _))| (name.to_owned(), lamp(&world, i))).collect();
    found.sort_by(|a, b| a.0.cmp(&b.0));
    let found: Vec<_> = found.into_iter().map(|(_, medium)| medium).collect();
    let named = [Some(here), Some(there), Some(here), Some(there), Some(there), None, Some(here)];
    assert_eq!(found, named);
    assert_eq!(camera(&world), Some(there));
}

#[test]
fn light_from_infinity_starts_outside_of_everything() {
    let mut b = looking();
    let fog = smoke(&mut b, 1.0);
    ball(&mut b, Vec3::ZERO, 3.0, between(Some(fog), None));
    b.light(LightKind::Constant { radiance: Rgb::WHITE });
    b.light(LightKind::Directional { direction: Vec3::X, irradiance: Rgb::WHITE });
    let world = b.build();
    assert_eq!([0, 1].map(|light| lamp(&world, light)), [None; 2]);
    assert_eq!(camera(&world), Some(fog));
    assert_eq!(remarks(&world), []);
}

/// A wall on either side, each with another medium before it: the camera is told of both.
#[test]
fn shapes_that_do_not_agree_are_named() {
    let mut b = looking();
    let (left, right) = (smoke(&mut b, 1.0), smoke(&mut b, 2.0));
    let wall = |x: f64, degrees| facing(DVec3::new(x, 0.0, 0.0), 3.0, DVec3::Y, degrees);
    b.border(Geometry::Rectangle, wall(-1.0, 90.0), between(None, Some(left))).name = "west".into();
    b.border(Geometry::Rectangle, wall(1.0, -90.0), between(None, Some(right))).name = "east".into();
    point(&mut b, 0.0);
    b.scene.lights[0].medium = Some(left);
    let world = b.build();
    let found = remarks(&world);
    let [(Subject::Camera, message)] = found[..] else { panic!("{found:?}") };
    for part in ["the camera stands in medium `fog ", "`west`", "`east`", "name its medium"] {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn glass_that_names_nothing_in_a_medium_is_remarked_on() {
    let remarks_on = |x: f32, material: Option<f32>, boundary: fn(Handle<Medium>) -> Boundary| {
        let mut b = looking();
        let fog = smoke(&mut b, 1.0);
        ball(&mut b, Vec3::ZERO, 3.0, between(Some(fog), None));
        let material = match material {
            Some(ior) => b.glass(ior),
            None => b.mirror(1.0),
        };
        b.sphere(Vec3::new(x, 0.0, 1.0), 0.5, material).boundary = boundary(fog);
        let world = b.build();
        remarks(&world).iter().map(|&(subject, message)| (subject, message.to_owned())).collect::<Vec<_>>()
    };
    let nothing = |_| Boundary::default();
    let found = remarks_on(1.0, Some(1.5), nothing);
    let [(Subject::Shape(1), message)] = &found[..] else { panic!("{found:?}") };
    assert!(message.starts_with("it lies in medium `fog 0` and names no medium"), "{message}");
    assert_eq!(remarks_on(1.0, Some(1.5), |fog| between(None, Some(fog))), []);
    assert_eq!(remarks_on(1.0, Some(1.5), |fog| between(Some(fog), Some(fog))), []);
    assert_eq!(remarks_on(5.0, Some(1.5), nothing), [], "outside of it");
    assert_eq!(remarks_on(1.0, None, nothing), [], "a mirror lets nothing in");
}

#[test]
fn normals_that_are_turned_change_the_sides() {
    for flip in [false, true] {
        let mut b = looking();
        let (inner, outer) = (smoke(&mut b, 0.3), smoke(&mut b, 0.05));
        b.scene.camera.medium = Some(outer);
        let sides = if flip { between(Some(outer), Some(inner)) } else { between(Some(inner), Some(outer)) };
        ball(&mut b, Vec3::new(0.0, 0.0, 5.0), 1.0, sides).flip_normals = flip;
        let world = with_target(b);
        assert_eq!(lamp(&world, 0), Some(outer));
        assert_depth(&world, 2.0 * 0.3 + 8.0 * 0.05, "turned normals");
    }
}

/// Turned, stretched and mirrored; and a camera is found to be in the other.
#[test]
fn borders_in_groups_are_at_their_instances() {
    let mut b = looking();
    let (fog, null) = (smoke(&mut b, 0.4), b.null());
    let mut shape = Shape::new("ball", Geometry::Sphere { center: Vec3::ZERO, radius: 1.0 }, null);
    shape.boundary = between(Some(fog), None);
    let group = b.scene.groups.push(Group { name: "group".into(), shapes: vec![shape] });
    let stretched = Transform::scale(DVec3::new(2.0, 0.7, 0.5))
        .then(Transform::rotate(DVec3::Y, 90.0))
        .then(Transform::translate(DVec3::new(0.0, 0.0, 4.0)));
    let mirrored = boxed(DVec3::new(0.0, 0.0, 8.0), DVec3::new(1.0, 1.0, -0.5));
    let around = boxed(DVec3::ZERO, DVec3::new(-1.0, 1.0, 1.0));
    for (i, to_world) in [stretched, mirrored, around].into_iter().enumerate() {
        b.scene.instances.push(Instance { name: format!("instance {i}"), group, to_world });
    }
    let world = with_target(b);
    assert_eq!((camera(&world), lamp(&world, 0)), (Some(fog), None));
    assert_eq!(remarks(&world), []);
    assert_depth(&world, 0.4 * (1.0 + 4.0 + 1.0), "instances");
}

/// A lamp that is a border between media shines into what is before it.
#[test]
fn a_lamp_that_is_a_border_shines_into_what_is_before_it() {
    let mut b = looking();
    let (before, behind) = (smoke(&mut b, 0.1), smoke(&mut b, 5.0));
    b.scene.camera.medium = Some(before);
    let (null, one) = (b.null(), b.constant(1.0));
    let to_world = facing(DVec3::new(0.0, 0.0, 6.0), 1.0, DVec3::X, 180.0);
    let shape = b.shape(Geometry::Rectangle, to_world, null);
    (shape.emission, shape.boundary) = (Some(one), between(Some(behind), Some(before)));
    let wall = b.diffuse(0.0);
    b.shape(Geometry::Rectangle, facing(DVec3::new(0.0, 0.0, 7.0), 2.0, DVec3::X, 180.0), wall);
    let world = b.build();
    assert_eq!(lamp(&world, 0), Some(before));
    assert_eq!(remarks(&world), []);
    assert_depth(&world, 0.6, "a lamp that is a border");
}

/// Between two smooth faces that reflect R at normal incidence, with transmittance T between them, comes
/// through (1 − R)² T + (1 − R)² R² T³ + … = (1 − R)² T / (1 − R² T²).
#[test]
fn glass_in_fog_is_clear_and_fog_in_glass_ends_with_it() {
    let (r, sigma) = (0.04, 0.2);
    let through = |depth: f64| {
        let t = libm::exp(-depth);
        0.96 * 0.96 * t / (1.0 - r * r * t * t)
    };
    let slab = |b: &mut Builder, boundary| {
        let glass = b.glass(1.5);
        let shape = b.shape(Geometry::Cube, boxed(DVec3::new(0.0, 0.0, 5.0), DVec3::ONE), glass);
        shape.boundary = boundary;
    };
    let mut b = looking();
    let fog = smoke(&mut b, sigma as f32);
    b.scene.camera.medium = Some(fog);
    slab(&mut b, between(None, Some(fog)));
    let clear = with_target(b);
    // Both ways are followed at two faces, and at further ones one by chance.
    let rare = 2.0 * r * r;
    assert_depth_within(&clear, 8.0 * sigma - libm::log(through(0.0)), rare, "glass in fog");
    let mut b = looking();
    let fog = smoke(&mut b, sigma as f32);
    slab(&mut b, between(Some(fog), None));
    let filled = with_target(b);
    assert_eq!((camera(&filled), lamp(&filled, 0)), (None, None));
    assert_depth_within(&filled, -libm::log(through(2.0 * sigma)), rare, "fog in glass");
}

/// Each surface says what begins behind it, whatever else is there: where shapes overlap, the last one crossed
/// decides.
#[test]
fn of_shapes_that_overlap_the_last_crossed_decides() {
    let mut b = looking();
    let (first, second) = (smoke(&mut b, 0.3), smoke(&mut b, 0.2));
    for (z, inside) in [(4.0, first), (5.0, second)] {
        b.border(Geometry::Cube, boxed(DVec3::new(0.0, 0.0, z), DVec3::ONE), between(Some(inside), None));
    }
    // From 3 to 4 in the first, to 5 in the second, and behind the end of the first in none.
    assert_depth(&with_target(b), 0.3 + 0.2, "shapes that overlap");
    // The same with the end of the first inside of the second, if it says so.
    let mut b = looking();
    let (first, second) = (smoke(&mut b, 0.3), smoke(&mut b, 0.2));
    let cube = boxed(DVec3::new(0.0, 0.0, 4.0), DVec3::ONE);
    b.border(Geometry::Cube, cube, between(Some(first), Some(second)));
    b.scene.camera.medium = Some(second);
    assert_depth(&with_target(b), 2.0 * 0.3 + 8.0 * 0.2, "one in the other");
}
