//! Watches a render: shows how far it is, takes the time of its phases, and tells it when to stop.

use std::fmt::Write;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use nephroid::observer::{Observer, Phase};

use crate::exit::{Exit, Failure};

/// How long the phases of a render took.
#[derive(Clone, Copy, Debug, Default)]
pub struct PhaseTimes {
    /// Trial paths.
    pub pilot: Duration,
    /// Photon paths.
    pub photons: Duration,
    /// Building photon maps.
    pub maps: Duration,
    /// Camera paths.
    pub camera: Duration,
}

impl PhaseTimes {
    fn of(&mut self, phase: Phase) -> &mut Duration {
        match phase {
            Phase::Pilot => &mut self.pilot,
            Phase::Photons => &mut self.photons,
            Phase::Maps => &mut self.maps,
            Phase::Camera => &mut self.camera,
        }
    }
}

/// The observer of a render.
pub struct Watch {
    bar: ProgressBar,
    begun: Instant,
    /// When the time is up, and how long that is.
    limit: Option<Duration>,
    /// Whether a picture has been begun: there is nothing to stop with before.
    may_stop: AtomicBool,
    interrupted: Arc<AtomicBool>,
    /// Camera samples of all passes, if known, and those of the steps before this one.
    total_samples: Option<u64>,
    samples_before: AtomicU64,
    now: Mutex<Now>,
}

#[derive(Default)]
struct Now {
    phase: Option<(Phase, Instant)>,
    times: PhaseTimes,
    samples_of_step: u64,
}

/// The share of the time limit that a step may overrun to finish, and within which none is begun.
const GRACE: f64 = 0.03;

impl Watch {
    /// The render begins now. `limit` is in seconds; `total_samples` counts those of all pixels.
    pub fn new(
        visible: bool,
        limit: Option<f64>,
        total_samples: Option<u64>,
        interrupted: Arc<AtomicBool>,
    ) -> Self {
        let target = if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        Self {
            bar: ProgressBar::with_draw_target(None, target),
            begun: Instant::now(),
            limit: limit.map(Duration::from_secs_f64),
            may_stop: AtomicBool::new(false),
            interrupted,
            total_samples,
            samples_before: AtomicU64::new(0),
            now: Mutex::default(),
        }
    }

    /// From the start of the render.
    pub fn elapsed(&self) -> Duration {
        self.begun.elapsed()
    }

    /// Whether Ctrl-C was pressed.
    pub fn interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }

    /// Whether the time is up, too nearly for another step.
    pub fn time_is_up(&self) -> bool {
        self.is_past(1.0 - GRACE)
    }

    /// Ends the display, and gives the times.
    pub fn finish(&self) -> PhaseTimes {
        self.bar.finish_and_clear();
        let mut now = self.now.lock().unwrap_or_else(PoisonError::into_inner);
        now.enter(None);
        now.times
    }

    fn is_past(&self, share: f64) -> bool {
        self.limit.is_some_and(|limit| self.begun.elapsed() >= limit.mul_f64(share))
    }
}

impl Now {
    fn enter(&mut self, next: Option<Phase>) {
        let now = Instant::now();
        if let Some((phase, since)) = self.phase {
            *self.times.of(phase) += now - since;
        }
        self.phase = next.map(|phase| (phase, now));
    }
}

impl Observer for Watch {
    fn begin(&self, phase: Phase, work: u64) {
        self.may_stop.fetch_or(phase == Phase::Camera, Ordering::Relaxed);
        let mut now = self.now.lock().unwrap_or_else(PoisonError::into_inner);
        let last = now.phase.map(|(phase, _)| phase);
        now.enter(Some(phase));
        if phase == Phase::Camera {
            // A step that did not end would have ended the render.
            let before = std::mem::replace(&mut now.samples_of_step, work);
            self.samples_before.fetch_add(before, Ordering::Relaxed);
            if last == Some(Phase::Camera) {
                return;
            }
        }
        let length = match (phase, self.total_samples) {
            (Phase::Camera, Some(total)) => total,
            _ => work,
        };
        self.bar.reset();
        self.bar.set_style(style(phase));
        self.bar.set_length(length.max(1));
    }

    fn advance(&self, phase: Phase, done: u64) {
        let before = if phase == Phase::Camera { self.samples_before.load(Ordering::Relaxed) } else { 0 };
        self.bar.set_position(before + done);
    }

    fn cancelled(&self) -> bool {
        self.interrupted() || (self.may_stop.load(Ordering::Relaxed) && self.is_past(1.0 + GRACE))
    }
}

fn style(phase: Phase) -> ProgressStyle {
    let name = match phase {
        Phase::Pilot => "pilot",
        Phase::Photons => "photons",
        Phase::Maps => "maps",
        Phase::Camera => "picture",
    };
    let template = format!("{name:8} [{{bar:40}}] {{percent:>3}} %  {{rate}}  {{eta}} left");
    ProgressStyle::with_template(&template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("rate", |state: &ProgressState, out: &mut dyn Write| {
            // A line that cannot be formatted is not shown.
            let _ = write!(out, "{:>8}/s", rate(state.per_sec()));
        })
        .progress_chars("=> ")
}

/// Three digits and a prefix.
fn rate(value: f64) -> String {
    let (scaled, prefix) = match value {
        v if v >= 1e9 => (v / 1e9, " G"),
        v if v >= 1e6 => (v / 1e6, " M"),
        v if v >= 1e3 => (v / 1e3, " k"),
        v => (v, ""),
    };
    let digits = if scaled >= 100.0 { 0 } else { 1 };
    format!("{scaled:.digits$}{prefix}")
}

/// Listens for Ctrl-C: the first is for the render to notice, the second ends the process.
pub fn listen() -> Result<Arc<AtomicBool>, Failure> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    let handler = move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(Exit::Stopped as i32);
        }
    };
    match ctrlc::set_handler(handler) {
        Ok(()) => Ok(interrupted),
        Err(error) => Err(Failure::Usage(format!("cannot listen for Ctrl-C: {error}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn watch(limit: Option<f64>) -> Watch {
        Watch::new(false, limit, None, Arc::default())
    }

    #[test]
    fn time_stops_nothing_before_a_picture_is_begun() {
        let watch = watch(Some(1e-9));
        std::thread::sleep(Duration::from_millis(1));
        watch.begin(Phase::Photons, 1);
        assert!(watch.time_is_up() && !watch.cancelled());
        watch.begin(Phase::Camera, 1);
        assert!(watch.cancelled());
    }

    #[test]
    fn without_a_limit_only_an_interrupt_stops() {
        let watch = watch(None);
        assert!(!watch.time_is_up() && !watch.cancelled());
        watch.interrupted.store(true, Ordering::Relaxed);
        assert!(watch.cancelled());
    }

    #[test]
    fn phases_are_timed() {
        let watch = watch(None);
        watch.begin(Phase::Photons, 10);
        std::thread::sleep(Duration::from_millis(2));
        watch.begin(Phase::Camera, 10);
        let times = watch.finish();
        assert!(times.photons >= Duration::from_millis(2) && times.pilot.is_zero());
        assert!(times.camera < times.photons);
    }

    #[test]
    fn rates_are_short() {
        assert_eq!([0.5, 1234.0, 123_456_789.0].map(rate), ["0.5", "1.2 k", "123 M"]);
    }
}
