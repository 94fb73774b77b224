//! Materials that stand for others: of older files, or not built yet.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::material::{Material, Metal};
use nephroid::texture::Texture;

use super::named::metal_index;
use super::parameters::Parameters;
use super::reader::Reader;
use crate::spectra::Role;

impl Reader<'_> {
    pub(super) fn stands_for(&self, parameters: &Parameters, nearest: &str) {
        let message =
            format!("material \"{}\" cannot be rendered yet; {nearest} stands for it", parameters.kind);
        self.log.warn(&parameters.at, message);
    }

    pub(super) fn grey(&mut self, parameters: &Parameters) -> Material {
        let texture = Texture::Constant(Rgb::splat(0.5));
        Material::Diffuse { reflectance: self.store_texture(&parameters.at, texture) }
    }

    /// Light that goes in and comes out elsewhere, as if it came out at the same place.
    pub(super) fn subsurface(&mut self, parameters: &Parameters) -> Option<Material> {
        self.stands_for(parameters, "\"coateddiffuse\"");
        self.coated_diffuse(parameters, "reflectance")
    }

    /// Diffuse, about as dark as hair with that much pigment.
    pub(super) fn like_hair(&mut self, parameters: &Parameters) -> Option<Material> {
        self.stands_for(parameters, "\"diffuse\"");
        let name = if parameters.has("color") { "color" } else { "reflectance" };
        if parameters.has(name) {
            return Some(Material::Diffuse { reflectance: self.albedo(parameters, name, 0.5)? });
        }
        // Transmittance of a fibre by absorption as d'Eon et al. (2011) have it, for each pigment.
        let default = if parameters.has("pheomelanin") { 0.0 } else { 1.3 };
        let [brown, red] = [("eumelanin", default), ("pheomelanin", 0.0)].map(|(name, default)| {
            let texture = self.texture_or_color(parameters, name, Rgb::splat(default), Role::Index);
            texture.map_or(default, |texture| self.textures.mean(texture).g)
        });
        let absorption = Rgb::new(0.419, 0.697, 1.37) * brown + Rgb::new(0.187, 0.4, 1.05) * red;
        let color = absorption.map(|a| nephroid::math::real::exp(-a));
        let reflectance = self.store_texture(&parameters.at, Texture::Constant(color));
        Some(Material::Diffuse { reflectance })
    }

    /// A material of pbrt-v3 or older, by its nearest of today.
    pub(super) fn old_material(&mut self, parameters: &Parameters) -> Option<Handle<Material>> {
        let (material, nearest, two_sided) = match parameters.kind.as_str() {
            "matte" => (self.old_diffuse(parameters), "diffuse", true),
            "plastic" | "substrate" | "uber" | "disney" => {
                (self.old_plastic(parameters), "coateddiffuse", true)
            }
            "metal" => (self.old_metal(parameters), "conductor", true),
            "mirror" => {
                let reflectance = self.albedo(parameters, "Kr", 0.9);
                let metal = Metal::PerfectMirror;
                let mirror = reflectance
                    .map(|specular_reflectance| Material::Conductor { metal, specular_reflectance });
                (mirror, "conductor", true)
            }
            "glass" => (self.old_glass(parameters), "dielectric", false),
            "translucent" => (self.old_translucent(parameters), "diffusetransmission", false),
            "none" | "" => (Some(Material::Null), "interface", false),
            _ => (Some(self.grey(parameters)), "diffuse", true),
        };
        let message =
            format!("material \"{}\" is of older files; \"{nearest}\" stands for it", parameters.kind);
        self.log.warn(&parameters.at, message);
        let handle = material.map(|material| self.store_sides(&parameters.at, material, two_sided));
        let handle = self.tilted(parameters, handle);
        parameters.finish_approximated();
        handle
    }

    fn old_diffuse(&mut self, parameters: &Parameters) -> Option<Material> {
        Some(Material::Diffuse { reflectance: self.albedo(parameters, "Kd", 0.5)? })
    }

    fn old_plastic(&mut self, parameters: &Parameters) -> Option<Material> {
        let base = if parameters.kind == "disney" { "color" } else { "Kd" };
        let default = if parameters.kind == "disney" { 0.5 } else { 0.1 };
        let int_ior = match parameters.any("eta").or_else(|| parameters.any("index")) {
            Some(_) => self.ior(parameters, "eta", 1.5).max(1.0),
            None => 1.5,
        };
        let roughness = self.roughness(parameters, ["uroughness", "vroughness", "roughness"], default);
        let specular_reflectance = self.white(parameters);
        let diffuse_reflectance = self.albedo(parameters, base, 0.25)?;
        Some(Material::Plastic {
            int_ior,
            ext_ior: 1.0,
            diffuse_reflectance,
            specular_reflectance,
            nonlinear: true,
            roughness,
        })
    }

    fn old_metal(&mut self, parameters: &Parameters) -> Option<Material> {
        let [copper_eta, copper_k] = metal_index("Cu").unwrap_or([Rgb::WHITE; 2]);
        let eta = self.color(parameters, "eta", copper_eta, Role::Index);
        let k = self.color(parameters, "k", copper_k, Role::Index);
        let metal = Metal::Index { eta, k };
        let specular_reflectance = self.white(parameters);
        let roughness = self.roughness(parameters, ["uroughness", "vroughness", "roughness"], 0.01);
        Some(match roughness {
            None => Material::Conductor { metal, specular_reflectance },
            Some(roughness) => Material::RoughConductor { metal, specular_reflectance, roughness },
        })
    }

    fn old_glass(&mut self, parameters: &Parameters) -> Option<Material> {
        let name = if parameters.has("index") { "index" } else { "eta" };
        let int_ior = self.ior(parameters, name, 1.5);
        let (reflected, transmitted) =
            (self.albedo(parameters, "Kr", 1.0), self.albedo(parameters, "Kt", 1.0));
        Some(Material::Dielectric {
            int_ior,
            ext_ior: 1.0,
            specular_reflectance: reflected?,
            specular_transmittance: transmitted?,
        })
    }

    fn old_translucent(&mut self, parameters: &Parameters) -> Option<Material> {
        let at = parameters.at.clone();
        let base = self.albedo(parameters, "Kd", 0.25)?;
        let [reflectance, transmittance] = ["reflect", "transmit"].map(|name| {
            let part = self.albedo(parameters, name, 0.5)?;
            Some(self.product(base, part, &at))
        });
        Some(Material::DiffuseTransmission { reflectance: reflectance?, transmittance: transmittance? })
    }
}
