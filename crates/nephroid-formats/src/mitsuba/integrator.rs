//! `<integrator>`: handed on by name, because what its properties mean is another's business.

use std::cell::{Cell, RefCell};

use nephroid::film::Aov;

use super::document::Element;
use super::names::property_is_known;
use super::parameters::shortened;
use super::reader::Reader;
use super::value::{Property, Value};
use crate::diagnostic::{Diagnostic, Location};

/// Values that `aov` knows in Mitsuba and that are not kept here.
const OTHER_AOVS: [&str; 7] =
    ["dp_du", "dp_dv", "duv_dx", "duv_dy", "prim_index", "shape_index", "boundary_test"];

/// Integrators that only wrap another one, to compute more about the same picture.
const WRAPPERS: [&str; 2] = ["moment", "aov"];

/// The value of a parameter of an integrator.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterValue {
    /// `<integer>`
    Int(i64),
    /// `<float>`
    Float(f64),
    /// `<boolean>`
    Bool(bool),
    /// `<string>`
    Text(String),
}

/// A parameter of an integrator.
#[derive(Clone, Debug, PartialEq)]
pub struct IntegratorParameter {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: ParameterValue,
    /// Where the value stands.
    pub location: Location,
    used: Cell<bool>,
}

/// A layer that `<integrator type="aov">` asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct AovLayer {
    /// What the layer is called.
    pub name: String,
    /// What is in it.
    pub aov: Aov,
    /// Where it is asked for.
    pub location: Location,
}

impl AovLayer {
    /// The channels of the layer, as Mitsuba names them.
    pub fn channels(&self) -> &'static [&'static str] {
        if self.aov == Aov::Depth { &["T"] } else { self.aov.channels() }
    }
}

/// The integrator that a scene asks for. Whoever sets up an integrator takes its parameters with
/// the `get` functions, and then reports [`Self::unused`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IntegratorRequest {
    /// Its name; empty if the scene names none.
    pub name: String,
    /// Where it is named.
    pub location: Option<Location>,
    /// What is said of it.
    pub parameters: Vec<IntegratorParameter>,
    /// Layers that are asked for beside the picture.
    pub aovs: Vec<AovLayer>,
    asked: RefCell<Vec<String>>,
}

impl IntegratorRequest {
    fn get<T>(
        &self,
        name: &str,
        expected: &str,
        convert: impl Fn(&ParameterValue) -> Option<T>,
    ) -> Result<Option<T>, Diagnostic> {
        let mut asked = self.asked.borrow_mut();
        if !asked.iter().any(|a| a == name) {
            asked.push(name.to_string());
        }
        let Some(parameter) = self.parameters.iter().find(|p| p.name == name) else { return Ok(None) };
        parameter.used.set(true);
        match convert(&parameter.value) {
            Some(value) => Ok(Some(value)),
            None => {
                let message = format!("\"{name}\" must be {expected}");
                Err(Diagnostic::error(&parameter.location, message))
            }
        }
    }

    /// A whole number, or `None` if it is not given.
    pub fn get_int(&self, name: &str) -> Result<Option<i64>, Diagnostic> {
        self.get(name, "an integer", |value| match value {
            ParameterValue::Int(v) => Some(*v),
            _ => None,
        })
    }

    /// A number (a whole one will do), or `None` if it is not given.
    pub fn get_float(&self, name: &str) -> Result<Option<f64>, Diagnostic> {
        self.get(name, "a float", |value| match value {
            ParameterValue::Float(v) => Some(*v),
            ParameterValue::Int(v) => Some(*v as f64),
            _ => None,
        })
    }

    /// True or false, or `None` if it is not given.
    pub fn get_bool(&self, name: &str) -> Result<Option<bool>, Diagnostic> {
        self.get(name, "a boolean", |value| match value {
            ParameterValue::Bool(v) => Some(*v),
            _ => None,
        })
    }

    /// A text, or `None` if it is not given.
    pub fn get_string(&self, name: &str) -> Result<Option<String>, Diagnostic> {
        self.get(name, "a string", |value| match value {
            ParameterValue::Text(v) => Some(v.clone()),
            _ => None,
        })
    }

    /// A message for each parameter that nobody asked for: a warning if some integrator of the
    /// format has it, else an error that proposes one of those asked for.
    pub fn unused(&self) -> Vec<Diagnostic> {
        let asked = self.asked.borrow();
        let complain = |p: &IntegratorParameter| {
            let (name, owner) = (shortened(&p.name), shortened(&self.name));
            if property_is_known(&p.name) {
                let message = format!("\"{name}\" means nothing to the integrator \"{owner}\"");
                return Diagnostic::warning(&p.location, message);
            }
            let message = format!("the integrator \"{owner}\" has no parameter \"{name}\"");
            let mut message = Diagnostic::error(&p.location, message)
                .did_you_mean(&p.name, asked.iter().map(String::as_str));
            if message.hint.is_none() && !asked.is_empty() {
                message = message.hint(format!("it has {}", asked.join(", ")));
            }
            message
        };
        self.parameters.iter().filter(|p| !p.used.get()).map(complain).collect()
    }
}

impl<'t> Reader<'t> {
    /// The scene's integrator, taken out of those that only wrap it.
    pub(super) fn integrator(&mut self, elements: &'t [Element]) -> IntegratorRequest {
        let mut integrators = elements.iter().filter(|e| e.tag == "integrator");
        let Some(mut element) = integrators.next() else { return IntegratorRequest::default() };
        if let Some(second) = integrators.next() {
            self.log.error(&second.location, "the scene has two integrators");
        }
        let mut request = IntegratorRequest::default();
        loop {
            let plugin = self.plugin(element);
            let nested = plugin.objects("integrator");
            for property in &plugin.properties {
                if let (Value::Text(list), "aov", "aovs") = (&property.value, plugin.kind, property.name) {
                    self.aovs(list, &property.location, &mut request.aovs);
                }
                let value = match property.value {
                    Value::Integer(v) => ParameterValue::Int(v),
                    Value::Float(v) => ParameterValue::Float(v),
                    Value::Boolean(v) => ParameterValue::Bool(v),
                    Value::Text(v) => ParameterValue::Text(v.to_string()),
                    _ => continue,
                };
                if property.name == "hide_emitters" {
                    self.lamps_stay(property, &value);
                    continue;
                }
                if WRAPPERS.contains(&plugin.kind) {
                    continue;
                }
                request.parameters.retain(|p| p.name != property.name);
                request.parameters.push(IntegratorParameter {
                    name: property.name.to_string(),
                    value,
                    location: property.location.clone(),
                    used: Cell::new(false),
                });
            }
            if !WRAPPERS.contains(&plugin.kind) {
                request.name = plugin.kind.to_string();
                request.location = Some(plugin.location().clone());
                return request;
            }
            // Only written ones count: a reference could lead back here.
            match nested.iter().find(|(property, inner)| property.location == inner.location) {
                Some((_, inner)) => element = inner,
                None => return request,
            }
        }
    }

    /// Says that lamps are seen all the same, whatever integrator takes the picture.
    fn lamps_stay(&self, property: &Property, value: &ParameterValue) {
        match value {
            ParameterValue::Bool(false) => {}
            ParameterValue::Bool(true) => {
                let message = "\"hide_emitters\" cannot be had yet: the camera sees lamps and sky";
                self.log.warn(&property.location, message);
            }
            _ => self.log.error(&property.location, "\"hide_emitters\" must be a boolean"),
        }
    }

    /// Reads `name:type` pairs.
    fn aovs(&self, list: &str, at: &Location, layers: &mut Vec<AovLayer>) {
        for pair in list.split([',', ' ']).map(str::trim).filter(|pair| !pair.is_empty()) {
            let Some((name, kind)) = pair.split_once(':').filter(|(name, _)| is_layer_name(name)) else {
                let message = format!("\"{}\" is no layer", shortened(pair));
                self.log.push(Diagnostic::error(at, message).hint("write NAME:TYPE, as in nn:sh_normal"));
                continue;
            };
            let aov = if kind == "sh_normal" { Some(Aov::Normal) } else { Aov::parse(kind) };
            match aov {
                Some(_) if layers.iter().any(|layer| layer.name == name) => {
                    self.log.error(at, format!("two layers have the name \"{}\"", shortened(name)));
                }
                Some(aov) => {
                    let (name, location) = (name.to_string(), at.clone());
                    layers.push(AovLayer { name, aov, location });
                }
                None if OTHER_AOVS.contains(&kind) => {
                    self.log.warn(at, format!("\"{kind}\" is not kept here: the layer is left out"));
                }
                None => {
                    let known = Aov::ALL.iter().map(|aov| aov.name()).chain(["sh_normal"]);
                    let message = format!("there is no value \"{}\" to keep", shortened(kind));
                    self.log.push(Diagnostic::error(at, message).did_you_mean(kind, known));
                }
            }
        }
    }
}

/// Whether a layer of a file can have that name.
fn is_layer_name(name: &str) -> bool {
    (1..=100).contains(&name.len()) && name.bytes().all(|b| b.is_ascii_graphic())
}
