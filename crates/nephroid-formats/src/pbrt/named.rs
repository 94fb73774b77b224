//! Spectra that pbrt knows by name.

use nephroid::color::Rgb;
use nephroid::material::Dispersion;

use super::color_space::xyz_of;
use crate::spectra::{Known, metal, xyz_to_rgb};

/// Indices of refraction at 587.6 nm and Abbe numbers, from the data sheets of Schott AG.
const GLASSES: [(&str, f32, f32); 10] = [
    ("glass-BK7", 1.5168, 64.17),
    ("glass-BAF10", 1.6700, 47.11),
    ("glass-FK51A", 1.4866, 84.47),
    ("glass-LASF9", 1.8503, 32.17),
    // SF5, SF10 and SF11 by both spellings that are in use.
    ("glass-SF5", 1.6727, 32.21),
    ("glass-SF10", 1.7283, 28.41),
    ("glass-SF11", 1.7847, 25.76),
    ("glass-F5", 1.6727, 32.21),
    ("glass-F10", 1.7283, 28.41),
    ("glass-F11", 1.7847, 25.76),
];

/// Chromaticities of standard illuminants for the 2° observer (CIE 015:2018; D60 as SMPTE ST 2065-1 has it).
const ILLUMINANTS: [(&str, [f64; 2]); 16] = [
    ("stdillum-A", [0.44758, 0.40745]),
    ("stdillum-D50", [0.34567, 0.35851]),
    ("stdillum-D65", [0.31272, 0.32903]),
    ("stdillum-F1", [0.31310, 0.33727]),
    ("stdillum-F2", [0.37208, 0.37529]),
    ("stdillum-F3", [0.40910, 0.39430]),
    ("stdillum-F4", [0.44018, 0.40329]),
    ("stdillum-F5", [0.31379, 0.34531]),
    ("stdillum-F6", [0.37790, 0.38835]),
    ("stdillum-F7", [0.31292, 0.32933]),
    ("stdillum-F8", [0.34588, 0.35875]),
    ("stdillum-F9", [0.37417, 0.37281]),
    ("stdillum-F10", [0.34609, 0.35986]),
    ("stdillum-F11", [0.38052, 0.37713]),
    ("stdillum-F12", [0.43695, 0.40441]),
    ("illum-acesD60", [0.32168, 0.33767]),
];

/// Metals that pbrt has by name.
const METALS: [&str; 7] = ["Ag", "Al", "Au", "Cu", "CuZn", "MgO", "TiO2"];

/// η and k of brass at the wavelengths of red, green and blue, as they are in use among renderers.
const BRASS: [[f32; 3]; 2] = [[0.444, 0.527, 1.094], [3.695, 2.765, 1.829]];

/// What stands behind a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum NamedSpectrum {
    /// An index of refraction, or what metals absorb.
    Index(Rgb),
    /// Light of luminance one.
    Light(Rgb),
}

/// η and k of a metal.
pub(super) fn metal_index(name: &str) -> Option<[Rgb; 2]> {
    if name == "CuZn" {
        return Some(BRASS.map(Rgb::from));
    }
    match metal(name).filter(|_| METALS.contains(&name)) {
        Some(Known::Index(eta, k)) => Some([eta, k]),
        _ => None,
    }
}

/// How a glass of that name takes light apart.
pub(super) fn glass_dispersion(name: &str) -> Option<Dispersion> {
    let (_, n_d, abbe) = GLASSES.iter().find(|(known, ..)| *known == name)?;
    Some(Dispersion::from_abbe(*n_d, *abbe))
}

/// The spectrum of a name.
pub(super) fn named_spectrum(name: &str) -> Option<NamedSpectrum> {
    if let Some((_, value, _)) = GLASSES.iter().find(|(known, ..)| *known == name) {
        return Some(NamedSpectrum::Index(Rgb::splat(*value)));
    }
    if let Some((_, xy)) = ILLUMINANTS.iter().find(|(known, _)| *known == name) {
        let rgb = xyz_to_rgb(xyz_of(*xy).to_array());
        return Some(NamedSpectrum::Light(Rgb::from(rgb.map(|v| v as f32))));
    }
    let (metal, what) = name.strip_prefix("metal-")?.rsplit_once('-')?;
    let [eta, k] = metal_index(metal)?;
    match what {
        "eta" => Some(NamedSpectrum::Index(eta)),
        "k" => Some(NamedSpectrum::Index(k)),
        _ => None,
    }
}

/// Every name, for proposals.
pub(super) fn spectrum_names() -> Vec<String> {
    let metals = METALS.iter().flat_map(|m| [format!("metal-{m}-eta"), format!("metal-{m}-k")]);
    let others = GLASSES.iter().map(|(name, ..)| *name).chain(ILLUMINANTS.iter().map(|(name, _)| *name));
    metals.chain(others.map(str::to_owned)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names() {
        assert_eq!(named_spectrum("glass-BK7"), Some(NamedSpectrum::Index(Rgb::splat(1.5168))));
        assert!(spectrum_names().iter().all(|name| named_spectrum(name).is_some()));
        assert!(
            ["metal-Au", "metal-Xx-eta", "metal-Au-q", "glass", ""]
                .iter()
                .all(|n| named_spectrum(n).is_none())
        );
        let Some(NamedSpectrum::Light(white)) = named_spectrum("stdillum-D65") else { panic!("no light") };
        assert!((white - Rgb::WHITE).map(f32::abs).max_channel() < 1e-3, "{white:?}");
    }
}
