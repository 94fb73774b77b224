//! Media whose extinction is the same everywhere: closed forms.

use super::Passage;
use crate::color::Rgb;
use crate::math::real;
use crate::sampling::Sampler;

/// See [`Matter::travel`](super::Matter::travel). A channel is chosen by what it carries and decides how far
/// the light goes; all channels are weighted by the mean density of the three (Veach's balance heuristic for
/// one sample, as Pharr, Jakob and Humphreys 2016 have it in §15.2.1).
pub(super) fn travel(sigma_t: Rgb, t_max: f32, carried: Rgb, sampler: &mut Sampler) -> Passage {
    let is_grey = is_grey(sigma_t);
    let chosen = if is_grey { sigma_t.r } else { sigma_t[choose(carried, sampler.next_1d())] };
    // Where nothing stops it, it comes through for certain, however far that is.
    let t = if chosen > 0.0 { -real::ln(1.0 - sampler.next_1d()) / chosen } else { f32::INFINITY };
    let share = shares(carried);
    if t < t_max {
        let density = sigma_t * attenuation(sigma_t, t);
        let weight = if is_grey { Rgb::WHITE } else { over_mean(density, share) };
        Passage::Collision { t: t.max(0.0), weight }
    } else {
        let weight = if is_grey { Rgb::WHITE } else { over_mean(attenuation(sigma_t, t_max), share) };
        Passage::Through { weight }
    }
}

/// e^(−σt), and 1 where there is nothing even on an infinite way.
#[inline]
pub(super) fn attenuation(sigma_t: Rgb, t: f32) -> Rgb {
    transmittance(sigma_t.map(|sigma| if sigma > 0.0 { sigma * t } else { 0.0 }))
}

/// e^(−τ) of an optical depth τ.
#[inline]
pub(super) fn transmittance(depth: Rgb) -> Rgb {
    if is_grey(depth) { Rgb::splat(real::exp(-depth.r)) } else { depth.map(|depth| real::exp(-depth)) }
}

#[inline]
pub(super) fn is_grey(value: Rgb) -> bool {
    value.r == value.g && value.g == value.b
}

/// What each channel carries of the sum; alike if there is nothing to tell them apart.
#[inline]
pub(super) fn shares(carried: Rgb) -> Rgb {
    let sum = carried.sum();
    if sum > 0.0 && sum.is_finite() { carried / sum } else { Rgb::splat(1.0 / 3.0) }
}

/// A channel with the probability of its share, and never one that carries nothing.
fn choose(carried: Rgb, u: f32) -> usize {
    let share = shares(carried);
    // Rounding leaves the last a little more or less.
    if u < share.r || share.g + share.b == 0.0 {
        0
    } else if u < share.r + share.g || share.b == 0.0 {
        1
    } else {
        2
    }
}

fn over_mean(value: Rgb, share: Rgb) -> Rgb {
    sound(value / (share * value).sum())
}

/// Zero where a weight has no end, which only a channel that carries nothing, or next to nothing, comes to.
#[inline]
pub(super) fn sound(weight: Rgb) -> Rgb {
    weight.map(|w| if w.is_finite() { w } else { 0.0 })
}
