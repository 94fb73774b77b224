//! The densities along a path, as far as the techniques that could have found it need them.

use crate::light::Asker;
use crate::math::Vec3;

/// What a path meets at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The lamp where it begins; a Dirac one no path meets by chance.
    Lamp { dirac: bool },
    /// A Dirac surface, at which nothing can be connected.
    Specular,
    /// Any other surface.
    Surface,
    /// A collision in a medium.
    Medium,
}

/// A vertex of a path that is walked from one of its ends.
///
/// Densities are per m², in media per m³, and per steradian for the direction of a lamp infinitely far away. What both
/// ends' walks have in common is left out of both: transmittances, chances of survival, and the lobe of a Dirac surface.
/// Weights that are made of them are the same whichever technique finds the path, and so they add up to one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// With which this walk comes here from the vertex before. At a lamp that with which it is asked for direct light.
    pub arrival: f32,
    /// With which a walk from the other end comes here, once it is known where this walk goes on.
    pub counter: f32,
    pub kind: Kind,
    /// Whether the next vertex towards the camera is so far away that photons may be merged here: see [`super::reach::Reach`].
    pub far: bool,
}

/// Where a vertex lies, and how it faces directions.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// A surface with this geometric normal.
    Surface { position: Vec3, ng: Vec3 },
    /// A point of a medium with this mean extinction, in 1/m.
    Medium { position: Vec3, sigma_t: f32 },
    /// A lamp without extent, or the lens.
    Point { position: Vec3 },
    /// A lamp infinitely far away in this direction.
    Distant { direction: Vec3 },
}

impl Place {
    /// What turns a density per unit of area across `direction` into one at the place itself.
    fn facing(&self, direction: Vec3) -> f32 {
        match self {
            Self::Surface { ng, .. } => ng.dot(direction).abs(),
            Self::Medium { sigma_t, .. } => *sigma_t,
            Self::Point { .. } | Self::Distant { .. } => 1.0,
        }
    }

    /// As one that asks lights, if it is a place that may.
    pub fn asker(&self) -> Option<Asker> {
        match self {
            Self::Surface { position, ng } => Some(Asker { position: *position, normal: *ng }),
            Self::Medium { position, .. } => Some(Asker::in_space(*position)),
            Self::Point { .. } | Self::Distant { .. } => None,
        }
    }

    pub fn position(&self) -> Option<Vec3> {
        match self {
            Self::Surface { position, .. } | Self::Medium { position, .. } | Self::Point { position } => {
                Some(*position)
            }
            Self::Distant { .. } => None,
        }
    }

    /// What densities per steradian at each of two places are multiplied by to be densities at the other: at `there` of
    /// those at `self`, and the other way round.
    pub fn between(&self, there: &Self) -> [f32; 2] {
        match (self, there) {
            (Self::Distant { direction }, _) => [there.facing(*direction), 1.0],
            (_, Self::Distant { direction }) => [1.0, self.facing(*direction)],
            _ => {
                let (Some(a), Some(b)) = (self.position(), there.position()) else { return [0.0; 2] };
                let way = b - a;
                let distance_sq = way.length_squared();
                if distance_sq == 0.0 {
                    return [0.0; 2];
                }
                let (direction, per_area) = (way / distance_sq.sqrt(), 1.0 / distance_sq);
                [there.facing(direction) * per_area, self.facing(direction) * per_area]
            }
        }
    }
}

/// A walk so far: its vertices, the first of which is a lamp or what the camera sees first.
#[derive(Clone, Debug)]
pub(super) struct Trail {
    pub nodes: Vec<Node>,
    /// The last vertex.
    pub at: Place,
    /// What turns a density per steradian at the last vertex into one at the vertex before.
    pub back: f32,
    /// The density per steradian of the direction that the walk has taken from the last vertex.
    pub leaving: f32,
}

impl Trail {
    /// A walk that has not begun.
    pub fn new() -> Self {
        Self { nodes: Vec::new(), at: Place::Point { position: Vec3::ZERO }, back: 0.0, leaving: 0.0 }
    }

    /// Begins anew at the end of a path, from where a way is taken with a density.
    pub fn begin(&mut self, at: Place, leaving: f32) {
        self.nodes.clear();
        (self.at, self.leaving, self.back) = (at, leaving, 0.0);
    }

    /// Comes to a vertex.
    pub fn arrive(&mut self, there: Place, kind: Kind) {
        let [forth, back] = self.at.between(&there);
        self.nodes.push(Node { arrival: self.leaving * forth, counter: 0.0, kind, far: false });
        (self.at, self.back) = (there, back);
    }

    /// The distance from the last vertex to a place.
    pub fn distance_to(&self, there: &Place) -> f32 {
        match (self.at.position(), there.position()) {
            (Some(a), Some(b)) => a.distance(b),
            _ => f32::INFINITY,
        }
    }

    /// Goes on from the last vertex by a Dirac lobe: for what follows nothing can be connected there, whatever other lobes
    /// it has.
    pub fn turn_specular(&mut self) {
        if let Some(last) = self.nodes.last_mut() {
            last.kind = Kind::Specular;
        }
        self.turn(1.0, 1.0);
    }

    /// Takes a direction from the last vertex with a density, and the opposite way that of the reverse.
    pub fn turn(&mut self, leaving: f32, reverse: f32) {
        self.leaving = leaving;
        let count = self.nodes.len();
        if count >= 2 {
            self.nodes[count - 2].counter = reverse * self.back;
        }
    }
}
