//! The camera side of photon mapping: from a camera ray to radiance.

use super::Maps;
use super::config::{DirectSource, PhotonMapperConfig, Show};
use super::guide::Guide;
use crate::color::Rgb;
use crate::integrator::Components;
use crate::material::{Bsdf, BsdfSample, Transport};
use crate::math::{Ray, Vec3};
use crate::photon_map::{Bandwidth, Kernel, NearestList, PhotonMap, Query, gather};
use crate::sampling::{Key, Sampler, Sequence};
use crate::shape::SurfacePoint;
use crate::transport::{PixelSample, direct_light, survival};
use crate::world::{World, leave};

/// Surfaces that both reflect and refract, along a camera path, at which both lobes are followed, before one is chosen by
/// chance: the reflection in a glass ball then shows no noise, at up to four times the rays.
const SPLITS: u32 = 2;

/// Photons in the disc of an estimate that a gather ray makes, at the map's mean density. Small, as
/// the mean over many rays smooths what each of them sees.
const GATHER_PHOTONS: u32 = 6;

/// Photons that guide the gather rays from a surface.
const GUIDE_PHOTONS: u32 = 48;

/// Surfaces that a gather ray may go on from because they are too near to be seen through the map.
const MAX_NEAR_SURFACES: u32 = 8;

/// Memory that estimates lend one another.
pub(crate) type Scratch = NearestList;

/// What the camera pass of one iteration looks up.
pub(crate) struct PhotonMapper<'a> {
    world: &'a World,
    config: &'a PhotonMapperConfig,
    maps: &'a Maps,
    gather_rays: Option<u32>,
    /// Every so many-th sample reads the maps, for all.
    stride: u32,
    /// Widths of the estimates on surfaces that the camera sees.
    global_bandwidth: Bandwidth,
    caustic_bandwidth: Bandwidth,
    afterglow_bandwidth: Bandwidth,
    /// Radius of the estimates where gather rays land.
    global_radius: f32,
}

/// Of how many camera samples one reads the maps, and counts for the others, which bring direct light
/// and emission only: what a map shows hardly changes within a pixel. At least 4 samples of a pixel
/// read. The steps of a session are whole multiples, so that a render may stop after any of them.
fn reading_stride(samples_per_pixel: u32) -> u32 {
    [4, 2]
        .into_iter()
        .find(|s| samples_per_pixel.is_multiple_of(*s) && samples_per_pixel >= 4 * s)
        .unwrap_or(1)
}

/// A surface that scatters light other than specularly, as a path meets it.
struct Vertex<'a> {
    point: &'a SurfacePoint,
    bsdf: &'a Bsdf,
    wo: Vec3,
    /// Segments from the lens to here.
    depth: u32,
}

impl Vertex<'_> {
    /// The geometric normal on the side it is seen from.
    fn facing_normal(&self) -> Vec3 {
        if self.wo.dot(self.point.ng) > 0.0 { self.point.ng } else { -self.point.ng }
    }
}

impl<'a> PhotonMapper<'a> {
    pub fn new(
        world: &'a World,
        config: &'a PhotonMapperConfig,
        maps: &'a Maps,
        samples_per_pixel: u32,
    ) -> Self {
        let stride = reading_stride(samples_per_pixel);
        Self {
            world,
            config,
            maps,
            gather_rays: config.gather_rays(samples_per_pixel / stride),
            stride,
            global_bandwidth: config.bandwidth(&maps.global),
            caustic_bandwidth: config.bandwidth(&maps.caustic),
            afterglow_bandwidth: config.bandwidth(&maps.afterglow),
            global_radius: config.radius.unwrap_or_else(|| maps.global.typical_radius(GATHER_PHOTONS)),
        }
    }

    /// Estimates the light of one camera sample.
    pub fn radiance(&self, sample: &mut PixelSample, scratch: &mut Scratch) -> Components {
        let mut out = Components::default();
        let ray = sample.ray;
        self.trace(ray, Rgb::WHITE, 1, 1, sample, scratch, &mut out);
        out
    }

    fn fits(&self, depth: u32) -> bool {
        self.config.max_depth.is_none_or(|max| depth <= max)
    }

    /// Follows a path from the camera over specular surfaces and shades the first that is not.
    /// `branch` numbers the ways of a path that was split.
    #[expect(clippy::too_many_arguments, reason = "the state of a path that splits in two")]
    fn trace(
        &self,
        mut ray: Ray,
        mut throughput: Rgb,
        mut depth: u32,
        branch: u64,
        sample: &mut PixelSample,
        scratch: &mut Scratch,
        out: &mut Components,
    ) {
        while self.fits(depth) {
            let Some(hit) = self.world.intersect(&ray) else {
                out.emitted += throughput * self.world.sky(ray.direction);
                return;
            };
            let wo = -ray.direction;
            if let Some((_, emitted)) = self.world.emitted(&hit, wo) {
                out.emitted += throughput * emitted;
            }
            let bsdf = self.world.bsdf(&hit, wo);
            if bsdf.is_null() {
                ray = leave(&hit.point, ray.direction);
                continue;
            }
            if !bsdf.is_dirac() {
                let vertex = Vertex { point: &hit.point, bsdf: &bsdf, wo, depth };
                let key = sample.key.with(branch);
                self.shade(&vertex, throughput, key, sample, scratch, out);
                return;
            }
            let lobes = bsdf.dirac_lobes(wo, Transport::Radiance);
            if let ([Some(a), Some(b)], true) = (lobes, branch < 1 << SPLITS) {
                for (lobe, side) in [(a, 0), (b, 1)] {
                    let ray = leave(&hit.point, lobe.wi);
                    let branch = branch << 1 | side;
                    self.trace(ray, throughput * lobe.weight, depth + 1, branch, sample, scratch, out);
                }
                return;
            }
            let Some((next, carried)) =
                scatter(&bsdf, &hit.point, wo, throughput, depth - 1, &mut sample.sampler)
            else {
                return;
            };
            (ray, throughput) = (next, carried);
            depth += 1;
        }
    }

    /// Adds the light that a surface reflects towards the camera.
    fn shade(
        &self,
        vertex: &Vertex<'_>,
        throughput: Rgb,
        key: Key,
        sample: &mut PixelSample,
        scratch: &mut Scratch,
        out: &mut Components,
    ) {
        let show = self.config.show;
        let shows_direct = matches!(show, Show::All | Show::Direct);
        let shows_global = matches!(show, Show::All | Show::Indirect | Show::Global);
        if shows_direct && self.config.direct == DirectSource::Rays && self.fits(vertex.depth + 1) {
            out.direct += throughput * self.direct(vertex, &mut sample.sampler);
        }
        if !sample.index.is_multiple_of(self.stride) {
            return;
        }
        let throughput = throughput * self.stride as f32;
        if self.config.shows_caustics() {
            out.caustic +=
                throughput * self.look_up(&self.maps.caustic, vertex, self.caustic_bandwidth, scratch).1;
        }
        let gathers = self.gather_rays.is_some();
        if self.config.direct == DirectSource::Map || (shows_global && !gathers) {
            // What the map would blur is sampled below.
            let bsdf = if gathers { *vertex.bsdf } else { vertex.bsdf.diffuse_part() };
            let smooth = Vertex { bsdf: &bsdf, ..*vertex };
            let (mut direct, global) =
                self.look_up(&self.maps.global, &smooth, self.global_bandwidth, scratch);
            if shows_direct {
                // No ray will find a point light: its highlight is the photons', however blurred.
                if !gathers && vertex.bsdf.has_glossy_lobe() {
                    direct = self.look_up(&self.maps.global, vertex, self.global_bandwidth, scratch).0;
                }
                out.direct += throughput * direct;
            }
            if shows_global && !gathers {
                out.global += throughput * global;
            }
        }
        if shows_global && self.fits(vertex.depth + 2) {
            let (bsdf, rays) = match self.gather_rays {
                Some(rays) => (*vertex.bsdf, rays),
                None if vertex.bsdf.has_glossy_lobe() => (vertex.bsdf.glossy_part(), 1),
                None => return,
            };
            let vertex = Vertex { bsdf: &bsdf, ..*vertex };
            let guide = gathers.then(|| self.guide(&vertex, scratch));
            let first = u64::from(sample.index / self.stride) * u64::from(rays);
            let found: Rgb = (first..first + u64::from(rays))
                .map(|ray| {
                    let mut sampler = Sampler::new(Sequence::Sobol, key, ray);
                    self.gather_ray(&vertex, guide.as_ref(), &mut sampler, scratch)
                })
                .sum();
            out.global += throughput * (found / rays as f32);
            if gathers {
                out.global += throughput * self.afterglow(&vertex, scratch);
            }
        }
    }

    /// What a gather ray brings from where it lands: all of the light, or from near by what no ray that
    /// goes on from there will bring. `sharp` is the share for which it brings caustics.
    fn light_at(
        &self,
        vertex: &Vertex<'_>,
        far: bool,
        sharp: Rgb,
        sampler: &mut Sampler,
        scratch: &mut Scratch,
    ) -> Rgb {
        let mut light = Rgb::BLACK;
        if self.config.direct == DirectSource::Rays {
            light += self.direct(vertex, sampler);
        }
        if !sharp.is_black() {
            light += sharp * self.look_up(&self.maps.caustic, vertex, self.caustic_bandwidth, scratch).1;
        }
        if far || self.config.direct == DirectSource::Map {
            let bandwidth = Bandwidth::Fixed { radius: self.global_radius };
            let (direct, other) = self.look_up(&self.maps.global, vertex, bandwidth, scratch);
            light += if far { direct + other } else { direct };
        }
        if !far {
            light += self.afterglow(vertex, scratch);
        }
        light
    }

    /// The light of caustics on other surfaces, which gather rays leave out: a small bright caustic
    /// that few of them chance upon makes white specks, and its photons one bounce on do not.
    fn afterglow(&self, vertex: &Vertex<'_>, scratch: &mut Scratch) -> Rgb {
        let smooth = Vertex { bsdf: &vertex.bsdf.diffuse_part(), ..*vertex };
        self.look_up(&self.maps.afterglow, &smooth, self.afterglow_bandwidth, scratch).1
    }

    fn direct(&self, vertex: &Vertex<'_>, sampler: &mut Sampler) -> Rgb {
        let Vertex { point, bsdf, wo, .. } = *vertex;
        direct_light(self.world, point, bsdf, wo, self.config.direct_lights, sampler)
    }

    /// Reflected radiance by density estimation, direct (L D) and other photons apart.
    fn look_up(
        &self,
        map: &PhotonMap,
        vertex: &Vertex<'_>,
        bandwidth: Bandwidth,
        scratch: &mut Scratch,
    ) -> (Rgb, Rgb) {
        let Vertex { point, bsdf, wo, depth } = *vertex;
        if map.is_empty() || bsdf.is_black() {
            return (Rgb::BLACK, Rgb::BLACK);
        }
        let query = Query {
            position: point.position,
            normal: vertex.facing_normal(),
            max_photon_depth: self.config.max_depth.map(|max| max.saturating_sub(depth).min(65_535) as u16),
        };
        let (mut direct, mut other) = (Rgb::BLACK, Rgb::BLACK);
        gather(map, &query, self.config.kernel, bandwidth, scratch, |photon, weight| {
            let f = bsdf.eval(wo, photon.wi) * bsdf.density_factor(photon.wi);
            let radiance = f * photon.power * weight;
            *(if photon.depth == 1 { &mut direct } else { &mut other }) += radiance;
        });
        (direct, other)
    }

    /// Where gather rays from a surface should go.
    fn guide(&self, vertex: &Vertex<'_>, scratch: &mut Scratch) -> Guide {
        let normal = vertex.facing_normal();
        let mut guide = Guide::new(normal);
        let map = &self.maps.global;
        if !map.is_empty() {
            let query = Query { position: vertex.point.position, normal, max_photon_depth: None };
            let bandwidth =
                Bandwidth::Nearest { k: GUIDE_PHOTONS, max_radius: map.default_max_radius(GUIDE_PHOTONS) };
            gather(map, &query, Kernel::Box, bandwidth, scratch, |photon, _| {
                if photon.depth > 1 {
                    guide.add(photon.wi, photon.power);
                }
            });
        }
        guide.finish();
        guide
    }

    /// One gather ray: on over specular surfaces to the first that is not, whose direct and global light
    /// it brings home, and its caustics as far as it was sent by a glossy lobe: the others come by
    /// [`Self::afterglow`]. Emission on the way is direct light's
    /// and the caustic map's.
    /// Where that surface is nearer than the map can resolve, a ray goes on from it in place of the
    /// look-up; corners stay as bright as they are.
    fn gather_ray(
        &self,
        vertex: &Vertex<'_>,
        guide: Option<&Guide>,
        sampler: &mut Sampler,
        scratch: &mut Scratch,
    ) -> Rgb {
        let mut found = Rgb::BLACK;
        let Some((mut ray, mut throughput)) = start_gather(vertex, guide, sampler) else {
            return found;
        };
        // The share that a glossy lobe has in the last surface's reflection: through it caustics are seen
        // as they are, and the rest of that surface has them by its afterglow.
        let mut sharp = glossy_share(vertex.bsdf, vertex.wo, ray.direction);
        let mut depth = vertex.depth + 1;
        let (mut distance, mut near) = (0.0, 0);
        // A surface at the last segment can still reflect nothing: light needs one more.
        while self.fits(depth + 1) {
            let Some(hit) = self.world.intersect(&ray) else { break };
            distance += hit.t;
            let wo = -ray.direction;
            let bsdf = self.world.bsdf(&hit, wo);
            if bsdf.is_null() {
                ray = leave(&hit.point, ray.direction);
                continue;
            }
            if !bsdf.is_dirac() {
                let there = Vertex { point: &hit.point, bsdf: &bsdf, wo, depth };
                let far = distance >= 2.0 * self.global_radius || near == MAX_NEAR_SURFACES;
                found += throughput * self.light_at(&there, far, sharp, sampler, scratch);
                if far {
                    break;
                }
                near += 1;
                distance = 0.0;
            }
            let Some((next, carried)) = scatter(&bsdf, &hit.point, wo, throughput, depth - 1, sampler) else {
                break;
            };
            if !bsdf.is_dirac() {
                // Where nothing is gathered there is no afterglow, and the ray brings all caustics.
                let gathers = self.gather_rays.is_some();
                sharp = if gathers { glossy_share(&bsdf, wo, next.direction) } else { Rgb::WHITE };
            }
            (ray, throughput) = (next, carried);
            depth += 1;
        }
        found
    }
}

/// The first segment of a gather ray, with its f·cos/pdf: by the guide, by the BSDF, or where there is
/// a glossy lobe by an equal mixture of both.
fn start_gather(vertex: &Vertex<'_>, guide: Option<&Guide>, sampler: &mut Sampler) -> Option<(Ray, Rgb)> {
    let Vertex { point, bsdf, wo, .. } = *vertex;
    let (u, u_lobe, u_technique) = (sampler.next_2d(), sampler.next_1d(), sampler.next_1d());
    let guide_share = match guide {
        None => 0.0,
        Some(_) if bsdf.has_glossy_lobe() => 0.5,
        Some(_) => 1.0,
    };
    let wi = match guide {
        Some(guide) if u_technique < guide_share => guide.sample(u),
        _ => bsdf.sample(wo, u, u_lobe, Transport::Radiance)?.wi,
    };
    let pdf = guide_share * guide.map_or(0.0, |g| g.pdf(wi)) + (1.0 - guide_share) * bsdf.pdf(wo, wi);
    let weight = bsdf.eval(wo, wi) * (bsdf.cosine(wi) / pdf);
    (pdf > 0.0 && !weight.is_black()).then(|| (leave(point, wi), weight))
}

/// The share of a BSDF that is in its glossy lobe.
fn glossy_share(bsdf: &Bsdf, wo: Vec3, wi: Vec3) -> Rgb {
    if !bsdf.has_glossy_lobe() {
        return Rgb::BLACK;
    }
    let share = |part: f32, whole: f32| if whole > 0.0 { part / whole } else { 0.0 };
    bsdf.glossy_part().eval(wo, wi).zip(bsdf.eval(wo, wi), share)
}

/// Samples the next segment of a camera path, with roulette.
fn scatter(
    bsdf: &Bsdf,
    point: &SurfacePoint,
    wo: Vec3,
    throughput: Rgb,
    bounces: u32,
    sampler: &mut Sampler,
) -> Option<(Ray, Rgb)> {
    let (u, u_lobe, u_survive) = (sampler.next_2d(), sampler.next_1d(), sampler.next_1d());
    let BsdfSample { wi, weight, radiance_scale, .. } = bsdf.sample(wo, u, u_lobe, Transport::Radiance)?;
    let carried = throughput * weight;
    let q = survival(throughput, carried / radiance_scale, bounces);
    (u_survive < q).then(|| (leave(point, wi), carried / q))
}
