use crate::color::Rgb;

/// Values on a regular grid that fills [0, 1]³, each in the middle of its cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// What messages call it.
    pub name: String,
    /// Cells along x, y and z.
    pub size: [u32; 3],
    /// One for each cell; x runs fastest, then y.
    pub values: GridValues,
}

/// One number or three in a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum GridValues {
    /// The same for all channels.
    Grey(Vec<f32>),
    /// One for each channel.
    Rgb(Vec<Rgb>),
}
