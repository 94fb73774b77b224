use super::ImageProblem;

/// No image has more pixels on a side.
pub const MAX_SIDE: u64 = 65_536;

/// No image has more pixels.
pub const MAX_PIXELS: u64 = 1 << 28;

/// Checks a size as a header declares it.
pub fn check_size(width: u64, height: u64) -> Result<(), ImageProblem> {
    if width == 0 || height == 0 {
        Err(ImageProblem::NoPixels)
    } else if width > MAX_SIDE || height > MAX_SIDE || width * height > MAX_PIXELS {
        Err(ImageProblem::TooLarge { width, height })
    } else {
        Ok(())
    }
}

/// Checks that a file of `bytes` bytes can hold a checked size: `bits_per_pixel` before
/// compression, which makes nothing smaller than by a factor of `best_ratio`.
pub fn check_held(
    (width, height): (u64, u64),
    bits_per_pixel: u64,
    best_ratio: u64,
    bytes: usize,
) -> Result<(), ImageProblem> {
    let needed = u128::from(width) * u128::from(height) * u128::from(bits_per_pixel) / 8;
    if needed > bytes as u128 * u128::from(best_ratio) {
        return Err(ImageProblem::TooShort { width, height, bytes });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_at_the_limits() {
        assert!(check_size(1, 1).is_ok() && check_size(65_536, 4096).is_ok());
        assert!(matches!(check_size(0, 5), Err(ImageProblem::NoPixels)));
        assert!(matches!(check_size(65_537, 1), Err(ImageProblem::TooLarge { .. })));
        assert!(matches!(check_size(65_536, 4097), Err(ImageProblem::TooLarge { .. })));
    }

    #[test]
    fn files_that_are_too_short() {
        assert!(check_held((100, 10), 8, 10, 100).is_ok());
        assert!(matches!(check_held((100, 10), 8, 10, 99), Err(ImageProblem::TooShort { .. })));
    }
}
