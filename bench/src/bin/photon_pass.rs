//! The photon pass in the Cornell box: photons stored per CPU second, and how well two threads share the work.

use std::path::Path;
use std::time::Instant;

use nephroid::observer::Silent;
use nephroid::transport::{Extras, MapPlan, PhotonPlan, WalkSettings, photon_pass};
use nephroid::world::World;
use nephroid_bench::cpu_time;
use nephroid_formats::mitsuba::{Options, read_scene};
use nephroid_formats::vfs::DiskFiles;

const PATHS: u64 = 1 << 20;
const ROUNDS: usize = 7;

fn main() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/cornell.xml");
    let file = read_scene(&scene, &DiskFiles, &Options::default()).expect("the default scene can be read");
    let world = World::new(file.scene).expect("the default scene can be rendered");
    let plan = PhotonPlan { global: MapPlan { paths: PATHS, ..MapPlan::default() }, ..PhotonPlan::default() };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let mut stored = 0;
        let start = Instant::now();
        let cpu = cpu_time(|| {
            pool.install(|| {
                let settings = WalkSettings::default();
                let pass = photon_pass(&world, &settings, &plan, Extras::default(), 1, 0, &Silent);
                stored = pass.expect("nobody cancels").global.stored();
            });
        });
        (stored as f64 / cpu.as_secs_f64(), stored as f64 / start.elapsed().as_secs_f64())
    };
    let mut rates: Vec<[f64; 3]> = (0..ROUNDS)
        .map(|_| {
            let ((one_cpu, one_wall), (_, two_wall)) = (run(1), run(2));
            [one_cpu, one_wall, two_wall / one_wall / 2.0]
        })
        .collect();
    rates.sort_by(|a, b| a[0].total_cmp(&b[0]));
    println!("million photons stored per CPU second, one thread: {:.2}", rates[ROUNDS / 2][0] / 1e6);
    rates.sort_by(|a, b| a[2].total_cmp(&b[2]));
    println!("efficiency of two threads: {:.3}", rates[ROUNDS / 2][2]);
}
