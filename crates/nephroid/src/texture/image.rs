use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::{Affine2, Vec2};

/// A rectangle of linear colours, row by row from the first row of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width · height` values.
    pub pixels: Vec<Rgb>,
}

impl Image {
    /// An image of one colour.
    pub fn filled(width: u32, height: u32, value: Rgb) -> Self {
        Self { width, height, pixels: vec![value; width as usize * height as usize] }
    }

    /// The pixel in column `x` of row `y`.
    #[inline]
    pub fn pixel(&self, x: u32, y: u32) -> Rgb {
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// The mean of all pixels; black if there are none.
    pub fn mean(&self) -> Rgb {
        let mut sum = [0.0f64; 3];
        for p in &self.pixels {
            for (s, v) in sum.iter_mut().zip(p.to_array()) {
                *s += f64::from(v);
            }
        }
        let n = self.pixels.len().max(1) as f64;
        Rgb::from(sum.map(|s| (s / n) as f32))
    }

    /// The largest value of any channel; 0 if there is none above it.
    pub fn brightest(&self) -> f32 {
        self.pixels.iter().fold(0.0, |largest, p| p.max_channel().max(largest))
    }
}

/// How a bitmap is read between its pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BitmapFilter {
    /// The nearest pixel.
    Nearest,
    /// Linear in both directions.
    #[default]
    Bilinear,
}

/// What a bitmap shows outside the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// Itself again.
    #[default]
    Repeat,
    /// Itself mirrored.
    Mirror,
    /// Its edge.
    Clamp,
}

impl Wrap {
    /// The pixel index for a coordinate that may lie outside [0, size).
    #[inline]
    pub fn index(self, i: i64, size: u32) -> u32 {
        let n = i64::from(size);
        let wrapped = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Clamp => i.clamp(0, n - 1),
            Self::Mirror => {
                let j = i.rem_euclid(2 * n);
                if j < n { j } else { 2 * n - 1 - j }
            }
        };
        wrapped as u32
    }
}

/// An image as a texture: row 0 at `v` = 0, pixel centres at half-integers.
#[derive(Clone, Debug, PartialEq)]
pub struct Bitmap {
    /// What it shows.
    pub image: Handle<Image>,
    /// Reading between pixels.
    pub filter: BitmapFilter,
    /// Reading outside the square.
    pub wrap: Wrap,
    /// Applied to `uv` first.
    pub to_uv: Affine2,
}

impl Bitmap {
    /// The value at `uv` of `image`, which must be the one it refers to.
    pub fn eval(&self, image: &Image, uv: Vec2) -> Rgb {
        let p = self.to_uv.transform_point2(uv) * Vec2::new(image.width as f32, image.height as f32);
        if !p.is_finite() {
            return Rgb::BLACK;
        }
        let at =
            |x: i64, y: i64| image.pixel(self.wrap.index(x, image.width), self.wrap.index(y, image.height));
        match self.filter {
            BitmapFilter::Nearest => at(p.x.floor() as i64, p.y.floor() as i64),
            BitmapFilter::Bilinear => {
                let (x, y) = (p.x - 0.5, p.y - 0.5);
                let (i, j) = (x.floor(), y.floor());
                let (a, b) = (x - i, y - j);
                let (i, j) = (i as i64, j as i64);
                (at(i, j) * (1.0 - a) + at(i + 1, j) * a) * (1.0 - b)
                    + (at(i, j + 1) * (1.0 - a) + at(i + 1, j + 1) * a) * b
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::handle::Arena;

    fn two_by_one() -> (Image, Handle<Image>) {
        let image = Image { width: 2, height: 1, pixels: vec![Rgb::BLACK, Rgb::WHITE] };
        let handle = Arena::default().push(image.clone());
        (image, handle)
    }

    #[test]
    fn bilinear_meets_the_pixels_at_their_centres() {
        let (image, handle) = two_by_one();
        let bitmap = Bitmap {
            image: handle,
            filter: BitmapFilter::Bilinear,
            wrap: Wrap::Clamp,
            to_uv: Affine2::IDENTITY,
        };
        assert_eq!(bitmap.eval(&image, Vec2::new(0.25, 0.5)), Rgb::BLACK);
        assert_eq!(bitmap.eval(&image, Vec2::new(0.75, 0.5)), Rgb::WHITE);
        assert_eq!(bitmap.eval(&image, Vec2::new(0.5, 0.5)), Rgb::splat(0.5));
        assert_eq!(bitmap.eval(&image, Vec2::new(f32::NAN, 0.5)), Rgb::BLACK);
    }

    #[test]
    fn wrapping_covers_every_integer() {
        assert_eq!([-1, 0, 1, 2, 3].map(|i| Wrap::Repeat.index(i, 2)), [1, 0, 1, 0, 1]);
        assert_eq!([-1, 0, 1, 2, 3].map(|i| Wrap::Mirror.index(i, 2)), [0, 0, 1, 1, 0]);
        assert_eq!([-9, 0, 1, 2, 9].map(|i| Wrap::Clamp.index(i, 2)), [0, 0, 1, 1, 1]);
    }
}
