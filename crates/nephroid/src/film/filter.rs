use crate::math::real::exp;

/// Reconstruction filter, as a function of the distance from the pixel's centre in pixels.
///
/// A filter is the product of the same function of x and of y; the names and the defaults are
/// those of Mitsuba.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// Constant over the pixel.
    Box,
    /// Linear down to zero at `radius`.
    Tent {
        /// Where it ends.
        radius: f32,
    },
    /// A bell, cut off (and lowered to zero) at four standard deviations.
    Gaussian {
        /// Standard deviation.
        std_dev: f32,
    },
    /// The cubic of Mitchell and Netravali (1988), with negative lobes; ends at 2 pixels.
    Mitchell {
        /// Blur.
        b: f32,
        /// Ringing.
        c: f32,
    },
}

impl Filter {
    /// What [`Filter::parse`] understands.
    pub const NAMES: [&'static str; 4] = ["box", "tent", "gaussian", "mitchell"];

    /// The filter of that name with its default parameters.
    pub fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "box" => Self::Box,
            "tent" => Self::Tent { radius: 1.0 },
            "gaussian" => Self::Gaussian { std_dev: 0.5 },
            "mitchell" => Self::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 },
            _ => return None,
        })
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Tent { .. } => "tent",
            Self::Gaussian { .. } => "gaussian",
            Self::Mitchell { .. } => "mitchell",
        }
    }

    /// Whether samples may count less than nothing.
    pub(crate) fn has_negative_lobes(self) -> bool {
        matches!(self, Self::Mitchell { .. })
    }

    /// Whether the parameters make a filter: lengths finite and above zero, `b` and `c` in [0, 1],
    /// the square that Mitchell and Netravali studied.
    pub fn is_valid(self) -> bool {
        let length = |l: f32| l.is_finite() && l > 0.0;
        match self {
            Self::Box => true,
            Self::Tent { radius } => length(radius),
            Self::Gaussian { std_dev } => length(std_dev) && length(4.0 * std_dev),
            Self::Mitchell { b, c } => (0.0..=1.0).contains(&b) && (0.0..=1.0).contains(&c),
        }
    }

    /// Half its width, in pixels: it is zero beyond.
    pub fn radius(self) -> f32 {
        match self {
            Self::Box => 0.5,
            Self::Tent { radius } => radius,
            Self::Gaussian { std_dev } => 4.0 * std_dev,
            Self::Mitchell { .. } => 2.0,
        }
    }

    /// Its value at a distance of `x` pixels along one axis, up to a constant factor.
    pub fn eval_axis(self, x: f32) -> f32 {
        let x = x.abs();
        if x > self.radius() {
            return 0.0;
        }
        match self {
            Self::Box => 1.0,
            Self::Tent { radius } => 1.0 - x / radius,
            Self::Gaussian { std_dev } => {
                let t = x / std_dev;
                (exp(-0.5 * t * t) - exp(-8.0)).max(0.0)
            }
            Self::Mitchell { b, c } => mitchell(x, b, c),
        }
    }
}

/// Equation 8 of Mitchell and Netravali, *Reconstruction Filters in Computer Graphics* (1988), for
/// `x` in [0, 2].
fn mitchell(x: f32, b: f32, c: f32) -> f32 {
    let (k3, k2, k1, k0) = if x < 1.0 {
        (12.0 - 9.0 * b - 6.0 * c, -18.0 + 12.0 * b + 6.0 * c, 0.0, 6.0 - 2.0 * b)
    } else {
        (-b - 6.0 * c, 6.0 * b + 30.0 * c, -12.0 * b - 48.0 * c, 8.0 * b + 24.0 * c)
    };
    (((k3 * x + k2) * x + k1) * x + k0) / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_at_known_points() {
        assert_eq!(Filter::Tent { radius: 2.0 }.eval_axis(-0.5), 0.75);
        let gaussian = Filter::Gaussian { std_dev: 0.5 };
        assert!((gaussian.eval_axis(0.5) - (0.606_530_7 - 0.000_335_46)).abs() < 1e-6);
        assert_eq!(gaussian.eval_axis(2.0), 0.0);
        // The cubic B-spline: 4/6 at 0 and 1/6 at 1.
        let spline = Filter::Mitchell { b: 1.0, c: 0.0 };
        assert!((spline.eval_axis(0.0) - 4.0 / 6.0).abs() < 1e-6);
        assert!((spline.eval_axis(1.0) - 1.0 / 6.0).abs() < 1e-6);
        // Catmull and Rom's spline: 1 at 0, 0 at 1 and 2, −1/16 at 1.5.
        let catmull_rom = Filter::Mitchell { b: 0.0, c: 0.5 };
        assert_eq!(catmull_rom.eval_axis(0.0), 1.0);
        assert!(catmull_rom.eval_axis(1.0).abs() < 1e-6 && catmull_rom.eval_axis(2.0).abs() < 1e-6);
        assert!((catmull_rom.eval_axis(1.5) + 0.0625).abs() < 1e-6);
    }

    #[test]
    fn names_lead_back_to_filters() {
        for name in Filter::NAMES {
            let filter = Filter::parse(name).unwrap();
            assert_eq!(filter.name(), name);
            assert!(filter.is_valid());
        }
        assert_eq!(Filter::parse("lanczos"), None);
    }

    #[test]
    fn impossible_parameters_are_recognised() {
        for bad in [
            Filter::Tent { radius: 0.0 },
            Filter::Tent { radius: f32::NAN },
            Filter::Gaussian { std_dev: -1.0 },
            Filter::Gaussian { std_dev: f32::MAX },
            Filter::Mitchell { b: f32::INFINITY, c: 0.0 },
            Filter::Mitchell { b: 0.3, c: -0.1 },
        ] {
            assert!(!bad.is_valid(), "{bad:?}");
        }
    }
}
