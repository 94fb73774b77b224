//! Integrator and sampler.

use super::names::{INTEGRATORS, SAMPLERS};
use super::parameters::Parameters;
use super::reader::Reader;
use crate::integrator_request::{IntegratorParameter, IntegratorRequest, ParameterValue};

/// Surfaces that a path of pbrt meets if nothing else is said.
const DEFAULT_DEPTH: u32 = 5;

impl Reader<'_> {
    /// The integrator, handed on by the name that it has here where it has one.
    pub(super) fn integrator(&mut self, parameters: &Parameters) {
        let known = INTEGRATORS.contains(&parameters.kind.as_str());
        if !known {
            self.unknown_kind(parameters, &[INTEGRATORS]);
        }
        let name = match parameters.kind.as_str() {
            "path" | "simplepath" | "directlighting" | "whitted" => "path",
            "volpath" | "simplevolpath" => "volpath",
            "lightpath" => "ptracer",
            "sppm" => "ppm",
            other => other,
        };
        let mut request = IntegratorRequest::default();
        (request.name, request.location) = (name.to_owned(), Some(parameters.at.clone()));
        // There the light that is seen at once has depth 0, here 1.
        let depth = parameters.integer("maxdepth", DEFAULT_DEPTH, 0..=i32::MAX as u32);
        let at = parameters.any("maxdepth").map_or(&parameters.at, |p| &p.value_at).clone();
        let depth = ParameterValue::Int(i64::from(depth) + 1);
        request.parameters.push(IntegratorParameter::new("max_depth", depth, at, true));
        if parameters.boolean("regularize", false) {
            let message = "\"regularize\" means nothing here: mirrors stay sharp";
            self.log.warn(&parameters.at, message);
        }
        // The rest is about how to get the same picture.
        parameters.finish_approximated();
        self.integrator = request;
    }

    /// How many samples a pixel has; which numbers they are is this renderer's own business.
    pub(super) fn sampler(&mut self, parameters: &Parameters) {
        if !SAMPLERS.contains(&parameters.kind.as_str()) {
            self.unknown_kind(parameters, &[SAMPLERS]);
        }
        let count = if parameters.kind == "stratified" {
            let side = |name| u64::from(parameters.integer(name, 4, 1..=65_536));
            Some(side("xsamples") * side("ysamples"))
        } else {
            let count = parameters.integer("pixelsamples", 16, 1..=i32::MAX as u32);
            parameters.has("pixelsamples").then_some(u64::from(count))
        };
        self.sample_count = count.map(|count| u32::try_from(count).unwrap_or(u32::MAX));
        parameters.finish_approximated();
    }
}
