//! Writes the grid of the built-in scene `smoke`: a plume that widens, bends and frays as it rises.
//!
//! ```sh
//! cargo run --release -p nephroid-formats --example smoke_grid -- scenes/smoke.vol
//! ```
//!
//! The same file on every machine: noise comes from a hash of integers, and of the functions of real numbers
//! only the square root is used, which is exact everywhere.

use std::io;

/// Cells along x, y (up) and z.
const SIZE: [i32; 3] = [48, 88, 48];

fn main() -> io::Result<()> {
    let usage = || io::Error::other("write smoke_grid FILE.vol");
    std::fs::write(std::env::args_os().nth(1).ok_or_else(usage)?, volume())
}

/// A `.vol` of version 3: a byte for each cell of the unit cube.
fn volume() -> Vec<u8> {
    let mut file = b"VOL\x03".to_vec();
    for int in [3, SIZE[0], SIZE[1], SIZE[2], 1] {
        file.extend(int.to_le_bytes());
    }
    for corner in [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0] {
        file.extend(corner.to_le_bytes());
    }
    let middle = |i: i32, axis: usize| (f64::from(i) + 0.5) / f64::from(SIZE[axis]);
    for z in 0..SIZE[2] {
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                let density = density([middle(x, 0), middle(y, 1), middle(z, 2)]);
                file.push((density * 255.0).round() as u8);
            }
        }
    }
    file
}

/// Density in [0, 1] at a point of the unit cube; it is 0 at all faces but the lower.
fn density([x, y, z]: [f64; 3]) -> f64 {
    // The higher, the more the axis wanders, and the wider the plume is.
    let bend = |salt: f64| 0.42 * y * (octaves([2.2 * y, salt, 0.5], 2) - 0.5);
    let (dx, dz) = (x - 0.5 - bend(3.7), z - 0.5 - bend(11.3));
    let width = 0.05 + 0.23 * y.sqrt() * y.sqrt().sqrt();
    // Noise that is itself moved by noise curls.
    let warp = |salt: f64| 0.9 * (octaves([5.0 * x + salt, 6.0 * y, 5.0 * z], 3) - 0.5);
    let noise = octaves([6.0 * x + warp(17.0), 8.0 * y + warp(29.0), 6.0 * z + warp(43.0)], 4);
    let distance = (dx * dx + dz * dz).sqrt() / width;
    let body = smooth((1.0 - distance + 2.2 * (noise - 0.5)) / 0.7);
    let fade = smooth((0.97 - y) / 0.5) * (1.0 - 0.5 * y);
    let edge = |t: f64| smooth(t.min(1.0 - t) / 0.08);
    (body * fade * edge(x) * edge(z) * (0.35 + 0.65 * noise)).clamp(0.0, 1.0)
}

/// 0 below 0, 1 above 1, and without a kink between.
fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A sum of noises, each half as strong and half as wide as the one before, in [0, 1].
fn octaves(point: [f64; 3], count: u32) -> f64 {
    let (mut sum, mut weights, mut weight, mut scale) = (0.0, 0.0, 1.0, 1.0);
    for octave in 0..count {
        sum += weight * noise(point.map(|p| p * scale), octave);
        weights += weight;
        weight *= 0.5;
        scale *= 2.0;
    }
    sum / weights
}

/// Random values at the corners of unit cells, smooth between them, in [0, 1].
fn noise(point: [f64; 3], seed: u32) -> f64 {
    let corner = point.map(f64::floor);
    let t = [0, 1, 2].map(|axis| smooth(point[axis] - corner[axis]));
    let mut sum = 0.0;
    for i in 0..8 {
        let bits = [i & 1, (i >> 1) & 1, (i >> 2) & 1];
        let weight = |axis: usize| if bits[axis] == 1 { t[axis] } else { 1.0 - t[axis] };
        let at = [0, 1, 2].map(|axis| corner[axis] as i32 + bits[axis]);
        sum += weight(0) * weight(1) * weight(2) * value(at, seed);
    }
    sum
}

/// A number in [0, 1] for a corner, by the finaliser of MurmurHash3 (A. Appleby, public domain).
fn value(at: [i32; 3], seed: u32) -> f64 {
    let mut hash = seed;
    for coordinate in at {
        hash = hash.wrapping_mul(0x9e37_79b9) ^ (coordinate as u32);
        hash = (hash ^ (hash >> 16)).wrapping_mul(0x85eb_ca6b);
        hash = (hash ^ (hash >> 13)).wrapping_mul(0xc2b2_ae35);
        hash ^= hash >> 16;
    }
    f64::from(hash) / f64::from(u32::MAX)
}
