//! What a map keeps, how wide it makes beams, and what it costs.

use super::testing::{beam, direction, map, total, visits};
use super::{Beam, BeamMap, BeamWidth, Beams};
use crate::bvh::Simd;
use crate::color::Rgb;
use crate::math::{Frame, Ray, Vec2, Vec3, warp};
use crate::photon_map::testing::Rng;
use crate::photon_map::{Blur, Kernel};

/// Beams from all over the walls of a box of side 2 to where they leave it.
fn across_a_box(n: usize, rng: &mut Rng) -> Vec<Beam> {
    let mut one = |i: usize| {
        let axis = i % 3;
        let mut origin = rng.point() * 2.0 - 1.0;
        let mut inward = Vec3::ZERO;
        origin[axis] = if i.is_multiple_of(2) { -1.0 } else { 1.0 };
        inward[axis] = -origin[axis];
        let d = warp::square_to_cosine_hemisphere(Vec2::new(rng.next(), rng.next()));
        let d = Frame::from_normal(inward).to_world(d).normalize();
        let to_wall = |axis: usize| (d[axis].signum() - origin[axis]) / d[axis];
        beam(i, origin, d, to_wall(0).min(to_wall(1)).min(to_wall(2)).max(1e-3))
    };
    (0..n).map(&mut one).collect()
}

fn scaled(beams: &[Beam], scale: f32) -> Beams {
    let scaled = |b: &Beam| Beam { origin: b.origin * scale, length: b.length * scale, ..*b };
    Beams::new(1, beams.iter().map(scaled).collect())
}

#[test]
fn power_is_divided_by_the_paths_emitted() {
    let one = beam(3, Vec3::X, Vec3::Y, 2.0);
    let mut beams = Beams::new(6, vec![one; 3]);
    beams.append(Beams::new(2, vec![one]));
    assert_eq!((beams.emitted(), beams.stored(), beams.as_slice().len()), (8, 4, 4));
    let map = BeamMap::build(beams, BeamWidth::Fixed { radius: 0.5 });
    assert_eq!(map.beam(2), Beam { power: Rgb::splat(0.125), ..one });
    assert_eq!((map.len(), map.emitted(), map.radius()), (4, 8, 0.5));
    let mut found = 0;
    map.along(&Ray::new(Vec3::Y, Vec3::Z), 1.0, 0, Kernel::Box, |_, _, _, _| found += 1);
    assert_eq!(found, 0, "nearest points lie beside the ray's start");
    map.along(&Ray::new(Vec3::new(1.0, 1.0, -0.5), Vec3::Z), 1.0, 0, Kernel::Box, |t, s, beam, weight| {
        assert_eq!((t, s, weight, beam.power), (0.5, 1.0, 1.0, Rgb::splat(0.125)));
        found += 1;
    });
    assert_eq!(found, 4);
}

#[test]
fn nothing_is_found_where_nothing_can_be() {
    let one = beam(0, Vec3::ZERO, Vec3::X, 1.0);
    let ray = Ray::new(Vec3::new(0.5, 0.0, -1.0), Vec3::Z);
    let found =
        |map: &BeamMap, ray: &Ray, t_max| visits(map, Simd::detect(), ray, t_max, 0, Kernel::Box).len();
    assert_eq!(found(&map(vec![one], 0.1), &ray, 2.0), 1);
    for t_max in [0.0, -1.0, f32::NAN, 0.9] {
        assert_eq!(found(&map(vec![one], 0.1), &ray, t_max), 0);
    }
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(found(&map(vec![one], radius), &ray, 2.0), 0);
    }
    let broken = Ray::new(ray.origin, Vec3::NAN);
    assert_eq!(found(&map(vec![one], 0.1), &broken, 2.0), 0);
    let odd = [
        Beam { length: 0.0, ..one },
        Beam { length: -1.0, ..one },
        Beam { length: f32::INFINITY, ..one },
        Beam { length: f32::NAN, ..one },
        Beam { direction: Vec3::ZERO, ..one },
        Beam { origin: Vec3::NAN, ..one },
    ];
    assert_eq!(found(&map(odd.to_vec(), 0.1), &ray, 2.0), 0);
    assert_eq!(found(&map([odd.as_slice(), &[one]].concat(), 0.1), &ray, 2.0), 1);
    let nothing = BeamMap::build(Beams::default(), BeamWidth::Crossing { k: 10.0 });
    assert!(nothing.is_empty() && nothing.radius() == 0.0 && found(&nothing, &ray, 2.0) == 0);
}

#[test]
fn media_do_not_mix() {
    let mut rng = Rng::new(1);
    let beams = across_a_box(500, &mut rng);
    let medium = |i: usize| (i % 3) as u16;
    let mixed = beams.iter().enumerate().map(|(i, b)| Beam { medium: medium(i), ..*b }).collect();
    let (mixed, alone) = (map(mixed, 0.1), map(beams, 0.1));
    let mut some = [0; 4];
    for _ in 0..100 {
        let ray = Ray::new(rng.point() - 0.5, direction(&mut rng));
        let all = visits(&alone, Simd::detect(), &ray, 1.0, 0, Kernel::Biweight);
        for number in 0..4 {
            let of_medium = visits(&mixed, Simd::detect(), &ray, 1.0, number, Kernel::Biweight);
            assert!(of_medium.iter().eq(all.iter().filter(|visit| medium(visit.0) == number)));
            some[usize::from(number)] += of_medium.len();
        }
    }
    assert!(some[..3].iter().all(|&n| n > 100) && some[3] == 0);
}

#[test]
fn memory_is_at_most_three_hundred_bytes_a_beam() {
    let mut rng = Rng::new(2);
    let across = across_a_box(20_000, &mut rng);
    let short: Vec<_> = across.iter().map(|b| Beam { length: b.length * 0.01, ..*b }).collect();
    let uneven: Vec<_> =
        across.iter().enumerate().map(|(i, b)| if i.is_multiple_of(10) { *b } else { short[i] }).collect();
    let bundle: Vec<_> =
        across.iter().map(|b| Beam { direction: Vec3::ONE.normalize(), length: 2.0, ..*b }).collect();
    for (name, beams) in [("across", across), ("short", short), ("uneven", uneven), ("bundle", bundle)] {
        for k in [10.0, 300.0] {
            let map = BeamMap::build(Beams::new(1, beams.clone()), BeamWidth::Crossing { k });
            let bytes = map.memory_bytes() as f64 / 20_000.0;
            assert!(bytes <= 300.0, "{name}, {k}: {bytes} bytes a beam");
        }
    }
}

/// Lines with uniform directions through uniform places across them: those that meet the box are as good as
/// each other.
fn lines(n: usize, rng: &mut Rng) -> Vec<Ray> {
    let mut out = Vec::new();
    while out.len() < n {
        let frame = Frame::from_normal(direction(rng));
        let across = Vec3::new(rng.next() - 0.5, rng.next() - 0.5, 0.0) * 4.0;
        let ray = Ray::new(frame.to_world(across - Vec3::Z * 3.0), frame.n);
        let meets = {
            let (one, other) = ((-1.0 - ray.origin) / ray.direction, (1.0 - ray.origin) / ray.direction);
            one.min(other).max_element() < one.max(other).min_element()
        };
        if meets {
            out.push(ray);
        }
    }
    out
}

#[test]
fn rays_cross_about_as_many_beams_as_are_asked_for() {
    let mut rng = Rng::new(3);
    let beams = across_a_box(3000, &mut rng);
    for k in [5.0, 50.0] {
        let map = BeamMap::build(Beams::new(1, beams.clone()), BeamWidth::Crossing { k });
        let mut found = 0;
        for ray in lines(2000, &mut rng) {
            map.along(&ray, 6.0, 0, Kernel::Box, |_, _, _, _| found += 1);
        }
        // Some two standard deviations of 3000 beams' lengths and 2000 rays' ways.
        let mean = found as f32 / 2000.0;
        assert!((mean / k - 1.0).abs() < 0.1, "{mean} in place of {k}");
    }
}

#[test]
fn widths_and_weights_follow_the_scale() {
    let beams = across_a_box(2000, &mut Rng::new(4));
    let width = BeamWidth::Crossing { k: 20.0 };
    let radius = BeamMap::build(scaled(&beams, 1.0), width).radius();
    for scale in [1e-3, 1e6] {
        let there = BeamMap::build(scaled(&beams, scale), width).radius();
        assert!((there / scale / radius - 1.0).abs() < 1e-5, "{scale}: {there}");
    }
    // A power of two changes no bit.
    let map = BeamMap::build(scaled(&beams, 1.0), width);
    for scale in [2.0f32.powi(-10), 2.0f32.powi(20)] {
        let there = BeamMap::build(scaled(&beams, scale), width);
        assert_eq!(there.radius(), radius * scale);
        let mut rng = Rng::new(5);
        for _ in 0..100 {
            let (origin, d) = (rng.point() - 0.5, direction(&mut rng));
            let here = visits(&map, Simd::detect(), &Ray::new(origin, d), 1.0, 0, Kernel::Cone { k: 1.1 });
            let ray = Ray::new(origin * scale, d);
            let there = visits(&there, Simd::detect(), &ray, scale, 0, Kernel::Cone { k: 1.1 });
            let expected = here.iter().map(|&(i, t, s, w)| (i, t * scale, s * scale, w / scale));
            assert!(there.iter().copied().eq(expected) && !here.is_empty());
        }
    }
}

#[test]
fn a_few_beams_are_not_spread_over_the_scene() {
    for (beams, most) in [
        (vec![beam(0, Vec3::ZERO, Vec3::X, 2.0)], 0.125),
        (vec![beam(0, Vec3::ZERO, Vec3::ONE.normalize(), 2.0)], 0.125),
        (vec![beam(0, Vec3::ZERO, Vec3::X, 2.0), beam(1, Vec3::ONE, -Vec3::X, 1.0)], 0.22),
    ] {
        let map = BeamMap::build(Beams::new(1, beams), BeamWidth::Crossing { k: 50.0 });
        assert!(map.radius() > 0.0 && map.radius() <= most, "{}", map.radius());
        let ray = Ray::new(Vec3::new(0.2, 0.2, -1.0), Vec3::Z);
        assert!(total(&map, &ray, 3.0, Kernel::Box).is_finite());
    }
}

/// In a series beams narrow from the radius of the first iteration on, also where that is the largest there may be.
#[test]
fn few_beams_narrow_like_many() {
    let mut rng = Rng::new(9);
    for count in [3, 3000] {
        let beams: Vec<Beam> = (0..count).map(|i| beam(i, rng.point(), direction(&mut rng), 1.0)).collect();
        let radius = |iteration| {
            let blur = Blur::of_iteration(iteration);
            let beams = Beams::new(1, beams.clone());
            BeamMap::build_narrow(beams, BeamWidth::Crossing { k: 50.0 }, blur).radius()
        };
        let whole = BeamMap::build(Beams::new(1, beams.clone()), BeamWidth::Crossing { k: 50.0 }).radius();
        assert_eq!(radius(0), whole);
        assert!((radius(31) / whole - 0.5).abs() < 1e-6, "{count}: {} of {whole}", radius(31));
    }
}
