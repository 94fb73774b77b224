//! Textures: a colour for each point of a surface's parameter square.

mod checkerboard;
mod image;

pub use checkerboard::Checkerboard;
pub use image::{Bitmap, BitmapFilter, Image, Wrap};

use crate::color::Rgb;
use crate::handle::{Arena, Handle};
use crate::math::Vec2;

/// A colour that may vary over a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(Rgb),
    /// An image.
    Bitmap(Bitmap),
    /// Two alternating textures.
    Checkerboard(Checkerboard),
}

/// The textures of a scene and the images they show.
///
/// A texture refers only to textures stored before it, so looking one up always ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Textures {
    /// Every texture.
    pub list: Arena<Texture>,
    /// Every image.
    pub images: Arena<Image>,
}

impl Textures {
    /// Stores a texture.
    pub fn push(&mut self, texture: Texture) -> Handle<Texture> {
        self.list.push(texture)
    }

    /// Stores a constant.
    pub fn constant(&mut self, value: Rgb) -> Handle<Texture> {
        self.list.push(Texture::Constant(value))
    }

    /// The value at `uv`.
    pub fn eval(&self, texture: Handle<Texture>, uv: Vec2) -> Rgb {
        match &self.list[texture] {
            Texture::Constant(value) => *value,
            Texture::Bitmap(bitmap) => bitmap.eval(&self.images[bitmap.image], uv),
            Texture::Checkerboard(board) => self.eval(board.child(uv), uv),
        }
    }

    /// The mean over the parameter square, exact for constants and whole images.
    pub fn mean(&self, texture: Handle<Texture>) -> Rgb {
        match &self.list[texture] {
            Texture::Constant(value) => *value,
            Texture::Bitmap(bitmap) => self.images[bitmap.image].mean(),
            Texture::Checkerboard(board) => (self.mean(board.color0) + self.mean(board.color1)) * 0.5,
        }
    }

    /// A bound on the values of all channels, which a constant and the pixels of an image reach.
    pub fn brightest(&self, texture: Handle<Texture>) -> f32 {
        match &self.list[texture] {
            Texture::Constant(value) => value.max_channel(),
            Texture::Bitmap(bitmap) => self.images[bitmap.image].brightest(),
            Texture::Checkerboard(board) => self.brightest(board.color0).max(self.brightest(board.color1)),
        }
    }
}
