/// What a sequence of numbers is for; keeps the purposes independent of one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Stream {
    /// Camera paths.
    Camera = 1,
    /// Photon paths that fill the global map.
    GlobalPhotons = 2,
    /// Photon paths that fill the caustic map.
    CausticPhotons = 3,
    /// Trial photon paths that count how many photons a path stores, and other trials before a render: of what
    /// lights send where, of what media give off, of what cameras and lamps are in.
    Pilot = 4,
    /// Whether a ray meets a masked surface.
    Masks = 5,
    /// Rounding of what a photon map keeps of a photon.
    Rounding = 6,
    /// Photon paths that fill the map of light in media.
    VolumePhotons = 7,
    /// Photon paths that fill the map of caustics in media.
    VolumeCausticPhotons = 8,
    /// Light paths that are connected to the camera.
    LightPaths = 9,
}

/// A 64-bit hash of what identifies a sequence: (seed, iteration, stream, path, …).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key(u64);

impl Key {
    /// The key of one stream of one iteration.
    pub const fn new(seed: u64, iteration: u64, stream: Stream) -> Self {
        Self(mix(seed)).with(iteration).with(stream as u64)
    }

    /// Adds a number to what is identified: a path, a pixel, a purpose.
    #[inline]
    #[must_use]
    pub const fn with(self, value: u64) -> Self {
        Self(mix(self.0 ^ mix(value.wrapping_add(0x9e37_79b9_7f4a_7c15))))
    }

    /// The hash.
    #[inline]
    pub fn hash(self) -> u64 {
        self.0
    }
}

/// A bijection of 64-bit numbers that changes half of the bits for each bit of its argument:
/// multiply and xor-shift with the constants of Stafford's variant 13, as in SplitMix64
/// (Steele, Lea and Flood 2014, doi 10.1145/2660193.2660195).
#[inline]
const fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn neighbouring_keys_differ() {
        let mut seen = HashSet::new();
        for seed in 0..4 {
            for iteration in 0..4 {
                for stream in [Stream::Camera, Stream::GlobalPhotons, Stream::CausticPhotons] {
                    for path in 0..64 {
                        assert!(seen.insert(Key::new(seed, iteration, stream).with(path).hash()));
                    }
                }
            }
        }
    }

    #[test]
    fn keys_are_part_of_the_contract() {
        assert_eq!(Key::new(0, 0, Stream::Camera).with(0).hash(), 8_129_072_725_407_301_052);
    }
}
