//! How surfaces scatter: metallic-roughness with its extensions, and specular-glossiness.

use nephroid::color::{Rgb, Wavelength};
use nephroid::handle::Handle;
use nephroid::material::{Dispersion, Material, MetallicRoughness};
use nephroid::math::real::ln;
use nephroid::medium::{Medium, Phase};
use nephroid::texture::Texture;

use super::item::Item;
use super::material::factors;
use super::reader::Reader;
use super::texture::Part;

/// The least index of glass for any wavelength.
const LEAST_IOR: f32 = 1.001;

/// What dielectrics of the index 1.5 reflect straight on.
const USUAL_REFLECTANCE: f32 = 0.04;

/// A material before normal maps, masks and the like.
pub(super) struct Surface {
    pub(super) handle: Handle<Material>,
    /// Whether light goes through.
    pub(super) transmits: bool,
    pub(super) medium: Option<Handle<Medium>>,
}

impl<'d> Reader<'d> {
    /// How a material scatters.
    pub(super) fn surface(&mut self, material: Item<'d>, with_colors: bool) -> Surface {
        let mut out = match material.extension("KHR_materials_pbrSpecularGlossiness") {
            Some(extension) => self.specular_glossiness(extension, with_colors),
            None => self.metallic_roughness(material, with_colors),
        };
        self.coat_and_sheen(material, &mut out);
        self.anisotropy(material, &mut out);
        if let Some(extension) = material.extension("KHR_materials_transmission") {
            out.transmission = self.product(
                extension,
                unit(extension, "transmissionFactor", 0.0),
                "transmissionTexture",
                Part::Red,
            );
        }
        let transmits = self.textures.brightest(out.transmission) > 0.0;
        let mut medium = None;
        if let Some(extension) = material.extension("KHR_materials_volume").filter(|_| transmits) {
            out.thin = extension.number("thicknessFactor").unwrap_or(0.0) <= 0.0;
            if !out.thin {
                medium = self.absorption(extension, material);
            }
        }
        self.what_lacks(material);
        let ior = out.ior;
        let bends = transmits && !out.thin && ior > 1.0;
        let mut handle = self.store_material(material, Material::MetallicRoughness(Box::new(out)));
        if let Some(dispersion) = dispersion(material, ior).filter(|_| bends) {
            handle = self.store_material(material, Material::Dispersive { dispersion, inside: handle });
        }
        Surface { handle, transmits, medium }
    }

    /// White, with nothing on it.
    fn plain(&mut self, at: Item<'d>) -> MetallicRoughness {
        let (none, all) = (self.constant(at, Rgb::BLACK), self.constant(at, Rgb::WHITE));
        MetallicRoughness {
            base_color: all,
            metallic: none,
            roughness: all,
            ior: 1.5,
            specular: all,
            specular_color: all,
            clearcoat: none,
            clearcoat_roughness: none,
            transmission: none,
            thin: true,
            sheen_color: none,
            sheen_roughness: none,
            anisotropy: none,
            anisotropy_rotation: 0.0,
            anisotropy_direction: None,
        }
    }

    fn metallic_roughness(&mut self, material: Item<'d>, with_colors: bool) -> MetallicRoughness {
        let mut out = self.plain(material);
        out.base_color = self.base_color(material, with_colors);
        out.metallic = out.roughness;
        if let Some(pbr) = material.object("pbrMetallicRoughness") {
            let (metallic, roughness) = (unit(pbr, "metallicFactor", 1.0), unit(pbr, "roughnessFactor", 1.0));
            out.metallic = self.product(pbr, metallic, "metallicRoughnessTexture", Part::Blue);
            out.roughness = self.product(pbr, roughness, "metallicRoughnessTexture", Part::Green);
        }
        if let Some(extension) = material.extension("KHR_materials_ior") {
            let ior = extension.number("ior").unwrap_or(1.5);
            if ior == 0.0 || ior >= 1.0 {
                out.ior = ior as f32;
            } else {
                extension.error("\"ior\" must be at least 1, or 0");
            }
        }
        if let Some(extension) = material.extension("KHR_materials_specular") {
            out.specular = self.product(
                extension,
                unit(extension, "specularFactor", 1.0),
                "specularTexture",
                Part::Alpha,
            );
            let color = factors(extension, "specularColorFactor", [1.0; 3]);
            out.specular_color = self.product(extension, color, "specularColorTexture", Part::Colors);
        }
        out
    }

    /// The older model as one without metal, whose reflection has the given colour: its diffuse part is what that leaves
    /// over in both.
    fn specular_glossiness(&mut self, extension: Item<'d>, with_colors: bool) -> MetallicRoughness {
        let mut out = self.plain(extension);
        let [r, g, b, _] = factors(extension, "diffuseFactor", [1.0; 4]);
        let diffuse = self.product(extension, Rgb::new(r, g, b), "diffuseTexture", Part::Colors);
        out.base_color = if with_colors { self.with_colors(extension, diffuse) } else { diffuse };
        let specular = factors(extension, "specularFactor", [1.0; 3]).map(|v| v / USUAL_REFLECTANCE);
        out.specular_color = self.product(extension, specular, "specularGlossinessTexture", Part::Colors);
        let gloss = unit(extension, "glossinessFactor", 1.0);
        let weight = self.product(extension, gloss, "specularGlossinessTexture", Part::Alpha);
        let (a, b) = (self.constant(extension, Rgb::WHITE), self.constant(extension, Rgb::BLACK));
        out.roughness = match self.textures.list[weight] {
            Texture::Constant(gloss) => self.constant(extension, Rgb::WHITE - gloss),
            _ => self.store_texture(extension, Texture::Mix { weight, a, b }),
        };
        out
    }

    fn coat_and_sheen(&mut self, material: Item<'d>, out: &mut MetallicRoughness) {
        if let Some(extension) = material.extension("KHR_materials_clearcoat") {
            let strength = unit(extension, "clearcoatFactor", 0.0);
            out.clearcoat = self.product(extension, strength, "clearcoatTexture", Part::Red);
            let roughness = unit(extension, "clearcoatRoughnessFactor", 0.0);
            out.clearcoat_roughness =
                self.product(extension, roughness, "clearcoatRoughnessTexture", Part::Green);
            if extension.has("clearcoatNormalTexture") {
                self.once(
                    extension,
                    "a coat has the normals of what is below: \"clearcoatNormalTexture\" is not read",
                );
            }
        }
        if let Some(extension) = material.extension("KHR_materials_sheen") {
            let color = factors(extension, "sheenColorFactor", [0.0; 3]).map(|v| v.min(1.0));
            out.sheen_color = self.product(extension, color, "sheenColorTexture", Part::Colors);
            let roughness = unit(extension, "sheenRoughnessFactor", 0.0);
            out.sheen_roughness = self.product(extension, roughness, "sheenRoughnessTexture", Part::Alpha);
        }
    }

    fn anisotropy(&mut self, material: Item<'d>, out: &mut MetallicRoughness) {
        let Some(extension) = material.extension("KHR_materials_anisotropy") else { return };
        let strength = unit(extension, "anisotropyStrength", 0.0);
        out.anisotropy = self.product(extension, strength, "anisotropyTexture", Part::Blue);
        out.anisotropy_rotation = extension.number("anisotropyRotation").unwrap_or(0.0) as f32;
        out.anisotropy_direction = self.part(extension, "anisotropyTexture", Part::Numbers);
    }

    /// What absorbs behind a surface: after the distance white has become the colour.
    fn absorption(&mut self, extension: Item<'d>, material: Item<'d>) -> Option<Handle<Medium>> {
        let distance = extension.number("attenuationDistance")?;
        if distance <= 0.0 {
            extension.error("\"attenuationDistance\" must be above zero");
            return None;
        }
        let color = factors(extension, "attenuationColor", [1.0; 3]);
        // Nothing is so dark that it had no logarithm.
        let sigma_a = Rgb::from(color.map(|c| -ln(c.clamp(1e-6, 1.0)) / distance as f32));
        if sigma_a.is_black() {
            return None;
        }
        let name = material.called("volume", 0);
        self.origins.media.push(extension.at());
        Some(self.media.list.push(Medium::homogeneous(name, sigma_a, Rgb::BLACK, Phase::Isotropic)))
    }

    /// Says what of a material is not read.
    fn what_lacks(&mut self, material: Item<'d>) {
        let is_on = |extension: &str, factor: &str| {
            material.extension(extension).is_some_and(|e| e.number(factor).unwrap_or(0.0) > 0.0)
        };
        if is_on("KHR_materials_iridescence", "iridescenceFactor") {
            self.once(material, "iridescence is not read: thin films have no colours");
        }
    }
}

/// How strongly glass takes light apart: the extension's number is 20 over the one of Abbe.
fn dispersion(material: Item, ior: f32) -> Option<Dispersion> {
    let extension = material.extension("KHR_materials_dispersion")?;
    let strength = extension.number("dispersion").unwrap_or(0.0);
    if strength < 0.0 {
        extension.error("\"dispersion\" must not be negative");
    }
    let of = |strength: f32| Dispersion::from_abbe(ior, 20.0 / strength);
    // Light of long waves is bent less the more glass disperses, in proportion; it must be bent at all.
    let red = Wavelength::from_nm(Wavelength::LONGEST_NM);
    let most = (ior - LEAST_IOR) / (ior - of(1.0).ior(red));
    if strength as f32 > most {
        extension.warn(format!(
            "glass of the index {ior} cannot have a \"dispersion\" above {most:.1}, which is taken"
        ));
    }
    (strength > 0.0).then(|| of((strength as f32).min(most)))
}

/// A factor between 0 and 1, in all channels.
fn unit(owner: Item, name: &str, default: f64) -> Rgb {
    Rgb::splat(owner.number_within(name, default, 0.0, 1.0) as f32)
}
