//! What a scene says of rough boundaries.

use crate::handle::Handle;
use crate::texture::Texture;

/// How the slopes of a rough boundary's facets are distributed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Distribution {
    /// Trowbridge and Reitz (1975), known as GGX by Walter et al. (2007): long tails, as of most real surfaces.
    #[default]
    Ggx,
    /// Gauss's distribution of slopes (Beckmann and Spizzichino 1963): short tails.
    Beckmann,
}

/// How rough a boundary is.
///
/// α is √2 times the standard deviation of a Gaussian surface's slopes, and what GGX calls by that name. Textures of
/// scalars count by the mean of their channels. Values below 10⁻⁴ count as that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// The distribution of slopes.
    pub distribution: Distribution,
    /// α along the first tangent, in [0, 1].
    pub alpha_u: Handle<Texture>,
    /// α along the second tangent, in [0, 1].
    pub alpha_v: Handle<Texture>,
}

impl Roughness {
    /// The same in all directions.
    pub fn isotropic(distribution: Distribution, alpha: Handle<Texture>) -> Self {
        Self { distribution, alpha_u: alpha, alpha_v: alpha }
    }
}
