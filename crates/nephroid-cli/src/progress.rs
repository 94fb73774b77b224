//! Watches a render: shows how far it is, takes the time of its phases, and tells it when to stop.

use std::fmt::Write;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use nephroid::observer::{Observer, Phase};

use crate::exit::{Exit, Failure};

/// How long the phases of a render took.
#[derive(Clone, Copy, Debug, Default)]
pub struct PhaseTimes {
    /// Trees for rays.
    pub trees: Duration,
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
            Phase::Trees => &mut self.trees,
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
    /// Camera samples of this run, none if unknown, and those of the steps before this one.
    total_samples: AtomicU64,
    samples_before: AtomicU64,
    /// When the first photons or samples were begun.
    planned: Arc<OnceLock<Instant>>,
    /// When the error will be small enough, if that is to end it.
    good_enough: Arc<Mutex<Option<Instant>>>,
    now: Mutex<Now>,
}

#[derive(Default)]
struct Now {
    phase: Option<(Phase, Instant)>,
    times: PhaseTimes,
    samples_of_step: u64,
    /// What was last said beside the pass.
    more: Option<String>,
}

/// The share of the time limit that a step may overrun to finish, and within which none is begun.
const GRACE: f64 = 0.03;

impl Watch {
    /// The render begins now. `limit` is in seconds.
    pub fn new(visible: bool, limit: Option<f64>, interrupted: Arc<AtomicBool>) -> Self {
        let target = if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        Self {
            bar: ProgressBar::with_draw_target(None, target),
            begun: Instant::now(),
            limit: limit.map(Duration::from_secs_f64),
            may_stop: AtomicBool::new(false),
            interrupted,
            total_samples: AtomicU64::new(0),
            samples_before: AtomicU64::new(0),
            planned: Arc::default(),
            good_enough: Arc::default(),
            now: Mutex::default(),
        }
    }

    /// How many samples of all pixels together this run will take, if that is known.
    pub fn expect(&self, samples: Option<u64>) {
        self.total_samples.store(samples.unwrap_or(0), Ordering::Relaxed);
    }

    /// In how many seconds the error may be small enough.
    pub fn expect_end(&self, seconds: f64) {
        let left = Duration::from_secs_f64(seconds.clamp(0.0, 1e9));
        *self.good_enough.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now().checked_add(left);
    }

    /// Whether anybody sees the display.
    pub fn is_visible(&self) -> bool {
        !self.bar.is_hidden()
    }

    /// Shows how far the render is, and what else there is to say, or what there was last.
    pub fn tell(&self, text: String, more: Option<String>) {
        if !self.is_visible() {
            return;
        }
        let mut now = self.now.lock().unwrap_or_else(PoisonError::into_inner);
        now.more = more.or(now.more.take());
        let more = now.more.as_ref().map_or(String::new(), |more| format!(", {more}"));
        self.bar.set_message(format!("{text}{more}"));
    }

    /// Prints something while the display is out of the way.
    pub fn aside(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
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
        if !matches!(phase, Phase::Trees | Phase::Pilot) {
            self.planned.get_or_init(Instant::now);
        }
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
        let total = self.total_samples.load(Ordering::Relaxed);
        let length = if phase == Phase::Camera && total > 0 { total } else { work };
        self.bar.reset();
        self.bar.set_style(self.style(phase));
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

impl Watch {
    fn style(&self, phase: Phase) -> ProgressStyle {
        let name = match phase {
            Phase::Trees => "trees",
            Phase::Pilot => "pilot",
            Phase::Photons => "photons",
            Phase::Maps => "maps",
            Phase::Camera => "picture",
        };
        let total = self.total_samples.load(Ordering::Relaxed);
        let (planned, limit, begun) = (Arc::clone(&self.planned), self.limit, self.begun);
        let good_enough = Arc::clone(&self.good_enough);
        let left = move |state: &ProgressState, out: &mut dyn Write| {
            // Photons are part of a pass: the time of the samples so far counts them in.
            let since = planned.get().map_or(0.0, |since| since.elapsed().as_secs_f64());
            let by_samples = (phase == Phase::Camera && total > 0 && state.pos() > 0)
                .then(|| since * (total.saturating_sub(state.pos())) as f64 / state.pos() as f64);
            let by_time = limit.map(|limit| limit.saturating_sub(begun.elapsed()).as_secs_f64());
            let end = *good_enough.lock().unwrap_or_else(PoisonError::into_inner);
            let by_error = end.map(|end| end.saturating_duration_since(Instant::now()).as_secs_f64());
            let left = by_samples.into_iter().chain(by_time).chain(by_error).reduce(f64::min);
            // A line that cannot be formatted is not shown.
            let _ = match left {
                Some(left) => write!(out, "{} left", HumanDuration(Duration::from_secs_f64(left.min(1e9)))),
                None => Ok(()),
            };
        };
        let template = format!("{name:8} [{{bar:30}}] {{percent:>3}} %  {{rate}}  {{msg}}  {{left}}");
        ProgressStyle::with_template(&template)
            .unwrap_or_else(|_| ProgressStyle::default_bar())
            .with_key("rate", |state: &ProgressState, out: &mut dyn Write| {
                let _ = write!(out, "{:>8}/s", rate(state.per_sec()));
            })
            .with_key("left", left)
            .progress_chars("=> ")
    }
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
        Watch::new(false, limit, Arc::default())
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
