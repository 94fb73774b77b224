//! Journeys through media against closed forms and quadrature. The tests of hypotheses share the level
//! `ALPHA` by Šidák's formula: on seeds chosen afresh, correct code would fail with probability 1 %.

use nephroid_testkit::{ALPHA, MeanTest, Outcome, Tolerance, binomial_test, integrate, sidak};

use super::testing::{Case, grey, patchy, sampler, transforms};
use super::{Coefficient, Grid, Matter, Media, Medium, Passage, Phase};
use crate::color::Rgb;
use crate::handle::Arena;
use crate::math::{DVec3, Ray, Transform, Vec3};

/// More than the tests of hypotheses in this file.
const TESTS: usize = 400;

/// Rounding of weights in single precision, which constant samples show.
const ROUNDING: f64 = 3e-6;

#[track_caller]
fn judge(name: &str, outcome: &Outcome) {
    assert!(outcome.passes(sidak(ALPHA, TESTS)), "{name}: {outcome}");
}

fn uniform(sigma_t: Rgb) -> Matter {
    let medium = Medium::homogeneous("fog", sigma_t, Rgb::WHITE, Phase::Isotropic);
    Matter::new(&medium, &Arena::default())
}

fn along_x() -> Ray {
    Ray::new(Vec3::new(0.0, 0.5, 0.5), Vec3::X)
}

/// Checks that journeys keep what is carried, and that every channel that carries something collides and comes
/// through as often, and collides as far away, as in `expected`: 1 − T(t_max) and ∫ t σ T dt.
#[track_caller]
fn travels(
    name: &str,
    matter: &Matter,
    (ray, t_max): (&Ray, f32),
    carried: Rgb,
    (collide, moment): ([f64; 3], [f64; 3]),
    count: u64,
) {
    let mut collided = [MeanTest::new(); 3];
    let mut through = [MeanTest::new(); 3];
    let mut moments = [MeanTest::new(); 3];
    for i in 0..count {
        let (t, weight, collides) = match matter.travel(ray, t_max, carried, &mut sampler(i)) {
            Passage::Collision { t, weight } => {
                assert!(t >= 0.0 && t < t_max, "{name}: {t}");
                (t, weight, 1.0)
            }
            Passage::Through { weight } => (0.0, weight, 0.0),
        };
        assert!(weight.is_finite() && weight.min_channel() >= 0.0, "{name}: {weight:?}");
        let kept = (carried * weight).sum() / carried.sum();
        assert!((kept - 1.0).abs() < 2e-5, "{name}: {kept} of what was carried");
        for (channel, w) in weight.to_array().map(f64::from).into_iter().enumerate() {
            collided[channel].push(w * collides);
            through[channel].push(w * (1.0 - collides));
            moments[channel].push(w * collides * f64::from(t));
        }
    }
    for channel in (0..3).filter(|&channel| carried[channel] > 0.0) {
        let name = |what: &str| format!("{name}, {what} in channel {channel}");
        judge(&name("collisions"), &collided[channel].within(collide[channel], ROUNDING));
        judge(&name("the rest"), &through[channel].within(1.0 - collide[channel], ROUNDING));
        judge(&name("distances"), &moments[channel].within(moment[channel], ROUNDING));
    }
}

#[test]
fn of_a_slab_of_depth_one_63_per_cent_collide() {
    // If the chance of an interaction were rolled again after its distance was, it would be 20 %.
    let share = -libm::expm1(-1.0);
    assert!((share - 0.632121).abs() < 1e-6);
    let slabs = [
        ("uniform", uniform(Rgb::WHITE)),
        ("a cell", Case::new(grey([1; 3], vec![1.0]), Transform::IDENTITY).matter),
    ];
    for (name, matter) in slabs {
        let n = 100_000;
        let mut collisions = 0;
        for i in 0..n {
            match matter.travel(&along_x(), 1.0, Rgb::new(0.2, 0.5, 0.3), &mut sampler(i)) {
                Passage::Collision { weight, .. } => {
                    assert_eq!(weight, Rgb::WHITE);
                    collisions += 1;
                }
                Passage::Through { weight } => assert_eq!(weight, Rgb::WHITE),
            }
        }
        judge(name, &binomial_test(collisions, n, share));
    }
}

/// ∫ t σ e^(−σt) up to `t_max`.
fn moment(sigma: f64, t_max: f64) -> f64 {
    if sigma == 0.0 { 0.0 } else { (1.0 - libm::exp(-sigma * t_max) * (1.0 + sigma * t_max)) / sigma }
}

#[test]
fn uniform_media_are_right_in_every_channel() {
    let sigmas = [Rgb::new(0.3, 1.0, 2.5), Rgb::new(0.0, 1.5, 0.2), Rgb::splat(0.7), Rgb::new(0.0, 0.0, 2.0)];
    let carries = [Rgb::WHITE, Rgb::new(5.0, 1.0, 0.2), Rgb::new(0.0, 2.0, 1.0), Rgb::new(0.0, 0.0, 1e-6)];
    for sigma_t in sigmas {
        for carried in carries {
            let sigma = sigma_t.to_array().map(f64::from);
            let expected =
                (sigma.map(|s| -libm::expm1(-s * 0.8)), sigma.map(|s| moment(s, f64::from(0.8f32))));
            let name = format!("{sigma_t:?} for {carried:?}");
            travels(&name, &uniform(sigma_t), (&along_x(), 0.8), carried, expected, 30_000);
        }
    }
    // All of it collides on a way without an end, but not in a channel where nothing stops it.
    let expected = ([1.0, 1.0, 0.0], [2.0, 0.5, 0.0]);
    let matter = uniform(Rgb::new(0.5, 2.0, 0.0));
    travels("without end", &matter, (&along_x(), f32::INFINITY), Rgb::WHITE, expected, 100_000);
}

#[test]
fn where_nothing_is_light_comes_through() {
    let empty = Case::new(grey([3, 2, 1], vec![0.0; 6]), Transform::IDENTITY).matter;
    let through = Passage::Through { weight: Rgb::WHITE };
    for matter in [&empty, &uniform(Rgb::BLACK)] {
        for t_max in [0.5, f32::INFINITY] {
            for carried in [Rgb::WHITE, Rgb::BLACK, Rgb::new(0.0, 1.0, 0.0)] {
                assert_eq!(matter.travel(&along_x(), t_max, carried, &mut sampler(1)), through);
            }
            assert_eq!(matter.transmittance(&along_x(), t_max, &mut sampler(1)), Rgb::WHITE);
            assert_eq!(matter.profile(&along_x(), t_max).transmittance(9.0), Rgb::WHITE);
        }
    }
    let case = Case::new(patchy(1, [4; 3], 1.0), Transform::IDENTITY);
    let outside = Vec3::new(0.5, 0.5, -0.1);
    for direction in [-Vec3::Z, Vec3::X, Vec3::new(0.8, 0.0, -0.6)] {
        let ray = Ray::new(outside, direction);
        assert_eq!(case.matter.travel(&ray, f32::INFINITY, Rgb::WHITE, &mut sampler(1)), through);
        assert_eq!(case.matter.transmittance(&ray, f32::INFINITY, &mut sampler(1)), Rgb::WHITE);
    }
    // Up to the grid and no further.
    assert_eq!(case.matter.travel(&Ray::new(outside, Vec3::Z), 0.1, Rgb::WHITE, &mut sampler(1)), through);
}

#[test]
fn nothing_carried_and_extreme_numbers_give_numbers() {
    let cloud = Case::new(patchy(1, [4; 3], 0.5), Transform::IDENTITY).matter;
    let thin = uniform(Rgb::new(f32::MIN_POSITIVE, 1e-45, 0.0));
    let thick = uniform(Rgb::new(1e30, 1.0, 1e-30));
    for matter in [&cloud, &thin, &thick, &uniform(Rgb::splat(f32::MAX))] {
        for carried in [Rgb::BLACK, Rgb::new(1e-45, 0.0, 1e38), Rgb::new(1.0, 0.0, 0.0), Rgb::splat(f32::MAX)]
        {
            for (i, t_max) in [1.0, f32::INFINITY, 1e-30].into_iter().cycle().take(300).enumerate() {
                let passage = matter.travel(&along_x(), t_max, carried, &mut sampler(i as u64));
                let (Passage::Collision { weight, .. } | Passage::Through { weight }) = passage;
                assert!(weight.is_finite(), "{passage:?}");
                assert!((weight * carried).is_finite() || carried.max_channel() > 1e37, "{passage:?}");
            }
        }
    }
}

#[test]
fn grids_are_right_in_every_channel_however_they_are_placed() {
    let carries = [Rgb::WHITE, Rgb::new(3.0, 0.1, 1.0), Rgb::new(0.0, 1.0, 0.3)];
    let sizes = [[9, 7, 5], [1, 1, 1], [5, 1, 2]];
    for (seed, size) in (1..).zip(sizes) {
        for (to_world, carried) in transforms().into_iter().zip(carries) {
            let case = Case::new(patchy(seed, size, 0.7), to_world);
            for (back, t_max) in [(3.0, f32::INFINITY), (0.0, 0.7)] {
                let ray = case.ray(Vec3::new(0.4, 0.55, 0.3), Vec3::new(1.0, 0.35, 0.5), back);
                let end = f64::from(t_max.min(9.0));
                let collide = case.depth(&ray, end).map(|depth| -libm::expm1(-depth));
                // ∫ t σ T dt by parts.
                let profile = case.matter.profile(&ray, t_max);
                let moment = std::array::from_fn(|channel| {
                    let f = |t: f64| f64::from(profile.transmittance(t as f32)[channel]);
                    let area = integrate(f, &[0.0, end], Tolerance::relative(1e-5)).value;
                    area - end * (1.0 - collide[channel])
                });
                let name = format!("{size:?} from {back} for {carried:?}");
                travels(&name, &case.matter, (&ray, t_max), carried, (collide, moment), 20_000);

                let mut through = [MeanTest::new(); 3];
                for i in 0..20_000 {
                    let estimate = case.matter.transmittance(&ray, t_max, &mut sampler(i));
                    for (mean, value) in through.iter_mut().zip(estimate.to_array()) {
                        mean.push(f64::from(value));
                    }
                }
                for (mean, collide) in through.iter().zip(collide) {
                    judge(&name, &mean.within(1.0 - collide, ROUNDING));
                }
            }
        }
    }
}

#[test]
fn a_ramp_and_a_thick_cloud_let_through_what_they_must() {
    // σ = 4x but for half a cell at both ends, whose errors cancel: depth 2.
    let n = 128;
    let values: Vec<f32> = (0..n).map(|i| 4.0 * (i as f32 + 0.5) / n as f32).collect();
    let thick = values.iter().map(|v| 3.0 * v).collect();
    let placed = Transform::scale(DVec3::new(1.0, 50.0, 50.0));
    for (name, values, depth) in [("a ramp", values, 2.0), ("a thick ramp", thick, 6.0)] {
        let case = Case::new(grey([n, 1, 1], values), placed);
        let ray = Ray::new(Vec3::new(2.0, 20.0, 20.0), -Vec3::X);
        let (mut transmittance, mut distance, mut through) = (MeanTest::new(), MeanTest::new(), 0);
        let count = 100_000;
        for i in 0..count {
            transmittance.push(f64::from(case.matter.transmittance(&ray, 10.0, &mut sampler(i)).g));
            let passage = case.matter.travel(&ray, 10.0, Rgb::WHITE, &mut sampler(count + i));
            through += u64::from(passage == Passage::Through { weight: Rgb::WHITE });
            distance.push(if let Passage::Collision { t, .. } = passage { f64::from(t) - 1.0 } else { 0.0 });
        }
        judge(name, &transmittance.against(libm::exp(-depth)));
        judge(name, &binomial_test(through, count, libm::exp(-depth)));
        // ∫ t σ T dt by parts, from the high end of the ramp.
        let transmittance = |t: f64| libm::exp(-depth * t * (2.0 - t));
        let area = integrate(transmittance, &[0.0, 1.0], Tolerance::relative(1e-6)).value;
        judge(name, &distance.within(area - libm::exp(-depth), 1e-4));
    }
}

#[test]
fn a_half_space_reflects_as_chandrasekhar_says() {
    let matter = uniform(Rgb::splat(0.7));
    let albedo = Rgb::new(0.5, 0.9, 0.0);
    let mut reflected = [MeanTest::new(); 2];
    for i in 0..30_000 {
        let mut sampler = sampler(i);
        let (mut ray, mut power) = (Ray::new(Vec3::ZERO, -Vec3::Z), Rgb::WHITE);
        // What is left after this many is below 1e-6.
        for _ in 0..140 {
            let out = if ray.direction.z > 0.0 { -ray.origin.z / ray.direction.z } else { f32::INFINITY };
            let Passage::Collision { t, weight } = matter.travel(&ray, out, power, &mut sampler) else {
                for (mean, power) in reflected.iter_mut().zip(power.to_array()) {
                    mean.push(f64::from(power));
                }
                break;
            };
            power = power * weight * albedo;
            let scattered = matter.phase().sample(-ray.direction, sampler.next_2d());
            ray = Ray::new(ray.at(t), scattered.wi);
        }
        for mean in reflected.iter_mut().filter(|mean| mean.count() <= i) {
            mean.push(0.0);
        }
    }
    for (mean, (h, albedo)) in reflected.iter().zip([(1.2513, 0.5f64), (1.8501, 0.9)]) {
        let expected = 1.0 - h * (1.0 - albedo).sqrt();
        judge("a half-space", &mean.within(expected, 5e-4));
    }
}

#[test]
fn scaled_by_a_power_of_two_light_goes_the_same_way() {
    let factor = 4096.0;
    let grid = patchy(8, [6, 3, 9], 0.6);
    let thin = Grid { values: grid.values.scaled(1.0 / factor), ..grid.clone() };
    let place = transforms()[2];
    let small = Case::new(grid, place);
    let large = Case::new(thin, place.then(Transform::scale(DVec3::splat(f64::from(factor)))));
    let ray = small.ray(Vec3::splat(0.4), Vec3::new(1.0, 0.2, -0.3), 2.0);
    let far = Ray::new(ray.origin * factor, ray.direction);
    let (mut collisions, carried) = (0, Rgb::new(1.0, 2.0, 0.5));
    for i in 0..200 {
        let mut passage = small.matter.travel(&ray, 4.0, carried, &mut sampler(i));
        if let Passage::Collision { t, .. } = &mut passage {
            *t *= factor;
            collisions += 1;
        }
        assert_eq!(large.matter.travel(&far, 4.0 * factor, carried, &mut sampler(i)), passage);
        let transmittance =
            |case: &Case, ray: &Ray, t: f32| case.matter.transmittance(ray, t, &mut sampler(i));
        assert_eq!(transmittance(&small, &ray, 4.0), transmittance(&large, &far, 4.0 * factor));
    }
    assert!((20..180).contains(&collisions));
    let (near, far) = (small.matter.profile(&ray, 4.0), large.matter.profile(&far, 4.0 * factor));
    assert_eq!(near.transmittance(2.1), far.transmittance(2.1 * factor));
}

#[test]
fn an_extinction_ends_with_its_grid_and_the_rest_goes_on() {
    let mut media = Media::default();
    let grid = media.grids.push(grey([2, 1, 1], vec![0.25, 0.5]));
    let placed = |scale| Coefficient::Grid { grid, to_world: Transform::scale(DVec3::splat(2.0)), scale };
    let medium = Medium {
        sigma_t: placed(4.0),
        albedo: placed(1.0),
        emission: placed(2.0),
        ambient: Rgb::new(1.0, 2.0, 3.0),
        ..Medium::homogeneous("fire", Rgb::BLACK, Rgb::BLACK, Phase::Rayleigh)
    };
    let matter = Matter::new(&medium, &media.grids);
    let (inside, outside) = (Vec3::new(1.9, 1.0, 1.0), Vec3::new(2.1, 1.0, 1.0));
    assert_eq!((matter.sigma_t(inside), matter.sigma_t(outside)), (Rgb::splat(2.0), Rgb::BLACK));
    assert_eq!((matter.albedo(inside), matter.albedo(outside)), (Rgb::splat(0.5), Rgb::splat(0.5)));
    assert_eq!((matter.emission(inside), matter.emission(outside)), (Rgb::WHITE, Rgb::WHITE));
    assert_eq!(matter.uniform_extinction(), None);
    assert!(matter.emits() && matter.phase() == Phase::Rayleigh && matter.ambient() == medium.ambient);
    let clear = uniform(Rgb::new(1.0, 2.0, 3.0));
    assert_eq!(clear.uniform_extinction(), Some(Rgb::new(1.0, 2.0, 3.0)));
    assert!(!clear.emits());
}
