use serde::{Deserialize, Serialize};

use crate::chart::Plot;
use crate::format;
use crate::picture::Picture;

/// What a section found: parts in the order of the page.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Body {
    /// What is shown.
    pub parts: Vec<Part>,
    /// Its rows in the table of all.
    pub findings: Vec<Finding>,
}

/// A part of a section.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub enum Part {
    /// A paragraph.
    Text(String),
    /// Pictures beside one another.
    Pictures(Vec<Picture>),
    /// Two pictures of one size, under a slider.
    Pair(Box<[Picture; 2]>),
    /// Curves.
    Plot(Plot),
    /// A table.
    Table(Table),
    /// Numbers with their bands.
    Numbers(Vec<Number>),
}

/// A table of texts.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Table {
    /// What it is.
    pub caption: String,
    /// Of the columns; the first names the rows.
    pub head: Vec<String>,
    /// Each as long as the head.
    pub rows: Vec<Vec<String>>,
}

/// A number that was computed in the run.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Number {
    /// What it is.
    pub name: String,
    /// In `unit`.
    pub value: f64,
    /// Empty for a mere number.
    pub unit: String,
    /// What it must lie in, ends included; none of what depends on the machine.
    pub band: Option<[f64; 2]>,
    /// Where the band comes from.
    pub why: String,
}

/// A row of the table of all: what became of a figure or a question.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Finding {
    /// As the report calls it.
    pub of: String,
    /// Where both say the same.
    pub agrees: String,
    /// Where they do not.
    pub differs: String,
    /// The reason.
    pub why: String,
}

impl Number {
    /// A number that must lie within a band.
    pub fn within(name: &str, value: f64, unit: &str, band: [f64; 2], why: &str) -> Self {
        Self { band: Some(band), ..Self::measured(name, value, unit, why) }
    }

    /// A number that decides nothing: a time.
    pub fn measured(name: &str, value: f64, unit: &str, why: &str) -> Self {
        Self { name: name.to_owned(), value, unit: unit.to_owned(), band: None, why: why.to_owned() }
    }

    /// Whether it lies within its band. What is no number lies in none.
    pub fn holds(&self) -> bool {
        self.band.is_none_or(|[low, high]| (low..=high).contains(&self.value))
    }

    /// As people read it, with its unit.
    pub fn text(&self) -> String {
        format!("{} {}", self.rounded(self.value), self.unit).trim_end().to_owned()
    }

    /// Its band as people read it.
    pub fn band_text(&self) -> String {
        match self.band {
            None => "none".to_owned(),
            Some([low, high]) if high == f64::MAX => format!("at least {}", self.rounded(low)),
            Some([low, high]) => format!("{} to {}", self.rounded(low), self.rounded(high)),
        }
    }

    /// With more digits where the band is narrow.
    fn rounded(&self, value: f64) -> String {
        let narrow = self.band.is_some_and(|[low, high]| high - low < 2e-3 * high.abs());
        format::rounded(value, if narrow { 6 } else { 4 })
    }
}

impl Body {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// A paragraph.
    pub fn say(&mut self, text: &str) {
        self.parts.push(Part::Text(text.to_owned()));
    }

    /// One picture.
    pub fn picture(&mut self, picture: Picture) {
        self.parts.push(Part::Pictures(vec![picture]));
    }

    /// Pictures beside one another.
    pub fn strip(&mut self, pictures: Vec<Picture>) {
        self.parts.push(Part::Pictures(pictures));
    }

    /// Two pictures of one size, under a slider.
    pub fn pair(&mut self, left: Picture, right: Picture) {
        self.parts.push(Part::Pair(Box::new([left, right])));
    }

    /// Curves.
    pub fn plot(&mut self, plot: Plot) {
        self.parts.push(Part::Plot(plot));
    }

    /// A table; the first column names the rows.
    pub fn table(&mut self, caption: &str, head: &[&str], rows: Vec<Vec<String>>) {
        let head = head.iter().map(|&text| text.to_owned()).collect();
        self.parts.push(Part::Table(Table { caption: caption.to_owned(), head, rows }));
    }

    /// Numbers with their bands.
    pub fn numbers(&mut self, numbers: Vec<Number>) {
        self.parts.push(Part::Numbers(numbers));
    }

    /// A row of the table of all.
    pub fn finding(&mut self, of: &str, agrees: &str, differs: &str, why: &str) {
        let [of, agrees, differs, why] = [of, agrees, differs, why].map(str::to_owned);
        self.findings.push(Finding { of, agrees, differs, why });
    }

    /// Every number in it.
    pub fn all_numbers(&self) -> impl Iterator<Item = &Number> {
        self.parts.iter().flat_map(|part| match part {
            Part::Numbers(numbers) => numbers.as_slice(),
            _ => &[],
        })
    }

    /// Every picture in it.
    pub fn pictures_mut(&mut self) -> impl Iterator<Item = &mut Picture> {
        self.parts.iter_mut().flat_map(|part| match part {
            Part::Pictures(pictures) => pictures.as_mut_slice(),
            Part::Pair(pair) => pair.as_mut_slice(),
            _ => &mut [],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_holds_its_ends_and_nothing_that_is_no_number() {
        let holds = |value| Number::within("n", value, "W", [1.0, 2.0], "").holds();
        assert!(holds(1.0) && holds(2.0) && !holds(0.99) && !holds(2.01) && !holds(f64::NAN));
        assert!(Number::measured("t", f64::NAN, "s", "").holds());
    }
}
