//! Glass that takes light apart: where each colour goes, and that none is gained or lost.
//!
//! The statistical tests of the file share the level [`ALPHA`] by Šidák's formula: on seeds chosen afresh, correct code would
//! fail somewhere in this file with probability 1 %.

use std::f64::consts::PI;

use libm::{acos, asin, cos, sin, sqrt};
use nephroid::color::{Rgb, Wavelength, response};
use nephroid::integrator::PhotonMapperConfig;
use nephroid::material::Dispersion;
use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::photon_map::Photon;
use nephroid::shape::{Geometry, Mesh};
use nephroid::transport::WalkSettings;
use nephroid::world::World;
use nephroid_convergence::{
    Builder, channel_means, every_method_but, forgiving, fresnel, photons, render, volpath,
};
use nephroid_testkit::{ALPHA, MeanTest, sidak};

/// More than the statistical tests of this file.
const TESTS: usize = 40;

/// Schott's N-SF11, whose Abbe number is 25.8.
const FLINT: Dispersion = Dispersion::Sellmeier {
    b: [1.737_596_9, 0.313_747_35, 1.898_781],
    c: [0.013_188_707, 0.062_306_814, 155.236_3],
};

/// Water between 390 and 720 nm, to 0.001.
const WATER: Dispersion = Dispersion::Cauchy { a: 1.324, b: 0.003_1 };

fn index(glass: &Dispersion, nm: f64) -> f64 {
    f64::from(glass.ior(Wavelength::from_nm(nm as f32)))
}

/// The albedo of walls that photons are only to land on.
const LEAST: f32 = 1e-4;

/// The middles of the wavelengths that are seen, 1 nm each.
fn wavelengths() -> impl Iterator<Item = f64> {
    (0..330).map(|i| f64::from(Wavelength::SHORTEST_NM) + f64::from(i) + 0.5)
}

/// A prism of this apex angle along z, and light along +x that meets it at `incidence`.
fn prism(apex: f64, incidence: f64, glass: Dispersion) -> World {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 500.0), Vec3::ZERO, 40.0, 1);
    let material = b.dispersive_glass(glass);
    // The faces that light passes meet at the apex, above; the normal of the first leans by `incidence` from -x.
    let face = |normal: f64| DVec3::new(cos(normal), sin(normal), 0.0);
    let (first, second) = (face(PI - incidence), face(PI - incidence - (PI - apex)));
    let down =
        |n: DVec3| if n.y * n.x < 0.0 { DVec3::new(n.y, -n.x, 0.0) } else { DVec3::new(-n.y, n.x, 0.0) };
    let along = |n: DVec3| {
        let d = down(n);
        // Away from the other face's outside.
        let other = if n == first { second } else { first };
        if d.dot(other) < 0.0 { d } else { -d }
    };
    let side = 1.0;
    let corners = [DVec3::ZERO, along(first) * side, along(second) * side];
    let positions: Vec<Vec3> =
        [-0.5, 0.5].iter().flat_map(|&z| corners.map(|c| (c + DVec3::Z * z).as_vec3())).collect();
    let mut triangles = vec![[0, 1, 2], [3, 4, 5]];
    // Without a base, through which light would go astray.
    for (a, c) in [(0, 1), (2, 0)] {
        triangles.extend([[a, c, c + 3], [a, c + 3, a + 3]]);
    }
    let middle = positions.iter().copied().sum::<Vec3>() / 6.0;
    for t in &mut triangles {
        let [p, q, r] = t.map(|i: u32| positions[i as usize]);
        if (q - p).cross(r - p).dot(p - middle) < 0.0 {
            t.swap(1, 2);
        }
    }
    b.mesh(Mesh { positions, triangles, ..Mesh::default() }, material);
    // Behind it a wall, which reflects next to nothing.
    let grey = b.diffuse(LEAST);
    let wall = Transform::scale(DVec3::splat(5000.0)).then(Transform::rotate(DVec3::Y, -90.0));
    b.shape(Geometry::Rectangle, wall.then(Transform::translate(DVec3::X * 300.0)), grey);
    b.sunlight(Vec3::X, 1.0);
    b.build()
}

/// A prism of an apex angle turns light that comes at `incidence` by this angle: to the base.
fn deviation(apex: f64, incidence: f64, n: f64) -> f64 {
    incidence - apex + asin(n * sin(apex - asin(sin(incidence) / n)))
}

/// Light of photons that met the glass twice and no more, with the angles they were turned by.
fn turned(pass: &[Photon], limits: [f64; 2]) -> Vec<(f64, Rgb)> {
    let angle = |p: &Photon| acos(f64::from(-p.wi.x).clamp(-1.0, 1.0));
    let of_two = pass.iter().filter(|p| p.depth == 3).map(|p| (angle(p), p.power));
    of_two.filter(|(angle, _)| (limits[0]..limits[1]).contains(angle)).collect()
}

#[test]
fn a_prism_turns_every_colour_by_its_own_angle() {
    let (apex, incidence) = (PI / 3.0, 1.1);
    let world = prism(apex, incidence, FLINT);
    let of = |nm: f64| deviation(apex, incidence, index(&FLINT, nm));
    let [red, violet] = [Wavelength::LONGEST_NM, Wavelength::SHORTEST_NM].map(|nm| of(f64::from(nm)));
    assert!(violet - red > 0.1, "a prism of flint spreads light by more than {} rad", violet - red);
    // Of what comes through: each channel's mean, by its response and Fresnel's equations on both faces.
    let (mut expected, mut weights) = ([0.0; 3], [0.0; 3]);
    for nm in wavelengths() {
        let n = index(&FLINT, nm);
        let out = of(nm) + apex - incidence;
        let through = (1.0 - fresnel(sin(incidence), n)) * (1.0 - fresnel(sin(out), n));
        for (channel, r) in response(nm as f32).to_array().into_iter().enumerate() {
            expected[channel] += f64::from(r) * through * of(nm);
            weights[channel] += f64::from(r) * through;
        }
    }
    let settings = WalkSettings { max_photon_depth: Some(3), ..WalkSettings::default() };
    let mut means = [const { Vec::new() }; 3];
    for seed in 0..16 {
        let pass = photons(&world, &settings, 40_000, seed);
        let found = turned(pass.caustic.as_slice(), [0.5 * red, PI / 2.0]);
        assert!(found.len() > 500, "{} photons came through", found.len());
        for (angle, _) in &found {
            assert!((red - 1e-4..violet + 1e-4).contains(angle), "{red} to {violet}: {angle}");
        }
        for (channel, means) in means.iter_mut().enumerate() {
            let of = |power: &Rgb| f64::from(power.to_array()[channel]);
            let total: f64 = found.iter().map(|(_, power)| of(power)).sum();
            means.push(found.iter().map(|(angle, power)| angle * of(power)).sum::<f64>() / total);
        }
    }
    for (channel, means) in means.into_iter().enumerate() {
        let (test, exact): (MeanTest, f64) =
            (means.into_iter().collect(), expected[channel] / weights[channel]);
        // A quotient of two means is off by less than this.
        let outcome = test.within(exact, 1e-4);
        assert!(outcome.passes(sidak(ALPHA, TESTS)), "channel {channel}, {exact}: {outcome}");
    }
}

/// The angle from the point opposite to the sun at which a drop of this index sends most light back.
fn rainbow(n: f64) -> f64 {
    let i = acos(sqrt((n * n - 1.0) / 3.0));
    4.0 * asin(sin(i) / n) - 2.0 * i
}

#[test]
fn a_drop_makes_a_rainbow() {
    assert!((rainbow(1.333).to_degrees() - 42.078).abs() < 1e-3);
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 500.0), Vec3::ZERO, 40.0, 1);
    let water = b.dispersive_glass(WATER);
    b.sphere(Vec3::ZERO, 1.0, water);
    // A shaft around it, through which the sun shines.
    let grey = b.diffuse(LEAST);
    let shaft = Geometry::Cylinder { p0: Vec3::ZERO, p1: 1000.0 * Vec3::Y, radius: 300.0 };
    b.shape(shaft, Transform::IDENTITY, grey).flip_normals = true;
    b.sunlight(-Vec3::Y, 1.0);
    let world = b.build();
    let settings = WalkSettings { max_photon_depth: Some(4), ..WalkSettings::default() };
    let pass = photons(&world, &settings, 4_000_000, 1);
    // Light that was refracted, reflected and refracted, seen from its back.
    let back = pass.caustic.as_slice().iter().filter(|p| p.depth == 4);
    let back: Vec<(f64, Rgb)> = back.map(|p| (acos(f64::from(-p.wi.y).clamp(-1.0, 1.0)), p.power)).collect();
    assert!(back.len() > 10_000, "{} photons came back", back.len());
    let pure = |c: Rgb, [own, a, b]: [usize; 3]| {
        let c = c.to_array();
        c[own] > 8.0 * (c[a] + c[b])
    };
    let shares = |nm: f64| {
        let total: Rgb = wavelengths().map(|nm| response(nm as f32)).sum();
        response(nm as f32).zip(total, |part, whole| part / whole)
    };
    for (name, channels) in [("red", [0, 1, 2]), ("blue", [2, 0, 1])] {
        let bows: Vec<f64> = wavelengths()
            .filter(|&nm| pure(shares(nm), channels))
            .map(|nm| rainbow(index(&WATER, nm)))
            .collect();
        let widest = bows.iter().copied().fold(0.0, f64::max);
        let found = back.iter().filter(|(_, power)| pure(*power, channels)).map(|(angle, _)| *angle);
        let edge = found.fold(0.0, f64::max);
        // Most light is at the edge, where many photons lie within a thousandth; none is beyond but for rounding.
        assert!((widest - 1e-3..widest + 3e-4).contains(&edge), "{name}: {edge} instead of {widest}");
    }
    let nominal = rainbow(f64::from(WATER.nominal_ior()));
    assert!(back.iter().all(|(angle, _)| *angle < nominal + 0.02));
}

#[test]
fn white_light_stays_white_and_whole() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 0.0, 5.0), Vec3::ZERO, 40.0, 1);
    let (glass, grey) = (b.dispersive_glass(FLINT), b.diffuse(LEAST));
    b.sphere(Vec3::ZERO, 1.0, glass);
    b.sphere(Vec3::ZERO, 3.0, grey).flip_normals = true;
    b.point_light(Vec3::X * 1.5, 1.0);
    let world = b.build();
    let sums = |seed| {
        let pass = photons(&world, &WalkSettings { aim: false, ..WalkSettings::default() }, 20_000, seed);
        let landed = pass.global.as_slice().iter().chain(pass.caustic.as_slice());
        let total: Rgb = landed.map(|photon| photon.power).sum();
        total.to_array().map(|p| f64::from(p) / pass.global.emitted() as f64)
    };
    let found: Vec<[f64; 3]> = (0..24).map(sums).collect();
    let emitted = world.lights().map(|(_, power)| power).sum::<Rgb>().to_array();
    for channel in 0..3 {
        let test: MeanTest = found.iter().map(|sums| sums[channel]).collect();
        let outcome = test.within(f64::from(emitted[channel]), 2.0 * f64::from(LEAST));
        assert!(outcome.passes(sidak(ALPHA, TESTS)), "channel {channel}: {outcome}");
    }
}

/// A ball of flint over a floor under a square lamp: what paths find, all find, in each channel.
#[test]
fn all_methods_agree() {
    let mut b = Builder::seen_from(Vec3::new(0.0, 1.5, 3.0), Vec3::new(0.0, 0.3, 0.0), 40.0, 16);
    b.white_floor(2.0);
    let glass = b.dispersive_glass(FLINT);
    b.sphere(Vec3::new(0.0, 0.6, 0.0), 0.5, glass);
    let (black, glow) = (b.diffuse(0.0), b.constant(3.0));
    let lamp = Transform::scale(DVec3::splat(0.6)).then(Transform::rotate(DVec3::X, 90.0));
    b.shape(Geometry::Rectangle, lamp.then(Transform::translate(DVec3::Y * 2.5)), black).emission =
        Some(glow);
    let world = b.build();
    let exact = channel_means(&world, &volpath(None), 1024, 0..8);
    let mapper = PhotonMapperConfig { emit: Some(40_000), ..PhotonMapperConfig::default() };
    for (first, contestant) in (1..).map(|i| 100 * i).zip(every_method_but(&["path", "auto"], &mapper)) {
        if !contestant.behind_glass {
            continue;
        }
        let found = channel_means(&world, &contestant.method, 64, first..first + 8);
        for channel in 0..3 {
            let of = |means: &[[f64; 3]]| means.iter().map(|m| m[channel]).collect::<Vec<f64>>();
            let bias = if contestant.blurs { 0.02 } else { 0.0 };
            let [found, exact] = [of(&found), of(&exact)];
            let exact: MeanTest = forgiving(&found, &exact, bias).into_iter().collect();
            let outcome = found.into_iter().collect::<MeanTest>().welch(&exact);
            let name = contestant.method.name();
            assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}, channel {channel}: {outcome}");
        }
    }
    // And colours there are: a pixel somewhere is twice as red as blue, or the other way round.
    let image = render(&world, volpath(None), 256, 1);
    let ratio = |p: &Rgb| if p.b > 0.0 { f64::from(p.r / p.b) } else { 1.0 };
    let most = image.pixels.iter().map(ratio).fold(1.0, |most: f64, r| most.max(r).max(1.0 / r));
    assert!(most > 1.5, "{most}");
}
