//! The sky by day: Preetham, Shirley and Smits 1999, *A Practical Analytic Model for Daylight*, doi 10.1145/311535.311545.
//!
//! Light is counted as the eye counts it: a radiance of 1 W/(m²·sr) in every channel stands for a luminance of 683 cd/m², so
//! that sky and sun are in proportion to one another. Values for which a spectrum of one at every wavelength has luminance one
//! are these over 106.857, the integral of the luminous efficiency in nm.

use super::LightKind;
use crate::color::Rgb;
use crate::math::{DVec3, Vec3, real};
use crate::texture::Image;

/// Luminous efficacy at 555 nm, lm/W.
const EFFICACY: f64 = 683.0;

/// Half of the angle that the sun is wide, in degrees.
const SUN_RADIUS_DEG: f64 = 0.2666;

/// Haziness for which the model makes sense.
const TURBIDITIES: [f64; 2] = [1.7, 10.0];

/// What a clear sky depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkySettings {
    /// How hazy the air is: 2 is very clear, 3 clear, 6 warm and moist, 10 hazy. Taken as at least 1.7 and at most 10.
    pub turbidity: f32,
    /// Towards the sun; +y is up. With the sun below the horizon there is no light at all.
    pub sun_direction: Vec3,
    /// Multiplies all light.
    pub scale: f32,
    /// Rows of the sky's image, at least 2; it is twice as wide.
    pub rows: u32,
}

impl Default for SkySettings {
    fn default() -> Self {
        Self { turbidity: 3.0, sun_direction: Vec3::Y, scale: 1.0, rows: 256 }
    }
}

/// The sky as an equirectangular image of radiance, black below the horizon, and the sun as it is seen through the air.
pub fn sun_sky(settings: &SkySettings) -> (Image, LightKind) {
    let (height, width) = (settings.rows.max(2), 2 * settings.rows.max(2));
    let model = Sky::new(settings);
    let mut pixels = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        // Rows lie from pole to pole, columns have their middles.
        let theta = std::f64::consts::PI * f64::from(y) / f64::from(height - 1);
        let (sin, cos) = (libm::sin(theta), libm::cos(theta));
        for x in 0..width {
            let turn = 360.0 * (f64::from(x) + 0.5) / f64::from(width);
            let direction = DVec3::new(sin * real::sin_deg(turn), cos, -sin * real::cos_deg(turn));
            pixels.push(model.as_ref().map_or(Rgb::BLACK, |sky| sky.radiance(direction)));
        }
    }
    let sun = LightKind::Sun {
        direction: settings.sun_direction,
        irradiance: model.map_or(Rgb::BLACK, |sky| sky.sun()),
        angular_radius_deg: SUN_RADIUS_DEG as f32,
    };
    (Image { width, height, pixels }, sun)
}

/// The five parameters of the distribution of one quantity over the sky.
#[derive(Clone, Copy, Debug)]
struct Perez([f64; 5]);

impl Perez {
    /// Each is linear in the turbidity.
    fn new(slopes: [f64; 5], at_zero: [f64; 5], turbidity: f64) -> Self {
        Self(std::array::from_fn(|i| slopes[i] * turbidity + at_zero[i]))
    }

    /// Equation 1, for a direction whose cosine to the zenith is positive and one at an angle γ to the sun.
    fn eval(&self, cos_theta: f64, gamma: f64) -> f64 {
        let [a, b, c, d, e] = self.0;
        let cos_gamma = libm::cos(gamma);
        (1.0 + a * libm::exp(b / cos_theta)) * (1.0 + c * libm::exp(d * gamma) + e * cos_gamma * cos_gamma)
    }
}

/// A sky whose sun is above the horizon.
#[derive(Clone, Debug)]
struct Sky {
    turbidity: f64,
    sun: DVec3,
    /// The sun's angle from the zenith.
    theta: f64,
    scale: f64,
    /// Luminance and chromaticities x and y: at the zenith, and over the sky.
    zenith: [f64; 3],
    over: [Perez; 3],
}

impl Sky {
    /// `None` if the sun is not above the horizon.
    fn new(settings: &SkySettings) -> Option<Self> {
        let sun = settings.sun_direction.as_dvec3().try_normalize().filter(|sun| sun.y > 0.0)?;
        let t = f64::from(settings.turbidity).clamp(TURBIDITIES[0], TURBIDITIES[1]);
        let theta = libm::acos(sun.y.min(1.0));
        Some(Self {
            turbidity: t,
            sun,
            theta,
            scale: f64::from(settings.scale),
            zenith: zenith(t, theta),
            // Appendix A.2.
            over: [
                Perez::new(
                    [0.1787, -0.3554, -0.0227, 0.1206, -0.0670],
                    [-1.4630, 0.4275, 5.3251, -2.5771, 0.3703],
                    t,
                ),
                Perez::new(
                    [-0.0193, -0.0665, -0.0004, -0.0641, -0.0033],
                    [-0.2592, 0.0008, 0.2125, -0.8989, 0.0452],
                    t,
                ),
                Perez::new(
                    [-0.0167, -0.0950, -0.0079, -0.0441, -0.0109],
                    [-0.2608, 0.0092, 0.2102, -1.6537, 0.0529],
                    t,
                ),
            ],
        })
    }

    /// Luminance in kcd/m² and the chromaticities x and y of a direction above the horizon: equation 2.
    fn quantities(&self, direction: DVec3) -> [f64; 3] {
        let gamma = libm::atan2(direction.cross(self.sun).length(), direction.dot(self.sun));
        std::array::from_fn(|i| {
            let perez = self.over[i];
            self.zenith[i] * perez.eval(direction.y, gamma) / perez.eval(1.0, self.theta)
        })
    }

    fn radiance(&self, direction: DVec3) -> Rgb {
        // Rounding leaves the row at the horizon on either side of it.
        if direction.y <= 1e-9 {
            return Rgb::BLACK;
        }
        let [luminance, x, y] = self.quantities(direction);
        let watts = luminance.max(0.0) * 1000.0 / EFFICACY * self.scale;
        rgb_of_xyz([x / y * watts, watts, (1.0 - x - y) / y * watts])
    }

    /// Irradiance of the sun on a surface facing it: appendix A.1.
    fn sun(&self) -> Rgb {
        let degrees = self.theta.to_degrees();
        // The mass of air in the way, of that overhead.
        let mass = 1.0 / (libm::cos(self.theta) + 0.15 * libm::pow(93.885 - degrees, -1.253));
        let beta = 0.046_083_658 * self.turbidity - 0.045_860_259;
        let mut xyz = [0.0; 3];
        for (i, [outside, ozone, vapour]) in SUN.into_iter().enumerate() {
            let nanometres = 380.0 + 10.0 * i as f64;
            let micrometres = nanometres / 1000.0;
            let water = vapour * 2.0 * mass;
            // Rayleigh scattering, haze, ozone of 0.35 cm, and 2 cm of water. Mixed gases absorb beyond 750 nm only.
            let depth = 0.008_735 * libm::pow(micrometres, -4.08) * mass
                + beta * libm::pow(micrometres, -1.3) * mass
                + ozone * 0.35 * mass
                + 0.2385 * water / libm::pow(1.0 + 20.07 * water, 0.45);
            let radiance = 100.0 * outside * libm::exp(-depth);
            for (sum, weight) in xyz.iter_mut().zip(observer(nanometres)) {
                *sum += weight * radiance * 10.0;
            }
        }
        let sin = libm::sin(SUN_RADIUS_DEG.to_radians());
        let solid_angle = std::f64::consts::PI * sin * sin;
        rgb_of_xyz(xyz.map(|sum| sum * solid_angle * self.scale))
    }
}

/// Luminance in kcd/m² and the chromaticities x and y of the zenith, by turbidity and the sun's angle from there: appendix A.2.
fn zenith(t: f64, theta: f64) -> [f64; 3] {
    let chi = (4.0 / 9.0 - t / 120.0) * (std::f64::consts::PI - 2.0 * theta);
    let luminance = (4.0453 * t - 4.9710) * libm::tan(chi) - 0.2155 * t + 2.4192;
    let chromaticity = |rows: [[f64; 4]; 3]| {
        let [square, linear, constant] = rows.map(|[a, b, c, d]| ((a * theta + b) * theta + c) * theta + d);
        (square * t + linear) * t + constant
    };
    let x = chromaticity([
        [0.00166, -0.00375, 0.00209, 0.0],
        [-0.02903, 0.06377, -0.03202, 0.00394],
        [0.11693, -0.21196, 0.06052, 0.25886],
    ]);
    let y = chromaticity([
        [0.00275, -0.00610, 0.00317, 0.0],
        [-0.04214, 0.08970, -0.04153, 0.00516],
        [0.15346, -0.26756, 0.06670, 0.26688],
    ]);
    [luminance, x, y]
}

/// Linear sRGB of tristimulus values; what no screen shows ends at 0.
fn rgb_of_xyz([x, y, z]: [f64; 3]) -> Rgb {
    let rows = [
        [3.240_454_2, -1.537_138_5, -0.498_531_4],
        [-0.969_266_0, 1.876_010_8, 0.041_556_0],
        [0.055_643_4, -0.204_025_9, 1.057_225_2],
    ];
    Rgb::from(rows.map(|[a, b, c]| (a * x + b * y + c * z).max(0.0) as f32))
}

/// The CIE 1931 colour matching functions (Wyman, Sloan and Shirley 2013, *Simple Analytic Approximations to the CIE XYZ Color
/// Matching Functions*, JCGT 2(2), equation 4).
fn observer(nanometres: f64) -> [f64; 3] {
    let lobe = |weight: f64, middle: f64, below: f64, above: f64| {
        let t = (nanometres - middle) / if nanometres < middle { below } else { above };
        weight * libm::exp(-0.5 * t * t)
    };
    [
        lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    ]
}

/// For each 10 nm from 380 nm: the sun's radiance outside of the air in 100 W/(m²·nm·sr), and the absorption of ozone and of
/// water vapour in 1/cm (the paper's table 2).
const SUN: [[f64; 3]; 38] = [
    [165.5, 0.0008, 0.0],
    [162.3, 0.0012, 0.0],
    [211.2, 0.0015, 0.0],
    [258.8, 0.0018, 0.0],
    [258.2, 0.0022, 0.0],
    [242.3, 0.0025, 0.0],
    [267.6, 0.0028, 0.0],
    [296.6, 0.003, 0.0],
    [305.4, 0.006, 0.0],
    [300.6, 0.009, 0.0],
    [306.6, 0.014, 0.0],
    [288.3, 0.021, 0.0],
    [287.1, 0.03, 0.0],
    [278.2, 0.04, 0.0],
    [271.0, 0.048, 0.0],
    [272.3, 0.063, 0.0],
    [263.6, 0.075, 0.0],
    [255.0, 0.085, 0.0],
    [250.6, 0.103, 0.0],
    [253.1, 0.12, 0.0],
    [253.5, 0.12, 0.0],
    [251.3, 0.115, 0.0],
    [246.3, 0.125, 0.0],
    [241.7, 0.12, 0.0],
    [236.8, 0.105, 0.0],
    [232.1, 0.09, 0.0],
    [228.2, 0.079, 0.0],
    [223.4, 0.067, 0.0],
    [219.7, 0.057, 0.0],
    [215.3, 0.048, 0.0],
    [211.0, 0.036, 0.0],
    [207.3, 0.028, 0.016],
    [202.4, 0.023, 0.024],
    [198.7, 0.018, 0.0125],
    [194.3, 0.014, 1.0],
    [190.7, 0.011, 0.87],
    [186.3, 0.010, 0.061],
    [182.6, 0.009, 0.001],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// A sun at an angle from the zenith.
    fn settings(degrees: f64, turbidity: f32) -> SkySettings {
        let sun = Vec3::new(real::sin_deg(degrees) as f32, real::cos_deg(degrees) as f32, 0.0);
        SkySettings { turbidity, sun_direction: sun, scale: 1.0, rows: 16 }
    }

    fn sky(degrees: f64, turbidity: f32) -> Sky {
        Sky::new(&settings(degrees, turbidity)).expect("the sun is up")
    }

    /// Y of linear sRGB.
    fn luminance(rgb: Rgb) -> f64 {
        let weights = [0.212_672_9, 0.715_152_2, 0.072_175_0];
        rgb.to_array().iter().zip(weights).map(|(v, w)| f64::from(*v) * w).sum()
    }

    /// By hand from the paper's polynomials: T = 3, the sun 45° from the zenith.
    #[test]
    fn the_zenith_is_that_of_the_paper() {
        let [luminance_of_zenith, x, y] = zenith(3.0, std::f64::consts::FRAC_PI_4);
        // χ = (4/9 − 1/40) π/2 = 0.658862 rad, and Y = 7.1649 tan χ − 0.6465 + 2.4192.
        assert!(
            (luminance_of_zenith - (7.1649 * 0.774_282_7 + 1.7727)).abs() < 2e-3,
            "{luminance_of_zenith}"
        );
        // Clear blue.
        assert!((0.24..0.27).contains(&x) && (0.25..0.28).contains(&y), "{x} {y}");
        let seen = sky(45.0, 3.0).radiance(DVec3::Y);
        let nits = luminance(seen) * EFFICACY / 1000.0;
        assert!((nits / luminance_of_zenith - 1.0).abs() < 1e-4, "{nits} of {luminance_of_zenith}");
        assert!(seen.b > seen.g && seen.g > seen.r);
    }

    #[test]
    fn skies_are_brightest_at_the_sun_and_never_odd() {
        for turbidity in [1.0, 2.0, 3.0, 6.0, 10.0, 20.0] {
            for degrees in [0.0, 30.0, 60.0, 85.0, 89.9] {
                let (image, LightKind::Sun { irradiance, .. }) = sun_sky(&settings(degrees, turbidity))
                else {
                    panic!("a sun");
                };
                let sound = |p: &Rgb| p.is_finite() && p.min_channel() >= 0.0;
                assert!(image.pixels.iter().all(sound) && sound(&irradiance));
                assert!(irradiance.r > 0.0 || degrees > 89.0, "{irradiance:?}");
                let dark = image.pixels.iter().skip(8 * 32);
                assert!(dark.clone().count() == 256 && dark.clone().all(|p| *p == Rgb::BLACK));
                // At the sun's height, away from it.
                let model = sky(degrees, turbidity);
                let (sin, cos) = (real::sin_deg(60.0), real::cos_deg(60.0));
                let around = |turn: f64| {
                    let to = DVec3::new(sin * real::cos_deg(turn), cos, sin * real::sin_deg(turn));
                    model.quantities(to)[0]
                };
                let brightness: Vec<f64> = (0..9).map(|i| around(f64::from(i) * 10.0)).collect();
                assert!(degrees == 0.0 || brightness.windows(2).all(|w| w[0] > w[1]), "{brightness:?}");
            }
        }
    }

    #[test]
    fn a_low_sun_is_weak_and_red_and_one_below_the_horizon_gives_nothing() {
        let suns: Vec<Rgb> = [0.0, 30.0, 60.0, 80.0, 88.0].map(|degrees| sky(degrees, 3.0).sun()).into();
        assert!(suns.windows(2).all(|w| luminance(w[0]) > luminance(w[1])), "{suns:?}");
        assert!(suns.windows(2).all(|w| w[0].b / w[0].r > w[1].b / w[1].r), "{suns:?}");
        // Some 100 000 lux at noon.
        let lux = luminance(suns[0]) * EFFICACY;
        assert!((80_000.0..120_000.0).contains(&lux), "{lux}");
        assert!(luminance(sky(40.0, 2.0).sun()) > luminance(sky(40.0, 6.0).sun()));
        let (night, sun) = sun_sky(&settings(91.0, 3.0));
        assert!(night.pixels.iter().all(|p| *p == Rgb::BLACK));
        assert!(matches!(sun, LightKind::Sun { irradiance: Rgb::BLACK, .. }));
    }

    #[test]
    fn colours_are_matched_as_the_table_has_it() {
        // At 555 nm ȳ is 1, and the integral of each function is 106.86 nm.
        assert!((observer(555.0)[1] - 1.0).abs() < 0.01);
        for k in 0..3 {
            let sum: f64 = (360..800).map(|nm| observer(f64::from(nm))[k]).sum();
            assert!((sum / 106.86 - 1.0).abs() < 0.01, "{sum}");
        }
    }
}
