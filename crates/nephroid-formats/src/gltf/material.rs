//! Materials.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::material::Material;
use nephroid::medium::Medium;
use nephroid::texture::Texture;

use super::image::Purpose;
use super::item::Item;
use super::reader::Reader;
use super::texture::{Part, uv_set};

/// What a primitive looks like.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    pub(super) material: Handle<Material>,
    pub(super) emission: Option<Handle<Texture>>,
    /// What its surface encloses.
    pub(super) inside: Option<Handle<Medium>>,
    /// Which texture coordinates it uses.
    pub(super) uv_set: usize,
}

impl<'d> Reader<'d> {
    /// The look of a primitive whose material is `material`, or the default, and whose vertices have colours or not.
    pub(super) fn look(
        &mut self,
        part: Item<'d>,
        material: Option<(usize, Item<'d>)>,
        with_colors: bool,
    ) -> Option<Look> {
        let key = (material.map(|(index, _)| index), with_colors);
        if let Some(known) = self.look_of.get(&key) {
            return Some(*known);
        }
        let look = match material {
            Some((_, item)) => self.new_look(item, with_colors)?,
            None => self.new_look(part, with_colors)?,
        };
        self.look_of.insert(key, look);
        Some(look)
    }

    /// `material` may also be a primitive without one, which says nothing of materials.
    fn new_look(&mut self, material: Item<'d>, with_colors: bool) -> Option<Look> {
        let uv_set = self.uv_set_of(material);
        if material.extension("KHR_materials_unlit").is_some() {
            return Some(self.unlit(material, with_colors, uv_set));
        }
        let surface = self.surface(material, with_colors);
        let mut inside = surface.handle;
        if let Some(info) = material.object("normalTexture")
            && let Some(normals) = self.bitmap(info, Purpose::Raw)
        {
            let scale = info.number("scale").unwrap_or(1.0) as f32;
            let map = Material::NormalMap { normals, scale, against_v: true, inside };
            inside = self.store_material(material, map);
        }
        if !surface.transmits {
            inside = self.store_material(material, Material::TwoSided { front: inside, back: inside });
        }
        let opacity = self.opacity(material);
        let mut emission = self.emission(material);
        let mut medium = surface.medium;
        if let Some(opacity) = opacity {
            inside = self.store_material(material, Material::Mask { opacity, inside });
            if emission.take().is_some() {
                self.once(
                    material,
                    "what is partly transparent gives no light here: its emission is left out",
                );
            }
            if medium.take().is_some() {
                self.once(
                    material,
                    "what is partly transparent encloses nothing here: its volume is left out",
                );
            }
        }
        Some(Look { material: inside, emission, inside: medium, uv_set })
    }

    /// The colour itself, whatever light falls on it: it is given off. Where that cannot be, it is a diffuse colour.
    fn unlit(&mut self, material: Item<'d>, with_colors: bool, uv_set: usize) -> Look {
        let color = self.base_color(material, with_colors);
        let opacity = self.opacity(material);
        if opacity.is_some() || with_colors {
            self.once(
                material,
                "what is partly transparent or has the colours of vertices gives no light here: unlit, it is diffuse",
            );
            let side = self.store_material(material, Material::Diffuse { reflectance: color });
            let inside = self.store_material(material, Material::TwoSided { front: side, back: side });
            let material = match opacity {
                Some(opacity) => self.store_material(material, Material::Mask { opacity, inside }),
                None => inside,
            };
            return Look { material, emission: None, inside: None, uv_set };
        }
        let reflectance = self.constant(material, Rgb::BLACK);
        let black = self.store_material(material, Material::Diffuse { reflectance });
        Look { material: black, emission: Some(color), inside: None, uv_set }
    }

    /// The base colour of a material, times the colours of vertices.
    pub(super) fn base_color(&mut self, material: Item<'d>, with_colors: bool) -> Handle<Texture> {
        let color = match material.object("pbrMetallicRoughness") {
            Some(pbr) => {
                let [r, g, b, _] = factors(pbr, "baseColorFactor", [1.0; 4]);
                self.product(pbr, Rgb::new(r, g, b), "baseColorTexture", Part::Colors)
            }
            None => self.constant(material, Rgb::WHITE),
        };
        if with_colors { self.with_colors(material, color) } else { color }
    }

    /// A texture times the colours of vertices.
    pub(super) fn with_colors(&mut self, at: Item<'d>, color: Handle<Texture>) -> Handle<Texture> {
        let colors = self.store_texture(at, Texture::VertexColor);
        if self.textures.list[color] == Texture::Constant(Rgb::WHITE) {
            return colors;
        }
        self.store_texture(at, Texture::Scale { a: color, b: colors })
    }

    /// The probability that a surface is there, if it is not always.
    fn opacity(&mut self, material: Item<'d>) -> Option<Handle<Texture>> {
        let mode = material.text("alphaMode").unwrap_or("OPAQUE");
        if mode == "OPAQUE" {
            return None;
        }
        let (owner, factor_name, texture_name) = base_of(material)?;
        let [.., factor] = factors(owner, factor_name, [1.0; 4]);
        let info = owner.object(texture_name);
        if mode == "MASK" {
            let cutoff = material.number("alphaCutoff").unwrap_or(0.5) as f32;
            let whole = |there: bool| Rgb::splat(f32::from(there));
            return match info {
                _ if cutoff <= 0.0 => None,
                Some(info) if factor > 0.0 && self.has_alpha(info) => {
                    self.bitmap(info, Purpose::Cutoff((cutoff / factor).to_bits()))
                }
                _ if factor >= cutoff => None,
                _ => Some(self.constant(material, whole(false))),
            };
        }
        if mode != "BLEND" {
            material.error("\"alphaMode\" must be \"OPAQUE\", \"MASK\" or \"BLEND\"");
            return None;
        }
        match info {
            Some(info) if self.has_alpha(info) => {
                let of = self.bitmap(info, Purpose::Color)?;
                let alpha = self.store_texture(info, Texture::Channel { of, channel: 3 });
                Some(self.times(material, alpha, Rgb::splat(factor)))
            }
            _ => (factor < 1.0).then(|| self.constant(material, Rgb::splat(factor))),
        }
    }

    /// Whether the image of a reference to a texture is not opaque everywhere.
    fn has_alpha(&mut self, info: Item<'d>) -> bool {
        info.refers("index", "textures")
            .and_then(|(_, texture)| self.image(texture, Purpose::Color))
            .is_some_and(|image| self.textures.images[image].alpha.is_some())
    }

    /// The radiance that a surface gives off, in W/(m²·sr): the numbers of the file as they are.
    fn emission(&mut self, material: Item<'d>) -> Option<Handle<Texture>> {
        let factor = factors(material, "emissiveFactor", [0.0; 3]);
        let strength = material
            .extension("KHR_materials_emissive_strength")
            .and_then(|extension| extension.number("emissiveStrength"))
            .unwrap_or(1.0)
            .max(0.0);
        let factor = Rgb::from(factor) * strength as f32;
        if factor.is_black() {
            return None;
        }
        let emission = self.product(material, factor, "emissiveTexture", Part::Colors);
        // Images that are black everywhere make no lamps.
        (self.textures.brightest(emission) > 0.0).then_some(emission)
    }

    /// The set of texture coordinates that a material uses: that of its base colour, or else of the first texture there is.
    fn uv_set_of(&mut self, material: Item<'d>) -> usize {
        let mut infos = Vec::new();
        if let Some((owner, _, name)) = base_of(material) {
            infos.extend(owner.object(name));
        }
        textures_in(material, &mut infos);
        let mut sets = infos.into_iter().map(|info| (uv_set(info), info));
        let Some((set, _)) = sets.next() else { return 0 };
        if let Some((other, info)) = sets.find(|(other, _)| *other != set) {
            let message = format!(
                "the textures of a material have one set of coordinates here: this one uses TEXCOORD_{set}, not \
                 TEXCOORD_{other}"
            );
            info.warn(message);
        }
        set
    }
}

/// Where a material has its base colour and opacity: the owner, the name of the factor, and of the texture.
fn base_of(material: Item) -> Option<(Item, &'static str, &'static str)> {
    match material.extension("KHR_materials_pbrSpecularGlossiness") {
        Some(owner) => Some((owner, "diffuseFactor", "diffuseTexture")),
        None => Some((material.object("pbrMetallicRoughness")?, "baseColorFactor", "baseColorTexture")),
    }
}

/// All references to textures in a material, but for occlusion, which is not read.
fn textures_in<'d>(item: Item<'d>, out: &mut Vec<Item<'d>>) {
    for name in item.names().filter(|name| *name != "occlusionTexture" && *name != "extras") {
        let Some(member) = item.get(name) else { continue };
        if name.ends_with("Texture") && member.has("index") {
            out.push(member);
        } else {
            textures_in(member, out);
        }
    }
}

/// Factors between 0 and any size.
pub(super) fn factors<const N: usize>(owner: Item, name: &str, default: [f32; N]) -> [f32; N] {
    match owner.vector::<N>(name) {
        Some(values) => values.map(|value| value.max(0.0) as f32),
        None => default,
    }
}
