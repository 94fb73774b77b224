//! `principled` and `principledthin`.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::material::{Material, MetallicRoughness, Principled};
use nephroid::texture::Texture;

use super::properties::Plugin;
use super::reader::Reader;
use crate::spectra::Role;

impl<'t> Reader<'t> {
    pub(super) fn principled(&mut self, plugin: &Plugin<'t>) -> Material {
        plugin.ignore(&[
            "diffuse_reflectance_sampling_rate",
            "main_specular_sampling_rate",
            "clearcoat_sampling_rate",
            "specular_sampling_rate",
        ]);
        Material::Principled(Box::new(Principled {
            base_color: self.share(plugin, "base_color", 0.5),
            roughness: self.share(plugin, "roughness", 0.5),
            anisotropic: self.share(plugin, "anisotropic", 0.0),
            metallic: self.share(plugin, "metallic", 0.0),
            spec_trans: self.share(plugin, "spec_trans", 0.0),
            eta: self.eta(plugin),
            spec_tint: self.share(plugin, "spec_tint", 0.0),
            sheen: self.share(plugin, "sheen", 0.0),
            sheen_tint: self.share(plugin, "sheen_tint", 0.0),
            flatness: self.share(plugin, "flatness", 0.0),
            clearcoat: self.share(plugin, "clearcoat", 0.0),
            clearcoat_gloss: self.share(plugin, "clearcoat_gloss", 0.0),
        }))
    }

    fn share(&mut self, plugin: &Plugin<'t>, name: &'static str, default: f32) -> Handle<Texture> {
        self.texture_property(plugin, name, default, Role::Reflectance)
    }

    /// The index of refraction, or that which reflects 8 % of `specular` at normal incidence.
    fn eta(&self, plugin: &Plugin<'t>) -> f32 {
        let specular = plugin.optional_float("specular");
        let eta = match (plugin.optional_float("eta"), specular) {
            (Some(eta), None) => eta,
            (Some(eta), Some(_)) => {
                self.log.error(plugin.location(), "give either \"eta\" or \"specular\"");
                eta
            }
            (None, specular) => 2.0 / (1.0 - (0.08 * specular.unwrap_or(0.5).clamp(0.0, 1.0)).sqrt()) - 1.0,
        };
        if eta >= 1.0 {
            return eta;
        }
        if let Some(property) = plugin.property("eta") {
            self.log.error(&property.location, format!("\"eta\" must be at least 1, not {eta}"));
        }
        1.5
    }

    /// A thin sheet: what glTF has for one, and as much of a diffuse transmitter as `diff_trans` says.
    pub(super) fn principled_thin(&mut self, plugin: &Plugin<'t>) -> Handle<Material> {
        self.stands_for(plugin, "the thin sheet of glTF");
        plugin.ignore(&[
            "diffuse_transmittance_sampling_rate",
            "diffuse_reflectance_sampling_rate",
            "specular_reflectance_sampling_rate",
            "specular_transmittance_sampling_rate",
            "anisotropic",
            "spec_tint",
            "sheen_tint",
            "flatness",
        ]);
        let base_color = self.share(plugin, "base_color", 0.5);
        let transmission = self.share(plugin, "spec_trans", 0.0);
        let mut sheet = MetallicRoughness::plain(&mut self.textures);
        while self.origins.textures.len() < self.textures.list.len() {
            self.origins.textures.push(plugin.location().clone());
        }
        sheet.base_color = base_color;
        sheet.roughness = self.share(plugin, "roughness", 0.5);
        sheet.transmission = transmission;
        sheet.sheen_color = self.share(plugin, "sheen", 0.0);
        sheet.ior = self.eta(plugin);
        let diff_trans = self.share_of(plugin);
        let passed = 0.5 * self.textures.mean(diff_trans).mean();
        let sheet = self.store(plugin, Material::MetallicRoughness(Box::new(sheet)));
        let clear = self.textures.list[transmission] != Texture::Constant(Rgb::BLACK);
        let sheet =
            if clear { sheet } else { self.store(plugin, Material::TwoSided { front: sheet, back: sheet }) };
        if passed == 0.0 {
            return sheet;
        }
        let black = self.store_texture(plugin.location(), Texture::Constant(Rgb::BLACK));
        let leaf = Material::DiffuseTransmission { reflectance: black, transmittance: base_color };
        let second = self.store(plugin, leaf);
        let share = passed.min(1.0) * (1.0 - self.textures.mean(transmission).mean());
        let weight = self.store_texture(plugin.location(), Texture::Constant(Rgb::splat(share)));
        self.store(plugin, Material::Blend { weight, first: sheet, second })
    }

    /// `diff_trans`, from 0 for none to 2 for all; only its mean counts.
    fn share_of(&mut self, plugin: &Plugin<'t>) -> Handle<Texture> {
        self.texture_property(plugin, "diff_trans", 0.0, Role::Index)
    }
}
