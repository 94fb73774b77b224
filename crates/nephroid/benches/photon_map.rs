//! Photons through the index: built, searched and gathered, in queries per second of one thread.
//!
//! `cargo bench -p nephroid --bench photon_map [-- PHOTONS]`. The photons lie on the walls of a box
//! and on a sphere in it; queries lie on the same surfaces, once along scan lines ("coherent") and
//! once in random order. Queries are
//! run a thousand at a time, nine times over, and the best time counts, so a busy machine matters less.
#![allow(clippy::print_stdout, reason = "it prints its results")]

use std::hint::black_box;
use std::time::Instant;

use nephroid::color::Rgb;
use nephroid::math::{Vec2, Vec3, warp};
use nephroid::photon_map::{
    Bandwidth, GridTree, Kernel, NearestList, Photon, PhotonIndex, PhotonMap, Photons, Query, gather,
};
use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng, SeedableRng};

const QUERIES: usize = 1 << 15;

fn main() {
    // The harness passes `--bench`; a number is ours.
    let n = std::env::args().skip(1).find_map(|arg| arg.parse().ok()).unwrap_or(200_000);
    let mut rng = Pcg32::seed_from_u64(1);
    let photons: Vec<_> = (0..n).map(|_| photon(uniform(&mut rng), uniform(&mut rng))).collect();

    let start = Instant::now();
    let map: PhotonMap = PhotonMap::build(Photons::new(n as u64, photons));
    println!(
        "{n} photons: built in {:.3} s, {} bytes each",
        start.elapsed().as_secs_f64(),
        map.memory_bytes() / n.max(1)
    );

    // The queries favour the floor, where photons are denser than on average.
    let radius = map.typical_radius(8);
    let max_radius = map.default_max_radius(50);
    for (order, queries) in [("coherent", scan_lines()), ("random", scattered(&mut rng))] {
        println!("{order} queries, thousands per second:");
        search(map.index(), &queries, radius, max_radius);
        for kernel in [Kernel::Box, Kernel::Epanechnikov, Kernel::Gaussian] {
            report(&format!("gather fixed, ~20 photons, {kernel}"), &queries, |query, heap| {
                flux(&map, query, kernel, Bandwidth::Fixed { radius }, heap)
            });
            report(&format!("gather nearest 50, {kernel}"), &queries, |query, heap| {
                flux(&map, query, kernel, Bandwidth::Nearest { k: 50, max_radius }, heap)
            });
        }
    }
}

fn search(tree: &GridTree, queries: &[Query], radius: f32, max_radius: f32) {
    report("within a radius, ~20 points", queries, |query, _| {
        let (mut sum, mut count) = (0.0, 0);
        tree.for_each_within(query.position, radius * radius, |_, d| {
            sum += d;
            count += 1;
        });
        (count, sum)
    });
    for k in [50, 200] {
        report(&format!("nearest {k}"), queries, |query, heap| {
            tree.nearest(query.position, f32::INFINITY, k, |_, d| Some(d), heap);
            (heap.len() as u32, heap.get(0).map_or(0.0, |n| n.dist_sq))
        });
    }
    report("nearest 50 up to the default radius", queries, |query, heap| {
        tree.nearest(query.position, max_radius * max_radius, 50, |_, d| Some(d), heap);
        (heap.len() as u32, heap.get(0).map_or(0.0, |n| n.dist_sq))
    });
}

fn flux(
    map: &PhotonMap,
    query: &Query,
    kernel: Kernel,
    bandwidth: Bandwidth,
    heap: &mut NearestList,
) -> (u32, f32) {
    let mut sum = Rgb::BLACK;
    let gathered = gather(map, query, kernel, bandwidth, heap, |photon, weight| {
        // What a diffuse material does: light from behind its surface does not count.
        if photon.wi.dot(query.normal) > 0.0 {
            sum += photon.power * weight;
        }
    });
    (gathered.count, sum.r)
}

fn report(what: &str, queries: &[Query], run: impl Fn(&Query, &mut NearestList) -> (u32, f32)) {
    let mut heap = NearestList::new();
    let (mut seconds, mut found) = (0.0, 0u64);
    for part in queries.chunks(1024) {
        let mut best = f64::INFINITY;
        let mut sum = 0;
        for _ in 0..9 {
            let start = Instant::now();
            sum = part.iter().map(|query| u64::from(black_box(run(query, &mut heap)).0)).sum();
            best = best.min(start.elapsed().as_secs_f64());
        }
        seconds += best;
        found += sum;
    }
    let (rate, mean) = (queries.len() as f64 / seconds / 1e3, found as f64 / queries.len() as f64);
    println!("  {rate:8.0}  {what} ({mean:.1} found)");
}

fn uniform(rng: &mut Pcg32) -> Vec2 {
    let mut next = || (rng.next_u32() >> 8) as f32 / 16_777_216.0;
    Vec2::new(next(), next())
}

/// A point of five walls or the sphere, and its normal. The floor takes half of all.
fn surface(which: f32, uv: Vec2) -> (Vec3, Vec3) {
    let (a, b) = (uv.x * 2.0 - 1.0, uv.y * 2.0 - 1.0);
    match (which * 10.0) as u32 {
        0..=4 => (Vec3::new(a, -1.0, b), Vec3::Y),
        5 => (Vec3::new(a, 1.0, b), -Vec3::Y),
        6 => (Vec3::new(-1.0, a, b), Vec3::X),
        7 => (Vec3::new(1.0, a, b), -Vec3::X),
        8 => (Vec3::new(a, b, -1.0), Vec3::Z),
        _ => {
            let n = warp::square_to_sphere(uv);
            (Vec3::new(0.3, -0.6, 0.2) + n * 0.4, n)
        }
    }
}

fn photon(which: Vec2, uv: Vec2) -> Photon {
    let (position, normal) = surface(which.x, uv);
    Photon { position, power: Rgb::WHITE, wi: normal, normal, depth: 2, light: 0 }
}

fn query(which: f32, uv: Vec2) -> Query {
    let (position, normal) = surface(which, uv);
    Query { position, normal, max_photon_depth: None }
}

fn scan_lines() -> Vec<Query> {
    let side = 128;
    (0..QUERIES)
        .map(|i| {
            let uv = Vec2::new((i % side) as f32, (i / side % side) as f32) / side as f32;
            query(if i < QUERIES / 2 { 0.1 } else { 0.85 }, uv)
        })
        .collect()
}

fn scattered(rng: &mut Pcg32) -> Vec<Query> {
    (0..QUERIES).map(|_| query(uniform(rng).x, uniform(rng))).collect()
}
