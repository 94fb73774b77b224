//! `along` against every beam looked at in double precision.

use super::testing::{Pair, Visit, beam, direction, map, visits};
use super::{Beam, BeamMap};
use crate::bvh::Simd;
use crate::math::{Ray, Vec3};
use crate::photon_map::Kernel;
use crate::photon_map::testing::Rng;

/// Relative to the distances involved, how far single precision may be off.
const TOLERANCE: f64 = 4e-6;

/// Whether a beam must be found at distances shrunk by `slack`, where that is above 0, or may be where below.
fn is_found(pair: &Pair, beam: &Beam, t_max: f32, map: &BeamMap, slack: f64) -> bool {
    let (length, radius) = (f64::from(beam.length), f64::from(map.radius()));
    if pair.sin >= f64::from(map.parallel_sin()) {
        let end = slack / pair.sin;
        let on_beam = pair.s > end && pair.s < length - end;
        return on_beam && pair.t > end && pair.t < f64::from(t_max) - end && pair.distance <= radius - slack;
    }
    stretch(pair, beam, t_max, radius - slack).is_some_and(|(low, high)| high - low > slack)
}

/// Between which t the ray is in the cylinder around a beam: by bisection from the point nearest to its axis.
fn stretch(pair: &Pair, beam: &Beam, t_max: f32, radius: f64) -> Option<(f64, f64)> {
    let ends = [0.0, f64::from(beam.length)].map(|s| (s - pair.start) / pair.cos);
    let low = ends[0].min(ends[1]).max(0.0);
    let high = ends[0].max(ends[1]).min(f64::from(t_max));
    let distance = |t: f64| (pair.across.0 + pair.across.1 * t).length();
    let nearest = -pair.across.0.dot(pair.across.1) / pair.across.1.length_squared();
    let nearest = if nearest.is_nan() { low } else { nearest.clamp(low.min(high), high.max(low)) };
    if low >= high || distance(nearest) > radius {
        return None;
    }
    let edge = |mut outside: f64| {
        let mut inside = nearest;
        for _ in 0..100 {
            let middle = 0.5 * (inside + outside);
            if distance(middle) <= radius { inside = middle } else { outside = middle }
        }
        outside
    };
    Some((edge(low), edge(high)))
}

/// Compares one query with all beams; returns how many were found.
fn check(name: &str, map: &BeamMap, ray: &Ray, t_max: f32, kernel: Kernel) -> usize {
    let found = visits(map, Simd::detect(), ray, t_max, 0, kernel);
    assert_eq!(found, visits(map, Simd::Portable, ray, t_max, 0, kernel), "{name}: both ways alike");
    let mut numbers: Vec<_> = found.iter().map(|visit| visit.0).collect();
    numbers.sort_unstable();
    assert!(numbers.windows(2).all(|w| w[0] < w[1]), "{name}: each once");
    let limit = f64::from(map.parallel_sin());
    for number in 0..map.len() {
        let beam = map.beam(number);
        let pair = Pair::new(ray, &beam);
        let slack = TOLERANCE * f64::from(beam.origin.distance(ray.origin) + beam.length + map.radius());
        // Which of the two kernels it is may be in doubt, too.
        if (pair.sin / limit - 1.0).abs() < 1e-2 {
            continue;
        }
        match found.iter().find(|visit| visit.0 == number) {
            None => {
                let missed = is_found(&pair, &beam, t_max, map, slack);
                assert!(!missed, "{name}: beam {number} was missed");
            }
            Some(&visit) => {
                let near = is_found(&pair, &beam, t_max, map, -slack);
                assert!(near, "{name}: beam {number} is not near");
                check_visit(name, map, &pair, t_max, kernel, visit, slack);
            }
        }
    }
    found.len()
}

/// Whether what is said of a beam is right, but for a shift of it by `slack`.
fn check_visit(name: &str, map: &BeamMap, pair: &Pair, t_max: f32, kernel: Kernel, visit: Visit, slack: f64) {
    let (number, t, s, weight) = visit;
    let beam = map.beam(number);
    assert!(t > 0.0 && t < t_max && s > 0.0 && s < beam.length, "{name}: {t} {s}");
    let [t, s, weight, radius] = [t, s, weight, map.radius()].map(f64::from);
    let radius_sq = (radius * radius) as f32;
    let (low, high) = if pair.sin >= f64::from(map.parallel_sin()) {
        assert!((t - pair.t).abs() <= slack / pair.sin, "{name}: t = {t}, not {}", pair.t);
        assert!((s - pair.s).abs() <= slack / pair.sin, "{name}: s = {s}, not {}", pair.s);
        // Rounding of the directions counts more at small angles.
        let sin = [1.0, -1.0].map(|sign| pair.sin * (1.0 + sign * (1e-6 + 3e-7 / pair.sin)));
        let (low, high) = extremes(pair.distance, slack, radius, |d_sq| kernel.weight_1d(d_sq, radius_sq));
        (low / sin[0], high / sin[1])
    } else {
        assert!((s - pair.start - t * pair.cos).abs() <= slack, "{name}: {s}");
        let distance = (pair.across.0 + pair.across.1 * t).length();
        let (low, high) = extremes(distance, slack, radius, |d_sq| kernel.weight_2d(d_sq, radius_sq));
        let length = |radius| stretch(pair, &beam, t_max, radius).map_or(0.0, |(low, high)| high - low);
        let (from, to) = stretch(pair, &beam, t_max, radius + slack).expect("a stretch inside");
        assert!(t > from - slack && t < to + slack, "{name}: {t} is not in {from}..{to}");
        (low * (length(radius - slack) - slack), high * (length(radius + slack) + slack))
    };
    let inside = weight >= low * (1.0 - 1e-6) && weight <= high * (1.0 + 1e-6);
    assert!(inside, "{name}: beam {number} weighs {weight}, not {low}..{high}, at sin {}", pair.sin);
}

/// The least and the largest weight at distances up to `slack` from one.
fn extremes(distance: f64, slack: f64, radius: f64, weight: impl Fn(f32) -> f32) -> (f64, f64) {
    let at = |distance: f64| {
        let distance = distance.clamp(0.0, radius);
        f64::from(weight((distance * distance) as f32))
    };
    (at(distance + slack), at(distance - slack))
}

fn random(n: usize, rng: &mut Rng, length: f32) -> Vec<Beam> {
    (0..n)
        .map(|i| {
            let (origin, direction) = (rng.point() * 2.0 - 1.0, direction(rng));
            beam(i, origin, direction, length * (0.05 + rng.next()))
        })
        .collect()
}

#[test]
fn beams_found_equal_brute_force() {
    let mut rng = Rng::new(1);
    let axes = |i: usize| [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X][i % 4];
    let mut sets: Vec<(&str, Vec<Beam>, f32)> = vec![("none", vec![], 0.1)];
    for n in [1, 2, 9, 1000] {
        sets.push(("random", random(n, &mut rng, 1.0), 0.1));
    }
    sets.push(("short", random(1000, &mut rng, 0.02), 0.1));
    sets.push(("long", random(300, &mut rng, 30.0), 0.05));
    sets.push(("thin", random(1000, &mut rng, 2.0), 1e-5));
    sets.push(("wide", random(100, &mut rng, 1.0), 3.0));
    let along_axes = (0..500).map(|i| beam(i, rng.point() * 2.0 - 1.0, axes(i), rng.next() + 0.1)).collect();
    sets.push(("along axes", along_axes, 0.08));
    let same = beam(0, Vec3::splat(-0.5), Vec3::X, 1.0);
    sets.push(("all the same", (0..40).map(|i| Beam { light: i, ..same }).collect(), 0.1));
    let mixed = random(400, &mut rng, 1.0).into_iter().enumerate();
    let mixed = mixed.map(|(i, b)| Beam { length: b.length * [1e-3, 1.0, 40.0][i % 3], ..b }).collect();
    sets.push(("mixed lengths", mixed, 0.05));
    for (name, beams, radius) in sets {
        let map = map(beams.clone(), radius);
        let mut found = 0;
        for i in 0..60 {
            let origin = rng.point() * 3.0 - 1.5;
            let d = if i % 5 == 0 { axes(i / 5) } else { direction(&mut rng) };
            let t_max = [f32::INFINITY, 1.0, 0.1][i % 3];
            let kernel = [Kernel::Box, Kernel::Epanechnikov, Kernel::Cone { k: 1.1 }][i / 3 % 3];
            found += check(name, &map, &Ray::new(origin, d), t_max, kernel);
            let Some(of) = beams.get(i * 7 % beams.len().max(1)) else { continue };
            // From a point on a beam; along it, both ways, and nearly so.
            let on = of.at(of.length * rng.next());
            found += check(name, &map, &Ray::new(on, d), t_max, kernel);
            let beside = on + direction(&mut rng) * radius * 0.7;
            for turn in [0.0, 1e-7, 1e-4, 1e-3, 0.05] {
                let nearly = (of.direction + direction(&mut rng) * turn).normalize();
                found += check(name, &map, &Ray::new(beside - nearly * 0.3, nearly), t_max, kernel);
                found += check(name, &map, &Ray::new(beside + nearly * 0.3, -nearly), t_max, kernel);
            }
        }
        assert!(found > 50 || beams.is_empty(), "{name}: only {found} found");
    }
}
