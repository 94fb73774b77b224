//! Indices of refraction: numbers, names of transparent media, metals.

use nephroid::color::Rgb;
use nephroid::material::Metal;

use super::properties::Plugin;
use super::reader::Reader;
use super::value::Value;
use crate::diagnostic::Diagnostic;
use crate::log::shortened;
use crate::spectra::Role;
use crate::spectra::{Known, metal, names};

/// Indices of refraction by name, at 589 nm and room temperature (Hecht, Optics, 4th edition).
const IORS: [(&str, f32); 23] = [
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.472_9),
    ("benzene", 1.501),
    ("silicone oil", 1.520_45),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.504_6),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];

impl<'t> Reader<'t> {
    /// An index of refraction: a number, or the name of a medium.
    pub(super) fn ior(&self, plugin: &Plugin<'t>, name: &'static str, default: &str) -> f32 {
        let by_name = |wanted: &str| IORS.iter().find(|(known, _)| known.eq_ignore_ascii_case(wanted));
        let default = by_name(default).map_or(1.0, |(_, value)| *value);
        let Some(property) = plugin.property(name) else { return default };
        let value = match property.value {
            Value::Text(text) => match by_name(text) {
                Some((_, value)) => *value,
                None => {
                    let message =
                        format!("nothing with a known index of refraction is called \"{}\"", shortened(text));
                    let known = IORS.iter().map(|(name, _)| *name);
                    self.log.push(Diagnostic::error(&property.location, message).did_you_mean(text, known));
                    default
                }
            },
            Value::Float(v) => v as f32,
            Value::Integer(v) => v as f32,
            _ => {
                plugin.wrong_type(property, "a float or the name of a medium");
                default
            }
        };
        if value > 0.0 {
            return value;
        }
        self.log.error(&property.location, format!("\"{name}\" must be above zero, not {value}"));
        default
    }

    /// A part of the index of a metal. Spectra made RGB can have a negative channel, which no metal has.
    fn metal_index(&mut self, plugin: &Plugin<'t>, name: &'static str, default: f32) -> Rgb {
        let index = self.color_property(plugin, name, default, Role::Index);
        if index.to_array().iter().all(|v| *v >= 0.0 || !v.is_finite()) {
            return index;
        }
        if let Some(property) = plugin.property(name) {
            self.log.warn(
                &property.location,
                format!("\"{name}\" is negative in a channel, and becomes 0 there"),
            );
        }
        index.map(|v| v.max(0.0))
    }

    /// A conductor by its name, or by `eta` and `k`.
    pub(super) fn metal(&mut self, plugin: &Plugin<'t>) -> Metal {
        let material = plugin.text("material");
        if plugin.has("eta") || plugin.has("k") {
            if let Some((_, at)) = material.filter(|(name, _)| *name != "none") {
                self.log.error(at, "give either \"material\" or \"eta\" and \"k\"");
            }
            return Metal::Index {
                eta: self.metal_index(plugin, "eta", 0.0),
                k: self.metal_index(plugin, "k", 1.0),
            };
        }
        plugin.ignore(&["eta", "k"]);
        let Some((name, at)) = material.filter(|(name, _)| !name.eq_ignore_ascii_case("none")) else {
            return Metal::PerfectMirror;
        };
        match metal(name) {
            Some(Known::Index(eta, k)) => return Metal::Index { eta, k },
            Some(Known::Name) => {
                let message = format!("metal \"{name}\" cannot be rendered yet; it becomes a perfect mirror");
                self.log
                    .push(Diagnostic::warning(at, message).hint("give \"eta\" and \"k\" to have its colour"));
            }
            None => {
                let message = format!("unknown metal \"{}\"", shortened(name));
                self.log.push(Diagnostic::error(at, message).did_you_mean(name, names()));
            }
        }
        Metal::PerfectMirror
    }
}
