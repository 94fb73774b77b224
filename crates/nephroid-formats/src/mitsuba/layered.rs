//! Materials around others: two sides, masks, blends, coats, tilted normals.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::material::{Material, Metal};
use nephroid::texture::Texture;

use super::document::Element;
use super::properties::Plugin;
use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::number::floats;
use crate::spectra::Role;

impl<'t> Reader<'t> {
    /// So many materials that stand in one; `None` if the log says what is wrong.
    fn inner<const N: usize>(&mut self, plugin: &Plugin<'t>) -> Option<[&'t Element; N]> {
        let nested: Vec<_> = plugin.objects("bsdf").into_iter().map(|(_, element)| element).collect();
        let found = nested.len();
        let inner = <[&Element; N]>::try_from(nested).ok();
        if inner.is_none() {
            let takes = if N == 1 { "one material" } else { "two materials" };
            let message = format!("\"{}\" takes {takes}, not {found}", plugin.kind);
            self.log.error(plugin.location(), message);
        }
        inner
    }

    pub(super) fn two_sided(&mut self, plugin: &Plugin<'t>) -> Option<Handle<Material>> {
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
            let message = "\"twosided\" takes no material that light passes through";
            match self.materials[handle] {
                Material::Dielectric { .. }
                | Material::ThinDielectric { .. }
                | Material::RoughDielectric { .. }
                | Material::DiffuseTransmission { .. }
                | Material::Null => {
                    self.log.error(&element.location, message);
                    return None;
                }
                Material::Mask { .. } => {
                    let message = Diagnostic::error(&element.location, message);
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

    pub(super) fn mask(&mut self, plugin: &Plugin<'t>) -> Option<Handle<Material>> {
        let opacity = self.texture_property(plugin, "opacity", 0.5, Role::Reflectance);
        let inner = self.inner(plugin);
        plugin.finish();
        let [inside] = inner?;
        let inside = self.material(inside)?;
        Some(self.store(plugin, Material::Mask { opacity, inside }))
    }

    pub(super) fn blend(&mut self, plugin: &Plugin<'t>) -> Option<Handle<Material>> {
        let weight = self.texture_property(plugin, "weight", 0.5, Role::Reflectance);
        let inner = self.inner(plugin);
        plugin.finish();
        let [first, second] = inner?;
        let (first, second) = (self.material(first)?, self.material(second)?);
        Some(self.store(plugin, Material::Blend { weight, first, second }))
    }

    /// Any number of materials with a weight each, as blends of two. What is missing to one is black, and more than
    /// one is scaled down.
    pub(super) fn mixture(&mut self, plugin: &Plugin<'t>) -> Option<Handle<Material>> {
        let weights = match plugin.text("weights") {
            Some((text, at)) => floats(text).map_err(|message| self.log.error(at, message)).ok()?,
            None => {
                self.log.error(plugin.location(), "\"mixturebsdf\" lacks its \"weights\"");
                return None;
            }
        };
        let nested: Vec<_> = plugin.objects("bsdf").into_iter().map(|(_, element)| element).collect();
        plugin.finish();
        if nested.len() != weights.len() || nested.is_empty() || weights.iter().any(|w| *w < 0.0) {
            let message = format!(
                "\"mixturebsdf\" takes a weight that is not negative for each material, not {} for {}",
                weights.len(),
                nested.len()
            );
            self.log.error(plugin.location(), message);
            return None;
        }
        let mut parts = Vec::new();
        for (element, weight) in nested.into_iter().zip(weights) {
            parts.push((self.material(element)?, weight));
        }
        let missing = 1.0 - parts.iter().map(|(_, weight)| weight).sum::<f64>();
        if missing > 1e-6 {
            let reflectance = self.store_texture(plugin.location(), Texture::Constant(Rgb::BLACK));
            parts.push((self.store(plugin, Material::Diffuse { reflectance }), missing));
        }
        let (mut whole, mut sum) = parts[0];
        for (second, weight) in parts.into_iter().skip(1).filter(|(_, weight)| *weight > 0.0) {
            sum += weight;
            let weight = Texture::Constant(Rgb::splat((weight / sum) as f32));
            let weight = self.store_texture(plugin.location(), weight);
            whole = self.store(plugin, Material::Blend { weight, first: whole, second });
        }
        Some(whole)
    }

    /// `bumpmap` and `normalmap`: a texture, whatever its name, and a material.
    pub(super) fn tilted(&mut self, plugin: &Plugin<'t>) -> Option<Handle<Material>> {
        let scale = plugin.float("scale", 1.0);
        plugin.ignore(&["flip_invalid_normals", "use_shadowing_function"]);
        let texture = plugin.only_object("texture");
        let inner = self.inner(plugin);
        plugin.finish();
        let [inside] = inner?;
        let Some(element) = texture else {
            self.log.error(plugin.location(), format!("\"{}\" lacks its texture", plugin.kind));
            return None;
        };
        let texture = self.texture(element)?;
        let inside = self.material(inside)?;
        let tilted = if plugin.kind == "bumpmap" {
            Material::BumpMap { heights: texture, scale, inside }
        } else {
            let raw = self.plugin(element);
            if raw.kind == "bitmap" && !raw.boolean("raw", false) && raw.optional_float("gamma") != Some(1.0)
            {
                let message = Diagnostic::warning(&element.location, "the normals are decoded from sRGB");
                self.log.push(message.hint("<boolean name=\"raw\" value=\"true\"/> takes them as they are"));
            }
            Material::NormalMap { normals: texture, scale, against_v: false, inside }
        };
        Some(self.store(plugin, tilted))
    }

    /// `coating` and `roughcoating`.
    pub(super) fn coating(&mut self, plugin: &Plugin<'t>) -> Option<Handle<Material>> {
        let int_ior = self.ior(plugin, "int_ior", "bk7");
        let ext_ior = self.ior(plugin, "ext_ior", "air");
        let specular = self.texture_property(plugin, "specular_reflectance", 1.0, Role::Reflectance);
        let coat_roughness = (plugin.kind == "roughcoating").then(|| self.roughness(plugin));
        plugin.ignore(&["thickness"]);
        let absorbs = self.color_property(plugin, "sigma_a", 0.0, Role::Index);
        if let Some(property) = plugin.property("sigma_a").filter(|_| !absorbs.is_black()) {
            self.log.warn(&property.location, "a coat that absorbs light cannot be had yet: it is clear");
        }
        let inner = self.inner(plugin);
        plugin.finish();
        let [element] = inner?;
        let inside = self.material(element)?;
        let sides = match self.materials[inside] {
            Material::TwoSided { front, back } => vec![front, back],
            _ => vec![inside],
        };
        let mut coated = Vec::new();
        for side in sides {
            let material = match self.materials[side].clone() {
                Material::Diffuse { reflectance } => Material::Plastic {
                    int_ior,
                    ext_ior,
                    diffuse_reflectance: reflectance,
                    specular_reflectance: specular,
                    nonlinear: true,
                    roughness: coat_roughness,
                },
                Material::Conductor { metal, specular_reflectance } => Material::CoatedConductor {
                    metal,
                    specular_reflectance,
                    roughness: None,
                    coat_ior: int_ior / ext_ior,
                    coat_roughness,
                },
                Material::RoughConductor { metal, specular_reflectance, roughness } => {
                    Material::CoatedConductor {
                        metal,
                        specular_reflectance,
                        roughness: Some(roughness),
                        coat_ior: int_ior / ext_ior,
                        coat_roughness,
                    }
                }
                _ => {
                    self.stands_for(plugin, "the material in it");
                    return Some(inside);
                }
            };
            coated.push(self.store(plugin, material));
        }
        match coated[..] {
            [front, back] => Some(self.store(plugin, Material::TwoSided { front, back })),
            _ => coated.first().copied(),
        }
    }

    /// Ward's model: Lambert and a rough metal, as much of each as it reflects.
    pub(super) fn ward(&mut self, plugin: &Plugin<'t>) -> Handle<Material> {
        self.stands_for(plugin, "a blend of \"diffuse\" and \"roughconductor\"");
        plugin.ignore(&["variant"]);
        let diffuse = self.texture_property(plugin, "diffuse_reflectance", 0.5, Role::Reflectance);
        let specular = self.texture_property(plugin, "specular_reflectance", 0.2, Role::Reflectance);
        let roughness = self.roughness(plugin);
        plugin.finish();
        let [kd, ks] = [diffuse, specular].map(|texture| self.textures.mean(texture).mean());
        let share = if kd + ks > 0.0 { ks / (kd + ks) } else { 0.0 };
        let reflectance = self.brightened(plugin, diffuse, 1.0 - share);
        let specular_reflectance = self.brightened(plugin, specular, share);
        let first = self.store(plugin, Material::Diffuse { reflectance });
        let metal = Metal::PerfectMirror;
        let second = self.store(plugin, Material::RoughConductor { metal, specular_reflectance, roughness });
        let weight = self.store_texture(plugin.location(), Texture::Constant(Rgb::splat(share)));
        self.store(plugin, Material::Blend { weight, first, second })
    }

    /// A texture divided by the share that it will have.
    fn brightened(&mut self, plugin: &Plugin<'t>, texture: Handle<Texture>, share: f32) -> Handle<Texture> {
        if share <= 0.0 || share >= 1.0 {
            return texture;
        }
        if let Texture::Constant(value) = self.textures.list[texture] {
            let value = (value * (1.0 / share)).map(|v| v.min(1.0));
            return self.store_texture(plugin.location(), Texture::Constant(value));
        }
        let factor = Texture::Constant(Rgb::splat(1.0 / share));
        let b = self.store_texture(plugin.location(), factor);
        self.store_texture(plugin.location(), Texture::Scale { a: texture, b })
    }
}
