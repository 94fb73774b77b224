use std::f32::consts::PI;

use super::EnvironmentMapping;
use super::aim::{Cone, Targets};
use super::emitter::{Emission, EmissionNumbers, Incident, Source, Target};
use super::sphere_image::{SphereImage, SphereSample};
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::real::sin;
use crate::math::{DMat3, Transform, Vec2, Vec3, warp};
use crate::texture::{Pixmap, Textures};

/// The same radiance from everywhere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConstantSky {
    pub radiance: Rgb,
    pub target: Target,
}

impl ConstantSky {
    pub fn power(&self) -> Rgb {
        self.radiance * (4.0 * PI * self.target.silhouette())
    }

    pub fn sample_incident(&self, u: Vec2) -> Incident {
        incident(warp::square_to_sphere(u), self.radiance, warp::SPHERE_PDF)
    }

    /// Starts in a direction uniform over the sphere.
    pub fn emit(&self, u: EmissionNumbers, targets: Option<&Targets>, direction: Vec3) -> Emission {
        self.target.emit(direction, self.radiance * (4.0 * PI), u, targets)
    }
}

/// Radiance from an image of all directions, sampled by its brightness.
#[derive(Clone, Debug)]
pub(crate) struct EnvironmentMap {
    sphere: SphereImage,
    scale: f32,
    to_local: DMat3,
    to_world: DMat3,
    pub target: Target,
}

impl EnvironmentMap {
    /// `None` if the image holds no light.
    pub fn new(
        textures: &Textures,
        (image, mapping): (Handle<Pixmap>, EnvironmentMapping),
        scale: f32,
        to_world: &Transform,
        target: Target,
    ) -> Option<Self> {
        let rotation = to_world.0.matrix3;
        Some(Self {
            sphere: SphereImage::new(textures, image, mapping)?,
            scale,
            to_local: rotation.inverse(),
            to_world: rotation,
            target,
        })
    }

    /// W that reach the target.
    pub fn power(&self) -> Rgb {
        self.sphere.mean() * (self.scale * 4.0 * PI * self.target.silhouette())
    }

    /// The largest radiance that is seen of it, of any channel.
    pub fn brightest(&self, textures: &Textures) -> f32 {
        self.sphere.brightest(textures) * self.scale
    }

    /// Radiance seen in a world direction.
    pub fn radiance(&self, textures: &Textures, direction: Vec3) -> Rgb {
        self.sphere.value(textures, self.local(direction)) * self.scale
    }

    fn local(&self, direction: Vec3) -> Vec3 {
        (self.to_local * direction.as_dvec3()).as_vec3().normalize()
    }

    /// Density of a world direction per unit solid angle.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        self.sphere.pdf(self.local(direction))
    }

    pub fn sample_incident(&self, textures: &Textures, u: Vec2) -> Option<Incident> {
        let SphereSample { direction, value, pdf } = self.sphere.sample(textures, u)?;
        let wi = (self.to_world * direction.as_dvec3()).as_vec3().normalize();
        Some(incident(wi, value * self.scale, pdf))
    }

    pub fn emit(&self, textures: &Textures, u: EmissionNumbers, targets: Option<&Targets>) -> Emission {
        match self.sample_incident(textures, u.direction) {
            Some(from) => self.target.emit(-from.wi, from.radiance / from.pdf_solid_angle, u, targets),
            None => Emission::elsewhere(self.target.center, Rgb::BLACK),
        }
    }
}

/// A disk at infinity, evenly bright.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sun {
    disk: Cone,
    radiance: Rgb,
    pub target: Target,
}

impl Sun {
    /// Towards a unit direction, with an angular radius above 0 and below 90°. Of a radius α and radiance L the irradiance
    /// is πL sin²α.
    pub fn new(direction: Vec3, irradiance: Rgb, angular_radius_deg: f32, target: Target) -> Self {
        let radius = angular_radius_deg.to_radians();
        let disk = Cone { axis: direction, one_minus_cos: warp::one_minus_cos(radius) };
        Self { disk, radiance: irradiance / (PI * sin(radius) * sin(radius)), target }
    }

    /// W that reach the target.
    pub fn power(&self) -> Rgb {
        self.radiance * (self.disk.solid_angle() * self.target.silhouette())
    }

    /// The largest radiance that is seen of it, of any channel.
    pub fn brightest(&self) -> f32 {
        self.radiance.max_channel()
    }

    /// Radiance seen in a direction.
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        if self.disk.contains(direction) { self.radiance } else { Rgb::BLACK }
    }

    /// Density of a direction per unit solid angle.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        if self.disk.contains(direction) { 1.0 / self.disk.solid_angle() } else { 0.0 }
    }

    pub fn sample_incident(&self, u: Vec2) -> Incident {
        incident(self.disk.sample(u), self.radiance, 1.0 / self.disk.solid_angle())
    }

    pub fn emit(&self, u: EmissionNumbers, targets: Option<&Targets>) -> Emission {
        let direction = -self.disk.sample(u.direction);
        self.target.emit(direction, self.radiance * self.disk.solid_angle(), u, targets)
    }
}

fn incident(wi: Vec3, radiance: Rgb, pdf_solid_angle: f32) -> Incident {
    Incident { wi, radiance, pdf_solid_angle, dirac: false, source: Source::Infinity }
}
