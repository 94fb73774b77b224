use crate::color::Rgb;

/// Bounces after which survival is limited, so that light caught between perfect mirrors ends.
const FREE_BOUNCES: u32 = 64;

/// The survival of a path that has gone on for so long.
const LATE_SURVIVAL: f32 = 0.95;

/// Collisions in media that count as one bounce: light goes on for long in milk and clouds, and comes out of them.
const COLLISIONS_PER_BOUNCE: u32 = 16;

/// Bounces as roulette counts them, of which so many were collisions.
#[inline]
pub(crate) fn effort(bounces: u32, collisions: u32) -> u32 {
    bounces - collisions + collisions / COLLISIONS_PER_BOUNCE
}

/// The probability with which a path goes on after a bounce that changed what it carries from
/// `before` to `after`: the ratio of the largest channels, so that what survivors carry stays level.
/// Never 0 where a channel is left, and survivors are divided by it: no channel is biased
/// (Arvo and Kirk 1990).
#[inline]
pub(crate) fn survival(before: Rgb, after: Rgb, bounces: u32) -> f32 {
    let limit = if bounces >= FREE_BOUNCES { LATE_SURVIVAL } else { 1.0 };
    let ratio = after.max_channel() / before.max_channel();
    if ratio.is_nan() { limit } else { ratio.min(limit) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn survival_follows_the_largest_channel_and_is_never_certain_for_ever() {
        let before = Rgb::new(2.0, 1.0, 0.5);
        assert_eq!(survival(before, before * Rgb::new(0.1, 0.9, 0.2), 0), 0.45);
        assert_eq!(survival(before, before, 63), 1.0);
        assert_eq!(survival(before, before, 64), 0.95);
        assert!(survival(before, Rgb::new(0.0, 0.0, 1e-3), 5) > 0.0);
    }
}
