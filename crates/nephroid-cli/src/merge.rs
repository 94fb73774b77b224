//! `nephroid merge`: parts of a render that were made apart, put together.

use std::ops::Range;
use std::path::{Path, PathBuf};

use nephroid::film::Quality;
use nephroid_formats::film_file::{FilmFile, FilmFileError, FilmHeader, FilmMerger, read_header};
use serde_json::{Value, json};

use crate::console::{self, Messages};
use crate::denoise::{self, Denoised};
use crate::exit::{Exit, Failure};
use crate::films;
use crate::job::{self, Job};
use crate::layers::{self, LayerFlag};
use crate::noise;
use crate::output::{self, Kind, Output, Picture};
use crate::quality;
use crate::session_args::MergeArgs;

/// Adds films up.
pub fn run(args: &MergeArgs) -> Result<Exit, Failure> {
    let mut messages = Messages::new(args.quiet);
    let outputs = output::outputs(&args.outputs)?;
    let denoiser = denoise::prepare(&args.denoise, &outputs, None)?;
    let FilmFile { header, film, aovs } = sum(&args.parts)?;
    let job = job_of_the_sum(&args.parts, &header, &outputs)?;
    let missing = missing(&header, &job);
    let in_words = |ranges: &[Range<u64>]| films::passes(ranges, header.samples_per_pass);
    if args.complete && (header.covered.is_empty() || !missing.is_empty()) {
        let missing = if missing.is_empty() { "every pass".to_owned() } else { in_words(&missing) };
        return Err(Failure::File(format!("--complete: nothing is written, for missing is {missing}")));
    }
    if header.covered.is_empty() {
        messages.warning("there is not one sample in the films: the pictures are black");
    } else if !missing.is_empty() {
        let missing = in_words(&missing);
        messages.warning(&format!("the pictures are of a part of the render: missing is {missing}"));
    }
    let writes_film = outputs.iter().any(|output| output.kind == Kind::Film);
    if writes_film && !is_one_piece(&header) {
        messages.note("what is missing has to be merged into the film before it can be gone on with");
    }
    if writes_film {
        job::check_names(job.outputs.iter().map(PathBuf::as_path))?;
    }
    let layers = layers::develop(&job.layers, aovs.as_ref());
    let pixels = quality::pixels_of(&header.identity, &job.plan);
    let quality = pixels.and_then(|pixels| Quality::of(&film, &header.convergence, pixels));
    let wants_error = job.args().is_ok_and(|args| args.aovs.contains(&LayerFlag::Error));
    let error = pixels
        .filter(|_| wants_error)
        .and_then(|pixels| Quality::of_pixels(&film, &header.convergence, pixels));
    let mut picture = Picture { image: film.develop(), noisy: None, error, layers };
    if denoiser.is_some() && !job.keeps_guides() {
        messages.note(denoise::NO_GUIDES);
    }
    let (denoised, trouble) = denoise::try_to(denoiser.as_ref(), &mut picture);
    let (outputs, more) = output::write_all(outputs, &picture, &args.display, &|path| {
        films::write(
            path,
            (&film, aovs.as_ref(), header.convergence),
            header.covered.clone(),
            &header.identity,
            &job,
        )
    });
    let trouble: Vec<String> = trouble.into_iter().chain(more).collect();
    messages.errors(&trouble);
    let noise = noise::noise(&film);
    if args.json {
        let numbers = |ranges: &[Range<u64>]| -> Vec<_> { ranges.iter().map(|r| [r.start, r.end]).collect() };
        let outputs: Vec<_> = outputs.iter().map(|o| o.path.display().to_string()).collect();
        let object = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "width": film.width(),
            "height": film.height(),
            "parts": args.parts.len(),
            "covered": numbers(header.covered.ranges()),
            "missing": numbers(&missing),
            "samples_per_pass": header.samples_per_pass,
            "samples_per_pixel": header.covered.total(),
            "noise": noise,
            "quality": quality.as_ref().map(quality::json),
            "mean_luminance": film.mean_luminance(),
            "denoised": denoised.as_ref().map(Denoised::json),
            "outputs": outputs,
            "messages": messages.list.into_iter().map(Value::from).collect::<Vec<_>>(),
        });
        console::result(&format!("{object}\n"))?;
    } else if !args.quiet {
        let good = match (&quality, noise) {
            (Some(quality), _) => format!(", {}", quality::text(quality)),
            (None, Some(noise)) => format!(", noise {}", noise::percent(noise)),
            (None, None) => String::new(),
        };
        console::say(&format!(
            "{} by {} pixels, {} samples each, {} of {} films{good}",
            film.width(),
            film.height(),
            header.covered.total(),
            films::passes(header.covered.ranges(), header.samples_per_pass),
            args.parts.len(),
        ));
        if let Some(denoised) = &denoised {
            console::say(&format!("denoised: {}", denoised.text()));
        }
    }
    Failure::of_files(trouble).map_or(Ok(Exit::Done), Err)
}

fn sum(parts: &[PathBuf]) -> Result<FilmFile, Failure> {
    let fail = |error: FilmFileError| Failure::File(error.to_string());
    let (first, others) =
        parts.split_first().ok_or_else(|| Failure::Usage("there are no films".to_owned()))?;
    let mut merger = FilmMerger::new(first).map_err(fail)?;
    for part in others {
        merger.add(part).map_err(fail)?;
    }
    Ok(merger.finish())
}

/// The job that its parts add up to: it writes the pictures that are written now, and took the time of all.
fn job_of_the_sum(parts: &[PathBuf], header: &FilmHeader, outputs: &[Output]) -> Result<Job, Failure> {
    let mut job = films::job_of(&parts[0], header)?;
    job.limits = job.limits.whole(header.covered.end().div_ceil(u64::from(header.samples_per_pass)));
    let pictures = outputs.iter().filter(|output| output.kind != Kind::Film);
    job.outputs = pictures.map(|output| absolute(&output.path)).collect();
    job.spent = 0.0;
    for part in parts {
        let header = read_header(part).map_err(|e| Failure::File(e.to_string()))?;
        job.spent += films::job_of(part, &header)?.spent;
    }
    Ok(job)
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

fn is_one_piece(header: &FilmHeader) -> bool {
    header.covered.gaps().is_empty() && !header.covered.is_empty()
}

/// Numbers of the samples of each pixel that the render should have and the films have not.
fn missing(header: &FilmHeader, job: &Job) -> Vec<Range<u64>> {
    let mut gaps = header.covered.gaps();
    if let Some(end) = job.limits.end(header.samples_per_pass).filter(|end| *end > header.covered.end()) {
        let begin = header.covered.end();
        gaps.push(begin..end);
    }
    gaps
}
