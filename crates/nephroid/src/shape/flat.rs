use super::{Intersection, SurfacePoint};
use crate::math::{Bounds, Ray, Transform, Vec2, Vec3, gamma};

/// A parallelogram or ellipse: the points `center + x·edge_x + y·edge_y` of a flat region.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flat {
    pub(super) center: Vec3,
    edge_x: Vec3,
    edge_y: Vec3,
    /// Dual basis: `x = dual_x · (p − center)`.
    pub(super) dual_x: Vec3,
    pub(super) dual_y: Vec3,
    pub(super) normal: Vec3,
    pub(super) region: Region,
    /// The edge in `x` and `y`, 1 and a few roundings, so that abutting walls leave no gap.
    pub(super) limit: f32,
}

/// What part of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Region {
    /// |x| ≤ 1 and |y| ≤ 1.
    Square,
    /// x² + y² ≤ 1.
    Disk,
    /// Everything.
    Plane,
}

impl Flat {
    /// The region of the plane z = 0 under `to_world`; `None` if it has no area left.
    pub fn new(to_world: &Transform, region: Region) -> Option<Self> {
        Self::spanned(
            to_world.point(Vec3::ZERO),
            to_world.vector(Vec3::X),
            to_world.vector(Vec3::Y),
            to_world.normal(Vec3::Z),
            region,
        )
    }

    /// The face of the cube [-1, 1]³ with normal ±`axis`, under `to_world`.
    pub fn cube_face(to_world: &Transform, axis: usize, positive: bool) -> Option<Self> {
        let unit = |i: usize| Vec3::from_array(std::array::from_fn(|k| if k == i % 3 { 1.0 } else { 0.0 }));
        let normal = if positive { unit(axis) } else { -unit(axis) };
        let (x, y) =
            if positive { (unit(axis + 1), unit(axis + 2)) } else { (unit(axis + 2), unit(axis + 1)) };
        Self::spanned(
            to_world.point(normal),
            to_world.vector(x),
            to_world.vector(y),
            to_world.normal(normal),
            Region::Square,
        )
    }

    fn spanned(center: Vec3, edge_x: Vec3, edge_y: Vec3, normal: Vec3, region: Region) -> Option<Self> {
        let cross = edge_x.cross(edge_y);
        let area_sq = cross.length_squared();
        let dual_x = edge_y.cross(cross) / area_sq;
        let dual_y = cross.cross(edge_x) / area_sq;
        let usable = area_sq > 0.0 && dual_x.is_finite() && dual_y.is_finite() && normal != Vec3::ZERO;
        let reach = dual_x.length().max(dual_y.length()) * center.length();
        usable.then_some(Self {
            center,
            edge_x,
            edge_y,
            dual_x,
            dual_y,
            // Perpendicular to the edges as they were rounded, on the side the transform says.
            normal: cross.normalize() * 1.0f32.copysign(cross.dot(normal)),
            region,
            limit: 1.0 + gamma(8) * (1.0 + reach),
        })
    }

    /// Whether it is a parallelogram, whose texture coordinates are those of its sampled points.
    pub fn is_rectangle(&self) -> bool {
        self.region == Region::Square
    }

    pub fn intersect(&self, ray: &Ray) -> Option<Intersection> {
        let t = (self.center - ray.origin).dot(self.normal) / ray.direction.dot(self.normal);
        if !(t > 0.0 && t < ray.t_max) {
            return None;
        }
        let q = ray.at(t) - self.center;
        let (x, y) = (q.dot(self.dual_x), q.dot(self.dual_y));
        let inside = match self.region {
            Region::Square => x.abs() <= self.limit && y.abs() <= self.limit,
            Region::Disk => x * x + y * y <= self.limit * self.limit,
            Region::Plane => true,
        };
        inside.then_some(Intersection { t, u: x, v: y })
    }

    #[inline]
    pub fn surface(&self, hit: &Intersection) -> SurfacePoint {
        let (dx, dy) = (self.edge_x * hit.u, self.edge_y * hit.v);
        SurfacePoint {
            position: self.center + dx + dy,
            error: (self.center.abs() + dx.abs() + dy.abs()) * gamma(6),
            ng: self.normal,
            ns: self.normal,
            uv: self.uv(hit.u, hit.v),
        }
    }

    /// How the position changes with `u` and `v` where the hit has these coordinates.
    pub fn tangents(&self, x: f32, y: f32) -> [Vec3; 2] {
        let Self { edge_x, edge_y, .. } = *self;
        match self.region {
            Region::Square | Region::Plane => [edge_x * 2.0, edge_y * 2.0],
            Region::Disk => {
                let out = Vec2::new(x, y).try_normalize().unwrap_or(Vec2::X);
                let turn = (edge_y * x - edge_x * y) * (2.0 * std::f32::consts::PI);
                [edge_x * out.x + edge_y * out.y, turn]
            }
        }
    }

    pub fn bounds(&self) -> Bounds {
        let reach = match self.region {
            Region::Square => self.edge_x.abs() + self.edge_y.abs(),
            Region::Disk => {
                let (x, y) = (self.edge_x, self.edge_y);
                (x * x + y * y).to_array().map(f32::sqrt).into()
            }
            Region::Plane => return Bounds::EMPTY,
        };
        Bounds { min: self.center - reach * self.limit, max: self.center + reach * self.limit }
    }

    pub fn area(&self) -> f32 {
        let unit = self.edge_x.cross(self.edge_y).length();
        match self.region {
            Region::Square => 4.0 * unit,
            Region::Disk => std::f32::consts::PI * unit,
            Region::Plane => f32::INFINITY,
        }
    }

    /// A point uniformly by area.
    pub fn sample(&self, u: Vec2) -> SurfacePoint {
        let p = match self.region {
            Region::Disk => crate::math::warp::square_to_disk(u),
            Region::Square | Region::Plane => 2.0 * u - Vec2::ONE,
        };
        self.surface(&Intersection { t: 0.0, u: p.x, v: p.y })
    }

    #[inline]
    fn uv(&self, x: f32, y: f32) -> Vec2 {
        match self.region {
            Region::Square | Region::Plane => Vec2::new((x + 1.0) * 0.5, (y + 1.0) * 0.5),
            Region::Disk => Vec2::new((x * x + y * y).sqrt(), turns(y, x)),
        }
    }
}

/// The angle of (x, y) as a fraction of a full turn, in [0, 1).
pub(crate) fn turns(y: f32, x: f32) -> f32 {
    let phi = crate::math::real::atan2(y, x) / (2.0 * std::f32::consts::PI);
    if phi < 0.0 { (phi + 1.0).min(1.0f32.next_down()) } else { phi }
}
