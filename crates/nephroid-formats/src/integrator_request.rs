//! The integrator that a scene asks for, by name: what its properties mean is another's business.

use std::cell::{Cell, RefCell};

use nephroid::film::Aov;

use crate::diagnostic::{Diagnostic, Location};
use crate::log::shortened;

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
    /// Whether some integrator of the file's format has a parameter of that name.
    pub of_format: bool,
    used: Cell<bool>,
}

impl IntegratorParameter {
    /// One that nobody has asked for yet.
    pub fn new(name: impl Into<String>, value: ParameterValue, location: Location, of_format: bool) -> Self {
        Self { name: name.into(), value, location, of_format, used: Cell::new(false) }
    }
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
            if p.of_format {
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
