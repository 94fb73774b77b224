use crate::math::{Frame, Vec3};
use crate::texture::TexturePoint;

/// What a material needs to know of the place where a ray meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The unit normal of the geometry, pointing to the outer side.
    pub ng: Vec3,
    /// The shading frame: its normal lies in the hemisphere of `ng`.
    pub frame: Frame,
    /// Where textures are read.
    pub at: TexturePoint,
}

impl Surface {
    /// A surface shaded with its own normal.
    #[inline]
    pub fn flat(ng: Vec3, at: impl Into<TexturePoint>) -> Self {
        Self { ng, frame: Frame::from_normal(ng), at: at.into() }
    }

    /// The same place with its outer side inside. The frame stays right-handed.
    #[inline]
    pub fn flipped(&self) -> Self {
        let Frame { s, t, n } = self.frame;
        Self { ng: -self.ng, frame: Frame { s, t: -t, n: -n }, at: self.at }
    }
}
