//! `<bsdf>` elements.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::material::Material;
use nephroid::texture::Texture;

use super::document::Element;
use super::names::{BSDFS, BSDFS_LIKE_DIFFUSE, BSDFS_LIKE_NULL};
use super::properties::Plugin;
use super::reader::{Outcome, Reader};
use crate::spectra::Role;

impl<'t> Reader<'t> {
    /// A `<bsdf>`, read once however often it is referred to. `None` if the log says why.
    pub(super) fn material(&mut self, element: &'t Element) -> Option<Handle<Material>> {
        match self.material_of.get(&element.number) {
            Some(Outcome::Done(handle)) => return Some(*handle),
            Some(Outcome::Failed) => return None,
            Some(Outcome::Open) => {
                self.log.error(&element.location, "the material refers to itself");
                return None;
            }
            None => {}
        }
        self.material_of.insert(element.number, Outcome::Open);
        let handle = self.nested(&element.location, |reader| reader.new_material(element));
        self.material_of.insert(element.number, handle.map_or(Outcome::Failed, Outcome::Done));
        handle
    }

    fn new_material(&mut self, element: &'t Element) -> Option<Handle<Material>> {
        let plugin = self.plugin(element);
        let material = match plugin.kind {
            "twosided" => return self.two_sided(&plugin),
            "mask" => return self.mask(&plugin),
            "blendbsdf" => return self.blend(&plugin),
            "mixturebsdf" => return self.mixture(&plugin),
            "bumpmap" | "normalmap" => return self.tilted(&plugin),
            "coating" | "roughcoating" => return self.coating(&plugin),
            "ward" => return Some(self.ward(&plugin)),
            "principledthin" => {
                let handle = self.principled_thin(&plugin);
                plugin.finish();
                return Some(handle);
            }
            "diffuse" => Material::Diffuse { reflectance: self.reflectance(&plugin, "reflectance", 0.5) },
            "phong" => self.phong(&plugin),
            "difftrans" => Material::DiffuseTransmission {
                reflectance: self.store_texture(plugin.location(), Texture::Constant(Rgb::BLACK)),
                transmittance: self.reflectance(&plugin, "transmittance", 0.5),
            },
            "conductor" => Material::Conductor {
                metal: self.metal(&plugin),
                specular_reflectance: self.reflectance(&plugin, "specular_reflectance", 1.0),
            },
            "roughconductor" => Material::RoughConductor {
                metal: self.metal(&plugin),
                specular_reflectance: self.reflectance(&plugin, "specular_reflectance", 1.0),
                roughness: self.roughness(&plugin),
            },
            "dielectric" | "thindielectric" | "roughdielectric" => {
                let glass = self.dielectric(&plugin);
                let handle = self.store_glass(&plugin, glass);
                plugin.finish();
                return Some(handle);
            }
            "plastic" | "roughplastic" | "pplastic" => self.plastic(&plugin),
            "principled" => self.principled(&plugin),
            "null" => Material::Null,
            _ => return self.nearest_material(&plugin),
        };
        plugin.finish();
        Some(self.store(&plugin, material))
    }

    pub(super) fn store(&mut self, plugin: &Plugin<'t>, material: Material) -> Handle<Material> {
        self.origins.materials.push(plugin.location().clone());
        self.materials.push(material)
    }

    /// The diffuse material of a shape that names none: grey, or black if it is a lamp.
    pub(super) fn default_material(&mut self, plugin: &Plugin<'t>, is_lamp: bool) -> Handle<Material> {
        if let Some(handle) = self.default_materials[usize::from(is_lamp)] {
            return handle;
        }
        let albedo = if is_lamp { Rgb::BLACK } else { Rgb::splat(0.5) };
        let reflectance = self.store_texture(plugin.location(), Texture::Constant(albedo));
        let handle = self.store(plugin, Material::Diffuse { reflectance });
        self.default_materials[usize::from(is_lamp)] = Some(handle);
        handle
    }

    fn reflectance(&mut self, plugin: &Plugin<'t>, name: &'static str, default: f32) -> Handle<Texture> {
        self.texture_property(plugin, name, default, Role::Reflectance)
    }

    /// Both of its colours are scaled down where they add up to more than one, as Mitsuba does: textures where they are looked
    /// up, plain colours here.
    fn phong(&mut self, plugin: &Plugin<'t>) -> Material {
        let mut diffuse_reflectance = self.reflectance(plugin, "diffuse_reflectance", 0.5);
        let mut specular_reflectance = self.reflectance(plugin, "specular_reflectance", 0.2);
        let colors = [diffuse_reflectance, specular_reflectance].map(|handle| &self.textures.list[handle]);
        if let [&Texture::Constant(diffuse), &Texture::Constant(specular)] = colors {
            let most = (diffuse + specular).max_channel();
            if most > 1.0 && most.is_finite() {
                let message = "the two reflectances add up to more than 1: both are scaled down";
                self.log.warn(plugin.location(), message);
                [diffuse_reflectance, specular_reflectance] = [diffuse, specular]
                    .map(|color| self.store_texture(plugin.location(), Texture::Constant(color / most)));
            }
        }
        Material::Phong {
            diffuse_reflectance,
            specular_reflectance,
            exponent: plugin.float("exponent", 30.0),
        }
    }

    fn dielectric(&mut self, plugin: &Plugin<'t>) -> Material {
        let int_ior = self.ior(plugin, "int_ior", "bk7");
        let ext_ior = self.ior(plugin, "ext_ior", "air");
        let specular_reflectance = self.reflectance(plugin, "specular_reflectance", 1.0);
        let specular_transmittance = self.reflectance(plugin, "specular_transmittance", 1.0);
        match plugin.kind {
            "dielectric" => {
                Material::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance }
            }
            "thindielectric" => {
                Material::ThinDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance }
            }
            _ => Material::RoughDielectric {
                int_ior,
                ext_ior,
                specular_reflectance,
                specular_transmittance,
                roughness: self.roughness(plugin),
            },
        }
    }

    fn plastic(&mut self, plugin: &Plugin<'t>) -> Material {
        if plugin.kind == "pplastic" {
            self.stands_for(plugin, "\"roughplastic\"");
        }
        Material::Plastic {
            int_ior: self.ior(plugin, "int_ior", "polypropylene"),
            ext_ior: self.ior(plugin, "ext_ior", "air"),
            diffuse_reflectance: self.reflectance(plugin, "diffuse_reflectance", 0.5),
            specular_reflectance: self.reflectance(plugin, "specular_reflectance", 1.0),
            nonlinear: plugin.boolean("nonlinear", false),
            roughness: (plugin.kind != "plastic").then(|| self.roughness(plugin)),
        }
    }

    /// The nearest material that can be rendered to one that cannot yet.
    fn nearest_material(&mut self, plugin: &Plugin<'t>) -> Option<Handle<Material>> {
        let (material, nearest) = match plugin.kind {
            kind if BSDFS_LIKE_DIFFUSE.contains(&kind) => (self.like_diffuse(plugin), "diffuse"),
            kind if BSDFS_LIKE_NULL.contains(&kind) => (Material::Null, "nothing"),
            _ => {
                self.unknown_kind(plugin, &[BSDFS, BSDFS_LIKE_DIFFUSE, BSDFS_LIKE_NULL]);
                return None;
            }
        };
        self.stands_for(plugin, nearest);
        plugin.finish_approximated();
        Some(self.store(plugin, material))
    }

    pub(super) fn stands_for(&self, plugin: &Plugin, nearest: &str) {
        let message = format!("bsdf \"{}\" cannot be rendered yet; {nearest} stands for it", plugin.kind);
        self.log.warn(plugin.location(), message);
    }

    /// Diffuse, with the colour that the plugin has under one of three names.
    fn like_diffuse(&mut self, plugin: &Plugin<'t>) -> Material {
        let name = ["diffuse_reflectance", "base_color", "reflectance"]
            .into_iter()
            .find(|name| plugin.has(name))
            .unwrap_or("diffuse_reflectance");
        Material::Diffuse { reflectance: self.reflectance(plugin, name, 0.5) }
    }
}
