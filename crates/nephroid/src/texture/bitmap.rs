use super::Pixmap;
use crate::color::Rgb;
use crate::handle::Handle;
use crate::math::{Affine2, Vec2};

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
    /// Black, which is not there.
    Black,
}

impl Wrap {
    /// The pixel index for a coordinate that may lie outside [0, size); of [`Wrap::Black`] the nearest.
    #[inline]
    pub fn index(self, i: i64, size: u32) -> u32 {
        let n = i64::from(size);
        let wrapped = match self {
            Self::Repeat => i.rem_euclid(n),
            Self::Clamp | Self::Black => i.clamp(0, n - 1),
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
    pub image: Handle<Pixmap>,
    /// Reading between pixels.
    pub filter: BitmapFilter,
    /// Reading outside the square.
    pub wrap: Wrap,
    /// Applied to `uv` first.
    pub to_uv: Affine2,
}

impl Bitmap {
    /// The colour at `uv` of `image`, which must be the one it refers to.
    pub fn eval(&self, image: &Pixmap, uv: Vec2) -> Rgb {
        self.read(image, uv, Rgb::BLACK, |x, y| image.pixel(x, y))
    }

    /// The opacity at `uv`.
    pub fn opacity(&self, image: &Pixmap, uv: Vec2) -> f32 {
        if image.alpha.is_none() && self.wrap != Wrap::Black {
            return 1.0;
        }
        self.read(image, uv, 0.0, |x, y| image.opacity(x, y))
    }

    /// How the colour changes with `u` and with `v`, read bilinearly.
    pub fn gradient(&self, image: &Pixmap, uv: Vec2) -> [Rgb; 2] {
        let size = Vec2::new(image.width as f32, image.height as f32);
        let p = self.to_uv.transform_point2(uv) * size - Vec2::splat(0.5);
        if !p.is_finite() {
            return [Rgb::BLACK; 2];
        }
        let (corner, part) = (p.floor(), p - p.floor());
        let (i, j) = (corner.x as i64, corner.y as i64);
        let at = |x: i64, y: i64| self.pixel(image, i + x, j + y, Rgb::BLACK, |x, y| image.pixel(x, y));
        let [[a, b], [c, d]] = [[at(0, 0), at(1, 0)], [at(0, 1), at(1, 1)]];
        let across = ((b - a) * (1.0 - part.y) + (d - c) * part.y) * size.x;
        let down = ((c - a) * (1.0 - part.x) + (d - b) * part.x) * size.y;
        let to_uv = self.to_uv.matrix2;
        [to_uv.x_axis, to_uv.y_axis].map(|axis| across * axis.x + down * axis.y)
    }

    /// A pixel that may lie outside.
    #[inline(always)]
    fn pixel<T>(&self, image: &Pixmap, x: i64, y: i64, nothing: T, pixel: impl Fn(u32, u32) -> T) -> T {
        let outside = |i: i64, size: u32| i < 0 || i >= i64::from(size);
        if self.wrap == Wrap::Black && (outside(x, image.width) || outside(y, image.height)) {
            return nothing;
        }
        pixel(self.wrap.index(x, image.width), self.wrap.index(y, image.height))
    }

    #[inline(always)]
    fn read<T>(&self, image: &Pixmap, uv: Vec2, nothing: T, pixel: impl Fn(u32, u32) -> T) -> T
    where
        T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
    {
        let p = self.to_uv.transform_point2(uv) * Vec2::new(image.width as f32, image.height as f32);
        if !p.is_finite() {
            return nothing;
        }
        let at = |x: i64, y: i64| self.pixel(image, x, y, nothing, &pixel);
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
    use crate::texture::{Image, Plane};

    fn two_by_one() -> (Pixmap, Handle<Pixmap>) {
        let image = Image { width: 2, height: 1, pixels: vec![Rgb::BLACK, Rgb::WHITE] };
        let handle = Arena::default().push(Pixmap::from(image.clone()));
        (image.into(), handle)
    }

    fn clamped(image: Handle<Pixmap>) -> Bitmap {
        Bitmap { image, filter: BitmapFilter::Bilinear, wrap: Wrap::Clamp, to_uv: Affine2::IDENTITY }
    }

    #[test]
    fn bilinear_meets_the_pixels_at_their_centres() {
        let (image, handle) = two_by_one();
        let bitmap = clamped(handle);
        assert_eq!(bitmap.eval(&image, Vec2::new(0.25, 0.5)), Rgb::BLACK);
        assert_eq!(bitmap.eval(&image, Vec2::new(0.75, 0.5)), Rgb::WHITE);
        assert_eq!(bitmap.eval(&image, Vec2::new(0.5, 0.5)), Rgb::splat(0.5));
        assert_eq!(bitmap.eval(&image, Vec2::new(f32::NAN, 0.5)), Rgb::BLACK);
    }

    #[test]
    fn opacity_is_read_as_colours_are() {
        let (mut image, handle) = two_by_one();
        let bitmap = clamped(handle);
        assert_eq!(bitmap.opacity(&image, Vec2::new(0.5, 0.5)), 1.0);
        image.alpha = Some(Plane::Linear(vec![0.0, 0.5]));
        assert_eq!(bitmap.opacity(&image, Vec2::new(0.5, 0.5)), 0.25);
        assert_eq!(bitmap.opacity(&image, Vec2::new(7.0, 0.5)), 0.5);
    }

    #[test]
    fn black_outside_is_not_there() {
        let (image, handle) = two_by_one();
        let bitmap = Bitmap { wrap: Wrap::Black, ..clamped(handle) };
        assert_eq!(bitmap.eval(&image, Vec2::new(0.75, 0.5)), Rgb::WHITE);
        // Halfway to the first pixel that is not there.
        assert_eq!(bitmap.eval(&image, Vec2::new(1.0, 0.5)), Rgb::splat(0.5));
        for uv in [Vec2::new(1.3, 0.5), Vec2::new(0.75, -0.6), Vec2::new(-1.0, 0.5)] {
            assert_eq!((bitmap.eval(&image, uv), bitmap.opacity(&image, uv)), (Rgb::BLACK, 0.0));
        }
    }

    #[test]
    fn wrapping_covers_every_integer() {
        assert_eq!([-1, 0, 1, 2, 3].map(|i| Wrap::Repeat.index(i, 2)), [1, 0, 1, 0, 1]);
        assert_eq!([-1, 0, 1, 2, 3].map(|i| Wrap::Mirror.index(i, 2)), [0, 0, 1, 1, 0]);
        assert_eq!([-9, 0, 1, 2, 9].map(|i| Wrap::Clamp.index(i, 2)), [0, 0, 1, 1, 1]);
    }
}
