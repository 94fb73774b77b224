//! `<emitter>` elements outside shapes.

use std::f32::consts::PI;

use nephroid::color::Rgb;
use nephroid::light::{EnvironmentMapping, Light, LightKind, ProjectorUnit};
use nephroid::math::{Affine2, Vec2, Vec3};
use nephroid::texture::{BitmapFilter, Pixmap, Texture};

use super::document::Element;
use super::names::{EMITTERS, EMITTERS_LATER};
use super::properties::Plugin;
use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::ies::read_ies;
use crate::log::shortened;

/// Half of the angle of the spot that stands for a beam.
const BEAM_DEG: f32 = 0.1;
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
            "projector" => self.projector(&plugin),
            "sky" | "sun" | "sunsky" => {
                self.daylight(&plugin);
                return;
            }
            "ies" => self.ies(&plugin),
            "collimated" => Some(self.collimated(&plugin)),
            // One that shapes refer to.
            "area" if plugin.id().is_some() => return,
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

    /// Says which lamps no shape refers to.
    pub(super) fn warn_of_unused_lamps(&self, elements: &[Element]) {
        let lamps = elements.iter().filter(|e| e.tag == "emitter" && e.value_of("type") == Some("area"));
        for (id, element) in lamps.filter_map(|element| Some((element.value_of("id")?, element))) {
            if !self.lamps_shown.contains(id) {
                let message = format!("no shape refers to the emitter \"{}\"", shortened(id));
                self.log.warn(&element.location, message);
            }
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

    /// An image thrown by a pinhole. `irradiance` is Mitsuba's: what a white screen shows, and so 1/π of ours.
    fn projector(&mut self, plugin: &Plugin<'t>) -> Option<LightKind> {
        let to_world = plugin.transform("to_world");
        let scale = plugin.float("scale", 1.0) * PI;
        let (fov_deg, fov_axis, offset) = self.opening(plugin);
        if offset != Vec2::ZERO {
            self.log.warn(plugin.location(), "the principal point of a projector is the middle of its image");
        }
        let texture = self.texture_property(plugin, "irradiance", 1.0, Role::Emission);
        let image = match &self.textures.list[texture] {
            Texture::Bitmap(bitmap) => {
                if bitmap.to_uv != Affine2::IDENTITY || bitmap.filter == BitmapFilter::Nearest {
                    let message = "a projector shows its image whole, and linear between pixels";
                    self.log.warn(plugin.location(), message);
                }
                bitmap.image
            }
            Texture::Constant(value) => {
                let image = Pixmap::filled(1, 1, *value);
                self.origins.images.push(plugin.location().clone());
                self.textures.images.push(image)
            }
            _ => {
                self.log.error(plugin.location(), "a projector shows a \"bitmap\" or one colour");
                return None;
            }
        };
        let scale = Rgb::splat(scale);
        Some(LightKind::Projector {
            to_world,
            image,
            scale,
            unit: ProjectorUnit::Irradiance,
            fov_deg,
            fov_axis,
        })
    }

    /// A luminaire that was measured. It hangs along local −y, and `intensity` multiplies the candelas of its file.
    fn ies(&mut self, plugin: &Plugin<'t>) -> Option<LightKind> {
        let to_world = plugin.transform("to_world");
        let intensity = self.color_property(plugin, "intensity", 1.0, Role::Emission);
        let Some((name, at)) = plugin.text("filename") else {
            self.log.error(plugin.location(), "emitter \"ies\" lacks a filename");
            return None;
        };
        let (path, bytes) = self.read_file(name, at)?;
        match read_ies(&String::from_utf8_lossy(&bytes)) {
            Ok(profile) => {
                self.origins.images.push(at.clone());
                let table = self.textures.images.push(profile.table.into());
                let intensity = intensity * profile.peak_candela;
                let mapping = EnvironmentMapping::Equirectangular;
                Some(LightKind::Goniometric { to_world, intensity, table, mapping })
            }
            Err(error) => {
                self.log.error(at, format!("{}: {error}", path.display()));
                None
            }
        }
    }

    /// A beam without width, as a narrow spot of the same power.
    fn collimated(&mut self, plugin: &Plugin<'t>) -> LightKind {
        let message = format!("a beam without width cannot be rendered; a spot of {BEAM_DEG}° stands for it");
        self.log.warn(plugin.location(), message);
        let name = if plugin.has("power") { "power" } else { "irradiance" };
        let power = self.color_property(plugin, name, 1.0, Role::Emission);
        let half = 0.5 * BEAM_DEG.to_radians();
        // 2π (1 − cos θ) = 4π sin² θ/2, and the angle is its own sine.
        let solid_angle = 4.0 * PI * half * half;
        LightKind::Spot {
            to_world: plugin.transform("to_world"),
            intensity: power * (1.0 / solid_angle),
            cutoff_deg: BEAM_DEG,
            beam_width_deg: BEAM_DEG,
            texture: None,
        }
    }

    fn not_both(&self, plugin: &Plugin, one: &'static str, other: &'static str) {
        if plugin.has(one) && plugin.has(other) {
            self.log.error(plugin.location(), format!("give either \"{one}\" or \"{other}\""));
        }
    }
}
