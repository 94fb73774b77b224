//! Renders that are killed at any moment and gone on with.

use std::process::Stdio;
use std::time::Instant;

use nephroid_formats::film_file::Covered;

use crate::support::Dir;

/// Kills of each render; `NEPHROID_KILLS` asks for more.
const KILLS: u64 = 3;

fn kills() -> u64 {
    std::env::var("NEPHROID_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(KILLS)
}

/// Numbers in [0, 1) that only look random.
fn fractions(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1u64 << 24) as f64
    }
}

/// Renders once as a whole, and once with a `SIGKILL` at random moments; each start has another number of threads.
#[track_caller]
fn survives(seed: u64, way: &[&str]) {
    let dir = Dir::new();
    let way = [&["render"], way, &["--quiet", "--seed", "3"]].concat();
    let begun = Instant::now();
    dir.run(&[&way[..], &["--threads", "2", "-o", "whole.exr", "-o", "whole.film"]].concat()).ends_with(0);
    let took = begun.elapsed();
    let total = dir.sums("whole.film").2.total();
    let checkpoint = ["--checkpoint", "kept.film", "--checkpoint-every", "0.001"];
    let first = [&way[..], &checkpoint, &["-o", "kept.exr"]].concat();
    let (kills, mut next, mut samples) = (kills(), fractions(seed), Vec::new());
    for start in 0.. {
        let threads = (start % 3 + 1).to_string();
        let go_on = dir.path("kept.film").exists();
        let args = if go_on { vec!["resume", "kept.film", "--quiet"] } else { first.clone() };
        let args = [&args[..], &["--threads", &threads]].concat();
        if go_on {
            samples.push(dir.sums("kept.film").2.total());
        }
        if start == kills {
            dir.run(&args).ends_with(0);
            break;
        }
        let mut child = dir.command(&args).stderr(Stdio::inherit()).spawn().unwrap();
        if start == 0 {
            // Nothing is kept before the pilot is done, and the first step after it: kill it as soon as there is.
            dir.wait_for("kept.film");
        } else {
            std::thread::sleep(took.mul_f64(0.05 + next() * 1.5 / kills as f64));
        }
        // It may be done already; what is kept is then finished, and going on with it does no harm.
        child.kill().unwrap();
        child.wait().unwrap();
    }
    println!("seed {seed}: killed {kills} times, {took:?} in one go, samples at each start: {samples:?}");
    assert!(samples.is_sorted());
    assert!(samples.iter().any(|n| (1..total).contains(n)), "no start found a part of {total} samples");
    dir.are_the_same("whole", "kept");
}

#[test]
fn photon_mapping_survives_kills_in_the_midst_of_passes() {
    let photons = ["--photons", "3000", "--caustic-photons", "1000"];
    let way = ["cornell", "--resolution", "40x30", "--spp", "128", "--passes", "2"];
    survives(1, &[&way[..], &photons].concat());
}

#[test]
fn progressive_photon_mapping_survives_kills() {
    let photons = ["--photons", "3000", "--caustic-photons", "1000"];
    let way = ["cornell", "--integrator", "ppm", "--resolution", "32x24", "--passes", "24"];
    survives(2, &[&way[..], &photons].concat());
}

#[test]
fn path_tracing_with_further_layers_survives_kills() {
    let way = ["fog", "--integrator", "volpath", "--resolution", "24x16", "--spp", "480", "--passes", "3"];
    survives(3, &[&way[..], &["--aov", "albedo,normal,depth,medium"]].concat());
}

#[test]
fn going_on_in_the_midst_of_a_pass_is_exact() {
    // Passes of 12 samples in steps of four; 20 are a pass and two steps.
    let dir = Dir::with_scene("", "");
    dir.run(&["render", "a.xml", "--spp", "24", "--passes", "2", "-o", "whole.exr", "-o", "whole.film"])
        .ends_with(0);
    dir.run(&["render", "a.xml", "--spp", "12", "-o", "kept.film", "-o", "kept.exr"]).ends_with(0);
    let run = dir.run(&["resume", "kept.film", "--spp", "20", "--json"]).ends_with(0);
    assert_eq!((&run.json()["passes_done"], &run.json()["samples_per_pixel"]), (&1.into(), &20.into()));
    assert_eq!(dir.sums("kept.film").2, Covered::from_range(0..20));
    dir.run(&["resume", "kept.film", "--spp", "24", "--threads", "3"]).ends_with(0);
    dir.are_the_same("whole", "kept");
}
