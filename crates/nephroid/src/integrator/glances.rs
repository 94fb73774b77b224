//! Lamps and sky as the camera sees them, straight or in mirrors and glass.

use super::{LightPart, Probe};
use crate::color::Rgb;
use crate::light::Emitter;
use crate::material::{LobeKind, Transport, segments_by};
use crate::math::{Ray, Vec3};
use crate::sampling::Sampler;
use crate::transport::{PixelSample, survival};
use crate::world::{Hit, Surroundings, World, leave};

/// Places of a pixel that are looked at for each camera sample, its own among them.
const GLANCES: u32 = 4;

/// What such a ray costs of one that is shaded, too.
pub(crate) const COST_OF_GLANCE: f64 = 0.5;

/// The throughput below which a way is followed by chance only.
const LEAST: f32 = 1.0 / 64.0;

/// Whether images of lamps can be small and bright.
pub(crate) fn are_worth_it(world: &World) -> bool {
    world.has_dirac_surfaces() && !world.emitters().iter().all(Emitter::is_dirac)
}

/// The light of lamps that a ray meets, or of the sky.
pub(crate) fn seen(world: &World, hit: Option<&Hit>, wo: Vec3) -> Rgb {
    match hit {
        Some(hit) => world.emitted(hit, wo).map_or(Rgb::BLACK, |(_, light)| light),
        None => world.sky(-wo),
    }
}

/// The light of lamps and sky that the pixel of a camera sample shows straight or by way of specular surfaces.
///
/// The image of a lamp in a curved mirror is often far smaller than a pixel and a thousand times as bright as what is around
/// it: a sample that meets it is a white speck. No photon can tell of it, but rays that ask for nothing else are cheap, for
/// most of them end at the first surface. Where a surface reflects and refracts, both ways are followed, and by chance only what
/// carries little: a faint image is seen as faint, and not rarely and bright.
///
/// Where a filter is negative somewhere, samples have weights of either sign that are divided by their sum, and only the
/// sample's own place goes with its weight.
pub(crate) fn glance(
    world: &World,
    sample: &PixelSample<'_>,
    max_depth: Option<u32>,
    probe: &mut impl Probe,
) -> Rgb {
    let glances = if world.scene().film.filter.has_negative_lobes() { 1 } else { GLANCES };
    let from = |glance| {
        let number = sample.index * u64::from(GLANCES) + u64::from(glance);
        let mut other = sample.beside(world, number);
        let ray = if glance == 0 { sample.ray } else { other.ray };
        let inside = world.camera_surroundings();
        let throughput = Rgb::splat(1.0 / glances as f32);
        let way = Way { ray, inside, throughput, whole: throughput.mean(), scale: 1.0, depth: 1 };
        way.emitted(world, max_depth, &mut other.sampler, probe)
    };
    (0..glances).map(from).sum()
}

/// A ray that looks for lamps.
#[derive(Clone, Copy)]
struct Way {
    ray: Ray,
    inside: Surroundings,
    throughput: Rgb,
    /// What it carries at the lens.
    whole: f32,
    /// What refraction so far has multiplied radiance by.
    scale: f32,
    /// Segments up to the next surface.
    depth: u32,
}

impl Way {
    /// The light of lamps on it and on its branches.
    fn emitted(
        mut self,
        world: &World,
        max_depth: Option<u32>,
        sampler: &mut Sampler,
        probe: &mut impl Probe,
    ) -> Rgb {
        let mut found = Rgb::BLACK;
        while max_depth.is_none_or(|max| self.depth <= max) {
            let hit = world.intersect(&self.ray);
            probe.glance();
            if let Some(matter) = world.matter(self.inside) {
                let end = hit.map_or(f32::INFINITY, |hit| hit.t);
                self.throughput *= matter.transmittance(&self.ray, end, sampler);
            }
            let wo = -self.ray.direction;
            let light = seen(world, hit.as_ref(), wo);
            if !light.is_black() {
                found += self.throughput * light;
                probe.carry(self.throughput);
                probe.light(LightPart::Emitted, light);
            }
            let Some(hit) = hit else { break };
            let bsdf = world.meet(&hit, wo, &mut self.inside, &mut self.throughput, sampler);
            let pass = |wi| (leave(&hit.point, wi), world.cross(self.inside, &hit, -wo, wi));
            if bsdf.is_null() {
                (self.ray, self.inside) = pass(-wo);
                continue;
            }
            if !bsdf.has(LobeKind::Dirac) {
                break;
            }
            let mut branches = bsdf.dirac_lobes(wo, Transport::Radiance).map(|lobe| {
                let lobe = lobe?;
                let throughput = self.throughput * lobe.weight;
                let scale = self.scale * lobe.radiance_scale;
                let carried = throughput.mean() / (scale * self.whole);
                let unending = survival(self.throughput, self.throughput, self.depth - 1);
                let q = (carried / LEAST).min(1.0) * unending;
                let (ray, inside) = pass(lobe.wi);
                let depth = self.depth + segments_by(wo, lobe.wi);
                let on = Self { ray, inside, throughput: throughput / q, scale, depth, ..self };
                (sampler.next_1d() < q).then_some(on)
            });
            // The weaker one is what recurs.
            let carried = |way: &Option<Self>| way.map_or(0.0, |way| way.throughput.mean());
            branches.sort_by(|a, b| carried(b).total_cmp(&carried(a)));
            if let Some(weaker) = branches[1] {
                found += weaker.emitted(world, max_depth, sampler, probe);
            }
            match branches[0] {
                Some(stronger) => self = stronger,
                None => break,
            }
        }
        found
    }
}
