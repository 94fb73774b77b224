use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::time::Instant;

use nephroid_formats::diagnostic::closest;
use serde_json::{Value, json};

use crate::keep::{Finished, Keeper, Key, write_whole};
use crate::lab::{Lab, Watch};
use crate::page;
use crate::recipe::Command;
use crate::section::{Section, Stop};
use crate::sections::SECTIONS;

/// The page is smaller than this, in bytes, so that it opens on a phone and can be sent.
pub const MOST_BYTES: usize = 20_000_000;

/// How a study is made.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Where the page is written, and sections are kept.
    pub folder: PathBuf,
    /// Small pictures, for a test of everything.
    pub quick: bool,
    /// Everything random follows from it.
    pub seed: u64,
    /// What computes: sections of another program are not gone on with.
    pub program: String,
}

/// Why a study could not be made.
#[derive(Debug, thiserror::Error)]
pub enum Trouble {
    /// A section of that name is not there.
    #[error("{0}")]
    Unknown(String),
    /// A file cannot be written.
    #[error("{0}")]
    File(String),
    /// A section cannot be computed.
    #[error("{0}")]
    Section(String),
}

impl Trouble {
    /// What went wrong with a file.
    pub fn file(path: &Path, error: impl Display) -> Self {
        Self::File(format!("{}: cannot be written: {error}", path.display()))
    }
}

/// What there is of a study.
#[derive(Clone, Debug)]
pub struct Study {
    /// The page that was written.
    pub page: PathBuf,
    /// How large it is.
    pub bytes: usize,
    /// Whether it was stopped before its end.
    pub stopped: bool,
    /// The sections that were asked for and are in the page, with what they found. What the page has besides, from runs
    /// before, is not judged here.
    pub finished: Vec<(&'static Section, Finished)>,
    quick: bool,
    seed: u64,
}

/// The sections of these names, in the order of the page; all of them where none is named.
pub fn select(ids: &[String]) -> Result<Vec<&'static Section>, Trouble> {
    for id in ids {
        if !SECTIONS.iter().any(|section| section.id == id) {
            let known = SECTIONS.iter().map(|section| section.id);
            let message = format!("the study has no section \"{id}\"");
            let list = || known.clone().collect::<Vec<_>>().join(", ");
            return Err(Trouble::Unknown(match closest(id, known.clone()) {
                Some(near) => format!("{message}; did you mean \"{near}\"? There are {}", list()),
                None => format!("{message}; there are {}", list()),
            }));
        }
    }
    Ok(SECTIONS.iter().filter(|section| ids.is_empty() || ids.iter().any(|id| id == section.id)).collect())
}

/// Runs those sections that are not kept from before, and writes the page of all that there is.
pub fn run(
    settings: &Settings,
    sections: &[&'static Section],
    command: &dyn Command,
    watch: &dyn Watch,
) -> Result<Study, Trouble> {
    let key = Key { program: settings.program.clone(), quick: settings.quick, seed: settings.seed };
    let keeper = Keeper::new(&settings.folder, key)?;
    let lab = Lab::new(settings.quick, settings.seed, command, watch);
    let weight = |section: &Section| section.weight.of(settings.quick);
    let due: Vec<_> = sections.iter().filter(|section| keeper.load(section.id).is_none()).collect();
    let total: f64 = due.iter().map(|section| weight(section)).sum();
    let (mut done, mut stopped, mut trouble) = (0.0, false, Vec::new());
    for section in due {
        watch.section(section, done, weight(section), total);
        let begun = Instant::now();
        match (section.run)(&lab) {
            Ok(body) => {
                keeper.save(section.id, begun.elapsed().as_secs_f64(), body)?;
            }
            Err(Stop::Cancelled) => {
                stopped = true;
                break;
            }
            Err(Stop::Failed(reason)) => trouble.push(format!("{}: {reason}", section.id)),
        }
        done += weight(section);
    }
    let mut finished: Vec<_> =
        SECTIONS.iter().filter_map(|section| Some((section, keeper.load(section.id)?))).collect();
    let page = settings.folder.join("index.html");
    let html = page::render(&finished, settings).map_err(|error| Trouble::file(&page, error))?;
    write_whole(&page, html.as_bytes())?;
    if html.len() >= MOST_BYTES {
        trouble.push(format!("the page has {} bytes, and should stay below {MOST_BYTES}", html.len()));
    }
    if !trouble.is_empty() {
        return Err(Trouble::Section(trouble.join("\n")));
    }
    finished.retain(|(section, _)| sections.iter().any(|asked| asked.id == section.id));
    let (quick, seed) = (settings.quick, settings.seed);
    Ok(Study { page, bytes: html.len(), stopped, finished, quick, seed })
}

impl Study {
    /// The numbers of [`Self::finished`] that lie outside of their bands: `fig-2-1: NAME is 3 W, not 1 to 2`.
    pub fn broken(&self) -> Vec<String> {
        let of_section = |(section, finished): &(&Section, Finished)| {
            let broken = finished.body.all_numbers().filter(|number| !number.holds());
            let told = broken.map(|number| {
                format!("{}: {} is {}, not {}", section.id, number.name, number.text(), number.band_text())
            });
            told.collect::<Vec<_>>()
        };
        self.finished.iter().flat_map(of_section).collect()
    }

    /// Every number, with its band and whether it lies in it.
    pub fn json(&self) -> Value {
        // An end that no value can pass is none.
        let end = |end: f64| if end == f64::MAX { Value::Null } else { json!(end) };
        let number = |number: &crate::body::Number| {
            json!({
                "name": number.name,
                "value": number.value,
                "unit": number.unit,
                "band": number.band.map(|band| band.map(end)),
                "holds": number.holds(),
            })
        };
        let section = |(section, finished): &(&Section, Finished)| {
            json!({
                "id": section.id,
                "heading": section.heading(),
                "seconds": finished.seconds,
                "numbers": finished.body.all_numbers().map(number).collect::<Vec<_>>(),
            })
        };
        json!({
            "page": self.page.display().to_string(),
            "bytes": self.bytes,
            "quick": self.quick,
            "seed": self.seed,
            "stopped": self.stopped,
            "all_hold": self.broken().is_empty(),
            "sections": self.finished.iter().map(section).collect::<Vec<_>>(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sections_are_chosen_by_name_and_stay_in_order() {
        let ids = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
            select(&names).map(|sections| sections.iter().map(|section| section.id).collect::<Vec<_>>())
        };
        assert_eq!(ids(&[]).unwrap().len(), SECTIONS.len());
        assert_eq!(ids(&["fig-2-6", "fig-2-1"]).unwrap(), ["fig-2-1", "fig-2-6"]);
        let message = ids(&["fig-2-66"]).unwrap_err().to_string();
        assert!(
            message.contains("did you mean \"fig-2-6\"?") && message.contains("question-1-3"),
            "{message}"
        );
        assert!(ids(&["nonsense"]).unwrap_err().to_string().contains("there are fig-2-1, "));
    }

    #[test]
    fn names_are_apart_and_budgets_are_kept() {
        for (i, section) in SECTIONS.iter().enumerate() {
            assert!(SECTIONS[..i].iter().all(|other| other.id != section.id), "{}", section.id);
            assert!(section.id.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'));
        }
        let total = |quick| SECTIONS.iter().map(|section| section.weight.of(quick)).sum::<f64>();
        assert!(total(false) <= 40.0 * 60.0 && total(true) <= 120.0, "{} {}", total(false), total(true));
    }
}
