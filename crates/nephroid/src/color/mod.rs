//! Colour: linear RGB with the primaries of sRGB, and single wavelengths.

mod rgb;
pub mod srgb;
mod wavelength;

pub use rgb::Rgb;
pub use wavelength::{Wavelength, response};
