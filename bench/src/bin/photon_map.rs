//! Photon look-ups beside kiddo, a well-known k-d tree, on the same photons and queries.
//!
//! `cargo run --release --manifest-path bench/Cargo.toml --bin photon_map [-- PHOTONS…]`, by default 1 000 000 and
//! 10 000 000. The photons lie evenly on the five walls and two boxes of a Cornell box, exactly in their planes;
//! queries are points of the same surfaces, "in order" as the pixels of tiles would ask for them, and
//! shuffled. Every query sums the power of the photons it finds; kiddo's lies in an array in the order of the
//! photons' pass, as a user would have it. Thousands of queries per CPU second of one thread, the median of
//! rounds in which all take turns.

use std::f32::consts::PI;
use std::hint::black_box;
use std::num::NonZero;

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nephroid::color::Rgb;
use nephroid::math::Vec3;
use nephroid::photon_map::{
    Bandwidth, Kernel, NearestList, Photon, PhotonIndex, PhotonMap, Photons, Query, gather,
};
use nephroid_bench::{cpu_time, rounds};

const ROUNDS: usize = 5;
const RADIUS_QUERIES: usize = 1 << 15;
const NEAREST_QUERIES: usize = 1 << 13;

/// Photons in a disc of the fixed radius.
const IN_DISC: f32 = 100.0;

fn main() {
    let counts: Vec<usize> = std::env::args().skip(1).filter_map(|arg| arg.parse().ok()).collect();
    for n in if counts.is_empty() { vec![1_000_000, 10_000_000] } else { counts } {
        measure(n);
    }
}

struct Random(u64);

impl Random {
    /// A number on [0, 1): 24 bits of SplitMix64.
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 40) as f32 / 16_777_216.0
    }
}

/// A rectangle: a corner and two sides.
struct Face {
    corner: Vec3,
    s: Vec3,
    t: Vec3,
}

impl Face {
    fn at(&self, s: f32, t: f32) -> Vec3 {
        self.corner + self.s * s + self.t * t
    }

    fn normal(&self) -> Vec3 {
        self.s.cross(self.t).normalize()
    }

    fn area(&self) -> f32 {
        self.s.cross(self.t).length()
    }
}

fn faces() -> Vec<Face> {
    let face = |corner, s, t| Face { corner, s, t };
    let (x, y, z) = (Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0);
    let low = -Vec3::ONE;
    let mut faces =
        vec![face(low, z, x), face(low + y, x, z), face(low, x, y), face(low, y, z), face(low + x, z, y)];
    for (corner, s, t, height) in [
        (Vec3::new(-0.6, -1.0, -0.5), Vec3::new(0.56, 0.0, -0.18), Vec3::new(0.18, 0.0, 0.56), 1.2),
        (Vec3::new(0.0, -1.0, 0.2), Vec3::new(0.56, 0.0, 0.16), Vec3::new(-0.16, 0.0, 0.56), 0.6),
    ] {
        let up = Vec3::Y * height;
        faces.extend([
            face(corner + up, t, s),
            face(corner, s, up),
            face(corner + s, t, up),
            face(corner + s + t, -s, up),
            face(corner + t, -t, up),
        ]);
    }
    faces
}

/// Every face in turn gets its share by area.
fn photons(n: usize) -> Vec<Photon> {
    let mut random = Random(1);
    let faces = faces();
    let total: f32 = faces.iter().map(Face::area).sum();
    (0..n)
        .map(|_| {
            let mut which = random.next() * total;
            let face = faces.iter().find(|f| {
                which -= f.area();
                which < 0.0
            });
            let face = face.unwrap_or(&faces[0]);
            let normal = face.normal();
            let position = face.at(random.next(), random.next());
            let power = Rgb { r: 0.5 + random.next(), g: random.next(), b: 0.2 };
            Photon { position, power, wi: normal, normal, depth: 2, light: 0 }
        })
        .collect()
}

/// Points in tiles of 32 × 32, a 512th of a wall apart.
fn queries() -> Vec<Query> {
    let faces = faces();
    let mut random = Random(2);
    (0..RADIUS_QUERIES / 1024)
        .flat_map(|tile| {
            let face = &faces[tile % faces.len()];
            let (s, t) = (random.next() * 0.9, random.next() * 0.9);
            (0..1024).map(move |i| {
                let place = |start, i: usize| start + (i as f32 + 0.5) / 512.0;
                let position = face.at(place(s, i % 32), place(t, i / 32));
                Query { position, normal: face.normal(), max_photon_depth: None }
            })
        })
        .collect()
}

fn shuffled(mut queries: Vec<Query>) -> Vec<Query> {
    let mut random = Random(3);
    for i in (1..queries.len()).rev() {
        queries.swap(i, (random.next() * (i + 1) as f32) as usize);
    }
    queries
}

fn measure(n: usize) {
    let photons = photons(n);
    let area: f32 = faces().iter().map(Face::area).sum();
    let powers: Vec<Rgb> = photons.iter().map(|p| p.power).collect();
    let points: Vec<[f32; 3]> = photons.iter().map(|p| p.position.to_array()).collect();
    let (mut tree, mut map) = (None, None);
    let theirs = cpu_time(|| tree = ImmutableKdTree::<f32, 3>::new_from_slice(&points).ok());
    drop(points);
    let photons = Photons::new(1, photons);
    let ours = cpu_time(|| map = Some(PhotonMap::build(photons)));
    let (Some(tree), Some(map)) = (tree, map) else { panic!("kiddo takes no photons") };
    let map: PhotonMap = map;
    println!(
        "{n} photons: built in {:.2} CPU s (kiddo {:.2}), {:.1} bytes a photon; covered area {:.3} of {area:.3}",
        ours.as_secs_f64(),
        theirs.as_secs_f64(),
        map.memory_bytes() as f64 / n as f64,
        map.index().covered_area(),
    );
    let radius = (IN_DISC * area / (PI * n as f32)).sqrt();
    for (order, queries) in [("in order", queries()), ("shuffled", shuffled(queries()))] {
        contest(
            &format!("{order}, radius of {IN_DISC} photons"),
            &queries,
            [&mut |q| by_radius(&map, q, radius), &mut |q| kiddo_by_radius(&tree, &powers, q, radius)],
        );
        let fewer = radius * (6.0 / IN_DISC).sqrt();
        contest(
            &format!("{order}, radius of 6 photons"),
            &queries,
            [&mut |q| by_radius(&map, q, fewer), &mut |q| kiddo_by_radius(&tree, &powers, q, fewer)],
        );
        let some = || queries.iter().copied().take(NEAREST_QUERIES).collect::<Vec<_>>();
        let mut found = NearestList::new();
        for k in [50, 200] {
            contest(
                &format!("{order}, nearest {k}"),
                &some(),
                [&mut |q| by_number(&map, q, k, &mut found), &mut |q| kiddo_by_number(&tree, &powers, q, k)],
            );
        }
        let mut found = NearestList::new();
        let mut gathered = |q: &Query, bandwidth| {
            let mut sum = Rgb::BLACK;
            gather(&map, q, Kernel::Epanechnikov, bandwidth, &mut found, |photon, weight| {
                if photon.wi.dot(q.normal) > 0.0 {
                    sum += photon.power * weight;
                }
            });
            sum
        };
        let max_radius = map.default_max_radius(50);
        for (what, bandwidth) in [
            ("radius of 100", Bandwidth::Fixed { radius }),
            ("radius of 6", Bandwidth::Fixed { radius: fewer }),
            ("nearest 50", Bandwidth::Nearest { k: 50, max_radius }),
        ] {
            let rate = rate(&queries, &mut |q| gathered(q, bandwidth));
            println!("  {order}, gather by {what}: {rate:.0}");
        }
    }
}

type Contestant<'a> = &'a mut dyn FnMut(&Query) -> Rgb;

/// Runs ours and kiddo's in turns.
fn contest(what: &str, queries: &[Query], [ours, theirs]: [Contestant; 2]) {
    let sum = |run: &mut dyn FnMut(&Query) -> Rgb| {
        let found = queries.iter().map(run).sum::<Rgb>();
        f64::from(found.r + found.g + found.b)
    };
    let (a, b) = (sum(&mut *ours), sum(&mut *theirs));
    assert!((a / b - 1.0).abs() < 2e-3, "{what}: the sums are {a} and {b}");
    let times = rounds(
        ROUNDS,
        &mut [&mut || queries.iter().for_each(|q| _ = black_box(ours(q))), &mut || {
            queries.iter().for_each(|q| _ = black_box(theirs(q)))
        }],
    );
    let rate = |seconds: f64| queries.len() as f64 / seconds / 1e3;
    println!(
        "  {what}: {:.0}, kiddo {:.0}, ratio {:.1}",
        rate(times[0]),
        rate(times[1]),
        times[1] / times[0]
    );
}

fn rate(queries: &[Query], run: Contestant) -> f64 {
    let times = rounds(ROUNDS, &mut [&mut || queries.iter().for_each(|q| _ = black_box(run(q)))]);
    queries.len() as f64 / times[0] / 1e3
}

fn by_radius(map: &PhotonMap, query: &Query, radius: f32) -> Rgb {
    map.power_within(query.position, radius)
}

fn kiddo_by_radius(tree: &ImmutableKdTree<f32, 3>, powers: &[Rgb], query: &Query, radius: f32) -> Rgb {
    let mut sum = Rgb::BLACK;
    tree.query(&query.position.to_array())
        .within::<SquaredEuclidean<f32>>(radius * radius)
        .unsorted()
        .visit(|found| sum += powers[found.item as usize]);
    sum
}

fn by_number(map: &PhotonMap, query: &Query, k: usize, found: &mut NearestList) -> Rgb {
    map.index().nearest(query.position, f32::INFINITY, k, |_, dist_sq| Some(dist_sq), found);
    found.iter().map(|neighbor| map.photon(neighbor.place).power).sum()
}

fn kiddo_by_number(tree: &ImmutableKdTree<f32, 3>, powers: &[Rgb], query: &Query, k: usize) -> Rgb {
    let found = tree
        .query(&query.position.to_array())
        .nearest_n::<SquaredEuclidean<f32>>(NonZero::new(k).unwrap_or(NonZero::<usize>::MIN))
        .execute();
    found.iter().map(|neighbor| powers[neighbor.item as usize]).sum()
}
