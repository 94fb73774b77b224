//! The camera pass of a step, with further values of the picture or without.

use crate::color::Rgb;
use crate::film::{AovFilm, AovSum, Convergence, Film, PixelSum, Pixels};
use crate::integrator::{AovProbe, BlurProbe, Brought, Estimator, PictureSums};
use crate::observer::Observer;
use crate::photon_map::NearestList;
use crate::transport::{CameraPass, Exposure, camera_pass};
use crate::world::World;

/// What a camera pass brings, with further values or without.
pub(super) enum Exposed {
    Picture(Exposure<PixelSum, PictureSums>),
    WithAovs(Exposure<(PixelSum, AovSum), PictureSums>),
}

impl Exposed {
    /// The picture's light by kind, and whether every pixel has its samples.
    pub fn total(&self) -> (&PictureSums, bool) {
        match self {
            Self::Picture(exposure) => (&exposure.total, exposure.complete),
            Self::WithAovs(exposure) => (&exposure.total, exposure.complete),
        }
    }

    /// Adds what light paths brought.
    pub fn add(&mut self, light: &Brought<'_>) {
        match self {
            Self::Picture(exposure) => light.add_to(exposure.sums.iter_mut(), &mut exposure.total),
            Self::WithAovs(exposure) => {
                light.add_to(exposure.sums.iter_mut().map(|(sum, _)| sum), &mut exposure.total);
            }
        }
    }

    /// Has the samples of each pixel count as one for the variance, because they share photons.
    pub fn count_as_one_estimate(&mut self) {
        match self {
            Self::Picture(exposure) => exposure.sums.iter_mut().for_each(|sum| *sum = sum.as_one_estimate()),
            Self::WithAovs(exposure) => {
                exposure.sums.iter_mut().for_each(|(sum, _)| *sum = sum.as_one_estimate());
            }
        }
    }

    /// Adds it to films.
    pub fn add_to(&self, film: &mut Film, aovs: Option<&mut AovFilm>) {
        match self {
            Self::Picture(exposure) => film.add_iteration(&exposure.sums),
            Self::WithAovs(exposure) => {
                let picture: Vec<PixelSum> = exposure.sums.iter().map(|(sum, _)| *sum).collect();
                film.add_iteration(&picture);
                if let Some(aovs) = aovs {
                    aovs.add_iteration(exposure.sums.iter().map(|(_, sums)| sums));
                }
            }
        }
    }

    /// Takes down how far it is from what was in the film before it was added.
    pub fn compare(&self, film: &mut Film, convergence: &mut Convergence, pixels: Pixels) {
        match self {
            Self::Picture(exposure) => convergence.add(film, pixels, |pixel| &exposure.sums[pixel]),
            Self::WithAovs(exposure) => convergence.add(film, pixels, |pixel| &exposure.sums[pixel].0),
        }
    }
}

/// What becomes of samples.
#[derive(Clone, Copy, Debug)]
pub(super) struct Keep {
    /// Whether further values of the picture are kept.
    pub aovs: bool,
    /// Whether it is kept what the blur of photon look-ups does.
    pub blur: bool,
    /// The most that a sample may bring of any channel, in W/(m²·sr).
    pub clamp: Option<f32>,
}

/// The light of a sample with its largest channel cut down, and what was cut off.
fn clamped(light: Rgb, limit: Option<f32>) -> (Rgb, Rgb) {
    let most = light.max_channel();
    match limit {
        Some(limit) if most > limit => {
            let left = light * (limit / most);
            (left, light - left)
        }
        _ => (light, Rgb::BLACK),
    }
}

/// Takes the samples of a step.
pub(super) fn expose(
    world: &World,
    estimator: &impl Estimator,
    pass: &CameraPass,
    Keep { aovs, blur, clamp }: Keep,
    observer: &dyn Observer,
) -> Exposed {
    let join = PictureSums::append;
    if aovs {
        return Exposed::WithAovs(camera_pass(
            world,
            pass,
            observer,
            NearestList::new,
            join,
            |mut sample, weight, neighbors, (picture, aovs): &mut (PixelSum, AovSum), total| {
                let mut probe = (AovProbe::new(&sample), BlurProbe::new());
                let light = estimator.radiance(&mut sample, neighbors, &mut probe);
                let (kept, cut) = clamped(light.total(), clamp);
                total.add(&light);
                total.cut(cut);
                picture.add(kept, weight);
                if blur {
                    picture.add_blur(probe.1.finish(), weight);
                }
                aovs.add(&probe.0.finish(&light), weight);
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
            let light = if blur {
                let mut probe = BlurProbe::new();
                let light = estimator.radiance(&mut sample, neighbors, &mut probe);
                picture.add_blur(probe.finish(), weight);
                light
            } else {
                estimator.radiance(&mut sample, neighbors, &mut ())
            };
            let (kept, cut) = clamped(light.total(), clamp);
            total.add(&light);
            total.cut(cut);
            picture.add(kept, weight);
        },
    ))
}
