//! What the tests of beams share.

use super::{Beam, BeamMap, BeamWidth, Beams};
use crate::bvh::Simd;
use crate::color::Rgb;
use crate::math::{DVec3, Ray, Vec2, Vec3, warp};
use crate::photon_map::Kernel;
use crate::photon_map::testing::Rng;

/// A beam of one watt; its `light` is its number.
pub fn beam(number: usize, origin: Vec3, direction: Vec3, length: f32) -> Beam {
    let (light, power) = (number as u32, Rgb::WHITE);
    Beam { origin, direction, length, power, depth: 1, light, medium: 0, long: true }
}

pub fn map(beams: Vec<Beam>, radius: f32) -> BeamMap {
    BeamMap::build(Beams::new(1, beams), BeamWidth::Fixed { radius })
}

pub fn direction(rng: &mut Rng) -> Vec3 {
    warp::square_to_sphere(Vec2::new(rng.next(), rng.next())).normalize()
}

/// What `along` visits: the beam's number, t, s and weight.
pub type Visit = (usize, f32, f32, f32);

pub fn visits(map: &BeamMap, simd: Simd, ray: &Ray, t_max: f32, medium: u16, kernel: Kernel) -> Vec<Visit> {
    let mut found = Vec::new();
    let note = |t, s, beam: &Beam, weight| found.push((beam.light as usize, t, s, weight));
    map.along_by(simd, ray, t_max, medium, kernel, note);
    found
}

/// The sum of the weights of all beams along a ray.
pub fn total(map: &BeamMap, ray: &Ray, t_max: f32, kernel: Kernel) -> f64 {
    let mut sum = 0.0;
    map.along(ray, t_max, 0, kernel, |_, _, _, weight| sum += f64::from(weight));
    sum
}

/// A ray and a beam in double precision.
pub struct Pair {
    pub sin: f64,
    pub cos: f64,
    /// Nearest points of the two lines and their distance.
    pub t: f64,
    pub s: f64,
    pub distance: f64,
    /// Perpendicular to the beam: where the ray is at t = 0, and how that changes.
    pub across: (DVec3, DVec3),
    /// Along the beam: where the ray is at t = 0.
    pub start: f64,
}

impl Pair {
    pub fn new(ray: &Ray, beam: &Beam) -> Self {
        let [o, d, p, w] = [ray.origin, ray.direction, beam.origin, beam.direction].map(Vec3::as_dvec3);
        let (d, w) = (d.normalize(), w.normalize());
        let n = d.cross(w);
        let sin_sq = n.length_squared();
        let from = p - o;
        let t = from.cross(w).dot(n) / sin_sq;
        let s = from.cross(d).dot(n) / sin_sq;
        let (cos, start) = (d.dot(w), -from.dot(w));
        let across = (-from - w * start, d - w * cos);
        Self { sin: sin_sq.sqrt(), cos, t, s, distance: (o + d * t).distance(p + w * s), across, start }
    }
}
