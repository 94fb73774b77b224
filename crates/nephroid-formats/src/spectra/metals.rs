//! Complex indices of refraction of the conductors that scenes name.
//!
//! They are measurements of η and k at some wavelengths, taken from the database of refractiveindex.info
//! (Polyanskiy 2024, doi 10.1038/s41597-023-02898-2; its data are in the public domain, CC0) or, where it has
//! none of visible light, from Palik's tables (1991, *Handbook of Optical Constants of Solids II*); linear
//! between wavelengths and the nearest value outside them. Each was made a colour as a spectrum in a file is:
//! the colour of η and of k under D65, not clamped from above (`Role::Index`). A metal by its name and the same
//! measurements by `eta` and `k` then agree. The reflectance at normal incidence that Fresnel's equations give
//! for these colours is within .02 of the colour of the reflectance for every entry, where that is a
//! reflectance: gold's red is 1.04, outside what sRGB can show.

use nephroid::color::Rgb;

/// Name, η and k, in the order of the alphabet; the source stands above.
const METALS: [(&str, [f32; 3], [f32; 3]); 39] = [
    // Arakawa, Williams and Inagaki 1977, arc-evaporated.
    ("a-C", [2.4535, 2.3468, 2.1704], [0.7287, 0.8434, 0.8949]),
    // Johnson and Christy 1972.
    ("Ag", [0.0555, 0.0547, 0.043], [4.3651, 3.5293, 2.5671]),
    // Rakić 1995.
    ("Al", [1.4811, 0.982, 0.598], [7.6515, 6.549, 5.3462]),
    // Rakić and Majewski 1996.
    ("AlAs", [3.1094, 3.2415, 3.5488], [0.0012, 0.0024, 0.0216]),
    // Djurišić et al. 2000.
    ("AlSb", [3.8641, 4.2934, 4.9606], [0.0472, 0.1622, 1.2389]),
    // Olmon et al. 2012, evaporated.
    ("Au", [0.0662, 0.3782, 1.5279], [3.693, 2.3332, 1.7318]),
    // Rakić et al. 1998, Brendel-Bormann.
    ("Be", [3.4215, 3.3033, 3.0551], [3.1835, 3.1313, 3.1248]),
    // Johnson and Christy 1974.
    ("Cr", [3.2512, 3.1069, 2.279], [3.289, 3.3374, 3.1238]),
    // Li 1976.
    ("CsI", [1.7789, 1.7955, 1.8269], [0.0, 0.0, 0.0]),
    // Johnson and Christy 1972.
    ("Cu", [0.174, 1.0434, 1.2899], [3.2826, 2.5994, 2.3663]),
    // Palik 1991.
    ("Cu2O", [2.939, 3.1096, 3.0333], [0.0809, 0.2084, 0.6487]),
    // Palik 1991.
    ("CuO", [2.7033, 2.5807, 2.4364], [0.4195, 0.6024, 0.7878]),
    // Phillip and Taft 1964.
    ("d-C", [2.4098, 2.4229, 2.4411], [0.0, 0.0, 0.0]),
    // Inagaki, Arakawa and Williams 1981, liquid.
    ("Hg", [2.0282, 1.5153, 1.016], [5.3039, 4.6037, 3.7905]),
    // Palik 1991.
    ("HgTe", [4.0097, 3.4032, 2.9503], [1.3473, 1.662, 1.8968]),
    // Schmitt et al. 2022, sputtered.
    ("Ir", [3.0632, 2.5935, 2.1398], [5.6205, 5.0726, 4.3267]),
    // Smith 1969.
    ("K", [0.0538, 0.0489, 0.0418], [1.7694, 1.4222, 1.0181]),
    // Rasigni and Rasigni 1977.
    ("Li", [0.2207, 0.2059, 0.242], [2.9785, 2.4332, 1.8539]),
    // Stephens and Malitson 1952.
    ("MgO", [1.7338, 1.7409, 1.7534], [0.0, 0.0, 0.0]),
    // Kirillova, Nomerovannaya and Noskov 1971.
    ("Mo", [3.4723, 3.3563, 2.796], [3.5292, 3.6521, 3.5282]),
    // Smith 1969.
    ("Na", [0.0489, 0.059, 0.0682], [2.6679, 2.2275, 1.7514]),
    // Weaver, Lynch and Olson 1973.
    ("Nb", [2.911, 2.9094, 2.6205], [2.8306, 2.8863, 2.8115]),
    // Johnson and Christy 1974.
    ("Ni", [2.0224, 1.9011, 1.7242], [4.173, 3.5643, 2.8852]),
    // Weaver, Olson and Lynch 1977.
    ("Rh", [2.1597, 1.96, 1.7222], [5.6807, 4.9553, 4.3896]),
    // Palik 1991, trigonal, ordinary ray.
    ("Se", [3.4224, 2.9947, 3.0946], [0.6363, 0.6692, 0.5695]),
    // Palik 1991, trigonal, extraordinary ray.
    ("Se-e", [4.818, 4.3859, 4.4893], [0.7037, 1.1652, 1.6869]),
    // Wang et al. 2013, 6H, ordinary ray.
    ("SiC", [2.6306, 2.6637, 2.7211], [0.0, 0.0, 0.0]),
    // Palik 1991; Weaver, Lynch and Olson 1974.
    ("Ta", [1.6545, 2.5257, 2.8819], [1.9942, 1.8429, 2.132]),
    // Guo et al. 2022, thin crystals, ordinary ray.
    ("Te", [2.7809, 1.8516, 1.2053], [3.2002, 2.9682, 2.4049]),
    // Guo et al. 2022, thin crystals, extraordinary ray.
    ("Te-e", [2.2837, 1.5334, 0.9976], [3.9897, 3.4798, 2.8215]),
    // Heitmann and Ritter 1968.
    ("ThF4", [1.5102, 1.5146, 1.5226], [0.0, 0.0, 0.0]),
    // Pflüger et al. 1984.
    ("TiC", [3.0767, 2.9917, 2.8455], [2.7285, 2.4789, 2.3906]),
    // Pflüger et al. 1984.
    ("TiN", [1.3776, 1.2149, 1.5033], [2.857, 2.0433, 1.2372]),
    // Devore 1951, rutile, extraordinary ray: the tables of Mitsuba and pbrt have its rays the wrong way round, and what
    // files mean by a name is what these renderers show.
    ("TiO2", [2.8579, 2.9583, 3.179], [0.0, 0.0, 0.0]),
    // Devore 1951, rutile, ordinary ray.
    ("TiO2-e", [2.5726, 2.6524, 2.8246], [0.0, 0.0, 0.0]),
    // Johnson and Christy 1974.
    ("V", [3.4764, 3.9583, 3.616], [2.9728, 3.0825, 3.4716]),
    // Pflüger et al. 1984.
    ("VC", [3.0459, 2.9022, 2.7887], [2.5649, 2.3173, 2.1628]),
    // Pflüger et al. 1984.
    ("VN", [2.3892, 2.2342, 2.136], [2.5458, 2.1653, 1.7893]),
    // Weaver, Olson and Lynch 1975.
    ("W", [3.6349, 3.4935, 3.3122], [2.9229, 2.7468, 2.5043]),
];

/// Names of Mitsuba's for which no measurement of the visible range could be found.
const UNMEASURED: [&str; 1] = ["SnTe"];

/// What is known of a metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Known {
    /// η and k.
    Index(Rgb, Rgb),
    /// Its name alone.
    Name,
}

/// A metal by its name, whatever the case, and with or without the `_palik` that Mitsuba adds to
/// tell one measurement from another.
pub(crate) fn metal(name: &str) -> Option<Known> {
    let lower = name.to_ascii_lowercase();
    let plain = lower.strip_suffix("_palik").unwrap_or(&lower);
    let is = |known: &str| known.eq_ignore_ascii_case(plain);
    match METALS.iter().find(|(known, _, _)| is(known)) {
        Some((_, eta, k)) => Some(Known::Index(Rgb::from(*eta), Rgb::from(*k))),
        None => UNMEASURED.iter().any(|known| is(known)).then_some(Known::Name),
    }
}

/// Every name, for proposals.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    METALS.iter().map(|(name, _, _)| *name).chain(UNMEASURED).chain(["none"])
}

#[cfg(test)]
mod tests {
    use nephroid::material::fresnel_conductor;

    use super::super::spectrum::{Role, Spectrum};
    use super::*;

    fn index(name: &str) -> (Rgb, Rgb) {
        match metal(name) {
            Some(Known::Index(eta, k)) => (eta, k),
            other => panic!("{name}: {other:?}"),
        }
    }

    fn reflectance(name: &str) -> Rgb {
        let (eta, k) = index(name);
        fresnel_conductor(1.0, eta, k)
    }

    fn near(name: &str, found: Rgb, expected: [f32; 3], tolerance: f32) {
        let off = found.zip(Rgb::from(expected), |a, b| (a - b).abs()).max_channel();
        assert!(off <= tolerance, "{name}: {found:?} is not {expected:?}");
    }

    /// Nothing but copper's η and k as Johnson and Christy (1972, table I) measured them: the table must
    /// be what the reader of spectra makes of them.
    #[test]
    fn copper_is_the_colour_of_its_measurements() {
        let copper = [
            (354.2, 1.37, 1.916),
            (367.9, 1.36, 1.975),
            (381.5, 1.33, 2.045),
            (397.4, 1.32, 2.116),
            (413.3, 1.28, 2.207),
            (430.5, 1.25, 2.305),
            (450.9, 1.24, 2.397),
            (471.4, 1.25, 2.483),
            (495.9, 1.22, 2.564),
            (520.9, 1.18, 2.608),
            (548.6, 1.02, 2.577),
            (582.1, 0.70, 2.704),
            (616.8, 0.30, 3.205),
            (659.5, 0.22, 3.747),
            (704.5, 0.21, 4.205),
            (756.0, 0.24, 4.665),
            (821.1, 0.26, 5.180),
            (892.0, 0.30, 5.768),
        ];
        let colour = |value: fn(&(f64, f64, f64)) -> f64| {
            let pairs: Vec<_> = copper.iter().map(|row| format!("{}:{}", row.0, value(row))).collect();
            Spectrum::parse(&pairs.join(" ")).unwrap().to_rgb(Role::Index).to_array()
        };
        let (eta, k) = index("Cu");
        near("eta", eta, colour(|row| row.1), 2e-4);
        near("k", k, colour(|row| row.2), 2e-4);
    }

    /// Published reflectances in linear RGB at normal incidence (Hoffman 2010, *Background: Physically-Based
    /// Shading*, table 1, clamped at one). They come from other measurements, which differ by so much:
    /// silver's blue by .1, all else by .08.
    #[test]
    fn well_known_metals_reflect_what_is_published() {
        for (name, published, tolerance) in [
            ("Au", [1.0, 0.71, 0.29], 0.085),
            ("Ag", [0.95, 0.93, 0.88], 0.1),
            ("Cu", [0.95, 0.64, 0.54], 0.03),
            ("Al", [0.91, 0.92, 0.92], 0.01),
        ] {
            near(name, reflectance(name), published, tolerance);
        }
    }

    /// Reflectances at normal incidence of single measurements near the middle of the green: tantalum 2.3 eV (Weaver, Lynch
    /// and Olson 1974, 0.36), trigonal selenium at 563.5 nm and copper oxides at 549.8 nm (Palik 1991). Colours are
    /// means over the green, and so are within .02 of them.
    #[test]
    fn green_is_what_tables_have_near_the_middle_of_it() {
        for (name, n, k) in [
            ("Ta", 2.56, 1.86),
            ("Se", 3.07, 0.73),
            ("Se-e", 4.49, 1.19),
            ("Cu2O", 3.10, 0.19),
            ("CuO", 2.58, 0.59),
            ("HgTe", 3.364, 1.649),
        ] {
            let expected = fresnel_conductor(1.0, Rgb::splat(n), Rgb::splat(k)).g;
            let found = reflectance(name).g;
            assert!((found - expected).abs() < 0.02, "{name}: {found} is not {expected}");
        }
    }

    /// n² = a + b/(λ² − c) of rutile for λ in µm (Devore 1951): at 589 nm 2.61 for the ordinary ray and 2.91 for the other.
    #[test]
    fn rutile_is_what_renderers_mean_by_its_names() {
        let at_d = |a: f64, b: f64, c: f64| (a + b / (0.5893 * 0.5893 - c)).sqrt() as f32;
        let [ordinary, extraordinary] = [at_d(5.913, 0.2441, 0.0803), at_d(7.197, 0.3322, 0.0843)];
        for (name, n) in [("TiO2", extraordinary), ("TiO2-e", ordinary)] {
            let Rgb { r, g, .. } = index(name).0;
            assert!(r < n && n < g && g - r < 0.11, "{name}: {n} is not between {r} and {g}");
        }
    }

    #[test]
    fn metals_have_their_colours() {
        let Rgb { r, g, b } = reflectance("Au");
        assert!(r > 0.95 && (0.7..0.85).contains(&g) && b < 0.4, "gold is yellow: {r} {g} {b}");
        let Rgb { r, g, b } = reflectance("Cu");
        assert!(r > 1.4 * g && g > b, "copper is red: {r} {g} {b}");
        for (name, least) in [("Ag", 0.97), ("Al", 0.9), ("Hg", 0.77), ("Cr", 0.54)] {
            let r = reflectance(name);
            assert!(
                r.min_channel() > least && r.max_channel() - r.min_channel() < 0.02,
                "{name} is grey: {r:?}"
            );
        }
    }

    #[test]
    fn every_metal_reflects_some_and_never_all() {
        for (name, eta, k) in METALS {
            let r = fresnel_conductor(1.0, Rgb::from(eta), Rgb::from(k));
            assert!(r.min_channel() > 0.03 && r.max_channel() < 0.995, "{name}: {r:?}");
        }
    }

    #[test]
    fn names_with_and_without_a_suffix() {
        assert_eq!(metal("na_palik"), metal("Na"));
        assert_eq!(metal("d-C_PALIK"), metal("d-C"));
        assert_eq!((metal("SnTe"), metal("SnTe_palik")), (Some(Known::Name), Some(Known::Name)));
        assert_eq!((metal("unobtainium"), metal("none"), metal("")), (None, None, None));
    }
}
