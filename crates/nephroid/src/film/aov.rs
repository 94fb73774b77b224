//! Further values of a picture beside its light: what they are called and how they are counted.

use crate::color::Rgb;

/// A value that a render can keep for each pixel beside the light that arrives there.
///
/// All are filtered as the picture is. Those of the light, the albedo and the normal are means over all
/// samples of a pixel, of which one that sees nothing counts as zero; the others are means over the
/// samples that have them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Aov {
    /// Light that met one surface that is not specular, and came straight to it, in W/(m²·sr).
    Direct,
    /// All light that is in none of the other parts, in W/(m²·sr).
    Global,
    /// Light that came to such a surface by specular ones, in W/(m²·sr).
    Caustic,
    /// Lamps and sky, seen directly or through specular surfaces, in W/(m²·sr).
    Emitted,
    /// Light from media, directly or by specular surfaces, in W/(m²·sr).
    Medium,
    /// What the first surface reflects of white light, in [0, 1]. Dirac surfaces are followed, and
    /// dim it as they dim light.
    Albedo,
    /// The unit shading normal of that surface in world space, on the side it is seen from; shorter
    /// where a pixel sees several.
    Normal,
    /// Distance from the ray's origin to the first surface of any kind, in scene units.
    Depth,
    /// The place of that surface in world space.
    Position,
    /// The unit geometric normal of that surface in world space, on the side it is seen from.
    GeometricNormal,
    /// Texture coordinates of that surface.
    Uv,
    /// Radius of the estimates from the global and the caustic map on surfaces that the camera sees.
    Radius,
    /// Photons that counted in each of them.
    Count,
}

/// Which samples a value is the mean of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Over {
    /// All of them, with the weight of the filter.
    Samples,
    /// Those whose ray meets a surface.
    Hits,
    /// The estimates they made from a photon map.
    LookUps,
}

/// Single-precision numbers of all values together.
pub(super) const NUMBERS: usize = 32;

impl Aov {
    /// Every one of them.
    pub const ALL: [Self; 13] = [
        Self::Direct,
        Self::Global,
        Self::Caustic,
        Self::Emitted,
        Self::Medium,
        Self::Albedo,
        Self::Normal,
        Self::Depth,
        Self::Position,
        Self::GeometricNormal,
        Self::Uv,
        Self::Radius,
        Self::Count,
    ];

    /// What the command line and the layers of files call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Global => "global",
            Self::Caustic => "caustic",
            Self::Emitted => "emitted",
            Self::Medium => "medium",
            Self::Albedo => "albedo",
            Self::Normal => "normal",
            Self::Depth => "depth",
            Self::Position => "position",
            Self::GeometricNormal => "geo_normal",
            Self::Uv => "uv",
            Self::Radius => "radius",
            Self::Count => "count",
        }
    }

    /// The value of that name.
    pub fn parse(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|aov| aov.name() == name)
    }

    /// The channels of its layer in OpenEXR files.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Direct | Self::Global | Self::Caustic | Self::Emitted | Self::Medium | Self::Albedo => {
                &["R", "G", "B"]
            }
            Self::Normal | Self::Position | Self::GeometricNormal => &["X", "Y", "Z"],
            Self::Uv => &["U", "V"],
            Self::Depth => &["Z"],
            Self::Radius | Self::Count => &["Y"],
        }
    }

    /// Whether it tells of estimates from photon maps, which path tracing does not make.
    pub fn is_of_photons(self) -> bool {
        matches!(self, Self::Radius | Self::Count)
    }

    /// Whether it is in W/(m²·sr).
    pub(super) fn is_light(self) -> bool {
        matches!(self, Self::Direct | Self::Global | Self::Caustic | Self::Emitted | Self::Medium)
    }

    /// Where its numbers begin among those of all.
    pub(super) fn start(self) -> usize {
        Self::ALL.iter().take_while(|other| **other != self).map(|other| other.channels().len()).sum()
    }

    pub(super) fn over(self) -> Over {
        match self {
            Self::Direct
            | Self::Global
            | Self::Caustic
            | Self::Emitted
            | Self::Medium
            | Self::Albedo
            | Self::Normal => Over::Samples,
            Self::Depth | Self::Position | Self::GeometricNormal | Self::Uv => Over::Hits,
            Self::Radius | Self::Count => Over::LookUps,
        }
    }
}

/// The values of one camera sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AovSample {
    numbers: [f32; NUMBERS],
    /// Whether its ray meets a surface.
    pub hit: bool,
    /// Estimates it made from photon maps, whose radii and counts it has the sums of.
    pub look_ups: u32,
}

impl Default for AovSample {
    fn default() -> Self {
        Self { numbers: [0.0; NUMBERS], hit: false, look_ups: 0 }
    }
}

impl AovSample {
    /// One that has the parts of the light and nothing else.
    pub fn of_light(parts: [(Aov, Rgb); 5]) -> Self {
        let mut sample = Self::default();
        sample.add_light(parts);
        sample
    }

    /// Adds to the parts of the light.
    pub fn add_light(&mut self, parts: [(Aov, Rgb); 5]) {
        for (aov, light) in parts {
            self.add(aov, &light.to_array());
        }
    }

    /// Adds to a value; `numbers` are as many as it has channels.
    pub fn add(&mut self, aov: Aov, numbers: &[f32]) {
        for (sum, v) in self.numbers[aov.start()..].iter_mut().zip(numbers) {
            *sum += v;
        }
    }

    /// The numbers of a value.
    pub fn get(&self, aov: Aov) -> &[f32] {
        &self.numbers[aov.start()..][..aov.channels().len()]
    }

    pub(super) fn numbers(&self) -> &[f32; NUMBERS] {
        &self.numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_numbers_and_names_of_their_own() {
        let mut end = 0;
        for aov in Aov::ALL {
            assert_eq!((aov.start(), Aov::parse(aov.name())), (end, Some(aov)));
            end += aov.channels().len();
        }
        assert_eq!((end, Aov::parse("colour")), (NUMBERS, None));
    }
}
