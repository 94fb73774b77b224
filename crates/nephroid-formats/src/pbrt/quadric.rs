//! Spheres, cylinders and disks, and parts of them.

use nephroid::math::{DVec3, Transform, Vec3};
use nephroid::shape::{Geometry, Mesh};

use super::parameters::Parameters;
use super::shape::Form;
use crate::log::Log;
use crate::mesh::{cylinder_part, disk_part, sphere_part};

/// A form that the angle φ about z sweeps out, by parameters u and v in [0, 1].
pub(super) struct Quadric {
    kind: Kind,
    phi_max_deg: f64,
}

enum Kind {
    /// Of a radius, between heights.
    Sphere { radius: f64, from: f64, to: f64 },
    /// Of a radius, between heights.
    Cylinder { radius: f64, from: f64, to: f64 },
    /// At a height, from the outer to the inner radius.
    Disk { height: f64, outer: f64, inner: f64 },
}

impl Quadric {
    /// Reads one; `None` if nothing is left of it, and the log says so.
    pub(super) fn read(parameters: &Parameters, log: &Log) -> Option<Self> {
        let radius = parameters.positive("radius", 1.0);
        let phi_max_deg = parameters.float("phimax", 360.0).clamp(0.0, 360.0);
        let kind = match parameters.kind.as_str() {
            "sphere" => {
                let (a, b) = (parameters.float("zmin", -radius), parameters.float("zmax", radius));
                let within = |z: f64| z.clamp(-radius, radius);
                Kind::Sphere { radius, from: within(a.min(b)), to: within(a.max(b)) }
            }
            "cylinder" => {
                let (a, b) = (parameters.float("zmin", -1.0), parameters.float("zmax", 1.0));
                Kind::Cylinder { radius, from: a.min(b), to: a.max(b) }
            }
            _ => Kind::Disk {
                height: parameters.float("height", 0.0),
                outer: radius,
                inner: parameters.not_negative("innerradius", 0.0).min(radius),
            },
        };
        let empty = match kind {
            Kind::Sphere { from, to, .. } | Kind::Cylinder { from, to, .. } => to <= from,
            Kind::Disk { outer, inner, .. } => inner >= outer,
        };
        if empty || phi_max_deg <= 0.0 {
            log.error(&parameters.at, format!("nothing is left of the {}", parameters.kind));
            return None;
        }
        Some(Self { kind, phi_max_deg })
    }

    /// The same as one primitive, if it is whole and its transform leaves it one.
    pub(super) fn whole(&self, ctm: &Transform) -> Option<Form> {
        if self.phi_max_deg < 360.0 {
            return None;
        }
        let (geometry, to_object) = match self.kind {
            Kind::Sphere { radius, from, to } if from <= -radius && to >= radius => {
                // There v begins at −z, here at +z.
                let mirror = Transform::scale(DVec3::new(1.0, 1.0, -1.0));
                (Geometry::Sphere { center: Vec3::ZERO, radius: radius as f32 }, mirror)
            }
            Kind::Cylinder { radius, from, to } => {
                let end = |z: f64| Vec3::new(0.0, 0.0, z as f32);
                let geometry = Geometry::Cylinder { p0: end(from), p1: end(to), radius: radius as f32 };
                (geometry, Transform::IDENTITY)
            }
            Kind::Disk { height, outer, inner: 0.0 } => {
                let to_object = Transform::scale(DVec3::new(outer, outer, 1.0))
                    .then(Transform::translate(DVec3::new(0.0, 0.0, height)));
                return Some(Form { geometry: Geometry::Disk, to_object });
            }
            _ => return None,
        };
        ctm.uniform_scale().map(|_| Form { geometry, to_object })
    }

    /// Triangles with the normals of the form.
    pub(super) fn mesh(&self) -> Mesh {
        let turn = self.phi_max_deg as f32;
        match self.kind {
            Kind::Sphere { radius, from, to } => sphere_part(radius as f32, from as f32, to as f32, turn),
            Kind::Cylinder { radius, from, to } => cylinder_part(radius as f32, from as f32, to as f32, turn),
            Kind::Disk { height, outer, inner } => disk_part(height as f32, outer as f32, inner as f32, turn),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_whole_and_not_stretched_stays_what_it_is() {
        let sphere = |to| Quadric { kind: Kind::Sphere { radius: 1.0, from: -1.0, to }, phi_max_deg: 360.0 };
        assert!(sphere(1.0).whole(&Transform::IDENTITY).is_some());
        assert!(sphere(0.9).whole(&Transform::IDENTITY).is_none());
        assert!(sphere(1.0).whole(&Transform::scale(DVec3::new(1.0, 2.0, 1.0))).is_none());
        assert!(sphere(0.0).mesh().positions.iter().all(|p| p.z < 1e-6));
    }
}
