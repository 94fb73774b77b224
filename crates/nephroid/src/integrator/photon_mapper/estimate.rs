//! The camera side of photon mapping: from a camera ray to radiance.

mod equiangular;
mod gather_rays;
mod in_scatter;
mod march;
mod trace;

use super::camera_plan::CameraPlan;
use super::config::{DirectSource, PhotonMapperConfig, Show};
use super::guide::Facing;
use super::{Guides, Maps};
use crate::color::Rgb;
use crate::integrator::glances::{are_worth_it, glance};
use crate::integrator::{Components, Estimator, LightPart, LookUp, MapName, Probe};
use crate::material::Bsdf;
use crate::math::{Ray, Vec3};
use crate::medium::Profile;
use crate::photon_map::{Bandwidth, NearestList, Query, gather_both};
use crate::sampling::{Sampler, Sequence};
use crate::shape::SurfacePoint;
use crate::transport::{PixelSample, direct_light};
use crate::world::{Hit, Surroundings, World, leave};
use in_scatter::Segment;
use trace::{Branch, Track};

/// Photons in the disc of an estimate that a gather ray makes, at the map's mean density. Small, as
/// the mean over many rays smooths what each of them sees.
const GATHER_PHOTONS: u32 = 6;

/// What an estimate works with.
struct Tools<'t, P> {
    /// Memory that look-ups lend one another.
    neighbors: &'t mut NearestList,
    /// The same of the transmittance along a ray.
    profile: Profile,
    probe: &'t mut P,
}

/// A ray and what it starts in.
#[derive(Clone, Copy)]
struct Way {
    ray: Ray,
    inside: Surroundings,
    /// Whether it begins where another medium ends.
    entered: bool,
    /// The length of what lies before it.
    before: f32,
}

impl Way {
    /// Onward from a surface that it met.
    fn pass(&self, world: &World, hit: &Hit, direction: Vec3) -> Self {
        let inside = world.cross(self.inside, hit, self.ray.direction, direction);
        let entered = inside.medium() != self.inside.medium();
        Self { ray: leave(&hit.point, direction), inside, entered, before: self.before + hit.t }
    }
}

/// What the camera pass of one iteration looks up.
pub(crate) struct PhotonMapper<'a> {
    world: &'a World,
    config: &'a PhotonMapperConfig,
    maps: &'a Maps,
    guides: &'a Guides,
    gather_rays: Option<u32>,
    /// Every so many-th sample reads the maps, for all.
    stride: u32,
    /// Widths of the estimates on surfaces that the camera sees.
    global_bandwidth: Bandwidth,
    caustic_bandwidth: Bandwidth,
    afterglow_bandwidth: Bandwidth,
    haze_bandwidth: Bandwidth,
    /// Radius of the estimates where gather rays land.
    global_radius: f32,
    /// Whether lamps are looked for by rays of their own.
    glances: bool,
}

/// A surface that scatters light other than specularly, as a path meets it.
struct Vertex<'a> {
    hit: &'a Hit,
    bsdf: &'a Bsdf,
    wo: Vec3,
    /// Segments from the lens to here.
    depth: u32,
    /// What lies on the side of `wo`.
    inside: Surroundings,
    /// The radius of a pixel there; nothing where gather rays land.
    footprint: f32,
    /// Whether only photons of Dirac lamps count.
    dirac_lamps: bool,
}

impl<'a> Vertex<'a> {
    fn point(&self) -> &'a SurfacePoint {
        &self.hit.point
    }

    /// The geometric normal on the side it is seen from.
    fn facing_normal(&self) -> Vec3 {
        if self.wo.dot(self.point().ng) > 0.0 { self.point().ng } else { -self.point().ng }
    }
}

impl<'a> PhotonMapper<'a> {
    pub fn new(
        world: &'a World,
        config: &'a PhotonMapperConfig,
        maps: &'a Maps,
        guides: &'a Guides,
        plan: &CameraPlan,
    ) -> Self {
        let bandwidth = |map, k| maps.blur.narrow(config.bandwidth(map, k), 2);
        let [of_global, of_caustic] = plan.neighbours;
        let global_radius = config.radius.unwrap_or_else(|| maps.global.typical_radius(GATHER_PHOTONS));
        Self {
            world,
            config,
            maps,
            guides,
            stride: plan.stride,
            gather_rays: plan.gather_rays,
            global_bandwidth: bandwidth(&maps.global, of_global),
            caustic_bandwidth: bandwidth(&maps.caustic, of_caustic),
            afterglow_bandwidth: bandwidth(&maps.afterglow, of_caustic),
            haze_bandwidth: bandwidth(&maps.haze, of_global),
            global_radius: global_radius * maps.blur.factor(2),
            glances: are_worth_it(world),
        }
    }

    /// The radiance that a medium adds to a camera ray from its way to `end`, after so many segments up to there, and
    /// the share of what lies behind that comes through. `open` tells at which ends nothing but the medium ends.
    #[expect(clippy::too_many_arguments, reason = "the state of a path")]
    pub fn medium_ahead<P: Probe>(
        &self,
        ray: &Ray,
        end: f32,
        inside: Surroundings,
        depth: u32,
        open: [bool; 2],
        sampler: &mut Sampler,
        neighbors: &mut NearestList,
        probe: &mut P,
    ) -> (Rgb, Rgb) {
        let Some(matter) = self.world.matter(inside) else { return (Rgb::BLACK, Rgb::WHITE) };
        let segment = Segment { ray, end, matter, inside, depth, open };
        let mut tools = Tools { neighbors, profile: Profile::default(), probe };
        self.through_medium(&segment, 1, sampler, &mut tools)
    }

    fn fits(&self, depth: u32) -> bool {
        self.config.max_depth.is_none_or(|max| depth <= max)
    }

    /// Adds the light that a surface reflects towards the camera.
    fn shade<P: Probe>(
        &self,
        vertex: &Vertex<'_>,
        throughput: Rgb,
        branch: Branch,
        sample: &mut PixelSample,
        tools: &mut Tools<'_, P>,
        out: &mut Components,
    ) {
        let show = self.config.show;
        let shows_direct = self.config.shows_direct();
        let shows_global = matches!(show, Show::All | Show::Indirect | Show::Global);
        // What is seen beside the light that gather rays bring.
        let mut beside = Rgb::BLACK;
        if shows_direct && self.config.direct == DirectSource::Rays && self.fits(vertex.depth + 1) {
            let direct = self.direct(vertex, &mut sample.sampler);
            out.direct += throughput * direct;
            beside += direct;
            tools.probe.light(LightPart::Direct, direct);
        }
        if !sample.index.is_multiple_of(u64::from(self.stride)) {
            return;
        }
        let throughput = throughput * self.stride as f32;
        tools.probe.carry(throughput);
        let look_up = |map, direct, other| LookUp { map, direct, other };
        if self.config.shows_caustics() {
            let wanted = look_up(MapName::Caustic, None, Some(LightPart::Caustic));
            let caustic = self.look_up(&wanted, vertex, self.caustic_bandwidth, tools).1;
            out.caustic += throughput * caustic;
            beside += caustic;
        }
        let gathers = self.gather_rays.is_some();
        if self.config.direct == DirectSource::Map || (shows_global && !gathers) {
            // What the map would blur is sampled below.
            let bsdf = if gathers { *vertex.bsdf } else { vertex.bsdf.diffuse_part() };
            let smooth = Vertex { bsdf: &bsdf, ..*vertex };
            // No ray will find a point light: its highlight is the photons', however blurred.
            let highlights = shows_direct && !gathers && vertex.bsdf.has_glossy_lobe();
            let wanted = look_up(
                MapName::Global,
                (shows_direct && !highlights).then_some(LightPart::Direct),
                (shows_global && !gathers).then_some(LightPart::Global),
            );
            let (mut direct, global) = self.look_up(&wanted, &smooth, self.global_bandwidth, tools);
            if shows_direct {
                if highlights {
                    let wanted = look_up(MapName::Global, Some(LightPart::Direct), None);
                    direct = self.look_up(&wanted, vertex, self.global_bandwidth, tools).0;
                }
                out.direct += throughput * direct;
            }
            if shows_global && !gathers {
                out.global += throughput * global;
            }
        }
        // Light that media give off is none of direct light's, though it may come straight here, by one segment.
        let straight = u32::from(self.world.glows());
        if shows_global && self.fits(vertex.depth + 2 - straight) {
            let glossy = self.gather_rays.is_none().then(|| vertex.bsdf.glossy_part());
            let (bsdf, most) = match (self.gather_rays, &glossy) {
                (Some(most), _) => (vertex.bsdf, most),
                (None, Some(glossy)) if !glossy.is_black() => (glossy, 1),
                (None, _) => return,
            };
            let vertex = Vertex { bsdf, ..*vertex };
            let guide = self.guides.at(vertex.point().position, vertex.facing_normal(), tools.neighbors);
            let wanted = self.weight_of_gathering(bsdf, guide.as_ref(), beside, branch.share);
            let rays = ((most as f32 * wanted).ceil() as u32).clamp(1, most);
            let key = sample.key.with(branch.number);
            let first = sample.index / u64::from(self.stride) * u64::from(most);
            let found: Rgb = (first..first + u64::from(rays))
                .map(|ray| {
                    tools.probe.begin(Some(ray), throughput / rays as f32);
                    let mut sampler = Sampler::new(Sequence::Sobol, key, ray);
                    self.gather_ray(&vertex, guide.as_ref(), &mut sampler, tools)
                })
                .sum();
            out.global += throughput * (found / rays as f32);
            tools.probe.begin(None, throughput);
            if gathers {
                out.global += throughput * self.unseen(&vertex, tools);
            }
        }
    }

    fn direct(&self, vertex: &Vertex<'_>, sampler: &mut Sampler) -> Rgb {
        let Vertex { hit, bsdf, wo, inside, .. } = *vertex;
        direct_light(self.world, hit, bsdf, wo, inside, self.config.direct_lights, sampler)
    }

    /// Reflected radiance by density estimation, direct (L D) and other photons apart.
    fn look_up<P: Probe>(
        &self,
        wanted: &LookUp,
        vertex: &Vertex<'_>,
        bandwidth: Bandwidth,
        tools: &mut Tools<'_, P>,
    ) -> (Rgb, Rgb) {
        let Vertex { hit, bsdf, wo, depth, .. } = *vertex;
        let map = match wanted.map {
            MapName::Global => &self.maps.global,
            MapName::Caustic => &self.maps.caustic,
            MapName::Afterglow => &self.maps.afterglow,
            MapName::Haze => &self.maps.haze,
            // What they hold lies on no surface.
            MapName::Volume | MapName::VolumeCaustic => return (Rgb::BLACK, Rgb::BLACK),
        };
        if map.is_empty() || bsdf.is_black() {
            return (Rgb::BLACK, Rgb::BLACK);
        }
        let normal = vertex.facing_normal();
        let has_direct = self.config.direct == DirectSource::Map && wanted.map == MapName::Global;
        let (mut direct, mut other) = (Rgb::BLACK, Rgb::BLACK);
        let bandwidth = bandwidth.at_least(vertex.footprint * self.maps.blur.factor(2));
        let Tools { neighbors, probe, .. } = tools;
        let sides = if bsdf.transmits() { 2 } else { 1 };
        for normal in [normal, -normal].into_iter().take(sides) {
            let query = Query {
                position: hit.point.position,
                normal,
                max_photon_depth: self
                    .config
                    .max_depth
                    .map(|max| max.saturating_sub(depth).min(65_535) as u16),
            };
            let kernel = self.config.kernel;
            let gathered = gather_both(map, &query, kernel, bandwidth, neighbors, |photon, weights| {
                if vertex.dirac_lamps && !self.world.emitters()[photon.light as usize].is_dirac() {
                    return;
                }
                let f = bsdf.eval(wo, photon.wi) * bsdf.density_factor(photon.wi);
                let radiance = f * photon.power * weights.whole;
                let is_direct = has_direct && photon.depth == 1 && !self.world.is_medium_light(photon.light);
                *(if is_direct { &mut direct } else { &mut other }) += radiance;
                probe.photon(photon, is_direct, radiance, f * photon.power * weights.half);
            });
            probe.look_up(wanted, gathered);
        }
        (direct, other)
    }
}

impl Estimator for PhotonMapper<'_> {
    fn radiance<P: Probe>(
        &self,
        sample: &mut PixelSample,
        neighbors: &mut NearestList,
        probe: &mut P,
    ) -> Components {
        let mut out = Components::default();
        let way =
            Way { ray: sample.ray, inside: self.world.camera_surroundings(), entered: false, before: 0.0 };
        let track = Track::new(way, self.glances);
        let mut tools = Tools { neighbors, profile: Profile::default(), probe };
        self.trace(track, sample, &mut tools, &mut out);
        if self.glances {
            probe.begin(None, Rgb::WHITE);
            out.emitted = glance(self.world, sample, self.config.max_depth, probe);
        }
        out
    }
}
