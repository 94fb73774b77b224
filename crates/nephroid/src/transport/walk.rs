//! The random walk of a photon: from a light, over surfaces and through media, to its end.

use super::direct::{Lit, Scatterer};
use super::history::{History, PhotonKind};
use super::ledger::Balance;
use super::roulette::survival;
use super::start::{Start, start};
use crate::color::Rgb;
use crate::light::SphereSampling;
use crate::material::{Bsdf, BsdfSample, Transport, segments_by};
use crate::math::{Ray, Vec3};
use crate::medium::{Matter, Passage, PhaseSample};
use crate::photon_map::{Beam, Photon, VolumePhoton};
use crate::sampling::Sampler;
use crate::world::{Hit, Surroundings, World, leave};

/// Which light a photon path starts from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightChoice {
    /// With probability ∝ its power, so that photons carry similar power.
    #[default]
    Power,
    /// The same number of paths from each, the report's comparison.
    Equal,
}

/// What governs photon walks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkSettings {
    /// Segments a photon path may have; `None` without end.
    pub max_photon_depth: Option<u32>,
    /// How paths are shared out among lights.
    pub light_choice: LightChoice,
    /// How directions of lights that shine everywhere are sampled, where they are not aimed.
    pub sphere_sampling: SphereSampling,
    /// Whether light is sent only where it can meet something that counts for the map. The rest is
    /// booked as escaped without being traced.
    pub aim: bool,
    /// What media do to photons.
    pub fog: Fog,
}

/// What media do to light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fog {
    /// They scatter and absorb it.
    #[default]
    Volume,
    /// They take from it and do not scatter, and what the camera sees of them is the same everywhere: the
    /// report's first method, which does not conserve energy.
    Ambient,
}

impl Default for WalkSettings {
    fn default() -> Self {
        Self {
            max_photon_depth: None,
            light_choice: LightChoice::default(),
            sphere_sampling: SphereSampling::default(),
            aim: true,
            fog: Fog::Volume,
        }
    }
}

/// The map that paths are traced for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MapKind {
    /// All light on surfaces.
    Global,
    /// Light on surfaces that meets a specular one first.
    Caustic,
    /// All light in media.
    Volume,
    /// Light in media that meets a specular surface first.
    VolumeCaustic,
}

/// How a walk goes on after a photon has been shown to its visitor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Next {
    Continue,
    Stop,
}

/// What a walk shows its visitor. Photons come with the vertex of the path where they are; its `wo` points back along
/// their flight.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Event<'a> {
    /// Light leaves a lamp.
    Start(&'a Start),
    /// A photon on a surface with a density to estimate.
    Surface(Photon, &'a Lit<'a>),
    /// The power that is scattered at a collision.
    Collision(VolumePhoton, &'a Lit<'a>),
    /// A stretch of the way through a medium.
    Way(Beam),
    /// Where and how the path goes on, at a surface or a collision.
    Bounce(&'a Lit<'a>, Bounce),
}

/// The direction that a path takes at one of its vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounce {
    pub wi: Vec3,
    /// Of `wi`; 0 for a Dirac lobe.
    pub pdf_solid_angle: f32,
    pub dirac: bool,
    /// Whether the lobe is a Dirac or nearly one.
    pub specular: bool,
}

/// A photon on its way.
struct Walker {
    ray: Ray,
    power: Rgb,
    inside: Surroundings,
    history: History,
    light: u32,
    /// What roulette, and distances that are sampled for one channel, took less what they gave.
    roulette: [f64; 3],
}

impl Walker {
    /// Goes on with other power, which is the same in the mean.
    fn gamble(&mut self, before: Rgb, after: Rgb) {
        let taken = before - after;
        for (r, p) in self.roulette.iter_mut().zip(taken.to_array()) {
            *r += f64::from(p);
        }
        self.power = after;
    }

    /// Roulette after a bounce that left `scattered` of the power; false if the path ends.
    fn survives(&mut self, scattered: Rgb, u: f32) -> bool {
        let q = survival(self.power, scattered, self.history.effort());
        let survives = u < q;
        self.gamble(scattered, if survives { scattered / q } else { Rgb::BLACK });
        survives
    }

    fn depth(&self) -> u32 {
        self.history.bounces() + 1
    }
}

/// Walks photon path `path`, showing every photon that lands on a surface with a density to
/// estimate, or collides in a medium, to `visit`, and books where the power goes with the light it came from.
/// What `map` has no use for, from the start on, may be left out.
pub(crate) fn walk(
    world: &World,
    settings: &WalkSettings,
    map: MapKind,
    path: u64,
    sampler: &mut Sampler,
    books: &mut [Balance],
    mut visit: impl FnMut(Event<'_>, PhotonKind) -> Next,
) {
    let Some(start) = start(world, settings, map, path, sampler) else {
        return;
    };
    let Start { light, ray, power, emitted, inside, history, .. } = start;
    let book = &mut books[light];
    book.emit(emitted);
    book.escape(emitted - power);
    if power.is_black() {
        return;
    }
    if visit(Event::Start(&start), history.kind()) == Next::Stop {
        book.end(power);
        return;
    }
    let roulette = [0.0; 3];
    let mut walker = Walker { ray, power, inside, history, light: light as u32, roulette };
    while step(world, settings, &mut walker, sampler, book, &mut visit) == Next::Continue {}
    book.roulette(walker.roulette);
}

/// The next segment, and what comes at its end.
fn step(
    world: &World,
    settings: &WalkSettings,
    walker: &mut Walker,
    sampler: &mut Sampler,
    book: &mut Balance,
    visit: &mut impl FnMut(Event<'_>, PhotonKind) -> Next,
) -> Next {
    let hit = world.intersect(&walker.ray);
    if let Some(matter) = world.matter(walker.inside) {
        let end = hit.map_or(f32::INFINITY, |hit| hit.t);
        match settings.fog {
            Fog::Ambient => {
                let left = walker.power * matter.transmittance(&walker.ray, end, sampler);
                book.absorb_in_medium(walker.power - left);
                walker.power = left;
                if left.is_black() {
                    return Next::Stop;
                }
            }
            Fog::Volume => {
                let (kind, carried) = (walker.history.kind_in_medium(), walker.power);
                let (mut beam, mut next) = (way(world, walker, matter, end), Next::Continue);
                let shows = matter.scatters();
                if beam.long && shows {
                    next = visit(Event::Way(beam), kind);
                }
                let passage =
                    matter.travel_and_tell(&walker.ray, end, carried, sampler, |from, to, weight| {
                        beam.origin = walker.ray.at(from);
                        (beam.length, beam.power) = (to - from, carried * weight);
                        if shows && beam.length > 0.0 && !beam.power.is_black() && next == Next::Continue {
                            next = visit(Event::Way(beam), kind);
                        }
                    });
                if !beam.long && shows && matter.uniform_extinction().is_some() {
                    if let Passage::Collision { t, .. } = passage {
                        beam.length = t;
                    }
                    next = visit(Event::Way(beam), kind);
                }
                if next == Next::Stop {
                    book.end(carried);
                    return Next::Stop;
                }
                match passage {
                    Passage::Through { weight } => walker.gamble(carried, carried * weight),
                    Passage::Collision { t, weight } => {
                        walker.gamble(carried, carried * weight);
                        return collide(settings, walker, matter, t, sampler, book, visit);
                    }
                }
            }
        }
    }
    let Some(hit) = hit else {
        book.escape(walker.power);
        return Next::Stop;
    };
    let wo = -walker.ray.direction;
    let mut power = walker.power;
    let bsdf = world.meet(&hit, wo, &mut walker.inside, &mut power, sampler);
    walker.gamble(walker.power, power);
    if bsdf.is_null() {
        walker.inside = world.cross(walker.inside, &hit, -wo, -wo);
        walker.ray = leave(&hit.point, -wo);
        return Next::Continue;
    }
    let (depth, power) = (walker.depth(), walker.power);
    if !bsdf.is_dirac() && !bsdf.is_black() && land(world, walker, &hit, &bsdf, visit) == Next::Stop {
        book.end(power);
        return Next::Stop;
    }
    if settings.max_photon_depth.is_some_and(|max| depth >= max) {
        book.end(power);
        return Next::Stop;
    }
    let (u, u_lobe, u_survive) = (sampler.next_2d(), sampler.next_1d(), sampler.next_1d());
    let Some(sample) = bsdf.sample(wo, u, u_lobe, Transport::Flux) else {
        book.absorb(power);
        return Next::Stop;
    };
    let scattered = power * sample.weight;
    book.absorb(power - scattered);
    if !walker.survives(scattered, u_survive) {
        return Next::Stop;
    }
    let vertex = Lit { scatterer: Scatterer::Surface { hit: &hit, bsdf: &bsdf }, wo, inside: walker.inside };
    let BsdfSample { wi, pdf_solid_angle, .. } = sample;
    let (dirac, specular) = (sample.is_dirac(), sample.is_specular());
    let bounce = Bounce { wi, pdf_solid_angle, dirac, specular };
    if visit(Event::Bounce(&vertex, bounce), walker.history.kind()) == Next::Stop {
        book.end(walker.power);
        return Next::Stop;
    }
    if segments_by(wo, sample.wi) == 0 {
        walker.history.pass();
    } else {
        walker.history.bounce(specular);
    }
    walker.inside = world.cross(walker.inside, &hit, -wo, sample.wi);
    walker.ray = leave(&hit.point, sample.wi);
    Next::Continue
}

/// Shows the photon that lands at a hit.
fn land(
    world: &World,
    walker: &Walker,
    hit: &Hit,
    bsdf: &Bsdf,
    visit: &mut impl FnMut(Event<'_>, PhotonKind) -> Next,
) -> Next {
    let wo = -walker.ray.direction;
    let normal = if wo.dot(hit.point.ng) > 0.0 { hit.point.ng } else { -hit.point.ng };
    let photon = Photon {
        position: hit.point.position,
        // A mask lets some photons pass, and those that land stand for them.
        power: walker.power / world.opacity(hit),
        wi: wo,
        normal,
        depth: u16::try_from(walker.depth()).unwrap_or(u16::MAX),
        light: walker.light,
    };
    let vertex = Lit { scatterer: Scatterer::Surface { hit, bsdf }, wo, inside: walker.inside };
    visit(Event::Surface(photon, &vertex), walker.history.kind())
}

/// A collision after so long a way: absorption by weight, and a new direction.
fn collide(
    settings: &WalkSettings,
    walker: &mut Walker,
    matter: &Matter,
    t: f32,
    sampler: &mut Sampler,
    book: &mut Balance,
    visit: &mut impl FnMut(Event<'_>, PhotonKind) -> Next,
) -> Next {
    let (position, wo, depth) = (walker.ray.at(t), -walker.ray.direction, walker.depth());
    let scattered = walker.power * matter.albedo(position);
    book.absorb_in_medium(walker.power - scattered);
    if scattered.is_black() {
        return Next::Stop;
    }
    let photon = VolumePhoton {
        position,
        power: scattered,
        wi: wo,
        depth: u16::try_from(depth).unwrap_or(u16::MAX),
        light: walker.light,
        medium: medium_number(walker.inside),
    };
    let scatterer = Scatterer::Medium { position, phase: matter.phase() };
    let vertex = Lit { scatterer, wo, inside: walker.inside };
    let kind = walker.history.kind_in_medium();
    let stopped = visit(Event::Collision(photon, &vertex), kind) == Next::Stop;
    if stopped || settings.max_photon_depth.is_some_and(|max| depth >= max) {
        book.end(scattered);
        return Next::Stop;
    }
    let (u, u_survive) = (sampler.next_2d(), sampler.next_1d());
    if !walker.survives(scattered, u_survive) {
        return Next::Stop;
    }
    let PhaseSample { wi, pdf_solid_angle } = matter.phase().sample(wo, u);
    let bounce = Bounce { wi, pdf_solid_angle, dirac: false, specular: false };
    visit(Event::Bounce(&vertex, bounce), kind);
    walker.history.collide();
    walker.ray = Ray::new(position, wi);
    Next::Continue
}

/// The beam that begins with a walker's next segment: all of it where it ends and the transmittance is known, as long as
/// the medium lets light be seen; else one that ends where the walker collides.
fn way(world: &World, walker: &Walker, matter: &Matter, end: f32) -> Beam {
    Beam {
        origin: walker.ray.origin,
        direction: walker.ray.direction,
        length: if end.is_finite() { end.min(matter.reach(&walker.ray)) } else { 2.0 * world.radius() },
        power: walker.power,
        depth: u16::try_from(walker.depth()).unwrap_or(u16::MAX),
        light: walker.light,
        medium: medium_number(walker.inside),
        long: end.is_finite() && matter.uniform_extinction().is_some(),
    }
}

/// The number of a medium as photons in it have it.
fn medium_number(inside: Surroundings) -> u16 {
    inside.medium().map_or(u16::MAX, |medium| medium.index() as u16)
}
