//! Aiming: photons are sent only where they can meet something.
//!
//! What light can meet is covered by balls. Seen from a point they are cones of directions, along a
//! direction they are disks. A sample falls into one of them, chosen by its size and uniformly inside,
//! and counts only if no ball before that one covers it, too. So it is uniform over their union: where
//! cones overlap nothing is counted twice, and what photons carry stays even.

use std::f32::consts::PI;

use crate::math::{Bounds, Frame, Ray, Vec2, Vec3, warp};

/// Most balls that are aimed at together.
pub(crate) const MAX_BALLS: usize = 32;

/// How much wider than its contents a ball or box is taken, relative to its size and its distance from
/// the origin: more than what rounding does to points and rays.
const MARGIN: f32 = 1e-5;

/// A ball around some of the scene, and the box of the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ball {
    pub center: Vec3,
    pub radius: f32,
    pub bounds: Bounds,
    /// The emitter, if it is the surface of one and of nothing else.
    pub emitter: Option<u32>,
}

impl Ball {
    /// With room for rounding.
    pub fn around(center: Vec3, radius: f32, bounds: Bounds, emitter: Option<u32>) -> Self {
        let room = MARGIN * (center.abs().max_element() + radius);
        let bounds = Bounds { min: bounds.min - Vec3::splat(room), max: bounds.max + Vec3::splat(room) };
        Self { center, radius: radius + room, bounds, emitter }
    }
}

/// What the light of a photon pass is aimed at.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Targets {
    /// At most [`MAX_BALLS`].
    pub balls: Vec<Ball>,
}

impl Targets {
    /// The balls that the light of an emitter can meet: all but its own, if it cannot meet itself.
    fn seen_by(&self, convex: Option<u32>) -> impl Iterator<Item = &Ball> {
        self.balls.iter().filter(move |ball| convex.is_none() || ball.emitter != convex)
    }

    /// Whether a ray meets the box of any ball.
    pub fn met_by(&self, ray: &Ray) -> bool {
        let inverse = ray.direction.recip();
        self.balls.iter().any(|ball| {
            let (a, b) = ((ball.bounds.min - ray.origin) * inverse, (ball.bounds.max - ray.origin) * inverse);
            // A ray within a face gives NaN, which `max` and `min` pass over.
            let near = a.x.min(b.x).max(a.y.min(b.y)).max(a.z.min(b.z)).max(0.0);
            let far = a.x.max(b.x).min(a.y.max(b.y)).min(a.z.max(b.z));
            near <= far * (1.0 + 1e-5)
        })
    }

    /// Whether the whole of another ball lies in one of these that belongs to no emitter.
    pub fn contains(&self, other: &Ball) -> bool {
        let around = |b: &Ball| b.center.distance(other.center) + other.radius <= b.radius;
        self.balls.iter().any(|b| b.emitter.is_none() && around(b))
    }
}

/// A cone of directions.
#[derive(Clone, Copy, Debug, Default)]
struct Cone {
    axis: Vec3,
    one_minus_cos: f32,
}

impl Cone {
    /// By the distance from the axis, which is exact for narrow cones, too.
    fn contains(&self, direction: Vec3) -> bool {
        (direction - self.axis).length_squared() <= 2.0 * self.one_minus_cos
    }
}

/// The cones that targets fill from somewhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cones {
    list: [Cone; MAX_BALLS],
    len: usize,
    /// Sum of their 1 − cos.
    sum: f32,
}

impl Cones {
    /// Solid angle of the cones, those that overlap counted so often.
    pub fn solid_angle(&self) -> f32 {
        2.0 * PI * self.sum
    }

    /// The cones of all directions from points of the ball of `radius` around `center` to points of the
    /// targets, but for those that `wanted` (axis and sine of the half-angle) rules out. `None` if one
    /// is not outside the targets, or if the cones fill more than `limit`.
    pub fn seen_from(
        targets: &Targets,
        (center, radius): (Vec3, f32),
        convex: Option<u32>,
        limit: f32,
        wanted: impl Fn(Vec3, f32) -> bool,
    ) -> Option<Self> {
        let mut cones = Self { list: [Cone::default(); MAX_BALLS], len: 0, sum: 0.0 };
        for ball in targets.seen_by(convex) {
            let to = ball.center - center;
            let (reach, distance) = (ball.radius + radius, to.length());
            let sin = reach / distance;
            // Also not where the distance is zero. Close by, the cone is all but half of the sphere.
            if !(sin < 0.999) {
                return None;
            }
            let axis = to / distance;
            if !wanted(axis, sin) {
                continue;
            }
            let one_minus_cos = sin * sin / (1.0 + (1.0 - sin * sin).sqrt());
            cones.list[cones.len] = Cone { axis, one_minus_cos };
            cones.len += 1;
            cones.sum += one_minus_cos;
        }
        (cones.solid_angle() <= limit).then_some(cones)
    }

    /// A direction uniform over the union, with density 1/[`solid_angle`](Self::solid_angle); none if
    /// it falls to another cone.
    pub fn sample(&self, u_cone: f32, u: Vec2) -> Option<Vec3> {
        let cones = &self.list[..self.len];
        let mut left = u_cone * self.sum;
        let chosen = cones.iter().position(|cone| {
            left -= cone.one_minus_cos;
            left < 0.0
        });
        // Where rounding leaves something over, the last has it.
        let chosen = chosen.or(self.len.checked_sub(1))?;
        let cone = cones[chosen];
        let local = warp::square_to_cone(u, cone.one_minus_cos);
        let direction = Frame::from_normal(cone.axis).to_world(local).normalize();
        (!cones[..chosen].iter().any(|before| before.contains(direction))).then_some(direction)
    }
}

/// The silhouettes of targets along a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Disks<'a> {
    targets: &'a Targets,
    /// Sum of the squared radii.
    sum: f32,
}

impl<'a> Disks<'a> {
    /// `None` if together they are larger than a disk of `radius`.
    pub fn new(targets: &'a Targets, radius: f32) -> Option<Self> {
        let sum = targets.balls.iter().map(|b| b.radius * b.radius).sum();
        (sum < radius * radius).then_some(Self { targets, sum })
    }

    /// Sum of their areas, m².
    pub fn area(&self) -> f32 {
        PI * self.sum
    }

    /// A point on the line of a ray along `direction`, uniform over the union with density
    /// 1/[`area`](Self::area); none if it falls to another disk.
    pub fn sample(&self, direction: Vec3, u_disk: f32, u: Vec2) -> Option<Vec3> {
        let balls = &self.targets.balls;
        let mut left = u_disk * self.sum;
        let chosen = balls.iter().position(|ball| {
            left -= ball.radius * ball.radius;
            left < 0.0
        });
        let chosen = chosen.or(balls.len().checked_sub(1))?;
        let (ball, frame) = (&balls[chosen], Frame::from_normal(direction));
        let disk = warp::square_to_disk(u) * ball.radius;
        let point = ball.center + frame.to_world(Vec3::new(disk.x, disk.y, 0.0));
        let covers = |before: &Ball| {
            let to = point - before.center;
            (to - direction * to.dot(direction)).length_squared() <= before.radius * before.radius
        };
        (!balls[..chosen].iter().any(covers)).then_some(point)
    }
}
