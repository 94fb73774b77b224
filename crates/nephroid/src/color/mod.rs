//! Colour: linear RGB with the primaries of sRGB.

mod rgb;
pub mod srgb;

pub use rgb::Rgb;
