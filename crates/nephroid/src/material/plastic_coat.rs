//! What comes through the coat of plastics.

use super::Distribution;
use super::albedo::{mean_inside, mean_reflectance};
use super::fresnel::fresnel_dielectric;
use super::plastic_tables::{
    INDICES, INSIDE_OF_BECKMANN, INSIDE_OF_GGX, Inside, PASSED_BY_BECKMANN, PASSED_BY_GGX, Passed,
};

/// The coat of a plastic: Fresnel's formulae where it is smooth. Where it is rough, the means over the facets that are
/// seen, (1 − F) G₁ of the refracted direction and F G₁ of the reflected one, as Mitsuba's `roughplastic` has them: light
/// that meets a second facet is lost, a few per cent at α = 0.1 and half of all at 0.8. The tables were worked out for
/// five indices from 1.1 to 2.4, beyond which they are taken to be the same, and are right to 0.03, mostly to 0.002.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticCoat {
    pub eta: f32,
    /// Of a rough one.
    rough: Option<(Distribution, f32)>,
}

impl PlasticCoat {
    pub fn new(eta: f32, rough: Option<(Distribution, f32)>) -> Self {
        Self { eta, rough }
    }

    /// The share of light with a cosine that comes in.
    #[inline]
    pub fn passed(&self, cos: f32) -> f32 {
        let Some((distribution, alpha)) = self.rough else { return 1.0 - fresnel_dielectric(cos, self.eta) };
        let table: &Passed = match distribution {
            Distribution::Ggx => &PASSED_BY_GGX,
            Distribution::Beckmann => &PASSED_BY_BECKMANN,
        };
        let (index, row, column) = (self.index(), place(alpha, 9), place(cos, 15));
        between(index, |i| between(row, |j| between(column, |k| table[i][j][k])))
    }

    /// The share of light from everywhere inside that is reflected back.
    pub fn inside(&self) -> f32 {
        let Some((distribution, alpha)) = self.rough else {
            return mean_inside(mean_reflectance(self.eta), self.eta);
        };
        let table: &Inside = match distribution {
            Distribution::Ggx => &INSIDE_OF_GGX,
            Distribution::Beckmann => &INSIDE_OF_BECKMANN,
        };
        let (index, row) = (self.index(), place(alpha, 9));
        between(index, |i| between(row, |j| table[i][j]))
    }

    /// The two indices of the table about that of the coat, as a cell and the way across it.
    #[inline]
    fn index(&self) -> (usize, f32) {
        let eta = self.eta.clamp(INDICES[0], INDICES[4]);
        let cell = (0..3).find(|&i| eta < INDICES[i + 1]).unwrap_or(3);
        (cell, (eta - INDICES[cell]) / (INDICES[cell + 1] - INDICES[cell]))
    }
}

/// The cell of the root of a number in [0, 1], and the way across it.
#[inline]
fn place(x: f32, cells: usize) -> (usize, f32) {
    let x = x.clamp(0.0, 1.0).sqrt() * cells as f32;
    let cell = (x as usize).min(cells - 1);
    (cell, x - cell as f32)
}

#[inline]
fn between((cell, way): (usize, f32), at: impl Fn(usize) -> f32) -> f32 {
    let (below, above) = (at(cell), at(cell + 1));
    below + way * (above - below)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::fresnel::refracted_cosine;
    use crate::material::microfacet::Microfacet;
    use crate::material::rough_dielectric::refract_at;
    use crate::math::{Vec2, Vec3};

    /// The mean over the facets seen, by the midpoint rule on the square that they are drawn from.
    fn passed(distribution: Distribution, alpha: f32, eta: f32, cos: f32) -> f32 {
        const STEPS: usize = 80;
        let facets = Microfacet::new(distribution, alpha, alpha);
        let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        let mut sum = 0.0;
        for i in 0..STEPS * STEPS {
            let u = Vec2::new((i % STEPS) as f32 + 0.5, (i / STEPS) as f32 + 0.5) / STEPS as f32;
            let m = facets.sample_visible(wo, u);
            let Some(wi) = refract_at(wo, m, eta).filter(|wi| wi.z < 0.0) else { continue };
            assert!(refracted_cosine(wo.dot(m).min(1.0), eta).is_some());
            sum += (1.0 - fresnel_dielectric(wo.dot(m), eta)) * facets.masking(wi);
        }
        sum / (STEPS * STEPS) as f32
    }

    #[test]
    fn the_tables_are_means_over_facets() {
        for distribution in [Distribution::Ggx, Distribution::Beckmann] {
            for (alpha, eta) in [(0.05, 1.5), (0.1, 1.3), (0.25, 1.9), (0.5, 1.5), (1.0, 1.5), (0.7, 1.2)] {
                let coat = PlasticCoat::new(eta, Some((distribution, alpha)));
                for cos in [0.1, 0.3, 0.6, 1.0] {
                    let (table, exact) = (coat.passed(cos), passed(distribution, alpha, eta, cos));
                    assert!(
                        (table - exact).abs() < 0.03,
                        "{distribution:?} {alpha} {eta} {cos}: {table} {exact}"
                    );
                }
            }
        }
    }

    /// What passes inwards of an even surrounding passes outwards, and what is reflected inside is not more than the rest.
    #[test]
    fn inside_and_outside_agree() {
        for distribution in [Distribution::Ggx, Distribution::Beckmann] {
            for (alpha, eta) in [(0.001, 1.5), (0.1, 1.3), (0.3, 1.5), (1.0, 2.4)] {
                let coat = PlasticCoat::new(eta, Some((distribution, alpha)));
                const STEPS: usize = 200;
                let at = |i: usize| coat.passed((i as f32 + 0.5) / STEPS as f32) * (2 * i + 1) as f32;
                let outwards = (0..STEPS).map(at).sum::<f32>() / (STEPS * STEPS) as f32 / (eta * eta);
                assert!(coat.inside() < 1.002 - outwards, "{alpha} {eta}: {} {outwards}", coat.inside());
                assert!(alpha > 0.01 || (coat.inside() + outwards - 1.0).abs() < 1.5e-2);
            }
        }
    }

    #[test]
    fn little_roughness_is_none() {
        let (smooth, rough) =
            (PlasticCoat::new(1.5, None), PlasticCoat::new(1.5, Some((Distribution::Ggx, 1e-3))));
        assert!((smooth.inside() - 0.5963).abs() < 1e-3, "{}", smooth.inside());
        assert!((smooth.inside() - rough.inside()).abs() < 1e-2);
        for cos in [0.2, 0.5, 1.0] {
            assert!((smooth.passed(cos) - rough.passed(cos)).abs() < 5e-3);
        }
    }
}
