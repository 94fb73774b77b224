//! Triangle meshes: from files, and from shapes that are made of triangles here.

mod grid;
mod gzip;
mod obj;
mod patches;
mod ply;
mod ply_binary;
mod quadrics;
mod serialized;
mod subdivide;

pub use obj::read_obj;
pub(crate) use obj::replace_missing_normals;
pub use patches::Patches;
pub use ply::read_ply;
pub use quadrics::{cylinder_part, disk_part, sphere_part};
pub use serialized::read_serialized;
pub use subdivide::loop_subdivision;

use nephroid::math::Vec3;
use nephroid::shape::Mesh;
use thiserror::Error;

/// How to read a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshOptions {
    /// Leave triangles flat, whatever the file says of normals.
    pub face_normals: bool,
    /// Replace `v` by `1 − v`.
    pub flip_tex_coords: bool,
}

/// A mesh and what had to be left out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// At least one triangle, each with an area.
    pub mesh: Mesh,
    /// Triangles without area that were left out.
    pub degenerate: usize,
    /// Whether the normals are those of the file, and not computed.
    pub has_own_normals: bool,
}

/// Why a file is not a mesh.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}{message}", line.map(|line| format!("line {line}: ")).unwrap_or_default())]
pub struct MeshError {
    /// The line of the file, from 1, if that is known.
    pub line: Option<usize>,
    /// What is wrong.
    pub message: String,
    /// Whether all that is wrong is that none of its faces has an area: there is nothing to see.
    pub is_flat: bool,
}

impl MeshError {
    fn new(message: impl Into<String>) -> Self {
        Self { line: None, message: message.into(), is_flat: false }
    }

    fn at(line: usize, message: impl Into<String>) -> Self {
        Self { line: Some(line), message: message.into(), is_flat: false }
    }
}

/// Leaves out triangles without area; an error if no others are left.
pub(crate) fn without_degenerate(mut mesh: Mesh, has_own_normals: bool) -> Result<MeshFile, MeshError> {
    let all = mesh.triangles.len();
    if all == 0 {
        return Err(MeshError::new("the file has no faces"));
    }
    let positions = &mesh.positions;
    mesh.triangles.retain(|triangle| has_area(triangle.map(|i| positions[i as usize])));
    let degenerate = all - mesh.triangles.len();
    if degenerate == all {
        return Err(MeshError { is_flat: true, ..MeshError::new("no face of the file has an area") });
    }
    Ok(MeshFile { mesh, degenerate, has_own_normals })
}

/// In double precision, so that small triangles are not taken for none.
fn has_area(p: [Vec3; 3]) -> bool {
    let [a, b, c] = p.map(Vec3::as_dvec3);
    (b - a).cross(c - a).length_squared() > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiny_triangles_have_an_area() {
        assert!(has_area([Vec3::ZERO, Vec3::X * 1e-30, Vec3::Y * 1e-30]));
        assert!(!has_area([Vec3::ZERO, Vec3::X, Vec3::X * 3.0]));
    }
}
