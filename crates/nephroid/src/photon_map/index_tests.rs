//! The tree of grids against brute force.

use super::testing::Rng;
use super::{BruteForce, GridTree, NearestList, PhotonIndex};
use crate::math::{Bounds, Vec3};

/// Point sets that have broken trees.
fn clouds() -> Vec<(&'static str, Vec<Vec3>)> {
    let mut rng = Rng::new(1);
    let mut random = |n: usize| -> Vec<Vec3> { (0..n).map(|_| rng.point()).collect() };
    let grid = |i: usize| Vec3::new((i % 12) as f32, (i / 12 % 12) as f32, (i / 144) as f32) / 11.0;
    let cluster = |(i, p): (usize, Vec3)| if i % 2 == 0 { p * 1e-4 } else { Vec3::ONE - p * 1e-3 };
    vec![
        ("nothing", vec![]),
        ("one point", random(1)),
        ("two points", random(2)),
        ("a full leaf", random(32)),
        ("a leaf and a point", random(33)),
        ("a node of leaves and a point", random(129)),
        ("a cloud", random(3000)),
        ("a plane", random(2000).into_iter().map(|p| p.with_y(0.5)).collect()),
        ("a line", random(500).into_iter().map(|p| Vec3::splat(p.x)).collect()),
        ("one place", vec![Vec3::splat(0.5); 1000]),
        ("two clusters", random(1500).into_iter().enumerate().map(cluster).collect()),
        ("a grid with every point twice", (0..2 * 1728).map(|i| grid(i % 1728)).collect()),
        ("far from the origin", random(1000).into_iter().map(|p| p + Vec3::splat(1e6)).collect()),
        (
            "both zeros",
            random(300).into_iter().map(|p| if p.x < 0.5 { -Vec3::ZERO } else { Vec3::ZERO }).collect(),
        ),
    ]
}

/// A tree and the oracle over the same points in the order of the tree.
fn tree_and_oracle(points: &[Vec3]) -> (GridTree, BruteForce) {
    let (tree, order) = GridTree::build(points.len(), |i| points[i]);
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert!((0u32..).zip(&sorted).all(|(i, &j)| i == j) && order.len() == points.len());
    let (oracle, _) = BruteForce::build(order.len(), |i| points[order[i] as usize]);
    (tree, oracle)
}

/// Points in and around the set, some of them in it.
fn queries(points: &[Vec3]) -> Vec<Vec3> {
    let mut rng = Rng::new(2);
    let bounds =
        if points.is_empty() { Bounds::of([Vec3::ZERO]) } else { Bounds::of(points.iter().copied()) };
    let around = (0..40).map(|_| bounds.center() + (rng.point() - 0.5) * 2.0 * (bounds.extent() + 1e-3));
    around.chain(points.iter().copied().step_by(points.len().div_ceil(20).max(1))).collect()
}

fn within(index: &impl PhotonIndex, center: Vec3, radius_sq: f32) -> Vec<(u32, f32)> {
    let mut found = Vec::new();
    index.for_each_within(center, radius_sq, |place, dist_sq| found.push((place, dist_sq)));
    found
}

#[test]
fn the_tree_holds_each_point_once() {
    for (name, points) in clouds() {
        let (tree, oracle) = tree_and_oracle(&points);
        assert_eq!((tree.len(), tree.bounds()), (points.len(), oracle.bounds()), "{name}");
        assert!((0..points.len() as u32).all(|i| tree.position(i) == oracle.position(i)), "{name}");
    }
}

#[test]
fn radius_queries_equal_brute_force_in_order_and_bits() {
    for (name, points) in clouds() {
        let (tree, oracle) = tree_and_oracle(&points);
        for center in queries(&points) {
            for radius_sq in [0.0, 1e-9, 1e-3, 0.05, 1.0, f32::INFINITY, -1.0, f32::NAN] {
                let expected = within(&oracle, center, radius_sq);
                assert_eq!(within(&tree, center, radius_sq), expected, "{name} {center} {radius_sq}");
            }
        }
    }
}

#[test]
fn nearest_points_equal_brute_force_in_order_and_bits() {
    let (mut ours, mut theirs) = (NearestList::new(), NearestList::new());
    for (name, points) in clouds() {
        let (tree, oracle) = tree_and_oracle(&points);
        for center in queries(&points) {
            for k in [0, 1, 2, 10, 50, 10_000] {
                for max_sq in [0.0, 1e-3, 0.05, f32::INFINITY, f32::NAN] {
                    // All; every third refused; every other one pushed away.
                    let measures: [fn(u32, f32) -> Option<f32>; 3] = [
                        |_, d| Some(d),
                        |place, d| (place % 3 != 0).then_some(d),
                        |place, d| Some(if place % 2 == 0 { d } else { d * 4.0 }),
                    ];
                    for measure in measures {
                        tree.nearest(center, max_sq, k, measure, &mut ours);
                        oracle.nearest(center, max_sq, k, measure, &mut theirs);
                        assert!(ours.iter().eq(theirs.iter()), "{name} {center} k = {k} {max_sq}");
                    }
                }
            }
        }
    }
}

#[test]
fn found_points_are_sorted_by_distance_then_place() {
    let (tree, _) = tree_and_oracle(&clouds()[11].1);
    let mut found = NearestList::new();
    tree.nearest(Vec3::splat(0.5), f32::INFINITY, 300, |_, d| Some(d), &mut found);
    assert_eq!(found.len(), 300);
    let keys: Vec<_> = found.iter().map(|n| (n.dist_sq, n.place)).collect();
    assert!(keys.windows(2).all(|w| w[0] < w[1]));
    assert!(keys.windows(2).any(|w| w[0].0 == w[1].0), "the grid has ties");
    assert_eq!(found.get(299), found.iter().last());
    assert_eq!(found.get(300), None);
}

#[test]
fn the_tree_does_not_depend_on_the_number_of_threads() {
    let mut rng = Rng::new(3);
    // Coarse coordinates, so that ties are everywhere.
    let points: Vec<_> = (0..60_000).map(|_| (rng.point() * 50.0).floor()).collect();
    let built = [1, 2, 7].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| GridTree::build(points.len(), |i| points[i]))
    });
    assert!(built[0] == built[1] && built[0] == built[2]);
}

#[test]
fn equal_points_keep_the_order_of_their_numbers() {
    // So the tree does not depend on how the standard library selects, either.
    let (_, order) = GridTree::build(5000, |_| Vec3::ONE);
    assert!(order.is_sorted());
}

#[test]
fn a_search_visits_a_small_part_of_a_large_set() {
    let mut rng = Rng::new(4);
    let points: Vec<_> = (0..100_000).map(|_| rng.point().with_z(0.0)).collect();
    let (tree, _) = tree_and_oracle(&points);
    let mut measured = 0;
    let mut found = NearestList::new();
    tree.nearest(
        Vec3::new(0.4, 0.6, 0.0),
        f32::INFINITY,
        50,
        |_, d| {
            measured += 1;
            Some(d)
        },
        &mut found,
    );
    assert!(found.len() == 50 && measured < 400, "{measured}");
}

#[test]
fn a_crowd_near_by_is_not_looked_through() {
    // 100 000 points crowd on a ten-thousandth of the area of which 10 000 have the rest; the query lies among
    // the latter, a little outside the crowd.
    let mut rng = Rng::new(5);
    let place =
        |i: usize, p: Vec3| if i.is_multiple_of(11) { p.with_z(0.0) } else { (p * 0.01 + 0.5).with_z(0.0) };
    let points: Vec<_> = (0..110_000).map(|i| place(i, rng.point())).collect();
    let (tree, oracle) = tree_and_oracle(&points);
    let (mut ours, mut theirs) = (NearestList::new(), NearestList::new());
    for x in [0.45, 0.48, 0.495, 0.499, 0.505] {
        let center = Vec3::new(x, 0.505, 0.0);
        let mut measured = 0;
        let count = |_, d| {
            measured += 1;
            Some(d)
        };
        tree.nearest(center, f32::INFINITY, 50, count, &mut ours);
        oracle.nearest(center, f32::INFINITY, 50, |_, d| Some(d), &mut theirs);
        assert!(ours.iter().eq(theirs.iter()));
        assert!(measured < 4000, "{x}: {measured}");
    }
}
