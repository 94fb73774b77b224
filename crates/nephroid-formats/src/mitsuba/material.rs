//! `<bsdf>` elements.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::material::{Material, Metal};
use nephroid::texture::Texture;

use super::document::Element;
use super::names::{BSDFS, BSDFS_LIKE_DIFFUSE, BSDFS_LIKE_NULL, BSDFS_WRAPPING};
use super::properties::Plugin;
use super::reader::{Outcome, Reader};
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
            "diffuse" => Material::Diffuse { reflectance: self.reflectance(&plugin, "reflectance", 0.5) },
            "phong" => Material::Phong {
                diffuse_reflectance: self.reflectance(&plugin, "diffuse_reflectance", 0.5),
                specular_reflectance: self.reflectance(&plugin, "specular_reflectance", 0.2),
                exponent: plugin.float("exponent", 30.0),
            },
            "conductor" => self.conductor(&plugin),
            "dielectric" => self.dielectric(&plugin),
            "thindielectric" => match self.dielectric(&plugin) {
                Material::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance } => {
                    Material::ThinDielectric {
                        int_ior,
                        ext_ior,
                        specular_reflectance,
                        specular_transmittance,
                    }
                }
                other => other,
            },
            "twosided" => return self.two_sided(&plugin),
            "mask" => return self.mask(&plugin),
            "null" => Material::Null,
            _ => return self.nearest_material(&plugin),
        };
        plugin.finish();
        Some(self.store(&plugin, material))
    }

    fn store(&mut self, plugin: &Plugin<'t>, material: Material) -> Handle<Material> {
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

    fn conductor(&mut self, plugin: &Plugin<'t>) -> Material {
        Material::Conductor {
            metal: self.metal(plugin),
            specular_reflectance: self.reflectance(plugin, "specular_reflectance", 1.0),
        }
    }

    fn metal(&mut self, plugin: &Plugin<'t>) -> Metal {
        let material = plugin.text("material");
        if plugin.has("eta") || plugin.has("k") {
            if let Some((_, at)) = material.filter(|(name, _)| *name != "none") {
                self.log.error(at, "give either \"material\" or \"eta\" and \"k\"");
            }
            return Metal::Index {
                eta: self.color_property(plugin, "eta", 0.0, Role::Index),
                k: self.color_property(plugin, "k", 1.0, Role::Index),
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

    fn dielectric(&mut self, plugin: &Plugin<'t>) -> Material {
        Material::Dielectric {
            int_ior: self.ior(plugin, "int_ior", "bk7"),
            ext_ior: self.ior(plugin, "ext_ior", "air"),
            specular_reflectance: self.reflectance(plugin, "specular_reflectance", 1.0),
            specular_transmittance: self.reflectance(plugin, "specular_transmittance", 1.0),
        }
    }

    /// An index of refraction: a number, or the name of a medium.
    fn ior(&self, plugin: &Plugin<'t>, name: &'static str, default: &str) -> f32 {
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

    fn two_sided(&mut self, plugin: &Plugin<'t>) -> Option<Handle<Material>> {
        plugin.ignore(&["allow_transmission"]);
        let nested: Vec<_> = plugin.objects("bsdf").into_iter().map(|(_, element)| element).collect();
        plugin.finish();
        if nested.is_empty() || nested.len() > 2 {
            let message = format!("\"twosided\" takes one or two materials, not {}", nested.len());
            self.log.error(plugin.location(), message);
            return None;
        }
        let mut sides = Vec::new();
        for element in &nested {
            let handle = self.material(element)?;
            match self.materials[handle] {
                Material::Dielectric { .. } | Material::ThinDielectric { .. } | Material::Null => {
                    let message = "\"twosided\" takes no material that light passes through";
                    self.log.error(&element.location, message);
                    return None;
                }
                Material::Mask { .. } => {
                    let message = Diagnostic::error(
                        &element.location,
                        "\"twosided\" takes no material that light passes through",
                    );
                    self.log.push(message.hint("put the \"twosided\" into the \"mask\""));
                    return None;
                }
                Material::TwoSided { front, back } => sides.push([front, back][sides.len()]),
                _ => sides.push(handle),
            }
        }
        let (front, back) = (sides[0], sides[sides.len() - 1]);
        Some(self.store(plugin, Material::TwoSided { front, back }))
    }

    fn mask(&mut self, plugin: &Plugin<'t>) -> Option<Handle<Material>> {
        let opacity = self.texture_property(plugin, "opacity", 0.5, Role::Reflectance);
        let nested: Vec<_> = plugin.objects("bsdf").into_iter().map(|(_, element)| element).collect();
        plugin.finish();
        let [inside] = nested[..] else {
            let message = format!("\"mask\" takes one material, not {}", nested.len());
            self.log.error(plugin.location(), message);
            return None;
        };
        let inside = self.material(inside)?;
        Some(self.store(plugin, Material::Mask { opacity, inside }))
    }

    /// The nearest material that can be rendered to one that cannot yet.
    fn nearest_material(&mut self, plugin: &Plugin<'t>) -> Option<Handle<Material>> {
        let nested: Vec<_> = plugin.objects("bsdf").into_iter().map(|(_, element)| element).collect();
        let (material, nearest) = match plugin.kind {
            "roughconductor" => (self.conductor(plugin), "a smooth conductor"),
            "roughdielectric" => (self.dielectric(plugin), "a smooth dielectric"),
            kind if BSDFS_LIKE_DIFFUSE.contains(&kind) => (self.like_diffuse(plugin), "diffuse"),
            kind if BSDFS_LIKE_NULL.contains(&kind) => (Material::Null, "nothing"),
            kind if BSDFS_WRAPPING.contains(&kind) => {
                self.stands_for(plugin, "the material in it");
                plugin.finish_approximated();
                let Some(first) = nested.first() else {
                    self.log.error(plugin.location(), format!("\"{kind}\" needs a material in it"));
                    return None;
                };
                return self.material(first);
            }
            _ => {
                let rough = ["roughconductor", "roughdielectric"];
                let known = [BSDFS, &rough, BSDFS_WRAPPING, BSDFS_LIKE_DIFFUSE, BSDFS_LIKE_NULL];
                self.unknown_kind(plugin, &known);
                return None;
            }
        };
        self.stands_for(plugin, nearest);
        plugin.finish_approximated();
        Some(self.store(plugin, material))
    }

    fn stands_for(&self, plugin: &Plugin, nearest: &str) {
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
