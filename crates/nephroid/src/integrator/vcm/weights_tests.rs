//! All techniques of a path share it out: their weights, each worked out from what its own two walks know, add up to one,
//! and each is the technique's density over the sum of all.

use std::f64::consts::PI;

use super::densities::{Kind, Node};
use super::reach::Reach;
use super::weights::{Technique, Techniques, Weighed, Whole};
use crate::sampling::{Key, Sampler, Sequence, Stream};

/// Sums and products of up to two dozen numbers in double precision, from densities in single precision, whose products with
/// areas are rounded; the weight itself is of single precision.
const ROUNDING: f64 = 2e-6;

/// A path, and what every walk would find at its vertices.
#[derive(Clone, Debug)]
struct Path {
    kinds: Vec<Kind>,
    /// Of walks from the lamp and from the camera.
    densities: Vec<[f32; 2]>,
    far: Vec<bool>,
    at_first: f32,
}

fn sampler(path: u64) -> Sampler {
    Sampler::new(Sequence::Independent, Key::new(7, 0, Stream::Pilot), path)
}

/// A vertex at random for each but the lamp, with the first that the camera sees and is not specular on a surface.
fn random_path(sampler: &mut Sampler) -> Path {
    let count = 2 + (sampler.next_1d() * 8.0) as usize;
    let mut kinds = vec![Kind::Lamp { dirac: sampler.next_1d() < 0.3 }];
    for _ in 1..count {
        kinds.push(match sampler.next_1d() {
            u if u < 0.3 => Kind::Specular,
            u if u < 0.5 => Kind::Medium,
            _ => Kind::Surface,
        });
    }
    let first = kinds.iter_mut().rev().find(|kind| **kind != Kind::Specular);
    if let Some(first) = first.filter(|kind| **kind == Kind::Medium) {
        *first = Kind::Surface;
    }
    let mut density = || libm::expf(12.0 * sampler.next_1d() - 6.0);
    let densities = (0..count).map(|_| [density(), density()]).collect();
    let at_first = 0.1 * density();
    let far = (0..count).map(|_| sampler.next_1d() < 0.5).collect();
    Path { kinds, densities, far, at_first }
}

fn random_techniques(sampler: &mut Sampler) -> Techniques {
    let mut or_none = |value: f32| if sampler.next_1d() < 0.2 { 0.0 } else { value };
    let (radius, paths, to_lens) = (or_none(0.03), or_none(1000.0), or_none(3.0));
    let (connects, correlation) = (sampler.next_1d() < 0.7, sampler.next_1d() < 0.5);
    Techniques { reach: Reach { radius, paths }, to_lens, connects, correlation }
}

/// What no walk knows yet when a technique is weighed: it must not be read.
const STALE: f32 = f32::NAN;

impl Path {
    fn count(&self) -> usize {
        self.kinds.len()
    }

    /// The walk from the lamp over so many vertices; of the last two it does not know how the other walk comes there.
    fn light(&self, vertices: usize) -> Vec<Node> {
        let node = |i: usize| {
            let [arrival, counter] = self.densities[i];
            let counter = if i + 2 < vertices { counter } else { STALE };
            Node {
                arrival,
                counter,
                kind: self.kinds[i],
                far: if i + 1 < vertices { self.far[i] } else { false },
            }
        };
        (0..vertices).map(node).collect()
    }

    /// The walk from the camera that ends at vertex `last`.
    fn camera(&self, last: usize) -> Vec<Node> {
        let node = |i: usize| {
            let [counter, arrival] = self.densities[i];
            Node { arrival, counter, kind: self.kinds[i], far: self.far[i] }
        };
        (last..self.count()).rev().map(node).collect()
    }

    /// As the integrator weighs it.
    fn weighed(&self, techniques: &Techniques, found: Technique, light: usize) -> Weighed {
        let (light, camera) = (self.light(light), self.camera(light));
        let last = light.len() - 1;
        let before = if last > 0 { self.densities[last - 1][1] } else { STALE };
        let path = Whole {
            light: &light,
            counters: [self.densities[last][1], before],
            camera: &camera,
            at_first: self.at_first,
            far: found == Technique::Merged || self.far[last],
        };
        techniques.weigh(&path, found)
    }

    /// Every technique, the vertices of its walk from the lamp and its density.
    fn all(&self, techniques: &Techniques) -> Vec<(Technique, usize, f64)> {
        let (count, first) = (self.count(), self.first());
        let rough = |i: usize| self.kinds[i] != Kind::Specular;
        let mut all = Vec::new();
        if self.kinds[0] == (Kind::Lamp { dirac: false }) {
            all.push((Technique::Met, 1, self.density(0)));
        }
        for s in 1..=count {
            let to_lens = s == count;
            let times = match s {
                _ if to_lens => f64::from(techniques.to_lens),
                1 => 1.0,
                _ => f64::from(u8::from(techniques.connects)),
            };
            if rough(s - 1) && (to_lens || rough(s)) && times > 0.0 {
                all.push((Technique::Connected, s, times * self.density(s)));
            }
        }
        for m in 2..count {
            let radius = match m {
                _ if self.kinds[m] != Kind::Surface => 0.0,
                _ if m == first => self.at_first,
                _ if self.far[m] => techniques.reach.radius,
                _ => 0.0,
            };
            let area = f64::from(techniques.reach.paths) * PI * f64::from(radius).powi(2);
            if area > 0.0 {
                let share = if techniques.correlation { self.share(m, techniques) } else { 1.0 };
                let density = self.density(m) * f64::from(self.densities[m][0]) * area * share;
                all.push((Technique::Merged, m + 1, density));
            }
        }
        all
    }

    fn first(&self) -> usize {
        (0..self.count()).rev().find(|i| self.kinds[*i] != Kind::Specular).unwrap_or(0)
    }

    /// P(s): that of walks over s vertices from the lamp, and the others from the camera.
    fn density(&self, s: usize) -> f64 {
        self.densities.iter().enumerate().map(|(i, [f, b])| f64::from(if i < s { *f } else { *b })).product()
    }

    /// See [`super::shares::Shares`].
    fn share(&self, m: usize, techniques: &Techniques) -> f64 {
        let first = self.first();
        if m == first {
            return 1.0;
        }
        let area = PI * f64::from(techniques.reach.radius).powi(2);
        let near = |i: usize, from: usize| {
            let around = match self.kinds[i] {
                Kind::Lamp { .. } => return 1.0,
                Kind::Medium => 4.0 / 3.0 * PI * f64::from(techniques.reach.radius).powi(3),
                Kind::Surface | Kind::Specular => area,
            };
            (f64::from(self.densities[i][from]) * around).min(1.0)
        };
        let q: f64 = (0..=m).map(|i| near(i, 0)).product();
        let p: f64 = (m..first).map(|i| near(i, 1)).product();
        p / (p + q - p * q)
    }
}

#[test]
fn weights_add_up_to_one() {
    let (mut merged, mut tried) = (0, 0);
    for number in 0..20_000 {
        let mut sampler = sampler(number);
        let (path, techniques) = (random_path(&mut sampler), random_techniques(&mut sampler));
        let all = path.all(&techniques);
        let whole: f64 = all.iter().map(|(.., density)| density).sum();
        let mut sum = 0.0;
        for &(found, light, density) in &all {
            let weight = f64::from(path.weighed(&techniques, found, light).weight);
            let exact = density / whole;
            let context = format!("{found:?} after {light} of {path:?} by {techniques:?}");
            assert!((weight - exact).abs() < ROUNDING, "{weight}, not {exact}: {context}");
            sum += weight;
            merged += u32::from(found == Technique::Merged);
        }
        if !all.is_empty() {
            tried += 1;
            assert!((sum - 1.0).abs() < all.len() as f64 * ROUNDING, "{sum}: {path:?} by {techniques:?}");
        }
    }
    assert!(merged > 10_000 && tried > 15_000, "{merged}, {tried}");
}

/// A path tracer alone would weigh its two techniques against each other: what is left out of the sum, all techniques know.
#[test]
fn every_technique_knows_how_much_more_there_is_than_a_path_tracers() {
    for number in 0..5_000 {
        let mut sampler = sampler(number);
        let (path, techniques) = (random_path(&mut sampler), random_techniques(&mut sampler));
        let all = path.all(&techniques);
        let is_of_paths = |found, light| light == 1 && found != Technique::Merged;
        let of_paths: f64 =
            all.iter().filter(|t| is_of_paths(t.0, t.1) && path.count() > 1).map(|t| t.2).sum();
        let whole: f64 = all.iter().map(|(.., density)| density).sum();
        for &(found, light, _) in &all {
            let over_paths = f64::from(path.weighed(&techniques, found, light).over_paths);
            let exact = whole / of_paths;
            let same = if exact.is_finite() {
                (over_paths / exact - 1.0).abs() < 1e-5
            } else {
                over_paths.is_infinite()
            };
            assert!(same, "{over_paths}, not {exact}: {found:?} after {light} of {path:?} by {techniques:?}");
        }
    }
}

/// Shares are chances: none is above one, none below zero, and the first vertex that the camera sees has all.
#[test]
fn shares_are_chances() {
    use super::shares::Shares;
    for number in 0..5_000 {
        let mut sampler = sampler(number);
        let path = random_path(&mut sampler);
        let (light, first) = (path.light(path.count()), path.first());
        let last = path.count() - 1;
        let counters = [path.densities[last][1], path.densities[last - 1][1]];
        let whole = Whole { light: &light, counters, camera: &[], at_first: path.at_first, far: true };
        let area = libm::expf(12.0 * sampler.next_1d() - 9.0);
        let shares = Shares::new(&whole, first, area);
        for vertex in 0..path.count() {
            let share = shares.at(vertex);
            assert!((0.0..=1.0 + 1e-12).contains(&share), "{share} at {vertex} of {path:?}");
            assert!(vertex < first || share == 1.0, "{share} at {vertex} of {path:?}");
        }
    }
}

/// Where walks from the camera come everywhere, each photon counts for itself; where they hardly ever come, a vertex's
/// photons have their way in common, and count as one.
#[test]
fn shares_follow_the_walk_from_the_camera() {
    use super::shares::Shares;
    let share = |from_camera: f32| {
        let kinds = [Kind::Lamp { dirac: false }, Kind::Surface, Kind::Surface, Kind::Surface];
        let node = |kind| Node { arrival: 10.0, counter: from_camera, kind, far: true };
        let light = kinds.map(node);
        let whole =
            Whole { light: &light, counters: [from_camera; 2], camera: &[], at_first: 0.1, far: true };
        Shares::new(&whole, 3, 1e-3).at(2)
    };
    assert_eq!(share(1e6), 1.0);
    // Both come near with chances of 1e-5 · 1e-3 and of (1e-2)².
    let (p, q) = (1e-8, 1e-4);
    assert!((share(1e-5) / (p / (p + q - p * q)) - 1.0).abs() < 1e-6);
}
