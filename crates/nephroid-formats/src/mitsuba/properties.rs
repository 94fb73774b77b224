//! A plugin of a scene with its typed properties, and the errors of asking for them.

use std::cell::RefCell;

use nephroid::math::{Transform, Vec3};

use super::document::Element;
use super::names::{PROPERTY_NAMES, SHAPES, property_is_known};
use super::value::{Ids, Property, Value, property};
use crate::diagnostic::{Diagnostic, Location};
use crate::log::{Log, shortened};

/// An element such as `<bsdf type="…">` with its properties.
pub(super) struct Plugin<'t> {
    pub(super) element: &'t Element,
    pub(super) kind: &'t str,
    pub(super) properties: Vec<Property<'t>>,
    /// Every name that was asked for: those that are proposed for a wrong one.
    asked: RefCell<Vec<&'static str>>,
    /// Whether properties that nobody knows are left alone.
    lenient: bool,
    log: &'t Log,
}

impl<'t> Plugin<'t> {
    /// Reads an element's properties; what is wrong with them goes to the log.
    pub(super) fn new(element: &'t Element, ids: &Ids<'t>, lenient: bool, log: &'t Log) -> Self {
        element.allow_attributes(&["type", "id", "name", "version"], log);
        let kind = element.require("type", log).map_or("", |a| a.value.as_str());
        // Where files do not differ by case, neither do Mitsuba's plugins.
        let is_shape = |known: &&&'static str| element.tag == "shape" && known.eq_ignore_ascii_case(kind);
        let kind = SHAPES.iter().find(is_shape).copied().unwrap_or(kind);
        let mut properties: Vec<Property> = Vec::new();
        for child in &element.children {
            let Some(property) = property(child, ids, log) else { continue };
            let first = properties.iter().position(|p| !p.name.is_empty() && p.name == property.name);
            if let Some(first) = first {
                let message = format!("\"{}\" is given twice", property.name);
                if element.is_legacy {
                    log.warn(&child.location, format!("{message}; the last counts"));
                    properties[first] = property;
                } else {
                    log.error(&child.location, message);
                }
                continue;
            }
            properties.push(property);
        }
        // The programs of old took a name that they did not know for a mistake of no consequence.
        let lenient = lenient || element.is_legacy;
        Self { element, kind, properties, asked: RefCell::new(Vec::new()), lenient, log }
    }

    pub(super) fn id(&self) -> Option<&'t str> {
        self.element.value_of("id")
    }

    /// Where the plugin's type is named.
    pub(super) fn location(&self) -> &'t Location {
        self.element.attribute("type").map_or(&self.element.location, |a| &a.location)
    }

    /// The id, or where to find it: `sphere at line 12`.
    pub(super) fn name(&self) -> String {
        match self.id() {
            Some(id) => id.to_string(),
            None => format!("{} at line {}", self.kind, self.element.location.line()),
        }
    }

    /// The property of a name, marked as used.
    pub(super) fn property(&self, name: &'static str) -> Option<&Property<'t>> {
        let mut asked = self.asked.borrow_mut();
        if !asked.contains(&name) {
            asked.push(name);
        }
        let found = self.properties.iter().find(|p| p.name == name)?;
        found.used.set(true);
        Some(found)
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.properties.iter().any(|p| p.name == name)
    }

    /// Complains that a property is of the wrong type.
    pub(super) fn wrong_type(&self, property: &Property, expected: &str) {
        if !matches!(property.value, Value::Broken) {
            let found = property.value.describe();
            self.log
                .error(&property.location, format!("\"{}\" must be {expected}, not {found}", property.name));
        }
    }

    pub(super) fn boolean(&self, name: &'static str, default: bool) -> bool {
        match self.property(name) {
            None => default,
            Some(Property { value: Value::Boolean(v), .. }) => *v,
            Some(other) => {
                self.wrong_type(other, "a boolean");
                default
            }
        }
    }

    pub(super) fn optional_float(&self, name: &'static str) -> Option<f32> {
        let property = self.property(name)?;
        match property.value {
            Value::Float(v) => Some(v as f32),
            Value::Integer(v) => Some(v as f32),
            _ => {
                self.wrong_type(property, "a float");
                None
            }
        }
    }

    pub(super) fn float(&self, name: &'static str, default: f32) -> f32 {
        self.optional_float(name).unwrap_or(default)
    }

    /// A float above zero.
    pub(super) fn positive(&self, name: &'static str, default: f32) -> f32 {
        let value = self.float(name, default);
        if value > 0.0 {
            return value;
        }
        if let Some(property) = self.property(name) {
            self.log.error(&property.location, format!("\"{name}\" must be above zero, not {value}"));
        }
        default
    }

    /// A whole number in a range; anything else is an error.
    pub(super) fn integer_within(
        &self,
        name: &'static str,
        default: u32,
        range: std::ops::RangeInclusive<u32>,
    ) -> u32 {
        let Some(property) = self.property(name) else { return default };
        let Value::Integer(value) = property.value else {
            self.wrong_type(property, "an integer");
            return default;
        };
        match u32::try_from(value) {
            Ok(v) if range.contains(&v) => v,
            _ => {
                let (low, high) = range.into_inner();
                let message = if high == u32::MAX {
                    format!("\"{name}\" must be at least {low}, not {value}")
                } else {
                    format!("\"{name}\" must be from {low} to {high}, not {value}")
                };
                self.log.error(&property.location, message);
                default
            }
        }
    }

    pub(super) fn text(&self, name: &'static str) -> Option<(&'t str, &Location)> {
        let property = self.property(name)?;
        match property.value {
            Value::Text(text) => Some((text, &property.location)),
            _ => {
                self.wrong_type(property, "a string");
                None
            }
        }
    }

    /// One of a list of words, compared without case.
    pub(super) fn choice<T: Copy>(&self, name: &'static str, default: T, choices: &[(&str, T)]) -> T {
        let Some((text, at)) = self.text(name) else { return default };
        match choices.iter().find(|(word, _)| word.eq_ignore_ascii_case(text)) {
            Some((_, value)) => *value,
            None => {
                let known: Vec<_> = choices.iter().map(|(word, _)| *word).collect();
                let message = format!("unknown {name} \"{}\"", shortened(text));
                self.log.push(Diagnostic::error(at, message).hint(format!("one of {}", known.join(", "))));
                default
            }
        }
    }

    /// Whether a property is there and a point or a vector.
    pub(super) fn is_vector(&self, name: &str) -> bool {
        self.properties.iter().any(|p| p.name == name && matches!(p.value, Value::Vector(_)))
    }

    pub(super) fn vector(&self, name: &'static str) -> Option<Vec3> {
        let property = self.property(name)?;
        match property.value {
            Value::Vector(v) => Some(v.as_vec3()),
            _ => {
                self.wrong_type(property, "a point or vector");
                None
            }
        }
    }

    pub(super) fn transform(&self, name: &'static str) -> Transform {
        match self.property(name) {
            None => Transform::IDENTITY,
            Some(Property { value: Value::Transform(t), .. }) => *t,
            Some(other) => {
                self.wrong_type(other, "a transform");
                Transform::IDENTITY
            }
        }
    }

    /// Nested plugins with a tag, in order, marked as used.
    pub(super) fn objects(&self, tag: &str) -> Vec<(&Property<'t>, &'t Element)> {
        let with_tag = |p: &'_ Property<'t>| match p.value {
            Value::Object(element) if element.tag == tag => Some(element),
            _ => None,
        };
        let found: Vec<_> =
            self.properties.iter().filter_map(|p| with_tag(p).map(|element| (p, element))).collect();
        for (property, _) in &found {
            property.used.set(true);
        }
        found
    }

    /// The only nested plugin with a tag; a second one is an error.
    pub(super) fn only_object(&self, tag: &str) -> Option<&'t Element> {
        let found = self.objects(tag);
        if let Some((property, _)) = found.get(1) {
            let message = format!("<{}> takes one <{tag}>", self.element.tag);
            self.log.error(&property.location, message);
        }
        found.first().map(|(_, element)| *element)
    }

    /// Takes properties that change nothing in the picture.
    pub(super) fn ignore(&self, names: &[&'static str]) {
        for name in names {
            self.property(name);
        }
    }

    /// Complains about properties nobody asked for: an error if no plugin has one of that name, unless the caller is
    /// lenient or the file is old; a warning if another plugin has.
    pub(super) fn finish(&self) {
        self.complain(true);
    }

    /// As [`Self::finish`], for plugins that stand for others: only names that no plugin has.
    pub(super) fn finish_approximated(&self) {
        self.complain(false);
    }

    fn complain(&self, about_known: bool) {
        let owner = format!("<{} type=\"{}\">", self.element.tag, shortened(self.kind));
        for property in self.properties.iter().filter(|p| !p.used.get()) {
            let name = property.name;
            if matches!(property.value, Value::Broken) && name.is_empty() {
                continue;
            }
            if let (Value::Object(element), true) = (&property.value, name.is_empty()) {
                if about_known {
                    let message = format!("<{}> has no place in {owner}", element.tag);
                    self.log.error(&property.location, message);
                }
            } else if !property_is_known(name) {
                let asked = self.asked.borrow();
                let known = || asked.iter().copied().filter(|name| !name.is_empty());
                let message = format!("{owner} has no property \"{}\"", shortened(name));
                let severity = if self.lenient { Diagnostic::warning } else { Diagnostic::error };
                let mut message = severity(&property.name_location, message).did_you_mean(name, known());
                if message.hint.is_none() {
                    message = message.did_you_mean(name, PROPERTY_NAMES.iter().copied());
                }
                if message.hint.is_none() && known().next().is_some() {
                    message = message.hint(format!("it has {}", known().collect::<Vec<_>>().join(", ")));
                }
                self.log.push(message);
            } else if about_known {
                self.log.warn(&property.location, format!("\"{name}\" means nothing in {owner}"));
            }
        }
    }
}
