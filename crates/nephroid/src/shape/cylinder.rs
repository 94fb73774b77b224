use super::flat::turns;
use super::{Intersection, SurfacePoint};
use crate::math::{Bounds, Frame, Ray, Transform, Vec2, Vec3, gamma};

/// The curved side of a cylinder in world space, without caps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cylinder {
    base: Vec3,
    frame: Frame,
    height: f32,
    radius: f32,
    error: Vec3,
}

impl Cylinder {
    /// `None` unless the transform scales uniformly and radius and length are positive.
    pub fn new(to_world: &Transform, p0: Vec3, p1: Vec3, radius: f32) -> Option<Self> {
        let radius = (f64::from(radius) * to_world.uniform_scale()?) as f32;
        let (base, end) = (to_world.point(p0), to_world.point(p1));
        let axis = end - base;
        let height = axis.length();
        if !(radius > 0.0 && radius.is_finite() && height > 0.0 && height.is_finite()) {
            return None;
        }
        let size = base.abs().max_element().max(end.abs().max_element()) + radius;
        Some(Self {
            base,
            frame: Frame::from_normal(axis / height),
            height,
            radius,
            error: Vec3::splat(size * gamma(12)),
        })
    }

    pub fn intersect(&self, ray: &Ray) -> Option<Intersection> {
        let o = self.frame.to_local(ray.origin - self.base);
        let d = self.frame.to_local(ray.direction);
        let (o2, d2) = (Vec2::new(o.x, o.y), Vec2::new(d.x, d.y));
        let a = d2.length_squared();
        if a == 0.0 {
            return None;
        }
        let b = -o2.dot(d2);
        let c = o2.length_squared() - self.radius * self.radius;
        if c > 0.0 && b <= 0.0 {
            return None;
        }
        let nearest = o2 + d2 * (b / a);
        let discriminant = a * (self.radius * self.radius - nearest.length_squared());
        if discriminant < 0.0 {
            return None;
        }
        let q = b + discriminant.sqrt().copysign(b);
        let (near, far) = if q > 0.0 { (c / q, q / a) } else { (q / a, c / q) };
        // From inside (c ≤ 0) the near root is the surface being left.
        let roots = if c > 0.0 { [near, far] } else { [far, f32::NAN] };
        roots.into_iter().find_map(|t| {
            let z = o.z + t * d.z;
            let hit = t > 0.0 && t < ray.t_max && (0.0..=self.height).contains(&z);
            hit.then_some(Intersection { t, u: turns(o.y + t * d.y, o.x + t * d.x), v: z / self.height })
        })
    }

    pub fn surface(&self, ray: &Ray, hit: &Intersection) -> SurfacePoint {
        let local = self.frame.to_local(ray.at(hit.t) - self.base);
        self.point(Vec2::new(local.x, local.y), hit.v, hit.u)
    }

    fn point(&self, radial: Vec2, v: f32, u: f32) -> SurfacePoint {
        let radial = radial.try_normalize().unwrap_or(Vec2::X);
        let n = self.frame.s * radial.x + self.frame.t * radial.y;
        SurfacePoint {
            position: self.base + self.frame.n * (v * self.height) + n * self.radius,
            error: self.error,
            ng: n,
            ns: n,
            uv: Vec2::new(u, v),
        }
    }

    /// How the position changes with `u` and `v`.
    pub fn tangents(&self, uv: Vec2) -> [Vec3; 2] {
        const TURN: f32 = 2.0 * std::f32::consts::PI;
        let (sin, cos) = crate::math::real::sin_cos(TURN * uv.x);
        let around = self.frame.t * cos - self.frame.s * sin;
        [around * (TURN * self.radius), self.frame.n * self.height]
    }

    pub fn bounds(&self) -> Bounds {
        let a = self.frame.n;
        let reach = (Vec3::ONE - a * a).to_array().map(|s| s.max(0.0).sqrt() * self.radius);
        let reach = Vec3::from_array(reach) + self.error;
        let end = self.base + a * self.height;
        Bounds { min: self.base.min(end) - reach, max: self.base.max(end) + reach }
    }

    pub fn area(&self) -> f32 {
        2.0 * std::f32::consts::PI * self.radius * self.height
    }

    /// A point uniformly by area.
    pub fn sample(&self, u: Vec2) -> SurfacePoint {
        let (sin, cos) = crate::math::real::sin_cos(2.0 * std::f32::consts::PI * u.x);
        self.point(Vec2::new(cos, sin), u.y, u.x)
    }
}
