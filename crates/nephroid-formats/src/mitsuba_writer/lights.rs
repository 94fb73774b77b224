//! Lights without a surface.

use std::f32::consts::FRAC_1_PI;

use nephroid::camera::FovAxis;
use nephroid::color::Rgb;
use nephroid::light::{EnvironmentMapping, LightKind, ProjectorUnit};
use nephroid::math::Vec3;

use super::Writer;
use super::textures::Range;

impl Writer<'_, '_> {
    pub(super) fn lights(&mut self) {
        let scene = self.scene;
        for light in &scene.lights {
            let id = self.id(&light.name);
            self.light(&id, &light.kind);
            if let Some(medium) = light.medium {
                self.xml.reference("", &self.media[medium.index()]);
            }
            self.xml.close();
        }
    }

    fn light(&mut self, id: &str, kind: &LightKind) {
        match kind {
            LightKind::Point { position, intensity } => {
                self.xml.plugin("emitter", "point", id);
                self.xml.point("position", *position);
                self.xml.rgb("intensity", *intensity);
            }
            LightKind::Spot { to_world, intensity, cutoff_deg, beam_width_deg, texture } => {
                self.xml.plugin("emitter", "spot", id);
                self.xml.transform("to_world", to_world);
                self.xml.rgb("intensity", *intensity);
                self.xml.float("cutoff_angle", *cutoff_deg);
                self.xml.float("beam_width", *beam_width_deg);
                if let Some(texture) = texture {
                    self.paint("texture", *texture, Range::Unit);
                }
            }
            LightKind::Directional { direction, irradiance } => {
                self.xml.plugin("emitter", "directional", id);
                self.xml.vector("direction", *direction);
                self.xml.rgb("irradiance", *irradiance);
            }
            LightKind::Sun { direction, irradiance, angular_radius_deg } => {
                if *angular_radius_deg > 0.0 {
                    self.warn(format!("{id}: Mitsuba has no disc at infinity: parallel light stands for it"));
                }
                self.xml.plugin("emitter", "directional", id);
                self.xml.vector("direction", -*direction);
                self.xml.rgb("irradiance", *irradiance);
            }
            LightKind::Constant { radiance } => {
                self.xml.plugin("emitter", "constant", id);
                self.xml.rgb("radiance", *radiance);
            }
            LightKind::Environment {
                image,
                mapping: EnvironmentMapping::Equirectangular,
                scale,
                to_world,
            } => {
                self.xml.plugin("emitter", "envmap", id);
                self.xml.string("filename", &self.images[image.index()].name);
                self.xml.float("scale", *scale);
                self.xml.transform("to_world", to_world);
            }
            LightKind::Environment { image, mapping: EnvironmentMapping::EqualArea, scale, .. } => {
                self.warn(format!("{id}: Mitsuba has no equal-area skies: their mean stands for it"));
                self.xml.plugin("emitter", "constant", id);
                self.xml.rgb("radiance", self.scene.textures.images[*image].mean() * *scale);
            }
            LightKind::Goniometric { to_world, intensity, table, .. } => {
                self.warn(format!(
                    "{id}: Mitsuba has no goniometric lights: one the same all around stands for it"
                ));
                self.xml.plugin("emitter", "point", id);
                self.xml.point("position", to_world.point(Vec3::ZERO));
                self.xml.rgb("intensity", *intensity * self.scene.textures.images[*table].mean());
            }
            LightKind::Projector { to_world, image, scale, unit, fov_deg, fov_axis } => {
                if *unit == ProjectorUnit::Intensity {
                    self.warn(format!("{id}: Mitsuba's projectors light screens evenly"));
                }
                if *scale != Rgb::splat(scale.mean()) {
                    self.warn(format!("{id}: Mitsuba's projectors have no colour but that of their image"));
                }
                self.xml.plugin("emitter", "projector", id);
                self.xml.transform("to_world", to_world);
                self.xml.float("fov", *fov_deg);
                self.xml.string("fov_axis", axis_name(*fov_axis));
                self.xml.float("scale", scale.mean() * FRAC_1_PI);
                let image = self.images[image.index()].clone();
                self.xml.open("texture", &[("type", "bitmap"), ("name", "irradiance")]);
                self.xml.string("filename", &image.name);
                if image.raw {
                    self.xml.boolean("raw", true);
                }
                self.xml.close();
            }
        }
    }
}

/// How Mitsuba calls it.
pub(super) fn axis_name(axis: FovAxis) -> &'static str {
    match axis {
        FovAxis::X => "x",
        FovAxis::Y => "y",
        FovAxis::Diagonal => "diagonal",
        FovAxis::Smaller => "smaller",
        FovAxis::Larger => "larger",
    }
}
