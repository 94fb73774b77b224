//! Lights that show an image.

use std::f64::consts::PI;

use nephroid::camera::FovAxis;
use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::light::{EnvironmentMapping, LightKind, ProjectorUnit};
use nephroid::math::real::tan;
use nephroid::math::{DMat3, DVec3, Transform};
use nephroid::texture::Pixmap;

use super::image::{Change, is_encoded};
use super::light::luminance;
use super::parameters::Parameters;
use super::reader::Reader;
use crate::spectra::Role;

impl Reader<'_> {
    /// The sky: of one colour, or an image in a square of equal areas.
    pub(super) fn infinite(&mut self, parameters: &Parameters) -> Option<LightKind> {
        if let Some(portal) = parameters.any("portal") {
            self.log.warn(&portal.location, "\"portal\" is not needed and left out");
        }
        if parameters.has("filename") || parameters.has("mapname") {
            return self.sky(parameters);
        }
        Some(LightKind::Constant { radiance: self.strength(parameters, "L", "illuminance", PI) })
    }

    fn sky(&mut self, parameters: &Parameters) -> Option<LightKind> {
        let old = parameters.has("mapname");
        if let Some(radiance) = parameters.any("L").filter(|_| !old) {
            self.log.error(&radiance.location, "give either \"L\" or \"filename\"");
        }
        let to_world = self.rigid(parameters, self.state.ctm);
        if let Some((name, at)) = parameters.text("mapname") {
            self.log.warn(at, "\"mapname\" is of older files: by longitude and latitude, the zenith +z");
            let (path, bytes) = self.read_file(name, at)?;
            let image = self.decoded(&path, &bytes, !is_encoded(name), at)?;
            let mut scale = self.scale(parameters, "illuminance", 0.0);
            if let Some(found) = parameters.any("L") {
                let factor = self.color(parameters, "L", Rgb::WHITE, Role::Emission);
                if factor.max_channel() != factor.min_channel() {
                    self.log.warn(
                        &found.location,
                        "the image of a sky cannot be coloured: the mean of \"L\" counts",
                    );
                }
                scale *= factor.mean();
            }
            let image = self.store_image(image, at);
            // There longitude is the angle about z from +x; here columns go from −z by +x, and +y is up.
            let columns = DMat3::from_cols(DVec3::Y, DVec3::Z, -DVec3::X);
            let turn = Transform(nephroid::math::DAffine3::from_mat3(columns));
            let mapping = EnvironmentMapping::Equirectangular;
            return Some(LightKind::Environment { image, mapping, scale, to_world: turn.then(to_world?) });
        }
        let image = self.light_image(parameters)?;
        let size = (self.textures.images[image].width, self.textures.images[image].height);
        if size.0 != size.1 {
            if let Some((_, at)) = parameters.text("filename") {
                let message = format!(
                    "the image of a sky is a square of equal areas, and not {}×{} pixels",
                    size.0, size.1
                );
                self.log.error(at, message);
            }
            return None;
        }
        let of_one =
            if parameters.has("illuminance") { illuminance(&self.textures.images[image]) } else { 0.0 };
        let scale = self.scale(parameters, "illuminance", of_one);
        Some(LightKind::Environment {
            image,
            mapping: EnvironmentMapping::EqualArea,
            scale,
            to_world: to_world?,
        })
    }

    fn light_image(&mut self, parameters: &Parameters) -> Option<Handle<Pixmap>> {
        let raw = parameters.text("filename").is_none_or(|(name, _)| !is_encoded(name));
        self.named_image(parameters, Change::decoded(raw))
    }

    pub(super) fn goniometric(&mut self, parameters: &Parameters) -> Option<LightKind> {
        let raw = parameters.text("filename").is_none_or(|(name, _)| !is_encoded(name));
        let table = self.named_image(parameters, Change { grey: true, ..Change::decoded(raw) });
        let mean = table.map_or(1.0, |table| f64::from(self.textures.images[table].mean().g));
        let intensity = self.strength(parameters, "I", "power", 4.0 * PI * mean);
        // Its +y is the pole of the table.
        let columns = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Y);
        let turn = Transform(nephroid::math::DAffine3::from_mat3(columns));
        let to_world = self.rigid(parameters, turn.then(self.state.ctm));
        let mapping = EnvironmentMapping::EqualArea;
        Some(LightKind::Goniometric { to_world: to_world?, intensity, table: table?, mapping })
    }

    pub(super) fn projection(&mut self, parameters: &Parameters) -> Option<LightKind> {
        let fov =
            parameters.float_that("fov", 90.0, "between 0 and 180 degrees", |fov| fov > 0.0 && fov < 180.0);
        let image = self.light_image(parameters);
        let of_one = match image {
            Some(image) if parameters.has("power") => projected(&self.textures.images[image], fov as f32),
            _ => 0.0,
        };
        let scale = Rgb::splat(self.scale(parameters, "power", of_one));
        // The first column is on its −x.
        let mirror = Transform::scale(DVec3::new(-1.0, 1.0, 1.0));
        let to_world = self.rigid(parameters, mirror.then(self.state.ctm));
        Some(LightKind::Projector {
            to_world: to_world?,
            image: image?,
            scale,
            unit: ProjectorUnit::Intensity,
            fov_deg: fov as f32,
            fov_axis: FovAxis::Smaller,
        })
    }
}

/// What a patch that faces +z gets from a square of equal areas: the directions above it lie in the rhombus
/// |x| + |y| ≤ 1 of [−1, 1]², at heights of 1 − (|x| + |y|)² (Clarberg 2008).
fn illuminance(image: &Pixmap) -> f64 {
    let place = |i: u32, size: u32| (f64::from(i) + 0.5) / f64::from(size) * 2.0 - 1.0;
    let mut sum = 0.0;
    for y in 0..image.height {
        for x in 0..image.width {
            let r = place(x, image.width).abs() + place(y, image.height).abs();
            sum += (1.0 - r * r).max(0.0) * f64::from(luminance(image.pixel(x, y)));
        }
    }
    sum * 4.0 * PI / (f64::from(image.width) * f64::from(image.height))
}

/// The power of a projector of unit scale, in lumens per 683: the mean of intensity over the solid angle.
fn projected(image: &Pixmap, fov_deg: f32) -> f64 {
    let aspect = f64::from(image.width) / f64::from(image.height);
    let tan = f64::from(tan((0.5 * fov_deg).to_radians()));
    let half = if aspect > 1.0 { (tan * aspect, tan) } else { (tan, tan / aspect) };
    let place = |i: u32, size: u32, half: f64| ((f64::from(i) + 0.5) / f64::from(size) * 2.0 - 1.0) * half;
    let mut sum = 0.0;
    for y in 0..image.height {
        for x in 0..image.width {
            let (a, b) = (place(x, image.width, half.0), place(y, image.height, half.1));
            let cos = 1.0 / (1.0 + a * a + b * b).sqrt();
            sum += cos * cos * cos * f64::from(luminance(image.pixel(x, y)));
        }
    }
    sum * 4.0 * half.0 * half.1 / (f64::from(image.width) * f64::from(image.height))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sky of radiance one lights what faces it with π; 256² pixels are within a part in 10⁴ of the integral.
    #[test]
    fn an_even_sky_lights_with_pi() {
        let image = Pixmap::filled(256, 256, Rgb::WHITE);
        assert!((illuminance(&image) - PI).abs() < 1e-3, "{}", illuminance(&image));
    }

    /// The solid angle of a face of a cube as seen from its middle is 4π/6.
    #[test]
    fn a_projector_that_sees_a_right_angle_fills_a_sixth() {
        let image = Pixmap::filled(256, 256, Rgb::WHITE);
        assert!((projected(&image, 90.0) - 4.0 * PI / 6.0).abs() < 1e-3);
    }
}
