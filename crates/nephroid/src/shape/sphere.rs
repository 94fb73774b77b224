use super::flat::turns;
use super::{Intersection, SurfacePoint};
use crate::math::real::{acos, sin_cos};
use crate::math::{Bounds, Frame, Ray, Transform, Vec2, Vec3, gamma, warp};

/// A sphere in world space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    pub center: Vec3,
    pub radius: f32,
    /// World directions of the sphere's own axes, for its `uv`.
    axes: [Vec3; 3],
}

impl Sphere {
    /// `None` unless the transform scales uniformly and the radius is positive.
    pub fn new(to_world: &Transform, center: Vec3, radius: f32) -> Option<Self> {
        let radius = (f64::from(radius) * to_world.uniform_scale()?) as f32;
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|a| to_world.vector(a).normalize_or_zero());
        (radius > 0.0 && radius.is_finite()).then_some(Self { center: to_world.point(center), radius, axes })
    }

    /// The nearest hit, by the quadratic in the form of Haines, Günther and Akenine-Möller
    /// (*Ray Tracing Gems* 2019, ch. 7). The sign of the origin's distance from the surface decides
    /// which roots can be ahead, so a ray that leaves the surface never meets it where it starts.
    pub fn intersect(&self, ray: &Ray) -> Option<Intersection> {
        let f = ray.origin - self.center;
        let a = ray.direction.length_squared();
        let b = -f.dot(ray.direction);
        let c = f.length_squared() - self.radius * self.radius;
        if c > 0.0 && b <= 0.0 {
            return None;
        }
        let nearest = f + ray.direction * (b / a);
        let discriminant = a * (self.radius * self.radius - nearest.length_squared());
        if discriminant < 0.0 {
            return None;
        }
        let q = b + discriminant.sqrt().copysign(b);
        let (near, far) = if q > 0.0 { (c / q, q / a) } else { (q / a, c / q) };
        let t = if c > 0.0 { near } else { far };
        (t > 0.0 && t < ray.t_max).then_some(Intersection { t, u: 0.0, v: 0.0 })
    }

    pub fn surface(&self, ray: &Ray, hit: &Intersection) -> SurfacePoint {
        let n = (ray.at(hit.t) - self.center).try_normalize().unwrap_or(Vec3::Z);
        self.point(n)
    }

    /// The point with a given outward normal.
    pub fn point(&self, n: Vec3) -> SurfacePoint {
        let local = Vec3::from_array(self.axes.map(|a| n.dot(a)));
        SurfacePoint {
            position: self.center + n * self.radius,
            error: (self.center.abs() + Vec3::splat(self.radius)) * gamma(8),
            ng: n,
            ns: n,
            uv: Vec2::new(turns(local.y, local.x), acos(local.z) / std::f32::consts::PI),
        }
    }

    /// How the position changes with `u` and `v`; the former vanishes at the poles.
    pub fn tangents(&self, uv: Vec2) -> [Vec3; 2] {
        use std::f32::consts::PI;
        let ((sin, cos), (sin_phi, cos_phi)) = (sin_cos(PI * uv.y), sin_cos(2.0 * PI * uv.x));
        let [x, y, z] = self.axes;
        let (out, around) = (x * cos_phi + y * sin_phi, y * cos_phi - x * sin_phi);
        [around * (2.0 * PI * self.radius * sin), (out * cos - z * sin) * (PI * self.radius)]
    }

    pub fn bounds(&self) -> Bounds {
        let r = Vec3::splat(self.radius * (1.0 + gamma(4)));
        Bounds { min: self.center - r, max: self.center + r }
    }

    pub fn area(&self) -> f32 {
        4.0 * std::f32::consts::PI * self.radius * self.radius
    }

    /// A point uniformly by area.
    pub fn sample(&self, u: Vec2) -> SurfacePoint {
        self.point(warp::square_to_sphere(u))
    }

    /// The cosine of the cone in which the sphere is seen from `p`, if `p` is outside.
    pub fn cone_cos(&self, p: Vec3) -> Option<f32> {
        let d_sq = (self.center - p).length_squared();
        let sin_sq = self.radius * self.radius / d_sq;
        // Inside or all but on the surface, the cone is no use.
        (sin_sq < 0.9999).then(|| (1.0 - sin_sq).sqrt())
    }

    /// 1 − cos of that cone, without cancellation for small or far spheres.
    pub fn cone_one_minus_cos(&self, p: Vec3) -> Option<f32> {
        let cos = self.cone_cos(p)?;
        let sin_sq = self.radius * self.radius / (self.center - p).length_squared();
        Some(sin_sq / (1.0 + cos))
    }

    /// A point on the visible side, uniformly by solid angle as seen from `p` outside.
    pub fn sample_cone(&self, p: Vec3, one_minus_cos: f32, u: Vec2) -> SurfacePoint {
        let to_center = self.center - p;
        let distance = to_center.length();
        let frame = Frame::from_normal(to_center / distance);
        let x = u.x * one_minus_cos;
        let sin_sq = x * (2.0 - x);
        let (sin_phi, cos_phi) = sin_cos(2.0 * std::f32::consts::PI * u.y);
        // The angle at the centre between the direction back to `p` and the point, from the law of
        // sines; measured so, the point lies on the near side.
        let reach = (self.radius * self.radius - distance * distance * sin_sq).max(0.0).sqrt();
        let along = distance * (1.0 - x) - reach;
        let r = along * sin_sq.max(0.0).sqrt();
        let local = Vec3::new(r * cos_phi, r * sin_phi, along * (1.0 - x));
        let n = (p + frame.to_world(local) - self.center).try_normalize().unwrap_or(-frame.n);
        self.point(n)
    }
}
