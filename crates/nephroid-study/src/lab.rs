use std::time::{Duration, Instant};

use nephroid::film::Quality;
use nephroid::observer::Observer;
use nephroid::sampling::{Key, Sampler, Sequence, Stream};
use nephroid::session::{RenderSettings, Session, Statistics};
use nephroid::texture::Image;
use nephroid::world::World;

use crate::recipe::{Command, Recipe, Task};
use crate::section::{Section, Stop};

/// Follows a study, and may stop it.
pub trait Watch: Observer {
    /// A section begins that is expected to take `weight` seconds. Of `total` seconds `done` are behind it.
    fn section(&self, section: &Section, done: f64, weight: f64, total: f64);
}

/// What a section works with.
pub struct Lab<'a> {
    quick: bool,
    seed: u64,
    command: &'a dyn Command,
    watch: &'a dyn Watch,
}

/// A picture that was rendered.
#[derive(Clone, Debug)]
pub struct Render {
    /// Radiance in W/(m²·sr).
    pub image: Image,
    /// What it states of its own error; none of a photon map, which cannot tell.
    pub quality: Option<Quality>,
    /// What was done.
    pub statistics: Statistics,
    /// How long it took, photons included.
    pub time: Duration,
    /// What made it; none if it was made in code.
    pub recipe: Option<Recipe>,
}

impl Render {
    /// Its own relative error as it states it, as a part of one.
    pub fn error(&self) -> Result<f64, Stop> {
        self.quality
            .map(|quality| quality.error)
            .ok_or_else(|| Stop::because("the reference states no error"))
    }

    /// Mean over all pixels and channels, in W/(m²·sr).
    pub fn mean(&self) -> f64 {
        let sum: f64 = self.image.pixels.iter().flat_map(|p| p.to_array()).map(f64::from).sum();
        sum / (3 * self.image.pixels.len()).max(1) as f64
    }
}

impl<'a> Lab<'a> {
    /// A laboratory.
    pub fn new(quick: bool, seed: u64, command: &'a dyn Command, watch: &'a dyn Watch) -> Self {
        Self { quick, seed, command, watch }
    }

    /// Whether small pictures and few samples will do.
    pub fn is_quick(&self) -> bool {
        self.quick
    }

    /// One value for the whole study, another for the quick one.
    pub fn pick<T>(&self, full: T, quick: T) -> T {
        if self.quick { quick } else { full }
    }

    /// The usual side of a picture in pixels.
    pub fn side(&self) -> u32 {
        self.pick(288, 48)
    }

    /// Everything random follows from it.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Independent random numbers; `purpose` keeps experiments apart.
    pub fn sampler(&self, purpose: u64) -> Sampler {
        Sampler::new(Sequence::Independent, Key::new(self.seed, 0, Stream::Camera).with(0x57ed7), purpose)
    }

    /// A built-in scene at the usual size, with the study's seed.
    pub fn recipe(&self, scene: &str) -> Recipe {
        let recipe = Recipe::of_scene(scene).side(self.side());
        if self.seed == 0 { recipe } else { recipe.flag("--seed", self.seed) }
    }

    /// Renders what a command line says.
    pub fn render(&self, recipe: &Recipe) -> Result<Render, Stop> {
        let told = |error| Stop::because(format!("{}: {error}", recipe.command()));
        let task = self.command.read(recipe.words()).map_err(told)?;
        let Task { scene, settings, samples, passes } = task;
        let world = World::new(scene).map_err(|errors| told(errors.to_string()))?;
        let render = self.go(&world, settings, samples, passes)?;
        Ok(Render { recipe: Some(recipe.clone()), ..render })
    }

    /// The world and the settings of a command line, for experiments that look into a render.
    pub fn world(&self, recipe: &Recipe) -> Result<(World, RenderSettings), Stop> {
        let told = |error| Stop::because(format!("{}: {error}", recipe.command()));
        let task = self.command.read(recipe.words()).map_err(told)?;
        let world = World::new(task.scene).map_err(|errors| told(errors.to_string()))?;
        Ok((world, task.settings))
    }

    /// Renders so many iterations of a world that was made in code.
    pub fn render_world(&self, world: &World, settings: RenderSettings, passes: u64) -> Result<Render, Stop> {
        self.go(world, settings, None, Some(passes))
    }

    /// Ends a section that was told to stop.
    pub fn check(&self) -> Result<(), Stop> {
        if self.watch.cancelled() { Err(Stop::Cancelled) } else { Ok(()) }
    }

    /// For functions of the library that take an observer.
    pub fn observer(&self) -> &dyn Observer {
        self.watch
    }

    fn go(
        &self,
        world: &World,
        settings: RenderSettings,
        samples: Option<u64>,
        passes: Option<u64>,
    ) -> Result<Render, Stop> {
        self.check()?;
        let begun = Instant::now();
        let observer = self.observer();
        let mut session = Session::new(world, settings, observer);
        let per_pass = session.plan().camera.samples_per_pixel;
        let by_passes = passes.map(|passes| passes.saturating_mul(u64::from(per_pass)));
        let end = match (samples, by_passes) {
            (Some(a), Some(b)) => a.min(b),
            (a, b) => a.or(b).unwrap_or(u64::from(per_pass)),
        };
        while session.place().samples_before(per_pass) < end {
            if !session.step(observer) {
                return Err(Stop::Cancelled);
            }
        }
        Ok(Render {
            image: session.film().develop(),
            quality: session.quality(),
            statistics: session.statistics().clone(),
            time: begun.elapsed(),
            recipe: None,
        })
    }
}
