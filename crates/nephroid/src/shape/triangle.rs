use super::{Intersection, Mesh, SurfacePoint};
use crate::math::{Bounds, Ray, Vec2, Vec3, gamma, warp};

/// One triangle of a mesh in world space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    p: [Vec3; 3],
    /// Which mesh of the world.
    pub mesh: u32,
    /// Which triangle of the mesh.
    pub index: u32,
}

/// A ray in the space in which it starts at the origin and runs along +z: what the watertight test
/// needs of it (Woop, Benthin and Wald 2013, *Watertight Ray/Triangle Intersection*, JCGT 2(1)).
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearedRay {
    pub(super) axes: [usize; 3],
    pub(super) shear: Vec3,
}

impl ShearedRay {
    /// For searches that meet no triangle: making a sheared ray takes as long as testing a box.
    pub const UNUSED: Self = Self { axes: [0, 1, 2], shear: Vec3::ZERO };

    #[inline]
    pub fn new(direction: Vec3) -> Self {
        let a = direction.abs();
        let z = if a.x > a.y && a.x > a.z {
            0
        } else if a.y > a.z {
            1
        } else {
            2
        };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if direction[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let inverse = 1.0 / direction[z];
        Self { axes: [x, y, z], shear: Vec3::new(direction[x] * inverse, direction[y] * inverse, inverse) }
    }
}

/// What bounds the error of t times the determinant, over the depth of the farthest corner: by the largest edge function, the
/// product of the largest coordinates across the ray, and the depth times their sum (Pharr, Jakob and Humphreys 2023, §6.8.7,
/// multiplied out). Rays that leave a triangle would else meet it again wherever the error of a coordinate is zero, as on
/// a floor at a height of 0, and slender triangles everywhere.
///
/// Of a small triangle far away, whose corners are all about as far, the error is more than t by this bound, and its sign is
/// sure all the same. So it counts only where a ray [begins](BEGINS).
pub(super) const OF_EDGE: f32 = gamma(18);
pub(super) const OF_CORNERS: f32 = gamma(72);
pub(super) const OF_SHEAR: f32 = gamma(30);

/// As many times the t of a hit must fit into the depth of the farthest corner for the ray to begin beside the triangle.
pub(super) const BEGINS: f32 = 8.0;

impl Triangle {
    pub fn new(mesh: &Mesh, mesh_index: u32, index: u32) -> Self {
        let p = mesh.triangles[index as usize].map(|i| mesh.positions[i as usize]);
        Self { p, mesh: mesh_index, index }
    }

    /// Whether it has an area that can be computed with.
    pub fn is_proper(&self) -> bool {
        let n = self.cross();
        n.is_finite() && n.try_normalize().is_some()
    }

    fn cross(&self) -> Vec3 {
        (self.p[1] - self.p[0]).cross(self.p[2] - self.p[0])
    }

    /// The hit, with `u` and `v` the weights of the second and third vertex. Edges shared by two
    /// triangles let nothing through. There is none beside the ray's origin where rounding hides
    /// whether it lies ahead.
    #[inline]
    pub fn intersect(&self, ray: &Ray, sheared: &ShearedRay) -> Option<Intersection> {
        Self::meet(&self.p, ray, sheared)
    }

    /// The same for three corners.
    #[inline]
    pub fn meet(p: &[Vec3; 3], ray: &Ray, sheared: &ShearedRay) -> Option<Intersection> {
        let [kx, ky, kz] = sheared.axes;
        let s = sheared.shear;
        let q = p.map(|p| {
            let p = p - ray.origin;
            Vec3::new(p[kx] - s.x * p[kz], p[ky] - s.y * p[kz], p[kz])
        });
        let edge = |a: Vec3, b: Vec3| a.x * b.y - a.y * b.x;
        let outside = |w: &[f32; 3]| w.iter().any(|&x| x < 0.0) && w.iter().any(|&x| x > 0.0);
        let mut w = [edge(q[2], q[1]), edge(q[0], q[2]), edge(q[1], q[0])];
        // Rounding keeps signs, or makes zeros of them.
        if outside(&w) {
            return None;
        }
        if w.contains(&0.0) {
            // On an edge single precision cannot tell the side; double precision can.
            let exact =
                |a: Vec3, b: Vec3| (f64::from(a.x) * f64::from(b.y) - f64::from(a.y) * f64::from(b.x)) as f32;
            w = [exact(q[2], q[1]), exact(q[0], q[2]), exact(q[1], q[0])];
            if outside(&w) {
                return None;
            }
        }
        let determinant = w[0] + w[1] + w[2];
        if determinant == 0.0 {
            return None;
        }
        let sum = w[0] * q[0].z + w[1] * q[1].z + w[2] * q[2].z;
        let most = q.iter().fold(Vec3::ZERO, |most, q| most.max(q.abs()));
        let most_edge = w[0].abs().max(w[1].abs()).max(w[2].abs());
        let error = most.z
            * (OF_EDGE * most_edge
                + OF_CORNERS * (most.x * most.y)
                + OF_SHEAR * (most.z * (most.x + most.y)));
        let scaled = sum * s.z;
        let inverse = 1.0 / determinant;
        let t = scaled * inverse;
        if sum.abs() <= error && t * BEGINS < most.z * s.z.abs() {
            return None;
        }
        (t > 0.0 && t < ray.t_max).then_some(Intersection { t, u: w[1] * inverse, v: w[2] * inverse })
    }

    pub fn surface(&self, mesh: &Mesh, hit: &Intersection) -> SurfacePoint {
        let b = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let terms = [self.p[0] * b[0], self.p[1] * b[1], self.p[2] * b[2]];
        let corners = mesh.triangles[self.index as usize].map(|i| i as usize);
        let mut ng = self.cross().normalize();
        let mut ns = ng;
        if !mesh.normals.is_empty() {
            let n: Vec3 = (0..3).map(|i| mesh.normals[corners[i]] * b[i]).sum();
            ns = n.try_normalize().unwrap_or(ng);
            // The vertex normals say which side is out.
            ng *= 1.0f32.copysign(ng.dot(ns));
        }
        let uv = if mesh.uvs.is_empty() {
            Vec2::new(hit.u, hit.v)
        } else {
            (0..3).map(|i| mesh.uvs[corners[i]] * b[i]).sum()
        };
        SurfacePoint {
            position: terms[0] + terms[1] + terms[2],
            error: (terms[0].abs() + terms[1].abs() + terms[2].abs()) * gamma(7),
            ng,
            ns,
            uv,
        }
    }

    /// How the position changes with the texture coordinates; zero where they lie on a line.
    pub fn tangents(&self, mesh: &Mesh) -> [Vec3; 2] {
        let edges = [self.p[1] - self.p[0], self.p[2] - self.p[0]];
        if mesh.uvs.is_empty() {
            return edges;
        }
        let [a, b, c] = mesh.triangles[self.index as usize].map(|i| mesh.uvs[i as usize]);
        let (b, c) = (b - a, c - a);
        // They may be tiny, and their product is not to vanish.
        let determinant = f64::from(b.x) * f64::from(c.y) - f64::from(b.y) * f64::from(c.x);
        let solved = |of_b: f32, of_c: f32| {
            let (b, c) = (f64::from(of_b) / determinant, f64::from(of_c) / determinant);
            (edges[0].as_dvec3() * b + edges[1].as_dvec3() * c).as_vec3()
        };
        let tangents = [solved(c.y, -b.y), solved(-c.x, b.x)];
        if tangents.iter().all(|t| t.is_finite()) { tangents } else { [Vec3::ZERO; 2] }
    }

    pub fn bounds(&self) -> Bounds {
        Bounds::of(self.p)
    }

    pub fn area(&self) -> f32 {
        0.5 * self.cross().length()
    }

    /// A point uniformly by area.
    pub fn sample(&self, mesh: &Mesh, u: Vec2) -> SurfacePoint {
        let b = warp::square_to_triangle(u);
        self.surface(mesh, &Intersection { t: 0.0, u: b.x, v: b.y })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::offset_origin;
    use nephroid_testkit::Pcg32;

    /// Rays that leave triangles to meet them again, of so many; those in a plane through the origin across an axis
    /// have one coordinate without an error of its own.
    fn met_again(flat: bool, slender: f32) -> (u32, u32) {
        let mut rng = Pcg32::new(5);
        let (mut again, mut rays) = (0, 0);
        for round in 0..20_000 {
            let axis = round % 3;
            let mut corner = || {
                let [x, y] = rng.vec2_f32();
                let mut p = [0.0f32; 3];
                p[(axis + 1) % 3] = 2.0 * x - 1.0;
                p[(axis + 2) % 3] = slender * (2.0 * y - 1.0);
                if !flat {
                    p[axis] = 0.3 + 0.2 * x - 0.7 * y * slender;
                }
                Vec3::from_array(p)
            };
            let positions = vec![corner(), corner(), corner()];
            let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
            let triangle = Triangle::new(&mesh, 0, 0);
            if !triangle.is_proper() {
                continue;
            }
            for _ in 0..10 {
                let point = triangle.sample(&mesh, Vec2::from_array(rng.vec2_f32()));
                let direction = warp::square_to_sphere(Vec2::from_array(rng.vec2_f32()));
                let ray =
                    Ray::new(offset_origin(point.position, point.error, point.ng, direction), direction);
                again += u32::from(triangle.intersect(&ray, &ShearedRay::new(direction)).is_some());
                rays += 1;
            }
        }
        (again, rays)
    }

    /// Without the bound on the error of t, 24 % of those in a plane of zeros do, and of the slender ones more.
    #[test]
    fn what_leaves_a_triangle_does_not_meet_it_again() {
        for slender in [1.0, 0.01, 1e-4] {
            for flat in [true, false] {
                let (again, rays) = met_again(flat, slender);
                assert!(again == 0 && rays > 50_000, "{again} of {rays}, flat: {flat}, slender: {slender}");
            }
        }
    }

    /// Grains of a millimetre half a kilometre away, at all slants.
    #[test]
    fn small_triangles_far_away_are_met() {
        let mut rng = Pcg32::new(11);
        let mut met = 0;
        for _ in 0..50_000 {
            let direction = warp::square_to_sphere(Vec2::from_array(rng.vec2_f32()));
            let center = direction * 512.0;
            let mut corner = || {
                let [x, y] = rng.vec2_f32();
                center + warp::square_to_sphere(Vec2::new(x, y)) * 1e-3
            };
            let corners = [corner(), corner(), corner()];
            let ray = Ray::new(Vec3::ZERO, direction);
            let target = corners.iter().copied().sum::<Vec3>() / 3.0;
            let ray = Ray { direction: (target - ray.origin).normalize(), ..ray };
            met += u32::from(Triangle::meet(&corners, &ray, &ShearedRay::new(ray.direction)).is_some());
        }
        // Rounding of the target and the direction lets some pass beside slender ones.
        assert!(met > 45_000, "{met}");
    }

    /// Whatever comes from a thousandth of its size away is met.
    #[test]
    fn what_comes_from_near_meets_a_triangle() {
        let corners = [Vec3::new(-1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1.0), Vec3::new(0.0, 0.0, -1.0)];
        let mut rng = Pcg32::new(7);
        for _ in 0..50_000 {
            let [a, b] = rng.vec2_f32().map(|u| u - 0.5);
            let target = Vec3::new(0.3 * a, 0.0, 0.3 * b);
            let [x, y] = rng.vec2_f32();
            let above = warp::square_to_cosine_hemisphere(Vec2::new(x, y));
            let direction = Vec3::new(above.x, -above.z.max(0.02), above.y).normalize();
            let ray = Ray::new(target - direction * 1e-3, direction);
            assert!(Triangle::meet(&corners, &ray, &ShearedRay::new(direction)).is_some());
        }
    }
}
