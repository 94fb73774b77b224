//! Light tracing: paths from the lights, connected to the camera at each of their vertices (Dutré, Lafortune and
//! Willems 1993; Veach 1997, §8.3). Unbiased, but for what lies behind mirrors and glass.
//!
//! The paths from light L to eye E that it finds are those whose last vertex before the lens is not specular, by
//! light paths, and L S* E, by camera rays that collect what lamps, sky and media give off. No path is found twice.

use super::{Components, Estimator, LightPart, Met, PictureSums, Probe};
use crate::color::Rgb;
use crate::film::PixelSum;
use crate::material::{Transport, segments_by};
use crate::observer::Observer;
use crate::photon_map::NearestList;
use crate::transport::{CameraPass, LightPass, PixelSample, Splats, effort, light_pass, survival};
use crate::world::{World, leave};

/// Settings of the light tracer.
///
/// What is seen in mirrors and through glass stays black there, lamps, sky and the light that media give off aside: no
/// vertex that a camera sees by a specular surface can be connected to it. [`Self::misses`] tells. All else is right in
/// the mean, caustics of lamps without a surface included, which the path tracer cannot find. Masks and null surfaces
/// are no obstacle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightTracerConfig {
    /// Segments of a path from light to lens; `None` without end.
    pub max_depth: Option<u32>,
}

impl LightTracerConfig {
    /// Whether the scene has mirrors or glass, in which the picture is too dark.
    pub fn misses(world: &World) -> bool {
        world.has_dirac_surfaces()
    }
}

/// The light tracer of a world.
pub(crate) struct LightTracer<'a> {
    world: &'a World,
    config: &'a LightTracerConfig,
    /// Whether anything gives off light that a camera ray may meet.
    shines: bool,
}

impl<'a> LightTracer<'a> {
    pub fn new(world: &'a World, config: &'a LightTracerConfig) -> Self {
        let shines = world.has_media() || world.emitters().iter().any(|e| !e.is_dirac());
        Self { world, config, shines }
    }

    /// What light paths bring in one step: as many as it has camera samples. `None` if the observer cancelled.
    pub fn paths(&self, pass: &CameraPass, observer: &dyn Observer) -> Option<LightSplats> {
        let window = self.world.scene().film.window();
        let pixels = u64::from(window.width) * u64::from(window.height);
        let paths = pixels * u64::from(pass.samples);
        let light = LightPass {
            seed: pass.seed,
            iteration: pass.iteration,
            first_path: pixels * pass.first_sample,
            paths,
            max_depth: self.config.max_depth,
        };
        let splats = light_pass(self.world, &light, observer)?;
        Some(LightSplats { splats, samples: pass.samples, paths })
    }
}

/// What the light paths of one step brought.
pub(crate) struct LightSplats {
    splats: Splats,
    samples: u32,
    paths: u64,
}

impl LightSplats {
    pub fn brought(&self) -> Brought<'_> {
        Brought::new(&self.splats, self.samples, self.paths)
    }
}

/// What light paths brought to the camera, and how many there were of them and of the camera's samples of each pixel.
pub(crate) struct Brought<'a> {
    splats: &'a Splats,
    samples: u32,
    paths: u64,
}

impl<'a> Brought<'a> {
    pub fn new(splats: &'a Splats, samples: u32, paths: u64) -> Self {
        Self { splats, samples, paths }
    }

    /// Joins it with the camera samples of the same step, pixel by pixel; those that have none stay without.
    ///
    /// With s samples of weights w that are 1 in the mean, Σ w·L / s and the mean over light paths are right in the
    /// mean each, so the sum of s times both has the weight s. A step is one estimate: its light paths are shared by
    /// all samples.
    pub fn add_to<'p>(&self, pixels: impl Iterator<Item = &'p mut PixelSum>, total: &mut PictureSums) {
        let share = f64::from(self.samples) / self.paths.max(1) as f64;
        for (sum, brought) in pixels.zip(&self.splats.pixels) {
            if sum.samples > 0 {
                for (sum, light) in sum.radiance.iter_mut().zip(brought) {
                    *sum += share * light;
                }
                *sum = PixelSum { weight: f64::from(self.samples), ..*sum }.as_one_estimate();
            }
        }
        let Splats { direct, caustic, global, medium, .. } = self.splats;
        let parts = [direct, caustic, global, medium];
        let [direct, caustic, global, medium] = parts.map(|part| part.map(|light| share * light));
        total.append(&PictureSums { direct, caustic, global, medium, ..PictureSums::default() });
    }
}

impl Estimator for LightTracer<'_> {
    /// What lamps, sky and media send straight to the camera, or by specular surfaces.
    fn radiance<P: Probe>(
        &self,
        sample: &mut PixelSample,
        _heap: &mut NearestList,
        probe: &mut P,
    ) -> Components {
        let world = self.world;
        probe.begin(None, Rgb::WHITE);
        let mut out = Components::default();
        if P::IDLE && !self.shines {
            return out;
        }
        let mut book = |part, light, probe: &mut P| {
            out.add(part, light);
            probe.light(part, light);
        };
        let (mut ray, mut inside) = (sample.ray, world.camera_surroundings());
        let (mut throughput, mut depth, mut bounces) = (Rgb::WHITE, 1, 0);
        while self.config.max_depth.is_none_or(|max| depth <= max) {
            let hit = world.intersect(&ray);
            if let Some(matter) = world.matter(inside) {
                let end = hit.map_or(f32::INFINITY, |hit| hit.t);
                if matter.emits() {
                    let emitted = matter.emitted(&ray, end, &mut sample.sampler);
                    book(LightPart::Medium, throughput * emitted, probe);
                }
                throughput *= matter.transmittance(&ray, end, &mut sample.sampler);
                if throughput.is_black() {
                    break;
                }
            }
            let Some(hit) = hit else {
                book(LightPart::Emitted, throughput * world.sky(ray.direction), probe);
                break;
            };
            let wo = -ray.direction;
            if let Some((_, emitted)) = world.emitted(&hit, wo) {
                book(LightPart::Emitted, throughput * emitted, probe);
            }
            let bsdf = world.meet(&hit, wo, &mut inside, &mut throughput, &mut sample.sampler);
            if bsdf.is_null() {
                inside = world.cross(inside, &hit, ray.direction, ray.direction);
                ray = leave(&hit.point, ray.direction);
                continue;
            }
            probe.surface(&Met { hit: &hit, bsdf: &bsdf, wo, depth, throughput, first: true });
            if !bsdf.is_dirac() {
                break;
            }
            let s = &mut sample.sampler;
            let (u, u_lobe, u_survive) = (s.next_2d(), s.next_1d(), s.next_1d());
            let Some(scattered) = bsdf.sample(wo, u, u_lobe, Transport::Radiance) else { break };
            let carried = throughput * scattered.weight;
            let q = survival(throughput, carried / scattered.radiance_scale, effort(bounces, 0));
            if u_survive >= q {
                break;
            }
            throughput = carried / q;
            inside = world.cross(inside, &hit, ray.direction, scattered.wi);
            ray = leave(&hit.point, scattered.wi);
            depth += segments_by(wo, scattered.wi);
            bounces += 1;
        }
        out
    }
}
