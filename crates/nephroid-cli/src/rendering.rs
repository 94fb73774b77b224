//! The middle of a render: from a scene to films, step by step, kept and shown on the way.

use std::ops::Range;
use std::time::{Duration, Instant};

use nephroid::film::{AovFilm, Convergence, Film, Quality};
use nephroid::integrator::{Choice, LightTracerConfig, Method};
use nephroid::session::{Place, RenderPlan, RenderSettings, Session, Statistics};
use nephroid::world::World;
use nephroid_formats::SceneFile;
use nephroid_formats::diagnostic::Diagnostic;
use nephroid_formats::film_file::Covered;

use crate::checkpoint::Checkpoint;
use crate::console::Messages;
use crate::exit::Failure;
use crate::films::{self, Begun};
use crate::identity::{self, Identity};
use crate::job::{Job, Order};
use crate::layers::LayerPlan;
use crate::load;
use crate::method;
use crate::noise;
use crate::plan::Plan;
use crate::preview::Previews;
use crate::progress::{self, PhaseTimes, Watch};
use crate::quality;

/// What is to be rendered.
pub struct Task {
    /// How.
    pub settings: RenderSettings,
    /// The flags of photon mapping that were given.
    pub flags: Vec<String>,
    /// How much.
    pub plan: Plan,
    /// The most that a camera sample may bring.
    pub clamp: Option<f32>,
    /// The layers of the picture.
    pub layers: Vec<LayerPlan>,
    /// Whether the error of each pixel is to be told.
    pub wants_error: bool,
    /// What it is, as far as that is known beforehand.
    pub identity: Identity,
    /// What it was told to be, where a film is to be kept or written.
    pub order: Option<Order>,
    /// What was rendered of it before.
    pub begun: Option<Begun>,
    /// Whether to show how far it is.
    pub visible: bool,
}

/// What became of a render.
pub struct Rendered {
    /// The sums to make a picture of, and those of its layers.
    pub picture: (Film, Option<AovFilm>),
    /// The sums of whole steps only, if there is more in the picture.
    whole: Option<(Film, Option<AovFilm>)>,
    /// How the whole steps came together.
    convergence: Convergence,
    /// What the picture states of its error, by its whole steps.
    pub quality: Option<Quality>,
    /// That of each pixel, if it is wanted and there is one.
    pub error_image: Option<Vec<f32>>,
    /// Numbers of the samples of each pixel that are in them.
    pub covered: Range<u64>,
    /// What the films are of.
    pub identity: Identity,
    /// What they are for, where a film is to be written.
    job: Option<Job>,
    /// What it decided before its first pass.
    decided: RenderPlan,
    /// The layers of the picture.
    pub layers: Vec<LayerPlan>,
    /// What was done in this run.
    pub statistics: Statistics,
    /// How much the picture still changes.
    pub noise: Option<f64>,
    /// Names of the lights, in the order of the ledger.
    pub lights: Vec<String>,
    /// Whether any of them has power.
    pub has_light: bool,
    /// The integrator that rendered.
    pub method: Method,
    /// Why it did, if that was to be found.
    pub choice: Option<Choice>,
    /// Whether there are mirrors or glass that the integrator sees nothing in.
    pub blind_to_specular: bool,
    /// Why it ended.
    pub ended: Ended,
    /// How long the phases took.
    pub phases: PhaseTimes,
    /// How long it took to prepare the world.
    pub preparing: Duration,
    /// How long it took to render, from the pilot to the last sample.
    pub rendering: Duration,
    /// Seconds of that which were there for this run.
    pub limit: Option<f64>,
    /// What of the scene may not be meant so.
    pub remarks: Vec<Diagnostic>,
    /// Threads that worked on it.
    pub threads: usize,
}

/// Why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// All passes or samples are done.
    Finished,
    /// The error is small enough.
    GoodEnough,
    /// The time is up.
    TimeIsUp,
    /// Ctrl-C.
    Interrupted,
}

impl Rendered {
    /// Samples of each pixel in the picture, as far as all have the same.
    pub fn samples(&self) -> u64 {
        self.covered.end - self.covered.start
    }

    /// Samples of each pixel in a pass.
    pub fn samples_per_pass(&self) -> u32 {
        self.decided.camera.samples_per_pixel
    }

    /// Passes that are complete in the picture.
    pub fn passes_done(&self) -> u64 {
        self.samples() / u64::from(self.samples_per_pass().max(1))
    }

    /// Whether there is anything to write a film of.
    pub fn has_film(&self) -> bool {
        !self.covered.is_empty()
    }

    /// Whether there is anything to make a picture of.
    pub fn has_picture(&self) -> bool {
        self.picture.0.iterations() > 0
    }

    /// Writes the sums of whole steps.
    pub fn write_film(&self, path: &std::path::Path) -> Result<(), String> {
        let job = self.job.as_ref().ok_or_else(|| format!("{}: nobody asked for a film", path.display()))?;
        let (film, aovs) = self.whole.as_ref().unwrap_or(&self.picture);
        let covered = Covered::from_range(self.covered.clone());
        films::write(path, (film, aovs.as_ref(), self.convergence), covered, &self.identity, job)
    }
}

/// What goes on beside a render.
pub struct Companions<'a> {
    /// Where it is kept.
    pub checkpoint: Option<&'a mut Checkpoint>,
    /// Where it is shown.
    pub previews: &'a mut Previews<'a>,
    /// What there is to say.
    pub messages: &'a mut Messages,
}

/// Renders to the end of the plan, or as far as it gets.
pub fn render(file: SceneFile, task: Task, companions: Companions<'_>) -> Result<Rendered, Failure> {
    let clock = Instant::now();
    let SceneFile { scene, origins, .. } = file;
    let world = load::world(scene, &origins, task.visible)?;
    let preparing = clock.elapsed();
    let Task { settings, flags, plan, clamp, layers, wants_error, identity, order, begun, visible } = task;
    let spent = begun.as_ref().map_or(0.0, |begun| begun.job.spent);
    let limit = plan.seconds.map(|seconds| (seconds - spent).max(0.0));
    let watch = Watch::new(visible, limit, progress::listen()?);
    let session = session(&world, settings, &layers, begun, &plan, &watch)?.clamping(clamp);
    for note in about_choice(session.plan().choice.as_ref(), session.method(), &flags, watch.interrupted()) {
        companions.messages.note(&note);
    }
    let decided = *session.plan();
    let mut run = Run {
        session,
        per_pass: decided.camera.samples_per_pixel,
        plan,
        identity: identity::with_plan(identity, &decided),
        order,
        layers,
        decided,
        spent,
        watch,
        told: Instant::now(),
        telling: Duration::ZERO,
        begun: None,
    };
    let ended = run.finish(companions);
    let covered = run.covered();
    let job = run.job();
    let picture = run.session.picture();
    let torn = picture.0.iterations() != run.session.film().iterations();
    Ok(Rendered {
        noise: noise::noise(&picture.0),
        convergence: *run.session.convergence(),
        quality: run.session.quality(),
        error_image: wants_error.then(|| run.session.error_image()).flatten(),
        whole: torn.then(|| (run.session.film().clone(), run.session.aovs().cloned())),
        picture,
        covered,
        identity: run.identity,
        job,
        decided,
        layers: run.layers,
        statistics: run.session.statistics().clone(),
        remarks: load::remarks(&world, &origins),
        lights: world.lights().map(|(name, _)| name.to_owned()).collect(),
        has_light: has_light(&world),
        method: run.session.method().clone(),
        choice: run.session.plan().choice,
        blind_to_specular: matches!(run.session.settings().method, Method::LightTracer(_))
            && LightTracerConfig::misses(&world),
        ended,
        rendering: run.watch.elapsed(),
        limit,
        phases: run.watch.finish(),
        preparing,
        threads: rayon::current_num_threads(),
    })
}

/// What was chosen and why, and which flags thereby have no effect. Trials that were interrupted tell of nothing.
fn about_choice(
    choice: Option<&Choice>,
    method: &Method,
    flags: &[String],
    interrupted: bool,
) -> Vec<String> {
    let Some(choice) = choice.filter(|_| !interrupted) else { return Vec::new() };
    let mut notes = vec![format!("auto: {}", choice.reason())];
    let foreign = method::foreign(flags, method);
    if !foreign.is_empty() {
        notes.push(format!("auto: {} makes no use of {}", method.name(), foreign.join(", ")));
    }
    notes
}

/// A session that begins at the plan's first sample, or goes on with what was begun.
fn session<'w>(
    world: &'w World,
    settings: RenderSettings,
    layers: &[LayerPlan],
    begun: Option<Begun>,
    plan: &Plan,
    watch: &Watch,
) -> Result<Session<'w>, Failure> {
    let aovs: Vec<_> = layers.iter().map(|layer| layer.aov).collect();
    let Some(begun) = begun else {
        let session = Session::new(world, settings, watch).with_aovs(&aovs);
        let per_pass = session.plan().camera.samples_per_pixel;
        let place = Place::before_sample(plan.first_sample(per_pass), per_pass);
        return Ok(session.starting_at(place));
    };
    let decided = begun.job.plan;
    let place = Place::before_sample(begun.covered.end, decided.camera.samples_per_pixel);
    let session = Session::with_plan(world, settings, decided).with_aovs(&aovs).starting_at(place);
    let name = begun.path.display().to_string();
    let damaged = |error| Failure::File(format!("{name}: is not of this picture: {error}"));
    let session = session.with_films(begun.film, begun.aovs).map_err(damaged)?;
    Ok(session.with_convergence(begun.convergence))
}

/// Steps after which a picture without any light is not waited for any longer.
const BLACK_AFTER: u64 = 64;

/// A render under way.
struct Run<'w> {
    session: Session<'w>,
    per_pass: u32,
    plan: Plan,
    identity: Identity,
    order: Option<Order>,
    layers: Vec<LayerPlan>,
    decided: RenderPlan,
    /// Seconds before this run.
    spent: f64,
    watch: Watch,
    /// When the noise was last told, and how long that took.
    told: Instant,
    telling: Duration,
    /// When the first step began, and how many steps were done before.
    begun: Option<(Instant, u64)>,
}

impl Run<'_> {
    fn finish(&mut self, mut companions: Companions<'_>) -> Ended {
        let ended = self.steps(&mut companions);
        self.keep(&mut companions);
        self.show(true, &mut companions);
        ended
    }

    fn steps(&mut self, companions: &mut Companions<'_>) -> Ended {
        let end = self.plan.end(self.per_pass);
        if end.is_some_and(|end| self.sample() >= end) {
            return Ended::Finished;
        }
        let window = self.session.film();
        let pixels = u64::from(window.width()) * u64::from(window.height());
        self.watch.expect(end.map(|end| (end - self.sample()).saturating_mul(pixels)));
        loop {
            if self.is_good_enough() {
                return Ended::GoodEnough;
            }
            // What went on before this run may have left no time at all.
            if self.sample() > self.plan.first_sample(self.per_pass) && self.watch.time_is_up() {
                return Ended::TimeIsUp;
            }
            self.tell();
            if !self.session.step(&self.watch) {
                return if self.watch.interrupted() { Ended::Interrupted } else { Ended::TimeIsUp };
            }
            if end.is_some_and(|end| self.sample() >= end) {
                return Ended::Finished;
            }
            if companions.checkpoint.as_ref().is_some_and(|checkpoint| checkpoint.is_due()) {
                self.keep(companions);
            }
            self.show(false, companions);
        }
    }

    /// Whether the error is small enough, where that is to be judged.
    fn is_good_enough(&self) -> bool {
        let Some(target) = self.plan.target_error else { return false };
        if !quality::is_due(self.session.steps()) {
            return false;
        }
        match self.session.quality() {
            Some(quality) => quality.interval[1] <= target,
            // A picture that stays black has no error to fall.
            None => self.session.steps() >= BLACK_AFTER && self.session.film().mean_luminance() == 0.0,
        }
    }

    /// The number of the next sample of each pixel.
    fn sample(&self) -> u64 {
        self.session.place().samples_before(self.per_pass)
    }

    fn covered(&self) -> Range<u64> {
        self.plan.first_sample(self.per_pass)..self.sample()
    }

    fn job(&self) -> Option<Job> {
        let spent = self.spent + self.watch.elapsed().as_secs_f64();
        self.order.clone().map(|order| order.job(self.decided, self.plan, &self.layers, spent))
    }

    fn keep(&self, companions: &mut Companions<'_>) {
        let covered = self.covered();
        if covered.is_empty() {
            return;
        }
        let (Some(checkpoint), Some(job)) = (&mut companions.checkpoint, self.job()) else { return };
        let films = (self.session.film(), self.session.aovs(), *self.session.convergence());
        let trouble = checkpoint.keep(covered.end, |path| {
            films::write(path, films, Covered::from_range(covered), &self.identity, &job)
        });
        if let Some(trouble) = trouble {
            let warning = format!("the render goes on, but cannot be kept for now: {trouble}");
            self.watch.aside(|| companions.messages.warning(&warning));
        }
    }

    fn show(&self, last: bool, companions: &mut Companions<'_>) {
        let trouble = if last {
            // With what there is of a step that was stopped; between steps there is none.
            let film = self.session.picture().0;
            if film.iterations() == 0 {
                return;
            }
            companions.previews.show(true, || film.develop())
        } else {
            companions.previews.show(false, || self.session.film().develop())
        };
        for warning in trouble {
            self.watch.aside(|| companions.messages.warning(&warning));
        }
    }

    /// Tells how far the render is; how good the picture is at most once a second, and in a hundredth of the time.
    fn tell(&mut self) {
        let per_pass = u64::from(self.per_pass.max(1));
        let pass = self.sample() / per_pass;
        let first = self.plan.first_sample(self.per_pass) / per_pass;
        // Numbers from 0, as everywhere.
        let of = self.plan.end(self.per_pass).map(|end| end.div_ceil(per_pass).saturating_sub(1));
        let of = of.map(|last| format!(" (of {first} to {last})"));
        let text = format!("pass {pass}{}", of.unwrap_or_default());
        let due = Duration::from_secs(1).max(100 * self.telling);
        self.begun.get_or_insert((Instant::now(), self.session.steps()));
        let more = if self.watch.is_visible() && self.told.elapsed() >= due {
            let begun = Instant::now();
            let more = self.how_good();
            (self.told, self.telling) = (Instant::now(), begun.elapsed());
            more
        } else {
            None
        };
        self.watch.tell(text, more);
    }

    /// What the picture states of its error, or else its noise; tells the display how long it will be until the error is
    /// small enough.
    fn how_good(&self) -> Option<String> {
        let Some(quality) = self.session.quality() else {
            let noise = noise::noise(self.session.film());
            return noise.map(|noise| format!("noise {}", noise::percent(noise)));
        };
        if let (Some(target), Some((begun, before))) = (self.plan.target_error, self.begun) {
            let steps = self.session.steps();
            let of_step = begun.elapsed().as_secs_f64() / steps.saturating_sub(before).max(1) as f64;
            let times = quality::times_the_steps(&quality, target, self.session.method());
            self.watch.expect_end(of_step * steps as f64 * (times - 1.0));
        }
        Some(quality::short(&quality))
    }
}

fn has_light(world: &World) -> bool {
    world.lights().any(|(_, power)| power.max_channel() > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid::integrator::{PathConfig, Pick, PpmConfig, VcmConfig};

    fn choice(pick: Pick) -> Choice {
        let (asked_for, paths_are_known) = (false, true);
        Choice { pick, path: 1.0, ppm: 1.0, vcm: [1.0; 2], asked_for, paths_are_known }
    }

    fn notes(pick: Pick, method: &Method, flags: &[&str]) -> Vec<String> {
        let flags: Vec<String> = flags.iter().map(|flag| (*flag).to_owned()).collect();
        about_choice(Some(&choice(pick)), method, &flags, false)
    }

    #[test]
    fn flags_that_the_choice_leaves_without_effect_are_named() {
        let flags = ["--max-depth", "--direct-lights", "--photons", "--emit-max"];
        let of = |pick, method| notes(pick, &method, &flags);
        let path = of(Pick::Path, Method::Path(PathConfig { media: true, ..PathConfig::default() }));
        assert_eq!(path[1..], ["auto: volpath makes no use of --photons, --emit-max"]);
        let vcm = of(Pick::Vcm { connections: true }, Method::Vcm(VcmConfig::default()));
        assert_eq!(vcm[1..], ["auto: vcm makes no use of --direct-lights, --photons"]);
        assert_eq!(of(Pick::Ppm, Method::Ppm(PpmConfig::default())).len(), 1);
        let known = notes(Pick::Path, &Method::Path(PathConfig::default()), &flags[..2]);
        assert!(known.len() == 1 && known[0].starts_with("auto: paths from the camera"), "{known:?}");
        assert!(about_choice(None, &Method::Path(PathConfig::default()), &[], false).is_empty());
    }

    #[test]
    fn interrupted_trials_say_nothing() {
        let (flags, method) = (["--photons".to_owned()], Method::Path(PathConfig::default()));
        let notes = |interrupted| about_choice(Some(&choice(Pick::Path)), &method, &flags, interrupted).len();
        assert_eq!((notes(false), notes(true)), (2, 0));
    }
}
