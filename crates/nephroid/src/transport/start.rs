//! Where photon paths start: which light, from where, in which direction, with what power.

use super::history::History;
use super::walk::{Fog, LightChoice, MapKind, WalkSettings};
use crate::color::Rgb;
use crate::light::{EmissionNumbers, SphereSampling};
use crate::math::{Ray, Vec2, Vec3, warp};
use crate::sampling::Sampler;
use crate::shape::SurfacePoint;
use crate::world::{Surroundings, World, leave};

/// The start of a path.
#[derive(Debug)]
pub(crate) struct Start {
    pub light: usize,
    pub ray: Ray,
    /// The point of a surface that it leaves.
    pub surface: Option<SurfacePoint>,
    /// W, as if the path were alone. Black if nothing starts.
    pub power: Rgb,
    /// What it stands for of all the light that is given off, in W.
    pub emitted: Rgb,
    /// What it starts in.
    pub inside: Surroundings,
    pub(super) history: History,
}

/// Starts path `path`; `None` if there is no light.
pub(super) fn start(
    world: &World,
    settings: &WalkSettings,
    map: MapKind,
    path: u64,
    sampler: &mut Sampler,
) -> Option<Start> {
    let aims = world.aims();
    let aim = match map {
        _ if !settings.aim => None,
        MapKind::Global | MapKind::Volume => aims.global.as_ref(),
        MapKind::Caustic | MapKind::VolumeCaustic => aims.caustic.as_ref(),
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
    if let Some(medium) = emitter.medium() {
        let starts = settings.fog == Fog::Volume && matches!(map, MapKind::Global | MapKind::Volume);
        let found = world.glow(medium, emission.ray.origin).filter(|_| starts);
        let (inside, glow) = found.unwrap_or_default();
        let power = emission.power * glow / probability;
        let history = History::from_medium();
        let (ray, surface) = (emission.ray, None);
        return Some(Start { light, ray, surface, power, emitted: power, inside, history });
    }
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
    let (power, emitted) = (power / probability, emission.emitted / probability);
    let (inside, history) = (world.light_surroundings(light), History::default());
    Some(Start { light, ray, surface: emission.surface, power, emitted, inside, history })
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

/// A uniform direction by rejection (the report's §2.1.1, but normalised): points of
/// the cube until one lies in the ball and not so near its centre that its direction is rounding.
fn rejection_sphere(sampler: &mut Sampler) -> Vec3 {
    loop {
        let a = sampler.next_2d();
        let p = 2.0 * Vec3::new(a.x, a.y, sampler.next_1d()) - Vec3::ONE;
        let length_sq = p.length_squared();
        if length_sq <= 1.0 && length_sq > 1e-6 {
            return p / length_sq.sqrt();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Key, Sequence, Stream};

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
