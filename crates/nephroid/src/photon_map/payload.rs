use super::photon::Photon;
use crate::bvh::{LANES, Lanes};
use crate::color::Rgb;
use crate::math::Vec3;
use crate::sampling::{Key, Stream};

/// What the index does not hold of a photon, in 16 bytes.
///
/// - Directions lie on an octahedron folded out to a square (Cigolle et al. 2014, *A Survey of Efficient
///   Representations for Independent Unit Vectors*, JCGT 3(2)), whose coordinates have 16 bits. They are
///   off by at most 6.5·10⁻⁵ rad; directions along the axes are exact.
/// - Power is three mantissas of 8 bits and an exponent for all of them (after Ward 1991, *Real
///   Pixels*, Graphics Gems II). Each is rounded up or down by chance, such that the *mean* is exact: rounded
///   always to the nearest, a light whose photons all carry the same power would come out up to 0.4 %
///   too bright or too dark.
/// - Lights from 65 535 on have that number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub(super) struct Payload {
    normal: [i16; 2],
    depth: u16,
    light: u16,
    wi: [i16; 2],
    mantissas: [u8; 3],
    exponent: u8,
}

/// What is kept of eight photons, side by side: one instruction can work on all of them. Beyond the last
/// photon are zeros.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub(super) struct PayloadBlock {
    /// From the lowest byte: three mantissas and the exponent.
    powers: [u32; LANES],
    normals: [[i16; 2]; LANES],
    depths: [u16; LANES],
    lights: [u16; LANES],
    wis: [[i16; 2]; LANES],
}

impl PayloadBlock {
    /// Of at most eight photons.
    pub fn new(payloads: impl Iterator<Item = Payload>) -> Self {
        let mut block = Self::default();
        for (lane, payload) in payloads.enumerate().take(LANES) {
            let ([r, g, b], e) = (payload.mantissas, payload.exponent);
            block.powers[lane] = u32::from_le_bytes([r, g, b, e]);
            block.normals[lane] = payload.normal;
            block.depths[lane] = payload.depth;
            block.lights[lane] = payload.light;
            block.wis[lane] = payload.wi;
        }
        block
    }

    #[inline(always)]
    pub fn get(&self, lane: usize) -> Payload {
        let [r, g, b, exponent] = self.powers[lane].to_le_bytes();
        Payload {
            normal: self.normals[lane],
            depth: self.depths[lane],
            light: self.lights[lane],
            wi: self.wis[lane],
            mantissas: [r, g, b],
            exponent,
        }
    }

    /// Powers in the lanes of a mask, and black in the others.
    #[inline(always)]
    pub fn powers<L: Lanes>(&self, mask: L) -> [L; 3] {
        let scale = L::from_exponent(&self.powers, BIAS).and(mask);
        [
            L::from_byte::<0>(&self.powers).times(scale),
            L::from_byte::<1>(&self.powers).times(scale),
            L::from_byte::<2>(&self.powers).times(scale),
        ]
    }
}

/// The largest angle in radians between a direction and what is kept of it.
#[cfg(test)]
const MAX_ANGLE: f64 = 6.5e-5;

/// Coordinates of the octahedron from -1 to 1 are so many steps.
const STEPS: f32 = 32767.0;

/// The exponents of the scale, less the exponent that is stored: a mantissa of 128 is one at 127.
const BIAS: u32 = 7;

/// The least exponent that is stored, for powers up to 10⁻³⁶ W: its scale is the smallest normal number.
const LEAST: u32 = BIAS + 1;

impl Payload {
    /// `number` is the photon's in its pass: the key of chance, so that neither the order of the map
    /// nor a scale of power that is a power of two changes the rounding.
    pub fn new(photon: &Photon, number: u32) -> Self {
        let (mantissas, exponent) = encode_power(photon.power, number, photon.wi);
        Self {
            normal: encode_direction(photon.normal),
            depth: photon.depth,
            light: photon.light.min(u32::from(u16::MAX)) as u16,
            wi: encode_direction(photon.wi),
            mantissas,
            exponent,
        }
    }

    #[inline(always)]
    pub fn decode(&self, position: Vec3) -> Photon {
        Photon {
            position,
            power: self.power(),
            wi: octahedron(self.wi).normalize(),
            normal: octahedron(self.normal).normalize(),
            depth: self.depth,
            light: u32::from(self.light),
        }
    }

    #[inline(always)]
    fn power(&self) -> Rgb {
        decode_power(self.mantissas, self.exponent)
    }

    /// The normal times some length between 1/√3 and 1.
    #[inline(always)]
    pub fn scaled_normal(&self) -> Vec3 {
        octahedron(self.normal)
    }

    #[inline(always)]
    pub fn depth(&self) -> u16 {
        self.depth
    }
}

/// Mantissas m and exponent e of a power: it is about m 2^(e − 134).
///
/// What they are rounded by follows from the photon's number and direction, so that maps do not repeat one another, whatever the
/// scale of the scene.
pub(super) fn encode_power(power: Rgb, number: u32, wi: Vec3) -> ([u8; 3], u8) {
    let power = [power.r, power.g, power.b].map(|p| if p > 0.0 { p } else { 0.0 });
    let largest = power.into_iter().fold(0.0, f32::max).min(f32::MAX);
    let mut exponent = (largest.to_bits() >> 23).max(LEAST);
    let per_scale = |exponent: u32| 1.0 / f64::from(f32::from_bits((exponent - BIAS) << 23));
    // What could be rounded up to 256.
    exponent += u32::from(f64::from(largest) * per_scale(exponent) > 255.0);
    exponent = exponent.min(254);
    let per_scale = per_scale(exponent);
    let [x, y, z] = wi.to_array().map(|v| u64::from(v.to_bits()));
    let named = u64::from(number) << 32 ^ y << 16 ^ z;
    let chance = Key::new(0, x, Stream::Rounding).with(named).hash();
    let mantissa = |channel: usize| {
        let exact = f64::from(power[channel]) * per_scale;
        let u = (chance >> (21 * channel) & 0x1f_ffff) as f64 / f64::from(1 << 21);
        (exact + u) as u8
    };
    ([mantissa(0), mantissa(1), mantissa(2)], exponent as u8)
}

/// The power of mantissas and an exponent.
#[inline(always)]
pub(super) fn decode_power(mantissas: [u8; 3], exponent: u8) -> Rgb {
    let scale = f32::from_bits((u32::from(exponent) - BIAS) << 23);
    let [r, g, b] = mantissas.map(|m| f32::from(m) * scale);
    Rgb { r, g, b }
}

/// The nearest point of the octahedron's square.
pub(super) fn encode_direction(v: Vec3) -> [i16; 2] {
    let p = v / (v.x.abs() + v.y.abs() + v.z.abs());
    let (x, y) = if p.z >= 0.0 {
        (p.x, p.y)
    } else {
        ((1.0 - p.y.abs()).copysign(p.x), (1.0 - p.x.abs()).copysign(p.y))
    };
    // To the nearest: without a call, which `round` is where SSE4.1 may be missing. Saturates, and NaN is
    // zero.
    [x, y].map(|c| (c * STEPS + 0.5f32.copysign(c)) as i16)
}

/// The point of the octahedron, |x| + |y| + |z| = 1, that a point of the square stands for.
#[inline(always)]
pub(super) fn octahedron(square: [i16; 2]) -> Vec3 {
    let [x, y] = square.map(|c| f32::from(c) * (1.0 / STEPS));
    let z = 1.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    Vec3::new(x - fold.copysign(x), y - fold.copysign(y), z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Vec2, warp};
    use crate::photon_map::testing::{Rng, photon_at};
    use nephroid_testkit::{ALPHA, sidak};

    #[test]
    fn directions_are_off_by_less_than_the_stated_angle() {
        let mut rng = Rng::new(1);
        let mut worst = 0.0f64;
        for _ in 0..1_000_000 {
            let v = warp::square_to_sphere(Vec2::new(rng.next(), rng.next()));
            let kept = octahedron(encode_direction(v)).normalize();
            worst = worst.max(v.as_dvec3().cross(kept.as_dvec3()).length());
            assert!(v.dot(kept) > 0.0);
        }
        assert!((0.5 * MAX_ANGLE..MAX_ANGLE).contains(&worst), "{worst}");
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for v in [axis, -axis] {
                assert_eq!(octahedron(encode_direction(v)).normalize(), v);
            }
        }
    }

    /// Means of the three channels over photons 0 to n, relative to what they should be.
    fn means(power: Rgb, n: u32, round: impl Fn(Rgb, u32) -> Rgb) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for number in 0..n {
            let kept = round(power, number);
            for (sum, channel) in sums.iter_mut().zip([kept.r, kept.g, kept.b]) {
                *sum += f64::from(channel);
            }
        }
        let exact = [power.r, power.g, power.b];
        std::array::from_fn(|i| sums[i] / f64::from(n) / f64::from(exact[i]))
    }

    fn by_chance(power: Rgb, number: u32) -> Rgb {
        Payload::new(&Photon { power, ..photon_at(Vec3::ZERO, Vec3::Z) }, number).power()
    }

    /// Powers and, for each channel, the standard deviation of one rounded number relative to it.
    fn powers() -> Vec<(Rgb, [f64; 3])> {
        let mut rng = Rng::new(2);
        let mut random = || Rgb { r: rng.next() + 1e-3, g: rng.next() + 1e-3, b: rng.next() + 1e-3 };
        let all = (0..20).map(|i| random() * [1e-30, 1e-3, 1.0, 1e20][i % 4]);
        let deviations = |p: Rgb| {
            let (_, exponent) = encode_power(p, 0, Vec3::ZERO);
            [p.r, p.g, p.b].map(|c| {
                let exact = f64::from(c) / f64::from(f32::from_bits((u32::from(exponent) - BIAS) << 23));
                let up = exact - exact.floor();
                (up * (1.0 - up)).sqrt() / exact
            })
        };
        all.map(|p| (p, deviations(p))).collect()
    }

    /// The largest deviation of a mean in standard deviations: 60 two-sided Z tests.
    fn worst_z(round: impl Fn(Rgb, u32) -> Rgb) -> f64 {
        const N: u32 = 100_000;
        let z = |(power, deviations): (Rgb, [f64; 3])| {
            let means = means(power, N, &round);
            (0..3).map(|i| (means[i] - 1.0).abs() / (deviations[i] / f64::from(N).sqrt())).fold(0.0, f64::max)
        };
        powers().into_iter().map(z).fold(0.0, f64::max)
    }

    /// False-positive rate: `ALPHA`.
    #[test]
    fn the_mean_of_rounded_power_is_exact() {
        let worst = worst_z(by_chance);
        let p = nephroid_testkit::z_test(worst, 0.0, 1.0);
        p.assert_passes(sidak(ALPHA, 60));
    }

    #[test]
    fn rounding_to_the_nearest_would_be_found_out() {
        let nearest = |power: Rgb, _| {
            let (_, exponent) = encode_power(power, 0, Vec3::ZERO);
            let scale = f32::from_bits((u32::from(exponent) - BIAS) << 23);
            let round = |p: f32| (p / scale).round() * scale;
            Rgb { r: round(power.r), g: round(power.g), b: round(power.b) }
        };
        assert!(worst_z(nearest) > 50.0);
    }

    #[test]
    fn a_power_of_two_scales_rounded_power_exactly() {
        let mut rng = Rng::new(3);
        for number in 0..10_000 {
            let power = Rgb { r: rng.next(), g: 0.1 * rng.next(), b: 1e-3 * rng.next() };
            let kept = by_chance(power, number);
            for scale in [2.0f32.powi(-90), 0.25, 2.0f32.powi(100)] {
                assert_eq!(by_chance(power * scale, number), kept * scale);
            }
            assert!((kept.r - power.r).abs() <= power.r.max(power.g) / 127.0);
        }
    }

    #[test]
    fn powers_that_fit_are_kept_and_odd_ones_stay_finite() {
        for p in [Rgb::BLACK, Rgb::WHITE, Rgb::splat(255.0), Rgb { r: 1.0, g: 0.5, b: 127.0 / 128.0 }] {
            assert_eq!(by_chance(p, 7), p);
        }
        for p in [f32::MAX, f32::MIN_POSITIVE, 1e-45, 0.999_999_9, -1.0, f32::NAN, f32::INFINITY] {
            for number in 0..100 {
                let kept = by_chance(Rgb { r: p, g: 1e-40, b: 0.0 }, number);
                assert!(kept.r >= 0.0 && kept.r.is_finite() && kept.b == 0.0, "{p} {kept:?}");
            }
        }
    }

    #[test]
    fn lights_beyond_the_last_number_have_the_last() {
        let of = |light| Payload::new(&Photon { light, ..photon_at(Vec3::ZERO, Vec3::Z) }, 0);
        assert_eq!(of(65_534).decode(Vec3::ZERO).light, 65_534);
        assert_eq!(of(u32::MAX).decode(Vec3::ZERO).light, 65_535);
        assert_eq!(size_of::<Payload>(), 16);
    }
}
