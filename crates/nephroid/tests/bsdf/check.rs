//! What is said of materials that cannot be rendered.

use nephroid::color::Rgb;
use nephroid::handle::{Arena, Handle};
use nephroid::material::{Material, Metal, check};
use nephroid::texture::Textures;

use crate::zoo::Zoo;

struct Workshop {
    textures: Textures,
    materials: Arena<Material>,
}

impl Workshop {
    fn new() -> Self {
        Self { textures: Textures::default(), materials: Arena::default() }
    }

    /// The only problem of a material says this.
    fn rejects(&mut self, material: Material, message: &str) {
        let material = self.materials.push(material);
        assert_eq!(check(&self.materials, material, &self.textures), [message]);
    }

    fn accepts(&mut self, material: Material) -> Handle<Material> {
        let material = self.materials.push(material);
        assert_eq!(check(&self.materials, material, &self.textures), [""; 0]);
        material
    }
}

#[test]
fn every_material_of_the_zoo_is_in_order() {
    let zoo = Zoo::new();
    for (handle, material) in zoo.materials.iter_handles() {
        assert_eq!(check(&zoo.materials, handle, &zoo.textures), [""; 0], "{material:?}");
    }
}

#[test]
fn albedos() {
    let mut w = Workshop::new();
    let over = w.textures.constant(Rgb::new(0.5, 1.5, 0.5));
    w.rejects(
        Material::Diffuse { reflectance: over },
        "reflectance is (0.5, 1.5, 0.5), which would reflect more light than arrives, and photons would \
         never end; write at most 1 in every channel, and make a light stronger instead",
    );
    for (value, shown) in [(f32::NAN, "(NaN, NaN, NaN)"), (-0.25, "-0.25"), (f32::INFINITY, "inf")] {
        let reflectance = w.textures.constant(Rgb::splat(value));
        let message = format!("reflectance is {shown}, but must be between 0 and 1 in every channel");
        w.rejects(Material::Diffuse { reflectance }, &message);
    }
    let elsewhere = (0..9).fold(over, |_, _| Textures::default().constant(Rgb::WHITE));
    let mut empty = Workshop::new();
    empty.rejects(
        Material::Diffuse { reflectance: elsewhere },
        "reflectance refers to a texture that does not exist",
    );
}

#[test]
fn phong() {
    let mut w = Workshop::new();
    let (dark, bright) = (w.textures.constant(Rgb::splat(0.25)), w.textures.constant(Rgb::WHITE));
    let build = |diffuse_reflectance, specular_reflectance, exponent| Material::Phong {
        diffuse_reflectance,
        specular_reflectance,
        exponent,
    };
    w.rejects(build(dark, dark, -1.0), "exponent is -1, but must be a number from 0 (dull) upwards");
    w.rejects(build(dark, dark, f32::NAN), "exponent is NaN, but must be a number from 0 (dull) upwards");
    w.rejects(
        build(bright, dark, 10.0),
        "diffuse_reflectance and specular_reflectance add up to 1.25, which would reflect more light than \
         arrives, and photons would never end; multiply both by 0.800 or less",
    );
    w.accepts(build(dark, dark, 0.0));
}

#[test]
fn indices_of_refraction() {
    let mut w = Workshop::new();
    let white = w.textures.constant(Rgb::WHITE);
    let build = |int_ior, ext_ior| Material::Dielectric {
        int_ior,
        ext_ior,
        specular_reflectance: white,
        specular_transmittance: white,
    };
    for ior in [0.0, -1.5, f32::NAN, f32::INFINITY] {
        let message = format!(
            "int_ior is {ior}, but an index of refraction is positive and finite (air has 1, water 1.33, \
             glass 1.5)"
        );
        w.rejects(build(ior, 1.0), &message);
        w.rejects(build(1.0, ior), &message.replace("int", "ext"));
        let thin = Material::ThinDielectric {
            int_ior: ior,
            ext_ior: 1.0,
            specular_reflectance: white,
            specular_transmittance: white,
        };
        w.rejects(thin, &message);
    }
    let far = format!("int_ior {} and ext_ior 1 are too far apart to reckon with", 1e30f32);
    w.rejects(build(1e30, 1.0), &far);
    w.accepts(build(1.0, 1.0));
}

#[test]
fn metals() {
    let mut w = Workshop::new();
    let specular_reflectance = w.textures.constant(Rgb::WHITE);
    let metal = Metal::Index { eta: Rgb::splat(-1.0), k: Rgb::WHITE };
    w.rejects(
        Material::Conductor { metal, specular_reflectance },
        "eta is -1, but must be finite and not negative in every channel",
    );
    let metal = Metal::Index { eta: Rgb::WHITE, k: Rgb::new(1.0, f32::NAN, 1.0) };
    w.rejects(
        Material::Conductor { metal, specular_reflectance },
        "k is (1, NaN, 1), but must be finite and not negative in every channel",
    );
}

#[test]
fn two_sided() {
    let mut w = Workshop::new();
    let white = w.textures.constant(Rgb::WHITE);
    let diffuse = w.accepts(Material::Diffuse { reflectance: white });
    let null = w.accepts(Material::Null);
    w.accepts(Material::TwoSided { front: diffuse, back: diffuse });
    w.rejects(
        Material::TwoSided { front: diffuse, back: null },
        "back is a null material, which has two sides already; use it without the two-sided material",
    );
    // Handles of a longer arena: the first names the material itself, the second nothing.
    let mut longer = w.materials.clone();
    let itself = longer.push(Material::Null);
    let nothing = longer.push(Material::Null);
    w.rejects(
        Material::TwoSided { front: itself, back: itself },
        "front refers to the material itself or a later one; store what it refers to first",
    );
    let mut short = Workshop::new();
    short.rejects(
        Material::TwoSided { front: nothing, back: nothing },
        "front refers to a material that does not exist",
    );
}

#[test]
fn masks() {
    let mut w = Workshop::new();
    let (white, black) = (w.textures.constant(Rgb::WHITE), w.textures.constant(Rgb::BLACK));
    let diffuse = w.accepts(Material::Diffuse { reflectance: white });
    let mask = w.accepts(Material::Mask { opacity: black, inside: diffuse });
    w.accepts(Material::Mask { opacity: white, inside: mask });
    for (value, shown) in [(1.5, "1.5"), (-0.1, "-0.1"), (f32::NAN, "(NaN, NaN, NaN)")] {
        let opacity = w.textures.constant(Rgb::splat(value));
        w.rejects(
            Material::Mask { opacity, inside: diffuse },
            &format!("opacity is {shown}, but must be between 0 (not there) and 1 (not masked)"),
        );
    }
    w.rejects(
        Material::TwoSided { front: mask, back: diffuse },
        "front is a mask, which cuts out both sides; put the two-sided material into the mask",
    );
    let mut longer = w.materials.clone();
    let itself = longer.push(Material::Null);
    w.rejects(
        Material::Mask { opacity: white, inside: itself },
        "inside refers to the material itself or a later one; store what it refers to first",
    );
}

#[test]
fn blends() {
    let mut w = Workshop::new();
    let (white, over) = (w.textures.constant(Rgb::WHITE), w.textures.constant(Rgb::splat(1.5)));
    let diffuse = w.accepts(Material::Diffuse { reflectance: white });
    let of = |weight, first, second| Material::Blend { weight, first, second };
    let pair = w.accepts(of(white, diffuse, diffuse));
    let four = w.accepts(of(white, pair, pair));
    w.rejects(of(over, diffuse, pair), "weight is 1.5, but must be between 0 and 1");
    w.rejects(
        of(white, diffuse, four),
        "more than 4 materials are blended; leave out those that weigh least",
    );
    let null = w.accepts(Material::Null);
    w.accepts(of(white, null, diffuse));
    w.rejects(
        of(white, null, null),
        "two materials that are clear and smooth are blended, but light goes on in one way only",
    );
    let mask = w.accepts(Material::Mask { opacity: white, inside: diffuse });
    w.rejects(of(white, mask, diffuse), "first is a mask; put the blend into the mask");
}
