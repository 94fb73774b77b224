//! Glass that takes light apart: properties of our own on `dielectric` and `roughdielectric`.

use nephroid::handle::Handle;
use nephroid::material::{Dispersion, Material};

use super::properties::Plugin;
use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::log::shortened;

/// The wavelength that `int_ior` is for, in µm: Fraunhofer's line d.
const LINE_D_UM: f32 = 0.587_561_8;

/// The properties, one of which a material may have.
const PROPERTIES: [&str; 3] = ["abbe", "cauchy_b", "sellmeier"];

impl<'t> Reader<'t> {
    /// How the glass of a plugin disperses, if it says so: by its Abbe number or Cauchy's B in µm² beside `int_ior`, or by
    /// Sellmeier's three B and three C in µm², which stand for `int_ior`.
    pub(super) fn dispersion(&self, plugin: &Plugin<'t>, int_ior: f32) -> Option<Dispersion> {
        let given: Vec<&str> = PROPERTIES.into_iter().filter(|name| plugin.has(name)).collect();
        if let [_, second, ..] = given[..] {
            let at = plugin.property(PROPERTIES[1]).map_or(plugin.location(), |p| &p.location);
            self.log.error(at, format!("give one of {}, not \"{second}\" as well", PROPERTIES.join(", ")));
        }
        if let Some(abbe) = plugin.optional_float("abbe") {
            if abbe > 0.0 && abbe.is_finite() {
                return Some(Dispersion::from_abbe(int_ior, abbe));
            }
            self.log.error(plugin.location(), format!("\"abbe\" must be above zero, not {abbe}"));
        }
        if let Some(b) = plugin.optional_float("cauchy_b") {
            return Some(Dispersion::Cauchy { a: int_ior - b / (LINE_D_UM * LINE_D_UM), b });
        }
        let (text, at) = plugin.text("sellmeier")?;
        let numbers: Result<Vec<f32>, _> =
            text.split([',', ' ', '\t', '\n']).filter(|part| !part.is_empty()).map(str::parse).collect();
        match numbers.as_deref() {
            Ok(&[b1, b2, b3, c1, c2, c3]) => Some(Dispersion::Sellmeier { b: [b1, b2, b3], c: [c1, c2, c3] }),
            _ => {
                let message = format!("\"{}\" is not six numbers", shortened(text));
                self.log.push(Diagnostic::error(at, message).hint("write B1 B2 B3 C1 C2 C3, each C in µm²"));
                None
            }
        }
    }

    /// Stores a dielectric, in a wrapping that disperses where that is asked for.
    pub(super) fn store_glass(&mut self, plugin: &Plugin<'t>, glass: Material) -> Handle<Material> {
        let (Material::Dielectric { int_ior, .. } | Material::RoughDielectric { int_ior, .. }) = glass else {
            return self.store(plugin, glass);
        };
        let Some(dispersion) = self.dispersion(plugin, int_ior) else { return self.store(plugin, glass) };
        let mut glass = glass;
        if let Material::Dielectric { int_ior, .. } | Material::RoughDielectric { int_ior, .. } = &mut glass {
            *int_ior = dispersion.nominal_ior();
        }
        let inside = self.store(plugin, glass);
        self.store(plugin, Material::Dispersive { dispersion, inside })
    }
}
