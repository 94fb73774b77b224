//! Eight floats at a time.
//!
//! [`Simd::run`] does a piece of [`Work`] with the widest instructions that the machine has. Both ways
//! round alike, operation by operation, and nothing is fused: they give the same bits.

/// How many floats are worked on at a time.
pub(crate) const LANES: usize = 8;

/// Eight floats, each its own lane. A comparison gives bit `i` for lane `i`.
pub(crate) trait Lanes: Copy {
    fn load(from: &[f32; LANES]) -> Self;
    fn store(self) -> [f32; LANES];
    fn splat(value: f32) -> Self;
    fn plus(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    fn over(self, other: Self) -> Self;
    /// `other` where `self` is not a number.
    fn larger(self, other: Self) -> Self;
    /// `other` where `self` is not a number.
    fn smaller(self, other: Self) -> Self;
    fn abs(self) -> Self;
    fn lt(self, other: Self) -> u32;
    fn le(self, other: Self) -> u32;
    fn eq(self, other: Self) -> u32;
    /// All bits of a lane where `self` is at most `other`, and none elsewhere.
    fn mask_le(self, other: Self) -> Self;
    /// The bits that both have.
    fn and(self, other: Self) -> Self;
    /// Floats whose exponents are the highest byte of each word less `less`; any number if that is negative.
    fn from_exponent(words: &[u32; LANES], less: u32) -> Self;
    /// A byte of each word, as a number.
    fn from_byte<const BYTE: i32>(words: &[u32; LANES]) -> Self;
    /// Has something brought from memory that will be asked for soon, and does not wait for it.
    fn prefetch<T>(what: &T);
}

/// Something to be done with either kind of lanes.
///
/// What handles lanes, in `run` and below, must be functions that are `inline(always)`, and no closures: else
/// it is compiled without the instructions that were asked for.
pub(crate) trait Work {
    type Output;
    fn run<L: Lanes>(self) -> Self::Output;
}

/// Which instructions to use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Simd {
    /// What the compiler makes of plain loops.
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Detected),
}

impl Simd {
    /// The best that this machine has.
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(detected) = avx2::detect() {
            return Self::Avx2(detected);
        }
        Self::Portable
    }

    #[inline]
    pub fn run<W: Work>(self, work: W) -> W::Output {
        match self {
            Self::Portable => work.run::<[f32; LANES]>(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(detected) => avx2::run(detected, work),
        }
    }
}

#[inline(always)]
fn each(f: impl Fn(usize) -> f32) -> [f32; LANES] {
    let mut out = [0.0; LANES];
    for (i, x) in out.iter_mut().enumerate() {
        *x = f(i);
    }
    out
}

#[inline(always)]
fn bits(f: impl Fn(usize) -> bool) -> u32 {
    let mut mask = 0;
    for i in 0..LANES {
        mask |= u32::from(f(i)) << i;
    }
    mask
}

/// One number in all lanes, for each of three.
#[inline(always)]
pub(crate) fn splat3<L: Lanes>([x, y, z]: [f32; 3]) -> [L; 3] {
    [L::splat(x), L::splat(y), L::splat(z)]
}

impl Lanes for [f32; LANES] {
    #[inline(always)]
    fn load(from: &[f32; LANES]) -> Self {
        *from
    }
    #[inline(always)]
    fn store(self) -> [f32; LANES] {
        self
    }
    #[inline(always)]
    fn splat(value: f32) -> Self {
        [value; LANES]
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        each(|i| self[i] + other[i])
    }
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        each(|i| self[i] - other[i])
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        each(|i| self[i] * other[i])
    }
    #[inline(always)]
    fn over(self, other: Self) -> Self {
        each(|i| self[i] / other[i])
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        each(|i| if self[i] > other[i] { self[i] } else { other[i] })
    }
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        each(|i| if self[i] < other[i] { self[i] } else { other[i] })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        each(|i| self[i].abs())
    }
    #[inline(always)]
    fn lt(self, other: Self) -> u32 {
        bits(|i| self[i] < other[i])
    }
    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        bits(|i| self[i] <= other[i])
    }
    #[inline(always)]
    fn eq(self, other: Self) -> u32 {
        bits(|i| self[i] == other[i])
    }
    #[inline(always)]
    fn mask_le(self, other: Self) -> Self {
        each(|i| f32::from_bits(if self[i] <= other[i] { u32::MAX } else { 0 }))
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        each(|i| f32::from_bits(self[i].to_bits() & other[i].to_bits()))
    }
    #[inline(always)]
    fn from_exponent(words: &[u32; LANES], less: u32) -> Self {
        each(|i| f32::from_bits((words[i] >> 24 << 23).wrapping_sub(less << 23)))
    }
    #[inline(always)]
    fn from_byte<const BYTE: i32>(words: &[u32; LANES]) -> Self {
        each(|i| f32::from((words[i] >> (8 * BYTE)) as u8))
    }
    #[inline(always)]
    fn prefetch<T>(_: &T) {}
}

/// The default build is for every x86-64, and users do not pass
/// `target-cpu`.
#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "AVX2 where the machine has it")]
mod avx2 {
    use std::arch::x86_64::*;

    use super::{LANES, Lanes, Work};

    const CACHE_LINE: usize = 64;

    /// Proof that the machine has AVX2 and can count bits, which all that have the one do: only [`detect`]
    /// makes it.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) struct Detected(());

    pub(super) fn detect() -> Option<Detected> {
        let bits = is_x86_feature_detected!("popcnt")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2");
        (bits && is_x86_feature_detected!("avx2")).then_some(Detected(()))
    }

    #[inline]
    pub(super) fn run<W: Work>(_: Detected, work: W) -> W::Output {
        // SAFETY: `Detected` exists, so the machine has all that is enabled.
        unsafe { with_avx2(work) }
    }

    #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
    fn with_avx2<W: Work>(work: W) -> W::Output {
        work.run::<Eight>()
    }

    /// Private to this module, and used by [`with_avx2`] alone.
    #[derive(Clone, Copy)]
    struct Eight(__m256);

    macro_rules! lanewise {
        ($($name:ident: $instruction:ident),*) => {$(
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                // SAFETY: `Eight` is used under `with_avx2` only.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        )*};
    }

    macro_rules! compare {
        ($($name:ident: $predicate:ident),*) => {$(
            #[inline(always)]
            fn $name(self, other: Self) -> u32 {
                // SAFETY: `Eight` is used under `with_avx2` only.
                unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<$predicate>(self.0, other.0)) as u32 }
            }
        )*};
    }

    impl Lanes for Eight {
        #[inline(always)]
        fn load(from: &[f32; LANES]) -> Self {
            // SAFETY: eight floats lie there, and no alignment is asked for.
            Self(unsafe { _mm256_loadu_ps(from.as_ptr()) })
        }
        #[inline(always)]
        fn store(self) -> [f32; LANES] {
            let mut to = [0.0; LANES];
            // SAFETY: there is room for eight floats, and no alignment is asked for.
            unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) };
            to
        }
        #[inline(always)]
        fn splat(value: f32) -> Self {
            // SAFETY: `Eight` is used under `with_avx2` only.
            Self(unsafe { _mm256_set1_ps(value) })
        }
        #[inline(always)]
        fn abs(self) -> Self {
            // SAFETY: `Eight` is used under `with_avx2` only.
            Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
        }
        #[inline(always)]
        fn mask_le(self, other: Self) -> Self {
            // SAFETY: `Eight` is used under `with_avx2` only.
            Self(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) })
        }
        #[inline(always)]
        fn from_exponent(words: &[u32; LANES], less: u32) -> Self {
            // SAFETY: eight words lie there, no alignment is asked for, and `Eight` is used under
            // `with_avx2` only.
            Self(unsafe {
                let words = _mm256_loadu_si256(words.as_ptr().cast());
                let exponents = _mm256_slli_epi32::<23>(_mm256_srli_epi32::<24>(words));
                _mm256_castsi256_ps(_mm256_sub_epi32(exponents, _mm256_set1_epi32((less << 23) as i32)))
            })
        }
        #[inline(always)]
        fn from_byte<const BYTE: i32>(words: &[u32; LANES]) -> Self {
            // SAFETY: as above.
            Self(unsafe {
                let words = _mm256_loadu_si256(words.as_ptr().cast());
                let shifted = match BYTE {
                    0 => words,
                    1 => _mm256_srli_epi32::<8>(words),
                    2 => _mm256_srli_epi32::<16>(words),
                    _ => _mm256_srli_epi32::<24>(words),
                };
                _mm256_cvtepi32_ps(_mm256_and_si256(shifted, _mm256_set1_epi32(0xff)))
            })
        }
        // The instructions for the larger and the smaller give the second where either is not a number.
        lanewise!(
            plus: _mm256_add_ps, minus: _mm256_sub_ps, times: _mm256_mul_ps, over: _mm256_div_ps,
            larger: _mm256_max_ps, smaller: _mm256_min_ps, and: _mm256_and_ps
        );
        compare!(lt: _CMP_LT_OQ, le: _CMP_LE_OQ, eq: _CMP_EQ_OQ);
        #[inline(always)]
        fn prefetch<T>(what: &T) {
            let start = std::ptr::from_ref(what).cast::<i8>();
            for at in (0..size_of::<T>()).step_by(CACHE_LINE) {
                // SAFETY: nothing is read, so any address will do.
                unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(at)) };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation on every pair of awkward numbers.
    struct All;

    impl Work for All {
        type Output = Vec<u32>;
        #[inline(always)]
        fn run<L: Lanes>(self) -> Vec<u32> {
            let values = [0.0, -0.0, 1.5, -3.25e-39, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.0 / 3.0];
            let mut out = Vec::new();
            for turn in 0..LANES {
                let a = L::load(&values);
                let b = L::load(&each(|i| values[(i + turn) % LANES]));
                let numbers = [
                    a.plus(b),
                    a.minus(b),
                    a.times(b),
                    a.over(b),
                    a.larger(b),
                    a.smaller(b),
                    a.abs(),
                    a.and(b),
                ];
                // Which NaN comes of two is not said.
                let plain = |x: f32| if x.is_nan() { f32::NAN.to_bits() } else { x.to_bits() };
                out.extend(numbers.iter().flat_map(|n| n.store()).map(plain));
                out.extend([a.lt(b), a.le(b), a.eq(b), a.lt(L::splat(0.5))]);
                out.extend(a.mask_le(b).store().map(f32::to_bits));
            }
            let words = std::array::from_fn(|i| 0x8000_ff01 + 0x0312_3456 * i as u32);
            let bytes = [L::from_byte::<0>(&words), L::from_byte::<1>(&words), L::from_byte::<2>(&words)];
            let numbers = [bytes[0], bytes[1], bytes[2], L::from_exponent(&words, 7)];
            out.extend(numbers.iter().flat_map(|n| n.store()).map(f32::to_bits));
            out
        }
    }

    #[test]
    fn both_ways_give_the_same_bits() {
        assert_eq!(Simd::detect().run(All), Simd::Portable.run(All));
    }
}
