//! A render in progress: an iteration at a time, in short steps that can be stopped between.

mod expose;
mod place;
mod plan;
mod quality;
mod statistics;

use expose::{Exposed, Keep, expose};
pub use place::Place;
pub use plan::RenderPlan;
pub use statistics::{MapStatistics, Statistics};

use crate::film::{Aov, AovFilm, Film, MergeError};
pub use crate::film::{Convergence, Quality};
use crate::integrator::{
    CameraPlan, Guides, LightTracer, Maps, Method, PathTracer, PhotonMapper, PhotonMapperConfig, Turn,
    VcmConfig, vcm,
};
use crate::observer::Observer;
use crate::transport::{CameraPass, Ledger};
use crate::world::World;

/// Camera samples a pixel gets in one step: a multiple of the strides at which photon maps are read.
const STEP_SAMPLES: u32 = 4;

/// Camera samples of each pixel in the next step of an iteration that has so many left to take. Those of a progressive
/// iteration share photons and are few, and so they are one step and one estimate.
pub(crate) fn samples_of_step(method: &Method, left: u32) -> u32 {
    if method.is_progressive() { left } else { STEP_SAMPLES.min(left) }
}

/// The samples of a step. Those of progressive iterations are numbered through all of them: they are as well spread as
/// those of one long iteration.
pub(crate) fn camera_pass_of(
    settings: &RenderSettings,
    camera: &CameraPlan,
    place: Place,
    samples: u32,
) -> CameraPass {
    let (iteration, first_sample) = if settings.method.is_progressive() {
        (0, place.samples_before(camera.samples_per_pixel))
    } else {
        (place.iteration, u64::from(place.samples))
    };
    CameraPass { seed: settings.seed, iteration, first_sample, samples }
}

/// How to render.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// The integrator.
    pub method: Method,
    /// Camera samples of each pixel in each iteration; progressive methods plan their own.
    pub samples_per_pixel: u32,
    /// Everything random follows from it.
    pub seed: u64,
}

/// A render in progress. Dropping it cancels.
pub struct Session<'w> {
    world: &'w World,
    settings: RenderSettings,
    plan: RenderPlan,
    /// What renders, which settings may leave open.
    method: Method,
    film: Film,
    convergence: Convergence,
    aovs: Option<AovFilm>,
    clamp: Option<f32>,
    /// A step that was stopped, as far as it got.
    torn: Option<Exposed>,
    maps: Option<Maps>,
    guides: Option<Guides>,
    density: Option<vcm::Density>,
    ledger: Ledger,
    place: Place,
    statistics: Statistics,
}

impl<'w> Session<'w> {
    /// Prepares a render; photon methods trace their pilot paths.
    pub fn new(world: &'w World, settings: RenderSettings, observer: &dyn Observer) -> Self {
        let plan = RenderPlan::new(world, &settings, observer);
        Self::with_plan(world, settings, plan)
    }

    /// Prepares a render that was planned before, with the same settings.
    pub fn with_plan(world: &'w World, settings: RenderSettings, plan: RenderPlan) -> Self {
        let window = world.scene().film.window();
        Self {
            world,
            method: plan.method(world, &settings.method),
            settings,
            plan,
            film: Film::with_unit(window.width, window.height, world.radiance_unit()),
            convergence: Convergence::default(),
            aovs: None,
            clamp: None,
            torn: None,
            maps: None,
            guides: None,
            density: None,
            ledger: Ledger::default(),
            place: Place::default(),
            statistics: Statistics { plan, ..Statistics::default() },
        }
    }

    /// Keeps further values of each pixel; none for an empty list. The picture stays the same to the bit.
    ///
    /// They are those of camera samples: of light tracing, the layers of light lack what light paths bring.
    #[must_use]
    pub fn with_aovs(mut self, aovs: &[Aov]) -> Self {
        let (width, height, unit) = (self.film.width(), self.film.height(), self.film.unit());
        self.aovs = (!aovs.is_empty()).then(|| AovFilm::with_unit(width, height, unit, aovs));
        self
    }

    /// Cuts camera samples down whose largest channel is more than `limit`, in W/(m²·sr): less noise, and less light than
    /// there is. What they lose is in [`PictureSums::clamped`](crate::integrator::PictureSums::clamped); what light paths
    /// bring is not cut.
    #[must_use]
    pub fn clamping(mut self, limit: Option<f32>) -> Self {
        self.clamp = limit;
        self
    }

    /// Begins at a place further on, for a render that is shared out or was interrupted. Parts join to the bits of the
    /// whole if they meet at the ends of steps, as [`Self::place`] tells them, or of iterations.
    #[must_use]
    pub fn starting_at(mut self, place: Place) -> Self {
        (self.place, self.maps) = (place, None);
        self
    }

    /// Goes on with the films of what was rendered before, which must have the values that [`Self::with_aovs`] asked for.
    pub fn with_films(mut self, film: Film, aovs: Option<AovFilm>) -> Result<Self, MergeError> {
        // Nothing is in this session's own.
        self.film.merge(&film)?;
        match (&mut self.aovs, &aovs) {
            (None, None) => {}
            (Some(own), Some(given)) => own.merge(given)?,
            (own, given) => {
                let values = |aovs: Option<&AovFilm>| aovs.map_or(Vec::new(), |aovs| aovs.aovs().to_vec());
                let (first, second) = (values(own.as_ref()), values(given.as_ref()));
                return Err(MergeError::Values { first, second });
            }
        }
        (self.film, self.aovs) = (film, aovs);
        Ok(self)
    }

    /// Renders on: the photons of an iteration if one begins, and a few samples of every pixel.
    /// Returns false if the observer cancelled: what was finished, tile by tile, is then in [`Self::picture`] alone, and
    /// the session is at its end.
    pub fn step(&mut self, observer: &dyn Observer) -> bool {
        let whole = self.plan.camera.samples_per_pixel;
        if self.place.samples >= whole {
            (self.place, self.maps) = (Place { iteration: self.place.iteration + 1, samples: 0 }, None);
        }
        let samples = samples_of_step(&self.method, whole - self.place.samples);
        let pass = camera_pass_of(&self.settings, &self.plan.camera, self.place, samples);
        let done = match self.method.clone() {
            Method::PhotonMapper(config) => self.photon_step(&config, &pass, observer),
            Method::Ppm(config) => self.photon_step(&config.mapper, &pass, observer),
            Method::Vcm(config) => self.vcm_step(&config, &pass, observer),
            // It was settled when the render was planned.
            Method::Auto(_) => return false,
            Method::Path(config) => {
                let tracer = PathTracer { world: self.world, config: &config };
                let exposed = expose(self.world, &tracer, &pass, self.keep(false), observer);
                self.take(exposed)
            }
            Method::LightTracer(config) => {
                let tracer = LightTracer::new(self.world, &config);
                let Some(light) = tracer.paths(&pass, observer) else { return false };
                let mut exposed = expose(self.world, &tracer, &pass, self.keep(false), observer);
                exposed.add(&light.brought());
                self.take(exposed)
            }
        };
        if done {
            self.statistics.samples_per_pixel += u64::from(pass.samples);
            let begun = self.place.samples == 0 || self.statistics.iterations == 0;
            self.statistics.iterations += u64::from(begun);
            self.place.samples += pass.samples;
        }
        done
    }

    /// Where the render is: what was begun with and what was done since.
    pub fn place(&self) -> Place {
        self.place
    }

    /// Steps that the render is made of up to [`Self::place`], those before this session included.
    pub fn steps(&self) -> u64 {
        let whole = self.plan.camera.samples_per_pixel;
        let in_step = samples_of_step(&self.method, whole).max(1);
        let steps = |samples: u32| u64::from(samples.div_ceil(in_step));
        self.place.iteration * steps(whole) + steps(self.place.samples)
    }

    /// Whether the current iteration has all its samples.
    pub fn iteration_is_complete(&self) -> bool {
        self.place.samples >= self.plan.camera.samples_per_pixel
    }

    /// The film so far: whole steps, up to [`Self::place`].
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Further values of the picture so far, if [asked for](Self::with_aovs).
    pub fn aovs(&self) -> Option<&AovFilm> {
        self.aovs.as_ref()
    }

    /// The films to make a picture of: with what there is of a step that was stopped.
    pub fn picture(&self) -> (Film, Option<AovFilm>) {
        let mut films = (self.film.clone(), self.aovs.clone());
        if let Some(torn) = &self.torn {
            torn.add_to(&mut films.0, films.1.as_mut());
        }
        films
    }

    /// What was done so far.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// How it renders.
    pub fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    /// The integrator that renders: that of the settings, or what they leave to be chosen.
    pub fn method(&self) -> &Method {
        &self.method
    }

    /// What it does in each iteration.
    pub fn plan(&self) -> &RenderPlan {
        &self.plan
    }

    fn photon_step(
        &mut self,
        config: &PhotonMapperConfig,
        pass: &CameraPass,
        observer: &dyn Observer,
    ) -> bool {
        let (world, plan) = (self.world, self.plan);
        if self.maps.is_none() {
            let turn = Turn::new(&self.method, &plan.camera, pass.seed, self.place.iteration);
            let Some(maps) = Maps::build(world, config, &plan.photons, &turn, observer) else { return false };
            self.statistics.count(&maps, &mut self.ledger);
            let given = self.guides.take();
            let method = &self.method;
            self.guides = Guides::of_turn(given, world, method, &maps, &turn, observer);
            self.maps = Some(maps);
        }
        let (Some(maps), Some(guides)) = (&self.maps, &self.guides) else { return false };
        let mapper = PhotonMapper::new(world, config, maps, guides, &plan.camera);
        let progressive = self.method.is_progressive();
        let mut exposed = expose(world, &mapper, pass, self.keep(progressive), observer);
        if progressive {
            exposed.count_as_one_estimate();
        }
        self.take(exposed)
    }

    fn vcm_step(&mut self, config: &VcmConfig, pass: &CameraPass, observer: &dyn Observer) -> bool {
        let (world, plan) = (self.world, self.plan);
        let number = vcm::IterationKey::new(pass.seed, self.place.iteration);
        let keep = self.keep(true);
        let density = match self.density.take() {
            Some(density) => density,
            None => vcm::density(world, config, plan.photons.global.paths, pass.seed, observer).0,
        };
        let density = &*self.density.insert(density);
        let iteration =
            vcm::Iteration::new(world, config, &plan.photons, &plan.camera, density, number, observer);
        let Some(iteration) = iteration else { return false };
        self.statistics.count_paths(&iteration.totals(), iteration.ledger(), &mut self.ledger);
        self.statistics.count_volumes(iteration.maps());
        let camera = iteration.camera(world, config, &plan.camera, density);
        let mut exposed = expose(world, &camera, pass, keep, observer);
        exposed.add(&iteration.brought(pass.samples));
        self.take(exposed)
    }

    fn keep(&self, blur: bool) -> Keep {
        Keep { aovs: self.aovs.is_some(), blur, clamp: self.clamp }
    }

    /// Adds a pass to the film if it is whole.
    fn take(&mut self, exposed: Exposed) -> bool {
        let (total, complete) = exposed.total();
        if complete {
            self.statistics.picture.append(total);
            exposed.add_to(&mut self.film, self.aovs.as_mut());
            exposed.compare(&mut self.film, &mut self.convergence, self.method.pixels());
        } else {
            self.torn = Some(exposed);
        }
        complete
    }
}
