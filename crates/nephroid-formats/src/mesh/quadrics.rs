//! Parts of spheres, cylinders and disks as meshes.
//!
//! Normals are those of the curved surface, so that shading hides the facets; outlines have corners. The texture
//! coordinates are pbrt's, from 0 to 1 over the part.

use nephroid::math::real::{acos, cos_deg, sin_deg};
use nephroid::math::{Vec2, Vec3};
use nephroid::shape::Mesh;

use super::grid::{Vertex, grid};

/// Facets around a whole turn.
const AROUND: f32 = 128.0;

/// Facets from pole to pole.
const ALONG: f32 = 64.0;

/// The part of a sphere about the origin between two heights, over the first `phi_max_deg` degrees from +x to +y. `u` goes
/// around, `v` from the lower end to the upper one in equal angles. The normal is outward.
pub fn sphere_part(radius: f32, z_min: f32, z_max: f32, phi_max_deg: f32) -> Mesh {
    let turn = turn_of(phi_max_deg);
    let theta = |z: f32| f64::from(acos((z / radius).clamp(-1.0, 1.0))).to_degrees();
    let (low, high) = (theta(z_min.min(z_max)), theta(z_min.max(z_max)));
    let rows = facets(ALONG, (low - high) / 180.0);
    let mut mesh = Mesh::default();
    grid(&mut mesh, [facets(AROUND, turn / 360.0), rows], false, |at| {
        let theta = low + f64::from(at.y) * (high - low);
        let out = around(f64::from(at.x) * turn) * sin_deg(theta) as f32;
        let normal = out + Vec3::Z * cos_deg(theta) as f32;
        Vertex { position: normal * radius, normal, uv: at }
    });
    mesh
}

/// The part of a cylinder around the z axis between two heights, over the first `phi_max_deg` degrees from +x to +y. `u`
/// goes around, `v` up. The normal is outward.
pub fn cylinder_part(radius: f32, z_min: f32, z_max: f32, phi_max_deg: f32) -> Mesh {
    let turn = turn_of(phi_max_deg);
    let (low, high) = (z_min.min(z_max), z_min.max(z_max));
    let mut mesh = Mesh::default();
    grid(&mut mesh, [facets(AROUND, turn / 360.0), 1], false, |at| {
        let normal = around(f64::from(at.x) * turn);
        Vertex { position: normal * radius + Vec3::Z * (low + at.y * (high - low)), normal, uv: at }
    });
    mesh
}

/// The part of a disk around the z axis at a height, beyond an inner radius, over the first `phi_max_deg` degrees from +x
/// to +y. `u` goes around, `v` from the rim inwards. The normal is +z.
pub fn disk_part(height: f32, radius: f32, inner_radius: f32, phi_max_deg: f32) -> Mesh {
    let turn = turn_of(phi_max_deg);
    let mut mesh = Mesh::default();
    grid(&mut mesh, [facets(AROUND, turn / 360.0), 1], false, |at| {
        let reach = radius + at.y * (inner_radius - radius);
        let position = around(f64::from(at.x) * turn) * reach + Vec3::Z * height;
        Vertex { position, normal: Vec3::Z, uv: Vec2::new(at.x, at.y) }
    });
    mesh
}

/// The unit vector at an angle from +x towards +y.
fn around(degrees: f64) -> Vec3 {
    Vec3::new(cos_deg(degrees) as f32, sin_deg(degrees) as f32, 0.0)
}

/// An angle that is usable.
fn turn_of(degrees: f32) -> f64 {
    if degrees > 0.0 { f64::from(degrees.min(360.0)) } else { 360.0 }
}

fn facets(whole: f32, part: f64) -> u32 {
    (f64::from(whole) * part.abs()).ceil().max(2.0) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(mesh: &Mesh) -> f64 {
        let corners = |t: &[u32; 3]| t.map(|i| mesh.positions[i as usize].as_dvec3());
        mesh.triangles.iter().map(corners).map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
    }

    /// Whether triangles turn the way their normals say.
    fn is_consistent(mesh: &Mesh) -> bool {
        mesh.triangles.iter().all(|t| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            t.iter().all(|&i| (b - a).cross(c - a).dot(mesh.normals[i as usize]) > 0.0)
        })
    }

    #[test]
    fn parts_have_the_areas_of_the_curved_surfaces() {
        use std::f64::consts::PI;
        let cases = [
            // Archimedes: a zone is as large as that of the cylinder around.
            (sphere_part(2.0, -1.0, 1.5, 90.0), 0.25 * 2.0 * PI * 2.0 * 2.5),
            (sphere_part(1.0, -1.0, 1.0, 360.0), 4.0 * PI),
            (cylinder_part(0.5, -1.0, 2.0, 120.0), PI / 3.0 * 3.0),
            (disk_part(1.0, 2.0, 0.5, 270.0), 0.75 * PI * (4.0 - 0.25)),
            (disk_part(0.0, 2.0, 0.0, 360.0), 4.0 * PI),
        ];
        for (mesh, expected) in cases {
            let found = area(&mesh);
            assert!(found < expected && found > 0.998 * expected, "{found} {expected}");
            assert!(is_consistent(&mesh), "of the area {expected}");
            assert!(mesh.uvs.iter().all(|uv| uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all()));
        }
    }

    #[test]
    fn parts_begin_at_x_and_their_coordinates_too() {
        let mesh = sphere_part(1.0, -0.5, 0.5, 180.0);
        assert!((mesh.positions[0] - Vec3::new(0.75f32.sqrt(), 0.0, -0.5)).length() < 1e-6);
        assert!((mesh.positions[0] + mesh.uvs[0].extend(0.0) - mesh.normals[0]).length() < 1e-6);
        let disk = disk_part(3.0, 2.0, 1.0, 90.0);
        let inner = disk.uvs.iter().position(|uv| *uv == Vec2::ONE).expect("a last corner");
        assert!((disk.positions[inner] - Vec3::new(0.0, 1.0, 3.0)).length() < 1e-6);
    }
}
