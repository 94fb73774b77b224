//! Textures: images as materials refer to them, with factors and channels.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::math::real::sin_cos;
use nephroid::math::{Affine2, Vec2};
use nephroid::texture::{Bitmap, BitmapFilter, Texture, Wrap};

use super::image::Purpose;
use super::item::Item;
use super::reader::Reader;

/// A part of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// Its colours.
    Colors,
    /// Its numbers, three in each place.
    Numbers,
    /// One channel of its numbers.
    Red,
    Green,
    Blue,
    Alpha,
}

impl<'d> Reader<'d> {
    /// A constant, stored once.
    pub(super) fn constant(&mut self, at: Item<'d>, value: Rgb) -> Handle<Texture> {
        let key = value.to_array().map(f32::to_bits);
        if let Some(known) = self.constant_of.get(&key) {
            return *known;
        }
        let handle = self.store_texture(at, Texture::Constant(value));
        self.constant_of.insert(key, handle);
        handle
    }

    /// The product of a factor and, if it is there, a part of the texture that a member of `owner` refers to.
    pub(super) fn product(
        &mut self,
        owner: Item<'d>,
        factor: impl Into<Rgb>,
        name: &str,
        part: Part,
    ) -> Handle<Texture> {
        let factor = factor.into();
        let texture = if factor.is_black() { None } else { self.part(owner, name, part) };
        match texture {
            Some(texture) => self.times(owner, texture, factor),
            None => self.constant(owner, factor),
        }
    }

    /// A texture times a constant.
    pub(super) fn times(&mut self, at: Item<'d>, texture: Handle<Texture>, factor: Rgb) -> Handle<Texture> {
        if factor == Rgb::WHITE {
            return texture;
        }
        let a = self.constant(at, factor);
        self.store_texture(at, Texture::Scale { a, b: texture })
    }

    /// A part of the texture that a member of `owner` refers to, if there is one.
    pub(super) fn part(&mut self, owner: Item<'d>, name: &str, part: Part) -> Option<Handle<Texture>> {
        let info = owner.object(name)?;
        let purpose = if part == Part::Colors { Purpose::Color } else { Purpose::Raw };
        let of = self.bitmap(info, purpose)?;
        let channel = match part {
            Part::Colors | Part::Numbers => return Some(of),
            Part::Red => 0,
            Part::Green => 1,
            Part::Blue => 2,
            Part::Alpha => 3,
        };
        Some(self.store_texture(info, Texture::Channel { of, channel }))
    }

    /// The image that a reference to a texture shows, as it shows it. `None` if there is none, or the log says why.
    pub(super) fn bitmap(&mut self, info: Item<'d>, purpose: Purpose) -> Option<Handle<Texture>> {
        let Some((_, texture)) = info.refers("index", "textures") else {
            if !info.has("index") {
                info.error("the reference to a texture has no \"index\"");
            }
            return None;
        };
        let image = self.image(texture, purpose)?;
        let (filter, wrap) = self.sampler(texture);
        let bitmap = Bitmap { image, filter, wrap, to_uv: to_uv(info) };
        Some(self.store_texture(info, Texture::Bitmap(bitmap)))
    }

    /// How an image is read between its pixels and outside of it (OpenGL's numbers).
    fn sampler(&mut self, texture: Item<'d>) -> (BitmapFilter, Wrap) {
        let Some((_, sampler)) = texture.refers("sampler", "samplers") else {
            return (BitmapFilter::Bilinear, Wrap::Repeat);
        };
        let filter = match sampler.whole("magFilter") {
            Some(9728) => BitmapFilter::Nearest,
            _ => BitmapFilter::Bilinear,
        };
        let wrap = |name: &str| match sampler.whole(name) {
            Some(33_071) => Wrap::Clamp,
            Some(33_648) => Wrap::Mirror,
            _ => Wrap::Repeat,
        };
        let (s, t) = (wrap("wrapS"), wrap("wrapT"));
        if s != t {
            self.once(sampler, "\"wrapT\" is taken to be as \"wrapS\": both directions are wrapped alike");
        }
        (filter, s)
    }
}

/// `KHR_texture_transform`: first stretched, then turned, then moved. Turning is clockwise in the usual axes, which is
/// counter-clockwise where v points down, as in the extension's example.
fn to_uv(info: Item) -> Affine2 {
    let Some(extension) = info.extension("KHR_texture_transform") else { return Affine2::IDENTITY };
    let pair = |name: &str, default: f64| {
        let [x, y] = extension.vector::<2>(name).unwrap_or([default; 2]);
        Vec2::new(x as f32, y as f32)
    };
    let (offset, scale) = (pair("offset", 0.0), pair("scale", 1.0));
    let (sin, cos) = sin_cos(extension.number("rotation").unwrap_or(0.0) as f32);
    let mut out = Affine2::IDENTITY;
    out.matrix2.x_axis = Vec2::new(cos, -sin) * scale.x;
    out.matrix2.y_axis = Vec2::new(sin, cos) * scale.y;
    out.translation = offset;
    out
}

/// The set of texture coordinates that a reference to a texture uses.
pub(super) fn uv_set(info: Item) -> usize {
    let moved = info.extension("KHR_texture_transform").and_then(|extension| extension.whole("texCoord"));
    moved.or_else(|| info.whole("texCoord")).unwrap_or(0)
}
