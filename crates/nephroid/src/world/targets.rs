//! What photons are aimed at, and how the paths of a map are shared out among lights.

use std::mem;

use crate::light::{Ball, EmissionNumbers, Emitter, Lookup, MAX_BALLS, Targets};
use crate::material::Material;
use crate::math::{Bounds, Ray, Vec3, warp};
use crate::sampling::{Discrete, Key, Sampler, Sequence, Stream};
use crate::scene::Scene;
use crate::shape::{Primitive, Shape, ShearedRay};

use super::scenery::Scenery;

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
    /// Whether anything to be seen has Dirac lobes.
    pub dirac: bool,
    /// Whether anything to be seen may have lobes that are Diracs or nearly so: without, there are no caustics.
    pub specular: bool,
    /// At all surfaces; `None` if one of them is infinite.
    pub global: Option<Aim>,
    /// At specular surfaces, for a path that meets another one first makes no caustic; `None` if one of
    /// them is infinite.
    pub caustic: Option<Aim>,
    /// Infinite planes, and a length beyond which the rest of the scene ends.
    planes: Vec<Primitive>,
    pub reach: f32,
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
    /// For each light the power that it sends to the targets, in W, as trials found it.
    pub sent: Vec<f32>,
    /// For each light the mean power of its photons, in W, each counted for its power.
    pub levels: Vec<f32>,
}

impl Aims {
    /// `emitter_of_shape` tells which shapes are lights, and `reach` the radius of the scene.
    pub(super) fn new(
        scene: &Scene,
        scenery: &Scenery,
        emitters: &[Emitter],
        emitter_of_shape: &[Option<u32>],
        reach: f32,
    ) -> Self {
        let mut solids = solids(scene, scenery, emitter_of_shape);
        let lookup = Lookup { meshes: scenery.meshes.as_slice(), textures: &scene.textures };
        let aim = |targets, selective| Aim::new(emitters, lookup, targets, selective);
        Self {
            dirac: has_dirac(scene),
            specular: solids.iter().any(|solid| solid.specular),
            global: targets_of_all(&solids).and_then(|targets| aim(targets, false)),
            caustic: specular_targets(&mut solids).and_then(|targets| aim(targets, true)),
            planes: solids.into_iter().flat_map(|solid| solid.planes).collect(),
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
        let mut aim =
            Self { targets, selective, lights: Discrete::new([1.0])?, sent: Vec::new(), levels: Vec::new() };
        let mut aimed = Vec::with_capacity(emitters.len());
        for (i, emitter) in (0..).zip(emitters) {
            let (mean, level) = aim.power_of(emitter, lookup, i, emitters.len());
            aimed.push(mean);
            aim.sent.push(mean as f32);
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

/// A shape that photons can meet: one of the scene, or one of a group at its place.
struct Solid {
    /// The light that it is.
    lamp: Option<u32>,
    specular: bool,
    /// What it is made of; of a shape of a group all in one.
    items: Vec<Item>,
    /// What of it is infinite.
    planes: Vec<Primitive>,
}

/// All but null shapes, with those of them behind which another medium begins.
fn solids(scene: &Scene, scenery: &Scenery, emitter_of_shape: &[Option<u32>]) -> Vec<Solid> {
    let solid = |shape: usize, described: &Shape| {
        let material = described.material;
        let inside = Material::unmasked(&scene.materials, material);
        if scene.materials[inside] == Material::Null && !described.boundary.is_named() {
            return None;
        }
        let lamp = emitter_of_shape.get(shape).copied().flatten();
        let specular = Material::may_be_specular(&scene.materials, material, &scene.textures);
        let (items, planes) = items(scenery, shape, specular);
        Some(Solid { lamp, specular, items, planes })
    };
    let mut solids: Vec<_> =
        scene.shapes.iter().enumerate().filter_map(|(i, shape)| solid(i, shape)).collect();
    let mut first = scene.shapes.len();
    let mut groups = Vec::new();
    for group in scene.groups.iter() {
        let members = (first..).zip(&group.shapes).filter_map(|(i, shape)| solid(i, shape));
        groups.push(
            members.map(|solid| (solid.specular, Item::around(&solid.items).bounds)).collect::<Vec<_>>(),
        );
        first += group.shapes.len();
    }
    for placed in &scenery.instances {
        solids.extend(groups[placed.group as usize].iter().map(|&(specular, bounds)| {
            let items = vec![Item::of_box(placed.bounds(bounds))];
            Solid { lamp: None, specular, items, planes: Vec::new() }
        }));
    }
    solids
}

/// What a shape is made of in its own space, the scene's or that of its group, and what of it is infinite.
/// Of a mesh all triangles only where asked for.
fn items(scenery: &Scenery, shape: usize, apart: bool) -> (Vec<Item>, Vec<Primitive>) {
    if let Some(mesh) = scenery.mesh_of[shape] {
        let mesh = &scenery.meshes.as_slice()[mesh as usize];
        if !apart {
            let corners = || mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]);
            return (vec![Item::of_points(corners)], Vec::new());
        }
        let corners = |triangle: &[u32; 3]| Bounds::of(triangle.map(|i| mesh.positions[i as usize]));
        return (mesh.triangles.iter().map(corners).map(Item::of_box).collect(), Vec::new());
    }
    let (planes, finite): (Vec<_>, Vec<_>) =
        scenery.pieces(shape).iter().partition(|piece| piece.bounds().is_empty());
    (finite.iter().map(Item::of_piece).collect(), planes)
}

/// The balls around everything: lamps on their own, for those that are convex do not aim at themselves.
/// `None` if a shape is infinite.
fn targets_of_all(solids: &[Solid]) -> Option<Targets> {
    if solids.iter().any(|solid| !solid.planes.is_empty()) {
        return None;
    }
    let apart = solids.iter().filter(|solid| solid.lamp.is_some()).count() <= MAX_BALLS / 2;
    let (lamps, together): (Vec<&Solid>, Vec<&Solid>) =
        solids.iter().partition(|solid| apart && solid.lamp.is_some());
    let mut items: Vec<_> = together.iter().map(|solid| Item::around(&solid.items)).collect();
    let mut targets = Targets { balls: cover(&mut items, HALVINGS) };
    for solid in lamps {
        let lamp = Item::around(&solid.items).ball(solid.lamp);
        if !targets.contains(&lamp) {
            targets.balls.push(lamp);
        }
    }
    Some(targets)
}

/// Whether any shape has a material with Dirac lobes.
fn has_dirac(scene: &Scene) -> bool {
    scene.all_shapes().any(|shape| Material::has_dirac(&scene.materials, shape.material))
}

/// The balls around what is specular, whose items it takes; `None` if some of it is infinite.
fn specular_targets(solids: &mut [Solid]) -> Option<Targets> {
    if solids.iter().any(|solid| solid.specular && !solid.planes.is_empty()) {
        return None;
    }
    let mut items = Vec::new();
    for solid in solids.iter_mut().filter(|solid| solid.specular) {
        let own = mem::take(&mut solid.items);
        // Of a big mesh alone there are enough not to have them twice.
        if items.is_empty() { items = own } else { items.extend(own) }
    }
    Some(Targets { balls: cover(&mut items, HALVINGS) })
}

/// Some of the scene, in a ball and in a box.
#[derive(Clone, Copy, Debug)]
struct Item {
    center: Vec3,
    radius: f32,
    bounds: Bounds,
}

impl Item {
    /// Of a finite primitive.
    fn of_piece(piece: &Primitive) -> Self {
        match piece {
            Primitive::Sphere(s) => Self { center: s.center, radius: s.radius, bounds: piece.bounds() },
            _ => Self::of_box(piece.bounds()),
        }
    }

    fn of_box(bounds: Bounds) -> Self {
        let (center, radius) = bounds.bounding_sphere();
        Self { center, radius, bounds }
    }

    /// Around points, which are gone through twice.
    fn of_points<P: Iterator<Item = Vec3>>(points: impl Fn() -> P) -> Self {
        let around = Self::of_box(Bounds::of(points()));
        let farthest_sq = points().map(|p| p.distance_squared(around.center)).fold(0.0, f32::max);
        Self { radius: around.radius.min(farthest_sq.sqrt()), ..around }
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
