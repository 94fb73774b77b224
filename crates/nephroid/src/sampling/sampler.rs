use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::Key;
use crate::math::Vec2;

/// How the numbers of successive samples of one sequence relate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sequence {
    /// Not at all.
    Independent,
    /// They fill the unit cubes evenly: Owen-scrambled Sobol points (Burley 2020, JCGT 9(4)),
    /// in sets of four dimensions that are independent of one another.
    #[default]
    Sobol,
}

/// Sets of four dimensions after which numbers are independent: deep bounces gain nothing.
const SOBOL_SETS: u32 = 12;

/// Length of one Sobol sequence; longer ones are a series of independently scrambled ones.
const SOBOL_LENGTH: u64 = 1 << 16;

/// The numbers in [0, 1) of one path.
#[derive(Clone, Debug)]
pub struct Sampler {
    sequence: Sequence,
    seed: u32,
    index: u32,
    set: u32,
    left: usize,
    buffer: [f32; 4],
    rng: Pcg32,
}

impl Sampler {
    /// The numbers of path `index` of the sequence that `key` names.
    #[inline]
    pub fn new(sequence: Sequence, key: Key, index: u64) -> Self {
        let own = key.with(index).hash();
        let block = key.with(index / SOBOL_LENGTH).with(0x5067).hash();
        Self {
            sequence,
            seed: (block >> 32) as u32,
            index: (index % SOBOL_LENGTH) as u32,
            set: 0,
            left: 0,
            buffer: [0.0; 4],
            rng: Pcg32::new(own, own.rotate_left(32)),
        }
    }

    /// The next number.
    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        if self.left == 0 {
            self.refill();
        }
        self.left -= 1;
        self.buffer[3 - self.left]
    }

    /// The next two numbers, well distributed together.
    #[inline]
    pub fn next_2d(&mut self) -> Vec2 {
        if self.left < 2 {
            self.refill();
        }
        self.left -= 2;
        Vec2::new(self.buffer[2 - self.left], self.buffer[3 - self.left])
    }

    /// A number for numbering derived sequences.
    #[inline]
    pub fn next_u64(&mut self) -> u64 {
        self.rng.next_u64()
    }

    fn refill(&mut self) {
        self.left = 4;
        if self.sequence == Sequence::Sobol && self.set < SOBOL_SETS {
            let seed = self.seed ^ self.set.wrapping_mul(0x9e37_79b9);
            self.buffer = sobol_burley::sample_4d(self.index, 0, seed);
            self.set += 1;
        } else {
            self.buffer = std::array::from_fn(|_| (self.rng.next_u32() >> 8) as f32 / 16_777_216.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Stream;

    #[test]
    fn first_values_are_part_of_the_contract() {
        let key = Key::new(1, 2, Stream::GlobalPhotons);
        for sequence in [Sequence::Independent, Sequence::Sobol] {
            let mut a = Sampler::new(sequence, key, 77);
            let mut b = Sampler::new(sequence, key, 77);
            for _ in 0..100 {
                let (x, y) = (a.next_1d(), b.next_1d());
                assert_eq!(x, y);
                assert!((0.0..1.0).contains(&x));
            }
        }
        let mut s = Sampler::new(Sequence::Independent, key, 0);
        assert_eq!(s.next_1d(), 0.024_380_803);
    }

    #[test]
    fn sobol_samples_stratify_every_pair() {
        let key = Key::new(0, 0, Stream::Camera);
        for pair in 0..4 {
            let mut cells = [0; 64];
            for i in 0..64 {
                let mut s = Sampler::new(Sequence::Sobol, key, i);
                for _ in 0..pair {
                    s.next_2d();
                }
                let u = s.next_2d();
                cells[(u.x * 8.0) as usize * 8 + (u.y * 8.0) as usize] += 1;
            }
            assert!(cells.iter().all(|&n| n == 1), "pair {pair}: {cells:?}");
        }
    }

    #[test]
    fn independent_numbers_have_the_moments_of_the_uniform_distribution() {
        let key = Key::new(3, 0, Stream::Camera);
        let n = 200_000;
        let (mut sum, mut squares, mut product) = (0.0f64, 0.0f64, 0.0f64);
        for i in 0..n {
            let mut s = Sampler::new(Sequence::Independent, key, i);
            let (x, y) = (f64::from(s.next_1d()), f64::from(s.next_1d()));
            sum += x;
            squares += x * x;
            product += x * y;
        }
        let n = n as f64;
        // Five standard errors of each mean: false positives below 2e-6.
        assert!((sum / n - 0.5).abs() < 5.0 * (1.0 / 12.0 / n).sqrt());
        assert!((squares / n - 1.0 / 3.0).abs() < 5.0 * (4.0 / 45.0 / n).sqrt());
        assert!((product / n - 0.25).abs() < 5.0 * (7.0 / 144.0 / n).sqrt());
    }
}
