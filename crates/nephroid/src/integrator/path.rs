//! Path tracing with next event estimation and multiple importance sampling (Kajiya 1986; Veach
//! 1997), in media with collisions at sampled distances: unbiased, and so the measure of every other
//! estimator. Light that reaches a surface or a medium from a Dirac light by way of a specular one is beyond it.

use super::{Components, Estimator, LightPart, Met, Probe};
use crate::color::Rgb;
use crate::light::Asker;
use crate::material::{Transport, segments_by};
use crate::math::Ray;
use crate::medium::{Passage, PhaseSample};
use crate::photon_map::NearestList;
use crate::sampling::power_heuristic;
use crate::transport::{
    DirectLights, Lit, Partner, PixelSample, Scatterer, effort, light_pdf, sample_lights, sky_by_bsdf,
    survival,
};
use crate::world::{World, leave};

/// Settings of the path tracer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathConfig {
    /// Segments of a path from light to lens; `None` without end.
    pub max_depth: Option<u32>,
    /// Which lights are sampled at each surface and collision.
    pub direct_lights: DirectLights,
    /// Whether there is anything between surfaces: `volpath` in scene files. Else they are in vacuum.
    pub media: bool,
}

/// How the segment being traced came to be.
#[derive(Clone, Copy)]
enum Last {
    /// From the camera or a Dirac lobe: nothing else could have found what it meets.
    Certain,
    /// Sampled from a BSDF or a phase function at a point with a density, as lights were sampled, too.
    Sampled { from: Asker, pdf_solid_angle: f32 },
}

/// The path tracer of a world.
pub(crate) struct PathTracer<'a> {
    pub world: &'a World,
    pub config: &'a PathConfig,
}

impl Estimator for PathTracer<'_> {
    fn radiance<P: Probe>(
        &self,
        sample: &mut PixelSample,
        _heap: &mut NearestList,
        probe: &mut P,
    ) -> Components {
        radiance(self.world, self.config, sample, probe)
    }
}

/// Estimates the radiance of one camera sample.
fn radiance<P: Probe>(
    world: &World,
    config: &PathConfig,
    sample: &mut PixelSample,
    probe: &mut P,
) -> Components {
    probe.begin(None, Rgb::WHITE);
    let mut out = Components::default();
    let mut ray = sample.ray;
    let inside = world.camera_surroundings();
    let mut inside = if config.media { inside } else { inside.blind() };
    let mut throughput = Rgb::WHITE;
    let mut last = Last::Certain;
    let mut so_far = SoFar::default();
    // Segments up to the next surface or collision.
    let mut depth = 1;
    let fits = |depth: u32| config.max_depth.is_none_or(|max| depth <= max);
    while fits(depth) {
        let hit = world.intersect(&ray);
        if let Some(matter) = world.matter(inside) {
            let end = hit.map_or(f32::INFINITY, |hit| hit.t);
            if matter.emits() {
                let emitted = matter.emitted(&ray, end, &mut sample.sampler);
                book(&mut out, LightPart::Medium, throughput * emitted, probe);
            }
            match matter.travel(&ray, end, throughput, &mut sample.sampler) {
                Passage::Through { weight } => throughput *= weight,
                Passage::Collision { t, weight } => {
                    let (position, wo) = (ray.at(t), -ray.direction);
                    let before = throughput;
                    throughput *= weight * matter.albedo(position);
                    so_far.collide();
                    if fits(depth + 1) {
                        let lit = Lit {
                            scatterer: Scatterer::Medium { position, phase: matter.phase() },
                            wo,
                            inside,
                        };
                        let direct = throughput * lights(world, config, &lit, sample);
                        book(&mut out, so_far.part(Last::Certain), direct, probe);
                    }
                    let (u, u_survive) = (sample.sampler.next_2d(), sample.sampler.next_1d());
                    let q = survival(before * weight, throughput, effort(depth - 1, so_far.collisions - 1));
                    if u_survive >= q || throughput.is_black() {
                        break;
                    }
                    throughput = throughput / q;
                    let PhaseSample { wi, pdf_solid_angle } = matter.phase().sample(wo, u);
                    last = Last::Sampled { from: Asker::in_space(position), pdf_solid_angle };
                    ray = Ray::new(position, wi);
                    depth += 1;
                    continue;
                }
            }
        }
        let Some(hit) = hit else {
            let sky = match last {
                Last::Certain => world.sky(ray.direction),
                Last::Sampled { from, pdf_solid_angle } => {
                    sky_by_bsdf(world, &from, ray.direction, pdf_solid_angle, config.direct_lights)
                }
            };
            book(&mut out, so_far.part(last), throughput * sky, probe);
            break;
        };
        let wo = -ray.direction;
        if let Some((light, emitted)) = world.emitted(&hit, wo) {
            let weight = match last {
                Last::Certain => 1.0,
                Last::Sampled { from, pdf_solid_angle } => {
                    let pdf = light_pdf(world, light, &from, &hit.point, config.direct_lights);
                    power_heuristic(pdf_solid_angle, pdf)
                }
            };
            book(&mut out, so_far.part(last), throughput * emitted * weight, probe);
        }
        let bsdf = world.meet(&hit, wo, &mut inside, &mut throughput, &mut sample.sampler);
        if bsdf.is_null() {
            inside = world.cross(inside, &hit, ray.direction, ray.direction);
            ray = leave(&hit.point, ray.direction);
            continue;
        }
        probe.surface(&Met { hit: &hit, bsdf: &bsdf, wo, depth, throughput, first: so_far.scattered == 0 });
        if !bsdf.is_dirac() {
            so_far.scattered += 1;
            if fits(depth + 1) {
                let lit = Lit { scatterer: Scatterer::Surface { hit: &hit, bsdf: &bsdf }, wo, inside };
                let direct = throughput * lights(world, config, &lit, sample);
                let part = so_far.part(Last::Sampled { from: Asker::on(&hit.point), pdf_solid_angle: 1.0 });
                book(&mut out, part, direct, probe);
            }
        }
        let s = &mut sample.sampler;
        let (u, u_lobe, u_survive) = (s.next_2d(), s.next_1d(), s.next_1d());
        let Some(scattered) = bsdf.sample(wo, u, u_lobe, Transport::Radiance) else { break };
        let carried = throughput * scattered.weight;
        let q =
            survival(throughput, carried / scattered.radiance_scale, effort(depth - 1, so_far.collisions));
        if u_survive >= q {
            break;
        }
        throughput = carried / q;
        last = if scattered.is_dirac() {
            Last::Certain
        } else {
            Last::Sampled { from: Asker::on(&hit.point), pdf_solid_angle: scattered.pdf_solid_angle }
        };
        inside = world.cross(inside, &hit, ray.direction, scattered.wi);
        ray = leave(&hit.point, scattered.wi);
        depth += segments_by(wo, scattered.wi);
    }
    out
}

/// Direct light where a path is, as directions will be sampled there, too.
fn lights(world: &World, config: &PathConfig, lit: &Lit<'_>, sample: &mut PixelSample) -> Rgb {
    sample_lights(world, lit, config.direct_lights, Partner::BsdfSample, &mut sample.sampler)
}

/// What a path has met, as far as it decides what its light is called.
#[derive(Clone, Copy, Default)]
struct SoFar {
    /// Surfaces that are not specular, and collisions.
    scattered: u32,
    collisions: u32,
    /// Whether the first of them was a collision.
    by_medium: bool,
}

impl SoFar {
    fn collide(&mut self) {
        self.by_medium |= self.scattered == 0;
        self.scattered += 1;
        self.collisions += 1;
    }

    /// What light is that the path finds now: a specular surface after the only other one makes it a caustic.
    fn part(self, last: Last) -> LightPart {
        match (self.scattered, last) {
            (0, _) => LightPart::Emitted,
            _ if self.by_medium => LightPart::Medium,
            (1, Last::Certain) => LightPart::Caustic,
            (1, Last::Sampled { .. }) => LightPart::Direct,
            _ => LightPart::Global,
        }
    }
}

fn book(out: &mut Components, part: LightPart, light: Rgb, probe: &mut impl Probe) {
    out.add(part, light);
    probe.light(part, light);
}
