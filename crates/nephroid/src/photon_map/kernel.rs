use std::f32::consts::PI;
use std::fmt;

use crate::math::real::{exp, pow};

/// Falloff of [`Kernel::Gaussian`] (Pavicic 1990, *Convenient Anti-Aliasing Filters*, Graphics Gems).
const BETA: f32 = 1.953;

/// How a photon's power is spread over the ball of radius r around it.
///
/// A kernel is a shape w(t²) of t = d/r in [0, 1], see [`Self::shape`], and a norm for 1, 2 and 3
/// dimensions. [`Self::weight_1d`], [`Self::weight_2d`] and [`Self::weight_3d`] join the two: they
/// integrate to one over the segment of length 2r, the disc of area πr² and the ball of volume
/// 4/3 πr³, and vanish outside. The one exception is [`Self::ReportGaussian`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kernel {
    /// Constant: w = 1.
    Box,
    /// w = 1 − t/k (Jensen 1996, *Global Illumination using Photon Maps*).
    Cone {
        /// Slope k ≥ 1: the cone reaches zero at k r. Anything below 1 counts as 1.
        k: f32,
    },
    /// w = 1 − (1 − e^(−βt²/2)) / (1 − e^(−β)), β = 1.953: Pavicic's pixel filter, which does not
    /// reach zero at t = 1 but .27, with norms that make it integrate to one.
    Gaussian,
    /// w = 1 − t²: the least error at its own best radius.
    Epanechnikov,
    /// w = (1 − t²)²: the smoothest.
    Biweight,
    /// [`Self::Gaussian`] with the factor .918 of Pavicic's filter for its norm, as published for
    /// photon maps by Jensen in 1996 and in the report of 2019. **It is not normalised**: over the
    /// disc it integrates to .53115, so pictures made with it are too dark by 46.9 % (Garcia et al.
    /// 2014). It serves comparisons alone. Called `jensen-1996`.
    ReportGaussian,
}

impl Kernel {
    /// What [`Self::parse`] understands; `cone` may be followed by its slope, as in `cone:1.5`.
    pub const NAMES: [&str; 6] = ["box", "cone", "gaussian", "epanechnikov", "biweight", "jensen-1996"];

    /// The kernel of a name; `None` if there is none, or if the slope of a cone is below 1 or not
    /// finite. Reads back what `Display` writes.
    pub fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "box" => Self::Box,
            "cone" => Self::Cone { k: 1.0 },
            "gaussian" => Self::Gaussian,
            "epanechnikov" => Self::Epanechnikov,
            "biweight" => Self::Biweight,
            "jensen-1996" => Self::ReportGaussian,
            _ => {
                let k: f32 = name.strip_prefix("cone:")?.parse().ok()?;
                (k >= 1.0 && k.is_finite()).then_some(Self::Cone { k })?
            }
        })
    }

    /// Its name, without the slope of a cone.
    pub fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Cone { .. } => "cone",
            Self::Gaussian => "gaussian",
            Self::Epanechnikov => "epanechnikov",
            Self::Biweight => "biweight",
            Self::ReportGaussian => "jensen-1996",
        }
    }

    /// The shape w at t² = (d/r)², for t in [0, 1]; one at the centre, without unit.
    #[inline]
    pub fn shape(self, t_sq: f32) -> f32 {
        match self {
            Self::Box => 1.0,
            Self::Cone { k } => 1.0 - t_sq.sqrt() / k.max(1.0),
            Self::Gaussian | Self::ReportGaussian => {
                const ONE_MINUS_EXP_BETA: f32 = 0.858_152_1;
                1.0 - (1.0 - exp(-0.5 * BETA * t_sq)) / ONE_MINUS_EXP_BETA
            }
            Self::Epanechnikov => 1.0 - t_sq,
            Self::Biweight => (1.0 - t_sq) * (1.0 - t_sq),
        }
    }

    /// What the shape is multiplied by, beside 1/(2r), in one dimension (beams of photons).
    #[inline]
    pub fn norm_1d(self) -> f32 {
        match self {
            Self::Box => 1.0,
            Self::Cone { k } => 1.0 / (1.0 - 1.0 / (2.0 * k.max(1.0))),
            Self::Gaussian => 1.408_060_9,
            Self::Epanechnikov => 1.5,
            Self::Biweight => 15.0 / 8.0,
            Self::ReportGaussian => 0.918,
        }
    }

    /// What the shape is multiplied by, beside 1/(πr²), in two dimensions (photons on surfaces).
    #[inline]
    pub fn norm_2d(self) -> f32 {
        match self {
            Self::Box => 1.0,
            Self::Cone { k } => 1.0 / (1.0 - 2.0 / (3.0 * k.max(1.0))),
            Self::Gaussian => 1.728_309_3,
            Self::Epanechnikov => 2.0,
            Self::Biweight => 3.0,
            Self::ReportGaussian => 0.918,
        }
    }

    /// What the shape is multiplied by, beside 1/(4/3 πr³), in three dimensions (photons in media).
    #[inline]
    pub fn norm_3d(self) -> f32 {
        match self {
            Self::Box => 1.0,
            Self::Cone { k } => 1.0 / (1.0 - 3.0 / (4.0 * k.max(1.0))),
            Self::Gaussian => 1.978_705_5,
            Self::Epanechnikov => 2.5,
            Self::Biweight => 35.0 / 8.0,
            Self::ReportGaussian => 0.918,
        }
    }

    /// Weight in 1/m of a photon at a squared distance `d_sq` along a line, for the squared radius
    /// `r_sq` > 0; zero beyond it.
    #[inline]
    pub fn weight_1d(self, d_sq: f32, r_sq: f32) -> f32 {
        if d_sq > r_sq {
            return 0.0;
        }
        self.norm_1d() * self.shape(d_sq / r_sq) / (2.0 * r_sq.sqrt())
    }

    /// Weight in 1/m² of a photon at a squared distance `d_sq` on a surface, for the squared radius
    /// `r_sq` > 0; zero beyond it.
    #[inline]
    pub fn weight_2d(self, d_sq: f32, r_sq: f32) -> f32 {
        if d_sq > r_sq {
            return 0.0;
        }
        self.norm_2d() * self.shape(d_sq / r_sq) / (PI * r_sq)
    }

    /// Weight in 1/m³ of a photon at a squared distance `d_sq` in space, for the squared radius
    /// `r_sq` > 0; zero beyond it.
    #[inline]
    pub fn weight_3d(self, d_sq: f32, r_sq: f32) -> f32 {
        if d_sq > r_sq {
            return 0.0;
        }
        self.norm_3d() * self.shape(d_sq / r_sq) / (4.0 / 3.0 * PI * r_sq * r_sq.sqrt())
    }

    /// How many times as many photons as the box this kernel should gather on a surface, so that
    /// both are at their best (equivalently: the ratio of the squared radii).
    ///
    /// At equal radius a kernel that falls off uses fewer photons and looks noisier; that compares
    /// bandwidths, not kernels. The radius of the least asymptotic mean integrated squared error in
    /// two dimensions has h⁶ ∝ R/μ² with R = ∫K² and μ = ∫x²K (Wand and Jones 1995, *Kernel
    /// Smoothing*, ch. 4): so the factor is ((R/R₀) (μ₀/μ)²)^(1/3), zeros denoting the box. That is 1
    /// for the box, 1.21 for the Gaussian, 1.44 for Epanechnikov's, 1.61 for the cone of slope 1 and
    /// 1.93 for the biweight.
    pub fn equal_bandwidth_factor(self) -> f32 {
        match self {
            Self::Box => 1.0,
            Self::Cone { k } => {
                let k = k.max(1.0);
                let mean = 1.0 - 2.0 / (3.0 * k);
                let roughness = (1.0 - 4.0 / (3.0 * k) + 1.0 / (2.0 * k * k)) / (mean * mean);
                let spread = (1.0 - 4.0 / (5.0 * k)) / mean;
                pow(roughness / (spread * spread), 1.0 / 3.0)
            }
            Self::Gaussian | Self::ReportGaussian => 1.214_473_1,
            // The cube roots of 3 and of 7.2.
            Self::Epanechnikov => 1.442_249_6,
            Self::Biweight => 1.930_978_8,
        }
    }
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cone { k } if *k > 1.0 => write!(f, "cone:{k}"),
            _ => f.write_str(self.name()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KERNELS: [Kernel; 7] = [
        Kernel::Box,
        Kernel::Cone { k: 1.0 },
        Kernel::Cone { k: 1.1 },
        Kernel::Cone { k: 2.0 },
        Kernel::Gaussian,
        Kernel::Epanechnikov,
        Kernel::Biweight,
    ];

    /// Simpson's rule on [0, 1] with 1000 intervals.
    fn integral(f: impl Fn(f64) -> f64) -> f64 {
        let n = 1000;
        let weight = |i| if i == 0 || i == n { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
        (0..=n).map(|i| weight(i) * f(f64::from(i) / f64::from(n))).sum::<f64>() / (3.0 * f64::from(n))
    }

    /// The integral over the ball of radius `r` of a weight, from the measure of its shells.
    fn over_ball(weight: fn(Kernel, f32, f32) -> f32, kernel: Kernel, dimension: i32, r: f64) -> f64 {
        let pi = std::f64::consts::PI;
        let shell = [2.0, 2.0 * pi, 4.0 * pi][dimension as usize - 1];
        let r_sq = (r * r) as f32;
        let density = |t: f64| f64::from(weight(kernel, (t * t) as f32 * r_sq, r_sq));
        integral(|t| shell * (t * r).powi(dimension - 1) * density(t) * r)
    }

    #[test]
    fn weights_integrate_to_one_in_each_dimension() {
        for kernel in KERNELS {
            for r in [0.01, 1.0, 300.0] {
                let integrals = [
                    over_ball(Kernel::weight_1d, kernel, 1, r),
                    over_ball(Kernel::weight_2d, kernel, 2, r),
                    over_ball(Kernel::weight_3d, kernel, 3, r),
                ];
                for total in integrals {
                    assert!((total - 1.0).abs() < 2e-5, "{kernel} r = {r}: {integrals:?}");
                }
            }
        }
    }

    #[test]
    fn the_unnormalised_gaussian_of_1996_loses_almost_half() {
        let total = over_ball(Kernel::weight_2d, Kernel::ReportGaussian, 2, 2.0);
        assert!((total - 0.531_15).abs() < 1e-5, "{total}");
    }

    #[test]
    fn weights_vanish_outside_and_never_turn_negative() {
        for kernel in KERNELS {
            assert_eq!(kernel.weight_1d(4.001, 4.0), 0.0);
            assert_eq!(kernel.weight_2d(4.001, 4.0), 0.0);
            assert_eq!(kernel.weight_3d(4.001, 4.0), 0.0);
            assert_eq!(kernel.shape(0.0), 1.0);
            for i in 0..=1000 {
                assert!(kernel.shape(i as f32 / 1000.0) >= 0.0, "{kernel} at t² = {i}/1000");
            }
        }
        assert_eq!(Kernel::Cone { k: 0.2 }.shape(1.0), 0.0);
        assert_eq!(Kernel::Cone { k: f32::NAN }.norm_2d(), Kernel::Cone { k: 1.0 }.norm_2d());
    }

    #[test]
    fn equal_bandwidth_factors_are_the_ratios_of_the_best_squared_radii() {
        // R and μ of a kernel on the unit disc, by quadrature; π cancels in the ratio.
        let roughness_over_spread_sq = |kernel: Kernel| {
            let w = |t: f64| f64::from(kernel.shape((t * t) as f32));
            let mass = integral(|t| 2.0 * t * w(t));
            let roughness = integral(|t| 2.0 * t * w(t) * w(t)) / (mass * mass);
            let spread = integral(|t| t * t * t * w(t)) / mass;
            roughness / (spread * spread)
        };
        let of_box = roughness_over_spread_sq(Kernel::Box);
        for kernel in KERNELS.into_iter().chain([Kernel::ReportGaussian]) {
            let factor = f64::from(kernel.equal_bandwidth_factor());
            let ratio = roughness_over_spread_sq(kernel) / of_box;
            assert!((factor.powi(3) - ratio).abs() < 1e-4, "{kernel}: {factor}³ is not {ratio}");
        }
        for (kernel, published) in [
            (Kernel::Epanechnikov, 1.44),
            (Kernel::Cone { k: 1.0 }, 1.61),
            (Kernel::Biweight, 1.93),
            (Kernel::Gaussian, 1.21),
        ] {
            assert!((kernel.equal_bandwidth_factor() - published).abs() < 0.005);
        }
    }

    #[test]
    fn names_read_back() {
        for kernel in KERNELS.into_iter().chain([Kernel::ReportGaussian]) {
            assert_eq!(Kernel::parse(&kernel.to_string()), Some(kernel));
            assert!(Kernel::NAMES.contains(&kernel.name()));
        }
        assert!(Kernel::NAMES.iter().all(|name| Kernel::parse(name).is_some_and(|k| k.name() == *name)));
        for bad in ["", "Box", "cone:", "cone:0.5", "cone:nan", "cone:inf", "tent"] {
            assert_eq!(Kernel::parse(bad), None, "{bad}");
        }
    }
}
