//! A frozen random number generator.

/// PCG32 (XSH RR 64/32), written out here so that no change of a dependency ever changes a test.
///
/// O'Neill, "PCG: A family of simple fast space-efficient statistically good algorithms for random number
/// generation", Harvey Mudd College technical report HMC-CS-2014-0905.
#[derive(Clone, Debug)]
pub struct Pcg32 {
    state: u64,
    increment: u64,
}

const MULTIPLIER: u64 = 6_364_136_223_846_793_005;

impl Pcg32 {
    /// The generator with this seed on the default stream.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self::with_stream(seed, 1)
    }

    /// The generator with this seed on one of 2⁶³ streams, which do not overlap.
    #[must_use]
    pub fn with_stream(seed: u64, stream: u64) -> Self {
        let increment = (stream << 1) | 1;
        let state = increment.wrapping_add(seed).wrapping_mul(MULTIPLIER).wrapping_add(increment);
        Self { state, increment }
    }

    /// The next 32 random bits.
    pub fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(MULTIPLIER).wrapping_add(self.increment);
        let shifted = (((old >> 18) ^ old) >> 27) as u32;
        shifted.rotate_right((old >> 59) as u32)
    }

    /// A number in [0, 1) on the grid of 2⁻²⁴, which single precision holds exactly.
    pub fn next_f32(&mut self) -> f32 {
        (self.next_u32() >> 8) as f32 * (1.0 / (1_u32 << 24) as f32)
    }

    /// A number in [0, 1) on the grid of 2⁻⁵³. Cast to `f32` it can become 1: see [`next_f32`](Self::next_f32).
    pub fn next_f64(&mut self) -> f64 {
        let high = u64::from(self.next_u32());
        let bits = (high << 32) | u64::from(self.next_u32());
        (bits >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// A point in the unit square [0, 1)², in double precision.
    pub fn vec2(&mut self) -> [f64; 2] {
        [self.next_f64(), self.next_f64()]
    }

    /// A point in the unit square [0, 1)², in single precision.
    pub fn vec2_f32(&mut self) -> [f32; 2] {
        [self.next_f32(), self.next_f32()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ALPHA, ks_test, sidak};

    #[test]
    fn gives_the_values_published_with_the_algorithm() {
        let mut rng = Pcg32::with_stream(42, 54);
        let expected = [0xa15c_02b7, 0x7b47_f409, 0xba1d_3330, 0x83d2_f293, 0xbfa4_784b, 0xcbed_606e];
        for value in expected {
            assert_eq!(rng.next_u32(), value);
        }
    }

    #[test]
    fn stays_as_it_was_frozen() {
        let mut rng = Pcg32::new(1);
        assert_eq!(rng.next_u32(), FROZEN.0);
        assert_eq!(rng.next_f32(), FROZEN.1);
        assert_eq!(rng.next_f64(), FROZEN.2);
    }

    const FROZEN: (u32, f32, f64) = (3_380_776_849, 0.084_272_504, 0.750_582_119_367_900_8);

    #[test]
    fn never_reaches_one() {
        let mut top = Pcg32 { state: 0, increment: 1 };
        let mut largest = 0.0_f64;
        for _ in 0..100_000 {
            assert!(top.next_f32() < 1.0);
            largest = largest.max(top.next_f64());
        }
        assert!((0.9999..1.0).contains(&largest));
        assert!((u32::MAX >> 8) as f32 * (1.0 / (1_u32 << 24) as f32) < 1.0);
        assert!((u64::MAX >> 11) as f64 * (1.0 / (1_u64 << 53) as f64) < 1.0);
    }

    #[test]
    fn is_uniform() {
        let mut rng = Pcg32::new(2);
        let singles: Vec<f64> = (0..50_000).map(|_| f64::from(rng.next_f32())).collect();
        let doubles: Vec<f64> = (0..50_000).map(|_| rng.next_f64()).collect();
        ks_test(&singles, |x| x).assert_passes(sidak(ALPHA, 2));
        ks_test(&doubles, |x| x).assert_passes(sidak(ALPHA, 2));
    }
}
