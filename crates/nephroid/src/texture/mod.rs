//! Textures: a colour for each point of a surface.

mod bitmap;
mod checkerboard;
mod image;
mod list;
mod pixmap;
mod point;

pub use bitmap::{Bitmap, BitmapFilter, Wrap};
pub use checkerboard::Checkerboard;
pub use image::Image;
pub use list::Textures;
pub use pixmap::{Decoding, Pixels, Pixmap, Plane};
pub use point::TexturePoint;

use crate::color::Rgb;
use crate::handle::Handle;

/// A colour that may vary over a surface, and its opacity, which only [`Texture::Channel`] reads.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere. Opaque.
    Constant(Rgb),
    /// An image.
    Bitmap(Bitmap),
    /// Two alternating textures.
    Checkerboard(Checkerboard),
    /// The colour that a mesh has at its vertices; white on what has none. Opaque.
    VertexColor,
    /// The product of two textures, opacities too.
    Scale {
        /// One factor.
        a: Handle<Self>,
        /// The other.
        b: Handle<Self>,
    },
    /// `a`·(1 − weight) + `b`·weight in each channel; opacities by the mean of the weight's channels.
    Mix {
        /// The share of `b`.
        weight: Handle<Self>,
        /// What is shown where the weight is 0.
        a: Handle<Self>,
        /// What is shown where the weight is 1.
        b: Handle<Self>,
    },
    /// One channel of a texture, in all channels. Opaque.
    Channel {
        /// Which texture.
        of: Handle<Self>,
        /// Red, green, blue, opacity: 0 to 3.
        channel: u8,
    },
}

impl Texture {
    /// The textures that it refers to.
    pub fn children(&self) -> impl Iterator<Item = Handle<Self>> {
        let children = match *self {
            Self::Constant(_) | Self::Bitmap(_) | Self::VertexColor => [None; 3],
            Self::Checkerboard(Checkerboard { color0: a, color1: b, .. }) | Self::Scale { a, b } => {
                [Some(a), Some(b), None]
            }
            Self::Mix { weight, a, b } => [Some(weight), Some(a), Some(b)],
            Self::Channel { of, .. } => [Some(of), None, None],
        };
        children.into_iter().flatten()
    }
}
