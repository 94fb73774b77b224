//! `LightSource`.

use nephroid::color::Rgb;
use nephroid::light::{Light, LightKind};
use nephroid::math::real::cos;
use nephroid::math::{DVec3, Transform};

use super::names::LIGHTS;
use super::parameters::Parameters;
use super::reader::Reader;
use crate::spectra::Role;

use std::f32::consts::PI;

/// Luminance of linear sRGB.
pub(super) fn luminance(rgb: Rgb) -> f32 {
    0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b
}

impl Reader<'_> {
    /// Reads a light into the scene; what is wrong goes to the log.
    pub(super) fn light(&mut self, parameters: &Parameters) {
        let kind = match parameters.kind.as_str() {
            "point" => Some(self.point(parameters)),
            "spot" => self.spot(parameters),
            "distant" => self.distant(parameters),
            "infinite" => self.infinite(parameters),
            "goniometric" => self.goniometric(parameters),
            "projection" => self.projection(parameters),
            _ => {
                self.unknown_kind(parameters, &[LIGHTS]);
                return;
            }
        };
        parameters.finish();
        let Some(kind) = kind.filter(|_| !self.state.is_hidden) else { return };
        if self.object.is_some() {
            let message = "the light is of the scene, and not of the object that it stands in";
            self.log.warn(&parameters.at, message);
        }
        let medium = match kind {
            LightKind::Point { .. } | LightKind::Spot { .. } => self.state.outside,
            _ => None,
        };
        self.origins.lights.push(parameters.at.clone());
        self.lights.push(Light { name: parameters.name(), kind, medium });
    }

    /// A light's colour times its `scale`. If it says how strong it is in all (`target`), as many times
    /// that as `of_one` is too little: the value of one with a luminance of one.
    pub(super) fn strength(
        &self,
        parameters: &Parameters,
        name: &'static str,
        target: &'static str,
        of_one: f64,
    ) -> Rgb {
        let white = self.color_space().to_srgb([1.0; 3]);
        let color = self.color(parameters, name, white, Role::Emission);
        color * self.scale(parameters, target, of_one)
    }

    /// The factor of that, and of the sensor.
    pub(super) fn scale(&self, parameters: &Parameters, target: &'static str, of_one: f64) -> f32 {
        let scale = parameters.not_negative("scale", 1.0);
        let wanted = match parameters.optional_float(target) {
            // As pbrt has it, zero and less say nothing.
            Some(value) if value > 0.0 && of_one > 0.0 => value / of_one,
            _ => 1.0,
        };
        (scale * wanted) as f32 * self.exposure
    }

    /// `ctm` if it moves, turns, mirrors and scales alike; else a message.
    pub(super) fn rigid(&self, parameters: &Parameters, ctm: Transform) -> Option<Transform> {
        if ctm.uniform_scale().is_some() {
            return Some(ctm);
        }
        self.log.error(&parameters.at, "a light may be turned, mirrored and scaled alike, but not stretched");
        None
    }

    fn point(&self, parameters: &Parameters) -> LightKind {
        let intensity = self.strength(parameters, "I", "power", 4.0 * f64::from(PI));
        let from = parameters.triple("from").unwrap_or(DVec3::ZERO);
        LightKind::Point { position: self.state.ctm.0.transform_point3(from).as_vec3(), intensity }
    }

    /// A cone that is full up to `coneangle` − `conedeltaangle`. pbrt's edge is smooth in the cosine of the angle.
    fn spot(&self, parameters: &Parameters) -> Option<LightKind> {
        let cutoff = parameters
            .float_that("coneangle", 30.0, "between 0 and 90 degrees", |v| v > 0.0 && v < 90.0)
            as f32;
        let delta = parameters.not_negative("conedeltaangle", 5.0) as f32;
        let full = (cutoff - delta).max(0.0);
        let (cos_full, cos_end) = (cos(full.to_radians()), cos(cutoff.to_radians()));
        let of_one = 2.0 * PI * ((1.0 - cos_full) + (cos_full - cos_end) / 2.0);
        let intensity = self.strength(parameters, "I", "power", f64::from(of_one));
        let from = parameters.triple("from").unwrap_or(DVec3::ZERO);
        let to = parameters.triple("to").unwrap_or(DVec3::Z);
        let Some(axis) = (to - from).try_normalize() else {
            self.log.error(&parameters.at, "\"from\" and \"to\" are the same point");
            return None;
        };
        let aim = Transform::look_at(from, to, axis.any_orthonormal_vector())?;
        let to_world = self.rigid(parameters, aim.then(self.state.ctm))?;
        Some(LightKind::Spot { to_world, intensity, cutoff_deg: cutoff, beam_width_deg: full, texture: None })
    }

    fn distant(&self, parameters: &Parameters) -> Option<LightKind> {
        let irradiance = self.strength(parameters, "L", "illuminance", 1.0);
        let from = parameters.triple("from").unwrap_or(DVec3::ZERO);
        let to = parameters.triple("to").unwrap_or(DVec3::Z);
        let Some(direction) = self.state.ctm.0.transform_vector3(to - from).try_normalize() else {
            self.log.error(&parameters.at, "\"from\" and \"to\" are the same point");
            return None;
        };
        Some(LightKind::Directional { direction: direction.as_vec3(), irradiance })
    }
}
