use std::path::{Path, PathBuf};

use super::read::{Sums, named, read_bytes};
use super::{Covered, FilmFile, FilmFileError, FilmFileProblem, FilmHeader, identity_differences, read_film};

/// Adds up films of the same render. The result is the same to the bit in whatever order they come.
///
/// Needs memory for the sums and for the bytes of one file at a time, which are fewer.
pub struct FilmMerger {
    /// All films so far. Of the header, the job is that of the film with the first samples.
    sum: FilmFile,
    /// Which samples came from where.
    parts: Vec<(PathBuf, Covered)>,
    first_path: PathBuf,
    bytes: Vec<u8>,
}

impl FilmMerger {
    /// Begins with a file.
    pub fn new(path: &Path) -> Result<Self, FilmFileError> {
        let sum = read_film(path)?;
        let parts = vec![(path.to_owned(), sum.header.covered.clone())];
        Ok(Self { sum, parts, first_path: path.to_owned(), bytes: Vec::new() })
    }

    /// Adds a file. After an error the sums are what they were before.
    pub fn add(&mut self, path: &Path) -> Result<(), FilmFileError> {
        named(path, || {
            read_bytes(path, &mut self.bytes)?;
            let (header, sums) = Sums::checked(&self.bytes)?;
            let differences = differences((&self.first_path, &self.sum.header), (path, &header));
            if !differences.is_empty() {
                return Err(FilmFileProblem::Differs { other: self.first_path.clone(), differences });
            }
            let covered = joined(&self.sum.header, &self.parts, &header)?;
            sums.add_to(&mut self.sum.film, self.sum.aovs.as_mut())?;
            self.sum.film.count(header.iterations, header.counts);
            self.parts.push((path.to_owned(), header.covered.clone()));
            let mut convergence = self.sum.header.convergence;
            convergence.merge(&header.convergence);
            let is_first = first_sample(&header) < first_sample(&self.sum.header);
            let of_render = if is_first { header } else { self.sum.header.clone() };
            self.sum.header = of_render.describing(&self.sum.film, self.sum.aovs.as_ref());
            (self.sum.header.covered, self.sum.header.convergence) = (covered, convergence);
            Ok(())
        })
    }

    /// What was added up so far is described by this.
    pub fn header(&self) -> &FilmHeader {
        &self.sum.header
    }

    /// The sum of all files.
    pub fn finish(self) -> FilmFile {
        self.sum
    }
}

/// Films without samples come last.
fn first_sample(header: &FilmHeader) -> u64 {
    header.covered.ranges().first().map_or(u64::MAX, |range| range.start)
}

/// The samples of all films and of one more.
fn joined(
    sum: &FilmHeader,
    parts: &[(PathBuf, Covered)],
    new: &FilmHeader,
) -> Result<Covered, FilmFileProblem> {
    for (other, covered) in parts {
        if let Err(overlap) = covered.join(&new.covered) {
            let pass_of = |sample: u64| sample / u64::from(sum.samples_per_pass);
            return Err(FilmFileProblem::Overlap {
                other: other.clone(),
                first_pass: pass_of(overlap.0.start),
                last_pass: pass_of(overlap.0.end - 1),
            });
        }
    }
    // No part overlaps it, so their sum does not.
    Ok(sum.covered.join(&new.covered).unwrap_or_default())
}

/// In words, why two films do not belong together; empty if they do.
fn differences((path, a): (&Path, &FilmHeader), (other_path, b): (&Path, &FilmHeader)) -> Vec<String> {
    let own = |h: &FilmHeader| {
        let entry = |what: &str, value: String| (what.to_owned(), value);
        let aovs = if h.aovs.is_empty() { "none".to_owned() } else { h.aovs.join(",") };
        let mut entries = vec![
            entry("pixels", format!("{}×{}", h.width, h.height)),
            entry("samples of a pass", h.samples_per_pass.to_string()),
            entry("values beside the picture", aovs),
            entry("unit of radiance", format!("2^{}", h.unit)),
        ];
        entries.extend(h.identity.iter().cloned());
        entries
    };
    let (name, other_name) = (path.display().to_string(), other_path.display().to_string());
    identity_differences((&name, &own(a)), (&other_name, &own(b)))
}
