//! A trial of path tracing: how much its samples vary, and what they cost.

use rayon::prelude::*;

use crate::color::Rgb;
use crate::film::FilterSampler;
use crate::integrator::vcm::Grid;
use crate::integrator::{Effort, Estimator, LightPart, Met, PathConfig, PathTracer, Probe};
use crate::photon_map::NearestList;
use crate::sampling::{Key, Stream};
use crate::transport::{PixelSample, pixel_key};
use crate::world::World;

/// Samples of each pixel.
const SAMPLES: u64 = 8;

/// Counts rays.
#[derive(Default)]
struct Rays(f64);

impl Probe for Rays {
    fn surface(&mut self, _: &Met<'_>) {
        self.0 += 1.0;
    }

    fn light(&mut self, part: LightPart, _: Rgb) {
        self.0 += f64::from(u8::from(part != LightPart::Emitted));
    }
}

/// Tries a pixel of each cell of the picture.
pub(super) fn trial(world: &World, config: &PathConfig, seed: u64) -> Effort {
    let seed = Key::new(seed, 0, Stream::Pilot).with(3).hash();
    let grid = Grid::new(world.scene().film.window());
    let filter = FilterSampler::new(world.scene().film.filter);
    let tracer = PathTracer { world, config };
    let estimate = |scratch: &mut NearestList, cell: u32| {
        let place = grid.pixel(cell);
        let key = pixel_key(seed, 0, place);
        let (mut sum, mut squares, mut rays) = (0.0, 0.0, Rays::default());
        for index in 0..SAMPLES {
            let (mut sample, weight) = PixelSample::new(world, &filter, key, place, index);
            let light = tracer.radiance(&mut sample, scratch, &mut rays);
            let luminance = f64::from(weight * light.total().luminance());
            sum += luminance;
            squares += luminance * luminance;
        }
        let count = SAMPLES as f64;
        let variance = (squares - sum * sum / count).max(0.0) / (count - 1.0);
        (sum / count, variance, 1.0 + rays.0 / count)
    };
    let cells: Vec<(f64, f64, f64)> =
        (0..grid.count() as u32).into_par_iter().map_init(NearestList::new, estimate).collect();
    let count = cells.len() as f64;
    let mean = cells.iter().map(|(light, ..)| light).sum::<f64>() / count;
    let relative = |(light, variance, _): &(f64, f64, f64)| variance / (light + 0.1 * mean).powi(2);
    let variance = if mean > 0.0 { cells.iter().map(relative).sum::<f64>() / count } else { f64::INFINITY };
    Effort { variance, rays: cells.iter().map(|(.., rays)| rays).sum::<f64>() / count }
}
