//! Spheres, cylinders and disks, and parts of them.

use std::f64::consts::PI;

use nephroid::math::{DVec3, Transform, Vec2, Vec3};
use nephroid::shape::{Geometry, Mesh};

use super::parameters::Parameters;
use super::shape::{Form, single};
use crate::log::Log;

/// Pieces of a full turn, where a form becomes triangles.
const TURN: u32 = 96;

/// A form that the angle φ about z sweeps out, by parameters u and v in [0, 1].
pub(super) struct Quadric {
    kind: Kind,
    phi_max: f64,
}

enum Kind {
    /// Of a radius, between polar angles measured from −z.
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
        let phi_max = parameters.float("phimax", 360.0).clamp(0.0, 360.0).to_radians();
        let kind = match parameters.kind.as_str() {
            "sphere" => {
                let (a, b) = (parameters.float("zmin", -radius), parameters.float("zmax", radius));
                let polar =
                    |z: f64| if z >= radius { PI } else { libm::acos((-z / radius).clamp(-1.0, 1.0)) };
                Kind::Sphere { radius, from: polar(a.min(b)), to: polar(a.max(b)) }
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
        if empty || phi_max <= 0.0 {
            log.error(&parameters.at, format!("nothing is left of the {}", parameters.kind));
            return None;
        }
        Some(Self { kind, phi_max })
    }

    /// The same as one primitive, if it is whole and its transform leaves it one.
    pub(super) fn whole(&self, ctm: &Transform) -> Option<Form> {
        if self.phi_max < 2.0 * PI {
            return None;
        }
        let (geometry, to_object) = match self.kind {
            Kind::Sphere { radius, from, to } if from <= 0.0 && to >= PI => {
                // There v begins at −z, here at +z.
                let mirror = Transform::scale(DVec3::new(1.0, 1.0, -1.0));
                (Geometry::Sphere { center: Vec3::ZERO, radius: radius as f32 }, mirror)
            }
            Kind::Cylinder { radius, from, to } => {
                let end = |z: f64| Vec3::new(0.0, 0.0, z as f32);
                let geometry = Geometry::Cylinder { p0: end(from), p1: end(to), radius: radius as f32 };
                (geometry, Transform::IDENTITY)
            }
            Kind::Disk { height, outer, inner } if inner == 0.0 => {
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
        let columns = ((self.phi_max / (2.0 * PI) * f64::from(TURN)).ceil() as u32).max(1);
        let rows = match self.kind {
            Kind::Sphere { from, to, .. } => ((to - from) / PI * f64::from(TURN / 2)).ceil().max(1.0) as u32,
            Kind::Cylinder { .. } | Kind::Disk { .. } => 1,
        };
        let mut mesh = Mesh::default();
        for j in 0..=rows {
            for i in 0..=columns {
                let (u, v) = (f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows));
                let (position, normal) = self.point(u, v);
                mesh.positions.push(single(position));
                mesh.normals.push(single(normal));
                mesh.uvs.push(Vec2::new(u as f32, v as f32));
            }
        }
        let place = |i: u32, j: u32| j * (columns + 1) + i;
        let [point_first, point_last] = self.ends_in_a_point();
        for j in 0..rows {
            for i in 0..columns {
                let [a, b, c, d] = [place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)];
                if j > 0 || !point_first {
                    mesh.triangles.push([a, b, c]);
                }
                if j + 1 < rows || !point_last {
                    mesh.triangles.push([a, c, d]);
                }
            }
        }
        mesh
    }

    /// Whether all of v = 0, and of v = 1, is one point.
    fn ends_in_a_point(&self) -> [bool; 2] {
        match self.kind {
            Kind::Sphere { from, to, .. } => [from <= 0.0, to >= PI],
            Kind::Cylinder { .. } => [false; 2],
            Kind::Disk { inner, .. } => [false, inner == 0.0],
        }
    }

    fn point(&self, u: f64, v: f64) -> (DVec3, DVec3) {
        let phi = u * self.phi_max;
        let around = DVec3::new(libm::cos(phi), libm::sin(phi), 0.0);
        match self.kind {
            Kind::Sphere { radius, from, to } => {
                let theta = from + v * (to - from);
                let normal = around * libm::sin(theta) - DVec3::Z * libm::cos(theta);
                (normal * radius, normal)
            }
            Kind::Cylinder { radius, from, to } => {
                (around * radius + DVec3::Z * (from + v * (to - from)), around)
            }
            Kind::Disk { height, outer, inner } => {
                (around * (outer + v * (inner - outer)) + DVec3::Z * height, DVec3::Z)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(mesh: &Mesh) -> f64 {
        let place = |i: u32| mesh.positions[i as usize].as_dvec3();
        let area = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a).length();
        mesh.triangles.iter().map(|t| area(t.map(place))).sum()
    }

    /// Triangles with their corners on the form have its area but for a part in some hundred, and their
    /// normals are on its side.
    #[test]
    fn parts_have_their_areas_and_normals() {
        let quarter = PI / 2.0;
        for (kind, expected) in [
            // A zone of height h has area φ·r·h.
            (Kind::Sphere { radius: 2.0, from: PI / 3.0, to: PI / 2.0 }, quarter * 2.0 * 1.0),
            (Kind::Cylinder { radius: 0.5, from: -1.0, to: 3.0 }, quarter * 0.5 * 4.0),
            (Kind::Disk { height: 1.0, outer: 2.0, inner: 1.0 }, quarter * (4.0 - 1.0) / 2.0),
        ] {
            let mesh = Quadric { kind, phi_max: quarter }.mesh();
            assert!((area(&mesh) / expected - 1.0).abs() < 2e-3, "{} {expected}", area(&mesh));
            for t in &mesh.triangles {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                let normal = (b - a).cross(c - a);
                assert!(normal.dot(mesh.normals[t[0] as usize]) > 0.0);
            }
        }
    }

    #[test]
    fn what_is_whole_and_not_stretched_stays_what_it_is() {
        let sphere = |to| Quadric { kind: Kind::Sphere { radius: 1.0, from: 0.0, to }, phi_max: 2.0 * PI };
        assert!(sphere(PI).whole(&Transform::IDENTITY).is_some());
        assert!(sphere(3.0).whole(&Transform::IDENTITY).is_none());
        assert!(sphere(PI).whole(&Transform::scale(DVec3::new(1.0, 2.0, 1.0))).is_none());
    }
}
