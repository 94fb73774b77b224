//! Materials that are rough, layered or mixed.

use nephroid::handle::Handle;
use nephroid::material::{Distribution, Material, MetallicRoughness, Principled, Roughness};
use nephroid::texture::Texture;

use super::Writer;
use super::textures::{Range, texture_id};

impl Writer<'_, '_> {
    pub(super) fn roughness(&mut self, roughness: &Roughness) {
        self.distribution(roughness);
        if roughness.alpha_u == roughness.alpha_v {
            self.scalar("alpha", roughness.alpha_u);
        } else {
            self.scalar("alpha_u", roughness.alpha_u);
            self.scalar("alpha_v", roughness.alpha_v);
        }
    }

    fn distribution(&mut self, roughness: &Roughness) {
        let name = match roughness.distribution {
            Distribution::Ggx => "ggx",
            Distribution::Beckmann => "beckmann",
        };
        self.xml.string("distribution", name);
    }

    /// `roughplastic` takes one number.
    pub(super) fn plain_roughness(&mut self, id: &str, roughness: &Roughness) {
        self.distribution(roughness);
        let sides = [roughness.alpha_u, roughness.alpha_v];
        let grey = self.constant(sides[0]).filter(|v| v.min_channel() == v.max_channel());
        match grey.filter(|_| sides[0] == sides[1]) {
            Some(alpha) => self.xml.float("alpha", alpha.r),
            None => {
                self.warn(format!("{id}: Mitsuba's plastic is as rough everywhere and in all directions"));
                self.xml.float("alpha", 0.5 * (self.mean(sides[0]) + self.mean(sides[1])));
            }
        }
    }

    pub(super) fn principled(&mut self, id: &str, principled: &Principled) {
        self.xml.plugin("bsdf", "principled", id);
        self.paint("base_color", principled.base_color, Range::Unit);
        for (name, texture) in [
            ("roughness", principled.roughness),
            ("anisotropic", principled.anisotropic),
            ("metallic", principled.metallic),
            ("spec_trans", principled.spec_trans),
            ("spec_tint", principled.spec_tint),
            ("sheen", principled.sheen),
            ("sheen_tint", principled.sheen_tint),
            ("flatness", principled.flatness),
            ("clearcoat", principled.clearcoat),
            ("clearcoat_gloss", principled.clearcoat_gloss),
        ] {
            self.scalar(name, texture);
        }
        self.xml.float("eta", principled.eta);
    }

    /// What Disney's material has of glTF's.
    pub(super) fn metallic_roughness(&mut self, id: &str, gltf: &MetallicRoughness) {
        self.warn("Mitsuba has no material of glTF: \"principled\" stands for it");
        let clear = self.mean(gltf.transmission) > 0.0;
        let thin = gltf.thin && clear;
        self.xml.plugin("bsdf", if thin { "principledthin" } else { "principled" }, id);
        self.paint("base_color", gltf.base_color, Range::Unit);
        self.scalar("roughness", gltf.roughness);
        self.xml.float("eta", if gltf.ior > 1.0 { gltf.ior } else { 1.5 });
        let sheen = self.mean(gltf.sheen_color);
        if sheen > 0.0 {
            self.xml.float("sheen", sheen);
        }
        if clear {
            self.scalar("spec_trans", gltf.transmission);
        }
        if !thin {
            self.scalar("metallic", gltf.metallic);
            self.scalar("clearcoat", gltf.clearcoat);
            let gloss = 1.0 - self.mean(gltf.clearcoat_roughness);
            self.xml.float("clearcoat_gloss", gloss);
        }
    }

    /// A sheet that is all diffuse, as bright as both sides together.
    pub(super) fn diffuse_transmission(
        &mut self,
        id: &str,
        reflectance: Handle<Texture>,
        transmittance: Handle<Texture>,
    ) {
        self.warn("Mitsuba 3 has no \"difftrans\": \"principledthin\" stands for it");
        let (reflected, passed) = (self.mean(reflectance), self.mean(transmittance));
        let sum = reflected + passed;
        self.xml.plugin("bsdf", "principledthin", id);
        match (self.constant(reflectance), self.constant(transmittance)) {
            (Some(r), Some(t)) => self.xml.rgb("base_color", (r + t).map(|v| v.min(1.0))),
            _ if passed > reflected => self.paint("base_color", transmittance, Range::Unit),
            _ => self.paint("base_color", reflectance, Range::Unit),
        }
        self.xml.float("roughness", 1.0);
        self.xml.float("diff_trans", if sum > 0.0 { 2.0 * passed / sum } else { 0.0 });
    }

    /// `normalmap` and `bumpmap`; what has no texture is nothing but the material in it.
    pub(super) fn tilted(
        &mut self,
        id: &str,
        map: Handle<Texture>,
        scale: f32,
        inside: Handle<Material>,
        bump: bool,
    ) {
        if self.constant(map).is_some() {
            // Nowhere tilted, or everywhere alike, which no image of a normal is.
            self.warn(format!("{id}: normals are tilted by images only"));
            self.xml.plugin("bsdf", "mask", id);
            self.xml.float("opacity", 1.0);
        } else if bump {
            self.xml.plugin("bsdf", "bumpmap", id);
            self.xml.reference("", &texture_id(map));
            self.xml.float("scale", scale);
        } else {
            if scale != 1.0 {
                self.warn(format!("{id}: Mitsuba knows no scale of normals"));
            }
            self.xml.plugin("bsdf", "normalmap", id);
            self.xml.reference("normalmap", &texture_id(map));
        }
        self.inside(inside);
    }
}
