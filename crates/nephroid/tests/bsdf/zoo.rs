//! The materials, surfaces and directions that every test goes through.

use nephroid::color::Rgb;
use nephroid::handle::{Arena, Handle};
use nephroid::material::{Bsdf, Dispersion, Material, Metal, Surface};
use nephroid::math::{Frame, Vec2, Vec3, real, warp};
use nephroid::texture::{Texture, Textures};

use crate::statistics::Rng;

/// A material and what is known of it.
pub struct Case {
    pub name: &'static str,
    pub material: Handle<Material>,
    /// Reflects and transmits all that arrives, on either side.
    pub lossless: bool,
}

/// A surface and whether it is shaded with its own normal.
pub struct Place {
    pub surface: Surface,
    pub flat: bool,
}

#[derive(Default)]
pub struct Zoo {
    pub textures: Textures,
    pub materials: Arena<Material>,
    pub cases: Vec<Case>,
}

impl Zoo {
    pub fn new() -> Self {
        let mut zoo = Self::default();
        zoo.add_opaque();
        zoo.add_transparent();
        zoo.add_two_sided();
        zoo
    }

    fn add_opaque(&mut self) {
        let white = self.grey(1.0);
        let red = self.textures.constant(Rgb::new(0.8, 0.2, 0.1));
        let tint = self.textures.constant(Rgb::new(0.2, 0.5, 0.9));
        self.add("white diffuse, one-sided", Material::Diffuse { reflectance: white });
        self.add("red diffuse", Material::Diffuse { reflectance: red });
        for (name, diffuse, specular, exponent) in [
            ("phong 0", 0.3, 0.6, 0.0),
            ("phong 10", 0.5, 0.5, 10.0),
            ("phong 1000", 0.2, 0.7, 1000.0),
            ("phong, lobe only", 0.0, 1.0, 40.0),
            ("phong, no lobe", 0.7, 0.0, 40.0),
        ] {
            let diffuse_reflectance = self.grey(diffuse);
            let specular_reflectance = self.grey(specular);
            self.add(name, Material::Phong { diffuse_reflectance, specular_reflectance, exponent });
        }
        let coloured =
            Material::Phong { diffuse_reflectance: red, specular_reflectance: tint, exponent: 5.0 };
        // 0.8 + 0.2, 0.2 + 0.5, 0.1 + 0.9.
        self.add("phong, coloured", coloured);
        let mirror = Material::Conductor { metal: Metal::PerfectMirror, specular_reflectance: white };
        self.add("mirror, one-sided", mirror);
        let gold = Metal::Index { eta: Rgb::new(0.18, 0.43, 1.38), k: Rgb::new(3.42, 2.46, 1.91) };
        self.add("gold", Material::Conductor { metal: gold, specular_reflectance: tint });
    }

    fn add_transparent(&mut self) {
        let white = self.grey(1.0);
        let tint = self.textures.constant(Rgb::new(0.2, 0.5, 0.9));
        for (name, int_ior, ext_ior) in
            [("glass", 1.5, 1.0), ("bubble in water", 1.0, 1.33), ("water in water", 1.33, 1.33)]
        {
            let specular_reflectance = white;
            let (specular_transmittance, clear) = (white, true);
            let glass =
                Material::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance };
            self.add_lossless(name, glass, clear);
        }
        let (int_ior, ext_ior) = (1.7, 1.1);
        let (specular_reflectance, specular_transmittance) = (self.grey(0.5), tint);
        let tinted = Material::Dielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance };
        self.add("tinted glass", tinted);
        let pane =
            Material::ThinDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance };
        self.add("tinted pane", pane);
        let (specular_reflectance, specular_transmittance) = (white, white);
        let pane =
            Material::ThinDielectric { int_ior, ext_ior, specular_reflectance, specular_transmittance };
        self.add_lossless("pane", pane, true);
        let (int_ior, ext_ior) = (1.6, 1.0);
        let inside = self.materials.push(Material::Dielectric {
            int_ior,
            ext_ior,
            specular_reflectance,
            specular_transmittance,
        });
        let dispersion = Dispersion::from_abbe(int_ior, 30.0);
        self.add_lossless("prism", Material::Dispersive { dispersion, inside }, true);
        self.add_lossless("null", Material::Null, true);
    }

    fn add_two_sided(&mut self) {
        let white = self.grey(1.0);
        let paper = self.materials.push(Material::Diffuse { reflectance: white });
        self.add_lossless("white paper", Material::TwoSided { front: paper, back: paper }, true);
        let specular_reflectance = white;
        let mirror =
            self.materials.push(Material::Conductor { metal: Metal::PerfectMirror, specular_reflectance });
        let phong = Material::Phong {
            diffuse_reflectance: self.grey(0.4),
            specular_reflectance: self.grey(0.5),
            exponent: 20.0,
        };
        let phong = self.materials.push(phong);
        self.add("phong before mirror", Material::TwoSided { front: phong, back: mirror });
        let nested = self.materials.push(Material::TwoSided { front: mirror, back: phong });
        self.add("mirror before diffuse, nested", Material::TwoSided { front: nested, back: paper });
        let opacity = self.grey(0.3);
        self.add("phong under a mask", Material::Mask { opacity, inside: phong });
    }

    fn grey(&mut self, value: f32) -> Handle<Texture> {
        self.textures.constant(Rgb::splat(value))
    }

    fn add(&mut self, name: &'static str, material: Material) {
        self.add_lossless(name, material, false);
    }

    fn add_lossless(&mut self, name: &'static str, material: Material, lossless: bool) {
        let material = self.materials.push(material);
        self.cases.push(Case { name, material, lossless });
    }

    pub fn bsdf(&self, case: &Case, surface: &Surface, wo: Vec3) -> Bsdf {
        Material::at(&self.materials, case.material, &self.textures, surface, wo)
    }

    /// The index of refraction on the side of `w`; one where the material says nothing of it.
    pub fn index(&self, case: &Case, surface: &Surface, w: Vec3) -> f32 {
        match self.materials[Material::unmasked(&self.materials, case.material)] {
            Material::Dielectric { int_ior, .. } if w.dot(surface.ng) < 0.0 => int_ior,
            Material::Dielectric { ext_ior, .. } => ext_ior,
            _ => 1.0,
        }
    }
}

/// A surface with its own normal, one that leans a little and one that leans a lot.
pub fn places() -> Vec<Place> {
    let ng = Vec3::new(0.3, -0.5, 0.7).normalize();
    let frame = Frame::from_normal(ng);
    [0.0f32, 0.2, 0.7]
        .map(|tilt| {
            let (sin, cos) = real::sin_cos(tilt);
            let n = frame.to_world(Vec3::new(0.6 * sin, 0.8 * sin, cos)).normalize();
            let surface = Surface::new(ng, n, Vec2::ZERO);
            Place { surface, flat: tilt == 0.0 }
        })
        .into()
}

/// Directions on both sides of a surface: along the normal, at grazing incidence and between.
pub fn directions(surface: &Surface) -> Vec<Vec3> {
    let frame = Frame::from_normal(surface.ng);
    let mut directions = Vec::new();
    for (i, theta_deg) in [0.0f32, 25.0, 50.0, 80.0, 89.0, 95.0, 120.0, 150.0, 180.0].into_iter().enumerate()
    {
        let (sin, cos) = real::sin_cos(theta_deg.to_radians());
        let (sin_phi, cos_phi) = real::sin_cos(2.4 * i as f32);
        directions.push(frame.to_world(Vec3::new(sin * cos_phi, sin * sin_phi, cos)).normalize());
    }
    directions
}

/// A direction anywhere, uniformly.
pub fn anywhere(rng: &mut Rng) -> Vec3 {
    warp::square_to_sphere(rng.square())
}

/// Calls `f` with every material at every place from every direction.
pub fn for_each(mut f: impl FnMut(&Zoo, &Case, &Place, Vec3, Bsdf)) {
    let zoo = Zoo::new();
    for case in &zoo.cases {
        for place in places() {
            for wo in directions(&place.surface) {
                f(&zoo, case, &place, wo, zoo.bsdf(case, &place.surface, wo));
            }
        }
    }
}

/// A new material does not compile here, nor pass below, before the zoo has it.
#[test]
fn the_zoo_has_every_material() {
    let zoo = Zoo::new();
    let kind = |material: &Material| match material {
        Material::Diffuse { .. } => 0,
        Material::Phong { .. } => 1,
        Material::Conductor { .. } => 2,
        Material::Dielectric { .. } => 3,
        Material::ThinDielectric { .. } => 4,
        Material::TwoSided { .. } => 5,
        Material::Null => 6,
        Material::Mask { .. } => 7,
        Material::Dispersive { .. } => 8,
        _ => 9,
    };
    for wanted in 0..=8 {
        assert!(zoo.cases.iter().any(|case| kind(&zoo.materials[case.material]) == wanted), "{wanted}");
    }
}
