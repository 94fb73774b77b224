//! How long each integrator takes to come near a reference, and how far `auto`, which chooses one of them, stays behind the
//! one that was best.
//!
//! `choices [OPTIONS] SCENE.xml REFERENCE.exr …`, as many pairs as wanted. A pair of folders stands for all scenes of the
//! one that have a reference of the same name in the other. A reference `A.exr,B.exr` is the mean of two that are
//! independent of one another; its own noise is then known, and taken off. Scenes are rendered at the reference's size.
//!
//! - `--methods path,ptracer,ppm,vcm,auto`: integrators, each with its defaults and the scene's `max_depth`; without it
//!   those of this list that there are; in media `path` is `volpath`
//! - `--target 0.01`: the error to reach, E² = mean of (a − t)² / (t² + (0.1 m)²) over the pixels, where a is a pixel's
//!   luminance, t the reference's and m the mean of that, without the pixel in a thousand where it is largest: one bright
//!   sample must not decide; or
//! - `--at 10`: CPU seconds after which errors are compared, and not times
//! - `--limit 60`: CPU seconds after which an integrator gives up
//! - `--patience 8`: it gives up sooner where it has taken so many times as long as the best before it
//! - `--seeds 1`: renders of each; the median is shown
//! - `--spp 1`: camera samples of each pixel in an iteration, of integrators that do not choose it
//!
//! Prints a table: for each scene the CPU seconds, of all threads, that each integrator took (or E² × 1000 with `--at`), which
//! was best, and how many times as much `auto` needed as the best of the others. `> 60 (4e-2)` gave up at an error² of .04.
//! Behind what `auto` took stands what it chose; its reason goes to the standard error.
//!
//! Time runs while a render is planned, photons are traced and pixels sampled; reading files, preparing the world and
//! comparing pictures is not counted. A picture is looked at when marks have passed that grow by a tenth, or after the last
//! step with `--at`; when the error was reached between two looks follows from a line through both.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use nephroid::integrator::Pick;
use nephroid::observer::Silent;
use nephroid::session::{RenderSettings, Session};
use nephroid::world::World;
use nephroid_bench::cpu_time;
use nephroid_bench::methods::{known_names, max_depth, method};
use nephroid_bench::reference::{Reference, pairs_of_folders};
use nephroid_formats::mitsuba::read_scene;
use nephroid_formats::Options;
use nephroid_formats::vfs::DiskFiles;

/// The integrators compared, where they exist.
const METHODS: [&str; 5] = ["path", "ptracer", "ppm", "vcm", "auto"];

/// The integrator that is judged by the others.
const JUDGED: &str = "auto";

/// What may be given beside scenes and references.
const OPTIONS: [&str; 7] = ["--methods", "--target", "--at", "--limit", "--patience", "--seeds", "--spp"];

/// The first mark in CPU seconds, and how much later each next one is.
const FIRST_LOOK: f64 = 0.1;
const NEXT_LOOK: f64 = 1.1;

/// When a render has done enough.
#[derive(Clone, Copy, Debug)]
enum Goal {
    /// At this error, or after so many CPU seconds.
    Error { target: f64, limit: f64 },
    /// After so many CPU seconds.
    Time(f64),
}

struct Arguments {
    methods: Vec<String>,
    goal: Goal,
    patience: f64,
    seeds: u64,
    samples_per_pixel: u32,
    /// Scenes and their references.
    pairs: Vec<(PathBuf, String)>,
}

/// How a render ended.
#[derive(Clone, Copy, Debug)]
struct End {
    cpu: f64,
    error_sq: f64,
    /// What was chosen, of an integrator that does.
    pick: Option<Pick>,
}

fn main() -> ExitCode {
    match Arguments::read(std::env::args().skip(1)).and_then(|arguments| run(&arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("choices: {message}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let names = arguments.methods.join(" | ");
    let judged = arguments.methods.iter().any(|name| name == JUDGED);
    let rest = if judged { " | auto / best" } else { "" };
    println!("| scene | {names} | best{rest} |");
    println!("|---|{}---|{}", "---:|".repeat(arguments.methods.len()), if judged { "---:|" } else { "" });
    for (scene, reference) in &arguments.pairs {
        println!("{}", row(scene, &Reference::read(reference)?, arguments)?);
    }
    Ok(())
}

/// A scene's row.
fn row(path: &Path, reference: &Reference, arguments: &Arguments) -> Result<String, String> {
    let mut file = read_scene(path, &DiskFiles, &Options::default()).map_err(|e| e.to_string())?;
    let max_depth = max_depth(&file)?;
    [file.scene.film.width, file.scene.film.height] = reference.size();
    let world = World::new(file.scene).map_err(|e| format!("{}: {e}", path.display()))?;
    let (mut cells, mut costs) = (Vec::new(), Vec::new());
    let mut best = f64::INFINITY;
    for name in &arguments.methods {
        let called = if name == "path" && world.has_media() { "volpath" } else { name };
        let method = method(called, max_depth).ok_or("no such integrator")?;
        let goal = arguments.goal.within(arguments.patience * best);
        let ends: Result<Vec<End>, String> = (0..arguments.seeds)
            .map(|seed| {
                let samples_per_pixel = arguments.samples_per_pixel;
                let settings = RenderSettings { method: method.clone(), samples_per_pixel, seed };
                render(&world, settings, reference, goal)
            })
            .collect();
        let (cell, cost) = goal.judge(ends?);
        best = best.min(cost);
        cells.push(cell);
        costs.push((name.as_str(), cost));
    }
    let scene = path.file_stem().unwrap_or_default().to_string_lossy();
    Ok(format!("| {scene} | {} | {} |", cells.join(" | "), verdict(&costs)))
}

/// The best of the integrators but the one that is judged, and what that costs in comparison, if it is there.
fn verdict(costs: &[(&str, f64)]) -> String {
    let others = costs.iter().filter(|(name, cost)| *name != JUDGED && cost.is_finite());
    let best = others.min_by(|a, b| a.1.total_cmp(&b.1));
    let judged = costs.iter().find(|(name, _)| *name == JUDGED);
    let name = best.map_or("–", |(name, _)| name);
    match (best, judged) {
        (_, None) => name.to_string(),
        (Some((_, best)), Some((_, judged))) if judged.is_finite() => {
            format!("{name} | {:.2}", judged / best)
        }
        _ => format!("{name} | –"),
    }
}

/// Renders to the goal.
fn render(world: &World, settings: RenderSettings, reference: &Reference, goal: Goal) -> Result<End, String> {
    let (mut session, mut cpu) = (None, Duration::ZERO);
    cpu += cpu_time(|| session = Some(Session::new(world, settings, &Silent)));
    let mut session = session.ok_or("no session")?;
    let choice = session.plan().choice;
    if let Some(choice) = &choice {
        eprintln!("after {:.2} s: {}", cpu.as_secs_f64(), choice.reason());
    }
    let pick = choice.map(|choice| choice.pick);
    let (mut mark, mut before) = (FIRST_LOOK, None);
    loop {
        let mut goes_on = true;
        cpu += cpu_time(|| goes_on = session.step(&Silent));
        if !goes_on {
            return Err("a render stopped by itself".to_string());
        }
        let now = cpu.as_secs_f64();
        let is_last = goal.is_out_of_time(now);
        if now < mark || !(is_last || goal.asks_for_errors()) {
            continue;
        }
        while mark <= now {
            mark *= NEXT_LOOK;
        }
        let error_sq = reference.error_sq(&session.film().develop())?;
        let end = End { cpu: now, error_sq, pick };
        if goal.is_reached(error_sq) {
            return Ok(before.map_or(end, |before| goal.between(before, end)));
        }
        if is_last {
            return Ok(end);
        }
        before = Some(end);
    }
}

/// In a word.
fn name_of(pick: Pick) -> &'static str {
    match pick {
        Pick::Path => "path",
        Pick::Ppm => "ppm",
        Pick::Vcm { connections: true } => "vcm",
        Pick::Vcm { connections: false } => "vcm, only merging",
    }
}

impl Goal {
    fn asks_for_errors(self) -> bool {
        matches!(self, Self::Error { .. })
    }

    fn is_reached(self, error_sq: f64) -> bool {
        matches!(self, Self::Error { target, .. } if error_sq <= target)
    }

    /// The same with no more time than this. Where times are compared by errors all take the same.
    fn within(self, seconds: f64) -> Self {
        match self {
            Self::Error { target, limit } => Self::Error { target, limit: limit.min(seconds) },
            Self::Time(_) => self,
        }
    }

    /// When the target was reached that one look missed and the next met, if errors fall evenly between.
    fn between(self, missed: End, met: End) -> End {
        let Self::Error { target, .. } = self else { return met };
        let part = (missed.error_sq - target) / (missed.error_sq - met.error_sq);
        End { cpu: missed.cpu + part.clamp(0.0, 1.0) * (met.cpu - missed.cpu), error_sq: target, ..met }
    }

    fn is_out_of_time(self, cpu: f64) -> bool {
        let (Self::Error { limit, .. } | Self::Time(limit)) = self;
        cpu >= limit
    }

    /// What the table shows of some renders, and the number that integrators are compared by: infinite if it gave up.
    fn judge(self, mut ends: Vec<End>) -> (String, f64) {
        let chosen = |end: &End| end.pick.map_or(String::new(), |pick| format!(" ({})", name_of(pick)));
        match self {
            Self::Time(_) => {
                ends.sort_by(|a, b| a.error_sq.total_cmp(&b.error_sq));
                let median = ends[ends.len() / 2];
                (format!("{:.3}{}", 1e3 * median.error_sq, chosen(&median)), median.error_sq)
            }
            Self::Error { limit, .. } => {
                let cost = |end: &End| if self.is_reached(end.error_sq) { end.cpu } else { f64::INFINITY };
                ends.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
                let end = ends[ends.len() / 2];
                let cell = if cost(&end).is_finite() {
                    format!("{:.2}{}", end.cpu, chosen(&end))
                } else {
                    format!("> {limit:.0} ({:.0e}){}", end.error_sq, chosen(&end))
                };
                (cell, cost(&end))
            }
        }
    }
}

impl Arguments {
    fn read(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let known = METHODS.iter().filter(|name| method(name, None).is_some());
        let mut arguments = Self {
            methods: known.map(|name| (*name).to_string()).collect(),
            goal: Goal::Time(0.0),
            patience: 8.0,
            seeds: 1,
            samples_per_pixel: 1,
            pairs: Vec::new(),
        };
        let (mut target, mut at, mut limit) = (0.01, None, 60.0);
        while let Some(word) = words.next() {
            if word.starts_with("--") && !OPTIONS.contains(&word.as_str()) {
                return Err(format!("no option is called {word}"));
            }
            let value = words.next().ok_or_else(|| format!("{word} needs a value or a reference"))?;
            let wrong = |e: &dyn std::fmt::Display| format!("{word} {value}: {e}");
            match word.as_str() {
                "--methods" => arguments.methods = known_names(&value)?,
                "--target" => target = value.parse().map_err(|e| wrong(&e))?,
                "--at" => at = Some(value.parse().map_err(|e| wrong(&e))?),
                "--limit" => limit = value.parse().map_err(|e| wrong(&e))?,
                "--patience" => arguments.patience = value.parse().map_err(|e| wrong(&e))?,
                "--seeds" => arguments.seeds = value.parse::<u64>().map_err(|e| wrong(&e))?.max(1),
                "--spp" => arguments.samples_per_pixel = value.parse().map_err(|e| wrong(&e))?,
                scene if Path::new(scene).is_dir() => {
                    arguments.pairs.extend(pairs_of_folders(Path::new(scene), Path::new(&value))?);
                }
                scene => arguments.pairs.push((PathBuf::from(scene), value)),
            }
        }
        if arguments.pairs.is_empty() {
            return Err("which SCENE.xml, and which REFERENCE.exr?".to_string());
        }
        arguments.goal = at.map_or(Goal::Error { target, limit }, Goal::Time);
        Ok(arguments)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_between_two_looks_is_reached_between_them() {
        let goal = Goal::Error { target: 0.01, limit: 60.0 };
        let at = |cpu, error_sq| End { cpu, error_sq, pick: None };
        let end = goal.between(at(1.0, 0.016), at(1.3, 0.007));
        assert!((end.cpu - 1.2).abs() < 1e-9, "{}", end.cpu);
    }

    #[test]
    fn auto_is_judged_by_the_best_of_the_others() {
        let costs = [("path", 9.0), ("ppm", 4.0), ("vcm", f64::INFINITY), (JUDGED, 6.0)];
        assert_eq!(verdict(&costs), "ppm | 1.50");
        assert_eq!(verdict(&costs[..3]), "ppm");
        assert_eq!(verdict(&[("path", f64::INFINITY), (JUDGED, 6.0)]), "– | –");
    }
}
