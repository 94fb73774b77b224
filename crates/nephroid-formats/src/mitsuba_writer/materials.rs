//! Materials.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::material::{Material, Metal};
use nephroid::shape::Mesh;
use nephroid::texture::Texture;

use super::Writer;
use super::textures::Range;

impl Writer<'_, '_> {
    pub(super) fn materials(&mut self) {
        let scene = self.scene;
        for (handle, material) in scene.materials.iter_handles() {
            self.material(&id(handle), material);
        }
    }

    fn material(&mut self, id: &str, material: &Material) {
        match *material {
            Material::Diffuse { reflectance } => {
                self.xml.plugin("bsdf", "diffuse", id);
                self.paint("reflectance", reflectance, Range::Unit);
            }
            Material::Phong { diffuse_reflectance, specular_reflectance, exponent } => {
                self.phong(id, diffuse_reflectance, specular_reflectance, exponent);
            }
            Material::Conductor { metal, specular_reflectance } => {
                self.xml.plugin("bsdf", "conductor", id);
                self.metal(metal);
                self.paint("specular_reflectance", specular_reflectance, Range::Unit);
            }
            Material::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance } => {
                self.xml.plugin("bsdf", "dielectric", id);
                self.glass(int_ior, ext_ior, specular_reflectance, specular_transmittance);
            }
            Material::ThinDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance } => {
                self.xml.plugin("bsdf", "thindielectric", id);
                self.glass(int_ior, ext_ior, specular_reflectance, specular_transmittance);
            }
            Material::TwoSided { front, back } => {
                self.xml.plugin("bsdf", "twosided", id);
                self.inside(front);
                if back != front {
                    self.inside(back);
                }
            }
            Material::Mask { opacity, inside } => {
                self.xml.plugin("bsdf", "mask", id);
                self.scalar("opacity", opacity);
                self.inside(inside);
            }
            Material::RoughConductor { metal, specular_reflectance, roughness } => {
                self.xml.plugin("bsdf", "roughconductor", id);
                self.metal(metal);
                self.paint("specular_reflectance", specular_reflectance, Range::Unit);
                self.roughness(&roughness);
            }
            Material::RoughDielectric {
                int_ior,
                ext_ior,
                specular_reflectance,
                specular_transmittance,
                roughness,
            } => {
                self.xml.plugin("bsdf", "roughdielectric", id);
                self.glass(int_ior, ext_ior, specular_reflectance, specular_transmittance);
                self.roughness(&roughness);
            }
            Material::Plastic {
                int_ior,
                ext_ior,
                diffuse_reflectance,
                specular_reflectance,
                nonlinear,
                roughness,
            } => {
                let kind = if roughness.is_some() { "roughplastic" } else { "plastic" };
                self.xml.plugin("bsdf", kind, id);
                self.xml.float("int_ior", int_ior);
                self.xml.float("ext_ior", ext_ior);
                self.paint("diffuse_reflectance", diffuse_reflectance, Range::Unit);
                self.paint("specular_reflectance", specular_reflectance, Range::Unit);
                self.xml.boolean("nonlinear", nonlinear);
                if let Some(roughness) = roughness {
                    self.plain_roughness(id, &roughness);
                }
            }
            Material::CoatedConductor { metal, specular_reflectance, roughness, .. } => {
                self.warn("Mitsuba 3 has no coats: coated metals are bare");
                let kind = if roughness.is_some() { "roughconductor" } else { "conductor" };
                self.xml.plugin("bsdf", kind, id);
                self.metal(metal);
                self.paint("specular_reflectance", specular_reflectance, Range::Unit);
                if let Some(roughness) = roughness {
                    self.roughness(&roughness);
                }
            }
            Material::DiffuseTransmission { reflectance, transmittance } => {
                self.diffuse_transmission(id, reflectance, transmittance);
            }
            Material::Principled(ref principled) => self.principled(id, principled),
            Material::MetallicRoughness(ref gltf) => self.metallic_roughness(id, gltf),
            Material::Blend { weight, first, second } => {
                self.xml.plugin("bsdf", "blendbsdf", id);
                self.scalar("weight", weight);
                self.inside(first);
                self.inside(second);
            }
            Material::NormalMap { normals, scale, inside, against_v } => {
                if against_v && self.scene.meshes.iter().any(is_mirrored) {
                    let message =
                        "where texture coordinates are mirrored, Mitsuba turns this normal map over";
                    self.warn(format!("{id}: {message}"));
                }
                self.tilted(id, normals, scale, inside, false);
            }
            Material::BumpMap { heights, scale, inside } => self.tilted(id, heights, scale, inside, true),
            Material::Dispersive { inside, .. } => {
                self.warn("Mitsuba 3 refracts all wavelengths alike: dispersion is left out");
                return self.material(id, &self.scene.materials[inside]);
            }
            Material::Null => self.xml.plugin("bsdf", "null", id),
        }
        self.xml.close();
    }

    pub(super) fn inside(&mut self, material: Handle<Material>) {
        self.xml.reference("", &id(material));
    }

    pub(super) fn metal(&mut self, metal: Metal) {
        match metal {
            Metal::PerfectMirror => self.xml.string("material", "none"),
            Metal::Index { eta, k } => {
                self.xml.rgb("eta", eta);
                self.xml.rgb("k", k);
            }
        }
    }

    fn glass(&mut self, int_ior: f32, ext_ior: f32, reflected: Handle<Texture>, passed: Handle<Texture>) {
        self.xml.float("int_ior", int_ior);
        self.xml.float("ext_ior", ext_ior);
        self.paint("specular_reflectance", reflected, Range::Unit);
        self.paint("specular_transmittance", passed, Range::Unit);
    }

    /// A blend of a Lambertian and a rough metal: Mitsuba 3 has no lobe of this kind.
    fn phong(&mut self, id: &str, diffuse: Handle<Texture>, specular: Handle<Texture>, exponent: f32) {
        self.warn("Mitsuba 3 has no Phong lobe: a blend with a rough metal stands for it");
        let mean = Rgb::mean;
        let [kd, ks] = [diffuse, specular].map(|texture| self.scene.textures.mean(texture));
        let weight = if mean(kd + ks) > 0.0 { mean(ks) / mean(kd + ks) } else { 0.0 };
        self.xml.plugin("bsdf", "blendbsdf", id);
        self.xml.float("weight", weight);
        for (kind, texture, name, share) in [
            ("diffuse", diffuse, "reflectance", 1.0 - weight),
            ("roughconductor", specular, "specular_reflectance", weight),
        ] {
            self.xml.plugin("bsdf", kind, "");
            if kind == "roughconductor" {
                self.xml.string("material", "none");
                self.xml.string("distribution", "beckmann");
                self.xml.float("alpha", alpha_of_exponent(exponent));
            }
            match self.constant(texture) {
                Some(value) if share > 0.0 => {
                    self.xml.rgb(name, (value * (1.0 / share)).map(|v| v.min(1.0)));
                }
                _ => self.paint(name, texture, Range::Unit),
            }
            self.xml.close();
        }
    }
}

pub(super) fn id(material: Handle<Material>) -> String {
    format!("material-{}", material.index())
}

/// The width of Beckmann's distribution whose middle falls off as cosⁿ does (Walter et al. 2007, section 5.2),
/// within what Mitsuba takes. An exponent about the mirror direction is a quarter of that about the normal.
fn alpha_of_exponent(exponent: f32) -> f32 {
    (2.0 / (4.0 * exponent + 2.0)).sqrt().clamp(1e-3, 1.0)
}

/// Whether v grows to the left of growing u somewhere on a mesh, where that of images whose first row is the upper one grows
/// to the right.
fn is_mirrored(mesh: &Mesh) -> bool {
    let uv = |i: u32| mesh.uvs.get(i as usize).copied().unwrap_or_default();
    mesh.triangles.iter().any(|corners| {
        let [a, b, c] = corners.map(uv);
        (b - a).perp_dot(c - a) > 0.0
    })
}
