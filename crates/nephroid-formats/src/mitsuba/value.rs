//! The values of properties, from their elements.

use std::cell::Cell;
use std::collections::BTreeMap;

use nephroid::math::{DVec3, Transform};

use super::document::Element;
use super::names::{OBJECT_TAGS, PROPERTY_TAGS};
use super::transform::{self, list, number};
use crate::diagnostic::{Diagnostic, Location};
use crate::log::{Log, shortened};
use crate::number::{boolean, floats, integer};
use crate::spectra::Spectrum;

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
    pub(super) fn describe(&self) -> &'static str {
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
    /// Where its name stands.
    pub(super) name_location: Location,
    /// Whether anything asked for it.
    pub(super) used: Cell<bool>,
}

/// A child of a plugin as a property; `None` if the log says why not.
pub(super) fn property<'t>(child: &'t Element, ids: &Ids<'t>, log: &Log) -> Option<Property<'t>> {
    let tag = child.tag.as_str();
    let is_plugin = OBJECT_TAGS.contains(&tag) || (tag == "spectrum" && child.attribute("type").is_some());
    let name_location = child.attribute("name").map_or(&child.location, |a| &a.location);
    let new = |name, value, location| Property {
        name,
        value,
        location,
        name_location: name_location.clone(),
        used: Cell::new(false),
    };
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
    let attribute = child.attribute("value").or_else(|| child.attribute("filename"));
    let location = attribute.map_or(&child.location, |a| &a.location).clone();
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
    match floats(text)?.as_slice() {
        [v] => Ok([*v; 3]),
        [r, g, b] => Ok([*r, *g, *b]),
        other => Err(format!("a colour has one or three numbers, not {}", other.len())),
    }
}
