//! `nephroid render`: from a scene to pictures.

use std::ffi::OsString;
use std::path::Path;
use std::time::{Duration, Instant};

use nephroid::film::Film;
use nephroid::integrator::{LightTracerConfig, Method};
use nephroid::session::{RenderSettings, Session, Statistics};
use nephroid::world::World;
use nephroid_formats::diagnostic::Diagnostic;
use nephroid_formats::image::MAX_PIXELS;
use nephroid_formats::mitsuba::SceneFile;
use std::io::IsTerminal;

use crate::args::RenderArgs;
use crate::builtin;
use crate::console::{self, Messages};
use crate::exit::{Exit, Failure};
use crate::layers::{self, DevelopedLayer, LayerPlan};
use crate::load;
use crate::method;
use crate::output::{self, Output};
use crate::plan::Plan;
use crate::progress::{self, PhaseTimes, Watch};
use crate::report::Report;

/// What became of a render.
pub struct Rendered {
    /// The picture's sums.
    pub film: Film,
    /// What was done.
    pub statistics: Statistics,
    /// Names of the lights, in the order of the ledger.
    pub lights: Vec<String>,
    /// Whether any of them has power.
    pub has_light: bool,
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
    /// What of the scene may not be meant so.
    pub remarks: Vec<Diagnostic>,
    /// Further layers of the picture.
    pub layers: Vec<DevelopedLayer>,
    /// Threads that worked on it.
    pub threads: usize,
}

/// Why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// All passes or samples are done.
    Finished,
    /// The time is up.
    TimeIsUp,
    /// Ctrl-C.
    Interrupted,
}

/// Renders a scene.
pub fn run(args: &RenderArgs) -> Result<Exit, Failure> {
    let mut messages = Messages::new(args.quiet);
    let (scene, name) = match &args.scene {
        Some(scene) => (scene.as_path(), load::name(scene)),
        None => (Path::new(builtin::DEFAULT), OsString::from("nephroid")),
    };
    let outputs = output::outputs(&args.outputs, &name)?;
    let clock = Instant::now();
    let mut file = load::load(scene, &args.reading)?;
    for warning in &file.warnings {
        messages.diagnostic(warning);
    }
    let method = method::choose(args.integrator, &file, &args.photons, &mut messages)?;
    resize(&mut file, args.resolution, &mut messages)?;
    let layers = layers::choose(&args.aovs, &file.integrator.aovs, &method, &outputs, &mut messages)?;
    let plan = Plan::new(&args.limits, file.sample_count);
    let settings = RenderSettings { method, samples_per_pixel: plan.samples_per_pass, seed: args.seed };
    let reading = clock.elapsed();
    let visible = !args.quiet && !args.json && std::io::stderr().is_terminal();

    let rendered = pool(args.threads)?.install(|| render(file, &settings, &plan, &layers, visible))?;

    for remark in &rendered.remarks {
        messages.diagnostic(remark);
    }
    let writing = Instant::now();
    let outputs = write(&rendered, &outputs, args)?;
    let report = Report {
        scene: &scene.display().to_string(),
        settings: &settings,
        plan: &plan,
        rendered: &rendered,
        outputs: &outputs,
        reading,
        writing: writing.elapsed(),
    };
    report.check(&mut messages);
    if args.json {
        console::result(&format!("{}\n", report.json(&messages.list)))?;
    } else if !args.quiet {
        console::say(report.text().trim_end());
    }
    Ok(if rendered.ended == Ended::Interrupted { Exit::Stopped } else { Exit::Done })
}

/// So many threads, or one for each core.
pub fn pool(threads: Option<u16>) -> Result<rayon::ThreadPool, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, usize::from));
    pool.build().map_err(|e| Failure::Usage(format!("cannot start threads: {e}")))
}

/// Gives the picture another size, and refuses one that memory cannot hold.
pub fn resize(
    file: &mut SceneFile,
    resolution: Option<(u32, u32)>,
    messages: &mut Messages,
) -> Result<(), Failure> {
    let film = &mut file.scene.film;
    if let Some((width, height)) = resolution {
        if film.crop.take().is_some() {
            messages.warning("the scene's crop window is for another size: with --resolution it is ignored");
        }
        (film.width, film.height) = (width, height);
    }
    let window = film.window();
    if u64::from(window.width) * u64::from(window.height) > MAX_PIXELS {
        let (width, height) = (window.width, window.height);
        return Err(Failure::Usage(format!(
            "{width} by {height} pixels are too many: a picture has at most {MAX_PIXELS}; see --resolution"
        )));
    }
    Ok(())
}

fn render(
    file: SceneFile,
    settings: &RenderSettings,
    plan: &Plan,
    layers: &[LayerPlan],
    visible: bool,
) -> Result<Rendered, Failure> {
    let clock = Instant::now();
    let SceneFile { scene, origins, .. } = file;
    let world = load::world(scene, &origins)?;
    let preparing = clock.elapsed();
    let window = world.scene().film.window();
    let pixels = u64::from(window.width) * u64::from(window.height);
    let total = plan.total_samples().map(|n| n.saturating_mul(pixels));
    let watch = Watch::new(visible, plan.seconds, total, progress::listen()?);
    let aovs: Vec<_> = layers.iter().map(|layer| layer.aov).collect();
    let mut session = Session::new(&world, settings.clone(), &watch).with_aovs(&aovs);
    let ended = step_to_the_end(&mut session, plan, &watch);
    let (film, further) = session.picture();
    Ok(Rendered {
        film,
        statistics: session.statistics().clone(),
        remarks: load::remarks(&world, &origins),
        layers: layers::develop(layers, further.as_ref()),
        lights: world.lights().map(|(name, _)| name.to_owned()).collect(),
        has_light: has_light(&world),
        blind_to_specular: matches!(settings.method, Method::LightTracer(_))
            && LightTracerConfig::misses(&world),
        ended,
        rendering: watch.elapsed(),
        phases: watch.finish(),
        preparing,
        threads: rayon::current_num_threads(),
    })
}

fn step_to_the_end(session: &mut Session<'_>, plan: &Plan, watch: &Watch) -> Ended {
    loop {
        if !session.step(watch) {
            return if watch.interrupted() { Ended::Interrupted } else { Ended::TimeIsUp };
        }
        let statistics = session.statistics();
        let passes = statistics.iterations - u64::from(!session.iteration_is_complete());
        let enough = plan.samples.is_some_and(|n| statistics.samples_per_pixel >= n)
            || plan.passes.is_some_and(|n| passes >= n);
        if enough {
            return Ended::Finished;
        }
        if watch.time_is_up() {
            return Ended::TimeIsUp;
        }
    }
}

fn has_light(world: &World) -> bool {
    world.lights().any(|(_, power)| power.max_channel() > 0.0)
}

/// Writes what there is; nothing if not a single sample is.
fn write(rendered: &Rendered, outputs: &[Output], args: &RenderArgs) -> Result<Vec<Output>, Failure> {
    if rendered.film.iterations() == 0 {
        return Ok(Vec::new());
    }
    let image = rendered.film.develop();
    output::write_all(outputs, &image, &rendered.layers, &args.display.tonemap, args.display.exposure)?;
    Ok(outputs.to_vec())
}
