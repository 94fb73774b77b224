use super::Material;
use super::bsdf::{Bsdf, Lobes};
use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::lambertian::Lambertian;
use super::phong::Phong;
use super::surface::Surface;
use crate::color::Rgb;
use crate::handle::{Arena, Handle};
use crate::math::Vec3;
use crate::texture::{Texture, Textures};

impl Material {
    /// How the material scatters at a point, seen from the side of `wo`: textures are read here and
    /// nowhere else. Values of textures are brought into [0, 1], and Phong's two weights scaled down
    /// where they add up to more than one, so that no image makes a surface reflect more than arrives.
    ///
    /// One-sided materials are black from behind. Two-sided ones turn the surface over, so that `wo` is
    /// always in front of them.
    ///
    /// # Panics
    ///
    /// If a handle is not of these arenas. A two-sided material that contains itself never returns.
    /// [`check()`] finds both.
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
            side =
                match materials[side] {
                    Self::TwoSided { back, .. } if wo.dot(surface.ng) < 0.0 => {
                        surface = surface.flipped();
                        back
                    }
                    Self::TwoSided { front, .. } => front,
                    Self::NormalMap { normals, scale, inside } => {
                        surface = surface.mapped(textures, normals, scale);
                        inside
                    }
                    Self::BumpMap { heights, scale, inside } => {
                        surface = surface.raised(textures, heights, scale);
                        inside
                    }
                    Self::Blend { weight, first, second } => {
                        if textures.eval(weight, surface.at).mean() > 0.5 { second } else { first }
                    }
                    _ => break,
                }
        }
        let lobes = materials[side].lobes(textures, &surface, wo.dot(surface.ng) > 0.0);
        Bsdf::new(surface.ng, surface.frame, lobes)
    }

    /// The lobes seen from the side the normal points to, or from the other one.
    fn lobes(&self, textures: &Textures, surface: &Surface, in_front: bool) -> Lobes {
        let read = |texture: Handle<Texture>| {
            textures.eval(texture, surface.at).map(|v| if v > 0.0 { v.min(1.0) } else { 0.0 })
        };
        match *self {
            Self::Null => Lobes::Null,
            Self::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance }
            | Self::ThinDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance }
            | Self::RoughDielectric {
                int_ior, ext_ior, specular_reflectance, specular_transmittance, ..
            } => {
                let dielectric = Dielectric {
                    eta: int_ior / ext_ior,
                    reflectance: read(specular_reflectance),
                    transmittance: read(specular_transmittance),
                };
                if (dielectric.reflectance + dielectric.transmittance).is_black() {
                    Lobes::Black
                } else if !matches!(self, Self::ThinDielectric { .. }) {
                    Lobes::Dielectric(dielectric)
                } else {
                    Lobes::ThinDielectric(dielectric)
                }
            }
            Self::Diffuse { reflectance } | Self::DiffuseTransmission { reflectance, .. } if in_front => {
                lambertian(read(reflectance))
            }
            Self::Plastic { diffuse_reflectance, .. } if in_front => lambertian(read(diffuse_reflectance)),
            Self::Principled(ref principled) if in_front => lambertian(read(principled.base_color)),
            Self::MetallicRoughness(ref gltf) if in_front => lambertian(read(gltf.base_color)),
            Self::Phong { diffuse_reflectance, specular_reflectance, exponent } if in_front => {
                let (diffuse, specular) = (read(diffuse_reflectance), read(specular_reflectance));
                if (diffuse + specular).is_black() {
                    return Lobes::Black;
                }
                let scale = (diffuse + specular).map(|sum| 1.0 / sum.max(1.0));
                Lobes::Phong(Phong { diffuse: diffuse * scale, specular: specular * scale, exponent })
            }
            Self::Conductor { metal, specular_reflectance }
            | Self::RoughConductor { metal, specular_reflectance, .. }
            | Self::CoatedConductor { metal, specular_reflectance, .. }
                if in_front =>
            {
                let reflectance = read(specular_reflectance);
                if reflectance.is_black() {
                    Lobes::Black
                } else {
                    Lobes::Conductor(Conductor { metal, reflectance })
                }
            }
            _ => Lobes::Black,
        }
    }
}

fn lambertian(albedo: Rgb) -> Lobes {
    if albedo.is_black() { Lobes::Black } else { Lobes::Diffuse(Lambertian { albedo }) }
}
