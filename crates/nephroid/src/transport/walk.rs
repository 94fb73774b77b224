//! The random walk of a photon: from a light, over surfaces, to its end.

use super::ledger::Balance;
use super::roulette::survival;
use crate::color::Rgb;
use crate::light::{EmissionNumbers, SphereSampling};
use crate::material::Transport;
use crate::math::{Ray, Vec2, Vec3, warp};
use crate::photon_map::Photon;
use crate::sampling::Sampler;
use crate::world::{World, leave};

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
}

impl Default for WalkSettings {
    fn default() -> Self {
        Self {
            max_photon_depth: None,
            light_choice: LightChoice::default(),
            sphere_sampling: SphereSampling::default(),
            aim: true,
        }
    }
}

/// The map that paths are traced for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MapKind {
    /// All light.
    Global,
    /// Light that meets a specular surface first.
    Caustic,
}

/// What a photon's path makes of it, decided here and nowhere else. L is the light, S a Dirac
/// bounce, D any other; null surfaces count as nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhotonKind {
    /// L D: belongs to next event estimation, unless direct light comes from the map.
    Direct,
    /// L S+ D: the caustic map's.
    Caustic,
    /// L S+ D S* D: a caustic's light after one more bounce. The global map's, and known apart, since
    /// gather rays do not bring it.
    Afterglow,
    /// All the rest: the global map's.
    Global,
}

/// How a walk goes on after a photon has been shown to its visitor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    Continue,
    Stop,
}

/// The start of a path.
struct Start {
    light: usize,
    ray: Ray,
    /// W, as if the path were alone. Black if nothing starts.
    power: Rgb,
    /// What it stands for of all the light that is given off, in W.
    emitted: Rgb,
}

/// Starts path `path`; `None` if there is no light.
fn start(
    world: &World,
    settings: &WalkSettings,
    map: MapKind,
    path: u64,
    sampler: &mut Sampler,
) -> Option<Start> {
    let aims = world.aims();
    let aim = match map {
        _ if !settings.aim => None,
        MapKind::Global => aims.global.as_ref(),
        MapKind::Caustic => aims.caustic.as_ref(),
    };
    let (direction, position) = (sampler.next_2d(), sampler.next_2d());
    let (u_light, target, u_level) = (sampler.next_1d(), sampler.next_1d(), sampler.next_1d());
    let (light, probability) = match settings.light_choice {
        LightChoice::Power => {
            let table = aim.map(|aim| &aim.lights).or(world.lights_by_power())?;
            let (light, probability, _) = table.sample(u_light);
            (light, probability)
        }
        LightChoice::Equal => {
            let n = world.light_count();
            world.lights_by_power()?;
            ((path % n as u64) as usize, 1.0 / n as f32)
        }
    };
    let sphere = |u: Vec2| match settings.sphere_sampling {
        SphereSampling::SolidAngle => warp::square_to_sphere(u),
        SphereSampling::Rejection => rejection_sphere(sampler),
    };
    let (emitter, u) = (&world.emitters()[light], EmissionNumbers { position, direction, target });
    let emission = emitter.emit(world.lookup(), u, aim.map(|aim| &aim.targets), sphere);
    let ray = match emission.surface {
        Some(point) => leave(&point, emission.ray.direction),
        None if emitter.is_infinite() => aims.before_planes(emission.ray),
        None => emission.ray,
    };
    let power = match aim {
        Some(aim) if !aim.keeps(&ray) => Rgb::BLACK,
        Some(aim) if emission.power != emission.emitted => level(emission.power, aim.levels[light], u_level),
        _ => emission.power,
    };
    Some(Start { light, ray, power: power / probability, emitted: emission.emitted / probability })
}

/// Keeps photons that carry much less than others of their light with so much lower a probability,
/// and makes them carry so much more.
fn level(power: Rgb, level: f32, u: f32) -> Rgb {
    let survival = power.mean() / (0.5 * level);
    match survival {
        q if q >= 1.0 || power.is_black() => power,
        q if u < q => power / q,
        _ => Rgb::BLACK,
    }
}

/// A uniform direction by rejection (item 8 of the report, with the normalisation of E3): points of
/// the cube until one lies in the ball and not so near its centre that its direction is rounding.
pub(super) fn rejection_sphere(sampler: &mut Sampler) -> Vec3 {
    loop {
        let a = sampler.next_2d();
        let p = 2.0 * Vec3::new(a.x, a.y, sampler.next_1d()) - Vec3::ONE;
        let length_sq = p.length_squared();
        if length_sq <= 1.0 && length_sq > 1e-6 {
            return p / length_sq.sqrt();
        }
    }
}

/// What a path has met so far.
#[derive(Clone, Copy, Debug, Default)]
struct History {
    specular: u32,
    other: u32,
    /// Whether the first surface that was not specular was lit by one that was.
    from_caustic: bool,
}

impl History {
    fn bounces(&self) -> u32 {
        self.specular + self.other
    }

    /// What a photon is that lands now on a surface that is not specular.
    fn kind(&self) -> PhotonKind {
        match (self.specular, self.other) {
            (0, 0) => PhotonKind::Direct,
            (_, 0) => PhotonKind::Caustic,
            (_, 1) if self.from_caustic => PhotonKind::Afterglow,
            _ => PhotonKind::Global,
        }
    }

    fn bounce(&mut self, dirac: bool) {
        if dirac {
            self.specular += 1;
        } else {
            self.from_caustic |= self.other == 0 && self.specular > 0;
            self.other += 1;
        }
    }
}

/// Walks photon path `path`, showing every photon that lands on a surface with a density to
/// estimate to `visit`, and books where the power goes with the light it came from. What `map` has no
/// use for, from the start on, may be left out.
pub(super) fn walk(
    world: &World,
    settings: &WalkSettings,
    map: MapKind,
    path: u64,
    sampler: &mut Sampler,
    books: &mut [Balance],
    mut visit: impl FnMut(Photon, PhotonKind) -> Next,
) {
    let Some(Start { light, mut ray, mut power, emitted }) = start(world, settings, map, path, sampler)
    else {
        return;
    };
    let book = &mut books[light];
    book.emit(emitted);
    book.escape(emitted - power);
    if power.is_black() {
        return;
    }
    let mut roulette = [0.0f64; 3];
    let mut history = History::default();
    loop {
        let Some(hit) = world.intersect(&ray) else {
            book.escape(power);
            break;
        };
        let wo = -ray.direction;
        let bsdf = world.bsdf(&hit, wo);
        if bsdf.is_null() {
            ray = leave(&hit.point, ray.direction);
            continue;
        }
        let depth = history.bounces() + 1;
        if !bsdf.is_dirac() && !bsdf.is_black() {
            let normal = if wo.dot(hit.point.ng) > 0.0 { hit.point.ng } else { -hit.point.ng };
            let photon = Photon {
                position: hit.point.position,
                // A mask lets some photons pass, and those that land stand for them.
                power: power / world.opacity(&hit),
                wi: wo,
                normal,
                depth: u16::try_from(depth).unwrap_or(u16::MAX),
                light: light as u32,
            };
            if visit(photon, history.kind()) == Next::Stop {
                book.end(power);
                break;
            }
        }
        if settings.max_photon_depth.is_some_and(|max| depth >= max) {
            book.end(power);
            break;
        }
        let (u, u_lobe, u_survive) = (sampler.next_2d(), sampler.next_1d(), sampler.next_1d());
        let Some(sample) = bsdf.sample(wo, u, u_lobe, Transport::Flux) else {
            book.absorb(power);
            break;
        };
        let scattered = power * sample.weight;
        book.absorb(power - scattered);
        let q = survival(power, scattered, depth - 1);
        if u_survive >= q {
            take(&mut roulette, scattered);
            break;
        }
        let survivor = scattered / q;
        take(&mut roulette, scattered - survivor);
        power = survivor;
        history.bounce(sample.dirac);
        ray = leave(&hit.point, sample.wi);
    }
    book.roulette(roulette);
}

fn take(roulette: &mut [f64; 3], power: Rgb) {
    for (r, p) in roulette.iter_mut().zip(power.to_array()) {
        *r += f64::from(p);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Key, Sequence, Stream};

    #[test]
    fn a_path_decides_the_kind_of_its_photons() {
        // S: Dirac bounces, D: others; the photon is the D that follows.
        let kind = |path: &str| {
            let mut history = History::default();
            path.chars().for_each(|bounce| history.bounce(bounce == 'S'));
            history.kind()
        };
        assert_eq!(kind(""), PhotonKind::Direct);
        for path in ["S", "SS", "SSS"] {
            assert_eq!(kind(path), PhotonKind::Caustic, "{path}");
        }
        for path in ["SD", "SSD", "SDS", "SDSS"] {
            assert_eq!(kind(path), PhotonKind::Afterglow, "{path}");
        }
        for path in ["D", "DS", "DD", "SDD", "DSD", "SDSD"] {
            assert_eq!(kind(path), PhotonKind::Global, "{path}");
        }
    }

    #[test]
    fn rejection_gives_unit_vectors_with_the_moments_of_the_uniform_sphere() {
        let n = 100_000;
        let (mut mean, mut squares) = (Vec3::ZERO, Vec3::ZERO);
        for i in 0..n {
            let mut s = Sampler::new(Sequence::Independent, Key::new(5, 0, Stream::Pilot), i);
            let w = rejection_sphere(&mut s);
            assert!((w.length() - 1.0).abs() < 1e-5);
            mean += w;
            squares += w * w;
        }
        // Five standard errors: false positives below 4e-6 for the six numbers together.
        let n = n as f32;
        assert!((mean / n).abs().max_element() < 5.0 * (1.0 / 3.0 / n).sqrt());
        assert!((squares / n - Vec3::splat(1.0 / 3.0)).abs().max_element() < 5.0 * (4.0 / 45.0 / n).sqrt());
    }
}
