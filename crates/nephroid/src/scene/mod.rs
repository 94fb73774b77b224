//! A scene: plain data, after references, units and defaults of its file are resolved.

mod check;
mod check_lights;
mod check_shapes;
#[cfg(test)]
mod check_tests;
mod error;

pub(crate) use check::check;
pub use error::{Remark, SceneError, SceneErrors, Subject};

use crate::camera::Camera;
use crate::film::FilmSettings;
use crate::handle::Arena;
use crate::light::Light;
use crate::material::Material;
use crate::medium::Media;
use crate::shape::{Group, Instance, Mesh, Shape};
use crate::texture::Textures;

/// Everything a picture is made of. Build it by hand or read it from a file, then give it to
/// `World::new`, which finds every problem it has.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The viewpoint.
    pub camera: Camera,
    /// The picture.
    pub film: FilmSettings,
    /// Textures and images.
    pub textures: Textures,
    /// Materials.
    pub materials: Arena<Material>,
    /// Participating media and their grids.
    pub media: Media,
    /// Triangle meshes.
    pub meshes: Arena<Mesh>,
    /// Surfaces.
    pub shapes: Vec<Shape>,
    /// Groups of surfaces, seen by their instances only.
    pub groups: Arena<Group>,
    /// Groups at places.
    pub instances: Vec<Instance>,
    /// Lights without a surface.
    pub lights: Vec<Light>,
}

impl Scene {
    /// A scene with nothing in it.
    pub fn new(camera: Camera, film: FilmSettings) -> Self {
        Self {
            camera,
            film,
            textures: Textures::default(),
            materials: Arena::default(),
            media: Media::default(),
            meshes: Arena::default(),
            shapes: Vec::new(),
            groups: Arena::default(),
            instances: Vec::new(),
            lights: Vec::new(),
        }
    }

    /// All shapes in the order in which hits count them: those of the scene, then those of its groups.
    pub fn all_shapes(&self) -> impl Iterator<Item = &Shape> {
        self.shapes.iter().chain(self.groups.iter().flat_map(|group| &group.shapes))
    }

    /// Whether anything stands in a medium. Media that nothing names are nowhere.
    pub fn has_media(&self) -> bool {
        self.all_shapes().any(|shape| shape.boundary.is_named() || shape.boundary.light.is_some())
            || self.camera.medium.is_some()
            || self.lights.iter().any(|light| light.medium.is_some())
    }
}
