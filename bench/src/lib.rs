//! What the benches share: CPU time, and rounds in which the contestants take turns.

pub mod denoise;
pub mod embree;
pub mod methods;
pub mod reference;

use std::time::Duration;

use cpu_time::ProcessTime;

/// CPU time of all threads that `work` takes.
pub fn cpu_time(work: impl FnOnce()) -> Duration {
    let start = ProcessTime::now();
    work();
    start.elapsed()
}

/// The median CPU time in seconds of each contestant over `rounds` rounds. They take turns within a round, so
/// that a machine that slows down slows all of them.
pub fn rounds(rounds: usize, contestants: &mut [&mut dyn FnMut()]) -> Vec<f64> {
    let mut times = vec![Vec::with_capacity(rounds); contestants.len()];
    for _ in 0..rounds {
        for (times, contestant) in times.iter_mut().zip(contestants.iter_mut()) {
            times.push(cpu_time(contestant).as_secs_f64());
        }
    }
    times.into_iter().map(median).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
