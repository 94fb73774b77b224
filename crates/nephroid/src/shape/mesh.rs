use crate::color::Rgb;
use crate::math::{Transform, Vec2, Vec3};

/// Triangles over shared vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// A unit normal for each vertex, or empty: then each triangle is flat.
    pub normals: Vec<Vec3>,
    /// A texture coordinate for each vertex, or empty: then `uv` is barycentric.
    pub uvs: Vec<Vec2>,
    /// A colour for each vertex, or empty: then it is white. [`Texture::VertexColor`](crate::texture::Texture) shows it.
    pub colors: Vec<Rgb>,
    /// Three vertices each, counter-clockwise as seen from the side the normal points to.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Goes to its place, still counter-clockwise where the transform mirrors.
    pub(crate) fn place(&mut self, to_world: &Transform) {
        self.positions.iter_mut().for_each(|p| *p = to_world.point(*p));
        self.normals.iter_mut().for_each(|n| *n = to_world.normal(*n));
        if to_world.is_mirrored() {
            self.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
        }
    }

    /// The colour on a triangle where its second and third vertex have the weights `u` and `v`.
    pub(crate) fn color(&self, triangle: u32, u: f32, v: f32) -> Rgb {
        if self.colors.is_empty() {
            return Rgb::WHITE;
        }
        let [a, b, c] = self.triangles[triangle as usize].map(|i| self.colors[i as usize]);
        a * (1.0 - u - v) + b * u + c * v
    }

    /// Replaces the vertex normals by means of the adjacent triangles' normals, weighted by the
    /// angle at the vertex (Thürmer and Wüthrich 1998). A vertex of no proper triangle gets +z.
    pub fn compute_normals(&mut self) {
        let mut sums = vec![Vec3::ZERO; self.positions.len()];
        for triangle in &self.triangles {
            let p = triangle.map(|i| self.positions[i as usize]);
            let Some(normal) = (p[1] - p[0]).cross(p[2] - p[0]).try_normalize() else { continue };
            for corner in 0..3 {
                let a = (p[(corner + 1) % 3] - p[corner]).normalize_or_zero();
                let b = (p[(corner + 2) % 3] - p[corner]).normalize_or_zero();
                sums[triangle[corner] as usize] += normal * crate::math::real::acos(a.dot(b));
            }
        }
        self.normals = sums.into_iter().map(|n| n.try_normalize().unwrap_or(Vec3::Z)).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_of_a_cube_corner_ignore_how_faces_are_split() {
        // Three faces of a cube meet at the origin; one of them is two triangles there.
        let mut mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(1.0, 1.0, 0.0)],
            triangles: vec![[0, 4, 1], [0, 2, 4], [0, 1, 3], [0, 3, 2]],
            ..Mesh::default()
        };
        mesh.compute_normals();
        assert!((mesh.normals[0] + Vec3::ONE.normalize()).length() < 1e-6);
    }
}
