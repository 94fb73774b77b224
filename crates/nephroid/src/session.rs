//! A render in progress: an iteration at a time, in short steps that can be stopped between.

use crate::film::{Aov, AovFilm, AovSum, Film, PixelSum};
use crate::integrator::{
    AovProbe, Brought, Estimator, LightTracer, Maps, Method, PathTracer, PhotonMapper, PhotonMapperConfig,
    PictureSums,
};
use crate::observer::{Observer, Phase, Work};
use crate::photon_map::NearestList;
use crate::transport::{CameraPass, Exposure, Ledger, PhotonPlan, camera_pass};
use crate::world::World;

/// Camera samples a pixel gets in one step: a multiple of the strides at which photon maps are read.
pub(crate) const STEP_SAMPLES: u32 = 4;

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
    /// The same for the map of light in media, which holds photons or beams.
    pub volume: MapStatistics,
    /// The same for that of caustics in media.
    pub volume_caustic: MapStatistics,
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
    aovs: Option<AovFilm>,
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
            Method::Path(_) | Method::LightTracer(_) => PhotonPlan::default(),
        };
        Self {
            world,
            settings,
            film: Film::new(window.width, window.height),
            aovs: None,
            plan,
            maps: None,
            ledger: Ledger::default(),
            iteration: 0,
            samples: 0,
            statistics: Statistics { plan, ..Statistics::default() },
        }
    }

    /// Keeps further values of each pixel; none for an empty list. The picture stays the same to the bit.
    #[must_use]
    pub fn with_aovs(mut self, aovs: &[Aov]) -> Self {
        let (width, height) = (self.film.width(), self.film.height());
        self.aovs = (!aovs.is_empty()).then(|| AovFilm::new(width, height, aovs));
        self
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
                let tracer = PathTracer { world: self.world, config: &config };
                let exposure = expose(self.world, &tracer, &pass, self.aovs.is_some(), observer);
                self.take(exposure)
            }
            Method::LightTracer(config) => {
                let tracer = LightTracer::new(self.world, &config);
                let Some(light) = tracer.paths(&pass, observer) else { return false };
                let mut exposed = expose(self.world, &tracer, &pass, self.aovs.is_some(), observer);
                exposed.add(&light);
                self.take(exposed)
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

    /// Further values of the picture so far, if [asked for](Self::with_aovs).
    pub fn aovs(&self) -> Option<&AovFilm> {
        self.aovs.as_ref()
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
        let exposure = expose(world, &mapper, pass, self.aovs.is_some(), observer);
        self.take(exposure)
    }

    /// Adds a pass to the film, whole or as far as it got.
    fn take(&mut self, exposed: Exposed) -> bool {
        let (total, complete) = match exposed {
            Exposed::Picture(exposure) => {
                self.film.add_iteration(&exposure.sums);
                (exposure.total, exposure.complete)
            }
            Exposed::WithAovs(exposure) => {
                let picture: Vec<PixelSum> = exposure.sums.iter().map(|(sum, _)| *sum).collect();
                self.film.add_iteration(&picture);
                if let Some(film) = &mut self.aovs {
                    film.add_iteration(exposure.sums.iter().map(|(_, aovs)| aovs));
                }
                (exposure.total, exposure.complete)
            }
        };
        self.statistics.picture.append(&total);
        complete
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
        let Statistics { volume, volume_caustic, .. } = &mut self.statistics;
        for (numbers, map) in [volume, volume_caustic].into_iter().zip(&maps.volumes) {
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

/// What a camera pass brings, with further values or without.
enum Exposed {
    Picture(Exposure<PixelSum, PictureSums>),
    WithAovs(Exposure<(PixelSum, AovSum), PictureSums>),
}

impl Exposed {
    /// Adds what light paths brought.
    fn add(&mut self, light: &Brought) {
        match self {
            Self::Picture(exposure) => light.add_to(exposure.sums.iter_mut(), &mut exposure.total),
            Self::WithAovs(exposure) => {
                light.add_to(exposure.sums.iter_mut().map(|(sum, _)| sum), &mut exposure.total);
            }
        }
    }
}

fn expose(
    world: &World,
    estimator: &impl Estimator,
    pass: &CameraPass,
    with_aovs: bool,
    observer: &dyn Observer,
) -> Exposed {
    let join = PictureSums::append;
    if with_aovs {
        return Exposed::WithAovs(camera_pass(
            world,
            pass,
            observer,
            NearestList::new,
            join,
            |mut sample, weight, neighbors, (picture, aovs): &mut (PixelSum, AovSum), total| {
                let mut probe = AovProbe::new(&sample);
                let light = estimator.radiance(&mut sample, neighbors, &mut probe);
                total.add(&light);
                picture.add(light.total(), weight);
                aovs.add(&probe.finish(&light), weight);
            },
        ));
    }
    Exposed::Picture(camera_pass(
        world,
        pass,
        observer,
        NearestList::new,
        join,
        |mut sample, weight, neighbors, picture: &mut PixelSum, total| {
            let light = estimator.radiance(&mut sample, neighbors, &mut ());
            total.add(&light);
            picture.add(light.total(), weight);
        },
    ))
}
