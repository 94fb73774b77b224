//! A render in progress: an iteration at a time, in short steps that can be stopped between.

use crate::film::Film;
use crate::integrator::{
    Maps, Method, PhotonMapper, PhotonMapperConfig, PictureSums, Scratch, path_radiance,
};
use crate::observer::{Observer, Phase, Work};
use crate::transport::{CameraPass, Exposure, Ledger, PhotonPlan, camera_pass};
use crate::world::World;

/// Camera samples a pixel gets in one step: a multiple of the strides at which photon maps are read.
const STEP_SAMPLES: u32 = 4;

/// How to render.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// The integrator.
    pub method: Method,
    /// Camera samples of each pixel in each iteration.
    pub samples_per_pixel: u32,
    /// Everything random follows from it.
    pub seed: u64,
}

/// What a render did so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Paths emitted and photons stored for the global map, over all iterations.
    pub global: MapStatistics,
    /// The same for the caustic map.
    pub caustic: MapStatistics,
    /// The paths planned for each iteration; all zero where there are no photons.
    pub plan: PhotonPlan,
    /// Where the power of each light went, in W, mean over the iterations; no lights where no photon
    /// was traced.
    pub ledger: Ledger,
    /// The picture's light by kind.
    pub picture: PictureSums,
    /// Iterations begun.
    pub iterations: u64,
    /// Camera samples taken of each pixel.
    pub samples_per_pixel: u64,
}

/// One map's numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MapStatistics {
    /// Paths emitted.
    pub paths: u64,
    /// Photons stored.
    pub photons: u64,
    /// Bytes of the current map.
    pub bytes: u64,
}

/// A render in progress. Dropping it cancels.
pub struct Session<'w> {
    world: &'w World,
    settings: RenderSettings,
    film: Film,
    plan: PhotonPlan,
    maps: Option<Maps>,
    ledger: Ledger,
    iteration: u64,
    /// Samples taken of each pixel in the current iteration.
    samples: u32,
    statistics: Statistics,
}

impl<'w> Session<'w> {
    /// Prepares a render; photon methods trace their pilot paths.
    pub fn new(world: &'w World, settings: RenderSettings, observer: &dyn Observer) -> Self {
        let window = world.scene().film.window();
        let plan = match &settings.method {
            Method::PhotonMapper(config) => {
                let _work = Work::begin(observer, Phase::Pilot, 1);
                PhotonPlan::by_pilot(world, &config.walk_settings(), &config.targets(), settings.seed)
            }
            Method::Path(_) => PhotonPlan::default(),
        };
        Self {
            world,
            settings,
            film: Film::new(window.width, window.height),
            plan,
            maps: None,
            ledger: Ledger::default(),
            iteration: 0,
            samples: 0,
            statistics: Statistics { plan, ..Statistics::default() },
        }
    }

    /// Renders on: the photons of an iteration if one begins, and a few samples of every pixel.
    /// Returns false if the observer cancelled; the film then has what was finished, tile by
    /// tile, and the session is at its end.
    pub fn step(&mut self, observer: &dyn Observer) -> bool {
        let whole = self.settings.samples_per_pixel.max(1);
        if self.samples >= whole {
            (self.iteration, self.samples, self.maps) = (self.iteration + 1, 0, None);
        }
        let pass = CameraPass {
            seed: self.settings.seed,
            iteration: self.iteration,
            first_sample: self.samples,
            samples: STEP_SAMPLES.min(whole - self.samples),
        };
        let done = match self.settings.method.clone() {
            Method::PhotonMapper(config) => self.photon_step(&config, &pass, observer),
            Method::Path(config) => {
                let world = self.world;
                let result = camera_pass(
                    world,
                    &pass,
                    observer,
                    || (),
                    PictureSums::append,
                    |sample, (), sums| {
                        let light = path_radiance(world, &config, sample);
                        sums.add(&light);
                        light.emitted + light.direct + light.global + light.caustic
                    },
                );
                self.take(result)
            }
        };
        if done {
            self.samples += pass.samples;
            self.statistics.samples_per_pixel += u64::from(pass.samples);
            self.statistics.iterations = self.iteration + 1;
        }
        done
    }

    /// Whether the current iteration has all its samples.
    pub fn iteration_is_complete(&self) -> bool {
        self.samples >= self.settings.samples_per_pixel.max(1)
    }

    /// The film so far.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// What was done so far.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// How it renders.
    pub fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    fn photon_step(
        &mut self,
        config: &PhotonMapperConfig,
        pass: &CameraPass,
        observer: &dyn Observer,
    ) -> bool {
        let world = self.world;
        if self.maps.is_none() {
            let RenderSettings { seed, samples_per_pixel, .. } = self.settings;
            let gathers = config.gather_rays(samples_per_pixel).is_some();
            let built = Maps::build(world, config, &self.plan, gathers, seed, self.iteration, observer);
            let Some(maps) = built else { return false };
            self.count(&maps);
            self.maps = Some(maps);
        }
        let Some(maps) = &self.maps else { return false };
        let mapper = PhotonMapper::new(world, config, maps, self.settings.samples_per_pixel);
        let result = camera_pass(
            world,
            pass,
            observer,
            Scratch::default,
            PictureSums::append,
            |mut sample, scratch, sums| {
                let light = mapper.radiance(&mut sample, scratch);
                sums.add(&light);
                light.emitted + light.direct + light.global + light.caustic
            },
        );
        self.take(result)
    }

    /// Adds a pass to the film, whole or as far as it got.
    fn take(&mut self, exposure: Exposure<PictureSums>) -> bool {
        self.film.add_iteration(&exposure.sums);
        self.statistics.picture.append(&exposure.total);
        exposure.complete
    }

    /// Takes new maps into the statistics.
    fn count(&mut self, maps: &Maps) {
        for (numbers, map) in
            [(&mut self.statistics.global, &maps.global), (&mut self.statistics.caustic, &maps.caustic)]
        {
            numbers.paths += map.emitted();
            numbers.photons += map.len() as u64;
            numbers.bytes = map.memory_bytes() as u64;
        }
        if self.ledger.lights.is_empty() {
            self.ledger = Ledger::new(maps.ledger.lights.len());
        }
        self.ledger.append(&maps.ledger);
        self.statistics.ledger = self.ledger.per_path();
    }
}
