//! `<medium>` and `<phase>`.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::medium::{Coefficient, Medium, Phase};

use super::document::Element;
use super::names::{MEDIA, PHASES, PHASES_LATER};
use super::properties::Plugin;
use super::reader::{Outcome, Reader};
use super::value::Value;
use crate::diagnostic::Diagnostic;
use crate::log::shortened;
use crate::spectra::Role;

impl<'t> Reader<'t> {
    /// A `<medium>`, read once however often it is referred to. `None` if the log says why.
    pub(super) fn medium(&mut self, element: &'t Element) -> Option<Handle<Medium>> {
        if let Some(outcome) = self.medium_of.get(&element.number) {
            return match outcome {
                Outcome::Done(handle) => Some(*handle),
                Outcome::Open | Outcome::Failed => None,
            };
        }
        let handle = self.new_medium(element);
        self.medium_of.insert(element.number, handle.map_or(Outcome::Failed, Outcome::Done));
        handle
    }

    fn new_medium(&mut self, element: &'t Element) -> Option<Handle<Medium>> {
        let plugin = self.plugin(element);
        if !MEDIA.contains(&plugin.kind) {
            self.unknown_kind(&plugin, &[MEDIA]);
            return None;
        }
        let scale = plugin.float("scale", 1.0);
        if let Some(property) = plugin.property("scale").filter(|_| scale < 0.0) {
            self.log.error(&property.location, format!("\"scale\" must not be negative, not {scale}"));
        }
        let coefficients = if let Some((name, at)) = plugin.text("material") {
            let message = format!("the coefficients of \"{}\" are not known here", shortened(name));
            self.log.push(Diagnostic::error(at, message).hint(
                "write them: <rgb name=\"sigma_s\" value=\"…\"/> and <rgb name=\"sigma_a\" value=\"…\"/>, \
                 scattering and absorption per length",
            ));
            None
        } else if plugin.has("sigma_s") || plugin.has("sigma_a") {
            Some(self.scattering_and_absorption(&plugin))
        } else {
            self.extinction_and_albedo(&plugin)
        };
        let emission = self.coefficient(&plugin, "emission", 0.0, Role::Emission);
        let ambient = self.color_property(&plugin, "ambient", 0.0, Role::Emission);
        let phase = match plugin.only_object("phase") {
            Some(phase) => self.phase(phase),
            None => Some(Phase::Isotropic),
        };
        // They choose between ways of getting the same picture.
        plugin.ignore(&["sample_emitters", "has_spectral_extinction"]);
        plugin.ignore(&["majorant_factor", "majorant_grid", "majorant_resolution_factor"]);
        plugin.finish();
        let (sigma_t, albedo) = coefficients?;
        let medium = Medium {
            name: plugin.name(),
            sigma_t: scaled(sigma_t, scale),
            albedo,
            emission: emission?,
            phase: phase?,
            ambient,
        };
        self.origins.media.push(plugin.location().clone());
        Some(self.media.list.push(medium))
    }

    fn extinction_and_albedo(&mut self, plugin: &Plugin<'t>) -> Option<(Coefficient, Coefficient)> {
        let sigma_t = self.coefficient(plugin, "sigma_t", 1.0, Role::Index);
        let albedo = self.coefficient(plugin, "albedo", 0.75, Role::Reflectance);
        if let (Some(Coefficient::Grid { .. }), "homogeneous", Some(property)) =
            (&sigma_t, plugin.kind, plugin.property("sigma_t"))
        {
            let message = "\"sigma_t\" of a homogeneous medium is the same everywhere";
            self.log
                .push(Diagnostic::error(&property.location, message).hint("write type=\"heterogeneous\""));
        }
        Some((sigma_t?, albedo?))
    }

    /// Extinction and albedo, from the other pair of numbers that says the same.
    fn scattering_and_absorption(&mut self, plugin: &Plugin<'t>) -> (Coefficient, Coefficient) {
        for (name, other) in [("sigma_s", "sigma_a"), ("sigma_a", "sigma_s")] {
            if !plugin.has(name) {
                self.log.error(plugin.location(), format!("\"{other}\" needs \"{name}\" beside it"));
            }
        }
        for name in ["sigma_t", "albedo"] {
            if let Some(property) = plugin.property(name) {
                let message = "give either \"sigma_s\" and \"sigma_a\" or \"sigma_t\" and \"albedo\"";
                self.log.error(&property.location, message);
            }
        }
        let sigma_s = self.color_property(plugin, "sigma_s", 0.0, Role::Index);
        let sigma_a = self.color_property(plugin, "sigma_a", 0.0, Role::Index);
        let sigma_t = sigma_s + sigma_a;
        let part = |s: f32, t: f32| if t == 0.0 { 0.0 } else { s / t };
        let albedo =
            Rgb::new(part(sigma_s.r, sigma_t.r), part(sigma_s.g, sigma_t.g), part(sigma_s.b, sigma_t.b));
        (Coefficient::Constant(sigma_t), Coefficient::Constant(albedo))
    }

    /// A property that may be a volume. `None` if the log says why.
    fn coefficient(
        &mut self,
        plugin: &Plugin<'t>,
        name: &'static str,
        default: f32,
        role: Role,
    ) -> Option<Coefficient> {
        match plugin.property(name).map(|property| &property.value) {
            Some(Value::Object(element)) if element.tag == "volume" => self.volume(element, role),
            _ => Some(Coefficient::Constant(self.color_property(plugin, name, default, role))),
        }
    }

    /// A `<phase>`. `None` if the log says why.
    fn phase(&mut self, element: &'t Element) -> Option<Phase> {
        let plugin = self.plugin(element);
        let phase = match plugin.kind {
            "isotropic" => Phase::Isotropic,
            "rayleigh" => Phase::Rayleigh,
            "hg" => {
                let g = plugin.float("g", 0.8);
                if let Some(property) = plugin.property("g").filter(|_| g.abs() >= 1.0) {
                    self.log.error(&property.location, format!("\"g\" must be between -1 and 1, not {g}"));
                }
                Phase::HenyeyGreenstein { g }
            }
            kind if PHASES_LATER.contains(&kind) => {
                let message = format!("phase \"{kind}\" cannot be rendered yet");
                if !self.lenient {
                    let message = Diagnostic::error(plugin.location(), message);
                    self.log.push(message.hint("--lenient takes \"isotropic\" in its place"));
                    return None;
                }
                self.log.warn(plugin.location(), format!("{message}; \"isotropic\" stands for it"));
                plugin.finish_approximated();
                return Some(Phase::Isotropic);
            }
            _ => {
                self.unknown_kind(&plugin, &[PHASES, PHASES_LATER]);
                return None;
            }
        };
        plugin.finish();
        Some(phase)
    }
}

fn scaled(coefficient: Coefficient, by: f32) -> Coefficient {
    match coefficient {
        Coefficient::Constant(value) => Coefficient::Constant(value * by),
        Coefficient::Grid { grid, to_world, scale } => {
            Coefficient::Grid { grid, to_world, scale: scale * by }
        }
    }
}
