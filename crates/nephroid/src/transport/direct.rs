//! Direct light by next event estimation.

use crate::color::Rgb;
use crate::light::Emitter;
use crate::material::{Bsdf, Transport};
use crate::math::Vec3;
use crate::sampling::{Sampler, power_heuristic};
use crate::shape::SurfacePoint;
use crate::world::{World, leave};

/// Which lights next event estimation asks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DirectLights {
    /// One, by roulette: half by power, half evenly.
    #[default]
    One,
    /// Every one.
    All,
}

/// The other technique that may find the same light, which the power heuristic shares it with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Partner {
    /// None: lights are sampled, and nothing else.
    None,
    /// A ray in a direction sampled from the BSDF.
    BsdfSample,
}

/// Reflected direct light at a surface towards `wo`, in W/(m²·sr), lights sampled only; glossy lobes
/// also by a ray sampled from the BSDF, weighted by the power heuristic.
pub(crate) fn direct_light(
    world: &World,
    point: &SurfacePoint,
    bsdf: &Bsdf,
    wo: Vec3,
    lights: DirectLights,
    sampler: &mut Sampler,
) -> Rgb {
    if !bsdf.has_glossy_lobe() {
        return sample_lights(world, point, bsdf, wo, lights, Partner::None, sampler);
    }
    let by_lights = sample_lights(world, point, bsdf, wo, lights, Partner::BsdfSample, sampler);
    by_lights + sample_bsdf(world, point, bsdf, wo, lights, sampler)
}

/// The part of [`direct_light`] that lights are sampled for.
pub(crate) fn sample_lights(
    world: &World,
    point: &SurfacePoint,
    bsdf: &Bsdf,
    wo: Vec3,
    lights: DirectLights,
    partner: Partner,
    sampler: &mut Sampler,
) -> Rgb {
    let Some(table) = world.lights_for_direct() else { return Rgb::BLACK };
    match lights {
        DirectLights::One => {
            let (light, probability, _) = table.sample(sampler.next_1d());
            let emitter = &world.emitters()[light];
            one_light(world, point, bsdf, wo, emitter, probability, partner, sampler)
        }
        DirectLights::All => {
            let each = |e| one_light(world, point, bsdf, wo, e, 1.0, partner, sampler);
            world.emitters().iter().map(each).sum()
        }
    }
}

#[expect(clippy::too_many_arguments, reason = "one call site; a struct would only rename them")]
fn one_light(
    world: &World,
    point: &SurfacePoint,
    bsdf: &Bsdf,
    wo: Vec3,
    emitter: &Emitter,
    probability: f32,
    partner: Partner,
    sampler: &mut Sampler,
) -> Rgb {
    let u = sampler.next_2d();
    let Some(incident) = emitter.sample_incident(world.lookup(), point.position, u) else {
        return Rgb::BLACK;
    };
    let f_cos = bsdf.eval(wo, incident.wi) * bsdf.cosine(incident.wi);
    if (f_cos * incident.radiance).is_black() || !world.visible(point, incident.wi, &incident.source) {
        return Rgb::BLACK;
    }
    let pdf = incident.pdf_solid_angle * probability;
    let weight = match partner {
        Partner::BsdfSample if !incident.dirac => power_heuristic(pdf, bsdf.pdf(wo, incident.wi)),
        _ => 1.0,
    };
    f_cos * incident.radiance * (weight / pdf)
}

/// The part of [`direct_light`] that a direction is sampled from the BSDF for.
fn sample_bsdf(
    world: &World,
    point: &SurfacePoint,
    bsdf: &Bsdf,
    wo: Vec3,
    lights: DirectLights,
    sampler: &mut Sampler,
) -> Rgb {
    let (u, u_lobe) = (sampler.next_2d(), sampler.next_1d());
    let Some(sample) = bsdf.sample(wo, u, u_lobe, Transport::Radiance) else { return Rgb::BLACK };
    let mut ray = leave(point, sample.wi);
    let mut seen = Rgb::BLACK;
    loop {
        let Some(hit) = world.intersect(&ray) else {
            seen += sky_by_bsdf(world, sample.wi, sample.pdf_solid_angle, lights);
            return sample.weight * seen;
        };
        seen += world.emitted(&hit, -ray.direction).map_or(Rgb::BLACK, |(light, radiance)| {
            let pdf = light_pdf(world, light, point.position, &hit.point, lights);
            radiance * power_heuristic(sample.pdf_solid_angle, pdf)
        });
        if !world.bsdf(&hit, -ray.direction).is_null() {
            return sample.weight * seen;
        }
        ray = leave(&hit.point, ray.direction);
    }
}

/// Density per solid angle, at `from`, with which next event estimation finds a point of area light
/// `light`, the choice of the light included.
pub(crate) fn light_pdf(
    world: &World,
    light: usize,
    from: Vec3,
    point: &SurfacePoint,
    lights: DirectLights,
) -> f32 {
    world.emitters()[light].pdf_of_surface(from, point) * choice(world, light, lights)
}

/// Radiance of the sky in a direction sampled from a BSDF, each light weighted by the power heuristic.
pub(crate) fn sky_by_bsdf(world: &World, direction: Vec3, pdf_bsdf: f32, lights: DirectLights) -> Rgb {
    let textures = &world.scene().textures;
    let skies = world.emitters().iter().enumerate().filter(|(_, e)| e.is_sky());
    skies
        .map(|(i, emitter)| {
            let pdf = emitter.pdf_of_sky(direction) * choice(world, i, lights);
            emitter.sky_radiance(textures, direction) * power_heuristic(pdf_bsdf, pdf)
        })
        .sum()
}

fn choice(world: &World, light: usize, lights: DirectLights) -> f32 {
    match (lights, world.lights_for_direct()) {
        (DirectLights::One, Some(table)) => table.pmf(light),
        _ => 1.0,
    }
}
