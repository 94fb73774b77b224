use std::f32::consts::{FRAC_1_PI, PI};

use super::fresnel::mirror;
use super::kind::Classes;
use super::roughness::Distribution;
use crate::math::{Vec2, Vec3, real, warp};

/// α below which a highlight is too narrow for photons.
pub(super) const SHARP: f32 = 0.1;

/// α below which single precision does not tell facets apart.
const SMOOTHEST: f32 = 1e-4;

/// A boundary of tiny mirrors (Walter et al. 2007, *Microfacet Models for Refraction through Rough Surfaces*; Heitz 2014,
/// *Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs*, JCGT 3(2)).
///
/// Directions are those of the shading frame, `wo` and facets' normals `m` above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacet {
    distribution: Distribution,
    alpha_u: f32,
    alpha_v: f32,
}

impl Microfacet {
    pub fn new(distribution: Distribution, alpha_u: f32, alpha_v: f32) -> Self {
        let within = |alpha: f32| if alpha > SMOOTHEST { alpha.min(1.0) } else { SMOOTHEST };
        Self { distribution, alpha_u: within(alpha_u), alpha_v: within(alpha_v) }
    }

    pub fn distribution(&self) -> Distribution {
        self.distribution
    }

    /// One α for what is tabulated of surfaces that have one.
    pub fn mean_alpha(&self) -> f32 {
        if self.alpha_u == self.alpha_v { self.alpha_u } else { (self.alpha_u * self.alpha_v).sqrt() }
    }

    /// Both α, and what they become if they are changed alike.
    pub fn with_alphas(self, f: impl Fn(f32) -> f32) -> Self {
        Self::new(self.distribution, f(self.alpha_u), f(self.alpha_v))
    }

    /// The class of the lobes that it makes.
    pub fn class(&self) -> Classes {
        if self.alpha_u < SHARP && self.alpha_v < SHARP { Classes::SHARP } else { Classes::GLOSSY }
    }

    /// D: area of facets for each unit of the surface's area and of solid angle of their normal.
    #[inline]
    pub fn density(&self, m: Vec3) -> f32 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let Self { alpha_u, alpha_v, .. } = *self;
        let (x, y, z_sq) = (m.x / alpha_u, m.y / alpha_v, m.z * m.z);
        match self.distribution {
            Distribution::Ggx => {
                let stretched = x * x + y * y + z_sq;
                FRAC_1_PI / (alpha_u * alpha_v * stretched * stretched)
            }
            Distribution::Beckmann => {
                real::exp(-(x * x + y * y) / z_sq) * FRAC_1_PI / (alpha_u * alpha_v * z_sq * z_sq)
            }
        }
    }

    /// Λ of Smith (Heitz 2014, equations 68 and 72), for a direction on either side.
    #[inline]
    fn lambda(&self, w: Vec3) -> f32 {
        let (x, y) = (self.alpha_u * w.x, self.alpha_v * w.y);
        let slope_sq = (x * x + y * y) / (w.z * w.z);
        match self.distribution {
            // (√(1 + s²) − 1)/2 without a difference of like numbers.
            Distribution::Ggx => 0.5 * slope_sq / (1.0 + (1.0 + slope_sq).sqrt()),
            Distribution::Beckmann => {
                let slope = slope_sq.sqrt();
                if slope < 0.25 {
                    // Below 1e-8.
                    return 0.0;
                }
                let a = 1.0 / slope;
                let tail = real::exp(-a * a) * slope / PI.sqrt();
                (0.5 * (tail - libm::erfcf(a))).max(0.0)
            }
        }
    }

    /// The share of facets seen from a direction among those that face it.
    #[inline]
    pub fn masking(&self, w: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// The share seen from both directions on one side, whose heights agree (Heitz 2014, equation 99).
    #[inline]
    pub fn masking_of_reflection(&self, wo: Vec3, wi: Vec3) -> f32 {
        1.0 / (1.0 + self.lambda(wo) + self.lambda(wi))
    }

    /// The same of directions on opposite sides, taken as independent.
    #[inline]
    pub fn masking_of_refraction(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.masking(wo) * self.masking(wi)
    }

    /// Draws a facet that `wo` sees, with the density D G₁ wo·m / wo.z per solid angle of `m`.
    #[inline]
    pub fn sample_visible(&self, wo: Vec3, u: Vec2) -> Vec3 {
        let Self { alpha_u, alpha_v, .. } = *self;
        let stretched = Vec3::new(alpha_u * wo.x, alpha_v * wo.y, wo.z).normalize();
        let m = match self.distribution {
            Distribution::Ggx => visible_ggx(stretched, u),
            Distribution::Beckmann => visible_beckmann(stretched, u),
        };
        Vec3::new(alpha_u * m.x, alpha_v * m.y, m.z.max(1e-7)).normalize()
    }

    /// D G / (4 cos cos): a reflection without Fresnel's share. Both directions are above.
    #[inline]
    pub fn reflection(&self, wo: Vec3, wi: Vec3, m: Vec3) -> f32 {
        self.density(m) * self.masking_of_reflection(wo, wi) / (4.0 * wo.z * wi.z)
    }

    /// Density per solid angle of [`sample_reflection`](Self::sample_reflection).
    #[inline]
    pub fn reflection_pdf(&self, wo: Vec3, m: Vec3) -> f32 {
        // 1/(4 wo·m) cancels with the cosine in the density of visible facets.
        if wo.dot(m) > 0.0 { self.density(m) * self.masking(wo) / (4.0 * wo.z) } else { 0.0 }
    }

    /// Reflects at a visible facet; the direction may be below.
    #[inline]
    pub fn sample_reflection(&self, wo: Vec3, u: Vec2) -> Vec3 {
        mirror(wo, self.sample_visible(wo, u))
    }
}

/// Visible facets for α = 1 (Heitz 2018, *Sampling the GGX Distribution of Visible Normals*, JCGT 7(4)): the projection of
/// a hemisphere.
fn visible_ggx(wo: Vec3, u: Vec2) -> Vec3 {
    let length_sq = wo.x * wo.x + wo.y * wo.y;
    let s = if length_sq > 0.0 { Vec3::new(-wo.y, wo.x, 0.0) / length_sq.sqrt() } else { Vec3::X };
    let t = wo.cross(s);
    let Vec2 { x, y } = warp::square_to_disk(u);
    let share = 0.5 * (1.0 + wo.z);
    let y = (1.0 - share) * (1.0 - x * x).max(0.0).sqrt() + share * y;
    x * s + y * t + (1.0 - x * x - y * y).max(0.0).sqrt() * wo
}

/// Visible facets for α = 1 (Heitz and d'Eon 2014, *Importance Sampling Microfacet-Based BSDFs using the Distribution of
/// Visible Normals*): the slope across is Gaussian, and that along is found by its distribution function.
fn visible_beckmann(wo: Vec3, u: Vec2) -> Vec3 {
    let sin = (wo.x * wo.x + wo.y * wo.y).sqrt();
    let (cos_phi, sin_phi) = if sin > 0.0 { (wo.x / sin, wo.y / sin) } else { (1.0, 0.0) };
    let along = slope(u.x, f64::from(wo.z.max(0.0)), f64::from(sin));
    let across = slope(u.y, 1.0, 0.0);
    Vec3::new(-(cos_phi * along - sin_phi * across), -(sin_phi * along + cos_phi * across), 1.0).normalize()
}

/// The slope x up to which a share u of the facets is, weighed by their projection cos − x sin towards the view:
/// F(x) = cos (1 + erf x)/2 + sin e^(−x²)/(2√π) up to x = cos/sin, where they turn away. Newton's steps, kept inside of
/// an interval that is halved.
fn slope(u: f32, cos: f64, sin: f64) -> f32 {
    const BEYOND: f64 = 6.0;
    let distribution = |x: f64| {
        0.5 * (cos * libm::erfc(-x) + sin * libm::exp(-x * x) * std::f64::consts::FRAC_2_SQRT_PI * 0.5)
    };
    let (mut low, mut high) = (-BEYOND, if cos < BEYOND * sin { cos / sin } else { BEYOND });
    let target = f64::from(u) * distribution(high);
    let mut x = 0.5 * (low + high);
    for _ in 0..40 {
        let error = distribution(x) - target;
        *(if error > 0.0 { &mut high } else { &mut low }) = x;
        let rise = (cos - x * sin) * libm::exp(-x * x) * std::f64::consts::FRAC_2_SQRT_PI * 0.5;
        let next = x - error / rise;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - x).abs() < 1e-9 {
            return next as f32;
        }
        x = next;
    }
    x as f32
}
