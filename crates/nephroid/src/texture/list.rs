use super::{Pixmap, Texture, TexturePoint};
use crate::color::Rgb;
use crate::handle::{Arena, Handle};

/// The textures of a scene and the images they show.
///
/// A texture refers only to textures stored before it, so looking one up always ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Textures {
    /// Every texture.
    pub list: Arena<Texture>,
    /// Every image.
    pub images: Arena<Pixmap>,
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

    /// The colour at a point.
    pub fn eval(&self, texture: Handle<Texture>, at: impl Into<TexturePoint>) -> Rgb {
        self.color(texture, &at.into())
    }

    fn color(&self, texture: Handle<Texture>, at: &TexturePoint) -> Rgb {
        match &self.list[texture] {
            Texture::Constant(value) => *value,
            Texture::Bitmap(bitmap) => bitmap.eval(&self.images[bitmap.image], at.uv),
            Texture::Checkerboard(board) => self.color(board.child(at.uv), at),
            Texture::VertexColor => at.color,
            Texture::Scale { a, b } => self.color(*a, at) * self.color(*b, at),
            Texture::Mix { weight, a, b } => {
                mixed(self.color(*weight, at), self.color(*a, at), self.color(*b, at))
            }
            Texture::Channel { of, channel: 3 } => Rgb::splat(self.alpha(*of, at)),
            Texture::Channel { of, channel } => Rgb::splat(channel_of(self.color(*of, at), *channel)),
        }
    }

    /// The opacity at a point.
    pub fn opacity(&self, texture: Handle<Texture>, at: impl Into<TexturePoint>) -> f32 {
        self.alpha(texture, &at.into())
    }

    fn alpha(&self, texture: Handle<Texture>, at: &TexturePoint) -> f32 {
        match &self.list[texture] {
            Texture::Constant(_) | Texture::VertexColor | Texture::Channel { .. } => 1.0,
            Texture::Bitmap(bitmap) => bitmap.opacity(&self.images[bitmap.image], at.uv),
            Texture::Checkerboard(board) => self.alpha(board.child(at.uv), at),
            Texture::Scale { a, b } => self.alpha(*a, at) * self.alpha(*b, at),
            Texture::Mix { weight, a, b } => {
                let weight = self.color(*weight, at).map(share).mean();
                self.alpha(*a, at) * (1.0 - weight) + self.alpha(*b, at) * weight
            }
        }
    }

    /// How the colour at a point changes with `u` and with `v`, by the rules of differentiation; a bitmap as if it were
    /// read bilinearly. Steps, opacities and the colours of vertices count as if they were level.
    pub fn gradient(&self, texture: Handle<Texture>, at: impl Into<TexturePoint>) -> [Rgb; 2] {
        self.slopes(texture, &at.into())
    }

    fn slopes(&self, texture: Handle<Texture>, at: &TexturePoint) -> [Rgb; 2] {
        match &self.list[texture] {
            Texture::Constant(_) | Texture::VertexColor | Texture::Channel { channel: 3, .. } => {
                [Rgb::BLACK; 2]
            }
            Texture::Bitmap(bitmap) => bitmap.gradient(&self.images[bitmap.image], at.uv),
            Texture::Checkerboard(board) => self.slopes(board.child(at.uv), at),
            Texture::Scale { a, b } => {
                let (value_a, value_b) = (self.color(*a, at), self.color(*b, at));
                let (a, b) = (self.slopes(*a, at), self.slopes(*b, at));
                [0, 1].map(|i| a[i] * value_b + value_a * b[i])
            }
            Texture::Mix { weight, a, b } => {
                let value = self.color(*weight, at);
                let apart = self.color(*b, at) - self.color(*a, at);
                let (weight, a, b) = (self.slopes(*weight, at), self.slopes(*a, at), self.slopes(*b, at));
                // Where the weight is cut off it does not change.
                let inside = value.map(|w| f32::from(w > 0.0 && w < 1.0));
                [0, 1].map(|i| mixed(value, a[i], b[i]) + weight[i] * inside * apart)
            }
            Texture::Channel { of, channel } => {
                self.slopes(*of, at).map(|slope| Rgb::splat(channel_of(slope, *channel)))
            }
        }
    }

    /// The mean over the parameter square, exact for constants, whole images and what is linear in them. Products
    /// and mixtures of two textures that vary together have another. Vertex colours count as half.
    pub fn mean(&self, texture: Handle<Texture>) -> Rgb {
        self.fold(texture, &|texture, of| match texture {
            Texture::Constant(value) => *value,
            Texture::Bitmap(bitmap) => self.images[bitmap.image].mean(),
            Texture::Checkerboard(board) => (of(board.color0) + of(board.color1)) * 0.5,
            Texture::VertexColor => Rgb::splat(0.5),
            Texture::Scale { a, b } => of(*a) * of(*b),
            Texture::Mix { weight, a, b } => mixed(of(*weight), of(*a), of(*b)),
            Texture::Channel { of, channel: 3 } => Rgb::splat(self.mean_opacity(*of)),
            Texture::Channel { of: whole, channel } => Rgb::splat(channel_of(of(*whole), *channel)),
        })
    }

    /// The mean opacity, exact where [`mean`](Self::mean) is.
    fn mean_opacity(&self, texture: Handle<Texture>) -> f32 {
        let alpha = self.fold(texture, &|texture, of| match texture {
            Texture::Constant(_) | Texture::VertexColor | Texture::Channel { .. } => Rgb::WHITE,
            Texture::Bitmap(bitmap) => Rgb::splat(self.images[bitmap.image].mean_opacity()),
            Texture::Checkerboard(board) => (of(board.color0) + of(board.color1)) * 0.5,
            Texture::Scale { a, b } => of(*a) * of(*b),
            Texture::Mix { a, b, .. } => (of(*a) + of(*b)) * 0.5,
        });
        alpha.r
    }

    /// A bound on the values of all channels, which a constant and the pixels of an image reach. Vertex colours count
    /// as 1. Of textures without negative values.
    pub fn brightest(&self, texture: Handle<Texture>) -> f32 {
        let bound = self.fold(texture, &|texture, of| match texture {
            Texture::Constant(value) => Rgb::splat(value.max_channel()),
            Texture::Bitmap(bitmap) => Rgb::splat(self.images[bitmap.image].brightest()),
            Texture::Checkerboard(board) => of(board.color0).zip(of(board.color1), f32::max),
            Texture::VertexColor => Rgb::WHITE,
            Texture::Scale { a, b } => of(*a) * of(*b),
            Texture::Mix { a, b, .. } => of(*a).zip(of(*b), f32::max),
            Texture::Channel { channel: 3, .. } => Rgb::WHITE,
            Texture::Channel { of: whole, .. } => of(*whole),
        });
        bound.r
    }

    /// Something of a texture from the same of those it refers to. Each is asked once, however often it is referred
    /// to, and in the order in which they are stored.
    fn fold(&self, texture: Handle<Texture>, value: &dyn Fn(&Texture, Below<'_>) -> Rgb) -> Rgb {
        let list: Vec<&Texture> = self.list.iter().take(texture.index() + 1).collect();
        let mut needed = vec![false; list.len()];
        needed[texture.index()] = true;
        for i in (0..list.len()).rev() {
            if needed[i] {
                list[i].children().for_each(|child| needed[child.index()] = true);
            }
        }
        let mut values = vec![Rgb::BLACK; list.len()];
        for i in (0..list.len()).filter(|&i| needed[i]) {
            values[i] = value(list[i], &|child| values[child.index()]);
        }
        values[texture.index()]
    }
}

/// What a fold found of the textures that one refers to.
type Below<'a> = &'a dyn Fn(Handle<Texture>) -> Rgb;

/// A weight, brought into [0, 1].
fn share(weight: f32) -> f32 {
    if weight > 0.0 { weight.min(1.0) } else { 0.0 }
}

fn mixed(weight: Rgb, a: Rgb, b: Rgb) -> Rgb {
    let weight = weight.map(share);
    a.zip(weight, |a, w| a * (1.0 - w)) + b * weight
}

fn channel_of(color: Rgb, channel: u8) -> f32 {
    match channel {
        0 => color.r,
        1 => color.g,
        _ => color.b,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Affine2, Vec2};
    use crate::texture::{Bitmap, BitmapFilter, Checkerboard, Image, Plane, Wrap};

    /// A bitmap of two pixels, (0.2, 0.4, 0.6) and (1, 0, 0.5), with opacities of 0.25 and 0.75.
    fn two_pixels(textures: &mut Textures) -> Handle<Texture> {
        let pixels = vec![Rgb::new(0.2, 0.4, 0.6), Rgb::new(1.0, 0.0, 0.5)];
        let image = Image { width: 2, height: 1, pixels };
        let alpha = Some(Plane::Linear(vec![0.25, 0.75]));
        let image = textures.images.push(Pixmap { alpha, ..image.into() });
        let (filter, wrap, to_uv) = (BitmapFilter::Nearest, Wrap::Repeat, Affine2::IDENTITY);
        textures.push(Texture::Bitmap(Bitmap { image, filter, wrap, to_uv }))
    }

    const LEFT: Vec2 = Vec2::new(0.25, 0.5);
    const RIGHT: Vec2 = Vec2::new(0.75, 0.5);

    #[test]
    fn channels_take_a_number_apart() {
        let mut t = Textures::default();
        let of = two_pixels(&mut t);
        let channels: Vec<_> = (0..4).map(|channel| t.push(Texture::Channel { of, channel })).collect();
        let read = |uv: Vec2| channels.iter().map(|&c| t.eval(c, uv)).collect::<Vec<_>>();
        assert_eq!(read(LEFT), [0.2, 0.4, 0.6, 0.25].map(Rgb::splat));
        assert_eq!(read(RIGHT), [1.0, 0.0, 0.5, 0.75].map(Rgb::splat));
        let means: Vec<f32> = channels.iter().map(|&c| t.mean(c).g).collect();
        for (mean, expected) in means.iter().zip([0.6, 0.2, 0.55, 0.5]) {
            assert!((mean - expected).abs() < 1e-6, "{means:?}");
        }
        // A channel is opaque itself.
        assert_eq!((t.opacity(channels[3], LEFT), t.opacity(of, LEFT)), (1.0, 0.25));
        assert_eq!(t.brightest(channels[1]), 1.0);
    }

    #[test]
    fn products_multiply_colours_and_opacities() {
        let mut t = Textures::default();
        let (a, b) = (two_pixels(&mut t), t.constant(Rgb::new(2.0, 0.5, 1.0)));
        let scale = t.push(Texture::Scale { a, b });
        assert_eq!(t.eval(scale, LEFT), Rgb::new(0.4, 0.2, 0.6));
        assert_eq!((t.opacity(scale, LEFT), t.opacity(scale, RIGHT)), (0.25, 0.75));
        let (mean, expected) = (t.mean(scale), t.mean(a) * Rgb::new(2.0, 0.5, 1.0));
        assert_eq!(mean, expected, "a constant factor keeps the mean exact");
        assert_eq!(t.brightest(scale), 2.0);
    }

    #[test]
    fn mixtures_go_from_one_texture_to_the_other() {
        let mut t = Textures::default();
        let (weight, a) = (two_pixels(&mut t), t.constant(Rgb::BLACK));
        let b = t.constant(Rgb::splat(3.0));
        let mix = t.push(Texture::Mix { weight, a, b });
        assert_eq!(t.eval(mix, LEFT), Rgb::new(0.2, 0.4, 0.6) * 3.0);
        assert_eq!((t.mean(mix), t.brightest(mix)), (t.mean(weight) * 3.0, 3.0));
        let inverted = t.push(Texture::Mix { weight, a: b, b: a });
        assert!((t.eval(inverted, RIGHT) - Rgb::new(0.0, 3.0, 1.5)).max_channel().abs() < 1e-6);
        // Weights outside of [0, 1] choose one.
        let sure = t.push(Texture::Mix { weight: b, a, b: weight });
        assert_eq!(t.eval(sure, RIGHT), t.eval(weight, RIGHT));
        assert_eq!(t.opacity(sure, RIGHT), 0.75);
    }

    /// A bitmap of 5 by 4 pixels, stretched and turned.
    fn uneven(textures: &mut Textures) -> Handle<Texture> {
        let value = |i: u32, k: u32| (i * k % 11) as f32 / 10.0;
        let pixels = (1..=20).map(|i| Rgb::new(value(i, 7), value(i, 5), value(i, 3))).collect();
        let image = textures.images.push(Image { width: 5, height: 4, pixels }.into());
        let to_uv = Affine2::from_scale_angle_translation(Vec2::new(1.5, 0.7), 0.4, Vec2::new(0.1, 0.3));
        let (filter, wrap) = (BitmapFilter::Bilinear, Wrap::Mirror);
        textures.push(Texture::Bitmap(Bitmap { image, filter, wrap, to_uv }))
    }

    #[test]
    fn gradients_are_limits_of_differences() {
        let mut t = Textures::default();
        let (a, b) = (t.constant(Rgb::new(0.2, 0.5, 2.0)), uneven(&mut t));
        let other = t.push(Texture::Scale { a: b, b });
        let mix = t.push(Texture::Mix { weight: b, a, b: other });
        let channel = t.push(Texture::Channel { of: mix, channel: 1 });
        let to_uv = Affine2::from_scale(Vec2::splat(0.4));
        let board = t.push(Texture::Checkerboard(Checkerboard { color0: mix, color1: b, to_uv }));
        const H: f32 = 1.0 / 512.0;
        let mut compared = 0;
        for texture in [b, other, channel, board] {
            for i in 0..200 {
                let uv = Vec2::new((i as f32 * 0.618_034).fract(), (i as f32 * 0.381_1).fract());
                let ends =
                    [Vec2::X, Vec2::Y].map(|d| [t.eval(texture, uv - d * H), t.eval(texture, uv + d * H)]);
                let middle = t.eval(texture, uv);
                for (slope, [below, above]) in t.gradient(texture, uv).into_iter().zip(ends) {
                    // Not across an edge between pixels, where one-sided differences disagree.
                    let bend = (above - middle).zip(middle - below, |a, b| (a - b).abs());
                    if bend.max_channel() < 2e-5 {
                        let difference = (above - below) * (0.5 / H);
                        let off = slope.zip(difference, |a, b| (a - b).abs());
                        assert!(off.max_channel() < 0.02, "{slope:?} {difference:?} at {uv}");
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared > 500, "{compared}");
    }

    #[test]
    fn vertex_colours_come_with_the_point() {
        let mut t = Textures::default();
        let own = t.push(Texture::VertexColor);
        let at = TexturePoint { uv: LEFT, color: Rgb::new(0.1, 0.2, 0.3) };
        assert_eq!((t.eval(own, at), t.eval(own, LEFT)), (Rgb::new(0.1, 0.2, 0.3), Rgb::WHITE));
    }

    #[test]
    fn means_of_textures_that_share_others_take_no_longer() {
        let mut t = Textures::default();
        let mut last = t.constant(Rgb::splat(0.5));
        for _ in 0..200 {
            let to_uv = Affine2::IDENTITY;
            last = t.push(Texture::Checkerboard(Checkerboard { color0: last, color1: last, to_uv }));
        }
        assert_eq!((t.mean(last), t.brightest(last)), (Rgb::splat(0.5), 0.5));
    }
}
