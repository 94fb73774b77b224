//! Light brought to a focus: by a parabolic mirror, and by a glass ball with all its aberration.
//!
//! All tests together reject a correct program with a probability of [`ALPHA`]; seeds are fixed.

use std::f64::consts::PI;

use nephroid::color::Rgb;
use nephroid::integrator::{Method, PhotonMapperConfig, Show};
use nephroid::light::LightKind;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::{Geometry, Mesh};
use nephroid::world::World;
use nephroid_convergence::{
    Builder, derivative, epanechnikov, fresnel, map_view, pixel_origins, renders, root, session,
};
use nephroid_testkit::{ALPHA, MeanTest, binomial_test, sidak};

/// Two discs at the parabola's focus, five behind the ball, and rings of light behind it: four by a
/// fixed radius and two by neighbours.
const TESTS: usize = 2 + 5 + 4 + 2;

fn level() -> f64 {
    sidak(ALPHA, TESTS)
}

/// Parallel light of 1 W/m² that shines down.
fn sun(b: &mut Builder) {
    b.light(LightKind::Directional { direction: Vec3::NEG_Y, irradiance: Rgb::WHITE });
}

/// The area that photons of the only light start from: each path carries as many W.
fn silhouette(world: &World) -> f64 {
    world.lights().map(|(_, power)| f64::from(power.mean())).sum()
}

/// Caustic photons that land on the only surface that is not specular, of [`PATHS`].
fn caught(world: &World) -> u64 {
    // Sent everywhere, so that their number is their share of the light.
    let config = PhotonMapperConfig { aim: false, ..map_view(Show::Caustic, PATHS) };
    let method = Method::PhotonMapper(config);
    let map = session(world, method, 1, 1).statistics().caustic;
    assert_eq!(map.paths, PATHS);
    map.photons
}

const PATHS: u64 = 200_000;

/// A grey disc about (0, y, 0), facing up or down and black from behind.
fn disc(b: &mut Builder, y: f64, radius: f64, up: bool) {
    let grey = b.diffuse(0.5);
    let to_world = Transform::scale(DVec3::splat(radius))
        .then(Transform::rotate(DVec3::X, if up { -90.0 } else { 90.0 }))
        .then(Transform::translate(DVec3::Y * y));
    b.shape(Geometry::Disk, to_world, grey);
}

/// Meridians and parallels of the dish.
const SECTORS: u32 = 96;
const PARALLELS: u32 = 48;

/// The dish y = ρ²/4, ρ ≤ 1, of focal length 1, with the normals of the paraboloid at its vertices.
fn dish() -> Mesh {
    let mut mesh = Mesh { positions: vec![Vec3::ZERO], normals: vec![Vec3::Y], ..Mesh::default() };
    for ring in 1..=PARALLELS {
        for sector in 0..SECTORS {
            let rho = f64::from(ring) / f64::from(PARALLELS);
            let phi = 2.0 * PI * f64::from(sector) / f64::from(SECTORS);
            let (x, z) = (rho * libm::cos(phi), rho * libm::sin(phi));
            mesh.positions.push(DVec3::new(x, 0.25 * rho * rho, z).as_vec3());
            mesh.normals.push(DVec3::new(-0.5 * x, 1.0, -0.5 * z).normalize().as_vec3());
        }
    }
    for sector in 0..SECTORS {
        let next = (sector + 1) % SECTORS;
        mesh.triangles.push([0, 1 + next, 1 + sector]);
        for ring in 0..PARALLELS - 1 {
            let at = |r: u32, s: u32| 1 + (ring + r) * SECTORS + s;
            mesh.triangles.push([at(0, sector), at(0, next), at(1, next)]);
            mesh.triangles.push([at(0, sector), at(1, next), at(1, sector)]);
        }
    }
    mesh
}

fn at_the_focus(mesh: Mesh, receiver: f64, reflectance: f64) -> World {
    let mut b = Builder::parallel_view(Vec3::Y * 0.5, Vec3::Y, 0.5, 1, 1);
    let mirror = b.mirror(reflectance as f32);
    b.mesh(mesh, mirror);
    disc(&mut b, 1.0, receiver, false);
    sun(&mut b);
    b.build()
}

/// A parabolic mirror sends all that falls on it, but for the shadow of the receiver, through the
/// focus: ρ (A − π a²) W. A is the area of the polygon that the mesh is from above.
///
/// Edges are at most h = .065 long. A facet lies up to h²/16 = 2.7e-4 above the paraboloid, whose
/// normals are interpolated to h²/32 = 1.4e-4, which the reflection doubles and carries 1.25 far;
/// light comes to the focus at up to 53° and is spread by 1/cos 53° there. All together that is
/// 1.1e-3: a disc of radius .002 catches everything. Counts are binomial, as every photon carries the
/// same power, whatever its facet: the mirror's reflectance becomes the probability of survival.
#[test]
fn a_parabolic_mirror_sends_all_light_to_its_focus() {
    let area = 0.5 * f64::from(SECTORS) * libm::sin(2.0 * PI / f64::from(SECTORS));
    for (receiver, reflectance) in [(0.002, 0.9), (0.3, 0.5)] {
        let world = at_the_focus(dish(), receiver, reflectance);
        let share = reflectance * (area - PI * receiver * receiver) / silhouette(&world);
        binomial_test(caught(&world), PATHS, share).assert_passes(level());
    }
}

/// Without vertex normals each facet is a plane mirror, whose light is as wide as itself: the small
/// disc would tell.
#[test]
fn a_faceted_mirror_does_not() {
    let faceted = Mesh { normals: Vec::new(), ..dish() };
    let all = caught(&at_the_focus(dish(), 0.002, 0.9));
    assert!(10 * caught(&at_the_focus(faceted, 0.002, 0.9)) < all);
}

const INDEX: f64 = 1.5;
/// Reflections within the ball that are followed; what is left carries F⁵ < 1e-6, but at the rim.
const ORDERS: i32 = 5;

/// Where light that meets the unit ball at distance h from the axis crosses the plane y = −p, by its
/// signed distance from the axis, and its share of the power; after `order` reflections within. `None`
/// if it does not leave downwards.
///
/// Its angle to the axis is D = 2 (i − r) + m (π − 2 r), and as at its entry it passes the centre at
/// distance h: the ball is round.
fn through_ball(h: f64, order: i32, p: f64) -> Option<(f64, f64)> {
    let (i, r) = (libm::asin(h), libm::asin(h / INDEX));
    let d = 2.0 * (i - r) + f64::from(order) * (PI - 2.0 * r);
    let f = fresnel(h, INDEX);
    let share = (1.0 - f) * (1.0 - f) * f.powi(order);
    (libm::cos(d) > 0.0).then(|| (h / libm::cos(d) - p * libm::tan(d), share))
}

/// The sum over incident light of `weight(|x|)` times its power.
fn over_ball(p: f64, steps: u32, weight: impl Fn(f64) -> f64) -> f64 {
    let dh = 1.0 / f64::from(steps);
    let hs = (0..steps).map(|i| (f64::from(i) + 0.5) * dh);
    let power = |h: f64| {
        let rays = (0..ORDERS).filter_map(|order| through_ball(h, order, p));
        rays.map(|(x, share)| share * weight(x.abs())).sum::<f64>() * 2.0 * PI * h * dh
    };
    hs.map(power).sum()
}

/// A ball about the origin, and a screen at y = −p.
fn behind_ball(p: f64, screen: f64, pixels: u32) -> World {
    let eye = 1.0 + 0.5 * (p - 1.0);
    let from = Vec3::NEG_Y * eye as f32;
    let mut b = Builder::parallel_view(from, Vec3::NEG_Y * p as f32, 0.25, pixels, pixels);
    let glass = b.glass(INDEX as f32);
    b.sphere(Vec3::ZERO, 1.0, glass);
    disc(&mut b, -p, screen, true);
    sun(&mut b);
    b.build()
}

/// Near the axis light meets at n/(2 (n − 1)), 1.5 radii from the centre.
#[test]
fn the_model_has_the_paraxial_focus() {
    let (x, _) = through_ball(1e-3, 0, INDEX / (2.0 * (INDEX - 1.0))).expect("light goes on");
    assert!(x.abs() < 1e-8, "{x}");
}

/// The power within discs before, at and behind the paraxial focus, by exact binomial tests: the
/// aberration of the ball decides it.
#[test]
fn a_ball_lens_concentrates_light_by_its_aberration() {
    for (p, radius) in [(1.25, 0.05), (1.25, 0.15), (1.5, 0.02), (1.5, 0.2), (2.0, 0.5)] {
        let world = behind_ball(p, radius, 1);
        let power = over_ball(p, 1_000_000, |x| f64::from(x < radius));
        binomial_test(caught(&world), PATHS, power / silhouette(&world)).assert_passes(level());
    }
}

/// Mean over the circle of radius x of the Epanechnikov kernel of radius r at distance q from its
/// centre, in closed form.
fn ring_kernel(q: f64, x: f64, r: f64) -> f64 {
    let (sum, product) = (q * q + x * x, 2.0 * q * x);
    if product < 1e-12 {
        return epanechnikov(sum, r);
    }
    let cos_edge = ((sum - r * r) / product).clamp(-1.0, 1.0);
    let phi = libm::acos(cos_edge);
    let integral = phi * (1.0 - sum / (r * r)) + product / (r * r) * libm::sin(phi);
    2.0 / (PI * r * r) * integral / PI
}

/// E(q) = Σ T h / (q |dx/dh|) over all h that land at distance q.
fn by_jacobian(q: f64, p: f64) -> f64 {
    const STEPS: u32 = 4000;
    let mut sum = 0.0;
    for order in 0..ORDERS {
        let x = |h: f64| through_ball(h, order, p).map_or(f64::NAN, |(x, _)| x.abs() - q);
        for i in 1..STEPS - 1 {
            let (a, b) = (f64::from(i) / f64::from(STEPS), f64::from(i + 1) / f64::from(STEPS));
            if x(a) * x(b) < 0.0 {
                let h = root(x, a, b);
                let share = through_ball(h, order, p).map_or(0.0, |(_, share)| share);
                sum += share * h / (q * derivative(x, h, 1e-5).abs());
            }
        }
    }
    sum
}

/// Rings on the screen .25 before the paraxial focus, each render's mean of measured over expected.
///
/// With a fixed radius the expectation is known, the bright point in the middle and the caustic ring
/// around it included. Pixels are .31 of the radius, and the means over 4 by 4 points of each, which
/// err by a sixteenth of (.31)²/24 · 6 = 2.4 % of what blurring does. Further out the light of one
/// branch is left, E ∝ 1/q or so. There k = 30 of 100 000 photons lie within r = .04, and the bias
/// r²/12q² is 5e-3.
#[test]
fn light_behind_a_ball_has_the_profile_of_the_jacobian() {
    const P: f64 = 1.25;
    const RADIUS: f64 = 0.04;
    const FINE: f64 = 1e-3;
    let world = behind_ball(P, 0.5, 40);
    let origins = pixel_origins(&world);
    let distance: Vec<f64> = origins.iter().map(|o| libm::hypot(o.x, o.z)).collect();
    let table = |f: &dyn Fn(f64) -> f64| {
        let values: Vec<f64> = (0..=400).map(|i| f(f64::from(i).max(0.5) * FINE)).collect();
        move |q: f64| {
            let i = (q / FINE) as usize;
            values[i] + (q / FINE - i as f64) * (values[i + 1] - values[i])
        }
    };
    let blurred = table(&|q| over_ball(P, 4000, |x| ring_kernel(q, x, RADIUS)));
    let sharp = table(&|q| if q > 0.09 { by_jacobian(q, P) } else { 0.0 });
    let pixel_mean = |profile: &dyn Fn(f64) -> f64, o: DVec3| {
        let offsets = [-0.375, -0.125, 0.125, 0.375].map(|offset| offset * 2.0 * 0.25 / 40.0);
        let points = offsets.iter().flat_map(|u| offsets.iter().map(move |v| libm::hypot(o.x + u, o.z + v)));
        points.map(profile).sum::<f64>() / 16.0
    };
    let fixed = PhotonMapperConfig { radius: Some(RADIUS as f32), ..map_view(Show::Caustic, 50_000) };
    let nearest = PhotonMapperConfig { neighbours: 30, ..map_view(Show::Caustic, 100_000) };
    let rings = [0.0, 0.05, 0.1, 0.17, 0.25];
    type Profile<'a> = &'a dyn Fn(f64) -> f64;
    for (config, expected, first, bias) in
        [(fixed, &blurred as Profile<'_>, 0, 2e-3), (nearest, &sharp as Profile<'_>, 2, 5e-3)]
    {
        let expected: Vec<f64> = origins.iter().map(|&o| pixel_mean(expected, o)).collect();
        let pictures = renders(&world, &Method::PhotonMapper(config), 4, 1..17);
        for ring in rings[first..].windows(2) {
            let ratio = |picture: &Vec<f64>| {
                let inside = (0..picture.len()).filter(|&i| (ring[0]..ring[1]).contains(&distance[i]));
                let (sum, of) = inside.fold((0.0, 0.0), |(s, o), i| (s + picture[i], o + expected[i]));
                sum * PI / (0.5 * of)
            };
            let test: MeanTest = pictures.iter().map(ratio).collect();
            test.within(1.0, bias).assert_passes(level());
        }
    }
}
