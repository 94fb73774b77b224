//! The end of a path at a lamp: with which densities light starts there, and is asked for.

use super::densities::{Kind, Node, Place};
use crate::color::Rgb;
use crate::light::{Asker, Source};
use crate::math::Vec3;
use crate::shape::SurfacePoint;
use crate::transport::{DirectLights, choice, light_pdf};
use crate::world::World;

/// The end of a path at a lamp, as seen from its next vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct LampEnd {
    pub place: Place,
    /// The lamp as a vertex; `arrival` is the density with which the next vertex asks for it.
    pub node: Node,
    /// The density of the lamp's directions, once the vertex itself has that of `node`: per steradian, and of a lamp
    /// infinitely far away per m² across.
    pub leaving: f32,
}

impl LampEnd {
    /// Of light with the radiance (of a lamp without extent the intensity, or the irradiance of parallel light) that it
    /// has there; black where no path starts.
    ///
    /// Paths start as the light is given off, evenly by power: the densities of point and direction together are L cos/Φ,
    /// with Φ for the power that is sent out. So it is whether light is aimed or not, but for what aiming makes uneven.
    fn new(
        world: &World,
        light: usize,
        place: Place,
        dirac: bool,
        asked: f32,
        radiance: Rgb,
        toward: Vec3,
    ) -> Self {
        let cosine = match place {
            Place::Surface { ng, .. } => ng.dot(toward).abs(),
            Place::Medium { .. } | Place::Point { .. } | Place::Distant { .. } => 1.0,
        };
        let started = radiance.mean() * cosine * starts_per_power(world, light);
        // A lamp that is never asked for still starts paths.
        let asked = if asked > 0.0 && asked.is_finite() { asked } else { 1.0 };
        Self {
            place,
            node: Node { arrival: asked, counter: 0.0, kind: Kind::Lamp { dirac }, far: true },
            leaving: started / asked,
        }
    }

    /// The point of a lamp's surface that is seen from `from`.
    pub fn on_surface(
        world: &World,
        light: usize,
        point: &SurfacePoint,
        radiance: Rgb,
        from: &Asker,
    ) -> Self {
        let to = from.position - point.position;
        let distance_sq = to.length_squared();
        let toward = to / distance_sq.sqrt();
        let per_area = point.ng.dot(toward).abs() / distance_sq;
        let asked = light_pdf(world, light, from, point, DirectLights::One) * per_area;
        let place = Place::Surface { position: point.position, ng: point.ng };
        Self::new(world, light, place, false, asked, radiance, toward)
    }

    /// A sky, in the direction in which it is seen from `from`.
    pub fn in_sky(world: &World, light: usize, direction: Vec3, radiance: Rgb, from: &Asker) -> Self {
        let chosen = choice(world, light, from, DirectLights::One);
        let emitter = &world.emitters()[light];
        let asked = emitter.pdf_of_sky(direction) * chosen;
        let sent = if emitter.sends_by(from.position, -direction) { radiance } else { Rgb::BLACK };
        Self::new(world, light, Place::Distant { direction }, false, asked, sent, -direction)
    }

    /// A Dirac lamp that lights `from` with an irradiance, from the direction `wi`.
    pub fn dirac(
        world: &World,
        light: usize,
        source: &Source,
        wi: Vec3,
        irradiance: Rgb,
        from: &Asker,
    ) -> Self {
        let chosen = choice(world, light, from, DirectLights::One);
        let (place, strength) = match source {
            Source::Point(position) => {
                (Place::Point { position: *position }, irradiance * from.position.distance_squared(*position))
            }
            _ if world.emitters()[light].sends_by(from.position, -wi) => {
                (Place::Distant { direction: wi }, irradiance)
            }
            _ => (Place::Distant { direction: wi }, Rgb::BLACK),
        };
        Self::new(world, light, place, true, chosen, strength, -wi)
    }

    /// The lamp that a photon path left, the first vertex of which is `from`, along `direction`. `None` if it cannot be
    /// asked for there.
    pub fn of_start(
        world: &World,
        light: usize,
        surface: Option<&SurfacePoint>,
        direction: Vec3,
        from: &Asker,
    ) -> Option<Self> {
        let emitter = &world.emitters()[light];
        if let Some(point) = surface {
            let radiance = emitter.surface_radiance(&world.scene().textures, point)?;
            return Some(Self::on_surface(world, light, point, radiance, from));
        }
        if emitter.is_sky() {
            let radiance = emitter.sky_radiance(&world.scene().textures, -direction);
            return Some(Self::in_sky(world, light, -direction, radiance, from));
        }
        let incident = emitter.sample_incident(world.lookup(), from.position, crate::math::Vec2::ZERO)?;
        Some(Self::dirac(world, light, &incident.source, incident.wi, incident.radiance, from))
    }
}

/// The share of paths that start at a light for each watt of it that is sent out, in 1/W.
fn starts_per_power(world: &World, light: usize) -> f32 {
    let (table, power) = match &world.aims().global {
        Some(aim) => (Some(&aim.lights), aim.sent[light]),
        None => (world.lights_by_power(), world.emitters()[light].power.mean()),
    };
    match table {
        Some(table) if power > 0.0 => table.pmf(light) / power,
        _ => 0.0,
    }
}
