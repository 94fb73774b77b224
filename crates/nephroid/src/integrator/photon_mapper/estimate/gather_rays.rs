//! Gather rays: what surfaces that the camera does not see send to those that it does.

use std::f32::consts::PI;

use super::in_scatter::Segment;
use super::trace::scatter;
use super::{DirectSource, Facing, PhotonMapper, Tools, Vertex, Way};
use crate::color::Rgb;
use crate::integrator::{LightPart, LookUp, MapName, Met, Probe};
use crate::material::{Bsdf, LobeKind, Transport, segments_by};
use crate::math::{Ray, Vec3};
use crate::photon_map::Bandwidth;
use crate::sampling::Sampler;

/// The part of the gather rays that are sent where no photons are near.
const WEIGHT_WHERE_DARK: f32 = 0.25;

/// Surfaces that a gather ray may go on from because they are too near to be seen through the map.
const MAX_NEAR_SURFACES: u32 = 8;

impl PhotonMapper<'_> {
    /// The part of the gather rays that are worth sending, as far as that is known before: all where
    /// indirect light is half of all or more, and on one way of a split path its `share` of that.
    pub(super) fn weight_of_gathering(
        &self,
        bsdf: &Bsdf,
        guide: Option<&Facing<'_>>,
        beside: Rgb,
        share: f32,
    ) -> f32 {
        if !self.config.spares_gather_rays() {
            return 1.0;
        }
        let Some(guide) = guide else { return share * WEIGHT_WHERE_DARK };
        let albedo = bsdf.albedo();
        let gathered = (albedo * guide.irradiance).mean() / PI;
        let light = gathered + beside.mean();
        share * if light > 0.0 { (2.0 * gathered / light).min(1.0) } else { 1.0 }
    }

    /// What a gather ray brings from where it lands: all of the light, or from near by what no ray that
    /// goes on from there will bring. `sharp` is the share for which it brings caustics, and `throughput`
    /// what reaches the surface that it left.
    fn light_at<P: Probe>(
        &self,
        vertex: &Vertex<'_>,
        far: bool,
        sharp: Rgb,
        throughput: Rgb,
        sampler: &mut Sampler,
        tools: &mut Tools<'_, P>,
    ) -> Rgb {
        let mut light = Rgb::BLACK;
        tools.probe.carry(throughput);
        if self.config.direct == DirectSource::Rays {
            let direct = self.direct(vertex, sampler);
            light += direct;
            tools.probe.light(LightPart::Global, direct);
        }
        let global = Some(LightPart::Global);
        if !sharp.is_black() {
            tools.probe.carry(throughput * sharp);
            let wanted = LookUp { map: MapName::Caustic, direct: None, other: global };
            light += sharp * self.look_up(&wanted, vertex, self.caustic_bandwidth, tools).1;
            tools.probe.carry(throughput);
        }
        if far || self.config.direct == DirectSource::Map {
            let bandwidth = Bandwidth::Fixed { radius: self.global_radius };
            let wanted = LookUp { map: MapName::Global, direct: global, other: global.filter(|_| far) };
            let (direct, other) = self.look_up(&wanted, vertex, bandwidth, tools);
            light += if far { direct + other } else { direct };
        }
        if !far {
            light += self.unseen(vertex, tools);
        }
        light
    }

    /// The light of caustics on other surfaces, which gather rays leave out: a small bright caustic
    /// that few of them chance upon makes white specks, and its photons one bounce on do not. And light that
    /// media send to the surface.
    pub(super) fn unseen<P: Probe>(&self, vertex: &Vertex<'_>, tools: &mut Tools<'_, P>) -> Rgb {
        let part = vertex.bsdf.has_glossy_lobe().then(|| vertex.bsdf.diffuse_part());
        let smooth = Vertex { bsdf: part.as_ref().unwrap_or(vertex.bsdf), ..*vertex };
        let wanted = LookUp { map: MapName::Afterglow, direct: None, other: Some(LightPart::Global) };
        let afterglow = self.look_up(&wanted, &smooth, self.afterglow_bandwidth, tools).1;
        // Light from media comes from everywhere, and is smooth on rough surfaces; glossy lobes see it by their rays.
        let wanted = LookUp { map: MapName::Haze, ..wanted };
        afterglow + self.look_up(&wanted, &smooth, self.haze_bandwidth, tools).1
    }

    /// One gather ray: on over specular surfaces to the first that is not, whose direct and global light
    /// it brings home, and its caustics as far as it was sent by a glossy lobe: the others come by
    /// [`Self::unseen`], and so does what media send to the surface that it left. Of those on its way it brings only
    /// a glossy lobe's share. Emission on the way is direct light's and the caustic map's.
    /// Where that surface is nearer than the map can resolve, a ray goes on from it in place of the
    /// look-up; corners stay as bright as they are.
    pub(super) fn gather_ray<P: Probe>(
        &self,
        vertex: &Vertex<'_>,
        guide: Option<&Facing<'_>>,
        sampler: &mut Sampler,
        tools: &mut Tools<'_, P>,
    ) -> Rgb {
        let mut found = Rgb::BLACK;
        let Some((direction, mut throughput)) = start_gather(vertex, guide, sampler) else {
            return found;
        };
        let before = Way {
            ray: Ray::new(vertex.point().position, -vertex.wo),
            inside: vertex.inside,
            entered: false,
            before: 0.0,
        };
        let mut way = before.pass(self.world, vertex.hit, direction);
        // The share that a glossy lobe has in the last surface's reflection: through it caustics are seen
        // as they are, and the rest of that surface has them by its afterglow.
        let mut sharp = glossy_share(vertex.bsdf, vertex.wo, direction);
        let mut depth = vertex.depth + 1;
        let (mut distance, mut near) = (0.0, 0);
        // A surface at the last segment can still reflect nothing: light needs one more.
        // What media give off and rays find in them needs no more; surfaces reflect only with one segment more.
        let more = |depth| self.fits(depth + 1) || (self.world.has_media() && self.fits(depth));
        while more(depth) {
            let hit = self.world.intersect(&way.ray);
            if let Some(matter) = self.world.matter(way.inside) {
                let end = hit.map_or(f32::INFINITY, |hit| hit.t);
                let open = [way.entered, hit.is_some_and(|hit| self.world.ends_medium(&hit))];
                let segment = Segment { ray: &way.ray, end, matter, inside: way.inside, depth, open };
                if sharp.is_black() {
                    throughput *= matter.transmittance(&way.ray, end, sampler);
                } else {
                    tools.probe.carry(throughput * sharp);
                    // The sample that sent the ray counts for others already.
                    let (seen, through) = self.through_medium(&segment, 1, sampler, tools);
                    found += throughput * sharp * seen;
                    throughput *= through;
                }
            }
            let Some(hit) = hit.filter(|_| self.fits(depth + 1)) else { break };
            distance += hit.t;
            let wo = -way.ray.direction;
            let bsdf = self.world.meet(&hit, wo, &mut way.inside, &mut throughput, sampler);
            if bsdf.is_null() {
                way = way.pass(self.world, &hit, way.ray.direction);
                continue;
            }
            tools.probe.surface(&Met { hit: &hit, bsdf: &bsdf, wo, depth, throughput, first: false });
            let mut far = false;
            if bsdf.has(LobeKind::Broad) {
                let part = bsdf.has_specular().then(|| bsdf.part(LobeKind::Broad));
                let there = Vertex {
                    hit: &hit,
                    bsdf: part.as_ref().unwrap_or(&bsdf),
                    wo,
                    depth,
                    inside: way.inside,
                    footprint: 0.0,
                    dirac_lamps: false,
                };
                far = distance >= 2.0 * self.global_radius || near == MAX_NEAR_SURFACES;
                found += throughput * self.light_at(&there, far, sharp, throughput, sampler, tools);
                if far && !bsdf.has_specular() {
                    break;
                }
                near += 1;
                distance = 0.0;
            }
            let Some((next, carried)) = scatter(&bsdf, wo, throughput, depth - 1, sampler) else {
                break;
            };
            let specular = next.is_specular();
            if far && !specular {
                break;
            }
            if !specular {
                // Where nothing is gathered there is no afterglow, and the ray brings all caustics.
                let gathers = self.gather_rays.is_some();
                sharp =
                    if gathers { glossy_share(&bsdf.part(LobeKind::Broad), wo, next.wi) } else { Rgb::WHITE };
            }
            (way, throughput) = (way.pass(self.world, &hit, next.wi), carried);
            depth += segments_by(wo, next.wi);
        }
        found
    }
}

/// The first segment of a gather ray, with its f·cos/pdf: by the guide, by the BSDF, or where there is
/// a glossy lobe by an equal mixture of both.
fn start_gather(
    vertex: &Vertex<'_>,
    guide: Option<&Facing<'_>>,
    sampler: &mut Sampler,
) -> Option<(Vec3, Rgb)> {
    let Vertex { bsdf, wo, .. } = *vertex;
    let (u, u_lobe, u_technique) = (sampler.next_2d(), sampler.next_1d(), sampler.next_1d());
    let guide_share = match guide {
        None => 0.0,
        Some(_) if bsdf.has_glossy_lobe() || bsdf.transmits() => 0.5,
        Some(_) => 1.0,
    };
    let (wi, pdf_of_guide) = match guide {
        Some(guide) if u_technique < guide_share => guide.sample(u),
        _ => {
            let wi = bsdf.sample(wo, u, u_lobe, Transport::Radiance)?.wi;
            (wi, guide.map_or(0.0, |g| g.pdf(wi)))
        }
    };
    let pdf = guide_share * pdf_of_guide + (1.0 - guide_share) * bsdf.pdf(wo, wi);
    let weight = bsdf.eval(wo, wi) * (bsdf.cosine(wi) / pdf);
    (pdf > 0.0 && !weight.is_black()).then_some((wi, weight))
}

/// The share of a BSDF that is in its glossy lobe.
fn glossy_share(bsdf: &Bsdf, wo: Vec3, wi: Vec3) -> Rgb {
    if !bsdf.has_glossy_lobe() {
        return Rgb::BLACK;
    }
    let share = |part: f32, whole: f32| if whole > 0.0 { part / whole } else { 0.0 };
    bsdf.glossy_part().eval(wo, wi).zip(bsdf.eval(wo, wi), share)
}
