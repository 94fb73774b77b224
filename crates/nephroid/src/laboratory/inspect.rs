//! One pixel of a render, estimated again with somebody watching.

use super::catalogue::Catalogue;
use super::inspect_probe::{InspectProbe, InspectedSample};
use super::photons;
use crate::color::Rgb;
use crate::film::{Aov, AovFilm, AovSample, AovSum, Film, FilterSampler, PixelSum};
use crate::integrator::{
    Components, Estimator, Guides, LightTracer, Maps, Method, PathTracer, PhotonMapper, PhotonMapperConfig,
    PpmConfig, Turn, vcm,
};
use crate::observer::Observer;
use crate::photon_map::NearestList;
use crate::session::{Place, RenderPlan, RenderSettings, camera_pass_of, samples_of_step};
use crate::transport::{Ledger, PixelSample, pixel_key};
use crate::world::World;

/// A pixel being estimated again: the same samples in the same steps as a
/// [`Session`](crate::session::Session) with the same settings takes, of this pixel alone.
pub struct Inspector<'w> {
    world: &'w World,
    settings: RenderSettings,
    /// What renders, which settings may leave open.
    method: Method,
    pixel: (u32, u32),
    plan: RenderPlan,
    maps: Option<(Maps, [Catalogue; 4])>,
    guides: Option<Guides>,
    film: Film,
    parts: AovFilm,
    iteration: u64,
    /// Samples taken in the current iteration, and in all.
    samples: u32,
    samples_in_all: u64,
    inspected: Vec<InspectedSample>,
}

/// What became of a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelReport {
    /// The pixel of the render, to the bit; of light tracing the camera's part alone, without what light paths bring.
    pub radiance: Rgb,
    /// The parts that it is the sum of, up to rounding.
    pub light: Components,
    /// Every sample.
    pub samples: Vec<InspectedSample>,
}

impl<'w> Inspector<'w> {
    /// `pixel` counts columns and rows of the whole picture from its upper left corner.
    pub fn new(
        world: &'w World,
        settings: RenderSettings,
        pixel: (u32, u32),
        observer: &dyn Observer,
    ) -> Self {
        let plan = RenderPlan::new(world, &settings, observer);
        Self {
            world,
            method: plan.method(world, &settings.method),
            settings,
            pixel,
            plan,
            maps: None,
            guides: None,
            film: Film::with_unit(1, 1, world.radiance_unit()),
            parts: AovFilm::with_unit(
                1,
                1,
                world.radiance_unit(),
                &[Aov::Direct, Aov::Global, Aov::Caustic, Aov::Emitted, Aov::Medium],
            ),
            iteration: 0,
            samples: 0,
            samples_in_all: 0,
            inspected: Vec::new(),
        }
    }

    /// Takes the samples of one step of a session. False if the observer cancelled.
    pub fn step(&mut self, observer: &dyn Observer) -> bool {
        let whole = self.plan.camera.samples_per_pixel;
        if self.samples >= whole {
            (self.iteration, self.samples, self.maps) = (self.iteration + 1, 0, None);
        }
        let taken = samples_of_step(&self.method, whole - self.samples);
        match self.method.clone() {
            Method::PhotonMapper(config) | Method::Ppm(PpmConfig { mapper: config, .. }) => {
                if self.maps.is_none() {
                    self.maps = self.build(&config, observer);
                }
                let Some((maps, catalogues)) = self.maps.take() else { return false };
                let Some(guides) = self.guides.take() else { return false };
                let mapper = PhotonMapper::new(self.world, &config, &maps, &guides, &self.plan.camera);
                self.take(&mapper, Some(&catalogues), taken);
                (self.maps, self.guides) = (Some((maps, catalogues)), Some(guides));
            }
            // It was settled when the render was planned.
            Method::Auto(_) => return false,
            Method::Vcm(config) => {
                let RenderPlan { photons, camera, .. } = self.plan;
                let number = vcm::IterationKey::new(self.settings.seed, self.iteration);
                let (density, _) =
                    vcm::density(self.world, &config, photons.global.paths, self.settings.seed, observer);
                let iteration =
                    vcm::Iteration::new(self.world, &config, &photons, &camera, &density, number, observer);
                let Some(iteration) = iteration else { return false };
                self.take(&iteration.camera(self.world, &config, &camera, &density), None, taken);
            }
            Method::Path(config) => {
                self.take(&PathTracer { world: self.world, config: &config }, None, taken);
            }
            Method::LightTracer(config) => {
                self.take(&LightTracer::new(self.world, &config), None, taken);
            }
        }
        self.samples += taken;
        self.samples_in_all += u64::from(taken);
        true
    }

    /// Iterations that have all their samples.
    pub fn iterations(&self) -> u64 {
        self.iteration + u64::from(self.samples >= self.plan.camera.samples_per_pixel)
    }

    /// Samples taken.
    pub fn samples(&self) -> u64 {
        self.samples_in_all
    }

    /// What was found.
    pub fn finish(self) -> PixelReport {
        let part = |aov| {
            let channels = self.parts.develop(aov).map_or(Vec::new(), |image| image.channels.concat());
            <[f32; 3]>::try_from(channels).map_or(Rgb::BLACK, |[r, g, b]| Rgb::new(r, g, b))
        };
        let light = Components {
            emitted: part(Aov::Emitted),
            direct: part(Aov::Direct),
            global: part(Aov::Global),
            caustic: part(Aov::Caustic),
            medium: part(Aov::Medium),
        };
        PixelReport { radiance: self.film.develop().pixels[0], light, samples: self.inspected }
    }

    fn build(
        &mut self,
        config: &PhotonMapperConfig,
        observer: &dyn Observer,
    ) -> Option<(Maps, [Catalogue; 4])> {
        let (world, plan) = (self.world, self.plan);
        let turn = Turn::new(&self.method, &plan.camera, self.settings.seed, self.iteration);
        let pass = photons::record(world, config, &plan.photons, &turn, observer)?;
        let (global, of_global) = Catalogue::build(pass.global, pass.global_paths);
        let (caustic, of_caustic) = Catalogue::build(pass.caustic, pass.caustic_paths);
        let (afterglow, of_afterglow) = Catalogue::build(pass.afterglow, pass.caustic_paths);
        let (haze, of_haze) = Catalogue::build(pass.haze, pass.global_paths);
        let volumes = Maps::volumes(world, config, &plan.photons, &turn, observer)?;
        let maps = Maps::new([global, caustic, afterglow, haze], volumes, turn.blur, Ledger::default());
        let (given, method) = (self.guides.take(), &self.method);
        self.guides = Guides::of_turn(given, world, method, &maps, &turn, observer);
        Some((maps, [of_global, of_caustic, of_afterglow, of_haze]))
    }

    fn take(&mut self, estimator: &impl Estimator, catalogues: Option<&[Catalogue; 4]>, samples: u32) {
        let filter = FilterSampler::new(self.world.scene().film.filter);
        let place = Place { iteration: self.iteration, samples: self.samples };
        let pass = camera_pass_of(&self.settings, &self.plan.camera, place, samples);
        let key = pixel_key(pass.seed, pass.iteration, self.pixel);
        let (mut neighbors, mut sum, mut parts) =
            (NearestList::new(), PixelSum::default(), AovSum::default());
        for index in self.samples..self.samples + samples {
            let number = pass.first_sample + u64::from(index - self.samples);
            let (mut sample, weight) = PixelSample::new(self.world, &filter, key, self.pixel, number);
            let (origin, direction) = (sample.ray.origin, sample.ray.direction);
            let mut probe = InspectProbe::new(catalogues);
            let light = estimator.radiance(&mut sample, &mut neighbors, &mut probe);
            sum.add(light.total(), weight);
            parts.add(&AovSample::of_light(light.by_layer()), weight);
            let (surfaces, rays, look_ups, media) = Default::default();
            let iteration = self.iteration;
            let mut report = InspectedSample {
                iteration,
                index,
                origin,
                direction,
                weight,
                light,
                surfaces,
                rays,
                look_ups,
                media,
            };
            probe.finish(&mut report);
            self.inspected.push(report);
        }
        if self.method.is_progressive() {
            sum = sum.as_one_estimate();
        }
        self.film.add_iteration(&[sum]);
        self.parts.add_iteration([parts].iter());
    }
}
