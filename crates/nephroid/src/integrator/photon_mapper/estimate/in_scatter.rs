//! What a medium sends back along a ray: light scattered once, found by rays to the lights, and all other, found by
//! photons along the way.

use super::equiangular::Equiangular;
use super::{DirectSource, PhotonMapper, Tools};
use crate::color::Rgb;
use crate::integrator::photon_mapper::VolumeIndex;
use crate::integrator::photon_mapper::config::VolumeEstimate;
use crate::integrator::{FromVolume, MediumLight, Passed, Probe};
use crate::light::Asker;
use crate::math::{Ray, Vec3};
use crate::medium::{Matter, Profile};
use crate::photon_map::Beam;
use crate::sampling::Sampler;
use crate::transport::{DirectLights, Fog, Lit, Partner, Scatterer, one_light};
use crate::world::Surroundings;

/// The part of a ray that lies in one medium.
pub(super) struct Segment<'a> {
    pub ray: &'a Ray,
    /// Where it ends, which may be infinitely far.
    pub end: f32,
    pub matter: &'a Matter,
    pub inside: Surroundings,
    /// Segments from the lens to its end.
    pub depth: u32,
    /// Whether it begins and ends where nothing but the medium does. A photon near such an end is seen beside it and
    /// counts in full, else the medium would be dark at its sides.
    pub open: [bool; 2],
}

impl Segment<'_> {
    /// The number of the medium as photons have it.
    pub fn medium(&self) -> u16 {
        self.inside.medium().map_or(u16::MAX, |medium| medium.index() as u16)
    }

    /// σ_s at a point of it, in 1/m.
    fn scattering(&self, position: Vec3) -> Rgb {
        self.matter.sigma_t(position) * self.matter.albedo(position)
    }
}

impl PhotonMapper<'_> {
    /// The radiance that a medium adds to a ray from its way, and the share of what lies behind that comes
    /// through. What maps tell counts for `samples` camera samples; for none they are not read.
    pub(super) fn through_medium<P: Probe>(
        &self,
        segment: &Segment<'_>,
        samples: u32,
        sampler: &mut Sampler,
        tools: &mut Tools<'_, P>,
    ) -> (Rgb, Rgb) {
        let &Segment { ray, end, matter, .. } = segment;
        let mut profile = std::mem::take(&mut tools.profile);
        matter.profile_into(ray, end, &mut profile);
        let through = profile.transmittance(end);
        let mut light = MediumLight::default();
        if self.config.shows_media() && self.config.fog == Fog::Ambient {
            light.ambient = self.ambient(segment, through);
        } else if self.config.shows_media() {
            if matter.emits() {
                light.emitted = matter.emitted(ray, end, sampler);
            }
            if self.config.single_scatter == DirectSource::Rays && self.fits(segment.depth + 1) {
                light.single = self.single_scatter(segment, &profile, sampler);
            }
            if samples > 0 {
                let [all, caustics] = &self.maps.volumes;
                let mut read = |map| {
                    let FromVolume { count, radiance } =
                        self.scattered(map, segment, &profile, sampler, tools);
                    FromVolume { count, radiance: radiance * samples as f32 }
                };
                (light.volume, light.volume_caustic) = (read(all), read(caustics));
            }
        }
        tools.profile = profile;
        let medium = segment.inside.medium();
        tools.probe.medium(&Passed {
            medium,
            length: end,
            depth: segment.depth,
            light,
            transmittance: through,
        });
        (light.total(), through)
    }

    /// σ_s L_i (1 − e^(−σ_t d)) / σ_t, the report's first method, with L_i as the medium says.
    fn ambient(&self, segment: &Segment<'_>, through: Rgb) -> Rgb {
        let albedo = segment.matter.albedo(segment.ray.origin);
        segment.matter.ambient() * albedo * (Rgb::WHITE - through)
    }

    /// Light scattered once: lights are asked at a point that is sampled by equiangular density for one light
    /// (Kulla and Fajardo 2012, doi 10.1111/j.1467-8659.2012.03148.x) or by transmittance, as a mixture.
    fn single_scatter(&self, segment: &Segment<'_>, profile: &Profile, sampler: &mut Sampler) -> Rgb {
        if !self.world.has_lights_to_ask() {
            return Rgb::BLACK;
        }
        match self.config.direct_lights {
            DirectLights::One => {
                let u = sampler.next_1d();
                let on_the_way = || {
                    let t = profile.sample(sampler.next_1d(), 0.0, segment.end);
                    Asker::in_space(segment.ray.at(t))
                };
                let asked = self.world.ask_along(on_the_way, u);
                let Some((light, probability)) = asked else { return Rgb::BLACK };
                self.scattered_once(segment, profile, light, probability, sampler)
            }
            DirectLights::All => (0..self.world.light_count())
                .map(|light| self.scattered_once(segment, profile, light, 1.0, sampler))
                .sum(),
        }
    }

    fn scattered_once(
        &self,
        segment: &Segment<'_>,
        profile: &Profile,
        light: usize,
        probability: f32,
        sampler: &mut Sampler,
    ) -> Rgb {
        let emitter = &self.world.emitters()[light];
        let (u, u_technique) = (sampler.next_1d(), sampler.next_1d());
        let Some([from, to]) = emitter.lit_part(segment.ray, segment.end) else { return Rgb::BLACK };
        let around = emitter.middle().map(|center| Equiangular::new(segment.ray, from, to, center));
        let by_angle = if around.is_some() { 0.5 } else { 0.0 };
        let t = match &around {
            Some(around) if u_technique < by_angle => around.sample(u).clamp(from, to),
            _ => profile.sample(u, from, to),
        };
        let pdf = by_angle * around.map_or(0.0, |around| around.pdf(t))
            + (1.0 - by_angle) * profile.pdf(t, from, to);
        let position = segment.ray.at(t);
        let weight = profile.transmittance(t) * segment.scattering(position) / pdf;
        if pdf <= 0.0 || weight.is_black() || !weight.is_finite() {
            return Rgb::BLACK;
        }
        let scatterer = Scatterer::Medium { position, phase: segment.matter.phase() };
        let lit = Lit { scatterer, wo: -segment.ray.direction, inside: segment.inside };
        weight * one_light(self.world, &lit, light, probability, Partner::None, sampler)
    }

    /// The light that a map holds along a ray.
    fn scattered<P: Probe>(
        &self,
        map: &VolumeIndex,
        segment: &Segment<'_>,
        profile: &Profile,
        sampler: &mut Sampler,
        tools: &mut Tools<'_, P>,
    ) -> FromVolume {
        let (wo, phase) = (-segment.ray.direction, segment.matter.phase());
        let kernel = self.config.kernel;
        let (mut count, mut sum) = (0, Rgb::BLACK);
        match map {
            VolumeIndex::Points(map) if map.is_empty() => {}
            VolumeIndex::Points(map) => match self.config.volume_estimate {
                VolumeEstimate::Beam => {
                    let largest =
                        map.default_max_radius_in(segment.medium(), self.config.volume_neighbours());
                    let margin = largest * self.maps.blur.factor(2);
                    let [before, beyond] = segment.open.map(|open| if open { margin } else { 0.0 });
                    let ray = Ray::new(segment.ray.at(-before), segment.ray.direction);
                    let length = before + segment.end + beyond;
                    map.along(&ray, length, segment.medium(), kernel, |t, photon, weight| {
                        if self.fits(segment.depth + u32::from(photon.depth)) {
                            let scattered = photon.power * (phase.eval(wo, photon.wi) * weight);
                            sum += profile.transmittance((t - before).clamp(0.0, segment.end)) * scattered;
                            count += 1;
                        }
                    });
                }
                VolumeEstimate::March => return self.march(map, segment, profile, sampler, tools),
                VolumeEstimate::MarchReport => return self.march_report(map, segment, tools),
            },
            VolumeIndex::Beams(map) => {
                map.along(segment.ray, segment.end, segment.medium(), kernel, |t, s, beam, weight| {
                    if self.fits(segment.depth + u32::from(beam.depth)) {
                        let reached = reached(segment.matter, beam, s);
                        let scattered = segment.scattering(segment.ray.at(t)) * beam.power * reached;
                        sum +=
                            profile.transmittance(t) * scattered * (phase.eval(wo, -beam.direction) * weight);
                        count += 1;
                    }
                });
            }
        }
        FromVolume { count, radiance: sum }
    }
}

/// The share of a beam's power that is left after so long a way, over the chance that the beam is so long.
fn reached(matter: &Matter, beam: &Beam, s: f32) -> Rgb {
    let left = matter.attenuation(s);
    if beam.long {
        return left;
    }
    // It ended where light collided that one of the channels was chosen for, by what it carries.
    let chance = (beam.power * left).sum() / beam.power.sum();
    if chance > 0.0 { left / chance } else { Rgb::BLACK }
}
