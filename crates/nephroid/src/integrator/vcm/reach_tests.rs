//! How near photons must lie to be merged, against what their density says.

use super::densities::Kind;
use super::reach::{Density, Reach};
use crate::math::{Vec3, warp};
use crate::photon_map::NearestList;
use crate::sampling::{Key, Sampler, Sequence, Stream};

/// So many places on a disk, and so many times the density more within a tenth of its radius.
fn places(count: usize, denser: usize) -> Vec<Vec3> {
    let mut sampler = Sampler::new(Sequence::Independent, Key::new(9, 0, Stream::Pilot), 0);
    let mut on_disk = |radius: f32| (radius * warp::square_to_disk(sampler.next_2d())).extend(0.0);
    let mut places: Vec<Vec3> = (0..count).map(|_| on_disk(1.0)).collect();
    places.extend((0..denser * count / 100).map(|_| on_disk(0.1)));
    places
}

/// The mean over places near by of the area within the radius.
fn mean_area(density: &Density, center: Vec3) -> f32 {
    let mut found = NearestList::new();
    let mut sampler = Sampler::new(Sequence::Independent, Key::new(9, 1, Stream::Pilot), 0);
    let radius = |sampler: &mut Sampler, found: &mut NearestList| {
        let point = center + (0.05 * warp::square_to_disk(sampler.next_2d())).extend(0.0);
        density.radius_at(point, found)
    };
    let sum: f32 = (0..1000).map(|_| radius(&mut sampler, &mut found).powi(2)).sum();
    std::f32::consts::PI * sum / 1000.0
}

/// With 25 times the density the area is a twenty-fifth; the eighth of a few thousand places is 2 % from where its mean is,
/// and those of a thousand points near by have much in common: a fifth is allowed.
#[test]
fn radii_follow_the_density() {
    let count = 4000;
    let density = Density::new(&places(count, 24), 4, 10.0);
    let exact = |times: f32| 4.0 * std::f32::consts::PI / (times * count as f32 * 10.0);
    let within = mean_area(&density, Vec3::ZERO);
    assert!((within / exact(25.0) - 1.0).abs() < 0.2, "{within}, not {}", exact(25.0));
    let mut found = NearestList::new();
    // Nowhere more than at the mean density.
    let most = density.typical();
    assert_eq!(density.radius_at(Vec3::new(50.0, 0.0, 0.0), &mut found), most);
}

#[test]
fn without_photons_nothing_is_near() {
    let density = Density::new(&[], 4, 10.0);
    assert_eq!(density.typical(), 0.0);
    assert_eq!(density.radius_at(Vec3::ZERO, &mut NearestList::new()), 0.0);
}

/// What lamps are asked for is not merged, nor what lies behind the first vertex and near the one before.
#[test]
fn photons_are_merged_where_a_blur_is_not_seen() {
    let reach = Reach { radius: 0.1, paths: 50.0 };
    let area = |radius: f32| f64::from(50.0 * std::f32::consts::PI * radius * radius);
    assert_eq!(reach.area_at(Kind::Surface, 1, 1, 0.3, true), 0.0);
    assert_eq!(reach.area_at(Kind::Surface, 2, 2, 0.3, false), area(0.3));
    assert_eq!(reach.area_at(Kind::Surface, 2, 3, 0.3, true), area(0.1));
    assert_eq!(reach.area_at(Kind::Surface, 2, 3, 0.3, false), 0.0);
    for kind in [Kind::Medium, Kind::Specular, Kind::Lamp { dirac: false }] {
        assert_eq!(reach.area_at(kind, 2, 2, 0.3, true), 0.0);
    }
    let nothing = Reach { paths: 0.0, ..reach };
    assert_eq!(nothing.area_at(Kind::Surface, 2, 2, 0.3, true), 0.0);
}
