//! The volumes of Mitsuba, which its `gridvolume` reads. All numbers are little-endian.
//!
//! | bytes | |
//! |---|---|
//! | 0–2 | `VOL` |
//! | 3 | version, 3 |
//! | 4–7 | encoding of the values: 1 = 32-bit floats, 2 = 16-bit floats, 3 = bytes from 0 to 1 |
//! | 8–19 | cells along x, y and z |
//! | 20–23 | values in each cell |
//! | 24–47 | corners of the box: x, y and z of the lower, then of the upper |
//! | 48– | values: those of a cell together, x fastest, then y |

use nephroid::color::Rgb;
use nephroid::math::Vec3;
use nephroid::medium::GridValues;

use super::{VolumeError, VolumeFile};

const HEADER_BYTES: usize = 48;

/// Reads a `.vol` file with one value or three in each cell.
///
/// # Errors
///
/// Another kind of file, another length than its header asks for, or a value that is not finite.
pub fn read_vol(bytes: &[u8]) -> Result<VolumeFile, VolumeError> {
    if !bytes.starts_with(b"VOL") {
        return Err(VolumeError::Magic);
    }
    let Some((header, body)) = bytes.split_at_checked(HEADER_BYTES) else {
        return Err(VolumeError::Header(bytes.len()));
    };
    if header[3] != 3 {
        return Err(VolumeError::Version(header[3]));
    }
    let int = |at: usize| i32::from_le_bytes(four(header, at));
    let float = |at: usize| f32::from_le_bytes(four(header, at));
    let encoding = Encoding::from_number(int(4))?;
    let declared = [int(8), int(12), int(16)];
    let size = declared.map(|side| u32::try_from(side).unwrap_or(0));
    if size.contains(&0) {
        return Err(VolumeError::Size(declared));
    }
    let channels = match int(20) {
        1 => 1,
        3 => 3,
        other => return Err(VolumeError::Channels(other)),
    };
    let count = size.iter().map(|side| u128::from(*side)).product::<u128>() * channels;
    let (promised, found) = (count * encoding.bytes() as u128, body.len());
    if promised > found as u128 {
        return Err(VolumeError::Truncated { promised, found });
    }
    if promised < found as u128 {
        return Err(VolumeError::TooLong(found as u128 - promised));
    }
    let mut values = encoding.decode(body);
    check(&values)?;
    let below = values.iter_mut().filter(|value| **value < 0.0);
    let negative = below.map(|value| *value = 0.0).count();
    let values = match channels {
        1 => GridValues::Grey(values),
        _ => GridValues::Rgb(values.chunks_exact(3).map(|c| Rgb::new(c[0], c[1], c[2])).collect()),
    };
    let corner = |at: usize| Vec3::new(float(at), float(at + 4), float(at + 8));
    Ok(VolumeFile { size, values, bounds: [corner(24), corner(36)], negative })
}

fn four(bytes: &[u8], at: usize) -> [u8; 4] {
    [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]
}

fn check(values: &[f32]) -> Result<(), VolumeError> {
    let is_bad = |v: &f32| !v.is_finite();
    match values.iter().position(is_bad) {
        None => Ok(()),
        Some(first) => {
            let count = values[first..].iter().filter(|v| is_bad(v)).count();
            Err(VolumeError::Values { count, first, value: values[first] })
        }
    }
}

/// How a value is stored.
#[derive(Clone, Copy)]
enum Encoding {
    Float,
    Half,
    Byte,
}

impl Encoding {
    fn from_number(number: i32) -> Result<Self, VolumeError> {
        match number {
            1 => Ok(Self::Float),
            2 => Ok(Self::Half),
            3 => Ok(Self::Byte),
            other => Err(VolumeError::Encoding(other)),
        }
    }

    /// Bytes of a value.
    fn bytes(self) -> usize {
        match self {
            Self::Float => 4,
            Self::Half => 2,
            Self::Byte => 1,
        }
    }

    fn decode(self, bytes: &[u8]) -> Vec<f32> {
        match self {
            Self::Float => bytes.chunks_exact(4).map(|b| f32::from_le_bytes(four(b, 0))).collect(),
            Self::Half => bytes.chunks_exact(2).map(|b| half(u16::from_le_bytes([b[0], b[1]]))).collect(),
            Self::Byte => bytes.iter().map(|b| f32::from(*b) / 255.0).collect(),
        }
    }
}

/// The value of a number in the 16-bit format of IEEE 754.
fn half(bits: u16) -> f32 {
    const SMALLEST: f32 = 1.0 / 16_777_216.0;
    let (exponent, fraction) = (u32::from(bits >> 10 & 31), u32::from(bits & 1023));
    let magnitude = match exponent {
        0 => fraction as f32 * SMALLEST,
        31 if fraction == 0 => f32::INFINITY,
        31 => f32::NAN,
        _ => f32::from_bits((exponent + 127 - 15) << 23 | fraction << 13),
    };
    if bits >> 15 == 1 { -magnitude } else { magnitude }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_floats() {
        for (bits, value) in [(0x3c00, 1.0), (0xc000, -2.0), (0x3555, 0.333_251_95), (0x7bff, 65_504.0)] {
            assert_eq!(half(bits), value);
        }
        assert_eq!(half(0x0001), 2.0f32.powi(-24));
        assert_eq!(half(0x0400), 2.0f32.powi(-14));
        assert_eq!(half(0x7c00), f32::INFINITY);
        assert!(half(0x7c01).is_nan());
    }
}
