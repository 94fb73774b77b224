//! The light pass: paths from the lights, each vertex of which is connected to the camera (Dutré, Lafortune and
//! Willems 1993; Veach 1997, §8.3).

use std::ops::{Range, RangeInclusive};

use rayon::prelude::*;

use super::direct::{Lit, Scatterer};
use super::history::PhotonKind;
use super::ledger::Ledger;
use super::walk::{Event, MapKind, Next, WalkSettings, walk};
use crate::color::Rgb;
use crate::film::Splatter;
use crate::light::Source;
use crate::math::Vec2;
use crate::observer::{Observer, Phase, Work};
use crate::sampling::{Key, Sampler, Sequence, Stream};
use crate::world::World;

/// Paths that are traced as one piece of work. What they bring is joined in the order of the paths.
const CHUNK: u64 = 64;

/// Pieces of work between two joinings: enough for many threads, and no more than are needed to keep them at work.
const BATCH: RangeInclusive<u64> = 16..=1024;

/// Connections that a batch is meant to keep. Two batches are alive at a time, so that, where paths alike bring
/// alike, there are 2^20 connections of 24 bytes, or 50 MB of vectors that may have grown to twice what they hold. Only
/// paths with more than 2^19 / (16 · 64) = 512 connections each, in the mean, come to more, in proportion.
const CONNECTIONS: u64 = 1 << 19;

/// Which paths to trace.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightPass {
    pub seed: u64,
    pub iteration: u64,
    /// Number of the first path, within the iteration.
    pub first_path: u64,
    /// How many paths.
    pub paths: u64,
    /// Segments of a path from light to lens; `None` without end.
    pub max_depth: Option<u32>,
}

/// What light paths brought to the camera, as sums over the paths.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Splats {
    /// Σ h·W·Φ of each pixel of the window, row by row: W/(m²·sr) once divided by the number of paths.
    pub pixels: Vec<[f64; 3]>,
    /// The same summed over the pixels, for surfaces that were lit in each of these ways.
    pub direct: [f64; 3],
    /// See `direct`.
    pub caustic: [f64; 3],
    /// See `direct`.
    pub global: [f64; 3],
    /// And for what media scattered to the camera.
    pub medium: [f64; 3],
}

impl Splats {
    fn new(pixels: usize) -> Self {
        let none = [0.0; 3];
        Self { pixels: vec![none; pixels], direct: none, caustic: none, global: none, medium: none }
    }

    /// Adds connections in their order, each to all pixels whose filter covers it.
    fn add(&mut self, connections: &[Connection], splatter: &Splatter) {
        for connection in connections {
            let part = match connection.part {
                Part::Medium => &mut self.medium,
                Part::Surface(PhotonKind::Direct) => &mut self.direct,
                Part::Surface(PhotonKind::Caustic) => &mut self.caustic,
                Part::Surface(_) => &mut self.global,
            };
            splatter.each(connection.film_position, |pixel, filter| {
                let light = connection.light * filter;
                for sum in [&mut self.pixels[pixel as usize], &mut *part] {
                    for (sum, value) in sum.iter_mut().zip(light.to_array()) {
                        *sum += f64::from(value);
                    }
                }
            });
        }
    }
}

/// What one vertex brings to the film. It is spread over the pixels when it is joined, for a filter covers many.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Connection {
    /// In pixels of the whole picture.
    pub film_position: Vec2,
    pub light: Rgb,
    pub part: Part,
}

/// Where the last vertex of a path lies, and how light came there.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Part {
    Surface(PhotonKind),
    Medium,
}

/// Traces light paths as photons walk, and connects them to the camera at all surfaces that are not Dirac and at all
/// collisions in media. The sums are the same to the bit on any number of threads. `None` if the observer cancelled.
pub(crate) fn light_pass(world: &World, pass: &LightPass, observer: &dyn Observer) -> Option<Splats> {
    let film = &world.scene().film;
    let (window, splatter) = (film.window(), Splatter::new(film));
    // A path that has one more segment to the camera.
    let shorter = pass.max_depth.map(|max| max.saturating_sub(1));
    if shorter == Some(0) {
        return Some(Splats::new(window.width as usize * window.height as usize));
    }
    let settings = WalkSettings { max_photon_depth: shorter, ..WalkSettings::default() };
    splat(world, pass.paths, observer, |range| (trace(world, &settings, pass, &splatter, range), ()), |()| {})
}

/// Traces paths piece by piece and adds what each connects to the camera, in the order of the paths, with whatever else
/// the pieces bring given to `keep` in the same order. `None` if the observer cancelled.
pub(crate) fn splat<T: Send>(
    world: &World,
    paths: u64,
    observer: &dyn Observer,
    trace: impl Fn(Range<u64>) -> (Vec<Connection>, T) + Sync,
    mut keep: impl FnMut(T) + Send,
) -> Option<Splats> {
    let film = &world.scene().film;
    let (window, splatter) = (film.window(), Splatter::new(film));
    let mut splats = Splats::new(window.width as usize * window.height as usize);
    let work = Work::begin(observer, Phase::Photons, paths);
    let trace = |chunk: u64| {
        if work.cancelled() {
            return None;
        }
        let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(paths);
        work.advance(range.end - range.start);
        Some(trace(range))
    };
    let mut join = |done: Vec<Option<(Vec<Connection>, T)>>| {
        for (connections, more) in done.into_iter().flatten() {
            splats.add(&connections, &splatter);
            keep(more);
        }
    };
    let chunks = paths.div_ceil(CHUNK);
    let (mut first, mut size, mut before) = (0, *BATCH.start(), Vec::new());
    while first < chunks {
        let end = (first + size).min(chunks);
        let done = std::mem::take(&mut before);
        // A batch is joined while the next is traced.
        let batch = || (first..end).into_par_iter().map(trace).collect();
        (before, ()) = rayon::join(batch, || join(done));
        if work.cancelled() {
            return None;
        }
        let connections = before.iter().flatten().map(|(connections, _)| connections.len() as u64).sum();
        size = next_batch(end - first, connections);
        first = end;
    }
    join(before);
    Some(splats)
}

/// How many chunks to trace before the next joining, after a batch of so many that brought so many connections. At most
/// four times as many, for a few dark paths tell little.
fn next_batch(chunks: u64, connections: u64) -> u64 {
    let fitting = CONNECTIONS * chunks / connections.max(1);
    fitting.min(4 * chunks).clamp(*BATCH.start(), *BATCH.end())
}

/// Traces a range of paths of the pass.
fn trace(
    world: &World,
    settings: &WalkSettings,
    pass: &LightPass,
    splatter: &Splatter,
    paths: Range<u64>,
) -> Vec<Connection> {
    let key = Key::new(pass.seed, pass.iteration, Stream::LightPaths);
    let mut books = Ledger::new(world.light_count()).lights;
    let mut found = Vec::new();
    for path in paths.map(|path| pass.first_path + path) {
        let mut sampler = Sampler::new(Sequence::Independent, key, path);
        let mut connections = Sampler::new(Sequence::Independent, key.with(1), path);
        walk(world, settings, MapKind::Global, path, &mut sampler, &mut books, |event, kind| {
            let (vertex, power, part) = match event {
                Event::Surface(photon, vertex) => (vertex, photon.power, Part::Surface(kind)),
                Event::Collision(photon, vertex) => (vertex, photon.power, Part::Medium),
                Event::Start(_) | Event::Way(_) | Event::Bounce(..) => return Next::Continue,
            };
            if let Some((film_position, light)) = connect(world, vertex, power, splatter, &mut connections) {
                found.push(Connection { film_position, light, part });
            }
            Next::Continue
        });
    }
    found
}

/// Where on the film the light of a vertex arrives, and how much: W · Φ · f cos · T.
fn connect(
    world: &World,
    vertex: &Lit<'_>,
    power: Rgb,
    splatter: &Splatter,
    sampler: &mut Sampler,
) -> Option<(Vec2, Rgb)> {
    let from = vertex.vantage();
    let seen = world.camera().connect(from.position(), sampler.next_2d())?;
    if !splatter.covers(seen.film_position) {
        return None;
    }
    let landed = match vertex.scatterer {
        // Of a photon that lands on a mask its power tells for those that passed, too, which are not seen there.
        Scatterer::Surface { hit, .. } => power * world.opacity(hit),
        Scatterer::Medium { .. } => power,
    };
    let sent = landed * vertex.spread(seen.direction) * seen.pixels_per_area;
    if sent.is_black() {
        return None;
    }
    let inside = vertex.beyond(world, seen.direction);
    let through = world.light_through(from, inside, seen.direction, &Source::Point(seen.lens), sampler);
    (!through.is_black()).then(|| (seen.film_position, sent * through))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Projection};
    use crate::film::{FilmSettings, Filter};
    use crate::light::{Light, LightKind};
    use crate::material::Material;
    use crate::math::{DVec3, Transform, Vec3};
    use crate::medium::{Medium, Phase as PhaseFunction};
    use crate::observer::Silent;
    use crate::scene::Scene;
    use crate::shape::{Geometry, Shape};

    /// A lamp in a white ball of fog of this optical radius, all of which the camera sees.
    fn ball(optical_radius: f32, filter: Filter) -> World {
        let camera = Camera {
            to_world: Transform::translate(DVec3::new(0.0, 0.0, -3.0)),
            projection: Projection::Orthographic,
            medium: None,
        };
        let mut scene = Scene::new(camera, FilmSettings { width: 16, height: 16, crop: None, filter });
        let null = scene.materials.push(Material::Null);
        let sigma_t = Rgb::splat(2.0 * optical_radius);
        let fog = Medium::homogeneous("fog", sigma_t, Rgb::WHITE, PhaseFunction::Isotropic);
        let mut ball = Shape::new("", Geometry::Sphere { center: Vec3::ZERO, radius: 0.5 }, null);
        ball.boundary.interior = Some(scene.media.list.push(fog));
        scene.shapes.push(ball);
        let kind = LightKind::Point { position: Vec3::ZERO, intensity: Rgb::WHITE };
        scene.lights.push(Light { name: String::new(), kind, medium: None });
        World::new(scene).expect("a sound scene")
    }

    const WIDE: Filter = Filter::Gaussian { std_dev: 0.5 };

    fn pass(paths: u64) -> LightPass {
        LightPass { seed: 5, iteration: 0, first_path: 7, paths, max_depth: None }
    }

    fn connections(world: &World, paths: u64) -> Vec<Connection> {
        let splatter = Splatter::new(&world.scene().film);
        trace(world, &WalkSettings::default(), &pass(paths), &splatter, 0..paths)
    }

    /// Memory goes with the connections, however many pixels each of them is spread over.
    #[test]
    fn a_wide_filter_keeps_no_more() {
        let [narrow, wide] = [Filter::Box, WIDE].map(|filter| connections(&ball(20.0, filter), 8).len());
        assert!(narrow > 8 * 20, "{narrow}");
        assert_eq!(narrow, wide);
        assert_eq!(size_of::<Connection>(), 24);
    }

    #[test]
    fn the_sums_are_those_of_all_paths_in_order_on_any_number_of_threads() {
        let world = ball(1.0, WIDE);
        let splatter = Splatter::new(&world.scene().film);
        // Three batches, the last of them short.
        let paths = 6 * 16 * CHUNK + 3;
        let mut expected = Splats::new(256);
        expected.add(&connections(&world, paths), &splatter);
        assert!(expected.medium[1] > 0.0);
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let splats = pool.install(|| light_pass(&world, &pass(paths), &Silent));
            assert!(splats.as_ref() == Some(&expected), "{threads} threads");
        }
    }

    #[test]
    fn batches_keep_no_more_connections_than_they_may() {
        for per_chunk in [0, 1, 700, 20_000, 32_768, 10_000_000] {
            let mut size = *BATCH.start();
            for _ in 0..6 {
                let next = next_batch(size, size * per_chunk);
                assert!(next <= 4 * size && BATCH.contains(&next), "{per_chunk}");
                assert!(next * per_chunk <= CONNECTIONS || next == *BATCH.start(), "{per_chunk}");
                size = next;
            }
            assert!(per_chunk > 512 || size == *BATCH.end(), "{per_chunk}");
        }
    }
}
