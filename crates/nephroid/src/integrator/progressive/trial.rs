//! Trial iterations: how much the estimates of a picture vary, for what reason, and what they cost.

use rayon::prelude::*;

use super::PpmConfig;
use crate::color::Rgb;
use crate::film::FilterSampler;
use crate::integrator::glances::COST_OF_GLANCE;
use crate::integrator::photon_mapper::{CameraPlan, Guides, Maps, PhotonMapper, Turn};
use crate::integrator::{Components, Estimator, LightPart, LookUp, Met, Passed, Probe};
use crate::observer::Observer;
use crate::photon_map::{Blur, Gathered, NearestList};
use crate::transport::{PhotonPlan, PixelSample, pixel_key};
use crate::world::World;

/// Sets of photon maps, each of photons of its own.
pub(super) const SETS: usize = 3;

/// Pixels that are tried, spread over the picture.
const PIXELS: u32 = 512;

/// Samples of each of them with each set of maps.
pub(super) const SAMPLES: usize = 4;

/// What a looked-up photon costs in rays.
const PHOTON_COST: f64 = 0.08;

/// The parts of a pixel's light, which vary for reasons of their own: what every camera sample brings, what gather
/// rays do, what is read from the caustic map, and what media add.
pub(super) const PARTS: usize = 4;

/// The luminances of one pixel: for each set and sample its parts.
pub(super) type PixelTrial = [[[f64; PARTS]; SAMPLES]; SETS];

/// What was found.
pub(super) struct Trial {
    pub pixels: Vec<PixelTrial>,
    /// Mean costs of a camera sample, in rays: what each does, what one that reads maps does besides, and for each
    /// gather ray.
    pub costs: [f64; 3],
}

/// Tries the pixels with maps of `plan`'s photons and one gather ray for each sample, or none.
pub(super) fn trial(
    world: &World,
    config: &PpmConfig,
    plan: &PhotonPlan,
    camera: &CameraPlan,
    seed: u64,
    observer: &dyn Observer,
) -> Trial {
    let window = world.scene().film.window();
    let filter = FilterSampler::new(world.scene().film.filter);
    let area = u64::from(window.width) * u64::from(window.height);
    let count = u64::from(PIXELS).min(area);
    // Rows of golden sections: as even for any size of the picture.
    let place = |i: u64| {
        let spread = (i as f64 * 0.618_033_988_749_894_9).fract();
        let number = ((i as f64 + spread) / count as f64 * area as f64) as u64;
        let number = number.min(area - 1);
        (
            (number % u64::from(window.width)) as u32 + window.x,
            (number / u64::from(window.width)) as u32 + window.y,
        )
    };
    let mut trial = Trial { pixels: vec![PixelTrial::default(); count as usize], costs: [0.0; 3] };
    let mut counted = Counts::default();
    for set in 0..SETS {
        let turn =
            Turn { seed, iteration: set as u64, gathers: camera.gather_rays.is_some(), blur: Blur::WHOLE };
        let Some(maps) = Maps::build(world, &config.mapper, plan, &turn, observer) else { return trial };
        let guides = if turn.gathers { Guides::new(&maps.global) } else { Guides::none() };
        let mapper = PhotonMapper::new(world, &config.mapper, &maps, &guides, camera);
        let estimate = |scratch: &mut NearestList, i: u64| {
            let mut counts = Counts::default();
            let key = pixel_key(seed, set as u64, place(i));
            let samples = [0, 1, 2, 3].map(|index| {
                let (mut sample, weight) = PixelSample::new(world, &filter, key, place(i), index);
                parts(&mapper.radiance(&mut sample, scratch, &mut counts), weight)
            });
            (samples, counts)
        };
        let found: Vec<_> = (0..count).into_par_iter().map_init(NearestList::new, estimate).collect();
        for (pixel, (samples, counts)) in trial.pixels.iter_mut().zip(found) {
            pixel[set] = samples;
            counted.append(&counts);
        }
    }
    let samples = (count as usize * SETS * SAMPLES).max(1) as f64;
    let rays = counted.gather_rays.max(1) as f64;
    trial.costs = [1.0 + counted.plain / samples, counted.reading / samples, counted.gathering / rays];
    trial
}

/// Luminances by part.
fn parts(light: &Components, weight: f32) -> [f64; PARTS] {
    let luminance = |light: Rgb| f64::from(weight * light.luminance());
    [light.emitted + light.direct, light.global, light.caustic, light.medium].map(luminance)
}

/// Counts what an estimate does, in rays.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    plain: f64,
    reading: f64,
    gathering: f64,
    gather_rays: u64,
    in_gather_ray: bool,
}

impl Counts {
    fn append(&mut self, more: &Self) {
        self.plain += more.plain;
        self.reading += more.reading;
        self.gathering += more.gathering;
        self.gather_rays += more.gather_rays;
    }

    fn ray(&mut self) {
        *(if self.in_gather_ray { &mut self.gathering } else { &mut self.plain }) += 1.0;
    }
}

impl Probe for Counts {
    fn begin(&mut self, gather_ray: Option<u64>, _: Rgb) {
        self.in_gather_ray = gather_ray.is_some();
        self.gather_rays += u64::from(self.in_gather_ray);
    }

    fn surface(&mut self, _: &Met<'_>) {
        self.ray();
    }

    fn glance(&mut self) {
        self.plain += COST_OF_GLANCE;
    }

    fn medium(&mut self, passed: &Passed) {
        let photons = passed.light.volume.count + passed.light.volume_caustic.count;
        // One ray to a light.
        self.ray();
        *(if self.in_gather_ray { &mut self.gathering } else { &mut self.reading }) +=
            PHOTON_COST * f64::from(photons);
    }

    fn light(&mut self, part: LightPart, _: Rgb) {
        if part != LightPart::Emitted {
            self.ray();
        }
    }

    fn look_up(&mut self, _: &LookUp, gathered: Gathered) {
        let cost = PHOTON_COST * f64::from(gathered.count);
        *(if self.in_gather_ray { &mut self.gathering } else { &mut self.reading }) += cost;
    }
}
