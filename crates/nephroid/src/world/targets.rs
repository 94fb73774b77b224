//! What photons are aimed at, and how the paths of a map are shared out among lights.

use crate::light::{Ball, EmissionNumbers, Emitter, Lookup, MAX_BALLS, Targets};
use crate::material::Material;
use crate::math::{Bounds, Ray, Vec3, warp};
use crate::sampling::{Discrete, Key, Sampler, Sequence, Stream};
use crate::scene::Scene;
use crate::shape::{Primitive, ShearedRay};

use super::is_dirac;

/// How often what is to be aimed at is halved: balls for half of [`MAX_BALLS`], the rest being lamps.
const HALVINGS: u32 = 4;

/// Two halves take the place of the whole where their silhouettes together are smaller than this share
/// of its own.
const WORTH: f32 = 0.8;

/// The share of paths by the power of lights, whatever they send to the targets, in case an estimate of
/// that is too low.
const BY_POWER: f64 = 0.05;

/// The aims of both maps.
#[derive(Clone, Debug, Default)]
pub(crate) struct Aims {
    /// At all surfaces; `None` if one of them is infinite.
    pub global: Option<Aim>,
    /// At specular surfaces, for a path that meets another one first makes no caustic; `None` if one of
    /// them is infinite.
    pub caustic: Option<Aim>,
    /// Infinite planes, and a length beyond which the rest of the scene ends.
    planes: Vec<Primitive>,
    reach: f32,
}

/// What the paths of one map are aimed at.
#[derive(Clone, Debug)]
pub(crate) struct Aim {
    pub targets: Targets,
    /// Whether rays are held against the boxes of the targets before they are traced. The tree does
    /// that as well where the targets are all there is.
    pub selective: bool,
    /// Lights by what they send to the targets.
    pub lights: Discrete,
    /// For each light the mean power of its photons, in W, each counted for its power.
    pub levels: Vec<f32>,
}

impl Aims {
    /// `emitter_of_shape` tells which shapes are lights, and `reach` the radius of the scene.
    pub fn new(
        scene: &Scene,
        pieces: &[Vec<Primitive>],
        emitters: &[Emitter],
        emitter_of_shape: &[Option<u32>],
        lookup: Lookup<'_>,
        reach: f32,
    ) -> Self {
        let solid: Vec<usize> = (0..pieces.len())
            .filter(|&i| !matches!(scene.materials[scene.shapes[i].material], Material::Null))
            .collect();
        let (lamps, others): (Vec<_>, Vec<_>) = solid.iter().partition(|&&i| emitter_of_shape[i].is_some());
        let all = targets_of_all(pieces, &lamps, &others, emitter_of_shape);
        let specular = solid.iter().filter(|&&i| is_dirac(&scene.materials, scene.shapes[i].material));
        let specular: Option<Vec<_>> = specular.flat_map(|&i| &pieces[i]).map(Item::of_piece).collect();
        let specular = specular.map(|mut items| Targets { balls: cover(&mut items, HALVINGS) });
        let aim = |targets, selective| Aim::new(emitters, lookup, targets, selective);
        Self {
            global: all.and_then(|targets| aim(targets, false)),
            caustic: specular.and_then(|targets| aim(targets, true)),
            planes: solid
                .iter()
                .flat_map(|&i| &pieces[i])
                .filter(|p| p.bounds().is_empty())
                .copied()
                .collect(),
            reach,
        }
    }

    /// A ray from infinitely far away, begun before it passes any infinite plane: they lie in no bounds.
    pub fn before_planes(&self, ray: Ray) -> Ray {
        let back = Ray::new(ray.origin, -ray.direction);
        let sheared = ShearedRay::new(back.direction);
        let distances =
            self.planes.iter().filter_map(|plane| plane.intersect(&back, &sheared)).map(|hit| hit.t);
        match distances.reduce(f32::max) {
            Some(t) => Ray::new(back.at(t * 1.001 + self.reach), ray.direction),
            None => ray,
        }
    }
}

impl Aim {
    /// `None` if there is no light.
    fn new(emitters: &[Emitter], lookup: Lookup<'_>, targets: Targets, selective: bool) -> Option<Self> {
        let mut aim = Self { targets, selective, lights: Discrete::new([1.0])?, levels: Vec::new() };
        let mut aimed = Vec::with_capacity(emitters.len());
        for (i, emitter) in (0..).zip(emitters) {
            let (mean, level) = aim.power_of(emitter, lookup, i, emitters.len());
            aimed.push(mean);
            aim.levels.push(level);
        }
        let power = |e: &Emitter| f64::from(e.power.mean());
        let (sent, given): (f64, f64) = (aimed.iter().sum(), emitters.iter().map(power).sum());
        aim.lights = Discrete::new(emitters.iter().zip(&aimed).map(|(emitter, &mean)| {
            let by_power = power(emitter) / given;
            if sent > 0.0 { (1.0 - BY_POWER) * mean / sent + BY_POWER * by_power } else { by_power }
        }))?;
        Some(aim)
    }

    /// The power that an emitter sends to the targets, and the level of its photons.
    fn power_of(&self, emitter: &Emitter, lookup: Lookup<'_>, index: u64, emitters: usize) -> (f64, f32) {
        let samples = (65_536 / emitters).clamp(64, 2048);
        let key = Key::new(0, 0, Stream::Pilot).with(index);
        let (mut sum, mut squares) = (0.0, 0.0);
        for i in 0..samples {
            let mut sampler = Sampler::new(Sequence::Sobol, key, i as u64);
            let (direction, position) = (sampler.next_2d(), sampler.next_2d());
            let u = EmissionNumbers { position, direction, target: sampler.next_1d() };
            let emission = emitter.emit(lookup, u, Some(&self.targets), warp::square_to_sphere);
            let power = f64::from(emission.power.mean());
            if power > 0.0 && self.keeps(&emission.ray) {
                sum += power;
                squares += power * power;
            }
        }
        if sum > 0.0 { (sum / samples as f64, (squares / sum) as f32) } else { (0.0, 0.0) }
    }

    /// Whether a ray may meet what is aimed at.
    pub fn keeps(&self, ray: &Ray) -> bool {
        !self.selective || self.targets.met_by(ray)
    }
}

/// The balls around everything: lamps on their own, for those that are convex do not aim at themselves.
/// `None` if a shape is infinite.
fn targets_of_all(
    pieces: &[Vec<Primitive>],
    lamps: &[usize],
    others: &[usize],
    emitter_of_shape: &[Option<u32>],
) -> Option<Targets> {
    let apart = if lamps.len() <= MAX_BALLS / 2 { lamps } else { &[] };
    let together = if apart.is_empty() { [lamps, others].concat() } else { others.to_vec() };
    let shape = |&i: &usize| {
        let items: Option<Vec<_>> = pieces[i].iter().map(Item::of_piece).collect();
        items.map(|items| Item::around(&items))
    };
    let mut items = together.iter().map(shape).collect::<Option<Vec<_>>>()?;
    let mut targets = Targets { balls: cover(&mut items, HALVINGS) };
    for &i in apart {
        let lamp = shape(&i)?.ball(emitter_of_shape[i]);
        if !targets.contains(&lamp) {
            targets.balls.push(lamp);
        }
    }
    Some(targets)
}

/// Some of the scene, in a ball and in a box.
#[derive(Clone, Copy, Debug)]
struct Item {
    center: Vec3,
    radius: f32,
    bounds: Bounds,
}

impl Item {
    /// `None` if it is infinite.
    fn of_piece(piece: &Primitive) -> Option<Self> {
        let bounds = piece.bounds();
        let (center, radius) = match piece {
            Primitive::Sphere(sphere) => (sphere.center, sphere.radius),
            _ => bounds.bounding_sphere(),
        };
        (!bounds.is_empty()).then_some(Self { center, radius, bounds })
    }

    /// Around at least one.
    fn around(items: &[Self]) -> Self {
        if let [one] = items {
            return *one;
        }
        let bounds = items.iter().fold(Bounds::EMPTY, |b, item| b.union(item.bounds));
        let (center, corner) = bounds.bounding_sphere();
        let farthest = items.iter().map(|i| i.center.distance(center) + i.radius).fold(0.0, f32::max);
        Self { center, radius: corner.min(farthest), bounds }
    }

    fn ball(self, emitter: Option<u32>) -> Ball {
        Ball::around(self.center, self.radius, self.bounds, emitter)
    }
}

/// Covers items by balls: one, or those of both halves of space if they are so much smaller.
fn cover(items: &mut [Item], halvings: u32) -> Vec<Ball> {
    if items.is_empty() {
        return Vec::new();
    }
    let whole = vec![Item::around(items).ball(None)];
    let centers = Bounds::of(items.iter().map(|item| item.center));
    let (extent, middle) = (centers.extent(), centers.center());
    let axis = (0..3).fold(0, |best, k| if extent[k] > extent[best] { k } else { best });
    items.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]));
    let below = items.partition_point(|item| item.center[axis] < middle[axis]);
    if halvings == 0 || below == 0 {
        return whole;
    }
    let (low, high) = items.split_at_mut(below);
    let mut halves = cover(low, halvings - 1);
    halves.append(&mut cover(high, halvings - 1));
    let size = |balls: &[Ball]| balls.iter().map(|ball| ball.radius * ball.radius).sum::<f32>();
    if size(&halves) < WORTH * size(&whole) { halves } else { whole }
}
