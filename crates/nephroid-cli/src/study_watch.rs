//! Watches a study: shows how far it is and how long it will take, and tells it when to stop.

use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use nephroid::observer::Observer;
use nephroid_study::{Section, Watch};

/// The watch of a study.
pub struct StudyWatch {
    bar: ProgressBar,
    /// Whether lines are printed where no bar can be seen.
    tells: bool,
    interrupted: Arc<AtomicBool>,
    pace: Arc<Mutex<Pace>>,
}

/// The expectation counts like so many seconds in which it was right.
const TRUST: f64 = 20.0;

/// How fast the study is beside its own expectation.
struct Pace {
    begun: Instant,
    section_begun: Instant,
    /// Seconds of work that are expected: behind the section, of the section, and in all.
    done: f64,
    section: f64,
    total: f64,
}

impl Pace {
    /// Expected seconds that are done, with a guess at the share of the section: it never quite ends before it ends.
    fn position(&self) -> f64 {
        let within = self.section_begun.elapsed().as_secs_f64() / self.speed();
        self.done + within.min(0.95 * self.section)
    }

    /// Seconds for each that was expected, by the sections behind; few of them say little.
    fn speed(&self) -> f64 {
        let before = (self.section_begun - self.begun).as_secs_f64();
        (before + TRUST) / (self.done + TRUST)
    }

    fn left(&self) -> Duration {
        Duration::from_secs_f64(((self.total - self.position()) * self.speed()).clamp(0.0, 1e9))
    }
}

impl StudyWatch {
    /// The study begins now.
    pub fn new(tells: bool, interrupted: Arc<AtomicBool>) -> Self {
        let visible = tells && std::io::stderr().is_terminal();
        let target = if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let now = Instant::now();
        let pace = Pace { begun: now, section_begun: now, done: 0.0, section: 0.0, total: 0.0 };
        let pace = Arc::new(Mutex::new(pace));
        let of_style = Arc::clone(&pace);
        let left = move |_: &ProgressState, out: &mut dyn Write| {
            let left = of_style.lock().unwrap_or_else(PoisonError::into_inner).left();
            // A line that cannot be formatted is not shown.
            let _ = write!(out, "{} left", HumanDuration(left));
        };
        let style = ProgressStyle::with_template("study [{bar:30}] {percent:>3} %  {msg}  {left}")
            .unwrap_or_else(|_| ProgressStyle::default_bar())
            .with_key("left", left)
            .progress_chars("=> ");
        let bar = ProgressBar::with_draw_target(Some(1), target).with_style(style);
        Self { bar, tells: tells && !visible, interrupted, pace }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn show(&self) {
        let pace = self.pace.lock().unwrap_or_else(PoisonError::into_inner);
        let position = (1000.0 * pace.position()) as u64;
        drop(pace);
        self.bar.set_position(position);
    }
}

impl Observer for StudyWatch {
    fn advance(&self, _phase: nephroid::observer::Phase, _done: u64) {
        if !self.bar.is_hidden() {
            self.show();
        }
    }

    fn cancelled(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}

impl Watch for StudyWatch {
    fn section(&self, section: &Section, done: f64, weight: f64, total: f64) {
        let mut pace = self.pace.lock().unwrap_or_else(PoisonError::into_inner);
        (pace.section_begun, pace.done, pace.section, pace.total) = (Instant::now(), done, weight, total);
        let left = pace.left();
        drop(pace);
        self.bar.set_length((1000.0 * total) as u64);
        self.bar.set_message(section.heading());
        self.show();
        if self.tells {
            crate::console::say(&format!("{}: {} left", section.heading(), HumanDuration(left)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_follows_the_pace_so_far() {
        let now = Instant::now();
        let begun = now.checked_sub(Duration::from_secs(20)).unwrap_or(now);
        // Five expected seconds took twenty; with twenty that are trusted, 40 for 25.
        let pace = Pace { begun, section_begun: now, done: 5.0, section: 5.0, total: 40.0 };
        let left = pace.left().as_secs_f64();
        assert!((left - 56.0).abs() < 1.0, "{left}");
    }
}
