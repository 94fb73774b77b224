//! The parameters of something, and the errors of asking for them.

use std::cell::RefCell;
use std::ops::RangeInclusive;
use std::rc::Rc;

use nephroid::math::DVec3;

use super::names::parameter_is_known;
use super::parameter::{Kind, Parameter, Values};
use crate::diagnostic::{Diagnostic, Location};
use crate::log::{Log, shortened};

/// What a directive such as `Shape "sphere"` says.
pub(super) struct Parameters<'t> {
    /// What it is, in messages: `shape`.
    pub(super) noun: &'static str,
    /// Its type: `sphere`.
    pub(super) kind: String,
    /// Where the type stands.
    pub(super) at: Location,
    list: Vec<Rc<Parameter>>,
    asked: RefCell<Vec<&'static str>>,
    log: &'t Log,
}

impl<'t> Parameters<'t> {
    /// `defaults` count where a parameter of their name is not in the list; of several the last.
    pub(super) fn new(
        noun: &'static str,
        kind: String,
        at: Location,
        list: Vec<Parameter>,
        defaults: &[Rc<Parameter>],
        log: &'t Log,
    ) -> Self {
        let mut list: Vec<_> = list.into_iter().map(Rc::new).collect();
        for default in defaults.iter().rev() {
            if list.iter().all(|p| p.name != default.name) {
                list.push(Rc::clone(default));
            }
        }
        Self { noun, kind, at, list, asked: RefCell::new(Vec::new()), log }
    }

    /// `sphere at line 12`.
    pub(super) fn name(&self) -> String {
        format!("{} at line {}", shortened(&self.kind), self.at.line())
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.list.iter().any(|p| p.name == name)
    }

    /// The parameter of a name, marked as used.
    pub(super) fn any(&self, name: &'static str) -> Option<&Parameter> {
        let mut asked = self.asked.borrow_mut();
        if !asked.contains(&name) {
            asked.push(name);
        }
        let found = self.list.iter().find(|p| p.name == name)?;
        found.used.set(true);
        Some(found)
    }

    /// The parameter of a name, which must be of one of these kinds.
    fn get(&self, name: &'static str, kinds: &[Kind]) -> Option<&Parameter> {
        let found = self.any(name)?;
        if kinds.contains(&found.kind) {
            return Some(found);
        }
        // Files that say so for all that follows may mean others.
        if !found.is_default {
            let expected: Vec<_> = kinds.iter().map(|kind| kind.name()).collect();
            self.wrong_kind(found, &format!("a {}", expected.join(" or ")));
        }
        None
    }

    pub(super) fn wrong_kind(&self, found: &Parameter, expected: &str) {
        let message = format!("\"{}\" must be {expected}, not a {}", found.name, found.kind.name());
        self.log.error(&found.location, message);
    }

    /// All numbers of a parameter, and where they stand.
    pub(super) fn numbers(&self, name: &'static str, kinds: &[Kind]) -> Option<(&[f64], &Location)> {
        let found = self.get(name, kinds)?;
        match &found.values {
            Values::Numbers(numbers) => Some((numbers, &found.value_at)),
            _ => None,
        }
    }

    /// So many numbers.
    fn exactly<const N: usize>(&self, name: &'static str, kinds: &[Kind]) -> Option<([f64; N], &Location)> {
        let (numbers, at) = self.numbers(name, kinds)?;
        match numbers.try_into() {
            Ok(array) => Some((array, at)),
            Err(_) => {
                let values = if N == 1 { "one number".to_owned() } else { format!("{N} numbers") };
                self.log.error(at, format!("\"{name}\" takes {values}, not {}", numbers.len()));
                None
            }
        }
    }

    pub(super) fn optional_float(&self, name: &'static str) -> Option<f64> {
        self.exactly::<1>(name, &[Kind::Float, Kind::Integer]).map(|([value], _)| value)
    }

    pub(super) fn float(&self, name: &'static str, default: f64) -> f64 {
        self.optional_float(name).unwrap_or(default)
    }

    /// A float that passes a test; else the default, and a message that says what it must be.
    pub(super) fn float_that(
        &self,
        name: &'static str,
        default: f64,
        must_be: &str,
        test: impl Fn(f64) -> bool,
    ) -> f64 {
        match self.exactly::<1>(name, &[Kind::Float, Kind::Integer]) {
            Some(([value], _)) if test(value) => value,
            Some(([value], at)) => {
                self.log.error(at, format!("\"{name}\" must be {must_be}, not {value}"));
                default
            }
            None => default,
        }
    }

    /// A float above zero.
    pub(super) fn positive(&self, name: &'static str, default: f64) -> f64 {
        self.float_that(name, default, "above zero", |value| value > 0.0)
    }

    /// A float of zero or more.
    pub(super) fn not_negative(&self, name: &'static str, default: f64) -> f64 {
        self.float_that(name, default, "zero or more", |value| value >= 0.0)
    }

    /// A whole number in a range; anything else is an error.
    pub(super) fn integer(&self, name: &'static str, default: u32, range: RangeInclusive<u32>) -> u32 {
        let Some(([value], at)) = self.exactly::<1>(name, &[Kind::Integer, Kind::Float]) else {
            return default;
        };
        let (least, most) = (f64::from(*range.start()), f64::from(*range.end()));
        if value.fract() == 0.0 && (least..=most).contains(&value) {
            return value as u32;
        }
        let message = format!("\"{name}\" must be a whole number between {least} and {most}, not {value}");
        self.log.error(at, message);
        default
    }

    pub(super) fn boolean(&self, name: &'static str, default: bool) -> bool {
        let Some(found) = self.get(name, &[Kind::Bool]) else { return default };
        match &found.values {
            Values::Bools(list) if list.len() == 1 => list[0],
            _ => {
                self.log.error(&found.value_at, format!("\"{name}\" takes one value"));
                default
            }
        }
    }

    /// All texts of a parameter, and where they stand.
    pub(super) fn texts(&self, name: &'static str) -> Option<(&[String], &Location)> {
        let found = self.get(name, &[Kind::String])?;
        match &found.values {
            Values::Texts(texts) => Some((texts, &found.value_at)),
            _ => None,
        }
    }

    pub(super) fn text(&self, name: &'static str) -> Option<(&str, &Location)> {
        match self.texts(name)? {
            ([text], at) => Some((text, at)),
            (texts, at) => {
                self.log.error(at, format!("\"{name}\" takes one string, not {}", texts.len()));
                None
            }
        }
    }

    /// One of several words.
    pub(super) fn choice<T: Copy>(&self, name: &'static str, default: T, choices: &[(&str, T)]) -> T {
        let Some((text, at)) = self.text(name) else { return default };
        if let Some((_, value)) = choices.iter().find(|(word, _)| *word == text) {
            return *value;
        }
        let words: Vec<_> = choices.iter().map(|(word, _)| *word).collect();
        let message = format!("\"{name}\" cannot be \"{}\"", shortened(text));
        let mut message = Diagnostic::error(at, message).did_you_mean(text, words.iter().copied());
        if message.hint.is_none() {
            message = message.hint(format!("it can be {}", words.join(", ")));
        }
        self.log.push(message);
        default
    }

    /// A point, a vector or a normal.
    pub(super) fn triple(&self, name: &'static str) -> Option<DVec3> {
        self.exactly::<3>(name, &[Kind::Point3, Kind::Vector3, Kind::Normal]).map(|(v, _)| DVec3::from(v))
    }

    /// Four floats.
    pub(super) fn four(&self, name: &'static str) -> Option<([f64; 4], &Location)> {
        self.exactly::<4>(name, &[Kind::Float, Kind::Integer])
    }

    /// Parameters that change nothing here, and of which nothing is said.
    pub(super) fn ignore(&self, names: &[&'static str]) {
        for name in names {
            self.any(name);
        }
    }

    /// A message for each parameter that nobody asked for: a warning if the format has it somewhere, else
    /// an error.
    pub(super) fn finish(&self) {
        for parameter in self.unused() {
            let (name, kind) = (shortened(&parameter.name), shortened(&self.kind));
            if parameter_is_known(&parameter.name) {
                let message = format!("\"{name}\" means nothing to the {} \"{kind}\"", self.noun);
                self.log.warn(&parameter.location, message);
            } else {
                self.unknown(parameter);
            }
        }
    }

    /// The same where something else stands for what is described: what the format has is not worth a word.
    pub(super) fn finish_approximated(&self) {
        for parameter in self.unused().filter(|p| !parameter_is_known(&p.name)) {
            self.unknown(parameter);
        }
    }

    fn unused(&self) -> impl Iterator<Item = &Rc<Parameter>> {
        self.list.iter().filter(|p| !p.is_default && !p.used.get())
    }

    fn unknown(&self, parameter: &Parameter) {
        let asked = self.asked.borrow();
        let (name, kind) = (shortened(&parameter.name), shortened(&self.kind));
        let message = format!("the {} \"{kind}\" has no parameter \"{name}\"", self.noun);
        let mut message = Diagnostic::error(&parameter.location, message)
            .did_you_mean(&parameter.name, asked.iter().copied());
        if message.hint.is_none() && !asked.is_empty() {
            message = message.hint(format!("it has {}", asked.join(", ")));
        }
        self.log.push(message);
    }
}
