//! What there is to tell of one camera sample.

use std::collections::BTreeMap;

use super::catalogue::Catalogue;
use crate::color::Rgb;
use crate::handle::Handle;
use crate::integrator::{
    Components, FromVolume, LightPart, LookUp, MapName, MediumLight, Met, Passed, Probe,
};
use crate::math::{Vec2, Vec3};
use crate::medium::Medium;
use crate::photon_map::{Gathered, Photon};
use crate::transport::Bounces;

/// One camera sample, and all that its estimate met. Lights, contributions and what media bring, of the whole sample,
/// add up to [`light`](Self::light), up to rounding.
#[derive(Clone, Debug, PartialEq)]
pub struct InspectedSample {
    /// The iteration it belongs to, from 0.
    pub iteration: u64,
    /// Its number within the pixel and the iteration, from 0.
    pub index: u32,
    /// Where its ray starts.
    pub origin: Vec3,
    /// Where its ray goes.
    pub direction: Vec3,
    /// Its weight by the reconstruction filter: 1, or of either sign for filters with negative lobes.
    pub weight: f32,
    /// Its light, in W/(m²·sr).
    pub light: Components,
    /// Surfaces that its path and gather rays met, in the order in which they were traced.
    pub surfaces: Vec<SurfaceMet>,
    /// Light that was found without photons.
    pub rays: Vec<RayLight>,
    /// Estimates from photon maps of surfaces.
    pub look_ups: Vec<LookUpReport>,
    /// Media that its path passed, and those of its gather rays where they count.
    pub media: Vec<MediumPassed>,
}

/// A surface that was met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceMet {
    /// The gather ray that met it; `None` for the camera path.
    pub gather_ray: Option<u64>,
    /// Segments from the lens to here.
    pub depth: u32,
    /// Where.
    pub position: Vec3,
    /// Unit shading normal, on the side it was seen from.
    pub normal: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// The index of the shape: first come those of the scene, then those of its groups.
    pub shape: u32,
    /// Whether all its lobes are Dirac ones.
    pub specular: bool,
    /// What reaches the camera of light from here, so far as the path decides it.
    pub throughput: Rgb,
}

/// Light that was found without photons: emission, or direct light by rays to the lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayLight {
    /// The surface that reflects it, in [`InspectedSample::surfaces`]; `None` for what the camera sees
    /// shine, be it in mirrors.
    pub surface: Option<usize>,
    /// What it counts as.
    pub part: LightPart,
    /// What it brings to the sample, in W/(m²·sr).
    pub radiance: Rgb,
}

/// A stretch of the way that lies in a medium, from one surface of any kind to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MediumPassed {
    /// The gather ray that passed it; `None` for the camera path. What gather rays find counts as global light.
    pub gather_ray: Option<u64>,
    /// Segments from the lens to its end.
    pub depth: u32,
    /// The medium, in [`Media::list`](crate::medium::Media::list).
    pub medium: Option<Handle<Medium>>,
    /// How long it is, in scene units; infinite where nothing ends it.
    pub length: f32,
    /// What it brings to the sample, in W/(m²·sr).
    pub light: MediumLight,
    /// The share of light from its end that comes through.
    pub transmittance: Rgb,
}

/// An estimate from a photon map.
#[derive(Clone, Debug, PartialEq)]
pub struct LookUpReport {
    /// The surface it was made for, in [`InspectedSample::surfaces`].
    pub surface: usize,
    /// The map.
    pub map: MapName,
    /// The radius it came to, in scene units.
    pub radius: f32,
    /// Photons within.
    pub count: u32,
    /// What they bring to the sample, by light and path; photons whose light is found by other means are
    /// left out.
    pub contributions: Vec<Contribution>,
}

/// What the photons of a light with paths of a kind bring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contribution {
    /// What it counts as.
    pub part: LightPart,
    /// The number of the light.
    pub light: u32,
    /// What the photons' paths met.
    pub bounces: Bounces,
    /// How many photons.
    pub photons: u32,
    /// What they bring to the sample, in W/(m²·sr).
    pub radiance: Rgb,
}

/// Takes down what the estimate of a sample meets.
pub(super) struct InspectProbe<'c> {
    catalogues: Option<&'c [Catalogue; 4]>,
    gather_ray: Option<u64>,
    base: Rgb,
    throughput: Rgb,
    /// The last surface of the camera path, and of what is being traced.
    camera_surface: Option<usize>,
    surface: Option<usize>,
    /// Photons of the look-up that is going on, whether each is direct light, and what it brings.
    photons: Vec<(Photon, bool, Rgb)>,
    surfaces: Vec<SurfaceMet>,
    rays: Vec<RayLight>,
    look_ups: Vec<LookUpReport>,
    media: Vec<MediumPassed>,
}

impl<'c> InspectProbe<'c> {
    /// `catalogues` are in the order of [`MapName::ALL`], those of surfaces; none without photons.
    pub fn new(catalogues: Option<&'c [Catalogue; 4]>) -> Self {
        Self {
            catalogues,
            gather_ray: None,
            base: Rgb::WHITE,
            throughput: Rgb::WHITE,
            camera_surface: None,
            surface: None,
            photons: Vec::new(),
            surfaces: Vec::new(),
            rays: Vec::new(),
            look_ups: Vec::new(),
            media: Vec::new(),
        }
    }

    /// Puts everything into the report of a sample.
    pub fn finish(self, sample: &mut InspectedSample) {
        (sample.surfaces, sample.rays, sample.look_ups) = (self.surfaces, self.rays, self.look_ups);
        sample.media = self.media;
    }

    fn carried(&self) -> Rgb {
        self.base * self.throughput
    }
}

impl Probe for InspectProbe<'_> {
    fn begin(&mut self, gather_ray: Option<u64>, base: Rgb) {
        (self.gather_ray, self.base, self.throughput) = (gather_ray, base, Rgb::WHITE);
        self.surface = self.camera_surface;
    }

    fn carry(&mut self, throughput: Rgb) {
        self.throughput = throughput;
    }

    fn surface(&mut self, met: &Met<'_>) {
        let point = &met.hit.point;
        self.surface = Some(self.surfaces.len());
        if self.gather_ray.is_none() {
            self.camera_surface = self.surface;
        }
        self.surfaces.push(SurfaceMet {
            gather_ray: self.gather_ray,
            depth: met.depth,
            position: point.position,
            normal: if met.wo.dot(point.ng) > 0.0 { point.ns } else { -point.ns },
            uv: point.uv,
            shape: met.hit.shape,
            specular: met.bsdf.is_dirac(),
            throughput: self.base * met.throughput,
        });
    }

    fn light(&mut self, part: LightPart, radiance: Rgb) {
        let radiance = self.carried() * radiance;
        if !radiance.is_black() {
            let surface = self.surface.filter(|_| part != LightPart::Emitted);
            self.rays.push(RayLight { surface, part, radiance });
        }
    }

    fn medium(&mut self, passed: &Passed) {
        let carried = self.carried();
        let Passed { medium, length, depth, light, transmittance } = *passed;
        let carry = |found: FromVolume| FromVolume { radiance: carried * found.radiance, ..found };
        let light = MediumLight {
            emitted: carried * light.emitted,
            single: carried * light.single,
            ambient: carried * light.ambient,
            volume: carry(light.volume),
            volume_caustic: carry(light.volume_caustic),
        };
        let gather_ray = self.gather_ray;
        self.media.push(MediumPassed { gather_ray, depth, medium, length, light, transmittance });
    }

    fn photon(&mut self, photon: &Photon, is_direct: bool, radiance: Rgb, _: Rgb) {
        self.photons.push((*photon, is_direct, radiance));
    }

    fn look_up(&mut self, look_up: &LookUp, gathered: Gathered) {
        let carried = self.carried();
        let mut sums: BTreeMap<(u32, Bounces), Contribution> = BTreeMap::new();
        for (photon, is_direct, radiance) in self.photons.drain(..) {
            let part = if is_direct { look_up.direct } else { look_up.other };
            let record = self.catalogues.and_then(|c| c.get(look_up.map as usize)?.find(&photon));
            let (Some(part), Some(record)) = (part, record) else { continue };
            let (light, bounces) = (record.photon.light, record.bounces);
            let nothing = Contribution { part, light, bounces, photons: 0, radiance: Rgb::BLACK };
            let sum = sums.entry((light, bounces)).or_insert(nothing);
            sum.photons += 1;
            sum.radiance += carried * radiance;
        }
        if let Some(surface) = self.surface {
            self.look_ups.push(LookUpReport {
                surface,
                map: look_up.map,
                radius: gathered.radius,
                count: gathered.count,
                contributions: sums.into_values().collect(),
            });
        }
    }
}
