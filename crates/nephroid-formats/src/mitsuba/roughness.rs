//! How rough surfaces are.

use nephroid::handle::Handle;
use nephroid::material::{Distribution, Roughness};
use nephroid::texture::Texture;

use super::properties::Plugin;
use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::spectra::Role;

/// What Mitsuba takes where nothing is said.
const ALPHA: f32 = 0.1;

/// Distributions by name. Those of versions before 2 that are not known here have their nearest kin, whose α means
/// the same.
const DISTRIBUTIONS: [(&str, Distribution); 4] = [
    ("beckmann", Distribution::Beckmann),
    ("ggx", Distribution::Ggx),
    ("phong", Distribution::Beckmann),
    ("as", Distribution::Beckmann),
];

impl<'t> Reader<'t> {
    /// `distribution` with `alpha`, or `alpha_u` and `alpha_v`.
    pub(super) fn roughness(&mut self, plugin: &Plugin<'t>) -> Roughness {
        let distribution = self.distribution(plugin);
        let sides = plugin.has("alpha_u") || plugin.has("alpha_v");
        if !sides {
            plugin.ignore(&["alpha_u", "alpha_v"]);
            let alpha = self.alpha(plugin, "alpha");
            return Roughness::isotropic(distribution, alpha);
        }
        if let Some(property) = plugin.property("alpha") {
            let message = "give either \"alpha\" or \"alpha_u\" and \"alpha_v\"";
            self.log.error(&property.location, message);
        }
        let alpha_u = self.alpha(plugin, "alpha_u");
        Roughness { distribution, alpha_u, alpha_v: self.alpha(plugin, "alpha_v") }
    }

    fn alpha(&mut self, plugin: &Plugin<'t>, name: &'static str) -> Handle<Texture> {
        self.texture_property(plugin, name, ALPHA, Role::Reflectance)
    }

    fn distribution(&self, plugin: &Plugin<'t>) -> Distribution {
        // How it is sampled changes no picture.
        plugin.ignore(&["sample_visible"]);
        let distribution = plugin.choice("distribution", Distribution::Beckmann, &DISTRIBUTIONS);
        if let Some((name, at)) = plugin.text("distribution")
            && ["phong", "as"].iter().any(|old| old.eq_ignore_ascii_case(name))
        {
            let message =
                format!("the distribution \"{name}\" is not known here; \"beckmann\" stands for it");
            self.log.push(Diagnostic::warning(at, message).hint("its highlights have shorter tails"));
        }
        distribution
    }
}
