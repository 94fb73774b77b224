//! A value of the document and what it says, with messages where that is not what is expected.

use super::json::{Kind, Value};
use crate::diagnostic::{Diagnostic, Location, Source};
use crate::log::{Log, shortened};
use std::sync::Arc;

/// What every part of a document needs to be read.
pub(super) struct Document<'d> {
    pub(super) source: &'d Arc<Source>,
    pub(super) root: &'d Value,
    pub(super) log: &'d Log,
}

/// A value of a document, usually an object.
#[derive(Clone, Copy)]
pub(super) struct Item<'d> {
    document: &'d Document<'d>,
    value: &'d Value,
}

impl<'d> Document<'d> {
    /// The whole document.
    pub(super) fn item(&'d self) -> Item<'d> {
        Item { document: self, value: self.root }
    }
}

impl<'d> Item<'d> {
    /// Where it stands: of objects and lists their opening brackets, for they may be as long as the document.
    pub(super) fn at(&self) -> Location {
        let range = self.value.range.clone();
        let end = match self.value.kind {
            Kind::List(_) | Kind::Object(_) => range.start + 1,
            _ => range.end,
        };
        Location::new(self.document.source, range.start..end)
    }

    pub(super) fn log(&self) -> &'d Log {
        self.document.log
    }

    pub(super) fn error(&self, message: impl Into<String>) {
        self.log().error(&self.at(), message);
    }

    pub(super) fn warn(&self, message: impl Into<String>) {
        self.log().warn(&self.at(), message);
    }

    /// A member of an object.
    pub(super) fn get(&self, name: &str) -> Option<Self> {
        match &self.value.kind {
            Kind::Object(fields) => fields
                .iter()
                .find(|(known, value)| known == name && value.kind != Kind::Null)
                .map(|(_, value)| Self { value, ..*self }),
            _ => None,
        }
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    /// Names of the members of an object.
    pub(super) fn names(&self) -> impl Iterator<Item = &'d str> {
        let fields: &[(String, Value)] = match &self.value.kind {
            Kind::Object(fields) => fields,
            _ => &[],
        };
        fields.iter().map(|(name, _)| name.as_str())
    }

    fn wrong(&self, name: &str, expected: &str) {
        self.error(format!("\"{name}\" must be {expected}, not {}", self.value.kind.name()));
    }

    /// A member that is an object.
    pub(super) fn object(&self, name: &str) -> Option<Self> {
        let member = self.get(name)?;
        if matches!(member.value.kind, Kind::Object(_)) {
            return Some(member);
        }
        member.wrong(name, "an object");
        None
    }

    /// What an extension says of this object.
    pub(super) fn extension(&self, name: &str) -> Option<Self> {
        self.object("extensions")?.object(name)
    }

    /// The items of a member that is a list; none if there is no such member.
    pub(super) fn list(&self, name: &str) -> Vec<Self> {
        let Some(member) = self.get(name) else { return Vec::new() };
        match &member.value.kind {
            Kind::List(items) => items.iter().map(|value| Self { value, ..*self }).collect(),
            _ => {
                member.wrong(name, "a list");
                Vec::new()
            }
        }
    }

    /// The item itself as a text.
    pub(super) fn as_text(&self) -> Option<&'d str> {
        match &self.value.kind {
            Kind::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The item itself as a finite number.
    pub(super) fn as_number(&self) -> Option<f64> {
        match self.value.kind {
            Kind::Number(number) if number.is_finite() => Some(number),
            _ => None,
        }
    }

    /// The item itself as a whole number from 0.
    pub(super) fn as_whole(&self) -> Option<usize> {
        // Beyond 2⁵³ not every whole number is one of double precision.
        self.as_number()
            .filter(|n| *n >= 0.0 && *n <= 9_007_199_254_740_992.0 && n.fract() == 0.0)
            .map(|n| n as usize)
    }

    pub(super) fn text(&self, name: &str) -> Option<&'d str> {
        let member = self.get(name)?;
        let text = member.as_text();
        if text.is_none() {
            member.wrong(name, "a text");
        }
        text
    }

    pub(super) fn boolean(&self, name: &str) -> bool {
        let Some(member) = self.get(name) else { return false };
        if let Kind::Bool(value) = member.value.kind {
            return value;
        }
        member.wrong(name, "true or false");
        false
    }

    pub(super) fn number(&self, name: &str) -> Option<f64> {
        let member = self.get(name)?;
        let number = member.as_number();
        if number.is_none() {
            member.wrong(name, "a number");
        }
        number
    }

    /// A number within bounds; one beyond them is moved to the nearest, with a warning.
    pub(super) fn number_within(&self, name: &str, default: f64, least: f64, most: f64) -> f64 {
        let Some(number) = self.number(name) else { return default };
        if (least..=most).contains(&number) {
            return number;
        }
        let clamped = number.clamp(least, most);
        if let Some(member) = self.get(name) {
            member.warn(format!("\"{name}\" is {number}, and {clamped} stands for it"));
        }
        clamped
    }

    /// A whole number from 0: a count, an offset or the place of something in a list.
    pub(super) fn whole(&self, name: &str) -> Option<usize> {
        let member = self.get(name)?;
        let number = member.as_whole();
        if number.is_none() {
            member.error(format!("\"{name}\" must be a whole number that is not negative"));
        }
        number
    }

    /// So many numbers.
    pub(super) fn vector<const N: usize>(&self, name: &str) -> Option<[f64; N]> {
        let member = self.get(name)?;
        let items = self.list(name);
        let mut out = [0.0; N];
        let sound = items.len() == N
            && out.iter_mut().zip(&items).all(|(value, item)| {
                item.as_number().is_some_and(|number| {
                    *value = number;
                    true
                })
            });
        if !sound {
            member.error(format!("\"{name}\" must be {N} numbers"));
            return None;
        }
        Some(out)
    }

    /// What a member refers to by its place in a list of the document: the place and the item there.
    pub(super) fn refers(&self, name: &str, list: &str) -> Option<(usize, Self)> {
        let index = self.whole(name)?;
        let found = self.document.item().nth(list, index);
        if found.is_none()
            && let Some(member) = self.get(name)
        {
            let count = self.document.item().list(list).len();
            member.error(format!("\"{name}\" is {index}, and there are {count} {list}"));
        }
        found.map(|item| (index, item))
    }

    /// An item of a member that is a list.
    pub(super) fn nth(&self, name: &str, index: usize) -> Option<Self> {
        match &self.get(name)?.value.kind {
            Kind::List(items) => items.get(index).map(|value| Self { value, ..*self }),
            _ => None,
        }
    }

    /// Its own name, or else what it is and its number, for messages.
    pub(super) fn called(&self, what: &str, index: usize) -> String {
        match self.get("name").and_then(|name| name.as_text()) {
            Some(name) if !name.trim().is_empty() => shortened(name),
            _ => format!("{what} {index}"),
        }
    }

    /// An error with advice.
    pub(super) fn error_with_hint(&self, message: impl Into<String>, hint: impl Into<String>) {
        self.log().push(Diagnostic::error(&self.at(), message).hint(hint));
    }
}
