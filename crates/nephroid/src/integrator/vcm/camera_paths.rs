//! Paths from the camera: connected to lamps and to the vertices of light paths, and merged with photons.

use super::VcmConfig;
use super::densities::{Kind, Place, Trail};
use super::lamp::LampEnd;
use super::light_paths::LightPaths;
use super::light_vertex::place_of;
use super::reach::AtFirst;
use super::weights::Techniques;
use crate::color::Rgb;
use crate::integrator::glances::glance;
use crate::integrator::photon_mapper::PhotonMapper;
use crate::integrator::{Components, Estimator, LightPart, Met, Probe};
use crate::light::Asker;
use crate::material::{Bsdf, Transport, segments_by};
use crate::math::{Ray, Vec3};
use crate::medium::{Matter, Passage, PhaseSample};
use crate::photon_map::NearestList;
use crate::sampling::{Key, Sampler};
use crate::transport::{Lit, PixelSample, Scatterer, effort, survival};
use crate::world::{Hit, Surroundings, World, leave};

/// What the camera pass of one iteration connects and merges with.
pub(crate) struct Camera<'a> {
    pub world: &'a World,
    pub config: &'a VcmConfig,
    pub(super) paths: &'a LightPaths,
    pub(super) techniques: Techniques,
    pub(super) at_first: AtFirst<'a>,
    /// Reads the maps of light in media.
    pub media: PhotonMapper<'a>,
    /// Whether lamps that are seen are looked for by rays of their own.
    pub glances: bool,
}

/// A path on its way.
pub(super) struct Walk {
    pub ray: Ray,
    pub inside: Surroundings,
    /// Whether the medium there began at the last surface.
    pub entered: bool,
    pub throughput: Rgb,
    /// Segments up to the next surface or collision.
    pub depth: u32,
    /// Surfaces that are not specular, and collisions.
    pub scattered: u32,
    pub collisions: u32,
    /// Whether nothing since the last of them but specular surfaces, of which there is at least one.
    pub specular: bool,
    pub trail: Trail,
    /// The length of the way up to the first surface that is not specular, as far as it is known.
    pub length: f32,
    /// The radius within which photons are merged there.
    pub at_first: f32,
    /// Number of the light path to connect to.
    pub partner: u64,
}

impl Walk {
    /// Begins at the lens.
    fn begin(world: &World, sample: &PixelSample) -> Self {
        let lens = sample.ray;
        let mut walk = Self {
            ray: lens,
            inside: world.camera_surroundings(),
            entered: false,
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
        walk
    }

    /// Leaves a surface in a direction.
    fn leave(&mut self, world: &World, hit: &Hit, wi: Vec3) {
        let inside = world.cross(self.inside, hit, self.ray.direction, wi);
        self.entered = inside.medium() != self.inside.medium();
        (self.inside, self.ray) = (inside, leave(&hit.point, wi));
    }

    /// What light is that comes straight, or by specular surfaces, to where the path was last.
    pub(super) fn part(&self) -> LightPart {
        match self.scattered {
            0 => LightPart::Emitted,
            1 if self.specular => LightPart::Caustic,
            1 => LightPart::Direct,
            _ => LightPart::Global,
        }
    }
}

impl Camera<'_> {
    pub(super) fn fits(&self, depth: u32) -> bool {
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

    /// What the medium does, if there is one, that the path is in up to what it meets next.
    fn to_next<P: Probe>(
        &self,
        walk: &mut Walk,
        hit: Option<&Hit>,
        sample: &mut PixelSample,
        neighbors: &mut NearestList,
        out: &mut Components,
        probe: &mut P,
    ) -> AfterMedium {
        let world = self.world;
        let Some(matter) = world.matter(walk.inside) else { return AfterMedium::Surface };
        let end = hit.map_or(f32::INFINITY, |hit| hit.t);
        if walk.scattered > 0 {
            return self.through_medium(walk, matter, end, sample, out, probe);
        }
        let open = [walk.entered, hit.is_some_and(|hit| world.ends_medium(hit))];
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
        if walk.throughput.is_black() { AfterMedium::End } else { AfterMedium::Surface }
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

    /// Leaves the scene.
    fn meet_sky(&self, walk: &mut Walk, out: &mut Components, probe: &mut impl Probe) {
        let (world, direction) = (self.world, walk.ray.direction);
        for (light, emitter) in world.skies() {
            let radiance = emitter.sky_radiance(&world.scene().textures, direction);
            let lamp = |from: &Asker| LampEnd::in_sky(world, light, direction, radiance, from);
            self.meet(walk, radiance, lamp, out, probe);
        }
    }

    /// What a surface that is not specular scatters towards the camera.
    fn scatter<P: Probe>(
        &self,
        (hit, bsdf): (&Hit, &Bsdf),
        walk: &mut Walk,
        sample: &mut PixelSample,
        neighbors: &mut NearestList,
        out: &mut Components,
        probe: &mut P,
    ) {
        if walk.scattered == 0 {
            walk.at_first = self.at_first.radius(self.world, hit.point.position, walk.length, neighbors);
        }
        (walk.scattered, walk.specular) = (walk.scattered + 1, false);
        let wo = -walk.ray.direction;
        let lit = Lit { scatterer: Scatterer::Surface { hit, bsdf }, wo, inside: walk.inside };
        if self.fits(walk.depth + 1) {
            let direct = walk.throughput * self.direct(&lit, walk, sample, probe);
            book(out, walk.part(), direct, probe);
            let connected = walk.throughput * self.connected(&lit, walk, sample, probe);
            book(out, LightPart::Global, connected, probe);
            self.merged(hit, bsdf, walk, out, probe);
        }
    }

    /// Takes a way on from a surface; false if the path ends there.
    fn go_on(&self, hit: &Hit, bsdf: &Bsdf, walk: &mut Walk, s: &mut Sampler) -> bool {
        let wo = -walk.ray.direction;
        let (u, u_lobe, u_survive) = (s.next_2d(), s.next_1d(), s.next_1d());
        let Some(next) = bsdf.sample(wo, u, u_lobe, Transport::Radiance) else { return false };
        let carried = walk.throughput * next.weight;
        let effort = effort(walk.depth - 1, walk.collisions);
        let q = survival(walk.throughput, carried / next.radiance_scale, effort);
        if u_survive >= q {
            return false;
        }
        walk.throughput = carried / q;
        if next.is_dirac() {
            walk.specular = true;
            walk.scattered -= u32::from(!bsdf.is_dirac());
            walk.trail.turn_specular();
        } else {
            walk.trail.turn(next.pdf_solid_angle, bsdf.pdf(next.wi, wo));
        }
        walk.leave(self.world, hit, next.wi);
        walk.depth += segments_by(wo, next.wi);
        true
    }
}

/// Where a path is behind a stretch of a medium.
enum AfterMedium {
    Surface,
    Collision,
    End,
}

pub(super) fn book(out: &mut Components, part: LightPart, light: Rgb, probe: &mut impl Probe) {
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
        if self.glances {
            out.emitted = glance(world, sample, self.config.mapper.max_depth, probe);
            probe.begin(None, Rgb::WHITE);
        }
        let lens = sample.ray;
        let mut walk = Walk::begin(world, sample);
        while self.fits(walk.depth) {
            let hit = world.intersect(&walk.ray);
            match self.to_next(&mut walk, hit.as_ref(), sample, neighbors, &mut out, probe) {
                AfterMedium::Surface => {}
                AfterMedium::Collision => continue,
                AfterMedium::End => break,
            }
            let Some(hit) = hit else {
                self.meet_sky(&mut walk, &mut out, probe);
                break;
            };
            let wo = -walk.ray.direction;
            if let Some((light, radiance)) = world.emitted(&hit, wo) {
                let lamp = |from: &Asker| LampEnd::on_surface(world, light, &hit.point, radiance, from);
                self.meet(&mut walk, radiance, lamp, &mut out, probe);
            }
            walk.length += hit.t;
            let bsdf = world.meet(&hit, wo, &mut walk.inside, &mut walk.throughput, &mut sample.sampler);
            if bsdf.is_null() {
                let direction = walk.ray.direction;
                walk.leave(world, &hit, direction);
                continue;
            }
            let (throughput, depth, first) = (walk.throughput, walk.depth, walk.scattered == 0);
            probe.surface(&Met { hit: &hit, bsdf: &bsdf, wo, depth, throughput, first });
            let place = Place::Surface { position: hit.point.position, ng: hit.point.ng };
            let kind = if bsdf.is_dirac() { Kind::Specular } else { Kind::Surface };
            self.arrive(&mut walk, place, kind, &lens);
            if !bsdf.is_dirac() {
                self.scatter((&hit, &bsdf), &mut walk, sample, neighbors, &mut out, probe);
            }
            if !self.go_on(&hit, &bsdf, &mut walk, &mut sample.sampler) {
                break;
            }
        }
        out
    }
}

/// Which light path a camera sample is connected to.
fn partner(key: Key, index: u64) -> u64 {
    key.with(index).with(0x0076_636d).hash() >> 8
}
