use crate::color::Rgb;
use crate::math::Vec2;

/// Where textures are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TexturePoint {
    /// Texture coordinates.
    pub uv: Vec2,
    /// The colour that the mesh has there, interpolated between its vertices; white if it has none.
    pub color: Rgb,
}

/// A place without a colour of its own.
impl From<Vec2> for TexturePoint {
    #[inline]
    fn from(uv: Vec2) -> Self {
        Self { uv, color: Rgb::WHITE }
    }
}
