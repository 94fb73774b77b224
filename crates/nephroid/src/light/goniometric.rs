use std::f32::consts::PI;

use super::EnvironmentMapping;
use super::aim::{Cones, Targets};
use super::emitter::{Emission, EmissionNumbers};
use super::sphere_image::{SphereImage, SphereSample};
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::{DMat3, Ray, Transform, Vec3};
use crate::texture::{Pixmap, Textures};

/// A point light whose intensity depends on the direction as a table tells.
#[derive(Clone, Debug)]
pub(crate) struct Goniometric {
    pub position: Vec3,
    intensity: Rgb,
    table: SphereImage,
    to_local: DMat3,
    to_world: DMat3,
}

impl Goniometric {
    /// `None` if the table holds no light.
    pub fn new(
        textures: &Textures,
        to_world: &Transform,
        intensity: Rgb,
        (table, mapping): (Handle<Pixmap>, EnvironmentMapping),
    ) -> Option<Self> {
        let rotation = to_world.0.matrix3;
        Some(Self {
            position: to_world.point(Vec3::ZERO),
            intensity,
            table: SphereImage::new(textures, table, mapping)?,
            to_local: rotation.inverse(),
            to_world: rotation,
        })
    }

    /// W/sr in a unit direction away from the light.
    pub fn intensity(&self, textures: &Textures, direction: Vec3) -> Rgb {
        let local = (self.to_local * direction.as_dvec3()).as_vec3().normalize();
        self.intensity * self.table.value(textures, local)
    }

    /// W: the integral of the intensity.
    pub fn power(&self) -> Rgb {
        self.intensity * self.table.mean() * (4.0 * PI)
    }

    /// By the table's brightness, or uniform over the solid angles of the targets if they are less than half of that of a
    /// lobe with as much light; `whole` is the power of the light.
    pub fn emit(
        &self,
        textures: &Textures,
        u: EmissionNumbers,
        targets: Option<&Targets>,
        whole: Rgb,
    ) -> Emission {
        let limit = 0.5 * self.table.lobe();
        let cones = targets.and_then(|t| Cones::seen_from(t, (self.position, 0.0), None, limit, |_, _| true));
        let Some(cones) = cones else {
            let Some(SphereSample { direction, value, pdf }) = self.table.sample(textures, u.direction)
            else {
                return Emission::elsewhere(self.position, Rgb::BLACK);
            };
            let direction = (self.to_world * direction.as_dvec3()).as_vec3().normalize();
            return Emission::whole(Ray::new(self.position, direction), None, self.intensity * value / pdf);
        };
        let position = self.position;
        cones.emit(position, u, whole, |direction| self.intensity(textures, direction))
    }
}
