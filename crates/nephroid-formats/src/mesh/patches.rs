//! Bilinear patches as meshes.

use nephroid::math::{Vec2, Vec3};
use nephroid::shape::Mesh;

use super::MeshError;
use super::grid::{Vertex, grid};

/// Cells along each side of a patch that is not flat.
const CELLS: u32 = 16;

/// Patches of four corners, as pbrt's `bilinearmesh` has them: at (0, 0), (1, 0), (0, 1) and (1, 1).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Patches {
    /// Positions of the corners.
    pub positions: Vec<Vec3>,
    /// A normal for each position, or empty: then those of the patches.
    pub normals: Vec<Vec3>,
    /// Texture coordinates for each position, or empty: then those of each patch are the unit square.
    pub uvs: Vec<Vec2>,
    /// Four corners each.
    pub patches: Vec<[u32; 4]>,
}

impl Patches {
    /// Triangles in their place: two for a parallelogram, which they meet exactly, else 512, whose vertices lie on the
    /// patch and have its normals.
    ///
    /// # Errors
    /// An index that leads nowhere, a list of another length than that of the positions, no patch with an area.
    pub fn to_mesh(&self) -> Result<Mesh, MeshError> {
        let count = self.positions.len();
        for (name, length) in [("normals", self.normals.len()), ("texture coordinates", self.uvs.len())] {
            if length != 0 && length != count {
                return Err(MeshError::new(format!("there are {length} {name} for {count} corners")));
            }
        }
        if let Some(bad) = self.patches.iter().flatten().find(|&&i| i as usize >= count) {
            return Err(MeshError::new(format!("corner {bad} does not exist: there are {count}")));
        }
        let mut mesh = Mesh::default();
        for patch in &self.patches {
            self.add(patch.map(|i| i as usize), &mut mesh);
        }
        if mesh.triangles.is_empty() {
            return Err(MeshError::new("no patch has an area"));
        }
        Ok(mesh)
    }

    fn add(&self, patch: [usize; 4], mesh: &mut Mesh) {
        let p = patch.map(|i| self.positions[i]);
        let [a, b, c, d] = p;
        let twist = (d - c) - (b - a);
        let size = (b - a).abs().max((c - a).abs()).max_element();
        // Corners are rounded, and so is what is left of their differences.
        let reach = p.iter().map(|p| p.abs().max_element()).fold(size, f32::max);
        let cells = if twist.abs().max_element() <= 8.0 * f32::EPSILON * reach { 1 } else { CELLS };
        let uvs = if self.uvs.is_empty() {
            [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE]
        } else {
            patch.map(|i| self.uvs[i])
        };
        // Where a side has no length, the normal is that of a place beside it.
        let inner = |v: f32| v.clamp(1e-3, 1.0 - 1e-3);
        grid(mesh, [cells, cells], false, |at| {
            let of_patch = || {
                let along_u = (b - a) * (1.0 - inner(at.y)) + (d - c) * inner(at.y);
                let along_v = (c - a) * (1.0 - inner(at.x)) + (d - b) * inner(at.x);
                along_u.cross(along_v)
            };
            let normal = if self.normals.is_empty() {
                of_patch()
            } else {
                between(patch.map(|i| self.normals[i]), at)
            };
            Vertex { position: between(p, at), normal, uv: between(uvs, at) }
        });
    }
}

fn between<T>([a, b, c, d]: [T; 4], at: Vec2) -> T
where
    T: std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    (a * (1.0 - at.x) + b * at.x) * (1.0 - at.y) + (c * (1.0 - at.x) + d * at.x) * at.y
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patch(lift: f32) -> Patches {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, lift)];
        Patches { positions, patches: vec![[0, 1, 2, 3]], ..Patches::default() }
    }

    #[test]
    fn a_flat_patch_is_two_triangles() {
        let mesh = patch(0.0).to_mesh().expect("a sound patch");
        assert_eq!(mesh.triangles, [[0, 1, 3], [0, 3, 2]]);
        assert_eq!((mesh.normals[0], mesh.uvs[3]), (Vec3::Z, Vec2::ONE));
    }

    #[test]
    fn a_twisted_patch_is_met_at_its_vertices() {
        // z = x·y, with the normal (−y, −x, 1).
        let mesh = patch(1.0).to_mesh().expect("a sound patch");
        assert_eq!(mesh.triangles.len(), 512);
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            assert!((p.z - p.x * p.y).abs() < 1e-6);
            assert!((*n - Vec3::new(-p.y, -p.x, 1.0).normalize()).length() < 3e-3);
        }
        let given = Patches { normals: vec![Vec3::X; 4], uvs: vec![Vec2::splat(0.5); 4], ..patch(1.0) };
        let mesh = given.to_mesh().expect("a sound patch");
        assert!(
            mesh.normals.iter().all(|n| *n == Vec3::X) && mesh.uvs.iter().all(|uv| *uv == Vec2::splat(0.5))
        );
    }

    #[test]
    fn broken_patches_are_told() {
        let bad = |patches: Patches| patches.to_mesh().expect_err("a broken patch").to_string();
        assert_eq!(
            bad(Patches { patches: vec![[0, 1, 2, 4]], ..patch(0.0) }),
            "corner 4 does not exist: there are 4"
        );
        let short = Patches { uvs: vec![Vec2::ZERO], ..patch(0.0) };
        assert_eq!(bad(short), "there are 1 texture coordinates for 4 corners");
        assert_eq!(bad(Patches { patches: vec![[0, 0, 0, 0]], ..patch(0.0) }), "no patch has an area");
    }
}
