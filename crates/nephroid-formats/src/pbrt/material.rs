//! Materials: `Material`, `MakeNamedMaterial` and `NamedMaterial`.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::material::{Material, Metal};
use nephroid::math::{Affine2, Vec2};
use nephroid::texture::{Bitmap, BitmapFilter, Texture, Wrap};

use super::named::{glass_dispersion, metal_index};
use super::names::{MATERIALS, MATERIALS_APPROXIMATED, MATERIALS_OLD};
use super::parameter::{Kind, Values};
use super::parameters::Parameters;
use super::reader::Reader;
use super::state::Current;
use crate::diagnostic::{Diagnostic, Location};
use crate::log::shortened;
use crate::spectra::Role;

/// Materials that one consists of, each counted as often as it is asked.
const MAX_SIZE: u32 = 1000;

/// Names of the roughness of a boundary.
const ROUGHNESS: [&str; 3] = ["uroughness", "vroughness", "roughness"];

impl Reader<'_> {
    /// A material of the scene, and where it stands in the file.
    pub(super) fn store_material(&mut self, at: &Location, material: Material) -> Handle<Material> {
        let size = match &material {
            Material::Blend { first, second, .. } => 1 + self.size_of(*first) + self.size_of(*second),
            Material::TwoSided { front: inside, .. }
            | Material::Mask { inside, .. }
            | Material::Dispersive { inside, .. }
            | Material::NormalMap { inside, .. }
            | Material::BumpMap { inside, .. } => 1 + self.size_of(*inside),
            _ => 1,
        };
        let fits = size <= MAX_SIZE;
        if !fits {
            self.log.error(at, format!("the material consists of more than {MAX_SIZE} others"));
        }
        self.material_sizes.push(if fits { size } else { 1 });
        self.origins.materials.push(at.clone());
        self.materials.push(if fits { material } else { Material::Null })
    }

    fn size_of(&self, material: Handle<Material>) -> u32 {
        self.material_sizes.get(material.index()).copied().unwrap_or(1)
    }

    pub(super) fn set_material(&mut self, parameters: &Parameters) -> Current {
        self.new_material(parameters).map_or(Current::Failed, Current::Is)
    }

    pub(super) fn make_named_material(&mut self, name: String, mut parameters: Parameters) {
        let name_at = parameters.at.clone();
        let kind = parameters.text("type").map(|(kind, at)| (kind.to_owned(), at.clone()));
        let handle = match kind {
            Some((kind, at)) => {
                (parameters.kind, parameters.at) = (kind, at);
                self.new_material(&parameters)
            }
            None => {
                let message = Diagnostic::error(&name_at, "the material has no type");
                self.log.push(message.hint("write \"string type\" and its name"));
                None
            }
        };
        if self.named_materials.insert(name.clone(), handle).is_some() {
            self.log.error(&name_at, format!("the material \"{}\" is there already", shortened(&name)));
        }
    }

    pub(super) fn named_material(&mut self, name: &str, at: &Location) {
        self.state.material = self.material_of_name(name, at).map_or(Current::Failed, Current::Is);
    }

    fn material_of_name(&self, name: &str, at: &Location) -> Option<Handle<Material>> {
        if let Some(known) = self.named_materials.get(name) {
            return *known;
        }
        let message = format!("no material is called \"{}\"", shortened(name));
        let known = self.named_materials.keys().map(String::as_str);
        let mut message = Diagnostic::error(at, message).did_you_mean(name, known);
        if message.hint.is_none() {
            message = message.hint("MakeNamedMaterial must stand before its use");
        }
        self.log.push(message);
        None
    }

    /// A material with its tilted normals. `None` if the log says why.
    fn new_material(&mut self, parameters: &Parameters) -> Option<Handle<Material>> {
        let at = &parameters.at;
        let (material, two_sided) = match parameters.kind.as_str() {
            "diffuse" => {
                let reflectance = self.albedo(parameters, "reflectance", 0.5);
                (reflectance.map(|reflectance| Material::Diffuse { reflectance }), true)
            }
            "dielectric" => (self.dielectric(parameters), false),
            "thindielectric" => (self.thin_dielectric(parameters), false),
            "conductor" => (self.conductor(parameters), true),
            "coateddiffuse" => (self.coated_diffuse(parameters, "reflectance"), true),
            "coatedconductor" => (self.coated_conductor(parameters), true),
            "diffusetransmission" => (self.diffuse_transmission(parameters), false),
            "mix" => return self.mix(parameters),
            "interface" => (Some(Material::Null), false),
            "subsurface" => (self.subsurface(parameters), true),
            "hair" => (self.like_hair(parameters), true),
            "measured" => {
                self.stands_for(parameters, "grey and diffuse");
                (Some(self.grey(parameters)), true)
            }
            kind if MATERIALS_OLD.contains(&kind) => return self.old_material(parameters),
            _ => {
                self.unknown_kind(parameters, &[MATERIALS, MATERIALS_APPROXIMATED, MATERIALS_OLD]);
                return None;
            }
        };
        let handle = material.map(|material| self.store_sides(at, material, two_sided));
        let handle = handle.map(|handle| self.with_dispersion(parameters, handle));
        let handle = self.tilted(parameters, handle);
        if MATERIALS_APPROXIMATED.contains(&parameters.kind.as_str()) {
            parameters.finish_approximated();
        } else {
            parameters.ignore(&["type"]);
            parameters.finish();
        }
        handle
    }

    /// A material alone, or on both sides, as pbrt has all that lets no light through.
    pub(super) fn store_sides(
        &mut self,
        at: &Location,
        material: Material,
        two_sided: bool,
    ) -> Handle<Material> {
        let side = self.store_material(at, material);
        if !two_sided {
            return side;
        }
        self.store_material(at, Material::TwoSided { front: side, back: side })
    }

    /// A material with what tilts its normals.
    pub(super) fn tilted(
        &mut self,
        parameters: &Parameters,
        inside: Option<Handle<Material>>,
    ) -> Option<Handle<Material>> {
        let at = &parameters.at;
        let bump = if parameters.has("displacement") { "displacement" } else { "bumpmap" };
        if parameters.has(bump) {
            let heights = self.texture_or_color(parameters, bump, Rgb::BLACK, Role::Index)?;
            return Some(self.store_material(at, Material::BumpMap { heights, scale: 1.0, inside: inside? }));
        }
        if let Some((name, map_at)) = parameters.text("normalmap") {
            let (path, bytes) = self.read_file(name, map_at)?;
            let image = self.decoded(&path, &bytes, true, map_at)?;
            let image = self.store_image(image, map_at);
            let mut to_uv = Affine2::from_scale(Vec2::new(1.0, -1.0));
            to_uv.translation = Vec2::Y;
            let bitmap = Bitmap { image, filter: BitmapFilter::Bilinear, wrap: Wrap::Repeat, to_uv };
            let normals = self.store_texture(map_at, Texture::Bitmap(bitmap));
            return Some(self.store_material(
                at,
                Material::NormalMap { normals, scale: 1.0, against_v: false, inside: inside? },
            ));
        }
        inside
    }

    /// A share of light, from 0 to 1.
    pub(super) fn albedo(
        &mut self,
        parameters: &Parameters,
        name: &'static str,
        default: f32,
    ) -> Option<Handle<Texture>> {
        let texture = self.texture_or_color(parameters, name, Rgb::splat(default), Role::Reflectance)?;
        match self.constant(texture) {
            // Of a float, or a float texture.
            Some(value) if value.max_channel() > 1.0 => {
                let at = parameters.at.clone();
                Some(self.store_texture(&at, Texture::Constant(value.map(|v| v.min(1.0)))))
            }
            _ => Some(texture),
        }
    }

    pub(super) fn white(&mut self, parameters: &Parameters) -> Handle<Texture> {
        self.store_texture(&parameters.at, Texture::Constant(Rgb::WHITE))
    }

    /// An index of refraction: of spectra, that of their middle.
    pub(super) fn ior(&mut self, parameters: &Parameters, name: &'static str, default: f32) -> f32 {
        let Some(found) = parameters.any(name) else { return default };
        let value = self.color_of(parameters, found, Role::Index).map_or(default, |index| index.g);
        if value > 0.0 {
            return value;
        }
        self.log.error(&found.value_at, format!("\"{name}\" must be above zero, not {value}"));
        default
    }

    /// Glass by its name, which takes light apart.
    fn with_dispersion(&mut self, parameters: &Parameters, glass: Handle<Material>) -> Handle<Material> {
        let Some(eta) = parameters.any("eta").filter(|_| parameters.kind == "dielectric") else {
            return glass;
        };
        if eta.kind != Kind::Spectrum {
            return glass;
        }
        let dispersion = match &eta.values {
            Values::Texts(texts) => texts.first().and_then(|name| glass_dispersion(name)),
            _ => None,
        };
        match (dispersion, &self.materials[glass]) {
            (Some(dispersion), Material::Dielectric { .. } | Material::RoughDielectric { .. }) => {
                self.store_material(&parameters.at, Material::Dispersive { dispersion, inside: glass })
            }
            _ => {
                let message = "only glass by its name takes light apart: this has one index of refraction";
                self.log.warn(&eta.value_at, message);
                glass
            }
        }
    }

    fn dielectric(&mut self, parameters: &Parameters) -> Option<Material> {
        let int_ior = self.ior(parameters, "eta", 1.5);
        let roughness = self.roughness(parameters, ROUGHNESS, 0.0);
        let white = self.white(parameters);
        let (ext_ior, specular_reflectance, specular_transmittance) = (1.0, white, white);
        Some(match roughness {
            None => Material::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance },
            Some(roughness) => Material::RoughDielectric {
                int_ior,
                ext_ior,
                specular_reflectance,
                specular_transmittance,
                roughness,
            },
        })
    }

    fn thin_dielectric(&mut self, parameters: &Parameters) -> Option<Material> {
        let int_ior = self.ior(parameters, "eta", 1.5);
        let white = self.white(parameters);
        Some(Material::ThinDielectric {
            int_ior,
            ext_ior: 1.0,
            specular_reflectance: white,
            specular_transmittance: white,
        })
    }

    /// A metal: by its indices, or by what it reflects; and what multiplies that.
    fn metal(
        &mut self,
        parameters: &Parameters,
        [eta, k]: [&'static str; 2],
    ) -> Option<(Metal, Handle<Texture>)> {
        let [copper_eta, copper_k] = metal_index("Cu").unwrap_or([Rgb::WHITE; 2]);
        if let Some(reflectance) = parameters.any("reflectance") {
            for name in [eta, k] {
                if let Some(other) = parameters.any(name) {
                    let message = format!("give either \"reflectance\" or \"{eta}\" and \"{k}\"");
                    self.log.error(&other.location, message);
                }
            }
            if reflectance.kind == Kind::Texture {
                let texture = self.albedo(parameters, "reflectance", 1.0)?;
                return Some((Metal::PerfectMirror, texture));
            }
            // Such a k that reflection at right angles is what is wanted, at an index of one.
            let wanted = self.color_of(parameters, reflectance, Role::Reflectance)?;
            let k = wanted.map(|r| 2.0 * (r.min(0.9999) / (1.0 - r.min(0.9999))).sqrt());
            return Some((Metal::Index { eta: Rgb::WHITE, k }, self.white(parameters)));
        }
        let mut index = |name: &'static str, default| match parameters.any(name) {
            Some(found) if found.kind == Kind::Texture => {
                let message = format!("a texture of \"{name}\" cannot be had yet: its mean stands for it");
                self.log.warn(&found.value_at, message);
                let texture = self.texture_or_color(parameters, name, default, Role::Index)?;
                Some(self.textures.mean(texture))
            }
            Some(found) => self.color_of(parameters, found, Role::Index),
            None => Some(default),
        };
        let (eta, k) = (index(eta, copper_eta), index(k, copper_k));
        Some((Metal::Index { eta: eta?, k: k? }, self.white(parameters)))
    }

    fn conductor(&mut self, parameters: &Parameters) -> Option<Material> {
        let roughness = self.roughness(parameters, ROUGHNESS, 0.0);
        let (metal, specular_reflectance) = self.metal(parameters, ["eta", "k"])?;
        Some(match roughness {
            None => Material::Conductor { metal, specular_reflectance },
            Some(roughness) => Material::RoughConductor { metal, specular_reflectance, roughness },
        })
    }

    /// A diffuse base below a coat.
    pub(super) fn coated_diffuse(&mut self, parameters: &Parameters, base: &'static str) -> Option<Material> {
        let int_ior = self.coat_ior(parameters, "eta");
        let roughness = self.roughness(parameters, ROUGHNESS, 0.0);
        let specular_reflectance = self.white(parameters);
        let reflectance = self.albedo(parameters, base, 0.5);
        self.coat_is_clear(parameters);
        Some(Material::Plastic {
            int_ior,
            ext_ior: 1.0,
            diffuse_reflectance: reflectance?,
            specular_reflectance,
            nonlinear: true,
            roughness,
        })
    }

    fn coated_conductor(&mut self, parameters: &Parameters) -> Option<Material> {
        let coat_ior = self.coat_ior(parameters, "interface.eta");
        let names = ["interface.uroughness", "interface.vroughness", "interface.roughness"];
        let coat_roughness = self.roughness(parameters, names, 0.0);
        let names = ["conductor.uroughness", "conductor.vroughness", "conductor.roughness"];
        let roughness = self.roughness(parameters, names, 0.0);
        self.coat_is_clear(parameters);
        let (metal, specular_reflectance) = self.metal(parameters, ["conductor.eta", "conductor.k"])?;
        Some(Material::CoatedConductor { metal, specular_reflectance, roughness, coat_ior, coat_roughness })
    }

    fn coat_ior(&mut self, parameters: &Parameters, name: &'static str) -> f32 {
        let ior = self.ior(parameters, name, 1.5);
        if ior < 1.0 {
            let message =
                format!("a coat with an index of refraction of {ior}, below 1, cannot be had: 1 it is");
            self.log.warn(&parameters.at, message);
        }
        ior.max(1.0)
    }

    /// Coats have no medium in them here.
    fn coat_is_clear(&self, parameters: &Parameters) {
        if let Some(albedo) = parameters.any("albedo") {
            let message = "a coat that scatters light cannot be had yet: it is clear";
            self.log.warn(&albedo.location, message);
        }
        parameters.ignore(&["thickness", "g", "maxdepth", "nsamples"]);
    }

    fn diffuse_transmission(&mut self, parameters: &Parameters) -> Option<Material> {
        let scale = Rgb::splat(parameters.not_negative("scale", 1.0) as f32);
        let at = parameters.at.clone();
        let mut scaled = |name| {
            let texture = self.albedo(parameters, name, 0.25)?;
            let scale = self.store_texture(&at, Texture::Constant(scale));
            let product = self.product(texture, scale, &at);
            match self.constant(product) {
                Some(value) if value.max_channel() > 1.0 => {
                    Some(self.store_texture(&at, Texture::Constant(value.map(|v| v.min(1.0)))))
                }
                _ => Some(product),
            }
        };
        let (reflectance, transmittance) = (scaled("reflectance"), scaled("transmittance"));
        Some(Material::DiffuseTransmission { reflectance: reflectance?, transmittance: transmittance? })
    }

    fn mix(&mut self, parameters: &Parameters) -> Option<Handle<Material>> {
        let weight = self.texture_or_color(parameters, "amount", Rgb::splat(0.5), Role::Index);
        let weight = weight.map(|weight| match self.constant(weight) {
            Some(value) if value.max_channel() > 1.0 => self.white(parameters),
            _ => weight,
        });
        let pair = match parameters.texts("materials") {
            Some(([first, second], at)) => Some([first, second].map(|name| self.material_of_name(name, at))),
            Some((_, at)) => {
                self.log.error(at, "\"materials\" takes two names");
                None
            }
            None => {
                self.log.error(&parameters.at, "\"mix\" needs \"string materials\", two names");
                None
            }
        };
        parameters.ignore(&["type"]);
        parameters.finish();
        let [first, second] = pair?;
        let material = Material::Blend { weight: weight?, first: first?, second: second? };
        Some(self.store_material(&parameters.at, material))
    }
}
