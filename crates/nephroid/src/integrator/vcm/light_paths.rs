//! The paths from the lights of one iteration: what they bring straight to the camera, and what of them is kept for paths
//! from there.

use std::ops::Range;

use super::densities::{Kind, Node, Place, Trail};
use super::lamp::LampEnd;
use super::light_vertex::{LightPhoton, LightVertex, place_of};
use super::reach::AtFirst;
use super::weights::{MOST_CONNECTED, Technique, Techniques, Weighed, Whole};
use crate::color::Rgb;
use crate::film::Splatter;
use crate::light::{Asker, Source};
use crate::math::{Vec2, Vec3};
use crate::observer::Observer;
use crate::photon_map::{GridTree, NearestList, PhotonIndex};
use crate::sampling::{Key, Sampler, Sequence, Stream};
use crate::shape::SurfacePoint;
use crate::transport::{
    Balance, Bounce, Connection, Event, Ledger, Lit, MapKind, Next, Part, PhotonKind, Scatterer, Splats,
    Start, WalkSettings, splat, walk,
};
use crate::world::World;

/// Light paths that are kept for connections: each path from the camera is connected to one of them.
const KEPT: u64 = 1 << 15;

/// Which paths to trace.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightPass {
    pub seed: u64,
    pub iteration: u64,
    pub paths: u64,
    /// Segments of a whole path.
    pub max_depth: Option<u32>,
    /// Whether what they bring to the camera is taken down one by one.
    pub watched: bool,
}

/// What one vertex brings to the camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Splat {
    /// In pixels of the whole picture.
    pub film_position: Vec2,
    /// Of its light, to be divided by the number of paths.
    pub luminance: f32,
    /// See [`Weighed::over_paths`].
    pub over_paths: f32,
}

/// The light paths of one iteration.
pub(super) struct LightPaths {
    pub emitted: u64,
    pub splats: Splats,
    pub watched: Vec<Splat>,
    pub ledger: Ledger,
    index: GridTree,
    photons: Vec<LightPhoton>,
    vertices: Vec<LightVertex>,
    /// Where the vertices of each path that is kept begin, and where the last ends.
    starts: Vec<u32>,
    nodes: Vec<Node>,
}

/// What one piece of work keeps.
struct Piece {
    photons: Vec<(Vec3, LightPhoton)>,
    vertices: Vec<LightVertex>,
    counts: Vec<u32>,
    nodes: Vec<Node>,
    books: Vec<Balance>,
    watched: Vec<Splat>,
}

impl LightPaths {
    /// Traces them. `None` if the observer cancelled.
    pub fn trace(
        world: &World,
        pass: &LightPass,
        techniques: &Techniques,
        at_first: AtFirst<'_>,
        observer: &dyn Observer,
    ) -> Option<Self> {
        let splatter = Splatter::new(&world.scene().film);
        let mut watched = Vec::new();
        let mut ledger = Ledger::new(world.light_count());
        ledger.paths = pass.paths;
        let (mut photons, mut vertices, mut nodes, mut starts) =
            (Vec::new(), Vec::new(), Vec::new(), vec![0]);
        let trace = |range: Range<u64>| trace(world, pass, techniques, at_first, &splatter, range);
        let splats = splat(world, pass.paths, observer, trace, |piece: Piece| {
            let first = nodes.len() as u32;
            let moved = |[start, end]: [u32; 2]| [start + first, end + first];
            nodes.extend(piece.nodes);
            let photon =
                |(p, photon): (Vec3, LightPhoton)| (p, LightPhoton { nodes: moved(photon.nodes), ..photon });
            photons.extend(piece.photons.into_iter().map(photon));
            let vertex = |vertex: LightVertex| LightVertex { nodes: moved(vertex.nodes), ..vertex };
            let mut end = vertices.len() as u32;
            vertices.extend(piece.vertices.into_iter().map(vertex));
            starts.extend(piece.counts.into_iter().map(|count| {
                end += count;
                end
            }));
            watched.extend(piece.watched);
            ledger.append(&Ledger { lights: piece.books, paths: 0 });
        })?;
        let (index, photons) = GridTree::build_with(photons.len(), |i| photons[i]);
        Some(Self { emitted: pass.paths, splats, watched, ledger, index, photons, vertices, starts, nodes })
    }

    /// How many photons are there to be merged with.
    pub fn photon_count(&self) -> usize {
        self.photons.len()
    }

    /// Bytes of heap memory, of pictures aside.
    pub fn memory_bytes(&self) -> usize {
        self.index.memory_bytes()
            + size_of_val(self.photons.as_slice())
            + size_of_val(self.vertices.as_slice())
            + size_of_val(self.nodes.as_slice())
    }

    /// Where the photons are.
    pub fn places(&self) -> Vec<Vec3> {
        (0..self.photons.len() as u32).map(|place| self.index.position(place)).collect()
    }

    /// The vertices of one of the paths that are kept, as a number without bounds chooses it.
    pub fn chosen(&self, number: u64) -> &[LightVertex] {
        let paths = self.starts.len() as u64 - 1;
        if paths == 0 {
            return &[];
        }
        let path = (number % paths) as usize;
        &self.vertices[self.starts[path] as usize..self.starts[path + 1] as usize]
    }

    pub fn nodes_of(&self, vertex: &LightVertex) -> &[Node] {
        &self.nodes[vertex.nodes[0] as usize..vertex.nodes[1] as usize]
    }

    pub fn nodes_at(&self, photon: &LightPhoton) -> &[Node] {
        &self.nodes[photon.nodes[0] as usize..photon.nodes[1] as usize]
    }

    /// Tells of the photons within a radius of a point, where they lie and how far away.
    pub fn each_within(&self, center: Vec3, radius: f32, mut visit: impl FnMut(&LightPhoton, Vec3)) {
        self.index.for_each_within(center, radius * radius, |place, _| {
            visit(&self.photons[place as usize], self.index.position(place));
        });
    }
}

/// A path on its way.
struct Walked<'a> {
    world: &'a World,
    techniques: &'a Techniques,
    splatter: &'a Splatter,
    start: Option<(usize, Option<SurfacePoint>, Vec3)>,
    trail: Trail,
    at_first: AtFirst<'a>,
    found: NearestList,
    /// What the camera sees of it, taken down if asked for.
    watched: Option<Vec<Splat>>,
    /// Whether it is kept for connections.
    kept: bool,
    photons: Vec<(Vec3, LightPhoton)>,
    vertices: Vec<LightVertex>,
}

impl Walked<'_> {
    /// Comes to a vertex; false if the path has no use.
    fn arrive(&mut self, place: Place, position: Vec3, kind: Kind) -> bool {
        if let Some((light, surface, direction)) = self.start.take() {
            let asker = place.asker().unwrap_or(Asker::in_space(position));
            let lamp = LampEnd::of_start(self.world, light, surface.as_ref(), direction, &asker);
            let Some(lamp) = lamp else { return false };
            self.trail.begin(lamp.place, lamp.leaving);
            self.trail.nodes.push(lamp.node);
        }
        if self.trail.nodes.is_empty() {
            return false;
        }
        let far = self.trail.distance_to(&place) >= self.techniques.reach.apart();
        if let Some(last) = self.trail.nodes.last_mut() {
            last.far = far;
        }
        self.trail.arrive(place, kind);
        true
    }

    /// Light that lands where it can be scattered anywhere.
    fn land(&mut self, lit: &Lit<'_>, power: Rgb, depth: u32, kind: PhotonKind) -> bool {
        let (place, position) = self.place(lit);
        let at_surface = matches!(place, Place::Surface { .. });
        if !self.arrive(place, position, if at_surface { Kind::Surface } else { Kind::Medium }) {
            return false;
        }
        let end = self.trail.nodes.len() as u32;
        let (nodes, back) = ([0, end], self.trail.back);
        if at_surface && end > 2 && self.techniques.reach.paths > 0.0 {
            let Place::Surface { ng, .. } = place else { return false };
            let normal = if lit.wo.dot(ng) > 0.0 { ng } else { -ng };
            let caustic = kind == PhotonKind::Caustic;
            self.photons
                .push((position, LightPhoton { power, wi: lit.wo, normal, back, depth, caustic, nodes }));
        }
        if self.kept && self.trail.nodes.len() <= MOST_CONNECTED {
            let vertex = LightVertex::new(lit, place, self.landed(lit, power), depth, back);
            self.vertices.push(LightVertex { nodes, ..vertex });
        }
        true
    }

    /// Of a photon that lands on a mask its power tells for those that passed, too.
    fn landed(&self, lit: &Lit<'_>, power: Rgb) -> Rgb {
        match lit.scatterer {
            Scatterer::Surface { hit, .. } => power * self.world.opacity(hit),
            Scatterer::Medium { .. } => power,
        }
    }

    fn place(&self, lit: &Lit<'_>) -> (Place, Vec3) {
        place_of(self.world, lit)
    }

    fn bounce(&mut self, lit: &Lit<'_>, bounce: &Bounce) -> bool {
        if bounce.dirac {
            let (place, position) = self.place(lit);
            // Where light can be scattered otherwise it has landed just now.
            if !lit.has_density() && !self.arrive(place, position, Kind::Specular) {
                return false;
            }
            self.trail.turn_specular();
        } else {
            self.trail.turn(bounce.pdf_solid_angle, lit.pdf_between(bounce.wi, lit.wo));
        }
        true
    }

    /// What the camera sees of light that a surface scatters.
    fn seen_from_lens(
        &mut self,
        lit: &Lit<'_>,
        power: Rgb,
        kind: PhotonKind,
        sampler: &mut Sampler,
    ) -> Option<Connection> {
        let (world, from) = (self.world, lit.vantage());
        let seen = world.camera().connect(from.position(), sampler.next_2d())?;
        if !self.splatter.covers(seen.film_position) {
            return None;
        }
        let sent = self.landed(lit, power) * lit.spread(seen.direction) * seen.pixels_per_area;
        if sent.is_black() {
            return None;
        }
        let facing = match self.trail.at {
            Place::Surface { ng, .. } => ng.dot(seen.direction).abs(),
            _ => return None,
        };
        let back = lit.pdf_between(seen.direction, lit.wo) * self.trail.back;
        let at_first = self.at_first.radius(
            world,
            from.position(),
            seen.lens.distance(from.position()),
            &mut self.found,
        );
        let path = Whole {
            light: &self.trail.nodes,
            counters: [seen.pixels_per_area * facing, back],
            camera: &[],
            far: true,
            at_first,
        };
        let Weighed { weight, over_paths } = self.techniques.weigh(&path, Technique::Connected);
        let inside = lit.beyond(world, seen.direction);
        let through = world.light_through(from, inside, seen.direction, &Source::Point(seen.lens), sampler);
        let light = sent * through * weight;
        let part = Part::Surface(kind);
        if light.is_black() {
            return None;
        }
        if let Some(watched) = &mut self.watched {
            watched.push(Splat {
                film_position: seen.film_position,
                luminance: light.luminance(),
                over_paths,
            });
        }
        Some(Connection { film_position: seen.film_position, light, part })
    }
}

fn trace(
    world: &World,
    pass: &LightPass,
    techniques: &Techniques,
    at_first: AtFirst<'_>,
    splatter: &Splatter,
    paths: Range<u64>,
) -> (Vec<Connection>, Piece) {
    let key = Key::new(pass.seed, pass.iteration, Stream::LightPaths);
    // Segments up to a vertex that one more leads from to the camera.
    let max_photon_depth = pass.max_depth.map(|max| max.saturating_sub(1));
    let settings = WalkSettings { max_photon_depth, ..WalkSettings::default() };
    let mut books = Ledger::new(world.light_count()).lights;
    let (mut connections, mut nodes, mut counts) = (Vec::new(), Vec::new(), Vec::new());
    let mut walked = Walked {
        world,
        techniques,
        splatter,
        start: None,
        trail: Trail::new(),
        at_first,
        found: NearestList::new(),
        watched: pass.watched.then(Vec::new),
        kept: false,
        photons: Vec::new(),
        vertices: Vec::new(),
    };
    for path in paths {
        let mut sampler = Sampler::new(Sequence::Sobol, key, path);
        let mut to_lens = Sampler::new(Sequence::Independent, key.with(1), path);
        walked.kept = techniques.connects && path < KEPT;
        let (photons, vertices) = (walked.photons.len(), walked.vertices.len());
        walk(world, &settings, MapKind::Global, path, &mut sampler, &mut books, |event, kind| {
            let useful = match event {
                Event::Start(Start { light, surface, ray, .. }) => {
                    walked.start = Some((*light, *surface, ray.direction));
                    walked.trail.nodes.clear();
                    // What media give off is found by paths from the camera.
                    world.emitters()[*light].medium().is_none()
                }
                Event::Surface(photon, lit) => {
                    let useful = walked.land(lit, photon.power, u32::from(photon.depth), kind);
                    let fits = pass.max_depth.is_none_or(|max| u32::from(photon.depth) < max);
                    if useful && fits && techniques.to_lens > 0.0 {
                        connections.extend(walked.seen_from_lens(lit, photon.power, kind, &mut to_lens));
                    }
                    useful
                }
                Event::Collision(photon, lit) => {
                    walked.land(lit, photon.power, u32::from(photon.depth), kind)
                }
                Event::Bounce(lit, bounce) => walked.bounce(lit, &bounce),
                Event::Way(_) => true,
            };
            if useful { Next::Continue } else { Next::Stop }
        });
        let first = nodes.len() as u32;
        let used = &mut walked.photons[photons..];
        let kept = &mut walked.vertices[vertices..];
        if !used.is_empty() || !kept.is_empty() {
            nodes.extend_from_slice(&walked.trail.nodes);
            for range in
                used.iter_mut().map(|(_, p)| &mut p.nodes).chain(kept.iter_mut().map(|v| &mut v.nodes))
            {
                *range = [first, range[1] + first];
            }
        }
        if walked.kept {
            counts.push(kept.len() as u32);
        }
    }
    let Walked { photons, vertices, watched, .. } = walked;
    let watched = watched.unwrap_or_default();
    (connections, Piece { photons, vertices, counts, nodes, books, watched })
}
