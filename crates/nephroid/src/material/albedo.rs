//! How much rough surfaces reflect altogether, from tables: what lobes below them are left with.

use super::albedo_tables::{OF_FACETS, OF_GRAZING, OF_SHEEN, Table};
use super::fresnel::fresnel_dielectric;

/// What microfacets reflect of light that comes with a cosine, if each reflects by Schlick's formula: `f0` times the
/// first plus `f90` times the second, to 0.003. For GGX of one α; Beckmann's facets reflect the same to 0.02.
#[inline]
pub(super) fn of_facets(cos: f32, alpha: f32) -> [f32; 2] {
    let place = Place::new(cos, alpha);
    let grazing = place.read(&OF_GRAZING);
    [place.read(&OF_FACETS) - grazing, grazing]
}

/// What Charlie's sheen of a white colour reflects, which may be more than arrives.
#[inline]
pub(super) fn of_sheen(cos: f32, alpha: f32) -> f32 {
    Place::new(cos, alpha).read(&OF_SHEEN)
}

/// What a dielectric coat reflects and lets in, light that meets several facets included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// Index of refraction inside relative to outside, at least 1.
    pub eta: f32,
    /// α, or 0 for a smooth one.
    pub alpha: f32,
    /// What stands for f0 and f90 in Schlick's formula.
    schlick: [f32; 2],
}

impl Coat {
    pub fn new(eta: f32, alpha: f32) -> Self {
        let f0 = fresnel_dielectric(1.0, eta);
        // Schlick's mean is f0 + (f90 − f0)/21; this one has the mean of Fresnel's formulae.
        let f90 = f0 + 21.0 * (mean_reflectance(eta) - f0);
        Self { eta, alpha, schlick: [f0, f90] }
    }

    /// The share reflected outside, over all facets.
    #[inline]
    pub fn reflected(&self, cos: f32) -> f32 {
        if self.alpha == 0.0 {
            return fresnel_dielectric(cos, self.eta);
        }
        let [a, b] = of_facets(cos, self.alpha);
        (self.schlick[0] * a + self.schlick[1] * b).min(1.0)
    }

    /// The share that comes in.
    #[inline]
    pub fn passed(&self, cos: f32) -> f32 {
        1.0 - self.reflected(cos)
    }
}

/// What is reflected of light that comes evenly from inside, if this much is outside: what comes in from an even
/// surrounding is what goes out, 1 − R = (1 − R')/η².
pub(super) fn mean_inside(outside: f32, eta: f32) -> f32 {
    1.0 - (1.0 - outside) / (eta * eta)
}

/// Fresnel's reflectance of a dielectric of index n ≥ 1, averaged over all directions weighed by their cosine (Walsh
/// 1926; Judd 1942, *Fresnel Reflection of Diffusely Incident Light*, J. Res. NBS 29).
pub(super) fn mean_reflectance(n: f32) -> f32 {
    let n = f64::from(n);
    // Near one the terms cancel; the series begins with the difference alone.
    if n < 1.001 {
        return ((n - 1.0) / 3.0) as f32;
    }
    let (n2, n4) = (n * n, n * n * n * n);
    let (plus, minus) = (n2 + 1.0, n2 - 1.0);
    let mean = 0.5
        + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0) * (n + 1.0))
        + n2 * minus * minus / (plus * plus * plus) * libm::log((n - 1.0) / (n + 1.0))
        - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / (plus * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / (plus * (n4 - 1.0) * (n4 - 1.0)) * libm::log(n);
    mean as f32
}

/// Where a table is read.
struct Place {
    row: usize,
    column: usize,
    down: f32,
    right: f32,
}

impl Place {
    #[inline]
    fn new(cos: f32, alpha: f32) -> Self {
        let part = |x: f32| {
            let x = x.clamp(0.0, 1.0).sqrt() * 15.0;
            let cell = (x as usize).min(14);
            (cell, x - cell as f32)
        };
        let ((row, down), (column, right)) = (part(alpha), part(cos));
        Self { row, column, down, right }
    }

    #[inline]
    fn read(&self, table: &Table) -> f32 {
        let across =
            |row: &[f32; 16]| row[self.column] + self.right * (row[self.column + 1] - row[self.column]);
        let (above, below) = (across(&table[self.row]), across(&table[self.row + 1]));
        above + self.down * (below - above)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::material::charlie::Charlie;
    use crate::material::microfacet::Microfacet;
    use crate::material::roughness::Distribution;
    use crate::math::{Vec2, Vec3, real, warp};

    const STEPS: usize = 300;

    /// The mean over the unit square by the midpoint rule.
    fn mean(f: impl Fn(Vec2) -> f32) -> f32 {
        let u = |i: usize| Vec2::new((i % STEPS) as f32 + 0.5, (i / STEPS) as f32 + 0.5) / STEPS as f32;
        (0..STEPS * STEPS).map(|i| f64::from(f(u(i)))).sum::<f64>() as f32 / (STEPS * STEPS) as f32
    }

    fn slanted(cos: f32) -> Vec3 {
        Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)
    }

    #[test]
    fn the_tables_of_facets_are_integrals() {
        for (alpha, cos) in [(0.02, 0.5), (0.1, 0.3), (0.25, 1.0), (0.4, 0.1), (0.7, 0.6), (1.0, 0.9)] {
            let (facets, wo) = (Microfacet::new(Distribution::Ggx, alpha, alpha), slanted(cos));
            let of = |f0: f32, f90: f32| {
                mean(|u| {
                    let m = facets.sample_visible(wo, u);
                    let wi = crate::material::fresnel::mirror(wo, m);
                    if wi.z <= 0.0 {
                        return 0.0;
                    }
                    let weight = facets.reflection(wo, wi, m) * wi.z / facets.reflection_pdf(wo, m);
                    weight * (f0 + (f90 - f0) * real::pow(1.0 - wo.dot(m), 5.0))
                })
            };
            let [a, b] = of_facets(cos, alpha);
            assert!((a - of(1.0, 0.0)).abs() < 5e-3, "{alpha} {cos}: {a} {}", of(1.0, 0.0));
            assert!((b - of(0.0, 1.0)).abs() < 5e-3, "{alpha} {cos}: {b} {}", of(0.0, 1.0));
        }
    }

    #[test]
    fn the_table_of_sheen_is_an_integral() {
        for (roughness, cos) in [(0.4f32, 0.3f32), (0.6, 0.7), (0.8, 0.15), (1.0, 0.5)] {
            let (wo, sheen) = (slanted(cos), Charlie::new(Rgb::splat(0.3), roughness));
            let albedo = mean(|u| {
                let wi = warp::square_to_cosine_hemisphere(u);
                sheen.eval(wo, wi).g * std::f32::consts::PI
            });
            let table = 0.3 * of_sheen(cos, roughness * roughness);
            assert!((albedo - table).abs() < 0.03 * table + 1e-3, "{roughness} {cos}: {albedo} {table}");
        }
    }

    /// The integral of Fresnel's formulae.
    #[test]
    fn mean_reflectances_are_integrals() {
        for n in [1.0005f32, 1.1, 1.33, 1.5, 2.5] {
            let steps = 4000;
            let at = |i: usize| {
                let cos = (i as f32 + 0.5) / steps as f32;
                f64::from(2.0 * cos * fresnel_dielectric(cos, n))
            };
            let expected = (0..steps).map(at).sum::<f64>() / steps as f64;
            assert!((f64::from(mean_reflectance(n)) - expected).abs() < 3e-4, "{n}: {expected}");
        }
        assert!((mean_reflectance(1.5) - 0.0918).abs() < 1e-4);
    }
}
