use nephroid::math::{Vec2, Vec3};
use nephroid::shape::Mesh;

/// A vertex of a [`grid`].
pub(super) struct Vertex {
    pub position: Vec3,
    /// Of any length; turned to unit length.
    pub normal: Vec3,
    pub uv: Vec2,
}

/// Appends `columns` by `rows` cells, of two triangles each, of a surface over the unit square. Normals are on the side
/// from which the first coordinate turns to the second counter-clockwise, unless `flipped`.
pub(super) fn grid(
    mesh: &mut Mesh,
    [columns, rows]: [u32; 2],
    flipped: bool,
    vertex: impl Fn(Vec2) -> Vertex,
) {
    let first = mesh.positions.len() as u32;
    for row in 0..=rows {
        for column in 0..=columns {
            let at = Vec2::new(column as f32 / columns as f32, row as f32 / rows as f32);
            let Vertex { position, normal, uv } = vertex(at);
            mesh.positions.push(position);
            mesh.normals.push(normal.try_normalize().unwrap_or(Vec3::Z));
            mesh.uvs.push(uv);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = first + row * (columns + 1) + column;
            let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
            let cell = [[a, b, c], [a, c, d]];
            // At a pole, a side of a cell has no length.
            for [a, b, c] in cell {
                let p = [a, b, c].map(|i| mesh.positions[i as usize]);
                if super::has_area(p) {
                    mesh.triangles.push(if flipped { [a, c, b] } else { [a, b, c] });
                }
            }
        }
    }
}
