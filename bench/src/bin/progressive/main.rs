//! How errors of progressive photon mapping fall with CPU seconds, drawn as curves.
//!
//! `progressive [OPTIONS] SCENE.xml …`
//!
//! - `--marks 1,2,5,10,20,60,120`: CPU seconds, of all threads, at which the picture is looked at
//! - `--reference 600`: CPU seconds of what it is compared with, the mean of two renders with seeds of their own
//! - `--size 240`: pixels along both edges
//! - `--svg FILE`: where to draw the curves
//!
//! A table for each scene is printed. Time runs while the render is planned, photons are traced and pixels sampled.

mod plot;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use nephroid::color::Rgb;
use nephroid::film::ImageError;
use nephroid::integrator::{Method, PpmConfig};
use nephroid::observer::Silent;
use nephroid::session::{RenderSettings, Session};
use nephroid::texture::Image;
use nephroid::world::World;
use nephroid_bench::cpu_time;
use nephroid_formats::mitsuba::read_scene;
use nephroid_formats::Options;
use nephroid_formats::vfs::DiskFiles;

struct Arguments {
    marks: Vec<f64>,
    reference: f64,
    size: u32,
    svg: Option<PathBuf>,
    scenes: Vec<PathBuf>,
}

/// What was measured of a scene.
struct Curve {
    name: String,
    /// CPU seconds and relMSE, without the noise of the reference.
    points: Vec<(f64, f64)>,
}

fn main() -> ExitCode {
    match Arguments::read(std::env::args().skip(1)).and_then(|arguments| run(&arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("progressive: {message}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let mut curves = Vec::new();
    for scene in &arguments.scenes {
        curves.push(measure(scene, arguments)?);
        // Drawn anew after each scene, for the whole takes long.
        if let Some(svg) = &arguments.svg {
            plot::draw(svg, &curves)?;
        }
    }
    Ok(())
}

fn measure(path: &Path, arguments: &Arguments) -> Result<Curve, String> {
    let mut file = read_scene(path, &DiskFiles, &Options::default()).map_err(|e| e.to_string())?;
    (file.scene.film.width, file.scene.film.height) = (arguments.size, arguments.size);
    let world = World::new(file.scene).map_err(|e| format!("{}: {e}", path.display()))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let halves = [1, 2].map(|seed| {
        let mut run = Run::new(&world, seed);
        run.go_on(0.5 * arguments.reference);
        run.session.film().develop()
    });
    let reference = mean(&halves);
    let noise = rel_mse(&halves[0], &reference)?;
    println!("\n### {name}\n\nThe reference's own noise, {noise:.1e}, is taken off.\n");
    println!("| CPU s | passes | samples | relMSE | mean |\n|---:|---:|---:|---:|---:|");
    let mut curve = Curve { name, points: Vec::new() };
    let mut run = Run::new(&world, 0);
    for &mark in &arguments.marks {
        if !run.go_on(mark) {
            continue;
        }
        let picture = run.session.film().develop();
        let error = rel_mse(&picture, &reference)? - noise;
        let (seconds, statistics) = (run.spent.as_secs_f64(), run.session.statistics());
        println!(
            "| {seconds:.1} | {} | {} | {error:.5} | {:.4} |",
            statistics.iterations,
            statistics.samples_per_pixel,
            picture.mean().luminance() / reference.mean().luminance()
        );
        curve.points.push((seconds, error));
    }
    Ok(curve)
}

/// A render and the CPU time it took so far.
struct Run<'w> {
    session: Session<'w>,
    spent: Duration,
}

impl<'w> Run<'w> {
    fn new(world: &'w World, seed: u64) -> Self {
        let method = Method::Ppm(PpmConfig::default());
        let settings = RenderSettings { method, samples_per_pixel: 1, seed };
        let (mut session, observer) = (None, Silent);
        let spent = cpu_time(|| session = Some(Session::new(world, settings.clone(), &observer)));
        let session = session.unwrap_or_else(|| Session::new(world, settings, &observer));
        Self { session, spent }
    }

    /// Renders until so many CPU seconds are spent; returns false if they were already.
    fn go_on(&mut self, seconds: f64) -> bool {
        let before = self.session.statistics().iterations;
        while self.spent.as_secs_f64() < seconds || self.session.statistics().iterations == 0 {
            self.spent += cpu_time(|| {
                self.session.step(&Silent);
            });
        }
        self.session.statistics().iterations > before
    }
}

fn mean([a, b]: &[Image; 2]) -> Image {
    let pixels: Vec<Rgb> = a.pixels.iter().zip(&b.pixels).map(|(&a, &b)| (a + b) * 0.5).collect();
    Image { width: a.width, height: a.height, pixels }
}

fn rel_mse(image: &Image, reference: &Image) -> Result<f64, String> {
    let error = ImageError::between(image, reference, ImageError::EPSILON);
    error.map(|error| error.rel_mse).map_err(|e| e.to_string())
}

impl Arguments {
    fn read(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut arguments = Self {
            marks: vec![1.0, 2.0, 5.0, 10.0, 20.0, 60.0, 120.0],
            reference: 600.0,
            size: 240,
            svg: None,
            scenes: Vec::new(),
        };
        while let Some(word) = words.next() {
            if !word.starts_with("--") {
                arguments.scenes.push(word.into());
                continue;
            }
            let value = words.next().ok_or_else(|| format!("{word} needs a value"))?;
            let wrong = |e: &dyn std::fmt::Display| format!("{word} {value}: {e}");
            match word.as_str() {
                "--marks" => {
                    let marks: Result<_, _> = value.split(',').map(str::parse).collect();
                    arguments.marks = marks.map_err(|e| wrong(&e))?;
                }
                "--reference" => arguments.reference = value.parse().map_err(|e| wrong(&e))?,
                "--size" => arguments.size = value.parse().map_err(|e| wrong(&e))?,
                "--svg" => arguments.svg = Some(value.into()),
                _ => return Err(format!("no option is called {word}")),
            }
        }
        if arguments.scenes.is_empty() {
            return Err("which SCENE.xml?".to_string());
        }
        Ok(arguments)
    }
}
