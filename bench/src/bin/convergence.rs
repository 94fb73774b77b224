//! Errors of whole renders against CPU seconds: how fast each integrator comes near a reference.
//!
//! `convergence [OPTIONS] SCENE.xml REFERENCE.exr …`, as many pairs as wanted. A pair of folders stands for all scenes of
//! the one that have a reference of the same name in the other. A reference `A.exr,B.exr` is the mean of two that are
//! independent of one another; its own noise is then known, and taken off. Errors are relMSE, of all pixels and without the
//! pixel in a thousand where it is largest.
//!
//! - `--methods photonmapper,path`: integrators, each with its defaults and the scene's `max_depth`
//! - `--spp 8`: camera samples of each pixel in an iteration; iterations follow one another without end
//! - `--marks 1,2,5,10,20,30,60`: CPU seconds, of all threads, at which the picture is looked at
//! - `--seed 0`
//! - `--csv FILE`: the table once more
//! - `--denoise`: looks at the denoised picture, too: by Open Image Denoise, found as the command finds it, with albedo and
//!   normal. Where it is missing, that is told, and nothing is denoised
//!
//! Time runs while photons are traced and pixels sampled. Reading files, preparing the world, denoising and comparing
//! pictures is not counted; with `--denoise` keeping albedo and normal is. A picture is looked at after the first step that ends at a mark or behind it; where it passes several, once.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use nephroid::integrator::Method;
use nephroid::observer::Silent;
use nephroid::session::{RenderSettings, Session};
use nephroid::world::World;
use nephroid_bench::cpu_time;
use nephroid_bench::denoise::{self, GUIDES, denoised};
use nephroid_bench::methods::{known_names, max_depth, method};
use nephroid_bench::reference::{Comparison, Reference, pairs_of_folders};
use nephroid_denoise::Denoiser;
use nephroid_formats::mitsuba::read_scene;
use nephroid_formats::Options;
use nephroid_formats::vfs::DiskFiles;

/// What may be given beside scenes and references.
const OPTIONS: [&str; 5] = ["--methods", "--spp", "--marks", "--seed", "--csv"];

struct Arguments {
    methods: Vec<String>,
    samples_per_pixel: u32,
    marks: Vec<f64>,
    seed: u64,
    csv: Option<PathBuf>,
    denoise: bool,
    /// Scenes and their references.
    pairs: Vec<(PathBuf, String)>,
}

fn main() -> ExitCode {
    match Arguments::read(std::env::args().skip(1)).and_then(|arguments| run(&arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("convergence: {message}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let denoiser = arguments.denoise.then(denoise::find).and_then(|found| {
        found.map_err(|why| eprintln!("convergence: nothing is denoised: {why} (pip install pyoidn)")).ok()
    });
    let more = if denoiser.is_some() { ",denoised,denoised_without_worst" } else { "" };
    let mut csv =
        format!("scene,method,cpu_s,iterations,samples,rel_mse,without_worst,noise,mean_ratio{more}\n");
    for (scene, reference) in &arguments.pairs {
        csv += &report(scene, &Reference::read(reference)?, arguments, denoiser.as_ref())?;
        if let Some(path) = &arguments.csv {
            std::fs::write(path, &csv).map_err(|e| format!("{}: {e}", path.display()))?;
        }
    }
    Ok(())
}

/// Prints a scene's table; returns the same for the CSV file.
fn report(
    path: &Path,
    reference: &Reference,
    arguments: &Arguments,
    denoiser: Option<&Denoiser>,
) -> Result<String, String> {
    let file = read_scene(path, &DiskFiles, &Options::default()).map_err(|e| e.to_string())?;
    let max_depth = max_depth(&file)?;
    let world = World::new(file.scene).map_err(|e| format!("{}: {e}", path.display()))?;
    let scene = path.file_stem().unwrap_or_default().to_string_lossy();
    println!("\n### {scene}\n");
    match reference.noise() {
        Some(noise) => println!("The reference's own noise, {noise:.1e}, is taken off.\n"),
        None => println!("The reference's own noise is not known and not taken off.\n"),
    }
    let [more, rule] =
        if denoiser.is_some() { [" denoised | without worst |", "---:|---:|"] } else { ["", ""] };
    println!("| method | CPU s | iterations | samples | relMSE | without worst | mean |{more}");
    println!("|---|---:|---:|---:|---:|---:|---:|{rule}");
    let noise = reference.noise().map(|noise| format!("{noise:.6}")).unwrap_or_default();
    let mut csv = String::new();
    for name in &arguments.methods {
        let method = method(name, max_depth).ok_or("no such integrator")?;
        converge(&world, method, reference, (arguments, denoiser), |row| {
            let Row { cpu, iterations, samples, found, denoised } = row;
            let Comparison { rel_mse, without_worst, mean_ratio } = found;
            let [cell, field] = denoised.map_or([String::new(), String::new()], |error| {
                let (all, rest) = (error.rel_mse, error.without_worst);
                [format!(" {all:.5} | {rest:.5} |"), format!(",{all:.6},{rest:.6}")]
            });
            println!(
                "| {name} | {cpu:.2} | {iterations} | {samples} | {rel_mse:.5} | {without_worst:.5} | {mean_ratio:.4} |{cell}"
            );
            csv += &format!(
                "{scene},{name},{cpu:.3},{iterations},{samples},{rel_mse:.6},{without_worst:.6},{noise},{mean_ratio:.5}{field}\n"
            );
        })?;
    }
    Ok(csv)
}

/// A picture at a mark.
struct Row {
    cpu: f64,
    iterations: u64,
    samples: u64,
    found: Comparison,
    /// Of the denoised picture, where there is a denoiser.
    denoised: Option<Comparison>,
}

/// Renders until the last mark, and shows the picture at each, unless that was seen already.
fn converge(
    world: &World,
    method: Method,
    reference: &Reference,
    (arguments, denoiser): (&Arguments, Option<&Denoiser>),
    mut seen: impl FnMut(Row),
) -> Result<(), String> {
    let Arguments { samples_per_pixel, marks, seed, .. } = arguments;
    let settings = RenderSettings { method, samples_per_pixel: *samples_per_pixel, seed: *seed };
    let (mut session, mut cpu) = (None, Duration::ZERO);
    cpu += cpu_time(|| session = Some(Session::new(world, settings, &Silent)));
    let mut session = session.ok_or("no session")?;
    if denoiser.is_some() {
        session = session.with_aovs(&GUIDES);
    }
    if let Some(choice) = &session.plan().choice {
        eprintln!("after {:.2} s: {}", cpu.as_secs_f64(), choice.reason());
    }
    let mut shown = None;
    for &mark in marks {
        while cpu.as_secs_f64() < mark {
            cpu += cpu_time(|| {
                session.step(&Silent);
            });
        }
        if shown.replace(cpu) == Some(cpu) {
            continue;
        }
        let found = reference.compare(&session.film().develop())?;
        let denoised = denoiser.map(|denoiser| denoised(denoiser, &session)).transpose()?;
        let denoised = denoised.map(|picture| reference.compare(&picture)).transpose()?;
        let statistics = session.statistics();
        seen(Row {
            cpu: cpu.as_secs_f64(),
            iterations: statistics.iterations,
            samples: statistics.samples_per_pixel,
            found,
            denoised,
        });
    }
    Ok(())
}

impl Arguments {
    fn read(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut arguments = Self {
            methods: vec!["photonmapper".to_string()],
            samples_per_pixel: 8,
            marks: vec![1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0],
            seed: 0,
            csv: None,
            denoise: false,
            pairs: Vec::new(),
        };
        while let Some(word) = words.next() {
            if word == "--denoise" {
                arguments.denoise = true;
                continue;
            }
            if word.starts_with("--") && !OPTIONS.contains(&word.as_str()) {
                return Err(format!("no option is called {word}"));
            }
            let value = words.next().ok_or_else(|| format!("{word} needs a value or a reference"))?;
            let wrong = |e: &dyn std::fmt::Display| format!("{word} {value}: {e}");
            match word.as_str() {
                "--methods" => arguments.methods = known_names(&value)?,
                "--spp" => arguments.samples_per_pixel = value.parse().map_err(|e| wrong(&e))?,
                "--marks" => {
                    let marks: Result<_, _> = value.split(',').map(str::parse).collect();
                    arguments.marks = marks.map_err(|e| wrong(&e))?;
                }
                "--seed" => arguments.seed = value.parse().map_err(|e| wrong(&e))?,
                "--csv" => arguments.csv = Some(PathBuf::from(value)),
                scene if Path::new(scene).is_dir() => {
                    arguments.pairs.extend(pairs_of_folders(Path::new(scene), Path::new(&value))?);
                }
                scene => arguments.pairs.push((PathBuf::from(scene), value)),
            }
        }
        if arguments.pairs.is_empty() {
            return Err("which SCENE.xml, and which REFERENCE.exr?".to_string());
        }
        Ok(arguments)
    }
}
