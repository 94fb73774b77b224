//! A trial of a few pixels: how much vertex connection and merging varies, how much path tracing would, and what they cost.

use rayon::prelude::*;

use super::grid::Grid;
use super::light_paths::Splat;
use super::{Density, Iteration, IterationKey, VcmConfig};
use crate::color::Rgb;
use crate::film::FilterSampler;
use crate::integrator::glances::COST_OF_GLANCE;
use crate::integrator::photon_mapper::CameraPlan;
use crate::integrator::{Effort, Estimator, Found, Met, Passed, Probe, Quiet};
use crate::observer::Observer;
use crate::photon_map::NearestList;
use crate::sampling::{Key, Stream};
use crate::transport::{MapPlan, PhotonPlan, PixelSample, pixel_key};
use crate::world::World;

/// Sets of light paths, and samples of each pixel with each of them.
const SETS: u64 = 2;
const SAMPLES: u64 = 4;

/// The share of light that paths may be unable to find: what rounding makes of paths at grazing incidence, and no more.
const UNFOUND: f64 = 1e-4;

/// Estimates are as narrow as after this many camera samples of all pixels: those of small pictures have come further by
/// the time that someone looks.
const NARROW_AFTER: u64 = 1 << 21;

/// What a ray and what is done at its end cost, in rays of a path tracer.
const RAY: f64 = 1.9;

/// What things cost in rays: a look-up of photons, each photon that is found, a connection to a light path, and all that
/// is done at a vertex of a light path.
const LOOK_UP: f64 = 1.0;
const PHOTON: f64 = 0.15;
const CONNECTION: f64 = 1.5;
const LIGHT_VERTEX: f64 = 4.0;

/// What was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tried {
    /// Of an iteration without connections, and with them.
    pub merging: [Effort; 2],
    /// Of one sample of a path tracer. Its variance is judged by light that other techniques found, too: it is infinite
    /// where there is some that paths cannot find, and true where they hardly ever do.
    pub paths: Effort,
}

/// What a cell of the picture brought.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    /// Sum and sum of squares of the luminances of camera samples.
    sum: f64,
    squares: f64,
    /// Of the squares that path tracing would have.
    of_paths: f64,
    /// Sum of the luminances that path tracing could not find.
    unfound: f64,
    /// Of what light paths bring: their mean over the pixels, squares, and squares that path tracing would have.
    splats: [f64; 3],
    rays: f64,
    path_rays: f64,
}

/// Counts what a camera sample does.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    of_paths: f64,
    unfound: f64,
    surfaces: f64,
    rough: f64,
    connections: f64,
    photons: f64,
    besides: f64,
}

impl Probe for Tally {
    fn surface(&mut self, met: &Met<'_>) {
        self.surfaces += 1.0;
        self.rough += f64::from(u8::from(!met.bsdf.is_dirac()));
    }

    fn glance(&mut self) {
        self.besides += COST_OF_GLANCE;
    }

    fn medium(&mut self, passed: &Passed) {
        let photons = passed.light.volume.count + passed.light.volume_caustic.count;
        self.besides += LOOK_UP + PHOTON * f64::from(photons);
    }

    fn technique(&mut self, found: Found, radiance: Rgb, over_paths: f32) {
        let luminance = f64::from(radiance.luminance());
        if over_paths.is_finite() {
            self.of_paths += luminance * luminance * f64::from(over_paths);
        } else {
            self.unfound += luminance;
        }
        match found {
            Found::Connected => self.connections += 1.0,
            Found::Merged => self.photons += 1.0,
            Found::Met | Found::Asked => {}
        }
    }
}

/// Tries a world with a plan. `None` if there is nothing to see, or the observer cancelled.
pub(crate) fn trial(
    world: &World,
    config: &VcmConfig,
    (photons, camera): (&PhotonPlan, &CameraPlan),
    density: &Density,
    seed: u64,
    observer: &dyn Observer,
) -> Option<Tried> {
    let seed = Key::new(seed, 0, Stream::Pilot).with(2).hash();
    let window = world.scene().film.window();
    let pixels = u64::from(window.width) * u64::from(window.height);
    let narrowing = (NARROW_AFTER / (pixels * u64::from(camera.samples_per_pixel)).max(1)).clamp(8, 128);
    let mut efforts = Vec::new();
    let mut paths = None;
    for connections in [false, true] {
        let config = VcmConfig { connections, ..config.clone() };
        let grid = Grid::new(world.scene().film.window());
        let mut cells = vec![Cell::default(); grid.count()];
        let mut light_rays = 0.0;
        for set in 0..SETS {
            let key = IterationKey { seed, iteration: set, narrowing, watched: true };
            let iteration = Iteration::new(world, &config, photons, camera, density, key, &Quiet(observer))?;
            let estimator = iteration.camera(world, &config, camera, density);
            let tried: Vec<Cell> = (0..grid.count() as u32)
                .into_par_iter()
                .map_init(NearestList::new, |scratch, i| {
                    try_pixel(world, &estimator, scratch, grid.pixel(i), (seed, set))
                })
                .collect();
            for (cell, more) in cells.iter_mut().zip(tried) {
                cell.add(&more);
            }
            let (totals, samples) = (iteration.totals(), f64::from(camera.samples_per_pixel));
            for splat in iteration.watched() {
                let share = grid.count() as f64 / grid.pixels();
                cells[grid.cell(splat.film_position)].splat(splat, totals.paths as f64, share, samples);
            }
            let in_media = [photons.volume, photons.volume_caustic];
            light_rays += in_media.iter().map(MapPlan::rays).sum::<f64>() / grid.pixels();
            light_rays += LIGHT_VERTEX * (totals.photons as f64 + totals.paths as f64) / grid.pixels();
        }
        let (merging, of_paths) =
            judge(&cells, f64::from(camera.samples_per_pixel), light_rays / SETS as f64)?;
        efforts.push(merging);
        paths.get_or_insert(of_paths);
    }
    let (&[without, with], paths) = (&efforts[..], paths?) else { return None };
    Some(Tried { merging: [without, with], paths })
}

impl Cell {
    fn add(&mut self, more: &Self) {
        self.sum += more.sum;
        self.squares += more.squares;
        self.of_paths += more.of_paths;
        self.unfound += more.unfound;
        self.rays += more.rays;
        self.path_rays += more.path_rays;
    }

    /// Adds what a vertex of one of `paths` light paths brings to the pixels of the cell, each of which is this share of it,
    /// for `samples` camera samples of each pixel.
    fn splat(&mut self, splat: &Splat, paths: f64, share: f64, samples: f64) {
        let luminance = f64::from(splat.luminance) / paths;
        let square = luminance * luminance * share;
        self.splats[0] += luminance * share;
        self.splats[1] += square;
        if splat.over_paths.is_finite() {
            self.splats[2] += square * samples * f64::from(splat.over_paths);
        } else {
            // As often as camera samples are taken of a pixel.
            self.unfound += luminance * share * SAMPLES as f64;
        }
    }
}

fn try_pixel(
    world: &World,
    estimator: &impl Estimator,
    scratch: &mut NearestList,
    place: (u32, u32),
    (seed, set): (u64, u64),
) -> Cell {
    let filter = FilterSampler::new(world.scene().film.filter);
    let key = pixel_key(seed, set, place);
    let mut cell = Cell::default();
    for index in 0..SAMPLES {
        let (mut sample, weight) = PixelSample::new(world, &filter, key, place, index);
        let mut tally = Tally::default();
        let light = estimator.radiance(&mut sample, scratch, &mut tally);
        let luminance = f64::from(weight * light.total().luminance());
        cell.sum += luminance;
        cell.squares += luminance * luminance;
        cell.of_paths += tally.of_paths;
        cell.unfound += tally.unfound;
        let path_rays = 1.0 + tally.surfaces + tally.rough;
        cell.path_rays += path_rays;
        cell.rays += path_rays
            + LOOK_UP * tally.rough
            + CONNECTION * tally.connections
            + PHOTON * tally.photons
            + tally.besides;
    }
    cell
}

/// What an iteration and a sample of a path tracer need, as means over the cells.
fn judge(cells: &[Cell], samples_per_pixel: f64, light_rays: f64) -> Option<(Effort, Effort)> {
    let tried = (SETS * SAMPLES) as f64;
    let light = |cell: &Cell| cell.sum / tried + cell.splats[0] / SETS as f64;
    let mean = cells.iter().map(light).sum::<f64>() / cells.len() as f64;
    if mean <= 0.0 {
        return None;
    }
    let unfound = cells.iter().map(|cell| cell.unfound).sum::<f64>() / (tried * cells.len() as f64);
    let (mut merging, mut paths) = (0.0, if unfound > UNFOUND * mean { f64::INFINITY } else { 0.0 });
    for cell in cells {
        let measure = (light(cell) + 0.1 * mean).powi(2);
        let of_sample = (cell.squares - cell.sum * cell.sum / tried).max(0.0) / (tried - 1.0);
        merging += (of_sample / samples_per_pixel + cell.splats[1] / SETS as f64) / measure;
        let square = cell.of_paths / tried + cell.splats[2] / SETS as f64;
        paths += (square - light(cell).powi(2)).max(0.0) / measure;
    }
    let count = cells.len() as f64;
    let per_sample = |of: fn(&Cell) -> f64| cells.iter().map(of).sum::<f64>() / (count * tried);
    let rays = per_sample(|cell| cell.rays) * samples_per_pixel + light_rays;
    Some((
        Effort { variance: merging / count, rays: RAY * rays },
        Effort { variance: paths / count, rays: per_sample(|cell| cell.path_rays) },
    ))
}
