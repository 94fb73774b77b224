//! What a path from the camera does at a vertex: it meets a lamp, asks one for its light, is connected to a light path, or
//! merged with photons.

use super::camera_paths::{Camera, Walk, book};
use super::densities::{Node, Trail};
use super::lamp::LampEnd;
use super::light_vertex::LightVertex;
use super::reach::Reach;
use super::weights::{MOST_CONNECTED, Technique, Weighed, Whole};
use crate::color::Rgb;
use crate::integrator::{Components, Found, LightPart, Probe};
use crate::light::{Asker, Source};
use crate::material::Bsdf;
use crate::photon_map::{MAX_THICKNESS, MIN_NORMAL_COSINE};
use crate::transport::{Lit, PixelSample};
use crate::world::Hit;

impl Camera<'_> {
    /// The weight of a lamp that the path meets.
    fn weight_of_lamp(&self, walk: &mut Walk, lamp: impl FnOnce(&Asker) -> LampEnd) -> Weighed {
        let Some(asker) = walk.trail.at.asker() else { return Weighed::ALONE };
        let lamp = lamp(&asker);
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
    pub(super) fn meet(
        &self,
        walk: &mut Walk,
        radiance: Rgb,
        lamp: impl FnOnce(&Asker) -> LampEnd,
        out: &mut Components,
        probe: &mut impl Probe,
    ) {
        if walk.scattered == 0 && self.glances {
            // Glances bring it.
            probe.technique(Found::Met, walk.throughput * radiance, 1.0);
            return;
        }
        let Weighed { weight, over_paths } = self.weight_of_lamp(walk, lamp);
        let light = walk.throughput * radiance * weight;
        probe.technique(Found::Met, light, over_paths);
        book(out, walk.part(), light, probe);
    }

    /// Light of lamps that are asked for it at a vertex.
    pub(super) fn direct(
        &self,
        lit: &Lit<'_>,
        walk: &mut Walk,
        sample: &mut PixelSample,
        probe: &mut impl Probe,
    ) -> Rgb {
        let (world, sampler, from) = (self.world, &mut sample.sampler, lit.vantage());
        if !world.has_lights_to_ask() {
            return Rgb::BLACK;
        }
        let asker = from.asker();
        let Some((light, probability)) = world.ask(&asker, sampler.next_1d()) else { return Rgb::BLACK };
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
            source if incident.dirac => LampEnd::dirac(world, light, source, wi, radiance, &asker),
            Source::Surface(point) => LampEnd::on_surface(world, light, point, radiance, &asker),
            _ => LampEnd::in_sky(world, light, wi, radiance, &asker),
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
    pub(super) fn connected(
        &self,
        lit: &Lit<'_>,
        walk: &mut Walk,
        sample: &mut PixelSample,
        probe: &mut impl Probe,
    ) -> Rgb {
        if !self.techniques.connects || walk.trail.nodes.len() > MOST_CONNECTED {
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
        let way = vertex.position - from.position();
        let distance_sq = way.length_squared();
        let Some(wi) = way.try_normalize() else { return Rgb::BLACK };
        let carried = lit.eval(wi) * vertex.power / distance_sq;
        if carried.is_black() {
            return Rgb::BLACK;
        }
        let bsdf = vertex.bsdf(world);
        let there = vertex.lit(bsdf.as_ref());
        let scattered = carried * there.spread(-wi);
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
    pub(super) fn merged(
        &self,
        hit: &Hit,
        bsdf: &Bsdf,
        walk: &mut Walk,
        out: &mut Components,
        probe: &mut impl Probe,
    ) {
        let reach = &self.techniques.reach;
        let radius = walk.merging_radius(reach);
        let area = reach.area(radius);
        if area <= 0.0 || bsdf.is_black() {
            return;
        }
        let (wo, position) = (-walk.ray.direction, hit.point.position);
        let normal = if wo.dot(hit.point.ng) > 0.0 { hit.point.ng } else { -hit.point.ng };
        let transmits = bsdf.transmits();
        let (at_first, scale) = (walk.at_first, walk.throughput / area);
        let [mut caustic, mut global, mut of_half] = [Rgb::BLACK; 3];
        self.paths.each_within(position, radius, |photon, place| {
            let height = (place - position).dot(normal);
            let alike = photon.normal.dot(normal);
            if (if transmits { alike.abs() } else { alike }) < MIN_NORMAL_COSINE
                || height.abs() > MAX_THICKNESS * radius
                || !self.fits(walk.depth + photon.depth)
            {
                return;
            }
            let f = bsdf.eval(wo, photon.wi) * bsdf.density_factor(photon.wi);
            if f.is_black() {
                return;
            }
            let Some((arrival, camera)) = up_to_photon(&mut walk.trail, bsdf.pdf(photon.wi, wo)) else {
                return;
            };
            let counters = [arrival, bsdf.pdf(wo, photon.wi) * photon.back];
            let path = Whole { light: self.paths.nodes_at(photon), counters, camera, far: true, at_first };
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
}

impl Walk {
    /// The radius within which photons are merged at the surface where the path is; 0 where none are.
    pub(super) fn merging_radius(&self, reach: &Reach) -> f32 {
        let far = self.trail.nodes.last().is_some_and(|node| node.far);
        reach.radius_at(self.scattered <= 1, self.at_first, far)
    }
}

/// The density with which a walk comes to its last vertex, which a photon takes the place of, and the vertices before. To
/// the last of these the light path goes on with this density per steradian.
pub(super) fn up_to_photon(trail: &mut Trail, onward: f32) -> Option<(f32, &[Node])> {
    let back = trail.back;
    let (last, before) = trail.nodes.split_last_mut()?;
    if let Some(before) = before.last_mut() {
        before.counter = onward * back;
    }
    Some((last.arrival, before))
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
