//! Writes the water of the built-in scene `pool`: a grid over the sum of a few waves, with the normals of the waves.
//!
//! ```sh
//! cargo run --release -p nephroid-formats --example pool_water -- scenes/pool.ply
//! ```
//!
//! The same file on every machine: sines and cosines are those of the renderer.

use std::io;

use nephroid::math::real::{cos, sin};
use nephroid::math::{Vec2, Vec3};

/// Cells along x and z.
const CELLS: [u16; 2] = [104, 78];

/// Half the lengths of the grid: a little more than the pool's, so that it reaches into the walls.
const HALF: Vec2 = Vec2::new(2.03, 1.53);

/// Wave lengths, from long swell to what a breeze makes.
const LENGTHS: [f32; 11] = [1.9, 1.55, 1.3, 1.08, 0.94, 0.83, 0.74, 0.66, 0.59, 0.53, 0.47];

/// How steep each wave is at most.
const SLOPE: f32 = 0.104;

fn main() -> io::Result<()> {
    let usage = || io::Error::other("write pool_water FILE.ply");
    std::fs::write(std::env::args_os().nth(1).ok_or_else(usage)?, mesh())
}

/// A binary PLY of quadrangles.
fn mesh() -> Vec<u8> {
    let [across, along] = CELLS;
    let row = across + 1;
    let mut file =
        header(usize::from(row) * usize::from(along + 1), usize::from(across) * usize::from(along));
    for j in 0..=along {
        for i in 0..=across {
            let part = Vec2::new(f32::from(i) / f32::from(across), f32::from(j) / f32::from(along));
            let place = (2.0 * part - Vec2::ONE) * HALF;
            let (height, slope) = waves(place);
            let normal = Vec3::new(-slope.x, 1.0, -slope.y).normalize();
            for value in [place.x, height, place.y, normal.x, normal.y, normal.z] {
                file.extend(value.to_le_bytes());
            }
        }
    }
    for corner in (0..along).flat_map(|j| (0..across).map(move |i| j * row + i)) {
        file.push(4);
        // Counter-clockwise, seen from above.
        for index in [corner, corner + row, corner + row + 1, corner + 1] {
            file.extend(index.to_le_bytes());
        }
    }
    file
}

fn header(vertices: usize, faces: usize) -> Vec<u8> {
    let mut text = format!("ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n");
    for name in ["x", "y", "z", "nx", "ny", "nz"] {
        text += &format!("property float {name}\n");
    }
    text += &format!("element face {faces}\nproperty list uchar ushort vertex_indices\nend_header\n");
    text.into_bytes()
}

/// The height of the water and its slopes along x and z.
fn waves(place: Vec2) -> (f32, Vec2) {
    let (mut height, mut slope) = (0.0, Vec2::ZERO);
    for (number, length) in (0_u8..).zip(LENGTHS) {
        // Golden angles: directions as unlike one another as can be.
        let angle = 2.399_963 * f32::from(number) + 0.4;
        let wave_number = std::f32::consts::TAU / length;
        let along = Vec2::new(cos(angle), sin(angle)) * wave_number;
        let phase = along.dot(place) + 1.7 * f32::from(number);
        height += SLOPE / wave_number * sin(phase);
        slope += along * (SLOPE / wave_number * cos(phase));
    }
    (height, slope)
}
