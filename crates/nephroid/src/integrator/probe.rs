//! Watching how a camera sample is estimated.

use super::Components;
use crate::color::Rgb;
use crate::film::{Aov, AovSample};
use crate::handle::Handle;
use crate::material::Bsdf;
use crate::math::Vec3;
use crate::medium::Medium;
use crate::photon_map::{Gathered, NearestList, Photon};
use crate::transport::PixelSample;
use crate::world::Hit;

/// The parts that light is booked under; see [`Components`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightPart {
    /// Lamps and sky seen directly or through specular surfaces.
    Emitted,
    /// Light that met one surface that is not specular, and came straight to it.
    Direct,
    /// All other light.
    Global,
    /// Light that came to such a surface by specular ones.
    Caustic,
    /// Light from a medium, directly or by specular surfaces.
    Medium,
}

impl LightPart {
    /// Every one of them.
    pub const ALL: [Self; 5] = [Self::Emitted, Self::Direct, Self::Global, Self::Caustic, Self::Medium];
}

/// The photon maps of an iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MapName {
    /// Light after at least one bounce off a surface that is not specular, and direct light where that
    /// comes from photons.
    Global,
    /// L S⁺ D.
    Caustic,
    /// L S⁺ D S* D, for surfaces whose other light gather rays bring.
    Afterglow,
    /// V S* D, light from media, for the same surfaces.
    Haze,
    /// Light in media but for caustics.
    Volume,
    /// L S⁺ V, caustics in media.
    VolumeCaustic,
}

impl MapName {
    /// Every one of them.
    pub const ALL: [Self; 6] =
        [Self::Global, Self::Caustic, Self::Afterglow, Self::Haze, Self::Volume, Self::VolumeCaustic];

    /// What the command line and exports call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Global => "global",
            Self::Caustic => "caustic",
            Self::Afterglow => "afterglow",
            Self::Haze => "haze",
            Self::Volume => "volume",
            Self::VolumeCaustic => "volume-caustic",
        }
    }
}

/// A surface that a path from the camera or a gather ray meets.
pub(crate) struct Met<'a> {
    pub hit: &'a Hit,
    pub bsdf: &'a Bsdf,
    pub wo: Vec3,
    /// Segments from the lens to here.
    pub depth: u32,
    /// What reaches the camera, or the surface that the gather ray left, of light from here.
    pub throughput: Rgb,
    /// Whether only specular surfaces lie before it.
    pub first: bool,
}

/// Which part of a picture the photons of a look-up count for: those of light that came straight from a
/// light, and all others. `None` if they do not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LookUp {
    pub map: MapName,
    pub direct: Option<LightPart>,
    pub other: Option<LightPart>,
}

/// What a map of light in media brings to a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FromVolume {
    /// Photons or beams that counted; where a ray is marched along, as often as steps counted them.
    pub count: u32,
    /// Their light, in W/(m²·sr).
    pub radiance: Rgb,
}

/// What a medium does to a ray on its way: the light that it adds, in W/(m²·sr) where the ray begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MediumLight {
    /// What it gives off.
    pub emitted: Rgb,
    /// What it scatters once, found by rays to the lights.
    pub single: Rgb,
    /// What it looks like everywhere, with the ambient approximation.
    pub ambient: Rgb,
    /// What the map holds of all light but caustics.
    pub volume: FromVolume,
    /// What the map of caustics holds.
    pub volume_caustic: FromVolume,
}

impl MediumLight {
    /// All of it.
    pub fn total(&self) -> Rgb {
        let from_maps = self.volume.radiance + self.volume_caustic.radiance;
        self.emitted + self.single + self.ambient + from_maps
    }
}

/// How light was found by a bidirectional method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// By a path from the camera that met a lamp.
    Met,
    /// By asking a lamp.
    Asked,
    /// By the connection to a light path.
    Connected,
    /// By a photon near by.
    Merged,
}

/// A stretch of a ray that lies in one medium.
pub(crate) struct Passed {
    pub medium: Option<Handle<Medium>>,
    /// May be infinite.
    pub length: f32,
    /// Segments from the lens to its end.
    pub depth: u32,
    pub light: MediumLight,
    /// The share of light from its end that comes through.
    pub transmittance: Rgb,
}

/// Watches the estimate of one camera sample. What it is told changes nothing; a render that wants to
/// know nothing passes `()`, and pays nothing.
pub(crate) trait Probe {
    /// Whether nothing is taken down, so that a sample without light need not be followed.
    const IDLE: bool = false;

    /// What follows reaches the camera by a gather ray, or without one, multiplied by `base`.
    fn begin(&mut self, _gather_ray: Option<u64>, _base: Rgb) {}
    /// What follows is multiplied by this before `base`.
    fn carry(&mut self, _throughput: Rgb) {}
    /// A surface is met, null ones excepted.
    fn surface(&mut self, _met: &Met<'_>) {}
    /// Light that was found without photons.
    fn light(&mut self, _part: LightPart, _radiance: Rgb) {}
    /// A ray looks for lamps and nothing else, up to the next surface.
    fn glance(&mut self) {}
    /// A medium is passed, and what it adds is multiplied as light without photons is.
    fn medium(&mut self, _passed: &Passed) {}
    /// A photon counts in the look-up that is going on, with the direct light or with the other. `_of_half` is what it
    /// would bring if the squared radius were half as large.
    fn photon(&mut self, _photon: &Photon, _is_direct: bool, _radiance: Rgb, _of_half: Rgb) {}
    /// A look-up is done.
    fn look_up(&mut self, _look_up: &LookUp, _gathered: Gathered) {}
    /// Photons that were merged with a path bring so much more than those within half of the squared radius would.
    fn blur(&mut self, _radiance: Rgb) {}
    /// One of several techniques found light. The densities of all of them are together so many times those of path
    /// tracing: infinitely many where that cannot find it.
    fn technique(&mut self, _name: Found, _radiance: Rgb, _over_paths: f32) {}
}

impl Probe for () {
    const IDLE: bool = true;
}

/// Two probes that watch the same.
impl<A: Probe, B: Probe> Probe for (A, B) {
    const IDLE: bool = A::IDLE && B::IDLE;

    fn begin(&mut self, gather_ray: Option<u64>, base: Rgb) {
        self.0.begin(gather_ray, base);
        self.1.begin(gather_ray, base);
    }

    fn carry(&mut self, throughput: Rgb) {
        self.0.carry(throughput);
        self.1.carry(throughput);
    }

    fn surface(&mut self, met: &Met<'_>) {
        self.0.surface(met);
        self.1.surface(met);
    }

    fn light(&mut self, part: LightPart, radiance: Rgb) {
        self.0.light(part, radiance);
        self.1.light(part, radiance);
    }

    fn glance(&mut self) {
        self.0.glance();
        self.1.glance();
    }

    fn medium(&mut self, passed: &Passed) {
        self.0.medium(passed);
        self.1.medium(passed);
    }

    fn photon(&mut self, photon: &Photon, is_direct: bool, radiance: Rgb, of_half: Rgb) {
        self.0.photon(photon, is_direct, radiance, of_half);
        self.1.photon(photon, is_direct, radiance, of_half);
    }

    fn look_up(&mut self, look_up: &LookUp, gathered: Gathered) {
        self.0.look_up(look_up, gathered);
        self.1.look_up(look_up, gathered);
    }

    fn blur(&mut self, radiance: Rgb) {
        self.0.blur(radiance);
        self.1.blur(radiance);
    }

    fn technique(&mut self, name: Found, radiance: Rgb, over_paths: f32) {
        self.0.technique(name, radiance, over_paths);
        self.1.technique(name, radiance, over_paths);
    }
}

/// An integrator that is ready to estimate camera samples.
pub(crate) trait Estimator: Sync {
    /// Estimates the light of one camera sample.
    fn radiance<P: Probe>(
        &self,
        sample: &mut PixelSample,
        neighbors: &mut NearestList,
        probe: &mut P,
    ) -> Components;
}

/// Takes down the further values of a camera sample.
pub(crate) struct AovProbe {
    origin: Vec3,
    gathering: bool,
    sample: AovSample,
}

impl AovProbe {
    pub fn new(sample: &PixelSample) -> Self {
        Self { origin: sample.ray.origin, gathering: false, sample: AovSample::default() }
    }

    /// All values, those of light included.
    pub fn finish(mut self, light: &Components) -> AovSample {
        self.sample.add_light(light.by_layer());
        self.sample
    }
}

impl Probe for AovProbe {
    fn begin(&mut self, gather_ray: Option<u64>, _base: Rgb) {
        self.gathering = gather_ray.is_some();
    }

    fn surface(&mut self, met: &Met<'_>) {
        if !met.first {
            return;
        }
        let point = &met.hit.point;
        let facing = |n: Vec3| if met.wo.dot(point.ng) > 0.0 { n } else { -n };
        if !self.sample.hit {
            self.sample.hit = true;
            self.sample.add(Aov::Depth, &[(point.position - self.origin).length()]);
            self.sample.add(Aov::Position, &point.position.to_array());
            self.sample.add(Aov::GeometricNormal, &facing(point.ng).to_array());
            self.sample.add(Aov::Uv, &point.uv.to_array());
        }
        if !met.bsdf.is_dirac() {
            let albedo = met.bsdf.diffuse_albedo() + met.bsdf.glossy_albedo();
            self.sample.add(Aov::Albedo, &(met.throughput * albedo).to_array());
            self.sample.add(Aov::Normal, &(facing(point.ns) * met.throughput.mean()).to_array());
        }
    }

    fn look_up(&mut self, look_up: &LookUp, gathered: Gathered) {
        if !self.gathering && !matches!(look_up.map, MapName::Afterglow | MapName::Haze) {
            self.sample.look_ups += 1;
            self.sample.add(Aov::Radius, &[gathered.radius]);
            self.sample.add(Aov::Count, &[gathered.count as f32]);
        }
    }
}
