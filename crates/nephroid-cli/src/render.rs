//! `nephroid render`: from a scene to pictures.

use std::ffi::OsString;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::Instant;

use nephroid::film::Quality;
use nephroid::session::RenderSettings;
use nephroid_denoise::Denoiser;
use nephroid_formats::SceneFile;
use nephroid_formats::film_file::identity_differences;
use nephroid_formats::image::{MAX_PIXELS, check_writable};

use crate::args::{LimitArgs, RenderArgs};
use crate::builtin;
use crate::checkpoint::Checkpoint;
use crate::console::{self, Messages};
use crate::denoise::{self, Denoised};
use crate::exit::{Exit, Failure};
use crate::films::{self, Begun};
use crate::identity;
use crate::job::Order;
use crate::layers::{self, LayerFlag};
use crate::load;
use crate::method;
use crate::output::{self, Kind, Output, Picture};
use crate::plan::{Done, Plan};
use crate::preview::Previews;
use crate::quality;
use crate::rendering::{self, Companions, Ended, Rendered, Task};
use crate::report::Report;

/// Renders a scene.
pub fn run(args: &RenderArgs) -> Result<Exit, Failure> {
    let default = if args.outputs.is_empty() { output::default_names(&name(args)) } else { Vec::new() };
    go(args, &[args.outputs.as_slice(), &default].concat(), None)
}

/// What the pictures of a render are called.
pub fn name(args: &RenderArgs) -> OsString {
    args.scene.as_ref().map_or_else(|| OsString::from("nephroid"), |scene| load::name(scene))
}

/// Renders what the flags say into other outputs: from the start, or on with what was begun, to other limits if there are
/// any.
pub fn go(
    args: &RenderArgs,
    outputs: &[PathBuf],
    resumed: Option<(Begun, &LimitArgs)>,
) -> Result<Exit, Failure> {
    let mut messages = Messages::new(args.quiet);
    let scene = args.scene.as_deref().unwrap_or(Path::new(builtin::DEFAULT));
    let outputs = output::outputs(outputs)?;
    check_files(args, &outputs, resumed.is_some())?;
    let denoiser = denoise::prepare(&args.denoise, &outputs, args.threads)?;
    let mut previews = Previews::new(&args.watch, &name(args).to_string_lossy(), &args.display)?;
    let clock = Instant::now();
    let (file, task) = prepare(args, scene, &outputs, resumed, &mut messages)?;
    let (settings, plan) = (task.settings.clone(), task.plan);
    let kept = task.begun.as_ref().map(|begun| begun.covered.end);
    let every = args.session.checkpoint_every;
    let mut checkpoint = args.session.checkpoint.as_deref().map(|path| Checkpoint::new(path, every, kept));
    let reading = clock.elapsed();

    let companions =
        Companions { checkpoint: checkpoint.as_mut(), previews: &mut previews, messages: &mut messages };
    let rendered = pool(args.threads)?.install(|| rendering::render(file, task, companions))?;

    for remark in &rendered.remarks {
        messages.diagnostic(remark);
    }
    let writing = Instant::now();
    let (outputs, denoised, mut trouble) = write(&rendered, outputs, args, denoiser.as_ref());
    trouble.extend(checkpoint.as_ref().and_then(|checkpoint| checkpoint.trouble().map(str::to_owned)));
    let report = Report {
        scene: &scene.display().to_string(),
        settings: &settings,
        plan: &plan,
        rendered: &rendered,
        outputs: &outputs,
        denoised: denoised.as_ref(),
        wants_error: args.aovs.contains(&LayerFlag::Error),
        checkpoint: checkpoint.as_ref(),
        reading,
        writing: writing.elapsed(),
    };
    report.check(&mut messages);
    messages.errors(&trouble);
    if args.json {
        console::result(&format!("{}\n", report.json(&messages.list)))?;
    } else if !args.quiet {
        console::say(report.text().trim_end());
    }
    match Failure::of_files(trouble) {
        Some(failure) => Err(failure),
        None if rendered.ended == Ended::Interrupted => Ok(Exit::Stopped),
        None => Ok(Exit::Done),
    }
}

/// Reads the scene, and settles what is to be rendered of it.
fn prepare(
    args: &RenderArgs,
    scene: &Path,
    outputs: &[Output],
    resumed: Option<(Begun, &LimitArgs)>,
    messages: &mut Messages,
) -> Result<(SceneFile, Task), Failure> {
    let visible = !args.quiet && !args.json && std::io::stderr().is_terminal();
    let (mut file, files) = load::load_recorded(scene, &args.reading, visible)?;
    for warning in &file.warnings {
        messages.diagnostic(warning);
    }
    let method = method::choose(args.integrator, &file, &args.photons, method::Integrator::Auto, messages)?;
    resize(&mut file, args.resolution, messages)?;
    let checkpoint = args.session.checkpoint.as_deref();
    let keeps_layers = checkpoint.is_some() || outputs.iter().any(|output| output.kind != Kind::Png);
    // What a film keeps was decided when it was begun.
    let denoises = match &resumed {
        Some((begun, _)) => begun.job.keeps_guides(),
        None => args.denoise.denoise,
    };
    let keeps = (keeps_layers, denoises);
    let layers = layers::choose(&args.aovs, &file.integrator.aovs, &method, keeps, messages)?;
    let method = if layers::need_maps(&layers) { method::maps_only(method) } else { method };
    if args.denoise.denoise && !denoises {
        messages.note(denoise::NO_GUIDES);
    }
    let plan = match &resumed {
        Some((begun, limits)) => {
            let pixels = quality::pixels_of(&begun.identity, &begun.job.plan);
            let quality = pixels.and_then(|pixels| Quality::of(&begun.film, &begun.convergence, pixels));
            let done = Done {
                samples_per_pass: begun.job.plan.camera.samples_per_pixel,
                samples: begun.covered.end,
                error: quality.map(|quality| quality.interval[1]),
            };
            begun.job.limits.resumed(limits, begun.job.spent, &done)?
        }
        None => {
            let progressive = method.is_progressive();
            let whole = Plan::new(&args.limits, file.sample_count);
            whole.part(&args.limits, args.session.pass_range, progressive)?
        }
    };
    if plan.target_error.is_some() {
        quality::check(&method, "--target-error")?;
    }
    let settings = RenderSettings { method, samples_per_pixel: plan.samples_per_pass, seed: args.seed };
    let identity =
        identity::of_render(&files, &args.reading, &file.scene.film, &settings, args.clamp, &layers);
    let begun = resumed.map(|(begun, _)| begun);
    let keeps_films = checkpoint.is_some() || outputs.iter().any(|output| output.kind == Kind::Film);
    let order = match &begun {
        Some(begun) => {
            check_same(begun, &identity)?;
            Some(begun.job.order())
        }
        None if keeps_films => {
            let paths: Vec<PathBuf> = outputs.iter().map(|output| output.path.clone()).collect();
            Some(Order::of_this_process(scene, &paths)?)
        }
        None => None,
    };
    if let (Some(path), None) = (checkpoint, &begun) {
        films::refuse_to_replace(path, &identity)?;
    }
    let (clamp, flags) = (args.clamp, args.photons.names());
    let wants_error = args.aovs.contains(&LayerFlag::Error);
    Ok((file, Task { settings, flags, plan, clamp, layers, wants_error, identity, order, begun, visible }))
}

/// The checkpoint could be written, and no file is to be written as two things. What is gone on with may have any name.
fn check_files(args: &RenderArgs, outputs: &[Output], resumes: bool) -> Result<(), Failure> {
    let checkpoint = args.session.checkpoint.as_deref();
    let written = outputs.iter().map(|output| (output.path.as_path(), "-o"));
    let kept = checkpoint.map(|path| (path, "--checkpoint"));
    let shown = args.watch.preview.as_deref().map(|path| (path, "--preview"));
    output::all_differ(written.chain(kept).chain(shown))?;
    let Some(path) = checkpoint else { return Ok(()) };
    if !resumes {
        Output::of_kind(path, Kind::Film)?;
    }
    check_writable(path).map_err(|e| Failure::File(e.to_string()))
}

/// What was begun is still the same render.
fn check_same(begun: &Begun, identity: &identity::Identity) -> Result<(), Failure> {
    let (name, then) = (begun.path.display().to_string(), identity::without_plan(&begun.identity));
    let differences = identity_differences((&name, &then), ("the render now", identity));
    if differences.is_empty() {
        return Ok(());
    }
    let differences = differences.join("; ");
    Err(Failure::File(format!(
        "{name}: cannot be gone on with: it would be another picture from here on. What has changed since it was begun, \
         then and now: {differences}"
    )))
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

/// Writes what there is; nothing if not a single sample is, and no film if there are not the first of every pixel.
/// Gives what was written, by what it was denoised, and why the rest could not be.
fn write(
    rendered: &Rendered,
    mut outputs: Vec<Output>,
    args: &RenderArgs,
    denoiser: Option<&Denoiser>,
) -> (Vec<Output>, Option<Denoised>, Vec<String>) {
    if !rendered.has_picture() {
        return (Vec::new(), None, Vec::new());
    }
    outputs.retain(|output| output.kind != Kind::Film || rendered.has_film());
    let (film, further) = &rendered.picture;
    let layers = layers::develop(&rendered.layers, further.as_ref());
    let error = rendered.error_image.clone();
    let mut picture = Picture { image: film.develop(), noisy: None, error, layers };
    let (denoised, trouble) = denoise::try_to(denoiser, &mut picture);
    let (outputs, more) =
        output::write_all(outputs, &picture, &args.display, &|path| rendered.write_film(path));
    (outputs, denoised, trouble.into_iter().chain(more).collect())
}
