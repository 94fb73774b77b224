use super::bsdf::{Bsdf, Lobes};
use super::charlie::Charlie;
use super::coated_conductor::CoatedConductor;
use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::diffuse_transmission::DiffuseTransmission;
use super::disney::Disney;
use super::disney_diffuse::Base;
use super::fresnel::fresnel_dielectric;
use super::gltf::{Gltf, LEAST_ETA};
use super::lambertian::Lambertian;
use super::microfacet::Microfacet;
use super::mixture::{Blend, MOST_PARTS, Weighed};
use super::part::Part;
use super::phong::Phong;
use super::plastic::Plastic;
use super::rough_conductor::RoughConductor;
use super::rough_dielectric::RoughDielectric;
use super::simple::{Clear, Pass, Thin};
use super::surface::Surface;
use super::{Distribution, Material, MetallicRoughness, Principled, Roughness};
use crate::color::Rgb;
use crate::handle::{Arena, Handle};
use crate::math::{Vec2, Vec3, real};
use crate::texture::{Texture, TexturePoint, Textures};

impl Material {
    /// How the material scatters at a point, seen from the side of `wo`: textures are read here and
    /// nowhere else. Values of textures are brought into [0, 1], and weights that belong together scaled down
    /// where they add up to more than one, so that no image makes a surface reflect more than arrives.
    ///
    /// One-sided materials are black from behind. Two-sided ones turn the surface over, so that `wo` is
    /// always in front of them.
    ///
    /// # Panics
    ///
    /// If a handle is not of these arenas. A two-sided material that contains itself never returns.
    /// [`check()`](super::check()) finds both.
    pub fn at(
        materials: &Arena<Self>,
        material: Handle<Self>,
        textures: &Textures,
        surface: &Surface,
        wo: Vec3,
    ) -> Bsdf {
        let mut surface = *surface;
        let mut side = Self::unmasked(materials, material);
        loop {
            side = match materials[side] {
                Self::TwoSided { back, .. } if wo.dot(surface.ng) < 0.0 => {
                    surface = surface.flipped();
                    back
                }
                Self::TwoSided { front, .. } => front,
                Self::Dispersive { inside, .. } => inside,
                Self::NormalMap { normals, scale, against_v, inside } => {
                    surface = surface.mapped(textures, normals, scale, against_v);
                    inside
                }
                Self::BumpMap { heights, scale, inside } => {
                    surface = surface.raised(textures, heights, scale);
                    inside
                }
                Self::Blend { .. } => {
                    let lobes = blended(materials, side, textures, &surface, wo.dot(surface.ng) > 0.0);
                    return Bsdf::new(surface.ng, surface.frame, lobes);
                }
                _ => break,
            }
        }
        let (reader, in_front) = (Reader { textures, at: surface.at }, wo.dot(surface.ng) > 0.0);
        // What most surfaces are is written where it is wanted: all lobes that there may be are many bytes to move.
        if let Self::Diffuse { reflectance } = materials[side] {
            let albedo = reader.color(reflectance);
            if in_front && !albedo.is_black() {
                return Bsdf::new(surface.ng, surface.frame, Lobes::Diffuse(Lambertian { albedo }));
            }
            return Bsdf::new(surface.ng, surface.frame, Lobes::Black);
        }
        let lobes = materials[side].lobes(&reader, in_front);
        Bsdf::new(surface.ng, surface.frame, lobes)
    }

    /// The lobes seen from the side the normal points to, or from the other one.
    fn lobes(&self, reader: &Reader<'_>, in_front: bool) -> Lobes {
        let read = |texture| reader.color(texture);
        match *self {
            Self::Null => Lobes::Null,
            Self::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance }
            | Self::ThinDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance } => {
                let dielectric = Dielectric {
                    eta: int_ior / ext_ior,
                    reflectance: read(specular_reflectance),
                    transmittance: read(specular_transmittance),
                };
                if (dielectric.reflectance + dielectric.transmittance).is_black() {
                    Lobes::Black
                } else if matches!(self, Self::Dielectric { .. }) {
                    Lobes::Dielectric(dielectric)
                } else {
                    Lobes::ThinDielectric(dielectric)
                }
            }
            Self::RoughDielectric {
                int_ior, ext_ior, specular_reflectance, specular_transmittance, ..
            } if int_ior == ext_ior => {
                Self::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance }
                    .lobes(reader, in_front)
            }
            Self::Diffuse { reflectance } if in_front => {
                let albedo = read(reflectance);
                if albedo.is_black() { Lobes::Black } else { Lobes::Diffuse(Lambertian { albedo }) }
            }
            Self::Phong { diffuse_reflectance, specular_reflectance, exponent } if in_front => {
                let (diffuse, specular) = (read(diffuse_reflectance), read(specular_reflectance));
                if (diffuse + specular).is_black() {
                    return Lobes::Black;
                }
                let [diffuse, specular] = within_one(diffuse, specular);
                Lobes::Phong(Phong { diffuse, specular, exponent })
            }
            Self::Conductor { metal, specular_reflectance } if in_front => {
                let reflectance = read(specular_reflectance);
                if reflectance.is_black() {
                    Lobes::Black
                } else {
                    Lobes::Conductor(Conductor { metal, reflectance })
                }
            }
            _ => self.part(reader, in_front).map_or(Lobes::Black, |part| Lobes::One(Weighed::whole(part))),
        }
    }

    /// The same of materials that are more than one simple lobe; `None` of others and where nothing is scattered.
    fn part(&self, reader: &Reader<'_>, in_front: bool) -> Option<Part> {
        let read = |texture| reader.color(texture);
        let facets = |roughness: &Roughness| reader.facets(roughness);
        let part = match self {
            Self::RoughDielectric {
                int_ior,
                ext_ior,
                specular_reflectance,
                specular_transmittance,
                roughness,
            } => {
                let (reflectance, transmittance) =
                    (read(*specular_reflectance), read(*specular_transmittance));
                if (reflectance + transmittance).is_black() {
                    return None;
                }
                let (eta, facets) = (int_ior / ext_ior, facets(roughness));
                Part::RoughDielectric(RoughDielectric { eta, reflectance, transmittance, facets })
            }
            Self::DiffuseTransmission { reflectance, transmittance } => {
                let [reflectance, transmittance] = within_one(read(*reflectance), read(*transmittance));
                if (reflectance + transmittance).is_black() {
                    return None;
                }
                Part::DiffuseTransmission(DiffuseTransmission { reflectance, transmittance })
            }
            Self::Principled(principled) => return reader.principled(principled, in_front),
            Self::MetallicRoughness(gltf) => return reader.metallic_roughness(gltf, in_front),
            _ if !in_front => return None,
            Self::RoughConductor { metal, specular_reflectance, roughness } => {
                let reflectance = read(*specular_reflectance);
                if reflectance.is_black() {
                    return None;
                }
                Part::RoughConductor(RoughConductor { metal: *metal, reflectance, facets: facets(roughness) })
            }
            Self::Plastic {
                int_ior,
                ext_ior,
                diffuse_reflectance,
                specular_reflectance,
                nonlinear,
                roughness,
            } => {
                let (diffuse, specular) = (read(*diffuse_reflectance), read(*specular_reflectance));
                if (diffuse + specular).is_black() {
                    return None;
                }
                let facets = roughness.as_ref().map(facets);
                Part::Plastic(Plastic::new(int_ior / ext_ior, diffuse, specular, *nonlinear, facets))
            }
            Self::CoatedConductor { metal, specular_reflectance, roughness, coat_ior, coat_roughness } => {
                let (own, coat) = (roughness.as_ref().map(facets), coat_roughness.as_ref().map(facets));
                let reflectance = read(*specular_reflectance);
                Part::CoatedConductor(CoatedConductor::new(*metal, reflectance, own, *coat_ior, coat))
            }
            _ => return None,
        };
        Some(part)
    }
}

/// Both colours, scaled down where they add up to more than one.
fn within_one(a: Rgb, b: Rgb) -> [Rgb; 2] {
    let scale = (a + b).map(|sum| 1.0 / sum.max(1.0));
    [a * scale, b * scale]
}

/// The lobes of a blend.
fn blended(
    materials: &Arena<Material>,
    blend: Handle<Material>,
    textures: &Textures,
    surface: &Surface,
    in_front: bool,
) -> Lobes {
    let reader = Reader { textures, at: surface.at };
    let mut found = [Weighed::whole(Part::Null(Pass)); MOST_PARTS];
    let mut count = 0;
    // What is still to be looked at; each blend takes one away and adds two.
    let mut waiting = [(blend, 1.0, false); MOST_PARTS + 1];
    let mut left = 1;
    while left > 0 {
        left -= 1;
        let (material, weight, flipped) = waiting[left];
        let mut wait = |next| {
            if left < waiting.len() {
                waiting[left] = next;
                left += 1;
            }
        };
        match &materials[material] {
            Material::Blend { weight: of_second, first, second } => {
                let share = reader.scalar(*of_second);
                if share > 0.0 {
                    wait((*second, weight * share, flipped));
                }
                if share < 1.0 {
                    wait((*first, weight * (1.0 - share), flipped));
                }
            }
            Material::TwoSided { front, back } => {
                let behind = in_front == flipped;
                wait((if behind { *back } else { *front }, weight, flipped != behind));
            }
            Material::Mask { inside, .. }
            | Material::Dispersive { inside, .. }
            | Material::NormalMap { inside, .. }
            | Material::BumpMap { inside, .. } => wait((*inside, weight, flipped)),
            simple => {
                if let Some(part) = as_part(simple.lobes(&reader, in_front != flipped))
                    && count < MOST_PARTS
                {
                    found[count] = Weighed { weight, flipped, part };
                    count += 1;
                }
            }
        }
    }
    Blend::new(&found[..count]).map_or(Lobes::Black, Lobes::Blend)
}

fn as_part(lobes: Lobes) -> Option<Part> {
    match lobes {
        Lobes::Black | Lobes::Blend(_) => None,
        Lobes::Null => Some(Part::Null(Pass)),
        Lobes::Diffuse(own) => Some(Part::Diffuse(own)),
        Lobes::Phong(own) => Some(Part::Phong(own)),
        Lobes::Conductor(own) => Some(Part::Conductor(own)),
        Lobes::Dielectric(own) => Some(Part::Dielectric(Clear(own))),
        Lobes::ThinDielectric(own) => Some(Part::ThinDielectric(Thin(own))),
        Lobes::One(one) => Some(one.part),
    }
}

/// Reads textures at one place.
struct Reader<'a> {
    textures: &'a Textures,
    at: TexturePoint,
}

impl Reader<'_> {
    fn color(&self, texture: Handle<Texture>) -> Rgb {
        self.textures.eval(texture, self.at).map(|v| if v > 0.0 { v.min(1.0) } else { 0.0 })
    }

    fn scalar(&self, texture: Handle<Texture>) -> f32 {
        let Rgb { r, g, b } = self.color(texture);
        if r == g && g == b { r } else { (r + g + b) / 3.0 }
    }

    fn facets(&self, roughness: &Roughness) -> Microfacet {
        let alpha_u = self.scalar(roughness.alpha_u);
        let alpha_v =
            if roughness.alpha_v == roughness.alpha_u { alpha_u } else { self.scalar(roughness.alpha_v) };
        Microfacet::new(roughness.distribution, alpha_u, alpha_v)
    }

    fn principled(&self, of: &Principled, in_front: bool) -> Option<Part> {
        let [metallic, spec_trans] = [of.metallic, of.spec_trans].map(|texture| self.scalar(texture));
        if !in_front && (1.0 - metallic) * spec_trans == 0.0 {
            return None;
        }
        let [roughness, anisotropic, spec_tint, sheen, sheen_tint] =
            [of.roughness, of.anisotropic, of.spec_tint, of.sheen, of.sheen_tint].map(|t| self.scalar(t));
        let [flatness, clearcoat, gloss] =
            [of.flatness, of.clearcoat, of.clearcoat_gloss].map(|t| self.scalar(t));
        let color = self.color(of.base_color);
        let luminance = color.luminance();
        let tint = if luminance > 0.0 { color / luminance } else { Rgb::WHITE };
        let (clearcoat, coat_alpha) = Disney::coat(clearcoat, gloss);
        Some(Part::Principled(Disney {
            color,
            eta: of.eta.max(LEAST_ETA),
            metallic,
            spec_trans,
            spec_tint,
            clearcoat,
            coat_alpha,
            base: Base {
                color: color * ((1.0 - metallic) * (1.0 - spec_trans)),
                sheen: (Rgb::WHITE + (tint - Rgb::WHITE) * sheen_tint) * (sheen * (1.0 - metallic)),
                roughness,
                flatness,
            },
            facets: Disney::facets(roughness, anisotropic),
        }))
    }

    fn metallic_roughness(&self, of: &MetallicRoughness, in_front: bool) -> Option<Part> {
        let [metallic, transmission] = [of.metallic, of.transmission].map(|texture| self.scalar(texture));
        if !in_front && (1.0 - metallic) * transmission == 0.0 {
            return None;
        }
        let [roughness, specular, anisotropy] =
            [of.roughness, of.specular, of.anisotropy].map(|texture| self.scalar(texture));
        let [clearcoat, coat_roughness, sheen_roughness] =
            [of.clearcoat, of.clearcoat_roughness, of.sheen_roughness].map(|texture| self.scalar(texture));
        let alpha = roughness * roughness;
        let alpha_u = alpha + (1.0 - alpha) * anisotropy * anisotropy;
        let coat_alpha = coat_roughness * coat_roughness;
        let tint = self.textures.eval(of.specular_color, self.at).map(|v| if v > 0.0 { v } else { 0.0 });
        let f0 = if of.ior == 0.0 { 1.0 } else { fresnel_dielectric(1.0, of.ior) };
        let ggx = |u, v| Microfacet::new(Distribution::Ggx, u, v);
        Some(Part::MetallicRoughness(Gltf {
            color: self.color(of.base_color),
            metallic,
            transmission,
            f0: (tint * f0).map(|v| v.min(1.0)) * specular,
            f90: specular,
            eta: if of.thin || of.ior == 0.0 { 1.0 } else { of.ior.max(LEAST_ETA) },
            facets: ggx(alpha_u, alpha),
            turn: self.direction(of),
            clearcoat,
            coat_facets: ggx(coat_alpha, coat_alpha),
            sheen: Charlie::new(self.color(of.sheen_color), sheen_roughness),
        }))
    }

    /// Cosine and sine of the angle of anisotropy.
    fn direction(&self, of: &MetallicRoughness) -> Vec2 {
        let (sin, cos) = real::sin_cos(of.anisotropy_rotation);
        let own = of.anisotropy_direction.map_or(Vec2::X, |texture| {
            let Rgb { r, g, .. } = self.color(texture);
            Vec2::new(2.0 * r - 1.0, 2.0 * g - 1.0).try_normalize().unwrap_or(Vec2::X)
        });
        Vec2::new(cos * own.x - sin * own.y, sin * own.x + cos * own.y)
    }
}
