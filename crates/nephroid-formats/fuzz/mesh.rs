//! What is asked of every mesh that a reader lets through.

use nephroid_formats::mesh::{MeshError, MeshFile};

/// Panics where a mesh breaks a promise of its reader, or an error has nothing to say.
pub fn check(read: Result<MeshFile, MeshError>) {
    let mesh = match read {
        Ok(file) => file.mesh,
        Err(error) => {
            assert!(!error.message.is_empty() && !error.message.contains('\n'), "{error:?}");
            return;
        }
    };
    let count = mesh.positions.len();
    assert!(!mesh.triangles.is_empty());
    assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < count));
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(mesh.uvs.is_empty() || mesh.uvs.len() == count);
    assert!(mesh.uvs.iter().all(|uv| uv.is_finite()));
    assert!(mesh.normals.is_empty() || mesh.normals.len() == count);
    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3), "{:?}", mesh.normals);
}
