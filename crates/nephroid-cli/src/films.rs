//! Film files: what the command puts into them and takes out.

use std::ops::Range;
use std::path::{Path, PathBuf};

use nephroid::film::{AovFilm, Convergence, Film};
use nephroid_formats::film_file::{
    Covered, FilmFile, FilmHeader, identity_differences, read_film, read_header, write_film,
};

use crate::exit::Failure;
use crate::identity::{Identity, without_plan};
use crate::job::Job;

/// A render so far.
#[derive(Clone, Debug)]
pub struct Begun {
    /// The file it was read from.
    pub path: PathBuf,
    /// The picture's sums.
    pub film: Film,
    /// Those of its layers.
    pub aovs: Option<AovFilm>,
    /// How it came together, which its error is told by.
    pub convergence: Convergence,
    /// Numbers of the samples of each pixel that are in it.
    pub covered: Range<u64>,
    /// What it is of.
    pub identity: Identity,
    /// What it is for.
    pub job: Job,
}

/// Writes a film whole or not at all. `covered` are the numbers of the samples of each pixel that are in it.
pub fn write(
    path: &Path,
    (film, aovs, convergence): (&Film, Option<&AovFilm>, Convergence),
    covered: Covered,
    identity: &Identity,
    job: &Job,
) -> Result<(), String> {
    let header = FilmHeader {
        covered,
        samples_per_pass: job.plan.camera.samples_per_pixel,
        identity: identity.clone(),
        job: job.to_json(),
        convergence,
        ..FilmHeader::default()
    };
    write_film(path, &header, film, aovs).map_err(|e| e.to_string())
}

/// Reads a film to go on with, which must be in one piece from the first sample of its job on.
pub fn read_to_go_on(path: &Path) -> Result<Begun, Failure> {
    let FilmFile { header, film, aovs } = read_film(path).map_err(|e| Failure::File(e.to_string()))?;
    let job = job_of(path, &header)?.where_it_is(path)?;
    let per_pass = header.samples_per_pass;
    let first = job.limits.first_sample(per_pass);
    let covered = match header.covered.ranges() {
        [one] if one.start == first => one.clone(),
        _ => {
            return Err(Failure::File(format!(
                "{}: cannot be gone on with, for it has {} and should be in one piece from pass {} on: merge what is \
                 missing into it first",
                path.display(),
                passes(header.covered.ranges(), per_pass),
                first / u64::from(per_pass.max(1)),
            )));
        }
    };
    let convergence = header.convergence;
    Ok(Begun { path: path.to_owned(), film, aovs, convergence, covered, identity: header.identity, job })
}

/// The job of a film's header, which must fit the rest.
pub fn job_of(path: &Path, header: &FilmHeader) -> Result<Job, Failure> {
    let job = Job::from_json(&header.job)
        .filter(|job| job.plan.camera.samples_per_pixel == header.samples_per_pass);
    job.ok_or_else(|| {
        Failure::File(format!(
            "{}: does not say how it was rendered: it is of another program",
            path.display()
        ))
    })
}

/// Tells why a new render may not keep itself in a file that exists: another one is in it, or this one.
pub fn refuse_to_replace(path: &Path, identity: &Identity) -> Result<(), Failure> {
    if !path.exists() {
        return Ok(());
    }
    let name = path.display();
    let header = match read_header(path) {
        Ok(header) => header,
        Err(error) => {
            return Err(Failure::File(format!(
                "--checkpoint: {name} exists and is not overwritten; remove it, or name another file ({error})"
            )));
        }
    };
    let kept = without_plan(&header.identity);
    let differences = identity_differences((&name.to_string(), &kept), ("this render", identity));
    Err(Failure::File(if differences.is_empty() {
        format!(
            "--checkpoint: {name} keeps this render already, with {}: go on with it by `nephroid resume {name}`, or \
             remove it",
            passes(header.covered.ranges(), header.samples_per_pass)
        )
    } else {
        format!(
            "--checkpoint: {name} keeps another render, which differs in this: {}. Remove it, or name another file",
            differences.join("; ")
        )
    }))
}

/// Ranges of samples in words: whole passes, and samples where they are not whole.
pub fn passes(ranges: &[Range<u64>], per_pass: u32) -> String {
    let per_pass = u64::from(per_pass.max(1));
    let one = |range: &Range<u64>| {
        let (first, end) = (range.start / per_pass, range.end.div_ceil(per_pass));
        let name = match end - first {
            0 => return "nothing".to_owned(),
            1 => format!("pass {first}"),
            _ => format!("passes {first} to {}", end - 1),
        };
        match (range.start % per_pass, range.end % per_pass) {
            (0, 0) => name,
            (0, rest) => format!("{name} (of the last {rest} of {per_pass} samples)"),
            _ => format!("{name} (samples {} to {})", range.start, range.end - 1),
        }
    };
    match ranges {
        [] => "nothing".to_owned(),
        _ => ranges.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_covered_is_told_in_passes() {
        let tell = |ranges: &[(u64, u64)]| {
            let ranges: Vec<_> = ranges.iter().map(|(a, b)| *a..*b).collect();
            passes(&ranges, 4)
        };
        assert_eq!(tell(&[]), "nothing");
        assert_eq!(tell(&[(0, 4)]), "pass 0");
        assert_eq!(tell(&[(0, 12), (20, 24)]), "passes 0 to 2, pass 5");
        assert_eq!(tell(&[(0, 10)]), "passes 0 to 2 (of the last 2 of 4 samples)");
        assert_eq!(tell(&[(6, 7)]), "pass 1 (samples 6 to 6)");
    }
}
