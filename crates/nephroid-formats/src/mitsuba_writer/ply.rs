//! Meshes as PLY files.

use nephroid::shape::Mesh;

/// A mesh in a binary PLY file, little-endian: what readers of PLY make of it is the mesh again, but for the last
/// bits of normals, which are brought to unit length anew. One without normals must be read with flat faces.
pub(super) fn encode(mesh: &Mesh) -> Vec<u8> {
    let (normals, uvs) = (!mesh.normals.is_empty(), !mesh.uvs.is_empty());
    let colors = !mesh.colors.is_empty();
    let mut header = String::from("ply\nformat binary_little_endian 1.0\n");
    let mut element = |name: &str, count: usize, properties: &[&str]| {
        header.push_str(&format!("element {name} {count}\n"));
        for property in properties {
            header.push_str(&format!("property {property}\n"));
        }
    };
    let mut of_vertex = vec!["float x", "float y", "float z"];
    if normals {
        of_vertex.extend(["float nx", "float ny", "float nz"]);
    }
    if uvs {
        of_vertex.extend(["float u", "float v"]);
    }
    if colors {
        of_vertex.extend(["float r", "float g", "float b"]);
    }
    element("vertex", mesh.positions.len(), &of_vertex);
    element("face", mesh.triangles.len(), &["list uchar int vertex_indices"]);
    header.push_str("end_header\n");
    let mut out = header.into_bytes();
    let mut floats = |values: &[f32]| out.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    for (i, position) in mesh.positions.iter().enumerate() {
        floats(&position.to_array());
        if normals {
            floats(&mesh.normals[i].to_array());
        }
        if uvs {
            floats(&mesh.uvs[i].to_array());
        }
        if colors {
            floats(&mesh.colors[i].to_array());
        }
    }
    for triangle in &mesh.triangles {
        out.push(3);
        out.extend(triangle.iter().flat_map(|i| i.to_le_bytes()));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{MeshOptions, read_ply};
    use nephroid::math::{Vec2, Vec3};

    #[test]
    fn meshes_come_back() {
        let flat = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(0.1, 1e-20, 3.0), Vec3::Y],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let round = Mesh { normals: vec![Vec3::Z, Vec3::NEG_X, Vec3::Y, Vec3::Z], ..flat.clone() };
        let uvs = vec![Vec2::ZERO, Vec2::new(0.5, -1.0), Vec2::Y, Vec2::new(7.0, 0.1)];
        for mesh in [flat.clone(), round.clone(), Mesh { uvs: uvs.clone(), ..flat }, Mesh { uvs, ..round }] {
            let options = MeshOptions { face_normals: mesh.normals.is_empty(), flip_tex_coords: false };
            assert_eq!(read_ply(&encode(&mesh), options).unwrap().mesh, mesh);
        }
    }
}
