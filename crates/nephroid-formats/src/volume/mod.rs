//! Grids of values in space from files.

mod vol;

pub use vol::read_vol;

use nephroid::math::{Transform, Vec3};
use nephroid::medium::GridValues;
use thiserror::Error;

/// A grid and the box that its file puts it into.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeFile {
    /// Cells along x, y and z, at least one of each.
    pub size: [u32; 3],
    /// Finite and not negative, one for each cell; x runs fastest, then y.
    pub values: GridValues,
    /// Two opposite corners of the box, as they stand in the file.
    pub bounds: [Vec3; 2],
    /// How many of the values are below zero in the file, as simulations and filters leave them. They are zero here.
    pub negative: usize,
}

impl VolumeFile {
    /// The map from [0, 1]³ to the box of the file.
    ///
    /// # Errors
    ///
    /// A box without volume, or one whose first corner is not the lower one.
    pub fn to_bounds(&self) -> Result<Transform, VolumeError> {
        let [low, high] = self.bounds.map(Vec3::as_dvec3);
        let to_bounds = Transform::scale(high - low).then(Transform::translate(low));
        if low.cmplt(high).all() && to_bounds.is_invertible() {
            Ok(to_bounds)
        } else {
            Err(VolumeError::Bounds(self.bounds))
        }
    }
}

/// Why a file is not a grid of values.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum VolumeError {
    /// It begins with other letters.
    #[error("not a volume: it does not begin with \"VOL\"")]
    Magic,
    /// It ends before the values.
    #[error("a volume has 48 bytes before its values, but the file ends after {0}")]
    Header(usize),
    /// Another version of the format.
    #[error("a volume of version {0}; version 3 can be read")]
    Version(u8),
    /// Numbers of another kind.
    #[error("values of encoding {0}; 1 (floats), 2 (half floats) and 3 (bytes) can be read")]
    Encoding(i32),
    /// Neither grey nor RGB.
    #[error("{0} values in each cell; 1 or 3 can be read")]
    Channels(i32),
    /// A side without cells.
    #[error("a grid of {} × {} × {} cells; each side needs at least one", .0[0], .0[1], .0[2])]
    Size([i32; 3]),
    /// Fewer bytes than the header promises.
    #[error("the header promises {promised} bytes of values, but {found} follow it")]
    Truncated {
        /// Bytes that the values of all cells take.
        promised: u128,
        /// Bytes behind the header.
        found: usize,
    },
    /// More bytes than the header promises.
    #[error("{0} bytes too many: the file goes on behind the last value")]
    TooLong(u128),
    /// Values that are none.
    #[error(
        "{count} of the values are not finite, the first of them number {first}: {value} (counted from 0)"
    )]
    Values {
        /// How many.
        count: usize,
        /// The place of the first in the order of the file, from 0.
        first: usize,
        /// The first of them.
        value: f32,
    },
    /// A box that holds nothing.
    #[error("its box goes from {} to {}; each coordinate must grow", .0[0], .0[1])]
    Bounds([Vec3; 2]),
}
