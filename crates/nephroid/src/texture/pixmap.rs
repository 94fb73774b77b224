use super::Image;
use crate::color::{Rgb, srgb};

/// An image as textures keep it: in bytes where its file has bytes, and perhaps with an alpha plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixmap {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width · height` colours, row by row from the first row of the file.
    pub pixels: Pixels,
    /// As many opacities; without, the image is opaque.
    pub alpha: Option<Plane>,
}

/// The colours of a [`Pixmap`].
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// Linear colours.
    Linear(Vec<Rgb>),
    /// A byte for all channels.
    Grey(Vec<u8>, Decoding),
    /// A byte for each channel.
    Color(Vec<[u8; 3]>, Decoding),
}

/// One number for each pixel.
#[derive(Clone, Debug, PartialEq)]
pub enum Plane {
    /// The number itself.
    Linear(Vec<f32>),
    /// In 255ths.
    Bytes(Vec<u8>),
}

/// What each byte stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct Decoding(Box<[f32; 256]>);

impl Decoding {
    /// 255ths.
    pub fn linear() -> Self {
        Self::of(|v| v)
    }

    /// By the curve of sRGB.
    pub fn srgb() -> Self {
        Self::of(srgb::decode)
    }

    /// By any curve over [0, 1].
    pub fn of(curve: impl Fn(f32) -> f32) -> Self {
        Self(Box::new(std::array::from_fn(|byte| curve(byte as f32 / 255.0))))
    }

    /// What a byte stands for.
    #[inline]
    pub fn value(&self, byte: u8) -> f32 {
        self.0[usize::from(byte)]
    }
}

impl Plane {
    /// How many pixels it has.
    pub fn len(&self) -> usize {
        match self {
            Self::Linear(values) => values.len(),
            Self::Bytes(bytes) => bytes.len(),
        }
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of a pixel.
    #[inline]
    pub fn value(&self, index: usize) -> f32 {
        match self {
            Self::Linear(values) => values[index],
            Self::Bytes(bytes) => f32::from(bytes[index]) / 255.0,
        }
    }
}

impl Pixels {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Linear(colors) => colors.len(),
            Self::Grey(bytes, _) => bytes.len(),
            Self::Color(bytes, _) => bytes.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The colour of a pixel.
    #[inline]
    pub fn color(&self, index: usize) -> Rgb {
        match self {
            Self::Linear(colors) => colors[index],
            Self::Grey(bytes, decoding) => Rgb::splat(decoding.value(bytes[index])),
            Self::Color(bytes, decoding) => Rgb::from(bytes[index].map(|byte| decoding.value(byte))),
        }
    }

    /// All of them in order.
    pub fn iter(&self) -> impl Iterator<Item = Rgb> {
        (0..self.len()).map(|index| self.color(index))
    }
}

impl Pixmap {
    /// An opaque image of one colour.
    pub fn filled(width: u32, height: u32, value: Rgb) -> Self {
        Image::filled(width, height, value).into()
    }

    /// The colour in column `x` of row `y`.
    #[inline]
    pub fn pixel(&self, x: u32, y: u32) -> Rgb {
        self.pixels.color(self.index(x, y))
    }

    /// The opacity in column `x` of row `y`.
    #[inline]
    pub fn opacity(&self, x: u32, y: u32) -> f32 {
        self.alpha.as_ref().map_or(1.0, |plane| plane.value(self.index(x, y)))
    }

    #[inline]
    fn index(&self, x: u32, y: u32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    /// The mean of all colours; black if there are none.
    pub fn mean(&self) -> Rgb {
        let mut sum = [0.0f64; 3];
        for p in self.pixels.iter() {
            for (s, v) in sum.iter_mut().zip(p.to_array()) {
                *s += f64::from(v);
            }
        }
        let n = self.pixels.len().max(1) as f64;
        Rgb::from(sum.map(|s| (s / n) as f32))
    }

    /// The mean opacity; 1 without an alpha plane.
    pub fn mean_opacity(&self) -> f32 {
        let Some(plane) = &self.alpha else { return 1.0 };
        let sum: f64 = (0..plane.len()).map(|index| f64::from(plane.value(index))).sum();
        (sum / plane.len().max(1) as f64) as f32
    }

    /// The largest value of any channel; 0 if there is none above it.
    pub fn brightest(&self) -> f32 {
        self.pixels.iter().fold(0.0, |largest, p| p.max_channel().max(largest))
    }

    /// Bytes that its pixels take.
    pub fn bytes(&self) -> usize {
        let colors = match &self.pixels {
            Pixels::Linear(colors) => size_of_val(&colors[..]),
            Pixels::Grey(bytes, _) => size_of_val(&bytes[..]),
            Pixels::Color(bytes, _) => size_of_val(&bytes[..]),
        };
        let alpha = match &self.alpha {
            None => 0,
            Some(Plane::Linear(values)) => size_of_val(&values[..]),
            Some(Plane::Bytes(bytes)) => size_of_val(&bytes[..]),
        };
        colors + alpha
    }
}

/// Opaque.
impl From<Image> for Pixmap {
    fn from(Image { width, height, pixels }: Image) -> Self {
        Self { width, height, pixels: Pixels::Linear(pixels), alpha: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_what_their_curve_says() {
        let pixels = Pixels::Color(vec![[0, 255, 128], [51, 51, 51]], Decoding::srgb());
        let map = Pixmap { width: 1, height: 2, pixels, alpha: Some(Plane::Bytes(vec![255, 51])) };
        assert_eq!(map.pixel(0, 0), Rgb::new(0.0, 1.0, srgb::decode(128.0 / 255.0)));
        assert_eq!((map.opacity(0, 0), map.opacity(0, 1)), (1.0, 0.2));
        assert!((map.mean_opacity() - 0.6).abs() < 1e-6);
        assert_eq!(map.brightest(), 1.0);
        assert_eq!(map.bytes(), 8);
        let grey = Pixmap { pixels: Pixels::Grey(vec![255, 51], Decoding::linear()), alpha: None, ..map };
        assert_eq!((grey.pixel(0, 1), grey.opacity(0, 1)), (Rgb::splat(0.2), 1.0));
        assert_eq!(grey.mean(), Rgb::splat(0.6));
    }

    #[test]
    fn linear_colours_stay_as_they_are() {
        let image = Image { width: 2, height: 1, pixels: vec![Rgb::new(1e9, 0.0, -3.0), Rgb::WHITE] };
        let map = Pixmap::from(image.clone());
        assert!(map.pixels.iter().eq(image.pixels.iter().copied()));
        assert_eq!(map.pixel(0, 0), Rgb::new(1e9, 0.0, -3.0));
    }
}
