//! The primitives of a mesh as triangles.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::math::{Vec2, Vec3};
use nephroid::shape::Mesh;

use super::item::Item;
use super::reader::Reader;
use crate::mesh::without_degenerate;

/// Triangles of all meshes together.
const MAX_TRIANGLES: usize = 1 << 28;

/// What a mesh is made of: its mode and the places of its accessors. Equal ones are stored once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Ingredients {
    mode: usize,
    indices: Option<usize>,
    positions: Option<usize>,
    normals: Option<usize>,
    uvs: Option<usize>,
    colors: Option<usize>,
}

impl<'d> Reader<'d> {
    /// The triangles of a primitive, with the texture coordinates of one set. `None` if it has none, or the log says why.
    pub(super) fn mesh(
        &mut self,
        primitive: Item<'d>,
        uv_set: usize,
        with_colors: bool,
    ) -> Option<Handle<Mesh>> {
        let mode = primitive.whole("mode").unwrap_or(4);
        if mode < 4 {
            self.once(primitive, "points and lines have no surface, and are left out");
            return None;
        }
        if mode > 6 {
            primitive.error(format!("there is no \"mode\" {mode}: 4 is triangles"));
            return None;
        }
        let attributes = primitive.object("attributes")?;
        let uv_name = format!("TEXCOORD_{uv_set}");
        let place = |name: &str| attributes.get(name).and_then(|index| index.as_whole());
        let ingredients = Ingredients {
            mode,
            indices: primitive.get("indices").and_then(|index| index.as_whole()),
            positions: place("POSITION"),
            normals: place("NORMAL"),
            uvs: place(&uv_name),
            colors: if with_colors { place("COLOR_0") } else { None },
        };
        if let Some(known) = self.mesh_of.get(&ingredients) {
            return *known;
        }
        let mesh = self.new_mesh(primitive, attributes, mode, &uv_name, with_colors);
        let handle = mesh.map(|mesh| self.meshes.push(mesh));
        self.mesh_of.insert(ingredients, handle);
        handle
    }

    fn new_mesh(
        &mut self,
        primitive: Item<'d>,
        attributes: Item<'d>,
        mode: usize,
        uv_name: &str,
        with_colors: bool,
    ) -> Option<Mesh> {
        let buffers = &mut self.buffers;
        let Some(positions) = buffers.attribute(attributes, "POSITION", [0.0; 3])? else {
            self.once(primitive, "a primitive without \"POSITION\" shows nothing, and is left out");
            return None;
        };
        let normals = buffers.attribute(attributes, "NORMAL", [0.0; 3])?;
        let uvs = buffers.attribute(attributes, uv_name, [0.0; 2])?;
        let colors = if with_colors { self.colors(attributes)? } else { None };
        for (name, count) in [
            ("NORMAL", normals.as_ref().map(Vec::len)),
            (uv_name, uvs.as_ref().map(Vec::len)),
            ("COLOR_0", colors.as_ref().map(Vec::len)),
        ] {
            if let Some(count) = count.filter(|count| *count != positions.len()) {
                attributes.error(format!("{} vertices have {count} of \"{name}\"", positions.len()));
                return None;
            }
        }
        let indices = match primitive.has("indices") {
            true => {
                let (_, accessor) = primitive.refers("indices", "accessors")?;
                let indices = self.buffers.indices(accessor)?;
                if let Some(beyond) = indices.iter().find(|index| **index as usize >= positions.len()) {
                    accessor.error(format!("vertex {beyond} is used, and there are {}", positions.len()));
                    return None;
                }
                indices
            }
            false => (0..u32::try_from(positions.len()).ok()?).collect(),
        };
        let triangles = triangles(mode, &indices);
        self.triangle_count = self.triangle_count.saturating_add(triangles.len());
        if self.triangle_count > MAX_TRIANGLES {
            primitive.error(format!("the meshes have more than {MAX_TRIANGLES} triangles"));
            return None;
        }
        if triangles.is_empty() {
            self.once(primitive, "a primitive without triangles shows nothing, and is left out");
            return None;
        }
        let mut mesh = Mesh {
            positions: positions.into_iter().map(Vec3::from).collect(),
            normals: normals.unwrap_or_default().into_iter().map(Vec3::from).collect(),
            uvs: uvs.unwrap_or_default().into_iter().map(Vec2::from).collect(),
            colors: colors.unwrap_or_default(),
            triangles,
        };
        make_unit(&mut mesh);
        self.finished(primitive, mesh, mode)
    }

    /// The colours of the vertices, as linear factors; what may be their opacity is left out.
    fn colors(&mut self, attributes: Item<'d>) -> Option<Option<Vec<Rgb>>> {
        if !attributes.has("COLOR_0") {
            return Some(None);
        }
        let (_, accessor) = attributes.refers("COLOR_0", "accessors")?;
        let values = self.buffers.floats(accessor, 3, [1.0; 4])?;
        if values.iter().any(|value| value[3] != 1.0) {
            self.once(accessor, "the opacity of vertices (\"COLOR_0\") is left out; their colours are read");
        }
        Some(Some(values.into_iter().map(|[r, g, b, _]| Rgb::new(r, g, b)).collect()))
    }

    /// Without what cannot be seen.
    fn finished(&mut self, primitive: Item<'d>, mesh: Mesh, mode: usize) -> Option<Mesh> {
        match without_degenerate(mesh, true) {
            Ok(file) => {
                // Strips are joined by triangles without area.
                if file.degenerate > 0 && mode == 4 {
                    let faces = if file.degenerate == 1 { "triangle" } else { "triangles" };
                    primitive.warn(format!("left out {} {faces} without area", file.degenerate));
                }
                Some(compact(file.mesh))
            }
            Err(_) => {
                primitive.warn("no triangle of the primitive has an area, and it is left out");
                None
            }
        }
    }
}

/// The triangles of a list (4), a strip (5) or a fan (6) (glTF 2.0, §3.7.2.1).
fn triangles(mode: usize, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        4 => indices.as_chunks::<3>().0.to_vec(),
        5 => indices
            .windows(3)
            .enumerate()
            .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] })
            .collect(),
        _ => indices.windows(2).skip(1).map(|w| [indices[0], w[0], w[1]]).collect(),
    }
}

/// Gives normals unit length; those without any are made from the triangles around them.
fn make_unit(mesh: &mut Mesh) {
    let mut lost = Vec::new();
    for (i, normal) in mesh.normals.iter_mut().enumerate() {
        match normal.as_dvec3().try_normalize() {
            Some(unit) => *normal = unit.as_vec3(),
            None => lost.push(i),
        }
    }
    if lost.is_empty() {
        return;
    }
    let given = std::mem::take(&mut mesh.normals);
    mesh.compute_normals();
    let made = std::mem::replace(&mut mesh.normals, given);
    for i in lost {
        mesh.normals[i] = made[i];
    }
}

/// Leaves out vertices that no triangle has: primitives often share the buffers of a whole model.
fn compact(mesh: Mesh) -> Mesh {
    const UNUSED: u32 = u32::MAX;
    let mut place = vec![UNUSED; mesh.positions.len()];
    let mut kept = Vec::new();
    for index in mesh.triangles.iter().flatten() {
        let place = &mut place[*index as usize];
        if *place == UNUSED {
            *place = kept.len() as u32;
            kept.push(*index as usize);
        }
    }
    if kept.len() == mesh.positions.len() {
        return mesh;
    }
    Mesh {
        positions: chosen(&mesh.positions, &kept),
        normals: chosen(&mesh.normals, &kept),
        uvs: chosen(&mesh.uvs, &kept),
        colors: chosen(&mesh.colors, &kept),
        triangles: mesh.triangles.iter().map(|t| t.map(|i| place[i as usize])).collect(),
    }
}

/// The values at the kept places, of an attribute that may be missing.
fn chosen<T: Copy>(values: &[T], kept: &[usize]) -> Vec<T> {
    if values.is_empty() { Vec::new() } else { kept.iter().map(|i| values[*i]).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_side() {
        let indices = [0, 1, 2, 3, 4];
        assert_eq!(triangles(4, &indices), [[0, 1, 2]]);
        assert_eq!(triangles(5, &indices), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(triangles(6, &indices), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert!(triangles(5, &[0, 1]).is_empty() && triangles(6, &[]).is_empty());
    }

    #[test]
    fn vertices_that_nothing_uses_go() {
        let positions: Vec<Vec3> = (0..5).map(|i| Vec3::splat(i as f32)).collect();
        let mesh = Mesh { positions, triangles: vec![[4, 1, 3]], ..Mesh::default() };
        let mesh = compact(mesh);
        assert_eq!(mesh.positions, [4.0, 1.0, 3.0].map(Vec3::splat));
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
    }

    #[test]
    fn normals_without_length_are_made() {
        let mut mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::ZERO, Vec3::Z * 3.0, Vec3::X],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        make_unit(&mut mesh);
        assert_eq!(mesh.normals, [Vec3::Z, Vec3::Z, Vec3::X]);
    }
}
