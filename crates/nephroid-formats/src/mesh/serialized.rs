//! Mitsuba's `serialized` meshes.

use std::io::Read;

use flate2::read::ZlibDecoder;
use nephroid::color::Rgb;
use nephroid::math::{Vec2, Vec3};
use nephroid::shape::Mesh;

use super::obj::replace_missing_normals;
use super::{MeshError, MeshFile, MeshOptions, without_degenerate};

const MAGIC: u16 = 0x041c;

const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLORS: u32 = 0x0008;
const FACE_NORMALS: u32 = 0x0010;
const DOUBLE: u32 = 0x2000;

/// Deflate packs no denser.
const BEST_RATIO: u64 = 1032;

/// Reads one of the meshes of a file of the versions 3 and 4, counted from zero (Mitsuba 0.6 documentation, § 8.2.4).
/// Vertices without normals get smooth ones, unless `face_normals` or the file says otherwise.
///
/// # Errors
///
/// A file of another kind, a mesh that it does not have, one that promises more than the file holds, a number that is not
/// finite, an index that leads nowhere, no face with an area.
pub fn read_serialized(bytes: &[u8], shape_index: u32, options: MeshOptions) -> Result<MeshFile, MeshError> {
    let version = version(bytes)?;
    let start = start_of(bytes, version, shape_index)?;
    let packed = bytes.get(start..).filter(|packed| packed.len() > 4).ok_or_else(cut_off)?;
    self::version(packed)?;
    let packed = &packed[4..];
    let mut stream = Stream { decoder: ZlibDecoder::new(packed), most: packed.len() as u64 * BEST_RATIO };
    let flags = u32::from_le_bytes(stream.bytes()?);
    if version >= 4 {
        // The name of the mesh, which nobody asks for.
        while stream.bytes::<1>()? != [0] {}
    }
    let vertices = u64::from_le_bytes(stream.bytes()?);
    let triangles = u64::from_le_bytes(stream.bytes()?);
    if vertices > u64::from(u32::MAX) {
        return Err(MeshError::new("its header makes no sense"));
    }
    // Not all files say that they are of single precision (0x1000).
    let double = flags & DOUBLE != 0;
    let mut list = |width: usize, wanted: bool| -> Result<Vec<f32>, MeshError> {
        if wanted { stream.floats(vertices, width, double) } else { Ok(Vec::new()) }
    };
    let positions = list(3, true)?;
    let normals = list(3, flags & HAS_NORMALS != 0)?;
    let uvs = list(2, flags & HAS_UVS != 0)?;
    let colors = list(3, flags & HAS_COLORS != 0)?;
    let face_normals = options.face_normals || flags & FACE_NORMALS != 0;
    let v = |v: f32| if options.flip_tex_coords { 1.0 - v } else { v };
    let three = |list: &[f32]| list.as_chunks::<3>().0.iter().map(|&c| Vec3::from_array(c)).collect();
    let mut mesh = Mesh {
        positions: three(&positions),
        normals: Vec::new(),
        uvs: uvs.as_chunks::<2>().0.iter().map(|c| Vec2::new(c[0], v(c[1]))).collect(),
        colors: colors.as_chunks::<3>().0.iter().map(|&c| Rgb::from(c)).collect(),
        triangles: stream.triangles(triangles, vertices)?,
    };
    if !face_normals && normals.is_empty() {
        mesh.compute_normals();
    } else if !face_normals {
        let given = |n: &[f32; 3]| Vec3::from_array(*n).try_normalize().unwrap_or(Vec3::ZERO);
        mesh.normals = normals.as_chunks::<3>().0.iter().map(given).collect();
        replace_missing_normals(&mut mesh);
    }
    without_degenerate(mesh, !face_normals && !normals.is_empty())
}

/// The version that a header tells.
fn version(bytes: &[u8]) -> Result<u16, MeshError> {
    let word = |at: usize| bytes.get(at..at + 2).map(|b| u16::from_le_bytes([b[0], b[1]]));
    match (word(0), word(2)) {
        (Some(MAGIC), Some(version @ (3 | 4))) => Ok(version),
        (Some(MAGIC), Some(version)) => {
            Err(MeshError::new(format!("version {version} cannot be read, only 3 and 4")))
        }
        _ => Err(MeshError::new("not a serialized mesh")),
    }
}

/// Where a mesh begins: the file ends with the place of each and their number.
fn start_of(bytes: &[u8], version: u16, shape_index: u32) -> Result<usize, MeshError> {
    if shape_index == 0 {
        return Ok(0);
    }
    let count = bytes.last_chunk::<4>().map(|c| u32::from_le_bytes(*c)).ok_or_else(cut_off)?;
    if shape_index >= count {
        return Err(MeshError::new(format!("mesh {shape_index} does not exist: there are {count}")));
    }
    let width = if version >= 4 { 8 } else { 4 };
    let back = 4 + (count - shape_index) as usize * width;
    let entry = bytes.len().checked_sub(back).and_then(|at| bytes.get(at..at + width)).ok_or_else(cut_off)?;
    let place = entry.iter().rev().fold(0u64, |place, &byte| place << 8 | u64::from(byte));
    usize::try_from(place).map_err(|_| cut_off())
}

fn cut_off() -> MeshError {
    MeshError::new("the file is cut off")
}

/// The numbers of a mesh as they are unpacked.
struct Stream<'a> {
    decoder: ZlibDecoder<&'a [u8]>,
    /// Bytes that it may hold at most.
    most: u64,
}

impl Stream<'_> {
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], MeshError> {
        let mut out = [0; N];
        self.decoder.read_exact(&mut out).map_err(|_| cut_off())?;
        Ok(out)
    }

    /// Whether so many numbers can be there, before anything is reserved.
    fn check(&self, count: u64, size: u64) -> Result<usize, MeshError> {
        match count.checked_mul(size) {
            Some(needed) if needed <= self.most => Ok(count as usize),
            _ => Err(MeshError::new("its header promises more than the file holds")),
        }
    }

    fn floats(&mut self, count: u64, width: usize, double: bool) -> Result<Vec<f32>, MeshError> {
        let numbers = self.check(count, (width * if double { 8 } else { 4 }) as u64)? * width;
        let mut out = Vec::with_capacity(numbers);
        for _ in 0..numbers {
            let value = if double {
                f64::from_le_bytes(self.bytes()?) as f32
            } else {
                f32::from_le_bytes(self.bytes()?)
            };
            if !value.is_finite() {
                let vertex = out.len() / width;
                return Err(MeshError::new(format!("vertex {vertex} holds a number that is not finite")));
            }
            out.push(value);
        }
        Ok(out)
    }

    fn triangles(&mut self, count: u64, vertices: u64) -> Result<Vec<[u32; 3]>, MeshError> {
        let count = self.check(count, 12)?;
        let mut out = Vec::with_capacity(count);
        for number in 0..count {
            let [a, b, c] = [self.bytes()?, self.bytes()?, self.bytes()?].map(u32::from_le_bytes);
            if let Some(bad) = [a, b, c].into_iter().find(|&i| u64::from(i) >= vertices) {
                let message = format!("face {number}: vertex {bad} does not exist: there are {vertices}");
                return Err(MeshError::new(message));
            }
            out.push([a, b, c]);
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::write::ZlibEncoder;
    use std::io::Write;

    const SINGLE: u32 = 0x1000;
    const PLAIN: MeshOptions = MeshOptions { face_normals: false, flip_tex_coords: false };

    /// A quad whose corners lie at this height.
    fn part(version: u16, flags: u32, height: f64) -> Vec<u8> {
        let mut inside = flags.to_le_bytes().to_vec();
        if version >= 4 {
            inside.extend(b"quad\0");
        }
        inside.extend([4u64, 2].map(u64::to_le_bytes).concat());
        let mut floats = |values: &[f64]| {
            for &v in values {
                if flags & DOUBLE != 0 {
                    inside.extend(v.to_le_bytes());
                } else {
                    inside.extend((v as f32).to_le_bytes());
                }
            }
        };
        floats(&[0.0, 0.0, height, 1.0, 0.0, height, 1.0, 1.0, height, 0.0, 1.0, height]);
        if flags & HAS_NORMALS != 0 {
            floats(&[0.0, 0.0, 2.0].repeat(4));
        }
        if flags & HAS_UVS != 0 {
            floats(&[0.0, 0.25].repeat(4));
        }
        if flags & HAS_COLORS != 0 {
            floats(&[0.1, 0.2, 0.3].repeat(4));
        }
        inside.extend([0u32, 1, 2, 0, 2, 3].map(u32::to_le_bytes).concat());
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(&inside).expect("memory takes all");
        let packed = encoder.finish().expect("memory takes all");
        [&MAGIC.to_le_bytes()[..], &version.to_le_bytes(), &packed].concat()
    }

    fn file(version: u16, parts: &[Vec<u8>]) -> Vec<u8> {
        let mut out = parts.concat();
        let mut place = 0u64;
        for part in parts {
            let bytes = place.to_le_bytes();
            out.extend(&bytes[..if version >= 4 { 8 } else { 4 }]);
            place += part.len() as u64;
        }
        out.extend((parts.len() as u32).to_le_bytes());
        out
    }

    #[test]
    fn both_versions_and_precisions_are_read() {
        for (version, precision) in [(3, 0), (3, SINGLE), (4, SINGLE), (3, DOUBLE), (4, DOUBLE)] {
            let all = HAS_NORMALS | HAS_UVS | HAS_COLORS | precision;
            let bytes = file(version, &[part(version, precision, 1.0), part(version, all, 2.0)]);
            let first = read_serialized(&bytes, 0, PLAIN).expect("the first").mesh;
            assert_eq!((first.positions[2], first.normals[0]), (Vec3::ONE, Vec3::Z));
            assert!(first.uvs.is_empty() && first.colors.is_empty());
            let flip = MeshOptions { flip_tex_coords: true, ..PLAIN };
            let second = read_serialized(&bytes, 1, flip).expect("the second").mesh;
            assert_eq!((second.positions[0].z, second.normals[3]), (2.0, Vec3::Z));
            assert_eq!((second.uvs[1], second.colors[1]), (Vec2::new(0.0, 0.75), Rgb::new(0.1, 0.2, 0.3)));
            assert_eq!(second.triangles, [[0, 1, 2], [0, 2, 3]]);
            let missing = read_serialized(&bytes, 2, PLAIN).expect_err("no third").to_string();
            assert_eq!(missing, "mesh 2 does not exist: there are 2");
        }
        let flat = read_serialized(&part(4, SINGLE | FACE_NORMALS, 0.0), 0, PLAIN).expect("a quad").mesh;
        assert!(flat.normals.is_empty());
    }

    #[test]
    fn damage_is_an_error_and_never_more() {
        let bytes = file(4, &[part(4, HAS_UVS | SINGLE, 1.0), part(4, SINGLE, 2.0)]);
        for length in 0..bytes.len() {
            assert!(read_serialized(&bytes[..length], 1, PLAIN).is_err(), "of {length} bytes");
        }
        let mut state = 7u64;
        for _ in 0..2000 {
            let mut damaged = bytes.clone();
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let at = (state >> 33) as usize % damaged.len();
            damaged[at] ^= 1 << (state >> 60 & 7);
            drop(read_serialized(&damaged, (state >> 20) as u32 & 1, PLAIN));
        }
        let huge = [&MAGIC.to_le_bytes()[..], &[5, 0]].concat();
        let message = read_serialized(&huge, 0, PLAIN).expect_err("a later version").to_string();
        assert_eq!(message, "version 5 cannot be read, only 3 and 4");
        assert!(read_serialized(b"ply\n", 0, PLAIN).is_err());
    }
}
