//! The page.

use askama::Template;

use crate::body::Part;
use crate::keep::Finished;
use crate::section::Section;
use crate::sections::SECTIONS;
use crate::study::Settings;

#[derive(Template)]
#[template(path = "page.html")]
struct Page<'a> {
    finished: &'a [(&'static Section, Finished)],
    missing: Vec<&'static Section>,
    numbers: usize,
    broken: usize,
    command: String,
    quick: bool,
    seed: u64,
    version: &'static str,
}

/// The page of all sections that there are.
pub fn render(
    finished: &[(&'static Section, Finished)],
    settings: &Settings,
) -> Result<String, askama::Error> {
    let is_missing = |section: &&Section| finished.iter().all(|(own, _)| own.id != section.id);
    let numbers = || finished.iter().flat_map(|(_, finished)| finished.body.all_numbers());
    let page = Page {
        finished,
        missing: SECTIONS.iter().filter(is_missing).collect(),
        numbers: numbers().filter(|number| number.band.is_some()).count(),
        broken: numbers().filter(|number| !number.holds()).count(),
        command: command(settings),
        quick: settings.quick,
        seed: settings.seed,
        version: env!("CARGO_PKG_VERSION"),
    };
    page.render()
}

/// What makes the whole page again.
fn command(settings: &Settings) -> String {
    let quick = if settings.quick { " --quick" } else { "" };
    let seed = if settings.seed == 0 { String::new() } else { format!(" --seed {}", settings.seed) };
    format!("nephroid study{quick}{seed}")
}
