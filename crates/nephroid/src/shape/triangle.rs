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
    /// triangles let nothing through.
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
        let scaled = (w[0] * q[0].z + w[1] * q[1].z + w[2] * q[2].z) * s.z;
        let inverse = 1.0 / determinant;
        let t = scaled * inverse;
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
