//! `<emitter>` elements outside shapes.

use nephroid::light::{EnvironmentMapping, Light, LightKind};
use nephroid::math::Vec3;

use super::document::Element;
use super::names::{EMITTERS, EMITTERS_LATER};
use super::properties::Plugin;
use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::spectra::Role;

impl<'t> Reader<'t> {
    /// Reads an `<emitter>` into the scene; what is wrong goes to the log.
    pub(super) fn emitter(&mut self, element: &'t Element) {
        let plugin = self.plugin(element);
        plugin.ignore(&["sampling_weight"]);
        let kind = match plugin.kind {
            "point" => Some(self.point(&plugin)),
            "spot" => self.spot(&plugin),
            "directional" => self.directional(&plugin),
            "constant" => Some(LightKind::Constant {
                radiance: self.color_property(&plugin, "radiance", 1.0, Role::Emission),
            }),
            "envmap" => self.environment(&plugin),
            "area" => {
                let message =
                    Diagnostic::error(plugin.location(), "an \"area\" emitter belongs inside a shape");
                self.log.push(message.hint("move it into the <shape> that shines"));
                return;
            }
            kind if EMITTERS_LATER.contains(&kind) => {
                self.left_out(plugin.location(), &format!("emitter \"{kind}\""));
                return;
            }
            _ => {
                self.unknown_kind(&plugin, &[EMITTERS, EMITTERS_LATER]);
                return;
            }
        };
        let medium = self.surroundings(&plugin);
        plugin.finish();
        if let Some(kind) = kind {
            self.origins.lights.push(plugin.location().clone());
            self.lights.push(Light { name: plugin.name(), kind, medium });
        }
    }

    fn point(&mut self, plugin: &Plugin<'t>) -> LightKind {
        let to_world = plugin.transform("to_world");
        let position = match plugin.vector("position") {
            Some(position) => {
                self.not_both(plugin, "position", "to_world");
                position
            }
            None => to_world.point(Vec3::ZERO),
        };
        let intensity = self.color_property(plugin, "intensity", 1.0, Role::Emission);
        LightKind::Point { position, intensity }
    }

    fn spot(&mut self, plugin: &Plugin<'t>) -> Option<LightKind> {
        let to_world = plugin.transform("to_world");
        let intensity = self.color_property(plugin, "intensity", 1.0, Role::Emission);
        let cutoff_deg = plugin.positive("cutoff_angle", 20.0);
        let beam_width_deg = plugin.float("beam_width", cutoff_deg * 0.75);
        let texture =
            plugin.has("texture").then(|| self.texture_property(plugin, "texture", 1.0, Role::Reflectance));
        if cutoff_deg >= 180.0 || !(0.0..=cutoff_deg).contains(&beam_width_deg) {
            let message = format!(
                "a spot's angles must be 0 ≤ beam_width ≤ cutoff_angle < 180, not {beam_width_deg} and {cutoff_deg}"
            );
            self.log.error(plugin.location(), message);
            return None;
        }
        Some(LightKind::Spot { to_world, intensity, cutoff_deg, beam_width_deg, texture })
    }

    fn directional(&mut self, plugin: &Plugin<'t>) -> Option<LightKind> {
        let to_world = plugin.transform("to_world");
        let irradiance = self.color_property(plugin, "irradiance", 1.0, Role::Emission);
        let direction = match plugin.vector("direction") {
            Some(direction) => {
                self.not_both(plugin, "direction", "to_world");
                direction
            }
            None => to_world.vector(Vec3::Z),
        };
        // Through double precision, so that very short and very long vectors keep their direction.
        let Some(direction) = direction.as_dvec3().try_normalize() else {
            self.log.error(plugin.location(), "the direction has no length");
            return None;
        };
        Some(LightKind::Directional { direction: direction.as_vec3(), irradiance })
    }

    fn environment(&mut self, plugin: &Plugin<'t>) -> Option<LightKind> {
        let to_world = plugin.transform("to_world");
        let scale = plugin.float("scale", 1.0);
        plugin.ignore(&["mis_compensation"]);
        let image = self.image_property(plugin, false)?;
        Some(LightKind::Environment { image, mapping: EnvironmentMapping::Equirectangular, scale, to_world })
    }

    fn not_both(&self, plugin: &Plugin, one: &'static str, other: &'static str) {
        if plugin.has(one) && plugin.has(other) {
            self.log.error(plugin.location(), format!("give either \"{one}\" or \"{other}\""));
        }
    }
}
