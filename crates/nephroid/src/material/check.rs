use super::mixture::MOST_PARTS;
use super::{Material, Metal, MetallicRoughness, Roughness};
use crate::color::Rgb;
use crate::handle::{Arena, Handle};
use crate::texture::{Texture, Textures};

/// Every problem of a material, one sentence each; none if [`Material::at`] may be called on it.
///
/// The sentences name the parameter, not the material, which only its owner can.
pub fn check(materials: &Arena<Material>, material: Handle<Material>, textures: &Textures) -> Vec<String> {
    let mut problems = Problems { textures, list: Vec::new() };
    match &materials[material] {
        Material::Diffuse { reflectance } => {
            problems.albedo("reflectance", *reflectance);
        }
        Material::Phong { diffuse_reflectance, specular_reflectance, exponent } => {
            problems.phong(*diffuse_reflectance, *specular_reflectance, *exponent);
        }
        Material::Conductor { metal, specular_reflectance } => {
            problems.metal(metal);
            problems.albedo("specular_reflectance", *specular_reflectance);
        }
        Material::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance }
        | Material::ThinDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance } => {
            problems.indices(*int_ior, *ext_ior);
            problems.albedo("specular_reflectance", *specular_reflectance);
            problems.albedo("specular_transmittance", *specular_transmittance);
        }
        Material::RoughConductor { metal, specular_reflectance, roughness } => {
            problems.metal(metal);
            problems.albedo("specular_reflectance", *specular_reflectance);
            problems.roughness("roughness", roughness);
        }
        Material::RoughDielectric {
            int_ior,
            ext_ior,
            specular_reflectance,
            specular_transmittance,
            roughness,
        } => {
            problems.indices(*int_ior, *ext_ior);
            problems.albedo("specular_reflectance", *specular_reflectance);
            problems.albedo("specular_transmittance", *specular_transmittance);
            problems.roughness("roughness", roughness);
        }
        Material::Plastic {
            int_ior, ext_ior, diffuse_reflectance, specular_reflectance, roughness, ..
        } => {
            problems.indices(*int_ior, *ext_ior);
            problems.at_least_one("int_ior / ext_ior", *int_ior / *ext_ior);
            problems.albedo("diffuse_reflectance", *diffuse_reflectance);
            problems.albedo("specular_reflectance", *specular_reflectance);
            problems.optional_roughness("roughness", roughness.as_ref());
        }
        Material::CoatedConductor { metal, specular_reflectance, roughness, coat_ior, coat_roughness } => {
            problems.metal(metal);
            problems.albedo("specular_reflectance", *specular_reflectance);
            problems.optional_roughness("roughness", roughness.as_ref());
            problems.at_least_one("coat_ior", *coat_ior);
            problems.optional_roughness("coat_roughness", coat_roughness.as_ref());
        }
        Material::DiffuseTransmission { reflectance, transmittance } => {
            problems.albedo("reflectance", *reflectance);
            problems.albedo("transmittance", *transmittance);
        }
        Material::Principled(principled) => {
            problems.albedo("base_color", principled.base_color);
            principled.scalars().into_iter().for_each(|(name, texture)| problems.share(name, texture));
            problems.at_least_one("eta", principled.eta);
        }
        Material::MetallicRoughness(gltf) => problems.metallic_roughness(gltf),
        Material::Blend { weight, first, second } => {
            problems.share("weight", *weight);
            problems.part("first", materials, material, *first);
            if first != second {
                problems.part("second", materials, material, *second);
            }
            if problems.list.is_empty() {
                problems.blend(materials, material);
            }
        }
        Material::NormalMap { normals: texture, scale, inside, .. }
        | Material::BumpMap { heights: texture, scale, inside } => {
            problems.exists("the map", *texture);
            if !scale.is_finite() {
                problems.add(format!("scale is {scale}, but must be finite"));
            }
            problems.stored_before("inside", materials, material, *inside);
        }
        Material::TwoSided { front, back } => {
            problems.side("front", materials, material, *front);
            if front != back {
                problems.side("back", materials, material, *back);
            }
        }
        Material::Mask { opacity, inside } => {
            problems.opacity(*opacity);
            problems.stored_before("inside", materials, material, *inside);
        }
        Material::Dispersive { dispersion, inside } => {
            problems.list.extend(dispersion.problem());
            problems.stored_before("inside", materials, material, *inside);
            if materials.contains(*inside) && !bends_light(&materials[*inside]) {
                problems.add("only glass can be dispersive: a smooth or rough dielectric, or a metallic-roughness material that is not thin");
            }
        }
        Material::Null => {}
    }
    problems.list
}

/// Whether it is the boundary of two dielectrics.
fn bends_light(material: &Material) -> bool {
    match material {
        Material::Dielectric { .. } | Material::RoughDielectric { .. } => true,
        Material::MetallicRoughness(of) => !of.thin && of.ior > 0.0,
        _ => false,
    }
}

struct Problems<'a> {
    textures: &'a Textures,
    list: Vec<String>,
}

impl Problems<'_> {
    fn add(&mut self, problem: impl Into<String>) {
        self.list.push(problem.into());
    }

    /// The value of an albedo that is constant and in order.
    fn albedo(&mut self, name: &str, texture: Handle<Texture>) -> Option<Rgb> {
        if !self.exists(name, texture) {
            return None;
        }
        let Texture::Constant(value) = self.textures.list[texture] else { return None };
        if !value.is_finite() || value.min_channel() < 0.0 {
            self.add(format!("{name} is {}, but must be between 0 and 1 in every channel", show(value)));
            return None;
        }
        if value.max_channel() > 1.0 {
            self.add(format!(
                "{name} is {}, which would reflect more light than arrives, and photons would never \
                 end; write at most 1 in every channel, and make a light stronger instead",
                show(value)
            ));
            return None;
        }
        Some(value)
    }

    fn exists(&mut self, name: &str, texture: Handle<Texture>) -> bool {
        let exists = self.textures.list.contains(texture);
        if !exists {
            self.add(format!("{name} refers to a texture that does not exist"));
        }
        exists
    }

    /// A number in [0, 1], or three of them.
    fn share(&mut self, name: &str, texture: Handle<Texture>) {
        if self.exists(name, texture)
            && let Texture::Constant(value) = self.textures.list[texture]
            && !(value.min_channel() >= 0.0 && value.max_channel() <= 1.0)
        {
            self.add(format!("{name} is {}, but must be between 0 and 1", show(value)));
        }
    }

    fn roughness(&mut self, name: &str, roughness: &Roughness) {
        self.share(&format!("{name} along the first tangent"), roughness.alpha_u);
        if roughness.alpha_v != roughness.alpha_u {
            self.share(&format!("{name} along the second tangent"), roughness.alpha_v);
        }
    }

    fn optional_roughness(&mut self, name: &str, roughness: Option<&Roughness>) {
        if let Some(roughness) = roughness {
            self.roughness(name, roughness);
        }
    }

    fn at_least_one(&mut self, name: &str, ior: f32) {
        if !(1.0..=1e3).contains(&ior) {
            self.add(format!("{name} is {ior}, but must be between 1 and 1000"));
        }
    }

    fn metallic_roughness(&mut self, gltf: &MetallicRoughness) {
        self.albedo("base_color", gltf.base_color);
        gltf.bounded().into_iter().for_each(|(name, texture)| self.share(name, texture));
        if self.exists("specular_color", gltf.specular_color)
            && let Texture::Constant(value) = self.textures.list[gltf.specular_color]
            && !(value.is_finite() && value.min_channel() >= 0.0)
        {
            self.add(format!("specular_color is {}, but must be finite and not negative", show(value)));
        }
        if gltf.ior != 0.0 {
            self.at_least_one("ior", gltf.ior);
        }
        if !gltf.anisotropy_rotation.is_finite() {
            self.add("anisotropy_rotation must be finite");
        }
        if let Some(direction) = gltf.anisotropy_direction {
            self.exists("anisotropy_direction", direction);
        }
    }

    fn opacity(&mut self, texture: Handle<Texture>) {
        if self.exists("opacity", texture)
            && let Texture::Constant(value) = self.textures.list[texture]
            && !(value.min_channel() >= 0.0 && value.max_channel() <= 1.0)
        {
            self.add(format!(
                "opacity is {}, but must be between 0 (not there) and 1 (not masked)",
                show(value)
            ));
        }
    }

    fn phong(&mut self, diffuse: Handle<Texture>, specular: Handle<Texture>, exponent: f32) {
        if !(exponent.is_finite() && exponent >= 0.0) {
            self.add(format!("exponent is {exponent}, but must be a number from 0 (dull) upwards"));
        }
        let diffuse = self.albedo("diffuse_reflectance", diffuse);
        let specular = self.albedo("specular_reflectance", specular);
        let (Some(diffuse), Some(specular)) = (diffuse, specular) else { return };
        let sum = diffuse + specular;
        if sum.max_channel() > 1.0 + f32::EPSILON {
            self.add(format!(
                "diffuse_reflectance and specular_reflectance add up to {}, which would reflect more \
                 light than arrives, and photons would never end; multiply both by {:.3} or less",
                show(sum),
                // Rounded down, so that following the advice is enough.
                (1000.0 / sum.max_channel()).floor() / 1000.0
            ));
        }
    }

    fn metal(&mut self, metal: &Metal) {
        let Metal::Index { eta, k } = metal else { return };
        for (name, value) in [("eta", *eta), ("k", *k)] {
            if !value.is_finite() || value.min_channel() < 0.0 {
                self.add(format!(
                    "{name} is {}, but must be finite and not negative in every channel",
                    show(value)
                ));
            }
        }
    }

    fn indices(&mut self, int_ior: f32, ext_ior: f32) {
        let found = self.list.len();
        for (name, ior) in [("int_ior", int_ior), ("ext_ior", ext_ior)] {
            if !(ior.is_finite() && ior > 0.0) {
                self.add(format!(
                    "{name} is {ior}, but an index of refraction is positive and finite (air has 1, water \
                     1.33, glass 1.5)"
                ));
            }
        }
        let ratio_sq = (int_ior / ext_ior) * (int_ior / ext_ior);
        if self.list.len() == found && !(ratio_sq.is_normal() && (1.0 / ratio_sq).is_normal()) {
            self.add(format!("int_ior {int_ior} and ext_ior {ext_ior} are too far apart to reckon with"));
        }
    }

    /// Whether a material that another refers to may be looked at.
    fn stored_before(
        &mut self,
        name: &str,
        materials: &Arena<Material>,
        owner: Handle<Material>,
        other: Handle<Material>,
    ) -> bool {
        if !materials.contains(other) {
            self.add(format!("{name} refers to a material that does not exist"));
        } else if other.index() >= owner.index() {
            self.add(format!(
                "{name} refers to the material itself or a later one; store what it refers to first"
            ));
        } else {
            return true;
        }
        false
    }

    /// What is mixed altogether, blends of blends included.
    fn blend(&mut self, materials: &Arena<Material>, blend: Handle<Material>) {
        let (mut count, mut refracting, mut waiting) = (0, 0, vec![blend]);
        while let Some(next) = waiting.pop() {
            match &materials[next] {
                Material::Blend { first, second, .. } => waiting.extend([*first, *second]),
                Material::NormalMap { inside, .. }
                | Material::BumpMap { inside, .. }
                | Material::Dispersive { inside, .. } => waiting.push(*inside),
                Material::TwoSided { front, back } if front != back => waiting.extend([*front, *back]),
                Material::TwoSided { front, .. } => waiting.push(*front),
                Material::Dielectric { .. } | Material::ThinDielectric { .. } | Material::Null => {
                    (count, refracting) = (count + 1, refracting + 1);
                }
                Material::RoughDielectric { int_ior, ext_ior, .. } if int_ior == ext_ior => {
                    (count, refracting) = (count + 1, refracting + 1);
                }
                _ => count += 1,
            }
            if count > MOST_PARTS {
                self.add(format!(
                    "more than {MOST_PARTS} materials are blended; leave out those that weigh least"
                ));
                return;
            }
        }
        if refracting > 1 {
            self.add(
                "two materials that are clear and smooth are blended, but light goes on in one way only",
            );
        }
    }

    fn part(
        &mut self,
        name: &str,
        materials: &Arena<Material>,
        owner: Handle<Material>,
        part: Handle<Material>,
    ) {
        if self.stored_before(name, materials, owner, part)
            && let Material::Mask { .. } = materials[part]
        {
            self.add(format!("{name} is a mask; put the blend into the mask"));
        }
    }

    fn side(
        &mut self,
        name: &str,
        materials: &Arena<Material>,
        owner: Handle<Material>,
        side: Handle<Material>,
    ) {
        if !self.stored_before(name, materials, owner, side) {
            return;
        }
        if let Material::Mask { .. } = materials[side] {
            self.add(format!(
                "{name} is a mask, which cuts out both sides; put the two-sided material into the mask"
            ));
        } else if let Some(kind) = two_sided_already(materials, self.textures, side) {
            self.add(format!(
                "{name} is {kind}, which has two sides already; use it without the two-sided material"
            ));
        }
    }
}

/// The name of a material that light passes through.
fn two_sided_already(
    materials: &Arena<Material>,
    textures: &Textures,
    material: Handle<Material>,
) -> Option<&'static str> {
    match &materials[material] {
        Material::Dielectric { .. } | Material::Dispersive { .. } => Some("a dielectric"),
        Material::ThinDielectric { .. } => Some("a thin dielectric"),
        Material::Null => Some("a null material"),
        Material::RoughDielectric { .. } => Some("a rough dielectric"),
        Material::DiffuseTransmission { .. } => Some("a diffuse transmitter"),
        other => other.is_clear(materials, textures).then_some("a material that light goes through"),
    }
}

/// One number for grey, three for colours.
fn show(value: Rgb) -> String {
    let Rgb { r, g, b } = value;
    if r == g && g == b { r.to_string() } else { format!("({r}, {g}, {b})") }
}
