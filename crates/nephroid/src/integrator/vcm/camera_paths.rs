//! Paths from the camera: connected to lamps and to the vertices of light paths, and merged with photons.

use super::VcmConfig;
use super::densities::{Kind, Place, Trail};
use super::lamp::LampEnd;
use super::light_paths::{LightPaths, LightVertex, place_of};
use super::reach::AtFirst;
use super::weights::{Technique, Techniques, Weighed, Whole};
use crate::color::Rgb;
use crate::integrator::photon_mapper::PhotonMapper;
use crate::integrator::{Components, Estimator, Found, LightPart, Met, Probe};
use crate::light::Source;
use crate::material::{Bsdf, Transport, segments_by};
use crate::math::{Ray, Vec3};
use crate::medium::{Matter, Passage, PhaseSample};
use crate::photon_map::NearestList;
use crate::sampling::Key;
use crate::transport::{Lit, PixelSample, Scatterer, effort, survival};
use crate::world::{Hit, Surroundings, World, leave};

/// How far off the tangent plane photons count, in radii, and the cosine that their normal has with that of the surface
/// at least: as in [`gather`](crate::photon_map::gather()).
const MAX_THICKNESS: f32 = 0.25;
const MIN_NORMAL_COSINE: f32 = 0.9;

/// What the camera pass of one iteration connects and merges with.
pub(crate) struct Camera<'a> {
    pub world: &'a World,
    pub config: &'a VcmConfig,
    pub(super) paths: &'a LightPaths,
    pub(super) techniques: Techniques,
    pub(super) at_first: AtFirst<'a>,
    /// Reads the maps of light in media.
    pub media: PhotonMapper<'a>,
}

/// A path on its way.
struct Walk {
    ray: Ray,
    inside: Surroundings,
    throughput: Rgb,
    /// Segments up to the next surface or collision.
    depth: u32,
    /// Surfaces that are not specular, and collisions.
    scattered: u32,
    collisions: u32,
    /// Whether nothing since the last of them but specular surfaces, of which there is at least one.
    specular: bool,
    trail: Trail,
    /// The length of the way up to the first surface that is not specular, as far as it is known.
    length: f32,
    /// The radius within which photons are merged there.
    at_first: f32,
    /// Number of the light path to connect to.
    partner: u64,
}

impl Walk {
    /// What light is that comes straight, or by specular surfaces, to where the path was last.
    fn part(&self) -> LightPart {
        match self.scattered {
            0 => LightPart::Emitted,
            1 if self.specular => LightPart::Caustic,
            1 => LightPart::Direct,
            _ => LightPart::Global,
        }
    }
}

impl Camera<'_> {
    fn fits(&self, depth: u32) -> bool {
        self.config.mapper.max_depth.is_none_or(|max| depth <= max)
    }

    /// Comes to a vertex.
    fn arrive(&self, walk: &mut Walk, place: Place, kind: Kind, lens: &Ray) {
        let far = walk.trail.distance_to(&place) >= self.techniques.reach.apart();
        walk.trail.arrive(place, kind);
        if let Some(last) = walk.trail.nodes.last_mut() {
            last.far = far;
        }
        if let ([first], Place::Surface { position, ng }) = (&mut walk.trail.nodes[..], place) {
            let across = self.world.camera().pixels_per_area_from(lens.origin, position);
            first.arrival = across * ng.dot(walk.ray.direction).abs();
        }
    }

    /// The weight of a lamp that the path meets.
    fn weight_of_lamp(&self, walk: &mut Walk, lamp: impl FnOnce(Vec3) -> LampEnd) -> Weighed {
        let (Place::Surface { position, .. } | Place::Medium { position, .. }) = walk.trail.at else {
            return Weighed::ALONE;
        };
        let lamp = lamp(position);
        let [there, here] = walk.trail.at.between(&lamp.place);
        let counter = walk.trail.leaving * there;
        if let Some(last) = walk.trail.nodes.last_mut() {
            last.counter = lamp.leaving * here;
        }
        let path = Whole {
            light: &[lamp.node],
            counters: [counter, 0.0],
            camera: &walk.trail.nodes,
            far: true,
            at_first: walk.at_first,
        };
        self.techniques.weigh(&path, Technique::Met)
    }

    /// Light of a lamp that the path meets.
    fn meet(
        &self,
        walk: &mut Walk,
        radiance: Rgb,
        lamp: impl FnOnce(Vec3) -> LampEnd,
        out: &mut Components,
        probe: &mut impl Probe,
    ) {
        let Weighed { weight, over_paths } = self.weight_of_lamp(walk, lamp);
        let light = walk.throughput * radiance * weight;
        probe.technique(Found::Met, light, over_paths);
        book(out, walk.part(), light, probe);
    }

    /// Light of lamps that are asked for it at a vertex.
    fn direct(
        &self,
        lit: &Lit<'_>,
        walk: &mut Walk,
        sample: &mut PixelSample,
        probe: &mut impl Probe,
    ) -> Rgb {
        let (world, sampler, from) = (self.world, &mut sample.sampler, lit.vantage());
        let Some(table) = world.lights_for_direct() else { return Rgb::BLACK };
        let (light, probability, _) = table.sample(sampler.next_1d());
        let u = sampler.next_2d();
        let Some(incident) = world.emitters()[light].sample_incident(world.lookup(), from.position(), u)
        else {
            return Rgb::BLACK;
        };
        let (wi, radiance) = (incident.wi, incident.radiance);
        let scattered = lit.eval(wi) * radiance;
        if scattered.is_black() {
            return Rgb::BLACK;
        }
        let inside = lit.beyond(world, wi);
        let through = world.light_through(from, inside, wi, &incident.source, sampler);
        if through.is_black() {
            return Rgb::BLACK;
        }
        let lamp = match &incident.source {
            source if incident.dirac => LampEnd::dirac(world, light, source, wi, radiance, from.position()),
            Source::Surface(point) => LampEnd::on_surface(world, light, point, radiance, from.position()),
            _ => LampEnd::in_sky(world, light, wi, radiance, from.position()),
        };
        let [there, here] = walk.trail.at.between(&lamp.place);
        set_counters(&mut walk.trail, lamp.leaving * here, lit.pdf_between(wi, lit.wo));
        let counters = [lit.pdf(wi) * there, 0.0];
        let path = Whole {
            light: &[lamp.node],
            counters,
            camera: &walk.trail.nodes,
            far: true,
            at_first: walk.at_first,
        };
        let Weighed { weight, over_paths } = self.techniques.weigh(&path, Technique::Connected);
        let light = scattered * through * (weight / (incident.pdf_solid_angle * probability));
        probe.technique(Found::Asked, walk.throughput * light, over_paths);
        light
    }

    /// Light of the vertices of a light path.
    fn connected(
        &self,
        lit: &Lit<'_>,
        walk: &mut Walk,
        sample: &mut PixelSample,
        probe: &mut impl Probe,
    ) -> Rgb {
        if !self.techniques.connects {
            return Rgb::BLACK;
        }
        let mut sum = Rgb::BLACK;
        for vertex in self.paths.chosen(walk.partner) {
            if self.fits(walk.depth + 1 + vertex.depth) {
                sum += self.connection(lit, vertex, walk, sample, probe);
            }
        }
        sum
    }

    fn connection(
        &self,
        lit: &Lit<'_>,
        vertex: &LightVertex,
        walk: &mut Walk,
        sample: &mut PixelSample,
        probe: &mut impl Probe,
    ) -> Rgb {
        let (world, from) = (self.world, lit.vantage());
        let way = vertex.position() - from.position();
        let distance_sq = way.length_squared();
        let Some(wi) = way.try_normalize() else { return Rgb::BLACK };
        let there = vertex.lit();
        let scattered = lit.eval(wi) * vertex.power * there.spread(-wi) / distance_sq;
        if scattered.is_black() {
            return Rgb::BLACK;
        }
        let [to_light, to_camera] = walk.trail.at.between(&vertex.place);
        set_counters(&mut walk.trail, there.pdf(-wi) * to_camera, lit.pdf_between(wi, lit.wo));
        let counters = [lit.pdf(wi) * to_light, there.pdf_between(-wi, there.wo) * vertex.back];
        let far = distance_sq >= self.techniques.reach.apart() * self.techniques.reach.apart();
        let path = Whole {
            light: self.paths.nodes_of(vertex),
            counters,
            camera: &walk.trail.nodes,
            far,
            at_first: walk.at_first,
        };
        let Weighed { weight, over_paths } = self.techniques.weigh(&path, Technique::Connected);
        let inside = lit.beyond(world, wi);
        let through = world.light_through(from, inside, wi, &vertex.source(), &mut sample.sampler);
        let light = scattered * through * weight;
        probe.technique(Found::Connected, walk.throughput * light, over_paths);
        light
    }

    /// Light of the photons around a surface: caustics that the camera sees there, and all other.
    fn merged(&self, hit: &Hit, bsdf: &Bsdf, walk: &mut Walk, out: &mut Components, probe: &mut impl Probe) {
        let reach = &self.techniques.reach;
        let behind = walk.scattered > 1;
        let radius = if behind { reach.radius } else { walk.at_first };
        let area = reach.area(radius);
        let far = walk.trail.nodes.last().is_some_and(|node| node.far);
        if area <= 0.0 || bsdf.is_black() || (behind && !far) {
            return;
        }
        let (wo, position) = (-walk.ray.direction, hit.point.position);
        let normal = if wo.dot(hit.point.ng) > 0.0 { hit.point.ng } else { -hit.point.ng };
        let (at_first, scale) = (walk.at_first, walk.throughput / area);
        let Some((last, before)) = walk.trail.nodes.split_last_mut() else { return };
        let [mut caustic, mut global, mut of_half] = [Rgb::BLACK; 3];
        self.paths.each_within(position, radius, |photon, place| {
            let height = (place - position).dot(normal);
            if photon.normal.dot(normal) < MIN_NORMAL_COSINE
                || height.abs() > MAX_THICKNESS * radius
                || !self.fits(walk.depth + photon.depth)
            {
                return;
            }
            let f = bsdf.eval(wo, photon.wi) * bsdf.density_factor(photon.wi);
            if f.is_black() {
                return;
            }
            if let Some(before) = before.last_mut() {
                before.counter = bsdf.pdf(photon.wi, wo) * walk.trail.back;
            }
            let counters = [last.arrival, bsdf.pdf(wo, photon.wi) * photon.back];
            let path =
                Whole { light: self.paths.nodes_at(photon), counters, camera: before, far: true, at_first };
            let Weighed { weight, over_paths } = self.techniques.weigh(&path, Technique::Merged);
            let light = f * photon.power * weight;
            probe.technique(Found::Merged, scale * light, over_paths);
            if (place - position).length_squared() <= 0.5 * radius * radius {
                of_half += 2.0 * light;
            }
            *(if photon.caustic && walk.scattered == 1 { &mut caustic } else { &mut global }) += light;
        });
        probe.blur(scale * (caustic + global - of_half));
        for (part, light) in [(LightPart::Caustic, caustic), (LightPart::Global, global)] {
            book(out, part, scale * light, probe);
        }
    }

    /// What a medium does to a path that has met a surface: a vertex in it, or none. Tells whether the path goes on.
    fn through_medium<P: Probe>(
        &self,
        walk: &mut Walk,
        matter: &Matter,
        end: f32,
        sample: &mut PixelSample,
        out: &mut Components,
        probe: &mut P,
    ) -> AfterMedium {
        if matter.emits() {
            let emitted = matter.emitted(&walk.ray, end, &mut sample.sampler);
            book(out, walk.part(), walk.throughput * emitted, probe);
        }
        match matter.travel(&walk.ray, end, walk.throughput, &mut sample.sampler) {
            Passage::Through { weight } => {
                walk.throughput *= weight;
                AfterMedium::Surface
            }
            Passage::Collision { t, weight } => {
                let (position, wo) = (walk.ray.at(t), -walk.ray.direction);
                let before = walk.throughput * weight;
                walk.throughput = before * matter.albedo(position);
                (walk.scattered, walk.collisions, walk.specular) =
                    (walk.scattered + 1, walk.collisions + 1, false);
                let scatterer = Scatterer::Medium { position, phase: matter.phase() };
                let lit = Lit { scatterer, wo, inside: walk.inside };
                let (place, _) = place_of(self.world, &lit);
                walk.trail.arrive(place, Kind::Medium);
                if self.fits(walk.depth + 1) {
                    let light =
                        self.direct(&lit, walk, sample, probe) + self.connected(&lit, walk, sample, probe);
                    book(out, LightPart::Global, walk.throughput * light, probe);
                }
                let (u, u_survive) = (sample.sampler.next_2d(), sample.sampler.next_1d());
                let q = survival(before, walk.throughput, effort(walk.depth - 1, walk.collisions - 1));
                if u_survive >= q || walk.throughput.is_black() {
                    return AfterMedium::End;
                }
                walk.throughput = walk.throughput / q;
                let PhaseSample { wi, pdf_solid_angle } = matter.phase().sample(wo, u);
                walk.trail.turn(pdf_solid_angle, matter.phase().eval(wi, wo));
                walk.ray = Ray::new(position, wi);
                walk.depth += 1;
                AfterMedium::Collision
            }
        }
    }
}

/// Where a path is behind a stretch of a medium.
enum AfterMedium {
    Surface,
    Collision,
    End,
}

/// Sets the densities of a light path that comes to the last vertex, and from there to the one before.
fn set_counters(trail: &mut Trail, here: f32, onward: f32) {
    let back = trail.back;
    if let [rest @ .., last] = &mut trail.nodes[..] {
        last.counter = here;
        if let Some(before) = rest.last_mut() {
            before.counter = onward * back;
        }
    }
}

fn book(out: &mut Components, part: LightPart, light: Rgb, probe: &mut impl Probe) {
    out.add(part, light);
    probe.light(part, light);
}

impl Estimator for Camera<'_> {
    fn radiance<P: Probe>(
        &self,
        sample: &mut PixelSample,
        neighbors: &mut NearestList,
        probe: &mut P,
    ) -> Components {
        probe.begin(None, Rgb::WHITE);
        let world = self.world;
        let mut out = Components::default();
        let lens = sample.ray;
        let mut walk = Walk {
            ray: lens,
            inside: world.camera_surroundings(),
            throughput: Rgb::WHITE,
            depth: 1,
            scattered: 0,
            collisions: 0,
            specular: false,
            trail: Trail::new(),
            length: 0.0,
            at_first: 0.0,
            partner: partner(sample.key, sample.index),
        };
        walk.trail.begin(Place::Point { position: lens.origin }, 0.0);
        let mut entered = false;
        while self.fits(walk.depth) {
            let hit = world.intersect(&walk.ray);
            if let Some(matter) = world.matter(walk.inside) {
                let end = hit.map_or(f32::INFINITY, |hit| hit.t);
                if walk.scattered == 0 {
                    let open = [entered, hit.is_some_and(|hit| world.ends_medium(&hit))];
                    let (seen, through) = self.media.medium_ahead(
                        &walk.ray,
                        end,
                        walk.inside,
                        walk.depth,
                        open,
                        &mut sample.sampler,
                        neighbors,
                        probe,
                    );
                    out.medium += walk.throughput * seen;
                    walk.throughput *= through;
                    if walk.throughput.is_black() {
                        break;
                    }
                } else {
                    match self.through_medium(&mut walk, matter, end, sample, &mut out, probe) {
                        AfterMedium::Surface => {}
                        AfterMedium::Collision => continue,
                        AfterMedium::End => break,
                    }
                }
            }
            let Some(hit) = hit else {
                let direction = walk.ray.direction;
                for (light, emitter) in world.emitters().iter().enumerate().filter(|(_, e)| e.is_sky()) {
                    let radiance = emitter.sky_radiance(&world.scene().textures, direction);
                    let lamp = |from| LampEnd::in_sky(world, light, direction, radiance, from);
                    self.meet(&mut walk, radiance, lamp, &mut out, probe);
                }
                break;
            };
            let wo = -walk.ray.direction;
            if let Some((light, radiance)) = world.emitted(&hit, wo) {
                let lamp = |from| LampEnd::on_surface(world, light, &hit.point, radiance, from);
                self.meet(&mut walk, radiance, lamp, &mut out, probe);
            }
            walk.length += hit.t;
            let bsdf = world.bsdf_within(&hit, wo, &walk.inside);
            if bsdf.is_null() {
                let direction = walk.ray.direction;
                let inside = world.cross(walk.inside, &hit, direction, direction);
                entered = inside.medium() != walk.inside.medium();
                (walk.inside, walk.ray) = (inside, leave(&hit.point, direction));
                continue;
            }
            let (throughput, depth, first) = (walk.throughput, walk.depth, walk.scattered == 0);
            probe.surface(&Met { hit: &hit, bsdf: &bsdf, wo, depth, throughput, first });
            let place = Place::Surface { position: hit.point.position, ng: hit.point.ng };
            self.arrive(
                &mut walk,
                place,
                if bsdf.is_dirac() { Kind::Specular } else { Kind::Surface },
                &lens,
            );
            if !bsdf.is_dirac() {
                if walk.scattered == 0 {
                    walk.at_first = self.at_first.radius(world, hit.point.position, walk.length, neighbors);
                }
                (walk.scattered, walk.specular) = (walk.scattered + 1, false);
                let lit =
                    Lit { scatterer: Scatterer::Surface { hit: &hit, bsdf: &bsdf }, wo, inside: walk.inside };
                if self.fits(walk.depth + 1) {
                    let direct = throughput * self.direct(&lit, &mut walk, sample, probe);
                    book(&mut out, walk.part(), direct, probe);
                    let connected = throughput * self.connected(&lit, &mut walk, sample, probe);
                    book(&mut out, LightPart::Global, connected, probe);
                    self.merged(&hit, &bsdf, &mut walk, &mut out, probe);
                }
            }
            let s = &mut sample.sampler;
            let (u, u_lobe, u_survive) = (s.next_2d(), s.next_1d(), s.next_1d());
            let Some(next) = bsdf.sample(wo, u, u_lobe, Transport::Radiance) else { break };
            let carried = throughput * next.weight;
            let q =
                survival(throughput, carried / next.radiance_scale, effort(walk.depth - 1, walk.collisions));
            if u_survive >= q {
                break;
            }
            walk.throughput = carried / q;
            if next.dirac {
                walk.specular = true;
                walk.trail.turn(1.0, 1.0);
            } else {
                walk.trail.turn(next.pdf_solid_angle, bsdf.pdf(next.wi, wo));
            }
            let inside = world.cross(walk.inside, &hit, walk.ray.direction, next.wi);
            entered = inside.medium() != walk.inside.medium();
            (walk.inside, walk.ray) = (inside, leave(&hit.point, next.wi));
            walk.depth += segments_by(wo, next.wi);
        }
        out
    }
}

/// Which light path a camera sample is connected to.
fn partner(key: Key, index: u64) -> u64 {
    key.with(index).with(0x0076_636d).hash() >> 8
}
