//! The light pass: paths from the lights, each vertex of which is connected to the camera (Dutré, Lafortune and
//! Willems 1993; Veach 1997, §8.3).

use std::ops::Range;

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
const CHUNK: u64 = 512;

/// Pieces of work between two joinings: few enough that what paths in thick fog bring does not fill the memory.
const BATCH: u64 = 64;

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

    fn add(&mut self, splat: &Splat) {
        let part = match splat.part {
            Part::Medium => &mut self.medium,
            Part::Surface(PhotonKind::Direct) => &mut self.direct,
            Part::Surface(PhotonKind::Caustic) => &mut self.caustic,
            Part::Surface(_) => &mut self.global,
        };
        for sum in [&mut self.pixels[splat.pixel as usize], part] {
            for (sum, value) in sum.iter_mut().zip(splat.light.to_array()) {
                *sum += f64::from(value);
            }
        }
    }
}

/// What one vertex brings to one pixel.
#[derive(Clone, Copy, Debug)]
struct Splat {
    pixel: u32,
    light: Rgb,
    part: Part,
}

/// Where the last vertex of a path lies, and how light came there.
#[derive(Clone, Copy, Debug)]
enum Part {
    Surface(PhotonKind),
    Medium,
}

/// Traces light paths as photons walk, and connects them to the camera at all surfaces that are not Dirac and at all
/// collisions in media. The sums are the same to the bit on any number of threads. `None` if the observer cancelled.
pub(crate) fn light_pass(world: &World, pass: &LightPass, observer: &dyn Observer) -> Option<Splats> {
    let film = &world.scene().film;
    let (window, splatter) = (film.window(), Splatter::new(film));
    let mut splats = Splats::new(window.width as usize * window.height as usize);
    // A path that has one more segment to the camera.
    let shorter = pass.max_depth.map(|max| max.saturating_sub(1));
    if shorter == Some(0) {
        return Some(splats);
    }
    let settings = WalkSettings { max_photon_depth: shorter, ..WalkSettings::default() };
    let work = Work::begin(observer, Phase::Photons, pass.paths);
    let trace = |chunk: u64| {
        if work.cancelled() {
            return Vec::new();
        }
        let range = chunk * CHUNK..((chunk + 1) * CHUNK).min(pass.paths);
        work.advance(range.end - range.start);
        trace(world, &settings, pass, &splatter, range)
    };
    let chunks = pass.paths.div_ceil(CHUNK);
    let mut before = Vec::new();
    for first in (0..chunks).step_by(BATCH as usize) {
        let batch = || (first..(first + BATCH).min(chunks)).into_par_iter().map(trace).collect();
        let done: Vec<Vec<Splat>> = std::mem::take(&mut before);
        // A batch is joined while the next is traced.
        (before, ()) = rayon::join(batch, || done.iter().flatten().for_each(|splat| splats.add(splat)));
        if work.cancelled() {
            return None;
        }
    }
    before.iter().flatten().for_each(|splat| splats.add(splat));
    Some(splats)
}

/// Traces a range of paths of the pass.
fn trace(
    world: &World,
    settings: &WalkSettings,
    pass: &LightPass,
    splatter: &Splatter,
    paths: Range<u64>,
) -> Vec<Splat> {
    let key = Key::new(pass.seed, pass.iteration, Stream::LightPaths);
    let mut books = Ledger::new(world.light_count()).lights;
    let mut splats = Vec::new();
    for path in paths.map(|path| pass.first_path + path) {
        let mut sampler = Sampler::new(Sequence::Independent, key, path);
        let mut connections = Sampler::new(Sequence::Independent, key.with(1), path);
        walk(world, settings, MapKind::Global, path, &mut sampler, &mut books, |event, kind| {
            let (vertex, power, part) = match event {
                Event::Surface(photon, vertex) => (vertex, photon.power, Part::Surface(kind)),
                Event::Collision(photon, vertex) => (vertex, photon.power, Part::Medium),
                Event::Way(_) | Event::Specular => return Next::Continue,
            };
            if let Some((position, light)) = connect(world, vertex, power, splatter, &mut connections) {
                splatter.each(position, |pixel, filter| {
                    splats.push(Splat { pixel, light: light * filter, part });
                });
            }
            Next::Continue
        });
    }
    splats
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
