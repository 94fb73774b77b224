//! Loop's subdivision surfaces (Loop 1987, *Smooth Subdivision Surfaces Based on Triangles*).

use std::collections::HashMap;
use std::ops::{Add, Mul};

use nephroid::math::Vec3;
use nephroid::shape::Mesh;

use super::MeshError;

/// No mesh is divided into more triangles.
const MOST_TRIANGLES: u64 = 1 << 27;

/// Divides each triangle into four, `levels` times, by the rules of Loop with Warren's weights, and moves the vertices to
/// where they come to in the limit. Normals are smooth means of those of the triangles; given ones are left out. Texture
/// coordinates and colours are divided linearly. Edges of one triangle, or of more than two, are sharp.
///
/// # Errors
/// More than 2²⁷ triangles; indices that lead nowhere.
pub fn loop_subdivision(mesh: &Mesh, levels: u32) -> Result<Mesh, MeshError> {
    let most = 4u64.checked_pow(levels).and_then(|each| each.checked_mul(mesh.triangles.len() as u64));
    if most.is_none_or(|most| most > MOST_TRIANGLES) {
        return Err(MeshError::new(format!("{levels} levels make too many triangles")));
    }
    let count = mesh.positions.len();
    if let Some(bad) = mesh.triangles.iter().flatten().find(|&&i| i as usize >= count) {
        return Err(MeshError::new(format!("vertex {bad} does not exist: there are {count}")));
    }
    let mut mesh = Mesh { normals: Vec::new(), ..mesh.clone() };
    for _ in 0..levels {
        mesh = divided(&mesh);
    }
    mesh.positions = moved(&mesh, &Edges::of(&mesh), Rule::Limit);
    mesh.compute_normals();
    Ok(mesh)
}

/// An edge from the vertex of the lower number.
type Pair = (u32, u32);

struct Edge {
    pair: Pair,
    /// The vertices opposite to it, of the first two triangles.
    opposite: [u32; 2],
    triangles: u32,
}

/// The edges of a mesh, in the order in which its triangles come to them.
struct Edges {
    list: Vec<Edge>,
    number: HashMap<Pair, u32>,
}

impl Edges {
    fn of(mesh: &Mesh) -> Self {
        let mut edges = Self { list: Vec::new(), number: HashMap::new() };
        for triangle in &mesh.triangles {
            for corner in 0..3 {
                let (pair, opposite) = (pair(triangle, corner), triangle[(corner + 2) % 3]);
                let next = edges.list.len() as u32;
                let number = *edges.number.entry(pair).or_insert(next);
                if number == next {
                    edges.list.push(Edge { pair, opposite: [opposite; 2], triangles: 1 });
                } else {
                    let edge = &mut edges.list[number as usize];
                    edge.triangles += 1;
                    edge.opposite[1] = opposite;
                }
            }
        }
        edges
    }
}

impl Edge {
    fn is_sharp(&self) -> bool {
        self.triangles != 2
    }
}

fn pair(triangle: &[u32; 3], corner: usize) -> Pair {
    let (a, b) = (triangle[corner], triangle[(corner + 1) % 3]);
    (a.min(b), a.max(b))
}

/// Where vertices go.
#[derive(Clone, Copy, PartialEq)]
enum Rule {
    /// In the next level.
    Next,
    /// After all levels.
    Limit,
}

fn moved(mesh: &Mesh, edges: &Edges, rule: Rule) -> Vec<Vec3> {
    let count = mesh.positions.len();
    // Neighbours by all edges and by sharp ones: how many, and the sum of where they are.
    let (mut all, mut sharp) = (vec![(0u32, Vec3::ZERO); count], vec![(0u32, Vec3::ZERO); count]);
    for edge in &edges.list {
        let (a, b) = (edge.pair.0 as usize, edge.pair.1 as usize);
        for (own, other) in [(a, b), (b, a)] {
            let other = mesh.positions[other];
            all[own] = (all[own].0 + 1, all[own].1 + other);
            if edge.is_sharp() {
                sharp[own] = (sharp[own].0 + 1, sharp[own].1 + other);
            }
        }
    }
    let place = |i: usize| {
        let (own, (n, sum)) = (mesh.positions[i], all[i]);
        let (each, n, sum) = match (sharp[i].0, rule) {
            (0, _) if n == 0 => return own,
            (0, _) => {
                let beta = if n == 3 { 3.0 / 16.0 } else { 3.0 / (8.0 * n as f32) };
                let each = if rule == Rule::Next { beta } else { 1.0 / (n as f32 + 3.0 / (8.0 * beta)) };
                (each, n, sum)
            }
            (2, Rule::Next) => (1.0 / 8.0, 2, sharp[i].1),
            (2, Rule::Limit) => (1.0 / 5.0, 2, sharp[i].1),
            // A corner.
            _ => return own,
        };
        own * (1.0 - each * n as f32) + sum * each
    };
    (0..count).map(place).collect()
}

fn divided(mesh: &Mesh) -> Mesh {
    let edges = Edges::of(mesh);
    let mut positions = moved(mesh, &edges, Rule::Next);
    let at = |i: u32| mesh.positions[i as usize];
    positions.extend(edges.list.iter().map(|edge| {
        let ends = at(edge.pair.0) + at(edge.pair.1);
        if edge.is_sharp() {
            ends * 0.5
        } else {
            ends * (3.0 / 8.0) + (at(edge.opposite[0]) + at(edge.opposite[1])) * (1.0 / 8.0)
        }
    }));
    let first = mesh.positions.len() as u32;
    let mut triangles = Vec::with_capacity(4 * mesh.triangles.len());
    for triangle in &mesh.triangles {
        let [a, b, c] = *triangle;
        let [ab, bc, ca] = [0, 1, 2].map(|corner| first + edges.number[&pair(triangle, corner)]);
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh {
        positions,
        normals: Vec::new(),
        uvs: with_middles(&mesh.uvs, &edges),
        colors: with_middles(&mesh.colors, &edges),
        triangles,
    }
}

fn with_middles<T: Copy + Add<Output = T> + Mul<f32, Output = T>>(values: &[T], edges: &Edges) -> Vec<T> {
    let middle = |edge: &Edge| (values[edge.pair.0 as usize] + values[edge.pair.1 as usize]) * 0.5;
    let middles = edges.list.iter().filter(|_| !values.is_empty()).map(middle);
    values.iter().copied().chain(middles).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid::math::Vec2;

    fn octahedron() -> Mesh {
        let positions = vec![Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
        let triangles =
            vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        Mesh { positions, triangles, ..Mesh::default() }
    }

    #[test]
    fn levels_near_the_same_smooth_surface() {
        let bodies: Vec<Mesh> =
            (0..5).map(|levels| loop_subdivision(&octahedron(), levels).expect("a sound mesh")).collect();
        for (levels, body) in bodies.iter().enumerate() {
            assert_eq!(body.triangles.len(), 8 << (2 * levels));
            // The limit of a vertex does not depend on when one stops.
            for i in 0..6 {
                assert!((body.positions[i] - bodies[0].positions[i]).length() < 1e-6);
            }
            assert!(body.normals.iter().zip(&body.positions).all(|(n, p)| n.dot(*p) > 0.0));
        }
        // By hand: n = 4, β = 3/32, 1/(n + 3/(8β)) = 1/8; the neighbours' sum is zero.
        assert!((bodies[0].positions[0] - Vec3::X * 0.5).length() < 1e-6);
    }

    #[test]
    fn flat_meshes_stay_flat_and_keep_their_corners_in_between() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y];
        let uvs: Vec<Vec2> = positions.iter().map(|p| p.truncate()).collect();
        let mesh = Mesh { positions, uvs, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
        let fine = loop_subdivision(&mesh, 3).expect("a sound mesh");
        assert!(fine.normals.iter().all(|n| n.z > 0.999_999) && fine.positions.iter().all(|p| p.z == 0.0));
        assert_eq!((fine.uvs.len(), fine.triangles.len()), (fine.positions.len(), 128));
        // A boundary is a cubic spline of its own: next to a corner it leaves the polygon.
        assert!(fine.positions[0].x > 0.1 && fine.positions[0].y > 0.1);
    }

    #[test]
    fn too_many_levels_and_broken_indices_are_refused() {
        assert!(loop_subdivision(&octahedron(), 14).is_err());
        assert!(loop_subdivision(&octahedron(), u32::MAX).is_err());
        let broken = Mesh { triangles: vec![[0, 1, 9]], ..octahedron() };
        let message = loop_subdivision(&broken, 1).expect_err("a broken mesh").to_string();
        assert_eq!(message, "vertex 9 does not exist: there are 6");
    }
}
