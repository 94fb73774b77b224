//! `nephroid study`: the experiments of a report, as a web page.

use std::fs;

use nephroid::session::RenderSettings;
use nephroid_study::{Command, Settings, Study, Task, Trouble, run as run_study, select};

use crate::args::{self, StudyArgs};
use crate::console::{self, Messages};
use crate::exit::{Exit, Failure};
use crate::identity::fingerprint;
use crate::load;
use crate::method::{self, Integrator};
use crate::plan::Plan;
use crate::progress;
use crate::render;
use crate::study_watch::StudyWatch;

/// Runs it, and writes the page.
pub fn run(args: &StudyArgs) -> Result<Exit, Failure> {
    let sections = select(&args.only).map_err(failure)?;
    let settings =
        Settings { folder: args.folder.clone(), quick: args.quick, seed: args.seed, program: this_program() };
    let watch = StudyWatch::new(!args.quiet && !args.json, progress::listen()?);
    let pool = render::pool(args.threads)?;
    let study = pool.install(|| run_study(&settings, &sections, &CommandLine, &watch));
    watch.finish();
    let study = study.map_err(failure)?;
    if args.json {
        console::result(&format!("{}\n", study.json()))?;
    } else if !args.quiet {
        summarise(&study);
    }
    if study.stopped {
        return Ok(Exit::Stopped);
    }
    let broken = study.broken();
    if broken.is_empty() {
        return Ok(Exit::Done);
    }
    let list: Vec<String> = broken.iter().map(|line| format!("  {line}")).collect();
    let count = broken.len();
    Err(Failure::Study(format!(
        "{count} of the study's numbers lie outside of their bands:\n{}",
        list.join("\n")
    )))
}

fn summarise(study: &Study) {
    let numbers =
        study.finished.iter().map(|(_, finished)| finished.body.all_numbers().count()).sum::<usize>();
    let megabytes = study.bytes as f64 / 1e6;
    let sections = study.finished.len();
    console::say(&format!(
        "{}: {sections} sections, {numbers} numbers, {megabytes:.1} MB",
        study.page.display()
    ));
    if study.stopped {
        console::say("stopped: the same command goes on with the section that was not finished");
    }
}

fn failure(trouble: Trouble) -> Failure {
    match trouble {
        Trouble::Unknown(message) => Failure::Usage(message),
        Trouble::File(message) => Failure::File(message),
        Trouble::Section(message) => Failure::Study(message),
    }
}

/// What tells this program from one that computes something else: its version, and its bytes where they can be read.
fn this_program() -> String {
    let bytes = std::env::current_exe().and_then(fs::read);
    let own = bytes.map_or(String::new(), |bytes| format!("-{}", &fingerprint(&bytes)[..16]));
    format!("{}{own}", env!("CARGO_PKG_VERSION"))
}

/// The command line of `render`.
struct CommandLine;

impl Command for CommandLine {
    fn read(&self, arguments: &[String]) -> Result<Task, String> {
        let words: Vec<String> =
            std::iter::once("render".to_owned()).chain(arguments.iter().cloned()).collect();
        let args = args::of_render(&words)?;
        let scene = args.scene.as_deref().ok_or("it names no scene")?;
        // Nobody is asked, and what a scene warns of is no news here.
        let mut messages = Messages::new(true);
        let mut file = load::load(scene, &args.reading, false).map_err(text)?;
        let method = method::choose(args.integrator, &file, &args.photons, Integrator::Auto, &mut messages)
            .map_err(text)?;
        render::resize(&mut file, args.resolution, &mut messages).map_err(text)?;
        let plan = Plan::new(&args.limits, file.sample_count);
        if plan.seconds.is_some() || plan.target_error.is_some() {
            return Err("a study is the same on every machine: no --time and no --target-error".to_owned());
        }
        let settings = RenderSettings { method, samples_per_pixel: plan.samples_per_pass, seed: args.seed };
        Ok(Task { scene: file.scene, settings, samples: plan.samples, passes: plan.passes })
    }
}

fn text(failure: Failure) -> String {
    match failure {
        Failure::Usage(message) | Failure::File(message) | Failure::Study(message) => message,
        Failure::Scene(diagnostics) => {
            let lines: Vec<String> = diagnostics.0.iter().map(ToString::to_string).collect();
            lines.join("\n")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recipe_is_a_command_line() {
        let read = |text: &str| {
            let words: Vec<String> = text.split(' ').map(str::to_owned).collect();
            CommandLine.read(&words)
        };
        let task = read("report-2-6 -D photons=77 -D width=8 -D spp=4 --seed 5").unwrap();
        assert_eq!((task.settings.seed, task.samples, task.passes), (5, Some(4), None));
        assert_eq!(task.settings.method.mapper().map(|mapper| mapper.photons), Some(77));
        assert_eq!(task.scene.film.width, 8);
        assert!(read("report-2-6 --time 3").unwrap_err().contains("--time"));
        assert!(read("report-2-66").unwrap_err().contains("report-2-6"));
        assert!(read("report-2-6 --no-such-flag").is_err());
    }
}
