//! A walk from the lamp and one from the camera over the same vertices: with what density one comes to a vertex is what the
//! other says of the reverse, and is the density of the direction times the cosine or the extinction, over distance².

use super::densities::{Kind, Node, Place, Trail};
use crate::math::{Vec3, warp};
use crate::sampling::{Key, Sampler, Sequence, Stream};

/// Of directions that graze surfaces, the cosines of which are rounded as the directions are.
const ROUNDING: f32 = 2e-3;

fn sampler(path: u64) -> Sampler {
    Sampler::new(Sequence::Independent, Key::new(8, 0, Stream::Pilot), path)
}

fn direction(sampler: &mut Sampler) -> Vec3 {
    warp::square_to_sphere(sampler.next_2d())
}

fn position(sampler: &mut Sampler) -> Vec3 {
    let (xy, z) = (sampler.next_2d(), sampler.next_1d());
    10.0 * (Vec3::new(xy.x, xy.y, z) - 0.5)
}

fn vertex(sampler: &mut Sampler) -> (Place, Kind) {
    let position = position(sampler);
    match sampler.next_1d() {
        u if u < 0.4 => (Place::Surface { position, ng: direction(sampler) }, Kind::Surface),
        u if u < 0.6 => (Place::Surface { position, ng: direction(sampler) }, Kind::Specular),
        u => (Place::Medium { position, sigma_t: 3.0 * u }, Kind::Medium),
    }
}

/// Of an area, a point, or something infinitely far away.
fn lamp(sampler: &mut Sampler) -> Place {
    match sampler.next_1d() {
        u if u < 0.4 => Place::Surface { position: position(sampler), ng: direction(sampler) },
        u if u < 0.7 => Place::Point { position: position(sampler) },
        _ => Place::Distant { direction: direction(sampler) },
    }
}

/// The density at `to` of a direction from `from` with this density, by the book.
fn arrival(from: &Place, to: &Place, density: f32) -> f32 {
    let way = match (from, to) {
        (Place::Distant { direction }, _) => -*direction,
        (_, Place::Distant { .. }) => return density,
        _ => to.position().expect("a place") - from.position().expect("a place"),
    };
    let distance_sq = if matches!(from, Place::Distant { .. }) { 1.0 } else { way.length_squared() };
    let facing = match to {
        Place::Surface { ng, .. } => ng.dot(way.normalize()).abs(),
        Place::Medium { sigma_t, .. } => *sigma_t,
        Place::Point { .. } | Place::Distant { .. } => 1.0,
    };
    density * facing / distance_sq
}

/// Both walks over a path, which turn at every vertex.
struct Both {
    places: Vec<Place>,
    /// Densities of directions from each vertex to the next and to the one before.
    onward: Vec<f32>,
    backward: Vec<f32>,
    light: Trail,
    camera: Trail,
}

fn walked(number: u64) -> Both {
    let mut s = sampler(number);
    let count = 3 + (s.next_1d() * 6.0) as usize;
    let mut places = vec![lamp(&mut s)];
    let mut kinds = vec![Kind::Lamp { dirac: false }];
    for _ in 1..count {
        let (place, kind) = vertex(&mut s);
        places.push(place);
        kinds.push(kind);
    }
    let mut densities = |i: usize| if kinds[i] == Kind::Specular { 1.0 } else { 0.1 + 5.0 * s.next_1d() };
    let onward: Vec<f32> = (0..count).map(&mut densities).collect();
    let backward: Vec<f32> = (0..count).map(&mut densities).collect();
    let mut light = Trail::new();
    light.begin(places[0], onward[0]);
    light.nodes.push(Node { arrival: 0.5, counter: 0.0, kind: kinds[0], far: true });
    for i in 1..count {
        light.arrive(places[i], kinds[i]);
        light.turn(onward[i], backward[i]);
    }
    let mut camera = Trail::new();
    camera.begin(Place::Point { position: position(&mut s) }, 0.0);
    for i in (1..count).rev() {
        camera.arrive(places[i], kinds[i]);
        camera.turn(backward[i], onward[i]);
    }
    Both { places, onward, backward, light, camera }
}

fn is_close(a: f32, b: f32) -> bool {
    (a - b).abs() <= ROUNDING * a.abs().max(b.abs())
}

#[test]
fn what_one_walk_finds_the_other_says_of_the_reverse() {
    for number in 0..2_000 {
        let Both { places, onward, backward, light, camera } = walked(number);
        let count = places.len();
        for i in 1..count {
            let from_light = light.nodes[i];
            let from_camera = camera.nodes[count - 1 - i];
            assert_eq!(from_light.kind, from_camera.kind);
            let exact = arrival(&places[i - 1], &places[i], onward[i - 1]);
            assert!(is_close(from_light.arrival, exact), "{number}: {} is {exact}", from_light.arrival);
            // The camera's walk learns that when it turns at the next vertex, which the lamp is none of.
            if i > 1 {
                assert!(is_close(from_camera.counter, exact), "{number}: {} is {exact}", from_camera.counter);
            }
            // The first that it comes to is the lens's business.
            if i + 1 < count {
                let exact = arrival(&places[i + 1], &places[i], backward[i + 1]);
                assert!(is_close(from_camera.arrival, exact), "{number}: {} is {exact}", from_camera.arrival);
                assert!(is_close(from_light.counter, exact), "{number}: {} is {exact}", from_light.counter);
            }
        }
        let exact = arrival(&places[1], &places[0], backward[1]);
        assert!(is_close(light.nodes[0].counter, exact), "{number}: the lamp's {}", light.nodes[0].counter);
    }
}

/// Where the two walks meet, either tells what the other one has from there.
#[test]
fn two_walks_are_joined_by_the_densities_of_both() {
    for number in 0..2_000 {
        let Both { places, onward, backward, light, camera } = walked(number);
        let last = places.len() - 1;
        let [there, here] = camera.at.between(&places[0]);
        assert!(is_close(backward[1] * there, arrival(&places[1], &places[0], backward[1])));
        assert!(is_close(onward[0] * here, light.nodes[1].arrival));
        assert!(is_close(
            backward[last] * light.back,
            arrival(&places[last], &places[last - 1], backward[last])
        ));
    }
}

#[test]
fn two_vertices_in_one_place_have_no_density() {
    let place = Place::Surface { position: Vec3::ONE, ng: Vec3::X };
    assert_eq!(place.between(&Place::Medium { position: Vec3::ONE, sigma_t: 1.0 }), [0.0; 2]);
}
