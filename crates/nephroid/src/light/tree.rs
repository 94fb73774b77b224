//! A tree of lights, by which a point asks one that probably lights it (Conty Estevez and Kulla 2018, *Importance Sampling of
//! Many Lights with Adaptive Tree Splitting*, doi 10.1145/3233305), here without the splitting.

use super::extent::{Extent, NormalCone};
use crate::math::real::{cos, sin};
use crate::math::{Bounds, Vec3};
use crate::shape::SurfacePoint;

/// Places where a node may be split along each axis, and one more.
const BINS: usize = 12;

/// No cosine counts for less: bounds are rough, and a lamp that is asked too rarely makes specks.
const LEAST_COSINE: f32 = 0.1;

/// By how much the cosine of an angle must be below that at which a lamp's light ends for the lamp to be left out.
const MARGIN: f32 = 1e-3;

/// No number of a node.
const NONE: u32 = u32::MAX;

/// Who asks lights: a point of a surface, or of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Asker {
    pub position: Vec3,
    /// Unit normal of the surface on either side; zero in space.
    pub normal: Vec3,
}

impl Asker {
    /// On a surface.
    pub fn on(point: &SurfacePoint) -> Self {
        Self { position: point.position, normal: point.ng }
    }

    /// Between surfaces.
    pub fn in_space(position: Vec3) -> Self {
        Self { position, normal: Vec3::ZERO }
    }
}

/// Lamps that are not infinitely far away, by place and direction.
#[derive(Clone, Debug)]
pub(crate) struct LightTree {
    nodes: Vec<Node>,
    /// The leaf of each emitter.
    leaf_of: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    center: Vec3,
    radius: f32,
    axis: Vec3,
    /// Sine and cosine of the half-angle that normals fill.
    normals: [f32; 2],
    cos_beyond: f32,
    strength: f32,
    parent: u32,
    below: Below,
}

#[derive(Clone, Copy, Debug)]
enum Below {
    Emitter(u32),
    /// The first child follows its parent; this is the second.
    Nodes(u32),
}

impl LightTree {
    /// Of emitters by number, each of which is there once; `None` if there are none.
    pub fn new(mut lamps: Vec<(u32, Extent)>) -> Option<Self> {
        let emitters = lamps.iter().map(|(number, _)| *number as usize + 1).max()?;
        let mut tree = Self { nodes: Vec::with_capacity(2 * lamps.len()), leaf_of: vec![NONE; emitters] };
        tree.build(&mut lamps, NONE);
        Some(tree)
    }

    /// Adds a node for at least one lamp.
    fn build(&mut self, lamps: &mut [(u32, Extent)], parent: u32) {
        let number = self.nodes.len() as u32;
        let all = extent_of(lamps);
        if let [(emitter, _)] = lamps {
            self.nodes.push(Node::new(&all, parent, Below::Emitter(*emitter)));
            self.leaf_of[*emitter as usize] = number;
            return;
        }
        self.nodes.push(Node::new(&all, parent, Below::Nodes(NONE)));
        let middle = split(lamps, &all);
        let (first, second) = lamps.split_at_mut(middle);
        self.build(first, number);
        let at = self.nodes.len() as u32;
        self.nodes[number as usize].below = Below::Nodes(at);
        self.build(second, number);
    }

    /// An emitter, and the probability with which a point asks it.
    pub fn sample(&self, from: &Asker, u: f32) -> (usize, f32) {
        let (mut number, mut probability, mut u) = (0, 1.0, f64::from(u));
        loop {
            let node = &self.nodes[number];
            let second = match node.below {
                Below::Emitter(emitter) => return (emitter as usize, probability as f32),
                Below::Nodes(second) => second as usize,
            };
            let first_share = self.share_of_first(number, second, from);
            if u < first_share {
                (number, probability, u) = (number + 1, probability * first_share, u / first_share);
            } else {
                let share = 1.0 - first_share;
                (number, probability, u) = (second, probability * share, (u - first_share) / share);
            }
            // Rounding must not lead to what has no share.
            u = u.clamp(0.0, 1.0f64.next_down());
        }
    }

    /// The probability with which a point asks an emitter.
    pub fn pmf(&self, emitter: usize, from: &Asker) -> f32 {
        let Some(mut number) = self.leaf_of.get(emitter).copied().filter(|leaf| *leaf != NONE) else {
            return 0.0;
        };
        let mut probability = 1.0;
        while self.nodes[number as usize].parent != NONE {
            let parent = self.nodes[number as usize].parent;
            if let Below::Nodes(second) = self.nodes[parent as usize].below {
                let first_share = self.share_of_first(parent as usize, second as usize, from);
                probability *= if number == second { 1.0 - first_share } else { first_share };
            }
            number = parent;
        }
        probability as f32
    }

    /// The share of the first child: by importance, or where neither has any by strength.
    fn share_of_first(&self, parent: usize, second: usize, from: &Asker) -> f64 {
        let (a, b) = (&self.nodes[parent + 1], &self.nodes[second]);
        let share = |a: f32, b: f32| {
            let (a, b) = (f64::from(a), f64::from(b));
            let share = a / (a + b);
            share.is_finite().then_some(share)
        };
        share(a.importance(from), b.importance(from)).or_else(|| share(a.strength, b.strength)).unwrap_or(0.5)
    }
}

impl Node {
    fn new(extent: &Extent, parent: u32, below: Below) -> Self {
        let NormalCone { axis, normals, beyond } = extent.cone;
        let (center, radius) = extent.bounds.bounding_sphere();
        Self {
            center,
            radius,
            axis,
            normals: [sin(normals), cos(normals)],
            cos_beyond: cos(beyond),
            strength: extent.strength,
            parent,
            below,
        }
    }

    /// Roughly the irradiance at most: strength times both cosines over the distance squared. Zero only where no light of it
    /// comes.
    fn importance(&self, from: &Asker) -> f32 {
        let to = self.center - from.position;
        let (distance_sq, radius_sq) = (to.length_squared(), self.radius * self.radius);
        if distance_sq <= radius_sq {
            return if radius_sq > 0.0 { self.strength / radius_sq } else { 0.0 };
        }
        let distance = distance_sq.sqrt();
        let direction = to / distance;
        let sin_half = self.radius / distance;
        // The half-angle that the bounds fill, within which either cosine may be anything.
        let half = [sin_half, (1.0 - sin_half * sin_half).max(0.0).sqrt()];
        let [_, leaving] = less(less(with_sine(-self.axis.dot(direction)), self.normals), half);
        if leaving < self.cos_beyond - MARGIN {
            return 0.0;
        }
        let arriving = if from.normal == Vec3::ZERO {
            1.0
        } else {
            less(with_sine(from.normal.dot(direction).abs()), half)[1]
        };
        self.strength * leaving.max(LEAST_COSINE) * arriving.max(LEAST_COSINE) / distance_sq
    }
}

/// Sine and cosine of an angle in [0, π].
fn with_sine(cos: f32) -> [f32; 2] {
    [(1.0 - cos * cos).max(0.0).sqrt(), cos]
}

/// Sine and cosine of one angle less another, and of 0 where that is the larger.
fn less([sin_a, cos_a]: [f32; 2], [sin_b, cos_b]: [f32; 2]) -> [f32; 2] {
    if cos_a >= cos_b { [0.0, 1.0] } else { [sin_a * cos_b - cos_a * sin_b, cos_a * cos_b + sin_a * sin_b] }
}

fn extent_of(lamps: &[(u32, Extent)]) -> Extent {
    let rest = &lamps[1..];
    rest.iter().fold(lamps[0].1, |all, (_, extent)| all.union(*extent))
}

/// Orders lamps so that the first few and the others are well apart, and tells how many those are. Bins along each axis; the
/// cost of a part is its strength times its solid angle times the square of its diagonal, which unlike the paper's surface
/// area tells points on a line apart.
fn split(lamps: &mut [(u32, Extent)], all: &Extent) -> usize {
    let centers = Bounds::of(lamps.iter().map(|(_, extent)| extent.bounds.center()));
    let (low, size) = (centers.min, centers.extent());
    let bin = |extent: &Extent, axis: usize| {
        let place = (extent.bounds.center()[axis] - low[axis]) / size[axis] * BINS as f32;
        (place as usize).min(BINS - 1)
    };
    let cost =
        |part: &Extent| part.strength * part.cone.measure().max(1e-3) * part.bounds.extent().length_squared();
    let longest = all.bounds.extent().max_element();
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in 0..3 {
        if size[axis] <= 0.0 {
            continue;
        }
        let mut bins: [Option<Extent>; BINS] = [None; BINS];
        for (_, extent) in lamps.iter() {
            let bin = &mut bins[bin(extent, axis)];
            *bin = Some(bin.map_or(*extent, |before| before.union(*extent)));
        }
        let join = |part: &[Option<Extent>]| part.iter().flatten().copied().reduce(Extent::union);
        // Thin slabs cost more.
        let shape = longest / all.bounds.extent()[axis];
        for at in 1..BINS {
            let (Some(first), Some(second)) = (join(&bins[..at]), join(&bins[at..])) else { continue };
            let total = shape * (cost(&first) + cost(&second));
            if best.is_none_or(|(least, ..)| total < least) {
                best = Some((total, axis, at));
            }
        }
    }
    let Some((_, axis, at)) = best else {
        // All in one place.
        return lamps.len() / 2;
    };
    let is_first = |lamp: &(u32, Extent)| bin(&lamp.1, axis) < at;
    lamps.sort_by_key(|lamp| !is_first(lamp));
    lamps.partition_point(is_first)
}
