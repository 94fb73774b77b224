//! Aiming: photons are sent only where they can meet something.
//!
//! What light can meet is covered by balls. Seen from a point they are cones of directions, along a
//! direction they are disks. A sample falls into one of them, chosen by its size and uniformly inside,
//! and counts only if no ball before that one covers it, too. So it is uniform over their union: where
//! cones overlap nothing is counted twice, and what photons carry stays even.

use std::f32::consts::PI;

use super::emitter::{Emission, EmissionNumbers};
use crate::color::Rgb;
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
            // A ray within a face, which gives NaN, may miss the box; what the box is around lies inside its margin.
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
pub(super) struct Cone {
    pub axis: Vec3,
    pub one_minus_cos: f32,
}

impl Cone {
    pub fn solid_angle(&self) -> f32 {
        2.0 * PI * self.one_minus_cos
    }

    /// A direction uniform over the cone.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let local = warp::square_to_cone(u, self.one_minus_cos);
        Frame::from_normal(self.axis).to_world(local).normalize()
    }

    /// By the distance from the axis, which is exact for narrow cones, too.
    pub fn contains(&self, direction: Vec3) -> bool {
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
            // Directions far away err by more than the margin of a small ball.
            let distance = to.length();
            let reach = ball.radius + radius + 2.0 * f32::EPSILON * distance;
            let sin = reach / distance;
            // In the middle there is no axis; close by, the cone is all but half of the sphere.
            if distance == 0.0 || sin >= 0.999 {
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

    /// Starts light of a point without extent at the targets; `whole` is the power of all of it.
    pub fn emit(
        &self,
        position: Vec3,
        u: EmissionNumbers,
        whole: Rgb,
        intensity: impl FnOnce(Vec3) -> Rgb,
    ) -> Emission {
        match self.sample(u.target, u.direction) {
            Some(direction) => Emission {
                ray: Ray::new(position, direction),
                surface: None,
                power: intensity(direction) * self.solid_angle(),
                emitted: whole,
            },
            None => Emission::elsewhere(position, whole),
        }
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
        let direction = cone.sample(u);
        (!cones[..chosen].iter().any(|before| before.contains(direction))).then_some(direction)
    }
}

/// Whether cones, told by axis and sine of the half-angle, overlap that about +z of a frame with the sine and cosine of its
/// half-angle, which is below 90°.
pub(super) fn overlaps(frame: &Frame, sin_cutoff: f32, cos_cutoff: f32) -> impl Fn(Vec3, f32) -> bool {
    let frame = *frame;
    move |axis: Vec3, sin_half: f32| {
        // Their axes are closer than the sum of the two angles; the margin is for rounding.
        let cos_half = (1.0 - sin_half * sin_half).sqrt();
        let (cos_sum, sin_sum) =
            (cos_cutoff * cos_half - sin_cutoff * sin_half, sin_cutoff * cos_half + cos_cutoff * sin_half);
        let local = frame.to_local(axis);
        let across = Vec2::new(local.x, local.y).length();
        // The sine of the sum less the angle between the axes; all are below 180°.
        sin_sum * local.z - cos_sum * across >= -1e-4
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

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid_testkit::{ALPHA, MeanTest, Pcg32, sidak};

    fn ball(center: Vec3, radius: f32) -> Ball {
        let r = Vec3::splat(radius);
        Ball::around(center, radius, Bounds { min: center - r, max: center + r }, None)
    }

    /// Two balls, one partly before the other, and a third apart.
    fn targets() -> Targets {
        let at = |x, y, z, radius| ball(Vec3::new(x, y, z), radius);
        Targets { balls: vec![at(0.0, 0.0, 5.0, 1.0), at(1.0, 0.5, 8.0, 1.5), at(-3.0, 0.0, 4.0, 0.7)] }
    }

    /// Estimates of the size of the union, and of the part of it that two balls share.
    fn sizes(samples: usize, mut sample: impl FnMut() -> Option<[f64; 2]>) -> [MeanTest; 2] {
        let mut tests = [MeanTest::new(); 2];
        for _ in 0..samples {
            let values = sample().unwrap_or_default();
            tests.iter_mut().zip(values).for_each(|(test, value)| test.push(value));
        }
        tests
    }

    /// 1 for a member of the union, and 1 for a member of two.
    fn count(members: usize) -> [f64; 2] {
        [members.min(1) as f64, (members / 2) as f64]
    }

    /// That sample of a union of cones or disks that overlap against one of everything. On seeds chosen
    /// afresh, correct code fails with probability 1 %. Each part on its own, as if the others were not
    /// there, counts the shared part twice, and has to fail.
    #[test]
    fn what_overlaps_is_counted_once() {
        let targets = targets();
        let mut rng = Pcg32::new(3);
        let mut u = move || Vec2::from_array(rng.vec2_f32());
        let n = 200_000;

        let cones =
            |targets: &Targets| Cones::seen_from(targets, (Vec3::ZERO, 0.0), None, 2.0 * PI, |_, _| true);
        let all = cones(&targets).unwrap();
        let inside = |w: Vec3| count(all.list[..all.len].iter().filter(|cone| cone.contains(w)).count());
        let exact = sizes(n, || Some(inside(warp::square_to_sphere(u())).map(|x| x * 4.0 * f64::from(PI))));
        let aimed = |cones: Cones, u: &mut dyn FnMut() -> Vec2| {
            let weight = f64::from(cones.solid_angle());
            sizes(n / 4, || cones.sample(u().x, u()).map(|w| inside(w).map(|x| x * weight)))
        };
        let union = aimed(all, &mut u);
        for (a, b) in exact.iter().zip(&union) {
            assert!(a.welch(b).passes(sidak(ALPHA, 4)), "{}", a.welch(b));
        }
        let apart = targets.balls.iter().map(|&ball| cones(&Targets { balls: vec![ball] }).unwrap());
        let planted: f64 = apart.map(|one| aimed(one, &mut u)[1].mean()).sum();
        let error = 2.0 * exact[1].standard_error();
        assert!((planted - exact[1].mean()).abs() > 10.0 * error, "{planted}");

        let direction = Vec3::new(0.1, 0.05, 1.0).normalize();
        let disks = Disks::new(&targets, 10.0).unwrap();
        let frame = Frame::from_normal(direction);
        let inside = |p: Vec3| {
            let across = |b: &&Ball| frame.to_local(p - b.center).truncate().length() <= b.radius;
            count(targets.balls.iter().filter(across).count())
        };
        let square = |u: Vec2| frame.to_world(((u - 0.5) * 20.0).extend(0.0));
        let exact = sizes(n, || Some(inside(square(u())).map(|x| x * 400.0)));
        let weight = f64::from(disks.area());
        let union =
            sizes(n / 4, || disks.sample(direction, u().x, u()).map(|p| inside(p).map(|x| x * weight)));
        for (a, b) in exact.iter().zip(&union) {
            assert!(a.welch(b).passes(sidak(ALPHA, 4)), "{}", a.welch(b));
        }
    }

    #[test]
    fn rays_that_meet_a_ball_meet_its_box() {
        let targets = targets();
        let mut rng = Pcg32::new(4);
        let (mut met, mut missed) = (0, 0);
        for _ in 0..10_000 {
            let direction = warp::square_to_sphere(Vec2::from_array(rng.vec2_f32()));
            let ray = Ray::new(Vec3::new(0.3, -0.2, 0.1), direction);
            let meets = targets.balls.iter().any(|b| {
                let to = b.center - ray.origin;
                to.dot(direction) > 0.0 && to.cross(direction).length() < b.radius
            });
            met += u32::from(meets);
            missed += u32::from(!targets.met_by(&ray));
            assert!(!meets || targets.met_by(&ray), "{direction}");
        }
        assert!(met > 100 && missed > 5000);
    }
}
