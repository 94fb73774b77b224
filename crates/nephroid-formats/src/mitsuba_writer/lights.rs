//! Lights without a surface.

use nephroid::light::LightKind;

use super::Writer;
use super::textures::Range;

impl Writer<'_, '_> {
    pub(super) fn lights(&mut self) {
        let scene = self.scene;
        for light in &scene.lights {
            let id = self.id(&light.name);
            let kind = match light.kind {
                LightKind::Point { .. } => "point",
                LightKind::Spot { .. } => "spot",
                LightKind::Directional { .. } => "directional",
                LightKind::Constant { .. } => "constant",
                LightKind::Environment { .. } => "envmap",
            };
            self.xml.plugin("emitter", kind, &id);
            match &light.kind {
                LightKind::Point { position, intensity } => {
                    self.xml.point("position", *position);
                    self.xml.rgb("intensity", *intensity);
                }
                LightKind::Spot { to_world, intensity, cutoff_deg, beam_width_deg, texture } => {
                    self.xml.transform("to_world", to_world);
                    self.xml.rgb("intensity", *intensity);
                    self.xml.float("cutoff_angle", *cutoff_deg);
                    self.xml.float("beam_width", *beam_width_deg);
                    if let Some(texture) = texture {
                        self.paint("texture", *texture, Range::Unit);
                    }
                }
                LightKind::Directional { direction, irradiance } => {
                    self.xml.vector("direction", *direction);
                    self.xml.rgb("irradiance", *irradiance);
                }
                LightKind::Constant { radiance } => self.xml.rgb("radiance", *radiance),
                LightKind::Environment { image, scale, to_world } => {
                    self.xml.string("filename", &self.images[image.index()]);
                    self.xml.float("scale", *scale);
                    self.xml.transform("to_world", to_world);
                }
            }
            if let Some(medium) = light.medium {
                self.xml.reference("", &self.media[medium.index()]);
            }
            self.xml.close();
        }
    }
}
