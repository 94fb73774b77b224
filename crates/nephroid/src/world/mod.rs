//! The world: a checked scene with everything that rendering needs prepared. Nothing in it changes,
//! and nothing that is done with it can fail.

mod build;
mod targets;

pub(crate) use targets::Aims;

use crate::bvh::Bvh;
use crate::camera::CameraRays;
use crate::color::Rgb;
use crate::handle::{Arena, Handle};
use crate::light::{Emitter, Lookup, Source};
use crate::material::{Bsdf, Material, Surface};
use crate::math::{Bounds, Frame, Ray, Vec3, offset_origin};
use crate::sampling::Discrete;
use crate::scene::Scene;
use crate::shape::{Intersection, Mesh, Primitive, ShearedRay, SurfacePoint};

/// A scene made ready to be rendered. See [`World::new`].
#[derive(Clone, Debug)]
pub struct World {
    scene: Scene,
    /// Meshes in world space, one for each shape that has one.
    meshes: Vec<Mesh>,
    primitives: Vec<Primitive>,
    /// The shape each primitive is a piece of.
    owner: Vec<u32>,
    /// How many of the primitives, from the first, are in the tree; the rest are infinite.
    in_tree: usize,
    bvh: Bvh,
    /// Whether light passes a shape as if it were not there.
    invisible: Vec<bool>,
    emitters: Vec<Emitter>,
    /// Emitters by power; `None` if there is no light at all.
    by_power: Option<Discrete>,
    /// Emitters as next event estimation asks them.
    for_direct: Option<Discrete>,
    /// The emitter each shape is, if it is one.
    emitter_of_shape: Vec<Option<u32>>,
    camera: CameraRays,
    bounds: Bounds,
    aims: Aims,
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray, in multiples of its direction.
    pub t: f32,
    /// The surface there.
    pub point: SurfacePoint,
    /// Index of the shape.
    pub shape: u32,
}

/// The shortening of shadow rays that keeps them off the light they end at; relative, as both ends
/// have been moved off their surfaces already.
const SHADOW_END: f32 = 1.0 - 1e-5;

impl World {
    /// The scene it was made from.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Bounds of the finite shapes; empty if there are none.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// How many lights there are.
    pub fn light_count(&self) -> usize {
        self.emitters.len()
    }

    /// Names and powers (W) of the lights.
    pub fn lights(&self) -> impl Iterator<Item = (&str, Rgb)> {
        self.emitters.iter().map(|e| (e.name.as_str(), e.power))
    }

    /// How many primitives rays are tested against.
    pub fn primitive_count(&self) -> usize {
        self.primitives.len()
    }

    pub(crate) fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    pub(crate) fn lights_by_power(&self) -> Option<&Discrete> {
        self.by_power.as_ref()
    }

    pub(crate) fn lights_for_direct(&self) -> Option<&Discrete> {
        self.for_direct.as_ref()
    }

    /// What photons are aimed at.
    pub(crate) fn aims(&self) -> &Aims {
        &self.aims
    }

    pub(crate) fn lookup(&self) -> Lookup<'_> {
        Lookup { meshes: &self.meshes, textures: &self.scene.textures }
    }

    pub(crate) fn camera(&self) -> &CameraRays {
        &self.camera
    }

    /// Whether any surface is a Dirac one, null ones aside: without, there are no caustics.
    pub(crate) fn has_dirac_surfaces(&self) -> bool {
        self.scene.shapes.iter().any(|s| is_dirac(&self.scene.materials, s.material))
    }

    /// The first surface a ray meets, null ones included.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let sheared = ShearedRay::new(ray.direction);
        let mut shortened = *ray;
        let mut nearest: Option<(usize, Intersection)> = None;
        let mut test = |range: std::ops::Range<usize>, ray: &mut Ray| {
            for i in range {
                if let Some(hit) = self.primitives[i].intersect(ray, &sheared) {
                    ray.t_max = hit.t;
                    nearest = Some((i, hit));
                }
            }
            false
        };
        test(self.in_tree..self.primitives.len(), &mut shortened);
        self.bvh.traverse(&mut shortened, &mut test);
        let (i, hit) = nearest?;
        let shape = self.owner[i];
        let point = self.primitives[i].surface(ray, &hit, &self.meshes);
        let flipped = self.scene.shapes[shape as usize].flip_normals;
        Some(Hit { t: hit.t, point: if flipped { point.flipped() } else { point }, shape })
    }

    /// Whether anything but null surfaces lies on the ray before its end.
    pub fn occluded(&self, ray: &Ray) -> bool {
        let sheared = ShearedRay::new(ray.direction);
        let mut blocked = false;
        let mut test = |range: std::ops::Range<usize>, ray: &mut Ray| {
            blocked = blocked
                || range.into_iter().any(|i| {
                    !self.invisible[self.owner[i] as usize]
                        && self.primitives[i].intersect(ray, &sheared).is_some()
                });
            blocked
        };
        let mut ray = *ray;
        if !test(self.in_tree..self.primitives.len(), &mut ray) {
            self.bvh.traverse(&mut ray, &mut test);
        }
        blocked
    }

    /// Whether light from `source` in direction `wi` reaches a point of a surface.
    pub fn visible(&self, from: &SurfacePoint, wi: Vec3, source: &Source) -> bool {
        let origin = offset_origin(from.position, from.error, from.ng, wi);
        let ray = match source {
            Source::Infinity => Ray::new(origin, wi),
            Source::Point(p) => Ray { origin, direction: *p - origin, t_max: SHADOW_END },
            Source::Surface(s) => {
                let end = offset_origin(s.position, s.error, s.ng, -wi);
                Ray { origin, direction: end - origin, t_max: SHADOW_END }
            }
        };
        !self.occluded(&ray)
    }

    /// How the surface scatters, seen from the side of `wo`.
    pub fn bsdf(&self, hit: &Hit, wo: Vec3) -> Bsdf {
        let material = self.scene.shapes[hit.shape as usize].material;
        let surface = Surface { ng: hit.point.ng, frame: Frame::from_normal(hit.point.ns), uv: hit.point.uv };
        Material::at(&self.scene.materials, material, &self.scene.textures, &surface, wo)
    }

    /// Radiance the surface itself emits towards `wo`, in W/(m²·sr), and the light it belongs to.
    pub fn emitted(&self, hit: &Hit, wo: Vec3) -> Option<(usize, Rgb)> {
        let emitter = self.emitter_of_shape[hit.shape as usize]?;
        let texture = self.scene.shapes[hit.shape as usize].emission?;
        (wo.dot(hit.point.ng) > 0.0)
            .then(|| (emitter as usize, self.scene.textures.eval(texture, hit.point.uv)))
    }

    /// Radiance that a ray which meets nothing sees, in W/(m²·sr).
    pub fn sky(&self, direction: Vec3) -> Rgb {
        self.emitters.iter().map(|e| e.sky_radiance(&self.scene.textures, direction)).sum()
    }
}

/// A ray that leaves a surface.
#[inline]
pub(crate) fn leave(point: &SurfacePoint, direction: Vec3) -> Ray {
    Ray::new(offset_origin(point.position, point.error, point.ng, direction), direction)
}

/// Whether either side of a material is a smooth conductor or dielectric.
fn is_dirac(materials: &Arena<Material>, material: Handle<Material>) -> bool {
    match materials[material] {
        Material::Conductor { .. } | Material::Dielectric { .. } | Material::ThinDielectric { .. } => true,
        Material::TwoSided { front, back } => is_dirac(materials, front) || is_dirac(materials, back),
        Material::Diffuse { .. } | Material::Phong { .. } | Material::Null => false,
    }
}
