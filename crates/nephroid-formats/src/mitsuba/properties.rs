//! A plugin of a scene with its typed properties, and the errors of asking for them.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

use nephroid::math::{DVec3, Transform, Vec3};

use super::document::Element;
use super::log::Log;
use super::names::{OBJECT_TAGS, PROPERTY_NAMES, PROPERTY_TAGS, property_is_known};
use super::number::{boolean, integer};
use super::parameters::shortened;
use super::spectrum::Spectrum;
use super::transform::{self, list, number};
use crate::diagnostic::{Diagnostic, Location};

/// Elements by their `id`.
pub(super) type Ids<'t> = BTreeMap<&'t str, &'t Element>;

/// A property's value.
#[derive(Debug)]
pub(super) enum Value<'t> {
    Boolean(bool),
    Integer(i64),
    Float(f64),
    Text(&'t str),
    Vector(DVec3),
    Color([f64; 3]),
    Spectrum(Spectrum),
    /// The name of a file with a spectrum in it.
    SpectrumFile(&'t str),
    Transform(Transform),
    /// A plugin, here or elsewhere.
    Object(&'t Element),
    /// Something that the log already complains about.
    Broken,
}

impl Value<'_> {
    fn describe(&self) -> &'static str {
        match self {
            Self::Boolean(_) => "a boolean",
            Self::Integer(_) => "an integer",
            Self::Float(_) => "a float",
            Self::Text(_) => "a string",
            Self::Vector(_) => "a point or vector",
            Self::Color(_) => "an rgb colour",
            Self::Spectrum(_) | Self::SpectrumFile(_) => "a spectrum",
            Self::Transform(_) => "a transform",
            Self::Object(_) => "a plugin",
            Self::Broken => "broken",
        }
    }
}

/// A property of a plugin.
#[derive(Debug)]
pub(super) struct Property<'t> {
    /// Empty if it has none, as most nested plugins do.
    pub(super) name: &'t str,
    pub(super) value: Value<'t>,
    /// Of the value if it is an attribute, else of the element.
    pub(super) location: Location,
    used: Cell<bool>,
}

/// An element such as `<bsdf type="…">` with its properties.
pub(super) struct Plugin<'t> {
    pub(super) element: &'t Element,
    pub(super) kind: &'t str,
    pub(super) properties: Vec<Property<'t>>,
    /// Every name that was asked for: those that are proposed for a wrong one.
    asked: RefCell<Vec<&'static str>>,
    log: &'t Log,
}

impl<'t> Plugin<'t> {
    /// Reads an element's properties; what is wrong with them goes to the log.
    pub(super) fn new(element: &'t Element, ids: &Ids<'t>, log: &'t Log) -> Self {
        element.allow_attributes(&["type", "id", "name", "version"], log);
        let kind = element.require("type", log).map_or("", |a| a.value.as_str());
        let mut properties: Vec<Property> = Vec::new();
        for child in &element.children {
            let Some(property) = property(child, ids, log) else { continue };
            if !property.name.is_empty() && properties.iter().any(|p| p.name == property.name) {
                log.error(&child.location, format!("\"{}\" is given twice", property.name));
                continue;
            }
            properties.push(property);
        }
        Self { element, kind, properties, asked: RefCell::new(Vec::new()), log }
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

    /// Complains about properties nobody asked for: an error if no plugin has one of that name, a
    /// warning if another plugin has.
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
            if let (Value::Object(element), true) = (&property.value, name.is_empty()) {
                if about_known {
                    let message = format!("<{}> has no place in {owner}", element.tag);
                    self.log.error(&property.location, message);
                }
            } else if !property_is_known(name) {
                let asked = self.asked.borrow();
                let known = || asked.iter().copied().filter(|name| !name.is_empty());
                let mut message = Diagnostic::error(
                    &property.location,
                    format!("{owner} has no property \"{}\"", shortened(name)),
                )
                .did_you_mean(name, known());
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

/// A child of a plugin as a property; `None` if the log says why not.
fn property<'t>(child: &'t Element, ids: &Ids<'t>, log: &Log) -> Option<Property<'t>> {
    let tag = child.tag.as_str();
    let is_plugin = OBJECT_TAGS.contains(&tag) || (tag == "spectrum" && child.attribute("type").is_some());
    let new = |name, value, location| Property { name, value, location, used: Cell::new(false) };
    let name = child.value_of("name").unwrap_or_default();
    if is_plugin {
        return Some(new(name, Value::Object(child), child.location.clone()));
    }
    if tag == "ref" {
        child.allow_attributes(&["id", "name"], log);
        let id = child.require("id", log)?;
        let value = match ids.get(id.value.as_str()) {
            Some(target) => Value::Object(target),
            None => {
                let message = format!("nothing has the id \"{}\"", shortened(&id.value));
                log.push(
                    Diagnostic::error(&id.location, message).did_you_mean(&id.value, ids.keys().copied()),
                );
                Value::Broken
            }
        };
        return Some(new(name, value, id.location.clone()));
    }
    if !PROPERTY_TAGS.contains(&tag) {
        let known = PROPERTY_TAGS.iter().chain(&OBJECT_TAGS).copied();
        let message = format!("unknown element <{}>", shortened(tag));
        log.push(Diagnostic::error(&child.location, message).did_you_mean(tag, known));
        return None;
    }
    if tag != "transform"
        && let Some(grandchild) = child.children.first()
    {
        log.error(&grandchild.location, format!("<{tag}> holds no elements"));
    }
    child.require("name", log)?;
    let location = child.attribute("value").map_or(&child.location, |a| &a.location).clone();
    let value = scalar_value(child, log).unwrap_or(Value::Broken);
    Some(new(name, value, location))
}

fn scalar_value<'t>(child: &'t Element, log: &Log) -> Option<Value<'t>> {
    match child.tag.as_str() {
        "transform" => {
            child.allow_attributes(&["name"], log);
            return transform::parse(child, log).map(Value::Transform);
        }
        "point" | "vector" => return vector(child, log).map(Value::Vector),
        "spectrum" => return spectrum(child, log),
        _ => {}
    }
    child.allow_attributes(&["name", "value"], log);
    let attribute = child.require("value", log)?;
    let parsed = match child.tag.as_str() {
        "boolean" => boolean(&attribute.value).map(Value::Boolean),
        "integer" => integer(&attribute.value).map(Value::Integer),
        "float" => return number(attribute, log).map(Value::Float),
        "string" => Ok(Value::Text(&attribute.value)),
        _ => color(&attribute.value).map(Value::Color),
    };
    parsed.map_err(|message| log.error(&attribute.location, message)).ok()
}

fn vector(child: &Element, log: &Log) -> Option<DVec3> {
    child.allow_attributes(&["name", "value", "x", "y", "z"], log);
    let Some(value) = child.attribute("value") else {
        let x = number(child.require("x", log)?, log)?;
        let y = number(child.require("y", log)?, log)?;
        return Some(DVec3::new(x, y, number(child.require("z", log)?, log)?));
    };
    match list(value, log)?.as_slice() {
        [v] => Some(DVec3::splat(*v)),
        [x, y, z] => Some(DVec3::new(*x, *y, *z)),
        other => {
            log.error(&value.location, format!("expected one or three numbers, found {}", other.len()));
            None
        }
    }
}

fn spectrum<'t>(child: &'t Element, log: &Log) -> Option<Value<'t>> {
    child.allow_attributes(&["name", "value", "filename"], log);
    match (child.attribute("value"), child.attribute("filename")) {
        (Some(value), None) => match Spectrum::parse(&value.value) {
            Ok(spectrum) => Some(Value::Spectrum(spectrum)),
            Err(message) => {
                log.error(&value.location, message);
                None
            }
        },
        (None, Some(filename)) => Some(Value::SpectrumFile(&filename.value)),
        _ => {
            log.error(&child.location, "<spectrum> needs either \"value\" or \"filename\"");
            None
        }
    }
}

/// One number, three numbers or `#rrggbb` in sRGB encoding.
fn color(text: &str) -> Result<[f64; 3], String> {
    if let Some(hex) = text.trim().strip_prefix('#') {
        let digits = hex.len() == 6 && hex.bytes().all(|b| b.is_ascii_hexdigit());
        let code = u32::from_str_radix(hex, 16).ok().filter(|_| digits);
        let code =
            code.ok_or_else(|| format!("\"{}\" is not a colour of the form #rrggbb", shortened(text)))?;
        let channel =
            |shift: u32| f64::from(nephroid::color::srgb::decode(((code >> shift) & 255) as f32 / 255.0));
        return Ok([channel(16), channel(8), channel(0)]);
    }
    match super::number::floats(text)?.as_slice() {
        [v] => Ok([*v; 3]),
        [r, g, b] => Ok([*r, *g, *b]),
        other => Err(format!("a colour has one or three numbers, not {}", other.len())),
    }
}
