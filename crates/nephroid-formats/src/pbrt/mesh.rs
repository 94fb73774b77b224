//! Shapes of triangles.

use nephroid::handle::Handle;
use nephroid::math::{Vec2, Vec3};
use nephroid::shape::Mesh;

use super::include::inflated;
use super::parameter::Kind;
use super::parameters::Parameters;
use super::reader::Reader;
use crate::diagnostic::Location;
use crate::mesh::{MeshFile, MeshOptions, read_ply, replace_missing_normals, without_degenerate};

impl Reader<'_> {
    pub(super) fn triangle_mesh(&mut self, parameters: &Parameters) -> Option<Handle<Mesh>> {
        let indices = self.indices(parameters, 3);
        let mut mesh = self.vertices(parameters)?;
        mesh.triangles = match indices? {
            Some(indices) => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
            None if mesh.positions.len() == 3 => vec![[0, 1, 2]],
            None => {
                self.log.error(&parameters.at, "\"trianglemesh\" lacks \"integer indices\"");
                return None;
            }
        };
        // Tangents of older files, and numbers of faces for textures that are not read.
        parameters.ignore(&["S", "faceIndices"]);
        self.indices_fit(parameters, mesh.triangles.as_flattened(), mesh.positions.len())?;
        self.store_mesh(parameters, mesh)
    }

    /// Positions, normals and texture coordinates of a shape.
    pub(super) fn vertices(&self, parameters: &Parameters) -> Option<Mesh> {
        let triples = |name| {
            let (list, at) = parameters.numbers(name, &[Kind::Point3, Kind::Vector3, Kind::Normal])?;
            let list: Vec<_> =
                list.chunks_exact(3).map(|v| Vec3::new(v[0] as f32, v[1] as f32, v[2] as f32)).collect();
            Some((list, at))
        };
        let uv = ["uv", "st"].into_iter().find(|name| parameters.has(name)).unwrap_or("uv");
        let uvs = parameters.numbers(uv, &[Kind::Point2, Kind::Vector2, Kind::Float]);
        let normals = triples("N");
        let Some((positions, _)) = triples("P") else {
            if !parameters.has("P") {
                self.log.error(&parameters.at, format!("\"{}\" lacks \"point3 P\"", parameters.kind));
            }
            return None;
        };
        let fits = |name: &str, found: usize, at: &Location| {
            if found != positions.len() {
                let message = format!("{found} of \"{name}\" for {} of \"P\"", positions.len());
                self.log.error(at, message);
            }
            found == positions.len()
        };
        let mut mesh = Mesh::default();
        if let Some((normals, at)) = normals {
            fits("N", normals.len(), at).then_some(())?;
            mesh.normals = normals.into_iter().map(|n| n.try_normalize().unwrap_or(Vec3::ZERO)).collect();
        }
        if let Some((uvs, at)) = uvs {
            fits(uv, uvs.len().div_ceil(2), at).then_some(())?;
            if !uvs.len().is_multiple_of(2) {
                self.log.error(at, format!("\"{uv}\" has half a pair"));
                return None;
            }
            mesh.uvs = uvs.chunks_exact(2).map(|v| Vec2::new(v[0] as f32, v[1] as f32)).collect();
        }
        mesh.positions = positions;
        Some(mesh)
    }

    /// `indices`, so many to a face; none if they are not given, and nothing if something is wrong.
    pub(super) fn indices(&self, parameters: &Parameters, corners: usize) -> Option<Option<Vec<u32>>> {
        let Some((list, at)) = parameters.numbers("indices", &[Kind::Integer]) else {
            return if parameters.has("indices") { None } else { Some(None) };
        };
        if !list.len().is_multiple_of(corners) {
            let message = format!("{} indices are no faces of {corners} corners each", list.len());
            self.log.error(at, message);
            return None;
        }
        if let Some(wrong) = list.iter().find(|index| **index < 0.0) {
            self.log.error(at, format!("vertex {wrong} does not exist: the first is 0"));
            return None;
        }
        Some(Some(list.iter().map(|index| *index as u32).collect()))
    }

    /// Whether all vertices exist; else a message.
    pub(super) fn indices_fit(
        &self,
        parameters: &Parameters,
        indices: &[u32],
        vertices: usize,
    ) -> Option<()> {
        let Some(wrong) = indices.iter().find(|index| **index as usize >= vertices) else { return Some(()) };
        let at = parameters.any("indices").map_or(&parameters.at, |found| &found.value_at);
        self.log.error(at, format!("vertex {wrong} does not exist: there are {vertices}"));
        None
    }

    /// The mesh that `filename` names, read once.
    pub(super) fn ply_mesh(&mut self, parameters: &Parameters) -> Option<Handle<Mesh>> {
        for name in ["displacement", "edgelength"] {
            if let Some(found) = parameters.any(name) {
                let message = format!("\"{name}\": shapes cannot be displaced yet, and stay as they are");
                self.log.warn(&found.location, message);
            }
        }
        let Some((name, at)) = parameters.text("filename") else {
            if !parameters.has("filename") {
                self.log.error(&parameters.at, "shape \"plymesh\" lacks a filename");
            }
            return None;
        };
        let (path, bytes) = self.read_file(name, at)?;
        if let Some(handle) = self.mesh_of.get(&path) {
            return Some(*handle);
        }
        let bytes = inflated(&path, bytes, at, self.log)?;
        let file = self.log.mesh(at, &path, read_ply(&bytes, MeshOptions::default()))?;
        let handle = self.meshes.push(oriented(file));
        self.mesh_of.insert(path, handle);
        Some(handle)
    }

    /// A mesh of which each index is one of a vertex.
    pub(super) fn store_mesh(&mut self, parameters: &Parameters, mut mesh: Mesh) -> Option<Handle<Mesh>> {
        let has_normals = !mesh.normals.is_empty();
        if has_normals {
            replace_missing_normals(&mut mesh);
        }
        match without_degenerate(mesh, has_normals) {
            Ok(file) => {
                self.log.degenerate(&parameters.at, "the mesh", file.degenerate);
                Some(self.meshes.push(oriented(file)))
            }
            Err(_) => {
                let message =
                    format!("no face of the \"{}\" has an area, and it is left out", parameters.kind);
                self.log.warn(&parameters.at, message);
                None
            }
        }
    }
}

/// As pbrt has it: flat where normals are not given, and on the side of the normals where they are.
fn oriented(file: MeshFile) -> Mesh {
    let mut mesh = file.mesh;
    if !file.has_own_normals {
        mesh.normals.clear();
        return mesh;
    }
    for t in &mut mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
        let normal = t.iter().map(|i| mesh.normals[*i as usize].as_dvec3()).sum::<nephroid::math::DVec3>();
        if (b - a).cross(c - a).dot(normal) < 0.0 {
            t.swap(1, 2);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_turn_to_their_normals() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh =
            Mesh { positions, normals: vec![-Vec3::Z; 3], triangles: vec![[0, 1, 2]], ..Mesh::default() };
        let file = |has_own_normals| MeshFile { mesh: mesh.clone(), degenerate: 0, has_own_normals };
        assert_eq!(oriented(file(true)).triangles, [[0, 2, 1]]);
        assert!(oriented(file(false)).normals.is_empty());
    }
}
