use super::Material;
use crate::color::Wavelength;
use crate::handle::{Arena, Handle};

/// How the index of refraction of a glass depends on the wavelength in a vacuum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dispersion {
    /// n = A + B/λ² (Cauchy 1830).
    Cauchy {
        /// A.
        a: f32,
        /// B in µm².
        b: f32,
    },
    /// n² = 1 + Σ B λ²/(λ² − C) (Sellmeier 1871), as makers of glass publish it.
    Sellmeier {
        /// The three B.
        b: [f32; 3],
        /// The three C in µm².
        c: [f32; 3],
    },
}

/// Fraunhofer's lines F, d and C in µm: between them the Abbe number measures.
const LINES_UM: [f32; 3] = [0.486_132_7, 0.587_561_8, 0.656_272_5];

impl Dispersion {
    /// Cauchy's formula with the index `n_d` at 587.6 nm and the Abbe number V = (n_d − 1)/(n_F − n_C).
    pub fn from_abbe(n_d: f32, abbe: f32) -> Self {
        let [f, d, c] = LINES_UM.map(|line| 1.0 / (line * line));
        let b = (n_d - 1.0) / (abbe * (f - c));
        Self::Cauchy { a: n_d - b * d, b }
    }

    /// The index of refraction.
    pub fn ior(&self, wavelength: Wavelength) -> f32 {
        let square = wavelength.um() * wavelength.um();
        match self {
            Self::Cauchy { a, b } => a + b / square,
            Self::Sellmeier { b, c } => {
                let terms = b.iter().zip(c).map(|(b, c)| b * square / (square - c));
                (1.0 + terms.sum::<f32>()).sqrt()
            }
        }
    }

    /// The index at 587.6 nm, which stands for all where light is not taken apart.
    pub fn nominal_ior(&self) -> f32 {
        self.ior(Wavelength::from_nm(1e3 * LINES_UM[1]))
    }

    /// What is wrong with it, if anything: the index must be a number above zero for all light that is seen.
    pub(super) fn problem(&self) -> Option<String> {
        let steps = (Wavelength::SHORTEST_NM as u16)..=(Wavelength::LONGEST_NM as u16);
        let bad = |nm: &u16| {
            let ior = self.ior(Wavelength::from_nm(f32::from(*nm)));
            !(ior.is_finite() && ior > 0.0)
        };
        let nm = steps.into_iter().find(bad)?;
        let ior = self.ior(Wavelength::from_nm(f32::from(nm)));
        Some(format!("the index of refraction at {nm} nm is {ior}, but must be a number above zero"))
    }
}

impl Material {
    /// How the index of refraction of a material depends on wavelength, if it does, masks aside.
    pub fn dispersion(materials: &Arena<Self>, material: Handle<Self>) -> Option<Dispersion> {
        let mut material = material;
        loop {
            match materials[material] {
                Self::Mask { inside, .. } | Self::NormalMap { inside, .. } | Self::BumpMap { inside, .. } => {
                    material = inside;
                }
                Self::Dispersive { dispersion, .. } => return Some(dispersion),
                _ => return None,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Schott's N-BK7.
    const BK7: Dispersion = Dispersion::Sellmeier {
        b: [1.039_612, 0.231_792_34, 1.010_469_5],
        c: [0.006_000_698_7, 0.020_017_914, 103.560_65],
    };

    #[test]
    fn glass_has_the_indices_of_its_data_sheet() {
        for (nm, index) in [(486.13, 1.522_38), (587.56, 1.516_80), (656.27, 1.514_32), (404.66, 1.530_24)] {
            let ior = BK7.ior(Wavelength::from_nm(nm));
            assert!((ior - index).abs() < 2e-5, "{nm} nm: {ior}");
        }
        assert!((BK7.nominal_ior() - 1.516_80).abs() < 2e-5);
    }

    #[test]
    fn an_abbe_number_comes_back() {
        let (n, abbe) = (1.7, 25.0);
        let glass = Dispersion::from_abbe(n, abbe);
        let at = |um: f32| glass.ior(Wavelength::from_nm(1e3 * um));
        assert!((at(LINES_UM[1]) - n).abs() < 1e-5);
        let found = (at(LINES_UM[1]) - 1.0) / (at(LINES_UM[0]) - at(LINES_UM[2]));
        assert!((found / abbe - 1.0).abs() < 1e-3, "{found}");
    }

    #[test]
    fn formulas_that_leave_the_numbers_are_told() {
        assert_eq!(BK7.problem(), None);
        let pole = Dispersion::Sellmeier { b: [1.0, 0.0, 0.0], c: [0.25, 0.0, 0.0] };
        assert!(pole.problem().is_some_and(|p| p.contains(" nm is ")), "{:?}", pole.problem());
        assert!(Dispersion::Cauchy { a: f32::NAN, b: 0.0 }.problem().is_some());
    }
}
