//! From the lens over surfaces that are specular, or nearly so, to those where densities are estimated.

use super::in_scatter::Segment;
use super::{PhotonMapper, Tools, Vertex, Way};
use crate::color::Rgb;
use crate::integrator::glances::seen;
use crate::integrator::{Components, LightPart, LookUp, MapName, Met, Probe};
use crate::light::Asker;
use crate::material::{Bsdf, BsdfSample, LobeKind, Transport, segments_by};
use crate::math::Vec3;
use crate::sampling::{Sampler, power_heuristic};
use crate::transport::{
    Lit, Partner, PixelSample, Scatterer, light_pdf, sample_lights, sky_by_bsdf, survival,
};
use crate::world::Hit;

/// Surfaces that both reflect and refract, along a camera path, at which both lobes are followed, before one
/// is chosen by chance: the reflection in a glass ball then shows no noise, at up to four times the rays.
const SPLITS: u32 = 2;

/// A pixel's footprint on a surface grows with its slope as if the cosine were at least this: it is round.
const MIN_COSINE: f32 = 0.25;

/// The way of a camera path that was split at specular surfaces.
#[derive(Clone, Copy)]
pub(super) struct Branch {
    /// Tells ways apart: a leading one, then one bit for each split.
    pub number: u64,
    /// The share of what all ways carry that this one does.
    pub share: f32,
}

impl Branch {
    const WHOLE: Self = Self { number: 1, share: 1.0 };

    /// The ways of two lobes.
    fn split(self, lobes: [&BsdfSample; 2]) -> [Self; 2] {
        let carried = lobes.map(|lobe| lobe.weight.mean() / lobe.radiance_scale);
        [0, 1].map(|side| Self {
            number: self.number << 1 | side as u64,
            share: self.share * carried[side] / (carried[0] + carried[1]),
        })
    }

    /// What goes on by specular lobes of a surface that has others, too.
    fn beyond(self, share: f32) -> Self {
        // However long the way, its number stays above those of ways that may still be split.
        let number = self.number << 1 | self.number & 1 << (u64::BITS - 1);
        Self { number, share: self.share * share }
    }
}

/// What lamps and sky that a camera path meets next count for.
#[derive(Clone, Copy)]
enum Lamps {
    /// Nothing: rays of their own look for them.
    Glanced,
    /// All.
    Whole,
    /// What they leave to a direction that was sampled with a density where they were asked for, too.
    Shared { from: Asker, pdf_solid_angle: f32 },
}

/// A path from the camera.
pub(super) struct Track {
    way: Way,
    throughput: Rgb,
    /// Segments up to the next surface.
    depth: u32,
    branch: Branch,
    lamps: Lamps,
    /// Whether it has met nothing but Dirac surfaces.
    direct: bool,
    /// Whether it has gone on by a lobe that is nearly a Dirac.
    sharp: bool,
}

impl Track {
    /// A path that begins; `glances` tells whether lamps are looked for by rays of their own.
    pub fn new(way: Way, glances: bool) -> Self {
        let lamps = if glances { Lamps::Glanced } else { Lamps::Whole };
        let (throughput, branch) = (Rgb::WHITE, Branch::WHOLE);
        Self { way, throughput, depth: 1, branch, lamps, direct: true, sharp: false }
    }
}

impl PhotonMapper<'_> {
    /// Follows a path from the camera over specular surfaces, and shades where it meets others.
    ///
    /// Lobes that are nearly Diracs are followed as well, as by a path tracer: lamps are asked for their light there, and share
    /// it with the ray that goes on. Light that Dirac lamps send there by way of specular surfaces is beyond that, and comes from
    /// the map of caustics, blurred: at the first such surface, and so from then on these lamps are not asked any more.
    pub(super) fn trace<P: Probe>(
        &self,
        mut track: Track,
        sample: &mut PixelSample,
        tools: &mut Tools<'_, P>,
        out: &mut Components,
    ) {
        tools.probe.begin(None, Rgb::WHITE);
        while self.fits(track.depth) {
            tools.probe.carry(track.throughput);
            let hit = self.world.intersect(&track.way.ray);
            self.medium_before(&mut track, hit.as_ref(), sample, tools, out);
            let wo = -track.way.ray.direction;
            self.lamp_met(&track, hit.as_ref(), wo, tools, out);
            let Some(hit) = hit else { return };
            let Track { way, throughput, .. } = &mut track;
            let bsdf = self.world.meet(&hit, wo, &mut way.inside, throughput, &mut sample.sampler);
            tools.probe.carry(track.throughput);
            if bsdf.is_null() {
                track.way = track.way.pass(self.world, &hit, track.way.ray.direction);
                continue;
            }
            let Track { way, throughput, depth, branch, direct: first, .. } = track;
            tools.probe.surface(&Met { hit: &hit, bsdf: &bsdf, wo, depth, throughput, first });
            let across = self.world.camera().pixel_radius(way.before + hit.t);
            let footprint = across / wo.dot(hit.point.ng).abs().max(MIN_COSINE).sqrt();
            // Most surfaces are of one class, and stand for its part as they are.
            let parts = (bsdf.has(LobeKind::Broad) && bsdf.has_specular())
                .then(|| [bsdf.part(LobeKind::Broad), bsdf.without_broad()]);
            let [broad, specular] = parts.as_ref().map_or([&bsdf; 2], <[Bsdf; 2]>::each_ref);
            let vertex = Vertex {
                hit: &hit,
                bsdf: broad,
                wo,
                depth,
                inside: way.inside,
                footprint,
                dirac_lamps: false,
            };
            if bsdf.has(LobeKind::Broad) {
                self.shade(&vertex, throughput, branch, sample, tools, out);
                tools.probe.begin(None, throughput);
            }
            if !bsdf.has_specular() {
                return;
            }
            if bsdf.has(LobeKind::Sharp) {
                let vertex = Vertex { bsdf: specular, dirac_lamps: true, ..vertex };
                self.highlights(&vertex, &track, sample, tools, out);
            }
            if bsdf.is_dirac()
                && let [Some(a), Some(b)] = bsdf.dirac_lobes(wo, Transport::Radiance)
                && branch.number < 1 << SPLITS
            {
                for (lobe, branch) in [a, b].into_iter().zip(branch.split([&a, &b])) {
                    let way = way.pass(self.world, &hit, lobe.wi);
                    let depth = depth + segments_by(wo, lobe.wi);
                    let throughput = throughput * lobe.weight;
                    let lamps = self.lamps_after(&lobe, &hit, track.sharp);
                    self.trace(Track { way, throughput, depth, branch, lamps, ..track }, sample, tools, out);
                }
                return;
            }
            let Some((next, carried)) = scatter(specular, wo, throughput, depth - 1, &mut sample.sampler)
            else {
                return;
            };
            if !bsdf.is_dirac() {
                let others = if parts.is_some() { broad.albedo().mean() } else { 0.0 };
                let own = next.weight.mean() / next.radiance_scale;
                track.branch = branch.beyond(own / (own + others));
                track.direct = false;
            }
            track.sharp |= next.lobe == LobeKind::Sharp;
            track.lamps = self.lamps_after(&next, &hit, track.sharp);
            (track.way, track.throughput) = (way.pass(self.world, &hit, next.wi), carried);
            track.depth += segments_by(wo, next.wi);
        }
    }

    /// The light and the transmittance of the medium before the next surface.
    fn medium_before<P: Probe>(
        &self,
        track: &mut Track,
        hit: Option<&Hit>,
        sample: &mut PixelSample,
        tools: &mut Tools<'_, P>,
        out: &mut Components,
    ) {
        let Track { way, depth, .. } = *track;
        let Some(matter) = self.world.matter(way.inside) else { return };
        let end = hit.map_or(f32::INFINITY, |hit| hit.t);
        let open = [way.entered, hit.is_some_and(|hit| self.world.ends_medium(hit))];
        let segment = Segment { ray: &way.ray, end, matter, inside: way.inside, depth, open };
        let samples = if sample.index.is_multiple_of(u64::from(self.stride)) { self.stride } else { 0 };
        let (seen, through) = self.through_medium(&segment, samples, &mut sample.sampler, tools);
        out.medium += track.throughput * seen;
        track.throughput *= through;
        tools.probe.carry(track.throughput);
    }

    /// What lamps and sky count for behind a lobe that is specular.
    fn lamps_after(&self, next: &BsdfSample, hit: &Hit, sharp: bool) -> Lamps {
        match next.lobe {
            LobeKind::Dirac if self.glances && !sharp => Lamps::Glanced,
            LobeKind::Dirac => Lamps::Whole,
            LobeKind::Sharp | LobeKind::Broad => {
                Lamps::Shared { from: Asker::on(&hit.point), pdf_solid_angle: next.pdf_solid_angle }
            }
        }
    }

    /// The light of a lamp or the sky that a path comes to.
    fn lamp_met<P: Probe>(
        &self,
        track: &Track,
        hit: Option<&Hit>,
        wo: Vec3,
        tools: &mut Tools<'_, P>,
        out: &mut Components,
    ) {
        let lights = self.config.direct_lights;
        let light = match (track.lamps, hit) {
            (Lamps::Glanced, _) => return,
            (Lamps::Whole, _) => seen(self.world, hit, wo),
            (Lamps::Shared { from, pdf_solid_angle }, None) => {
                sky_by_bsdf(self.world, &from, -wo, pdf_solid_angle, lights)
            }
            (Lamps::Shared { from, pdf_solid_angle }, Some(hit)) => {
                self.world.emitted(hit, wo).map_or(Rgb::BLACK, |(light, radiance)| {
                    let pdf = light_pdf(self.world, light, &from, &hit.point, lights);
                    radiance * power_heuristic(pdf_solid_angle, pdf)
                })
            }
        };
        let (part, sum) = match track.lamps {
            _ if !track.sharp => (LightPart::Emitted, &mut out.emitted),
            Lamps::Shared { .. } if self.config.shows_direct() => (LightPart::Direct, &mut out.direct),
            Lamps::Whole if self.config.shows_caustics() => (LightPart::Caustic, &mut out.caustic),
            _ => return,
        };
        *sum += track.throughput * light;
        tools.probe.light(part, light);
    }

    /// The light of lamps in a lobe that is nearly a Dirac, as far as the ray that goes on does not find it.
    fn highlights<P: Probe>(
        &self,
        vertex: &Vertex<'_>,
        track: &Track,
        sample: &mut PixelSample,
        tools: &mut Tools<'_, P>,
        out: &mut Components,
    ) {
        let Vertex { hit, bsdf, wo, inside, depth, .. } = *vertex;
        if self.config.shows_direct() && self.fits(depth + 1) {
            let partner = if track.sharp { Partner::BsdfSampleAndPhotons } else { Partner::BsdfSample };
            let lit = Lit { scatterer: Scatterer::Surface { hit, bsdf }, wo, inside };
            let lights = self.config.direct_lights;
            let direct = sample_lights(self.world, &lit, lights, partner, &mut sample.sampler);
            out.direct += track.throughput * direct;
            tools.probe.light(LightPart::Direct, direct);
        }
        let reads = sample.index.is_multiple_of(u64::from(self.stride)) && !track.sharp;
        if self.config.shows_caustics() && reads && self.world.has_dirac_lamps() {
            let throughput = track.throughput * self.stride as f32;
            tools.probe.carry(throughput);
            let wanted = LookUp { map: MapName::Caustic, direct: None, other: Some(LightPart::Caustic) };
            let caustic = self.look_up(&wanted, vertex, self.caustic_bandwidth, tools).1;
            out.caustic += throughput * caustic;
            tools.probe.carry(track.throughput);
        }
    }
}

/// Samples the next direction of a camera path, with roulette.
pub(super) fn scatter(
    bsdf: &Bsdf,
    wo: Vec3,
    throughput: Rgb,
    bounces: u32,
    sampler: &mut Sampler,
) -> Option<(BsdfSample, Rgb)> {
    let (u, u_lobe, u_survive) = (sampler.next_2d(), sampler.next_1d(), sampler.next_1d());
    let next = bsdf.sample(wo, u, u_lobe, Transport::Radiance)?;
    let carried = throughput * next.weight;
    let q = survival(throughput, carried / next.radiance_scale, bounces);
    (u_survive < q).then(|| (next, carried / q))
}
