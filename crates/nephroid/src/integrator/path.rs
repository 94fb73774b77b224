//! Path tracing with next event estimation and multiple importance sampling (Kajiya 1986; Veach
//! 1997): unbiased, and so the measure of every other estimator on surfaces. Light that reaches a
//! surface from a Dirac light by way of a specular one is beyond it.

use super::{Components, Estimator, LightPart, Met, Probe};
use crate::color::Rgb;
use crate::material::Transport;
use crate::math::Vec3;
use crate::photon_map::NearestList;
use crate::sampling::power_heuristic;
use crate::transport::{DirectLights, Partner, PixelSample, light_pdf, sample_lights, sky_by_bsdf, survival};
use crate::world::{World, leave};

/// Settings of the path tracer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathConfig {
    /// Segments of a path from light to lens; `None` without end.
    pub max_depth: Option<u32>,
    /// Which lights are sampled at each surface.
    pub direct_lights: DirectLights,
}

/// How the segment being traced came to be.
#[derive(Clone, Copy)]
enum Last {
    /// From the camera or a Dirac lobe: nothing else could have found what it meets.
    Certain,
    /// Sampled from a BSDF at a point with a density, as lights were sampled, too.
    Sampled { from: Vec3, pdf_solid_angle: f32 },
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
    let mut throughput = Rgb::WHITE;
    let mut last = Last::Certain;
    // Segments up to the next surface, and surfaces that were not specular.
    let (mut depth, mut diffuse) = (1, 0u32);
    let fits = |depth: u32| config.max_depth.is_none_or(|max| depth <= max);
    while fits(depth) {
        let Some(hit) = world.intersect(&ray) else {
            let sky = match last {
                Last::Certain => world.sky(ray.direction),
                Last::Sampled { pdf_solid_angle, .. } => {
                    sky_by_bsdf(world, ray.direction, pdf_solid_angle, config.direct_lights)
                }
            };
            book(&mut out, throughput * sky, diffuse, last, probe);
            break;
        };
        let wo = -ray.direction;
        if let Some((light, emitted)) = world.emitted(&hit, wo) {
            let weight = match last {
                Last::Certain => 1.0,
                Last::Sampled { from, pdf_solid_angle } => {
                    let pdf = light_pdf(world, light, from, &hit.point, config.direct_lights);
                    power_heuristic(pdf_solid_angle, pdf)
                }
            };
            book(&mut out, throughput * emitted * weight, diffuse, last, probe);
        }
        let bsdf = world.bsdf(&hit, wo);
        if bsdf.is_null() {
            ray = leave(&hit.point, ray.direction);
            continue;
        }
        probe.surface(&Met { hit: &hit, bsdf: &bsdf, wo, depth, throughput, first: diffuse == 0 });
        if !bsdf.is_dirac() {
            diffuse += 1;
            if fits(depth + 1) {
                let (lights, sampler) = (config.direct_lights, &mut sample.sampler);
                let direct =
                    sample_lights(world, &hit.point, &bsdf, wo, lights, Partner::BsdfSample, sampler);
                let part = if diffuse == 1 { LightPart::Direct } else { LightPart::Global };
                out.add(part, throughput * direct);
                probe.light(part, throughput * direct);
            }
        }
        let s = &mut sample.sampler;
        let (u, u_lobe, u_survive) = (s.next_2d(), s.next_1d(), s.next_1d());
        let Some(scattered) = bsdf.sample(wo, u, u_lobe, Transport::Radiance) else { break };
        let carried = throughput * scattered.weight;
        let q = survival(throughput, carried / scattered.radiance_scale, depth - 1);
        if u_survive >= q {
            break;
        }
        throughput = carried / q;
        last = if scattered.dirac {
            Last::Certain
        } else {
            Last::Sampled { from: hit.point.position, pdf_solid_angle: scattered.pdf_solid_angle }
        };
        ray = leave(&hit.point, scattered.wi);
        depth += 1;
    }
    out
}

/// Books light by how many surfaces that are not specular it met, and whether a specular one after the
/// only one of them makes it a caustic.
fn book(out: &mut Components, light: Rgb, diffuse: u32, last: Last, probe: &mut impl Probe) {
    let part = match (diffuse, last) {
        (0, _) => LightPart::Emitted,
        (1, Last::Certain) => LightPart::Caustic,
        (1, Last::Sampled { .. }) => LightPart::Direct,
        _ => LightPart::Global,
    };
    out.add(part, light);
    probe.light(part, light);
}
