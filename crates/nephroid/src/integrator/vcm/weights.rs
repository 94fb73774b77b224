//! Multiple importance sampling over all techniques that could have found a path (Veach 1997, §10; Georgiev et al. 2012,
//! doi 10.1145/2366145.2366211; Hachisuka, Pantaleoni and Jensen 2012, doi 10.1145/2366145.2366210).
//!
//! A path has the vertices 0, at the lamp, to k − 1, the first that the camera sees. Technique `Connected(s)` walks s of
//! them from the lamp and the others from the camera, and `Merged(m)` walks to vertex m from both ends, where a photon
//! counts that lies near by. With F and B for the densities of walks from the lamp and from the camera,
//!
//! P(s) = Π_{i<s} F_i · Π_{i≥s} B_i,   P'(m) = P(m) F_m η,
//!
//! where η = N π r² is the number of light paths times the area in which their photons count. The balance heuristic
//! weighs a path by its own technique's share of the sum.

use std::f32::consts::PI;

use super::densities::{Kind, Node};
use super::reach::Reach;
use super::shares::Shares;

/// Vertices of a walk that are connected to those of the other, counted from its end: so many times so many connections
/// there may be for a camera sample.
pub(super) const MOST_CONNECTED: usize = 16;

/// How a path was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Technique {
    /// A walk from the camera met the lamp, which is the only vertex in the other's list.
    Met,
    /// A walk from the lamp and one from the camera, the last vertices of which see one another. One from the camera
    /// without any is the lens.
    Connected,
    /// The last vertex of the walk from the lamp is next to the last one of the other, which is not in its list.
    Merged,
}

/// How paths are looked for, apart from what is the same for all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Techniques {
    /// What is merged, and where.
    pub reach: Reach,
    /// Light paths for each camera sample of a pixel: how often the lens is connected to. 0 without.
    pub to_lens: f32,
    /// Whether vertices of light paths beyond the lamp are connected to those of camera paths.
    pub connects: bool,
    /// Whether merging counts for what it is worth where its photons share the rest of the path.
    pub correlation: bool,
}

/// The sums of a path's techniques, in units of the density of its walks connected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sums {
    /// All of them.
    pub all: f64,
    /// Those of a path tracer: paths that meet a lamp, and direct light.
    pub of_paths: f64,
    /// That which found the path.
    pub own: f64,
}

/// What a path counts for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Weighed {
    pub weight: f32,
    /// See [`Probe::technique`](crate::integrator::Probe::technique).
    pub over_paths: f32,
}

impl Weighed {
    /// That of a path which nothing else could have found.
    pub const ALONE: Self = Self { weight: 1.0, over_paths: 1.0 };
}

/// A path as its two walks know it.
pub(super) struct Whole<'a> {
    /// The lamp and what follows.
    pub light: &'a [Node],
    /// Densities of a walk from the camera at the last of these and at the one before.
    pub counters: [f32; 2],
    /// From what the camera sees first on.
    pub camera: &'a [Node],
    /// The radius within which photons are merged at the first vertex that the camera sees and is not specular.
    pub at_first: f32,
    /// Whether the last vertex of the former is far from what follows: see [`Node::far`].
    pub far: bool,
}

impl Whole<'_> {
    pub fn len(&self) -> usize {
        self.light.len() + self.camera.len()
    }

    /// Vertex i from the lamp.
    pub fn kind(&self, i: usize) -> Kind {
        let light = self.light.len();
        match self.light.get(i) {
            // Where the light path ends for this path it scatters, though it may have gone on by a Dirac lobe.
            Some(Node { kind: Kind::Specular, .. }) if i + 1 == light => Kind::Surface,
            Some(node) => node.kind,
            None => self.camera[self.len() - 1 - i].kind,
        }
    }

    /// The densities F and B at vertex i.
    pub fn densities(&self, i: usize) -> [f64; 2] {
        let light = self.light.len();
        if i >= light {
            let node = &self.camera[self.len() - 1 - i];
            return [node.counter, node.arrival].map(f64::from);
        }
        let counter = match light - 1 - i {
            back @ (0 | 1) => self.counters[back],
            _ => self.light[i].counter,
        };
        [self.light[i].arrival, counter].map(f64::from)
    }

    /// The first vertex that the camera sees and is not specular.
    pub fn first(&self) -> usize {
        (0..self.len()).rev().find(|i| self.kind(*i) != Kind::Specular).unwrap_or(0)
    }

    /// Whether vertex i is far from the next towards the camera.
    fn is_far(&self, i: usize) -> bool {
        let light = self.light.len();
        match i + 1 {
            next if next < light => self.light[i].far,
            next if next == light => self.far,
            _ => self.camera[self.len() - 1 - i].far,
        }
    }
}

impl Techniques {
    /// The weight of a path that was found so.
    pub fn weigh(&self, path: &Whole<'_>, found: Technique) -> Weighed {
        let Sums { all, own, of_paths } = self.sums(path, found);
        let weight = if own > 0.0 && all.is_finite() { (own / all) as f32 } else { 0.0 };
        Weighed { weight, over_paths: (all / of_paths) as f32 }
    }

    /// How often connections are tried between the last of s vertices from the lamp and the rest of a path; 0 where they
    /// cannot be.
    fn connections(&self, path: &Whole<'_>, s: usize) -> f64 {
        let count = path.len();
        if s == 0 {
            return f64::from(u8::from(path.kind(0) == Kind::Lamp { dirac: false }));
        }
        let specular = |i: usize| path.kind(i) == Kind::Specular;
        if specular(s - 1) || (s < count && specular(s)) {
            return 0.0;
        }
        match s {
            _ if s == count => f64::from(u8::from(count > 1)) * f64::from(self.to_lens),
            1 => 1.0,
            _ => f64::from(u8::from(self.connects && s <= MOST_CONNECTED && count - s <= MOST_CONNECTED)),
        }
    }

    /// The densities of all techniques.
    pub fn sums(&self, path: &Whole<'_>, found: Technique) -> Sums {
        let (count, light) = (path.len(), path.light.len());
        let first = path.first();
        let shares =
            self.correlation.then(|| Shares::new(path, first, PI * self.reach.radius * self.reach.radius));
        let merged = |m: usize, density: f64| -> f64 {
            let area = self.reach.area_at(path.kind(m), m, first, path.at_first, path.is_far(m));
            if area == 0.0 {
                0.0
            } else {
                density * area * shares.as_ref().map_or(1.0, |shares| shares.at(m))
            }
        };
        let here = self.connections(path, light);
        let mut sums = Sums { all: here, of_paths: 0.0, own: here };
        if light == 1 {
            sums.of_paths = here;
        }
        let mut relative = 1.0;
        for i in (0..light).rev() {
            let [forth, back] = path.densities(i);
            let merging = merged(i, relative * back);
            relative *= back / forth;
            let connected = relative * self.connections(path, i);
            sums.all += merging + connected;
            if i <= 1 {
                sums.of_paths += connected;
            }
            match found {
                Technique::Merged if i + 1 == light => sums.own = merging,
                Technique::Met if i == 0 => sums.own = connected,
                _ => {}
            }
        }
        let mut relative = 1.0;
        for i in light..count {
            let [forth, back] = path.densities(i);
            sums.all += merged(i, relative * forth);
            relative *= forth / back;
            sums.all += relative * self.connections(path, i + 1);
        }
        sums
    }
}
