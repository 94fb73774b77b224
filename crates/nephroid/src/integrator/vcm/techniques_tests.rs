//! What a path from the camera takes for its own where photons are merged with it, against what weights count with.

use super::camera_paths::Walk;
use super::densities::{Kind, Place, Trail};
use super::reach::Reach;
use super::techniques::up_to_photon;
use crate::color::Rgb;
use crate::math::{Ray, Vec3};
use crate::world::Surroundings;

/// A walk over so many surfaces, the last of which is far from the one before or not.
fn walk(surfaces: u32, far: bool) -> Walk {
    let mut trail = Trail::new();
    trail.begin(Place::Point { position: Vec3::ZERO }, 0.0);
    for i in 1..=surfaces {
        let position = Vec3::new(0.0, 0.0, i as f32);
        trail.arrive(Place::Surface { position, ng: Vec3::Z }, Kind::Surface);
        trail.turn(0.5, f32::NAN);
    }
    // Others are as the last one is not.
    let count = trail.nodes.len();
    for (i, node) in trail.nodes.iter_mut().enumerate() {
        node.far = far == (i + 1 == count);
    }
    Walk {
        ray: Ray::new(Vec3::ZERO, Vec3::Z),
        inside: Surroundings::default(),
        entered: false,
        throughput: Rgb::WHITE,
        depth: surfaces,
        scattered: surfaces,
        collisions: 0,
        specular: false,
        trail,
        length: 1.0,
        at_first: 0.3,
        partner: 0,
    }
}

/// A path merges where, and as far as, all techniques' weights take it to merge: else it is counted twice or not at all.
#[test]
fn paths_merge_where_weights_say_so() {
    let reach = Reach { radius: 0.1, paths: 50.0 };
    for surfaces in 1..4 {
        for far in [true, false] {
            let walk = walk(surfaces, far);
            // Vertices are counted from the lamp: a path of six, of which the first is the last but for the lens.
            let (first, m) = (5, 6 - surfaces as usize);
            let weighed = reach.area_at(Kind::Surface, m, first, walk.at_first, far);
            let merged = f64::from(reach.area(walk.merging_radius(&reach)));
            assert_eq!(merged, weighed, "{surfaces}, far: {far}");
        }
    }
    assert_eq!(walk(1, false).merging_radius(&reach), 0.3);
    assert_eq!(walk(2, true).merging_radius(&reach), 0.1);
    assert_eq!(walk(2, false).merging_radius(&reach), 0.0);
}

/// Photons come from different directions, so that each has a density of its own to the vertex before; what the photon
/// before it left there, or a connection, is none of its business.
#[test]
fn every_photon_brings_its_own_density_to_the_vertex_before() {
    let mut trail = walk(3, true).trail;
    let arrivals: Vec<f32> = trail.nodes.iter().map(|node| node.arrival).collect();
    trail.nodes[1].counter = 77.0;
    trail.back = 4.0;
    for onward in [0.25, 0.5, 0.0] {
        let (arrival, before) = up_to_photon(&mut trail, onward).unwrap();
        assert_eq!((arrival, before.len()), (arrivals[2], 2));
        assert_eq!(before[1].counter, 4.0 * onward);
        assert_eq!(before.iter().map(|node| node.arrival).collect::<Vec<_>>(), arrivals[..2]);
    }
    let mut first = walk(1, true).trail;
    assert!(up_to_photon(&mut first, 1.0).is_some_and(|(_, before)| before.is_empty()));
    assert!(up_to_photon(&mut Trail::new(), 1.0).is_none());
}
