//! `<integrator>`: handed on by name.

use nephroid::film::Aov;

use super::document::Element;
use super::names::property_is_known;
use super::reader::Reader;
use super::value::{Property, Value};
use crate::diagnostic::{Diagnostic, Location};
use crate::integrator_request::{AovLayer, IntegratorParameter, IntegratorRequest, ParameterValue};
use crate::log::shortened;

/// Values that `aov` knows in Mitsuba and that are not kept here.
const OTHER_AOVS: [&str; 7] =
    ["dp_du", "dp_dv", "duv_dx", "duv_dy", "prim_index", "shape_index", "boundary_test"];

/// Integrators that only wrap another one, to compute more about the same picture.
const WRAPPERS: [&str; 2] = ["moment", "aov"];

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
                let of_format = property_is_known(property.name);
                let at = property.location.clone();
                request.parameters.push(IntegratorParameter::new(property.name, value, at, of_format));
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
