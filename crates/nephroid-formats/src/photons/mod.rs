//! Photons in files, for other programs to look at: tables of comma-separated values and clouds of points.
//!
//! Both have the same columns, one photon a row, by map and within a map by path. Positions are in scene
//! units and world space, directions are unit vectors along the photons' flight, and powers are in W, each
//! photon's share: divided by the paths emitted for its map.

mod csv;
mod ply;

pub use self::csv::{encode_csv, write_csv};
pub use self::ply::{encode_ply, write_ply};
