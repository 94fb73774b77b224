use std::ops::Range;

use nephroid::film::{Aov, AovFilm, Convergence, Film, FilmCounts};
use serde_json::{Map, Value, json};

use super::{Covered, FilmFileProblem};
use crate::image::{MAX_PIXELS, MAX_SIDE};

/// What a film file says about itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilmHeader {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Exponent of the film's unit: see [`Film::with_unit`].
    pub unit: i32,
    /// Iterations added to the film.
    pub iterations: u64,
    /// What did not go into it as it came.
    pub counts: FilmCounts,
    /// How far its steps were apart, for the error that the picture states. Zeros are known of no step.
    pub convergence: Convergence,
    /// Which samples of each pixel it holds.
    pub covered: Covered,
    /// Samples of a pixel in each pass; at least one.
    pub samples_per_pass: u32,
    /// What the render was of and how it was made, as (what, value): only films for which all of them are
    /// equal fit together.
    pub identity: Vec<(String, String)>,
    /// Whatever is needed to go on with the render. Nothing is made of it here.
    pub job: Value,
    /// [Names](Aov::name) of the values that are kept beside the picture.
    pub aovs: Vec<String>,
}

impl FilmHeader {
    /// The same header, with all that a film says of itself.
    pub(super) fn describing(&self, film: &Film, aovs: Option<&AovFilm>) -> Self {
        Self {
            width: film.width(),
            height: film.height(),
            unit: film.unit(),
            iterations: film.iterations(),
            counts: film.counts(),
            samples_per_pass: self.samples_per_pass.max(1),
            aovs: aovs
                .map_or_else(Vec::new, |aovs| aovs.aovs().iter().map(|a| a.name().to_owned()).collect()),
            ..self.clone()
        }
    }

    pub(super) fn to_json(&self) -> Value {
        let covered: Vec<[u64; 2]> = self.covered.into_iter().map(|r| [r.start, r.end]).collect();
        let identity: Vec<[&str; 2]> =
            self.identity.iter().map(|(what, value)| [&**what, &**value]).collect();
        json!({
            "width": self.width,
            "height": self.height,
            "unit": self.unit,
            "iterations": self.iterations,
            "saturated": self.counts.saturated,
            "non_finite": self.counts.non_finite,
            "convergence": self.convergence.numbers(),
            "covered": covered,
            "samples_per_pass": self.samples_per_pass,
            "identity": identity,
            "job": self.job,
            "aovs": self.aovs,
        })
    }

    pub(super) fn from_json(bytes: &[u8]) -> Result<Self, FilmFileProblem> {
        let object: Map<String, Value> =
            serde_json::from_slice(bytes).map_err(|e| FilmFileProblem::Header(e.to_string()))?;
        let fields = Fields(&object);
        let header = Self {
            width: fields.small("width")?,
            height: fields.small("height")?,
            unit: fields.get("unit", "a number", |v| i32::try_from(v.as_i64()?).ok())?,
            iterations: fields.number("iterations")?,
            counts: FilmCounts {
                saturated: fields.number("saturated")?,
                non_finite: fields.number("non_finite")?,
            },
            convergence: fields.get("convergence", "nine numbers", |v| {
                let numbers = list(v, Value::as_u64)?.try_into().ok()?;
                Some(Convergence::from_numbers(numbers))
            })?,
            covered: fields.get("covered", "ranges in order", |v| Covered::from_ranges(list(v, range)?))?,
            samples_per_pass: fields.get("samples_per_pass", "a number from 1 on", |v| {
                u32::try_from(v.as_u64()?).ok().filter(|n| *n > 0)
            })?,
            identity: fields.get("identity", "pairs of words", |v| list(v, pair))?,
            job: fields.get("job", "", |v| Some(v.clone()))?,
            aovs: fields.get("aovs", "names", |v| list(v, |name| Some(name.as_str()?.to_owned())))?,
        };
        check_size(header.width, header.height)?;
        Ok(header)
    }

    /// The values that are kept beside the picture.
    pub(super) fn known_aovs(&self) -> Result<Vec<Aov>, FilmFileProblem> {
        let known = |name: &String| Aov::parse(name).ok_or_else(|| FilmFileProblem::UnknownAov(name.clone()));
        let aovs: Vec<Aov> = self.aovs.iter().map(known).collect::<Result<_, _>>()?;
        if !aovs.windows(2).all(|pair| pair[0] < pair[1]) {
            return Err(FilmFileProblem::Header("`aovs` are not in order".to_owned()));
        }
        Ok(aovs)
    }
}

/// Whether a film of this size is read and written.
pub(super) fn check_size(width: u32, height: u32) -> Result<(), FilmFileProblem> {
    let (width, height) = (u64::from(width), u64::from(height));
    let sides = 1..=MAX_SIDE;
    if !sides.contains(&width) || !sides.contains(&height) || width * height > MAX_PIXELS {
        return Err(FilmFileProblem::Size { width, height });
    }
    Ok(())
}

/// The members of the object.
struct Fields<'j>(&'j Map<String, Value>);

impl Fields<'_> {
    fn get<T>(
        &self,
        name: &str,
        expected: &str,
        parse: impl FnOnce(&Value) -> Option<T>,
    ) -> Result<T, FilmFileProblem> {
        let value =
            self.0.get(name).ok_or_else(|| FilmFileProblem::Header(format!("`{name}` is missing")))?;
        parse(value).ok_or_else(|| FilmFileProblem::Header(format!("`{name}` is not {expected}")))
    }

    fn number(&self, name: &str) -> Result<u64, FilmFileProblem> {
        self.get(name, "a number", Value::as_u64)
    }

    fn small(&self, name: &str) -> Result<u32, FilmFileProblem> {
        self.get(name, "a number", |v| u32::try_from(v.as_u64()?).ok())
    }
}

fn list<T>(value: &Value, item: impl Fn(&Value) -> Option<T>) -> Option<Vec<T>> {
    value.as_array()?.iter().map(item).collect()
}

fn range(value: &Value) -> Option<Range<u64>> {
    let [start, end] = value.as_array()?.as_slice() else { return None };
    Some(start.as_u64()?..end.as_u64()?)
}

fn pair(value: &Value) -> Option<(String, String)> {
    let [what, value] = value.as_array()?.as_slice() else { return None };
    Some((what.as_str()?.to_owned(), value.as_str()?.to_owned()))
}
