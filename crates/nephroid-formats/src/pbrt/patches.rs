//! Bilinear patches.

use nephroid::handle::Handle;
use nephroid::math::{DVec3, Vec2};
use nephroid::shape::Mesh;

use super::parameters::Parameters;
use super::reader::Reader;
use super::shape::single;

/// Pieces of a side, where a patch is not flat.
const PIECES: u32 = 16;
/// The same where there are many patches.
const FEW_PIECES: u32 = 4;
/// From so many on.
const MANY: usize = 4096;

impl Reader<'_> {
    pub(super) fn bilinear_mesh(&mut self, parameters: &Parameters) -> Option<Handle<Mesh>> {
        let indices = self.indices(parameters, 4);
        let corners = self.vertices(parameters)?;
        let indices = match indices? {
            Some(indices) => indices,
            None if corners.positions.len() == 4 => vec![0, 1, 2, 3],
            None => {
                self.log.error(&parameters.at, "\"bilinearmesh\" lacks \"integer indices\"");
                return None;
            }
        };
        if let Some(image) = parameters.any("emissionfilename") {
            self.log.warn(&image.location, "\"emissionfilename\" of a shape cannot be had yet");
        }
        parameters.ignore(&["faceIndices"]);
        self.indices_fit(parameters, &indices, corners.positions.len())?;
        let pieces = if indices.len() / 4 > MANY { FEW_PIECES } else { PIECES };
        let mut mesh = Mesh::default();
        for patch in indices.chunks_exact(4) {
            Patch::new(&corners, patch).add_to(&mut mesh, pieces);
        }
        self.store_mesh(parameters, mesh)
    }
}

/// Values at the corners (0, 0), (1, 0), (0, 1) and (1, 1).
struct Patch {
    positions: [DVec3; 4],
    normals: Option<[DVec3; 4]>,
    uvs: [Vec2; 4],
}

impl Patch {
    fn new(mesh: &Mesh, indices: &[u32]) -> Self {
        let at = |k: usize| indices[k] as usize;
        let normals = std::array::from_fn(|k| mesh.normals.get(at(k)).map_or(DVec3::ZERO, |n| n.as_dvec3()));
        let own = [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE];
        Self {
            positions: std::array::from_fn(|k| mesh.positions[at(k)].as_dvec3()),
            normals: (!mesh.normals.is_empty()).then_some(normals),
            uvs: std::array::from_fn(|k| mesh.uvs.get(at(k)).copied().unwrap_or(own[k])),
        }
    }

    fn add_to(&self, mesh: &mut Mesh, pieces: u32) {
        let [p00, p10, p01, p11] = self.positions;
        let twist = (p00 - p10 - p01 + p11).length();
        let size = (p11 - p00).length().max((p10 - p01).length());
        // A parallelogram is two triangles.
        let n = if twist <= 1e-6 * size { 1 } else { pieces };
        let first = mesh.positions.len() as u32;
        for j in 0..=n {
            for i in 0..=n {
                let (u, v) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
                let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
                let position: DVec3 = self.positions.iter().zip(weights).map(|(p, w)| *p * w).sum();
                let normal = match self.normals {
                    Some(normals) => normals.iter().zip(weights).map(|(n, w)| *n * w).sum(),
                    None => {
                        let du = (p10 - p00) * (1.0 - v) + (p11 - p01) * v;
                        let dv = (p01 - p00) * (1.0 - u) + (p11 - p10) * u;
                        du.cross(dv)
                    }
                };
                let uv: Vec2 = self.uvs.iter().zip(weights).map(|(uv, w)| *uv * w as f32).sum();
                mesh.positions.push(single(position));
                mesh.normals.push(single(normal.normalize_or_zero()));
                mesh.uvs.push(uv);
            }
        }
        let place = |i: u32, j: u32| first + j * (n + 1) + i;
        for j in 0..n {
            for i in 0..n {
                let [a, b, c, d] = [place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)];
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid::math::Vec3;

    #[test]
    fn flat_patches_are_two_triangles_and_others_curve() {
        let mut corners = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)],
            ..Mesh::default()
        };
        let mut mesh = Mesh::default();
        Patch::new(&corners, &[0, 1, 2, 3]).add_to(&mut mesh, 4);
        assert_eq!((mesh.triangles.len(), mesh.normals[0], mesh.uvs[3]), (2, Vec3::Z, Vec2::ONE));
        corners.positions[3].z = 1.0;
        let mut mesh = Mesh::default();
        Patch::new(&corners, &[0, 1, 2, 3]).add_to(&mut mesh, 4);
        // The height is u·v.
        assert!(mesh.positions.iter().zip(&mesh.uvs).all(|(p, uv)| (p.z - uv.x * uv.y).abs() < 1e-6));
        assert_eq!(mesh.triangles.len(), 32);
    }
}
