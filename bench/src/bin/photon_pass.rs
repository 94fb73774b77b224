//! The photon pass: photons stored per CPU second, and how well two threads share the work.
//!
//! In a Cornell box with two boxes, where light that comes straight from the lamp is stored as well, as other
//! renderers do; and in the built-in scene, glass and mirror, without that.

use std::path::Path;
use std::time::Instant;

use nephroid::observer::Silent;
use nephroid::transport::{Extras, MapPlan, PhotonPlan, WalkSettings, photon_pass};
use nephroid::world::World;
use nephroid_bench::cpu_time;
use nephroid_formats::mitsuba::read_scene;
use nephroid_formats::Options;
use nephroid_formats::vfs::DiskFiles;

const PATHS: u64 = 1 << 20;
const ROUNDS: usize = 7;

fn main() {
    println!("million photons stored per CPU second on one thread; efficiency of two threads");
    for (name, direct) in [("bench/scenes/boxes.xml", true), ("scenes/cornell.xml", false)] {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name);
        let file = read_scene(&scene, &DiskFiles, &Options::default()).expect("the scene can be read");
        let world = World::new(file.scene).expect("the scene can be rendered");
        let (rate, efficiency) = measure(&world, Extras { direct, ..Extras::default() });
        println!("{name:<24} {rate:>6.2} {efficiency:>6.3}");
    }
}

/// Photons stored per CPU second, in millions, and the wall time of one thread over twice that of two.
fn measure(world: &World, extras: Extras) -> (f64, f64) {
    let plan = PhotonPlan { global: MapPlan { paths: PATHS, ..MapPlan::default() }, ..PhotonPlan::default() };
    let pools = [1, 2].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads"));
    let run = |pool: &rayon::ThreadPool| {
        let (mut stored, start) = (0, Instant::now());
        let cpu = cpu_time(|| {
            let settings = WalkSettings::default();
            let pass = pool.install(|| photon_pass(world, &settings, &plan, extras, 1, 0, &Silent));
            stored = pass.expect("nobody cancels").global.stored();
        });
        (stored as f64 / cpu.as_secs_f64() / 1e6, start.elapsed().as_secs_f64())
    };
    let mut rates = Vec::new();
    let mut efficiencies = Vec::new();
    for _ in 0..ROUNDS {
        let ((rate, one), (_, two)) = (run(&pools[0]), run(&pools[1]));
        rates.push(rate);
        efficiencies.push(one / two / 2.0);
    }
    let median = |mut values: Vec<f64>| {
        values.sort_unstable_by(f64::total_cmp);
        values[ROUNDS / 2]
    };
    (median(rates), median(efficiencies))
}
