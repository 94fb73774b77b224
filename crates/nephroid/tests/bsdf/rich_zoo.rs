//! Rough, layered and mixed materials.

use nephroid::color::Rgb;
use nephroid::material::{Distribution, Material, Metal, MetallicRoughness, Principled, Roughness};

use crate::zoo::Zoo;

const GOLD: Metal = Metal::Index { eta: Rgb::new(0.18, 0.43, 1.38), k: Rgb::new(3.42, 2.46, 1.91) };

impl Zoo {
    pub fn add_rich(&mut self) {
        self.add_rough_boundaries();
        self.add_coats();
        self.add_principled();
        self.add_metallic_roughness();
        self.add_mixtures();
    }

    fn roughness(&mut self, distribution: Distribution, alphas: [f32; 2]) -> Roughness {
        let [alpha_u, alpha_v] = alphas.map(|alpha| self.grey(alpha));
        Roughness { distribution, alpha_u, alpha_v }
    }

    fn add_rough_boundaries(&mut self) {
        let white = self.grey(1.0);
        for (gold, glass, fine, distribution, alphas) in [
            ("sharp gold", "sharp glass", 24, Distribution::Ggx, [0.08, 0.08]),
            ("rough gold", "rough glass", 10, Distribution::Ggx, [0.5, 0.5]),
            ("brushed gold", "brushed glass", 18, Distribution::Ggx, [0.15, 0.6]),
            ("beckmann gold", "beckmann glass", 10, Distribution::Beckmann, [0.3, 0.3]),
            ("brushed beckmann gold", "brushed beckmann glass", 12, Distribution::Beckmann, [0.7, 0.2]),
        ] {
            let roughness = self.roughness(distribution, alphas);
            let metal = Material::RoughConductor { metal: GOLD, specular_reflectance: white, roughness };
            self.add_rich_case(gold, fine, metal);
            let glass_of = |int_ior, ext_ior| Material::RoughDielectric {
                int_ior,
                ext_ior,
                specular_reflectance: white,
                specular_transmittance: white,
                roughness,
            };
            self.add_rich_case(glass, fine, glass_of(1.5, 1.0));
            if alphas == [0.5, 0.5] {
                self.add_rich_case("rough bubble", 10, glass_of(1.0, 1.33));
                let mirror = Metal::PerfectMirror;
                let mirror =
                    Material::RoughConductor { metal: mirror, specular_reflectance: white, roughness };
                self.add_rich_case("rough mirror", 10, mirror);
            }
        }
    }

    fn add_coats(&mut self) {
        let (white, red) = (self.grey(1.0), self.textures.constant(Rgb::new(0.8, 0.2, 0.1)));
        let rough = self.roughness(Distribution::Ggx, [0.3, 0.3]);
        let fine = self.roughness(Distribution::Beckmann, [0.1, 0.05]);
        for (name, parts, base, nonlinear, roughness) in [
            ("white plastic", 6, white, true, None),
            ("red plastic", 6, red, false, None),
            ("rough plastic", 10, red, true, Some(rough)),
            ("brushed plastic", 24, white, false, Some(fine)),
        ] {
            let plastic = Material::Plastic {
                int_ior: 1.5,
                ext_ior: 1.0,
                diffuse_reflectance: base,
                specular_reflectance: white,
                nonlinear,
                roughness,
            };
            self.add_rich_case(name, parts, plastic);
        }
        for (name, parts, roughness, coat_roughness) in [
            ("gold in glass", 6, None, None),
            ("rough gold in glass", 10, Some(rough), None),
            ("gold in rough glass", 24, None, Some(rough)),
            ("rough gold in fine glass", 24, Some(rough), Some(fine)),
        ] {
            let coated = Material::CoatedConductor {
                metal: GOLD,
                specular_reflectance: white,
                roughness,
                coat_ior: 1.5,
                coat_roughness,
            };
            self.add_rich_case(name, parts, coated);
        }
    }

    fn add_principled(&mut self) {
        let plain = Principled::plain(&mut self.textures);
        let (white, half, most) = (self.grey(1.0), self.grey(0.5), self.grey(0.8));
        let red = self.textures.constant(Rgb::new(0.8, 0.2, 0.1));
        let paint = Principled { base_color: white, clearcoat: white, ..plain };
        let cloth = Principled {
            base_color: white,
            roughness: most,
            spec_tint: half,
            sheen: white,
            sheen_tint: half,
            flatness: half,
            ..plain
        };
        let car = Principled {
            base_color: red,
            anisotropic: most,
            metallic: half,
            clearcoat: white,
            clearcoat_gloss: half,
            ..plain
        };
        let glass = Principled { base_color: red, spec_trans: most, clearcoat: half, ..plain };
        for (name, parts, principled) in [
            ("opaque principled", 10, plain),
            ("opaque paint", 24, paint),
            ("opaque cloth", 10, cloth),
            ("opaque car", 24, car),
            ("stained glass", 24, glass),
        ] {
            self.add_rich_case(name, parts, Material::Principled(Box::new(principled)));
        }
    }

    fn add_metallic_roughness(&mut self) {
        let plain = MetallicRoughness::plain(&mut self.textures);
        let (white, half, most) = (self.grey(1.0), self.grey(0.5), self.grey(0.8));
        let red = self.textures.constant(Rgb::new(0.8, 0.2, 0.1));
        let car = MetallicRoughness {
            base_color: red,
            metallic: half,
            roughness: half,
            clearcoat: white,
            clearcoat_roughness: half,
            anisotropy: most,
            anisotropy_rotation: 0.7,
            ..plain
        };
        let cloth = MetallicRoughness { sheen_color: red, sheen_roughness: half, ..plain };
        let pane = MetallicRoughness { base_color: red, roughness: half, transmission: most, ..plain };
        let glass = MetallicRoughness {
            thin: false,
            clearcoat_roughness: half,
            clearcoat: half,
            sheen_color: half,
            sheen_roughness: most,
            ..pane
        };
        for (name, gltf) in [
            ("opaque gltf", plain),
            ("opaque gltf car", car),
            ("opaque gltf cloth", cloth),
            ("gltf pane", pane),
            ("gltf glass", glass),
        ] {
            self.add_rich_case(name, 12, Material::MetallicRoughness(Box::new(gltf)));
        }
    }

    fn add_mixtures(&mut self) {
        let (white, half) = (self.grey(1.0), self.grey(0.5));
        let leaf = Material::DiffuseTransmission { reflectance: half, transmittance: white };
        self.add_rich_case("leaf", 6, leaf.clone());
        let leaf = self.materials.push(leaf);
        let find = |zoo: &Self, name: &str| {
            zoo.cases.iter().find(|case| case.name == name).expect("a case of this name").material
        };
        let (gold, glass, phong) =
            (find(self, "rough gold"), find(self, "rough glass"), find(self, "phong 10"));
        let (mirror, pane) = (find(self, "mirror, one-sided"), find(self, "pane"));
        let both = self.materials.push(Material::TwoSided { front: phong, back: gold });
        for (name, first, second) in [
            ("opaque blend", phong, gold),
            ("blend of leaf and mirror", leaf, mirror),
            ("blend of sides", both, glass),
        ] {
            self.add_rich_case(name, 10, Material::Blend { weight: half, first, second });
        }
        let first = find(self, "blend of leaf and mirror");
        let nested = Material::Blend { weight: half, first, second: pane };
        self.add_rich_case("nested blend", 6, nested);
        let inside = find(self, "opaque blend");
        self.add_rich_case(
            "opaque blend in maps",
            10,
            Material::NormalMap { normals: half, scale: 0.0, against_v: false, inside },
        );
        self.add_rich_case("opaque bumps", 10, Material::BumpMap { heights: half, scale: 1.0, inside: gold });
    }
}
