use nephroid::color::Rgb;
use nephroid::texture::Image;

use super::limits::{check_held, check_size};
use super::{ImageFormat, ImageProblem};

/// Decodes a portable float map: a line each for the kind, the size, and a factor whose sign tells the order of bytes,
/// then rows of floats from the lowest up. The absolute value of the factor multiplies all.
pub fn decode(bytes: &[u8]) -> Result<Image, ImageProblem> {
    let mut header = Header { bytes, at: 0 };
    let channels: usize = match header.word()? {
        b"PF" => 3,
        b"Pf" => 1,
        _ => return Err(damaged("it is of neither one nor three channels")),
    };
    let (width, height): (u64, u64) = (header.number()?, header.number()?);
    let factor: f32 = header.number()?;
    if factor == 0.0 || !factor.is_finite() {
        return Err(damaged("its scale is zero or not finite"));
    }
    // One blank, of whatever kind, ends the header.
    let data = bytes.get(header.at + 1..).unwrap_or_default();
    check_size(width, height)?;
    check_held((width, height), 32 * channels as u64, 1, data.len())?;
    let (width, height) = (width as usize, height as usize);
    let number = |bytes: &[u8; 4]| {
        let value = if factor < 0.0 { f32::from_le_bytes(*bytes) } else { f32::from_be_bytes(*bytes) };
        value * factor.abs()
    };
    let (numbers, _) = data.as_chunks::<4>();
    let row_length = width * channels;
    let mut pixels = Vec::with_capacity(width * height);
    for row in numbers[..row_length * height].chunks_exact(row_length).rev() {
        if channels == 3 {
            let (colors, _) = row.as_chunks::<3>();
            pixels.extend(colors.iter().map(|c| Rgb::from([&c[0], &c[1], &c[2]].map(number))));
        } else {
            pixels.extend(row.iter().map(|value| Rgb::splat(number(value))));
        }
    }
    Ok(Image { width: width as u32, height: height as u32, pixels })
}

/// Words divided by blanks.
struct Header<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Header<'a> {
    fn word(&mut self) -> Result<&'a [u8], ImageProblem> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        let length = rest[start..].iter().position(u8::is_ascii_whitespace);
        // A header does not end with the file.
        let length = length.ok_or_else(|| damaged("its header has no end"))?;
        self.at += start + length;
        Ok(&rest[start..start + length])
    }

    fn number<T: std::str::FromStr>(&mut self) -> Result<T, ImageProblem> {
        let word = str::from_utf8(self.word()?).ok();
        word.and_then(|word| word.parse().ok()).ok_or_else(|| damaged("its header lacks a number"))
    }
}

fn damaged(reason: &str) -> ImageProblem {
    ImageProblem::Damaged { format: ImageFormat::Pfm, reason: reason.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, values: &[f32], big: bool) -> Vec<u8> {
        let mut bytes = header.as_bytes().to_vec();
        let of = |v: &f32| if big { v.to_be_bytes() } else { v.to_le_bytes() };
        bytes.extend(values.iter().flat_map(of));
        bytes
    }

    #[test]
    fn rows_go_up_and_both_orders_of_bytes_are_read() {
        let values = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0];
        for (header, big) in [("PF\n2 2\n-1.0\n", false), ("PF 2\n2\n1 ", true)] {
            let image = decode(&file(header, &values, big)).expect("a sound file");
            assert_eq!((image.width, image.height), (2, 2));
            assert_eq!(image.pixel(0, 1), Rgb::new(1.0, 2.0, 3.0), "the first pixel is below");
            assert_eq!(image.pixel(1, 0), Rgb::new(10.0, 11.0, 12.0));
        }
        let grey = decode(&file("Pf\n1 2\n-2.5\n", &values[..2], false)).expect("a sound file");
        assert_eq!(grey.pixels, [5.0, 2.5].map(Rgb::splat));
    }

    #[test]
    fn broken_headers_and_short_files_are_told() {
        for header in ["PF\n", "PF\n2 2", "PF\n2 x\n1\n", "PF\n-2 2\n1\n", "PF\n1 1\n0\n", "PF\n1 1\nnan\n"] {
            let problem = decode(&file(header, &[1.0; 20], false)).expect_err("a broken header");
            assert!(matches!(problem, ImageProblem::Damaged { .. }), "{header:?}: {problem}");
        }
        let short = decode(&file("PF\n2 2\n-1\n", &[1.0; 11], false)).expect_err("a short file");
        assert!(matches!(short, ImageProblem::TooShort { .. }), "{short}");
        assert!(matches!(decode(b"PF\n0 2\n-1\n"), Err(ImageProblem::NoPixels)));
    }
}
