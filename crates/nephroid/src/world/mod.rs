//! The world: a checked scene with everything that rendering needs prepared. Nothing in it changes,
//! and nothing that is done with it can fail.

mod asking;
mod build;
mod cutout;
#[cfg(test)]
mod cutout_tests;
mod glow;
mod hues;
mod level;
mod nest;
#[cfg(test)]
mod nest_tests;
mod placed;
mod scenery;
#[cfg(test)]
mod spot_tests;
mod surroundings;
mod targets;
#[cfg(test)]
mod tests;
mod unit;
mod whereabouts;

pub use surroundings::Surroundings;
pub(crate) use surroundings::Vantage;
pub(crate) use targets::Aims;

use self::asking::Asked;
use self::hues::Hues;
use self::nest::{Rank, Ranked};
use self::scenery::Scenery;
use crate::camera::CameraRays;
use crate::color::Rgb;
use crate::handle::Handle;
use crate::light::{Emitter, Lookup};
use crate::material::{Bsdf, Material, Surface};
use crate::math::{Bounds, Ray, Vec2, Vec3, offset_origin};
use crate::medium::{Boundary, Matter};
use crate::sampling::Discrete;
use crate::scene::{Remark, Scene, Subject};
use crate::shape::SurfacePoint;
use crate::texture::{Texture, TexturePoint};

/// A scene made ready to be rendered. See [`World::new`].
#[derive(Clone, Debug)]
pub struct World {
    scene: Scene,
    scenery: Scenery,
    /// What is known of each shape of the scene, then of each shape of its groups.
    surfaces: Vec<Surfaced>,
    /// Whether any shape is masked: see [`World::is_there`].
    cutouts: bool,
    /// Whether light passes some shape as if it were not there.
    transparent: bool,
    emitters: Vec<Emitter>,
    /// Those of them that rays which meet nothing see.
    skies: Vec<u32>,
    /// Whether any of these is one of which most directions bring some.
    wide_sky: bool,
    /// Whether any of them is a Dirac one.
    dirac_lamps: bool,
    /// How many of them are no media; those that are come last.
    surface_lights: usize,
    /// Emitters by power; `None` if there is no light at all.
    by_power: Option<Discrete>,
    /// How next event estimation asks emitters.
    asked: Asked,
    camera: CameraRays,
    /// What paths are taken apart into; `None` if no glass does that.
    hues: Option<Hues>,
    bounds: Bounds,
    aims: Aims,
    /// What each emitter is in the scene.
    lamps: Vec<Subject>,
    /// The shapes that have a priority.
    ranked: Vec<Ranked>,
    /// The media of the scene, if any of them is anywhere.
    matters: Vec<Matter>,
    camera_surroundings: Surroundings,
    light_surroundings: Vec<Surroundings>,
    remarks: Vec<Remark>,
}

/// What rays ask of a shape.
#[derive(Clone, Copy, Debug)]
struct Surfaced {
    material: Handle<Material>,
    flipped: bool,
    /// Whether light passes it as if it were not there.
    invisible: bool,
    /// Whether light passes it by chance.
    masked: bool,
    /// Whether it has colours at its vertices.
    colored: bool,
    /// Whether its material asks for tangents.
    oriented: bool,
    /// The radiance and number of the light that it is.
    light: Option<(Handle<Texture>, u32)>,
    /// What it lies between, if it names any medium.
    boundary: Option<Boundary>,
    /// Its place among the shapes that have a priority; 0 if it has none.
    rank: Rank,
    /// Whether it refracts each wavelength another way.
    disperses: bool,
}

/// Where a ray meets a surface, as the search finds it: see [`World::nearest`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Distance along the ray, in multiples of its direction.
    pub t: f32,
    /// Of a triangle the weight of the second vertex; of other primitives a coordinate of their own.
    pub u: f32,
    /// Of a triangle the weight of the third vertex; of other primitives a coordinate of their own.
    pub v: f32,
    /// Index of the shape: first come those of the scene, then those of its groups.
    pub shape: u32,
    /// Of a mesh which triangle; else which of all primitives.
    pub primitive: u32,
    /// The instance by which the shape is seen, if it is one of a group.
    pub instance: Option<u32>,
}

/// The surface where a ray meets it.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray, in multiples of its direction.
    pub t: f32,
    /// The surface there.
    pub point: SurfacePoint,
    /// Index of the shape: first come those of the scene, then those of its groups.
    pub shape: u32,
    /// Where on the shape: what few ask is told from it when they do.
    spot: Spot,
}

/// A place on a shape.
#[derive(Clone, Copy, Debug)]
struct Spot {
    u: f32,
    v: f32,
    primitive: u32,
    instance: Option<u32>,
}

impl Hit {
    fn new(hit: &RayHit, point: SurfacePoint) -> Self {
        let &RayHit { t, u, v, shape, primitive, instance } = hit;
        Self { t, point, shape, spot: Spot { u, v, primitive, instance } }
    }
}

impl World {
    /// The scene it was made from.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Bounds of the finite shapes and the instances; empty if there are none.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Radius of a sphere around the finite shapes and the camera.
    pub(crate) fn radius(&self) -> f32 {
        self.aims.reach
    }

    /// What of the scene may not be meant so.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    /// How many lights there are.
    pub fn light_count(&self) -> usize {
        self.emitters.len()
    }

    /// Names and powers (W) of the lights.
    pub fn lights(&self) -> impl Iterator<Item = (&str, Rgb)> {
        self.emitters.iter().map(|e| (e.name.as_str(), e.power))
    }

    /// How many primitives rays are tested against; those of a group count once.
    pub fn primitive_count(&self) -> usize {
        self.scenery.count
    }

    /// Bytes of the trees that rays go through, with the primitives in their leaves.
    pub fn tree_bytes(&self) -> usize {
        self.scenery.bytes()
    }

    pub(crate) fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    pub(crate) fn lights_by_power(&self) -> Option<&Discrete> {
        self.by_power.as_ref()
    }

    /// What photons are aimed at.
    pub(crate) fn aims(&self) -> &Aims {
        &self.aims
    }

    pub(crate) fn lookup(&self) -> Lookup<'_> {
        Lookup { meshes: self.scenery.meshes.as_slice(), textures: &self.scene.textures }
    }

    pub(crate) fn camera(&self) -> &CameraRays {
        &self.camera
    }

    /// The emitters that rays which meet nothing see, with their numbers.
    pub(crate) fn skies(&self) -> impl Iterator<Item = (usize, &Emitter)> {
        self.skies.iter().map(|&number| (number as usize, &self.emitters[number as usize]))
    }

    /// Whether light comes from a sky, in most directions.
    pub(crate) fn has_wide_sky(&self) -> bool {
        self.wide_sky
    }

    /// Whether any lamp is a Dirac one, which no path meets by chance.
    pub(crate) fn has_dirac_lamps(&self) -> bool {
        self.dirac_lamps
    }

    /// Whether any surface has Dirac lobes, null ones aside.
    pub(crate) fn has_dirac_surfaces(&self) -> bool {
        self.aims.dirac
    }

    /// Whether any surface may have lobes that are Diracs or nearly so: without, there are no caustics.
    pub(crate) fn has_specular_surfaces(&self) -> bool {
        self.aims.specular
    }

    /// The first surface a ray meets, null ones included.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.nearest(ray)?;
        Some(Hit::new(&hit, self.surface(ray, &hit)))
    }

    /// Where a ray first meets a surface, null ones included: the search alone. The surface there is for
    /// [`Self::surface`] to tell.
    pub fn nearest(&self, ray: &Ray) -> Option<RayHit> {
        if self.cutouts {
            self.scenery.nearest(ray, |hit| self.is_there(ray, hit))
        } else {
            self.scenery.nearest(ray, |_| true)
        }
    }

    /// The surface at a hit of this ray.
    #[inline]
    pub fn surface(&self, ray: &Ray, hit: &RayHit) -> SurfacePoint {
        let point = self.scenery.surface(ray, hit);
        if self.surfaces[hit.shape as usize].flipped { point.flipped() } else { point }
    }

    /// Whether anything but null surfaces lies on the ray before its end. Priorities count for nothing here: what
    /// they hide depends on where a ray comes from.
    pub fn occluded(&self, ray: &Ray) -> bool {
        if self.cutouts || self.transparent {
            self.scenery.any(ray, |hit| {
                !self.surfaces[hit.shape as usize].invisible && (!self.cutouts || self.is_there(ray, hit))
            })
        } else {
            self.scenery.any(ray, |_| true)
        }
    }

    /// What a shape is made of, counted as in [`Hit::shape`]; of a masked one, and of one whose normals are changed, what is inside.
    pub(crate) fn material_of(&self, shape: u32) -> &Material {
        let material = self.surfaces[shape as usize].material;
        &self.scene.materials[Material::boundary(&self.scene.materials, material)]
    }

    /// How the surface scatters, seen from the side of `wo` and not from inside of any shape with a priority.
    pub fn bsdf(&self, hit: &Hit, wo: Vec3) -> Bsdf {
        let material = self.surfaces[hit.shape as usize].material;
        let (SurfacePoint { ng, ns, uv, .. }, at) = (hit.point, self.texture_point(hit));
        let surface = if self.surfaces[hit.shape as usize].oriented {
            Surface::oriented(ng, ns, at, self.scenery.tangents(hit.shape, &hit.spot, uv))
        } else {
            Surface::new(ng, ns, at)
        };
        Material::at(&self.scene.materials, material, &self.scene.textures, &surface, wo)
    }

    /// Where textures are read at a hit.
    fn texture_point(&self, hit: &Hit) -> TexturePoint {
        let Hit { point, shape, spot, .. } = hit;
        if self.surfaces[*shape as usize].colored {
            let color = self.scenery.color(*shape, spot.primitive, Vec2::new(spot.u, spot.v));
            TexturePoint { uv: point.uv, color }
        } else {
            point.uv.into()
        }
    }

    /// Radiance the surface itself emits towards `wo`, in W/(m²·sr), and the light it belongs to.
    pub fn emitted(&self, hit: &Hit, wo: Vec3) -> Option<(usize, Rgb)> {
        let (texture, emitter) = self.surfaces[hit.shape as usize].light?;
        (wo.dot(hit.point.ng) > 0.0)
            .then(|| (emitter as usize, self.scene.textures.eval(texture, hit.point.uv)))
    }

    /// Radiance that a ray which meets nothing sees, in W/(m²·sr).
    pub fn sky(&self, direction: Vec3) -> Rgb {
        self.skies().map(|(_, e)| e.sky_radiance(&self.scene.textures, direction)).sum()
    }
}

/// A ray that leaves a surface.
#[inline]
pub(crate) fn leave(point: &SurfacePoint, direction: Vec3) -> Ray {
    Ray::new(offset_origin(point.position, point.error, point.ng, direction), direction)
}
