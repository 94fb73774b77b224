//! Directives that move what follows.

use nephroid::math::{DAffine3, DMat3, DVec3, Transform};

use super::reader::Reader;
use super::token::Tokens;
use crate::diagnostic::{Diagnostic, Location};
use crate::log::shortened;

impl Reader<'_> {
    pub(super) fn transform(&mut self, directive: &'static str, at: &Location, tokens: &mut Tokens) {
        let Some(step) = self.step(directive, at, tokens) else { return };
        if matches!(directive, "Identity" | "Transform") {
            self.state.is_hidden = false;
        }
        // What animations hide has no size. That something is not finite is another matter.
        if self.in_world && step.0.is_finite() && step.0.matrix3.determinant() == 0.0 {
            self.state.is_hidden = true;
            let has_size = step.0.matrix3 != DMat3::ZERO;
            if has_size || !self.told_of_hidden {
                let message = format!("{directive} flattens space: what it would hold is left out");
                let message = Diagnostic::warning(at, message);
                self.log.push(if has_size { message } else { message.hint("this is told once") });
            }
            self.told_of_hidden |= !has_size;
            return;
        }
        if !step.is_invertible() {
            let message = Diagnostic::error(at, format!("{directive} flattens space or overflows"));
            self.log.push(message.hint("no scale may be zero"));
            return;
        }
        // What is said last is done first.
        self.state.ctm = match directive {
            "Identity" | "Transform" => step,
            _ => step.then(self.state.ctm),
        };
    }

    fn step(&self, directive: &'static str, at: &Location, tokens: &mut Tokens) -> Option<Transform> {
        match directive {
            "Translate" => Some(Transform::translate(self.follow(directive, at, tokens)?.into())),
            "Scale" => Some(Transform::scale(self.follow(directive, at, tokens)?.into())),
            "Rotate" => {
                let [degrees, x, y, z] = self.follow(directive, at, tokens)?;
                let axis = DVec3::new(x, y, z);
                if axis.try_normalize().is_none() {
                    self.log.error(at, "the axis of the rotation has no length");
                    return None;
                }
                Some(Transform::rotate(axis, degrees))
            }
            "LookAt" => {
                let v: [f64; 9] = self.follow(directive, at, tokens)?;
                self.look_at(
                    DVec3::from_slice(&v),
                    DVec3::from_slice(&v[3..]),
                    DVec3::from_slice(&v[6..]),
                    at,
                )
            }
            "Transform" | "ConcatTransform" => self.matrix(self.follow(directive, at, tokens)?, at),
            _ => Some(Transform::IDENTITY),
        }
    }

    /// From the world to a camera that looks along +z, with +x to its right.
    fn look_at(&self, eye: DVec3, target: DVec3, up: DVec3, at: &Location) -> Option<Transform> {
        let Some(forward) = (target - eye).try_normalize() else {
            self.log.error(at, "LookAt: the eye and what it looks at are the same point");
            return None;
        };
        let parallel = up.try_normalize().is_none_or(|up| up.cross(forward).length() < 1e-12);
        match Transform::look_at(eye, target, up) {
            Some(to_world) if !parallel => Some(to_world.inverse()),
            _ => {
                self.log.error(at, "LookAt: up is parallel to the line of sight");
                None
            }
        }
    }

    /// Sixteen numbers, column by column.
    fn matrix(&self, m: [f64; 16], at: &Location) -> Option<Transform> {
        if m[3] != 0.0 || m[7] != 0.0 || m[11] != 0.0 || m[15] == 0.0 {
            let message = "the matrix does not keep parallel lines so";
            let message = Diagnostic::error(at, message);
            self.log.push(message.hint("every fourth number must be 0, the last one 1"));
            return None;
        }
        let column = |i: usize| DVec3::new(m[i], m[i + 1], m[i + 2]) / m[15];
        let linear = DMat3::from_cols(column(0), column(4), column(8));
        Some(Transform(DAffine3::from_mat3_translation(linear, column(12))))
    }

    pub(super) fn coordinate_system(&mut self, directive: &str, name: &str, at: &Location) {
        if directive == "CoordinateSystem" {
            self.coordinate_systems.insert(name.to_owned(), (self.state.ctm, self.state.is_hidden));
            return;
        }
        match self.coordinate_systems.get(name) {
            Some(known) => (self.state.ctm, self.state.is_hidden) = *known,
            None => {
                let message = format!("no coordinate system is called \"{}\"", shortened(name));
                let known = self.coordinate_systems.keys().map(String::as_str);
                self.log.push(Diagnostic::error(at, message).did_you_mean(name, known));
            }
        }
    }
}
