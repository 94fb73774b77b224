//! Loop's subdivision of triangles (1987), with Warren's weights (1995).

use std::collections::BTreeMap;

use nephroid::handle::Handle;
use nephroid::math::DVec3;
use nephroid::shape::Mesh;

use super::parameters::Parameters;
use super::reader::Reader;
use super::shape::single;

/// Triangles of a surface.
const MAX_TRIANGLES: usize = 1 << 22;

impl Reader<'_> {
    pub(super) fn loop_subdivision(&mut self, parameters: &Parameters) -> Option<Handle<Mesh>> {
        let levels = parameters.integer("levels", 3, 0..=12);
        parameters.ignore(&["scheme"]);
        let indices = self.indices(parameters, 3);
        let cage = self.vertices(parameters)?;
        let Some(indices) = indices? else {
            self.log.error(&parameters.at, "\"loopsubdiv\" lacks \"integer indices\"");
            return None;
        };
        self.indices_fit(parameters, &indices, cage.positions.len())?;
        if (indices.len() / 3) << (2 * levels) > MAX_TRIANGLES {
            let message = format!("{levels} levels make more than {MAX_TRIANGLES} triangles");
            self.log.error(&parameters.at, message);
            return None;
        }
        let mut surface = Surface {
            positions: cage.positions.iter().map(|p| p.as_dvec3()).collect(),
            triangles: indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        };
        let mut rings = surface.rings();
        for _ in 0..levels {
            if rings.is_none() {
                break;
            }
            surface = surface.finer(rings.as_ref()?);
            rings = surface.rings();
        }
        let Some(rings) = rings else {
            self.log.error(&parameters.at, "an edge of the surface belongs to more than two triangles");
            return None;
        };
        let mut mesh = Mesh {
            positions: surface.limit(&rings).into_iter().map(single).collect(),
            triangles: surface.triangles,
            ..Mesh::default()
        };
        mesh.compute_normals();
        self.store_mesh(parameters, mesh)
    }
}

/// A surface of triangles.
struct Surface {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// What is around edges and vertices.
struct Rings {
    /// For each edge the vertices across from it, one at the border.
    edges: BTreeMap<[u32; 2], Vec<u32>>,
    /// For each vertex the sum of its neighbours, and how many there are.
    inner: Vec<(DVec3, u32)>,
    /// The same for its neighbours along the border; none in the middle.
    border: Vec<(DVec3, u32)>,
}

fn edge(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl Surface {
    /// `None` if an edge belongs to more than two triangles.
    fn rings(&self) -> Option<Rings> {
        let mut edges: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for &[a, b, c] in &self.triangles {
            for (from, to, across) in [(a, b, c), (b, c, a), (c, a, b)] {
                edges.entry(edge(from, to)).or_default().push(across);
            }
        }
        let none = vec![(DVec3::ZERO, 0); self.positions.len()];
        let (mut inner, mut border) = (none.clone(), none);
        for (&[a, b], across) in &edges {
            if across.len() > 2 {
                return None;
            }
            for (own, other) in [(a, b), (b, a)] {
                let add = |sum: &mut (DVec3, u32)| {
                    *sum = (sum.0 + self.positions[other as usize], sum.1 + 1);
                };
                add(&mut inner[own as usize]);
                if across.len() == 1 {
                    add(&mut border[own as usize]);
                }
            }
        }
        Some(Rings { edges, inner, border })
    }

    /// Each vertex moved towards its neighbours by a weight for each: at the border by its own, else by that of
    /// its number of neighbours.
    fn moved(&self, rings: &Rings, at_border: f64, weight: impl Fn(f64) -> f64) -> Vec<DVec3> {
        let moved = |(i, p): (usize, &DVec3)| {
            let ((sum, n), weight) = match (rings.border[i], rings.inner[i]) {
                ((sum, 2), _) => ((sum, 2), at_border),
                // Where borders meet, nothing moves.
                ((_, 1..), _) | (_, (_, 0)) => return *p,
                (_, (sum, n)) => ((sum, n), weight(f64::from(n))),
            };
            *p * (1.0 - f64::from(n) * weight) + sum * weight
        };
        self.positions.iter().enumerate().map(moved).collect()
    }

    /// Four triangles for each.
    fn finer(&self, rings: &Rings) -> Self {
        let mut positions = self.moved(rings, 0.125, beta);
        let mut middle = BTreeMap::new();
        for (&[a, b], across) in &rings.edges {
            let at = |i: u32| self.positions[i as usize];
            let ends = at(a) + at(b);
            let point = match across.as_slice() {
                [c, d] => ends * 0.375 + (at(*c) + at(*d)) * 0.125,
                _ => ends * 0.5,
            };
            middle.insert([a, b], positions.len() as u32);
            positions.push(point);
        }
        let mut triangles = Vec::with_capacity(4 * self.triangles.len());
        for &[a, b, c] in &self.triangles {
            let [ab, bc, ca] = [edge(a, b), edge(b, c), edge(c, a)].map(|edge| middle[&edge]);
            triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        Self { positions, triangles }
    }

    /// Where the vertices come to lie in the end.
    fn limit(&self, rings: &Rings) -> Vec<DVec3> {
        self.moved(rings, 0.2, |n| 1.0 / (n + 3.0 / (8.0 * beta(n))))
    }
}

/// The weight of each of so many neighbours.
fn beta(n: f64) -> f64 {
    if n == 3.0 { 3.0 / 16.0 } else { 3.0 / (8.0 * n) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octahedron() -> Surface {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let positions = vec![x, -x, y, -y, z, -z];
        let triangles =
            vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        Surface { positions, triangles }
    }

    /// The limit of a vertex is the same at each level.
    #[test]
    fn levels_lead_to_one_limit() {
        let coarse = octahedron();
        let rings = coarse.rings().unwrap();
        let expected = coarse.limit(&rings);
        let fine = coarse.finer(&rings);
        let fine = fine.finer(&fine.rings().unwrap());
        let found = fine.limit(&fine.rings().unwrap());
        assert_eq!(fine.triangles.len(), 8 * 16);
        for (a, b) in expected.iter().zip(&found) {
            assert!(a.distance(*b) < 1e-12, "{a} {b}");
        }
        assert!(found.iter().all(|p| p.length() < 0.75 && p.length() > 0.4));
    }

    #[test]
    fn borders_stay_in_their_plane_and_three_triangles_at_an_edge_are_refused() {
        let mut flat = octahedron();
        flat.triangles.truncate(4);
        let rings = flat.rings().unwrap();
        let limit = flat.limit(&rings);
        assert!(limit[..4].iter().all(|p| p.z == 0.0) && limit[5] == flat.positions[5]);
        let mut folded = octahedron();
        folded.triangles.push([0, 2, 1]);
        assert!(folded.rings().is_none());
    }
}
