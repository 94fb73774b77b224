use crate::color::Rgb;

/// A rectangle of linear colours, row by row from the first row of the file: what is rendered and written.
/// Textures keep a [`Pixmap`](super::Pixmap).
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
