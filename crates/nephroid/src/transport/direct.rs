//! Direct light by next event estimation.

use crate::color::Rgb;
use crate::light::Asker;
use crate::material::{Bsdf, LobeKind, Transport};
use crate::math::Vec3;
use crate::medium::Phase;
use crate::sampling::{Sampler, power_heuristic};
use crate::shape::SurfacePoint;
use crate::world::{Hit, Surroundings, Vantage, World, leave};

/// Which lights next event estimation asks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DirectLights {
    /// One, by roulette: of a few half by power, half evenly; of many by how much of their light may come.
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
    /// The same, and photons, which have all light of Dirac lamps.
    BsdfSampleAndPhotons,
}

/// A vertex of a path: of one from the camera, where direct light is estimated, or of one from a light, which is
/// connected to the camera there. `wo` points back along the path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lit<'a> {
    pub scatterer: Scatterer<'a>,
    pub wo: Vec3,
    /// What lies on the side of `wo`.
    pub inside: Surroundings,
}

/// What scatters light, and how.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Scatterer<'a> {
    /// A surface.
    Surface { hit: &'a Hit, bsdf: &'a Bsdf },
    /// A medium at a point.
    Medium { position: Vec3, phase: Phase },
}

impl<'a> Lit<'a> {
    pub fn vantage(&self) -> Vantage<'a> {
        match self.scatterer {
            Scatterer::Surface { hit, .. } => Vantage::Surface(&hit.point),
            Scatterer::Medium { position, .. } => Vantage::Space(position),
        }
    }

    /// Whether anything is scattered by lobes with a density.
    pub fn has_density(&self) -> bool {
        match self.scatterer {
            Scatterer::Surface { bsdf, .. } => !bsdf.is_dirac() && !bsdf.is_black(),
            Scatterer::Medium { .. } => true,
        }
    }

    /// Whether a density is estimated from photons here.
    pub fn gathers(&self) -> bool {
        match self.scatterer {
            Scatterer::Surface { bsdf, .. } => bsdf.has(LobeKind::Broad),
            Scatterer::Medium { .. } => true,
        }
    }

    /// Whether light may leave by lobes that caustics are made by.
    pub fn has_specular(&self) -> bool {
        match self.scatterer {
            Scatterer::Surface { bsdf, .. } => bsdf.has_specular(),
            Scatterer::Medium { .. } => false,
        }
    }

    /// What is scattered towards `wo` of the radiance from `wi`, per solid angle: f·cos, or the phase function.
    pub fn eval(&self, wi: Vec3) -> Rgb {
        match self.scatterer {
            Scatterer::Surface { bsdf, .. } => bsdf.eval(self.wo, wi) * bsdf.cosine(wi),
            Scatterer::Medium { phase, .. } => Rgb::splat(phase.eval(self.wo, wi)),
        }
    }

    /// What is scattered towards `wi` of each watt that comes along `wo`, per solid angle, on a path from a light.
    pub fn spread(&self, wi: Vec3) -> Rgb {
        match self.scatterer {
            Scatterer::Surface { bsdf, .. } => self.eval(wi) * bsdf.adjoint_factor(self.wo, wi),
            Scatterer::Medium { .. } => self.eval(wi),
        }
    }

    /// The density of `wi` per solid angle, Dirac lobes aside.
    pub fn pdf(&self, wi: Vec3) -> f32 {
        self.pdf_between(self.wo, wi)
    }

    /// The same for a path that comes from another side.
    pub fn pdf_between(&self, wo: Vec3, wi: Vec3) -> f32 {
        match self.scatterer {
            Scatterer::Surface { bsdf, .. } => bsdf.pdf(wo, wi),
            Scatterer::Medium { phase, .. } => phase.eval(wo, wi),
        }
    }

    /// What a ray is in that leaves the vertex.
    pub fn beyond(&self, world: &World, direction: Vec3) -> Surroundings {
        match self.scatterer {
            Scatterer::Surface { hit, .. } => world.cross(self.inside, hit, -self.wo, direction),
            Scatterer::Medium { .. } => self.inside,
        }
    }
}

/// Reflected direct light at a surface towards `wo`, in W/(m²·sr), lights sampled only; glossy lobes, and under a sky
/// all surfaces, also by a ray sampled from the BSDF, weighted by the power heuristic: most of a sky is below the
/// horizon or hidden, and the rest is found as the BSDF weighs it.
pub(crate) fn direct_light(
    world: &World,
    hit: &Hit,
    bsdf: &Bsdf,
    wo: Vec3,
    inside: Surroundings,
    lights: DirectLights,
    sampler: &mut Sampler,
) -> Rgb {
    let lit = Lit { scatterer: Scatterer::Surface { hit, bsdf }, wo, inside };
    if !bsdf.has_glossy_lobe() && !world.has_wide_sky() {
        return sample_lights(world, &lit, lights, Partner::None, sampler);
    }
    let by_lights = sample_lights(world, &lit, lights, Partner::BsdfSample, sampler);
    by_lights + sample_bsdf(world, &lit, hit, bsdf, lights, sampler)
}

/// The part of direct light that lights are sampled for: W/(m²·sr) at a surface, and in a medium the same for
/// each unit of scattering, which is W/(m²·sr) as well.
pub(crate) fn sample_lights(
    world: &World,
    lit: &Lit<'_>,
    lights: DirectLights,
    partner: Partner,
    sampler: &mut Sampler,
) -> Rgb {
    if !world.has_lights_to_ask() {
        return Rgb::BLACK;
    }
    match lights {
        DirectLights::One => {
            let asked = world.ask(&lit.vantage().asker(), sampler.next_1d());
            let Some((light, probability)) = asked else { return Rgb::BLACK };
            one_light(world, lit, light, probability, partner, sampler)
        }
        DirectLights::All => {
            (0..world.light_count()).map(|light| one_light(world, lit, light, 1.0, partner, sampler)).sum()
        }
    }
}

/// The light of one lamp, which was chosen with `probability`.
pub(crate) fn one_light(
    world: &World,
    lit: &Lit<'_>,
    light: usize,
    probability: f32,
    partner: Partner,
    sampler: &mut Sampler,
) -> Rgb {
    let (u, from) = (sampler.next_2d(), lit.vantage());
    let emitter = &world.emitters()[light];
    let Some(incident) = emitter.sample_incident(world.lookup(), from.position(), u) else {
        return Rgb::BLACK;
    };
    if incident.dirac && partner == Partner::BsdfSampleAndPhotons {
        return Rgb::BLACK;
    }
    let scattered = lit.eval(incident.wi) * incident.radiance;
    if scattered.is_black() {
        return Rgb::BLACK;
    }
    let inside = lit.beyond(world, incident.wi);
    let through = world.light_through(from, inside, incident.wi, &incident.source, sampler);
    if through.is_black() {
        return Rgb::BLACK;
    }
    let pdf = incident.pdf_solid_angle * probability;
    let weight = match partner {
        Partner::BsdfSample | Partner::BsdfSampleAndPhotons if !incident.dirac => {
            power_heuristic(pdf, lit.pdf(incident.wi))
        }
        _ => 1.0,
    };
    scattered * through * (weight / pdf)
}

/// The part of [`direct_light`] that a direction is sampled from the BSDF for.
fn sample_bsdf(
    world: &World,
    lit: &Lit<'_>,
    hit: &Hit,
    bsdf: &Bsdf,
    lights: DirectLights,
    sampler: &mut Sampler,
) -> Rgb {
    let (u, u_lobe) = (sampler.next_2d(), sampler.next_1d());
    let Some(sample) = bsdf.sample(lit.wo, u, u_lobe, Transport::Radiance) else { return Rgb::BLACK };
    let from = Asker::on(&hit.point);
    let mut inside = lit.beyond(world, sample.wi);
    let mut ray = leave(&hit.point, sample.wi);
    let (mut seen, mut through) = (Rgb::BLACK, Rgb::WHITE);
    loop {
        let hit = world.intersect(&ray);
        if let Some(matter) = world.matter(inside) {
            through *= matter.transmittance(&ray, hit.map_or(f32::INFINITY, |h| h.t), sampler);
        }
        let Some(hit) = hit else {
            seen += through * sky_by_bsdf(world, &from, sample.wi, sample.pdf_solid_angle, lights);
            return sample.weight * seen;
        };
        seen += world.emitted(&hit, -ray.direction).map_or(Rgb::BLACK, |(light, radiance)| {
            let pdf = light_pdf(world, light, &from, &hit.point, lights);
            through * radiance * power_heuristic(sample.pdf_solid_angle, pdf)
        });
        if !world.bsdf_within(&hit, -ray.direction, &inside).is_null() {
            return sample.weight * seen;
        }
        inside = world.cross(inside, &hit, ray.direction, ray.direction);
        ray = leave(&hit.point, ray.direction);
    }
}

/// Density per solid angle, at `from`, with which next event estimation finds a point of area light
/// `light`, the choice of the light included.
pub(crate) fn light_pdf(
    world: &World,
    light: usize,
    from: &Asker,
    point: &SurfacePoint,
    lights: DirectLights,
) -> f32 {
    world.emitters()[light].pdf_of_surface(from.position, point) * choice(world, light, from, lights)
}

/// Radiance of the sky in a direction sampled from a BSDF at `from`, each light weighted by the power heuristic.
pub(crate) fn sky_by_bsdf(
    world: &World,
    from: &Asker,
    direction: Vec3,
    pdf_bsdf: f32,
    lights: DirectLights,
) -> Rgb {
    let textures = &world.scene().textures;
    world
        .skies()
        .map(|(i, emitter)| {
            let pdf = emitter.pdf_of_sky(direction) * choice(world, i, from, lights);
            emitter.sky_radiance(textures, direction) * power_heuristic(pdf_bsdf, pdf)
        })
        .sum()
}

/// The probability with which next event estimation at `from` asks a light.
pub(crate) fn choice(world: &World, light: usize, from: &Asker, lights: DirectLights) -> f32 {
    match lights {
        DirectLights::One if world.has_lights_to_ask() => world.chance_of_asking(light, from),
        DirectLights::One | DirectLights::All => 1.0,
    }
}
