//! `<transform>`: a list of steps, applied from the first to the last.

use nephroid::math::{DAffine3, DMat3, DVec3, Transform};

use super::document::{Attribute, Element};
use crate::diagnostic::Diagnostic;
use crate::log::{Log, shortened};
use crate::number::{float, floats};

const STEPS: [&str; 5] = ["translate", "rotate", "scale", "lookat", "matrix"];

/// The map that a `<transform>` describes; `None` if the log says what is wrong.
pub(super) fn parse(element: &Element, log: &Log) -> Option<Transform> {
    let mut whole = Transform::IDENTITY;
    for step in &element.children {
        let next = match step.tag.as_str() {
            "translate" => Transform::translate(components(step, 0.0, log)?),
            "scale" => Transform::scale(components(step, 1.0, log)?),
            "rotate" => rotate(step, log)?,
            "lookat" => look_at(step, log)?,
            "matrix" => matrix(step, log)?,
            other => {
                let message = format!("<{other}> is not a step of a transform");
                log.push(Diagnostic::error(&step.location, message).did_you_mean(other, STEPS));
                return None;
            }
        };
        if let Some(child) = step.children.first() {
            log.error(&child.location, format!("<{}> holds no elements", step.tag));
        }
        whole = whole.then(next);
    }
    if !whole.is_invertible() {
        log.push(
            Diagnostic::error(&element.location, "the transform flattens space or overflows")
                .hint("no scale may be zero"),
        );
        return None;
    }
    Some(whole)
}

/// Three numbers from `value` (one or three) or from `x`, `y` and `z`.
fn components(step: &Element, missing: f64, log: &Log) -> Option<DVec3> {
    step.allow_attributes(&["x", "y", "z", "value", "angle"], log);
    if step.tag != "rotate"
        && let Some(angle) = step.attribute("angle")
    {
        log.error(&angle.location, format!("<{}> has no attribute \"angle\"", step.tag));
    }
    if let Some(value) = step.attribute("value") {
        if ["x", "y", "z"].iter().any(|axis| step.attribute(axis).is_some()) {
            log.error(&step.location, format!("<{}> has both \"value\" and \"x\", \"y\" or \"z\"", step.tag));
        }
        return match list(value, log)?.as_slice() {
            [v] => Some(DVec3::splat(*v)),
            [x, y, z] => Some(DVec3::new(*x, *y, *z)),
            other => {
                log.error(&value.location, format!("expected one or three numbers, found {}", other.len()));
                None
            }
        };
    }
    let axis = |name: &str| match step.attribute(name) {
        Some(attribute) => number(attribute, log),
        None => Some(missing),
    };
    Some(DVec3::new(axis("x")?, axis("y")?, axis("z")?))
}

fn rotate(step: &Element, log: &Log) -> Option<Transform> {
    let axis = components(step, 0.0, log)?;
    let angle = number(step.require("angle", log)?, log)?;
    if axis.try_normalize().is_none() {
        log.push(
            Diagnostic::error(&step.location, "the axis of the rotation has no length").hint("add y=\"1\""),
        );
        return None;
    }
    Some(Transform::rotate(axis, angle))
}

fn look_at(step: &Element, log: &Log) -> Option<Transform> {
    step.allow_attributes(&["origin", "target", "up"], log);
    let origin = vector(step.require("origin", log)?, log)?;
    let target = vector(step.require("target", log)?, log)?;
    let up = match step.attribute("up") {
        Some(up) => Some(vector(up, log)?).filter(|up| *up != DVec3::ZERO),
        None => None,
    };
    let Some(forward) = (target - origin).try_normalize() else {
        log.error(&step.location, "lookat: origin and target are the same point");
        return None;
    };
    let up = up.unwrap_or_else(|| forward.any_orthonormal_vector());
    let parallel = up.try_normalize().is_none_or(|up| up.cross(forward).length() < 1e-12);
    match Transform::look_at(origin, target, up) {
        Some(transform) if !parallel => Some(transform),
        _ => {
            log.error(&step.location, "lookat: \"up\" is parallel to the line of sight");
            None
        }
    }
}

fn matrix(step: &Element, log: &Log) -> Option<Transform> {
    step.allow_attributes(&["value"], log);
    let value = step.require("value", log)?;
    let m = list(value, log)?;
    let side = match m.len() {
        9 => 3,
        16 => 4,
        other => {
            log.error(&value.location, format!("a matrix has 9 or 16 numbers, not {other}"));
            return None;
        }
    };
    if side == 4 && m[12..] != [0.0, 0.0, 0.0, 1.0] {
        log.error(&value.location, "the last row of the matrix must be 0 0 0 1");
        return None;
    }
    let at = |row: usize, column: usize| m[row * side + column];
    let column = |c: usize| DVec3::new(at(0, c), at(1, c), at(2, c));
    let translation = if side == 4 { column(3) } else { DVec3::ZERO };
    let linear = DMat3::from_cols(column(0), column(1), column(2));
    Some(Transform(DAffine3::from_mat3_translation(linear, translation)))
}

pub(super) fn number(attribute: &Attribute, log: &Log) -> Option<f64> {
    float(&attribute.value).map_err(|message| log.error(&attribute.location, message)).ok()
}

pub(super) fn list(attribute: &Attribute, log: &Log) -> Option<Vec<f64>> {
    floats(&attribute.value).map_err(|message| log.error(&attribute.location, message)).ok()
}

fn vector(attribute: &Attribute, log: &Log) -> Option<DVec3> {
    match list(attribute, log)?.as_slice() {
        [x, y, z] => Some(DVec3::new(*x, *y, *z)),
        _ => {
            let message = format!("expected three numbers, found \"{}\"", shortened(&attribute.value));
            log.error(&attribute.location, message);
            None
        }
    }
}
