//! Textures of textures.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::texture::{Bitmap, Checkerboard, Texture};

use super::image::Change;
use super::reader::Reader;
use crate::diagnostic::Location;

/// Textures that one consists of, each counted as often as it is read.
const MAX_SIZE: u32 = 1000;

impl Reader<'_> {
    /// A texture of the scene, and where it stands in the file.
    pub(super) fn store_texture(&mut self, at: &Location, texture: Texture) -> Handle<Texture> {
        let size = 1 + texture.children().map(|child| self.size_of_texture(child)).sum::<u32>();
        let fits = size <= MAX_SIZE;
        if !fits {
            self.log.error(at, format!("the texture consists of more than {MAX_SIZE} others"));
        }
        self.texture_sizes.push(if fits { size } else { 1 });
        self.origins.textures.push(at.clone());
        self.textures.push(if fits { texture } else { Texture::Constant(Rgb::BLACK) })
    }

    fn size_of_texture(&self, texture: Handle<Texture>) -> u32 {
        self.texture_sizes.get(texture.index()).copied().unwrap_or(1)
    }

    /// The value of a texture that is the same everywhere.
    pub(super) fn constant(&self, texture: Handle<Texture>) -> Option<Rgb> {
        match self.textures.list[texture] {
            Texture::Constant(value) => Some(value),
            _ => None,
        }
    }

    /// `a`·`b`
    pub(super) fn product(
        &mut self,
        a: Handle<Texture>,
        b: Handle<Texture>,
        at: &Location,
    ) -> Handle<Texture> {
        match (self.constant(a), self.constant(b)) {
            (Some(x), Some(y)) => self.store_texture(at, Texture::Constant(x * y)),
            (Some(Rgb::WHITE), None) => b,
            (None, Some(Rgb::WHITE)) => a,
            _ => self.store_texture(at, Texture::Scale { a, b }),
        }
    }

    /// `a` where the weight is 0, `b` where it is 1.
    pub(super) fn mixture(
        &mut self,
        weight: Handle<Texture>,
        a: Handle<Texture>,
        b: Handle<Texture>,
        at: &Location,
    ) -> Handle<Texture> {
        match (self.constant(weight), self.constant(a), self.constant(b)) {
            (Some(w), Some(x), Some(y)) => {
                self.store_texture(at, Texture::Constant(x * (Rgb::WHITE - w) + y * w))
            }
            _ => self.store_texture(at, Texture::Mix { weight, a, b }),
        }
    }

    /// The root of a texture of numbers; of a mixture, the mixture of roots.
    pub(super) fn root(&mut self, texture: Handle<Texture>, at: &Location) -> Handle<Texture> {
        let root = match self.textures.list[texture].clone() {
            Texture::Constant(value) => Texture::Constant(value.map(|v| v.max(0.0).sqrt())),
            Texture::Bitmap(bitmap) => {
                let change = Change { root: true, ..Change::decoded(true) };
                let image = change.applied(&self.textures.images[bitmap.image]);
                let image = self.store_image(image, at);
                Texture::Bitmap(Bitmap { image, ..bitmap })
            }
            Texture::Checkerboard(board) => {
                let [color0, color1] = [board.color0, board.color1].map(|child| self.root(child, at));
                Texture::Checkerboard(Checkerboard { color0, color1, ..board })
            }
            Texture::Scale { a, b } => {
                let [a, b] = [a, b].map(|child| self.root(child, at));
                Texture::Scale { a, b }
            }
            Texture::Mix { weight, a, b } => {
                let [a, b] = [a, b].map(|child| self.root(child, at));
                Texture::Mix { weight, a, b }
            }
            other => other,
        };
        self.store_texture(at, root)
    }
}
