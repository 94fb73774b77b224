use nephroid_testkit::Pcg32;

use super::testing::{Case, grey, patchy, transforms};
use super::{Matter, Medium, Phase, Profile};
use crate::color::Rgb;
use crate::handle::Arena;
use crate::math::{Ray, Transform, Vec3};

fn depth(profile: &Profile, t: f32) -> [f64; 3] {
    profile.transmittance(t).to_array().map(|through| -libm::log(f64::from(through)))
}

#[test]
fn the_depth_is_that_of_quadrature_at_any_point() {
    let mut rng = Pcg32::new(11);
    let mut profile = Profile::default();
    let sizes = [[5, 4, 3], [1, 1, 1], [40, 1, 1], [9, 2, 6]];
    for (seed, (size, to_world)) in
        sizes.into_iter().flat_map(|size| transforms().map(|place| (size, place))).enumerate()
    {
        let case = Case::new(patchy(seed as u64, size, 0.5), to_world);
        for i in 0..8 {
            let mut number = || rng.next_f32();
            let through = Vec3::new(number(), number(), number());
            let direction = Vec3::new(number() - 0.5, number() - 0.5, number() - 0.5);
            // From far outside and from within.
            let ray = case.ray(through, direction, if i % 2 == 0 { 5.0 } else { 0.0 });
            case.matter.profile_into(&ray, 10.0, &mut profile);
            for _ in 0..4 {
                let t = number() * 7.0;
                let expected = case.depth(&ray, f64::from(t));
                for (found, expected) in depth(&profile, t).into_iter().zip(expected) {
                    let error = (found - expected).abs();
                    assert!(error < 5e-6 * (1.0 + expected), "{size:?} {t}: {found}, not {expected}");
                }
            }
        }
    }
}

#[test]
fn beside_the_grid_nothing_is_lost() {
    let case = Case::new(patchy(3, [3; 3], 1.0), Transform::IDENTITY);
    let misses = [
        Ray::new(Vec3::new(0.5, 2.0, 0.5), Vec3::X),
        Ray::new(Vec3::new(2.0, 0.5, 0.5), Vec3::X),
        Ray::new(Vec3::new(-9.0, 0.5, 0.5), Vec3::new(0.6, 0.8, 0.0)),
    ];
    for ray in misses {
        assert_eq!(case.matter.profile(&ray, f32::INFINITY).transmittance(100.0), Rgb::WHITE);
    }
    let ray = Ray::new(Vec3::new(-2.0, 0.5, 0.5), Vec3::X);
    let profile = case.matter.profile(&ray, f32::INFINITY);
    assert_eq!(profile.transmittance(1.999), Rgb::WHITE);
    assert!(profile.transmittance(2.1).max_channel() < 1.0);
    assert_eq!(profile.transmittance(3.1), profile.transmittance(f32::INFINITY));
    // Up to a surface in the grid.
    let short = case.matter.profile(&ray, 2.5);
    let difference = short.transmittance(2.4) - profile.transmittance(2.4);
    assert!(difference.map(f32::abs).max_channel() < 1e-6);
    assert_eq!(short.transmittance(2.5), short.transmittance(9.0));
}

#[test]
fn memory_is_used_again_and_nothing_else_is() {
    let case = Case::new(patchy(4, [6; 3], 0.7), Transform::IDENTITY);
    let uniform = Medium::homogeneous("fog", Rgb::new(0.0, 1.0, 2.0), Rgb::WHITE, Phase::Isotropic);
    let uniform = Matter::new(&uniform, &Arena::default());
    let rays = [Vec3::new(-1.0, 0.2, 0.3), Vec3::new(-1.0, 7.0, 0.3), Vec3::new(0.1, 0.8, 0.4)]
        .map(|origin| Ray::new(origin, Vec3::new(0.9, 0.1, 0.2).normalize()));
    let mut used = Profile::default();
    for matter in [&case.matter, &uniform, &case.matter] {
        for ray in &rays {
            matter.profile_into(ray, 4.0, &mut used);
            let fresh = matter.profile(ray, 4.0);
            for t in [0.0, 0.5, 1.0, 1.5, 4.0] {
                assert_eq!(used.transmittance(t), fresh.transmittance(t));
            }
        }
    }
    assert_eq!(uniform.profile(&rays[0], 1.0).transmittance(f32::INFINITY), Rgb::new(1.0, 0.0, 0.0));
}

#[test]
fn a_ramp_has_its_closed_form() {
    // σ = 4x between the middles, and half a cell that is level at both ends.
    let n = 128;
    let values = (0..n).map(|i| 4.0 * (i as f32 + 0.5) / n as f32).collect();
    let case = Case::new(grey([n, 1, 1], values), Transform::IDENTITY);
    let profile = case.matter.profile(&Ray::new(Vec3::new(-1.0, 0.3, 0.7), Vec3::X), f32::INFINITY);
    let level = 0.5 / f64::from(n);
    for x in [level, 0.25, 0.5, 0.777, 1.0 - level] {
        // ∫ 4x from 0, and half of 4·level² more from the level start.
        let expected = 2.0 * x * x + 2.0 * level * level;
        let found = depth(&profile, 1.0 + x as f32)[0];
        assert!((found - expected).abs() < 3e-6, "{x}: {found}, not {expected}");
    }
    assert!((depth(&profile, 2.0)[1] - 2.0).abs() < 3e-6);
}
