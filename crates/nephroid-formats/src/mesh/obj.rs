//! Wavefront OBJ.

use std::collections::HashMap;

use nephroid::color::{Rgb, srgb};
use nephroid::math::{Vec2, Vec3};
use nephroid::shape::Mesh;

use super::{MeshError, MeshFile, MeshOptions, without_degenerate};

/// Reads the faces of an OBJ file as one mesh: polygons as fans of triangles, groups and materials
/// ignored. Corners without a normal get a smooth one, unless `face_normals` says otherwise. Colours behind the
/// coordinates of vertices are decoded from sRGB, as programs that paint vertices write them.
///
/// # Errors
///
/// A number that is not finite, an index that leads nowhere, no face with an area.
pub fn read_obj(bytes: &[u8], options: MeshOptions) -> Result<MeshFile, MeshError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut file = Obj::default();
    for (number, line) in (1..).zip(bytes.split(|b| *b == b'\n')) {
        let line = String::from_utf8_lossy(line);
        let line = line.split('#').next().unwrap_or_default();
        let mut words = line.split_ascii_whitespace();
        let read = match words.next() {
            Some("v") => file.vertex(words),
            Some("vn") => numbers(words).map(|[x, y, z]| file.normals.push(Vec3::new(x, y, z))),
            Some("vt") => numbers(words).map(|[u, v]| {
                let v = if options.flip_tex_coords { 1.0 - v } else { v };
                file.uvs.push(Vec2::new(u, v));
            }),
            Some("f") => file.face(words),
            _ => Ok(()),
        };
        read.map_err(|message| MeshError::at(number, message))?;
    }
    let has_own_normals = !file.normals.is_empty() && !options.face_normals;
    without_degenerate(file.into_mesh(options), has_own_normals)
}

/// The first `N` numbers of a line.
fn numbers<'l, const N: usize>(mut words: impl Iterator<Item = &'l str>) -> Result<[f32; N], String> {
    let mut out = [0.0; N];
    for (i, value) in out.iter_mut().enumerate() {
        let Some(word) = words.next() else {
            // A texture coordinate may lack its v.
            if N == 2 && i == 1 {
                break;
            }
            return Err(format!("expected {N} numbers, found {i}"));
        };
        *value = word.parse::<f32>().ok().filter(|v| v.is_finite()).ok_or_else(|| {
            let shown: String = word.chars().take(40).collect();
            format!("\"{shown}\" is not a finite number")
        })?;
    }
    Ok(out)
}

/// Indices from 0 of a position, a texture coordinate and a normal.
type Corner = (u32, Option<u32>, Option<u32>);

#[derive(Default)]
struct Obj {
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    /// A colour for each position, if any has one.
    colors: Vec<Rgb>,
    triangles: Vec<[Corner; 3]>,
}

impl Obj {
    /// Three coordinates, perhaps with three channels of a colour behind.
    fn vertex<'l>(&mut self, words: impl Iterator<Item = &'l str> + Clone) -> Result<(), String> {
        let [x, y, z] = numbers(words.clone())?;
        let number = self.positions.len();
        self.positions.push(Vec3::new(x, y, z));
        let has_color = words.clone().count() >= 6;
        if has_color && self.colors.is_empty() {
            self.colors.resize(number, Rgb::WHITE);
        }
        if has_color || !self.colors.is_empty() {
            let color = if has_color { Rgb::from(numbers::<3>(words.skip(3))?) } else { Rgb::WHITE };
            self.colors.push(color.map(srgb::decode));
        }
        Ok(())
    }

    fn face<'l>(&mut self, words: impl Iterator<Item = &'l str>) -> Result<(), String> {
        let corners = words.map(|word| self.corner(word)).collect::<Result<Vec<_>, _>>()?;
        if corners.len() < 3 {
            return Err(format!("a face has at least 3 corners, not {}", corners.len()));
        }
        self.triangles.extend(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &str) -> Result<Corner, String> {
        let mut parts = word.split('/');
        let position = index(parts.next().unwrap_or_default(), self.positions.len(), "vertex")?;
        let position = position.ok_or_else(|| "a corner of a face has no vertex".to_string())?;
        let uv = index(parts.next().unwrap_or_default(), self.uvs.len(), "texture coordinate")?;
        let normal = index(parts.next().unwrap_or_default(), self.normals.len(), "normal")?;
        match parts.next() {
            None => Ok((position, uv, normal)),
            Some(_) => {
                Err(format!("\"{}\" is not a corner of a face", word.chars().take(40).collect::<String>()))
            }
        }
    }

    /// One vertex for each different corner, in the order of their first use.
    fn into_mesh(self, options: MeshOptions) -> Mesh {
        let corners = || self.triangles.iter().flatten();
        let has_uvs = corners().any(|c| c.1.is_some());
        let smooth = if !options.face_normals && corners().any(|c| c.2.is_none()) {
            self.smooth_normals()
        } else {
            Vec::new()
        };
        let mut mesh = Mesh::default();
        let mut vertices: HashMap<Corner, u32> = HashMap::new();
        for triangle in &self.triangles {
            let vertex = |corner: &Corner| {
                let corner = if options.face_normals { (corner.0, corner.1, None) } else { *corner };
                *vertices.entry(corner).or_insert_with(|| {
                    mesh.positions.push(self.positions[corner.0 as usize]);
                    if let Some(color) = self.colors.get(corner.0 as usize) {
                        mesh.colors.push(*color);
                    }
                    if has_uvs {
                        mesh.uvs.push(corner.1.map_or(Vec2::ZERO, |i| self.uvs[i as usize]));
                    }
                    if !options.face_normals {
                        let given = corner.2.and_then(|i| self.normals[i as usize].try_normalize());
                        let smooth = || smooth.get(corner.0 as usize).copied();
                        mesh.normals.push(given.or_else(smooth).unwrap_or(Vec3::ZERO));
                    }
                    (mesh.positions.len() - 1) as u32
                })
            };
            let indices = [&triangle[0], &triangle[1], &triangle[2]].map(vertex);
            mesh.triangles.push(indices);
        }
        replace_missing_normals(&mut mesh);
        mesh
    }

    /// A normal for each position, across the seams of texture coordinates.
    fn smooth_normals(&self) -> Vec<Vec3> {
        let mut mesh = Mesh {
            positions: self.positions.clone(),
            triangles: self.triangles.iter().map(|t| [t[0].0, t[1].0, t[2].0]).collect(),
            ..Mesh::default()
        };
        mesh.compute_normals();
        mesh.normals
    }
}

/// Puts smooth normals where the file gives one of no length.
pub(crate) fn replace_missing_normals(mesh: &mut Mesh) {
    if !mesh.normals.contains(&Vec3::ZERO) {
        return;
    }
    let mut smooth = mesh.clone();
    smooth.compute_normals();
    for (normal, smooth) in mesh.normals.iter_mut().zip(smooth.normals) {
        if *normal == Vec3::ZERO {
            *normal = smooth;
        }
    }
}

/// An index from 0, from one that counts from 1, or back from the last if negative.
fn index(word: &str, count: usize, what: &str) -> Result<Option<u32>, String> {
    if word.is_empty() {
        return Ok(None);
    }
    let shown: String = word.chars().take(40).collect();
    let written: i64 = word.parse().map_err(|_| format!("\"{shown}\" is not an index"))?;
    let count = count as i64;
    let from_zero = if written < 0 { count.saturating_add(written) } else { written - 1 };
    match u32::try_from(from_zero) {
        Ok(index) if i64::from(index) < count => Ok(Some(index)),
        _ => Err(format!("{what} {shown} does not exist: there are {count} so far")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLIP: MeshOptions = MeshOptions { face_normals: false, flip_tex_coords: true };

    #[test]
    fn a_quad_with_everything() {
        let text = "mtllib missing.mtl\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nvt 0 0.25 7\r\nvn 0 0 2\r\n\
                    usemtl x\r\nf 1/1/1 2/1/1 -2/1/1 -1/1/1 # quad\r\n";
        let file = read_obj(text.as_bytes(), FLIP).unwrap();
        assert_eq!(file.degenerate, 0);
        assert_eq!(file.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(file.mesh.positions[2], Vec3::new(1.0, 1.0, 0.0));
        assert_eq!(file.mesh.uvs, [Vec2::new(0.0, 0.75); 4]);
        assert_eq!(file.mesh.normals, [Vec3::Z; 4]);
        let flat = MeshOptions { face_normals: true, flip_tex_coords: false };
        let mesh = read_obj(text.as_bytes(), flat).unwrap().mesh;
        assert_eq!((mesh.uvs[0], mesh.normals.len()), (Vec2::new(0.0, 0.25), 0));
    }

    #[test]
    fn missing_normals_are_smooth_across_texture_seams() {
        // A roof of two faces whose texture is cut along the ridge.
        let text = "v 0 0 1\nv 0 1 1\nv -1 0 0\nv 1 0 0\nvt 0 0\nvt 1 0\nf 1/1 2/1 3/1\nf 1/2 4/2 2/2\n";
        let mesh = read_obj(text.as_bytes(), FLIP).unwrap().mesh;
        assert_eq!(mesh.positions.len(), 6);
        assert_eq!(mesh.normals[0], mesh.normals[3]);
        assert!((mesh.normals[0] - Vec3::Z).length() < 1e-6);
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2 3\n";
        let mesh = read_obj(text.as_bytes(), FLIP).unwrap().mesh;
        assert_eq!(mesh.normals, [Vec3::X, Vec3::Z, Vec3::Z]);
        assert!(mesh.uvs.is_empty());
    }

    #[test]
    fn vertices_may_have_colours() {
        let text = "v 0 0 0\nv 1 0 0 1 0 0.5\nv 0 1 0 0 1 0\nv 0 0 1 1\nf 1 2 3\nf 2 3 4\n";
        let mesh = read_obj(text.as_bytes(), FLIP).expect("a sound file").mesh;
        let red = Rgb::new(1.0, 0.0, srgb::decode(0.5));
        assert_eq!(mesh.colors, [Rgb::WHITE, red, Rgb::new(0.0, 1.0, 0.0), Rgb::WHITE]);
        assert!(read_obj(b"v 0 0 0 1 nan 0\n", FLIP).is_err());
    }

    #[test]
    fn faces_without_area_are_counted() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\n";
        let file = read_obj(text.as_bytes(), FLIP).unwrap();
        assert_eq!((file.mesh.triangles.len(), file.degenerate), (1, 2));
    }

    #[test]
    fn what_is_wrong_has_a_line() {
        let check = |text: &str, expected: &str| {
            assert_eq!(read_obj(text.as_bytes(), FLIP).unwrap_err().to_string(), expected);
        };
        check("v 0 0 nan", "line 1: \"nan\" is not a finite number");
        check("\nv 0 0", "line 2: expected 3 numbers, found 2");
        check("v 0 0 0\nf 1 1 2", "line 2: vertex 2 does not exist: there are 1 so far");
        check("v 0 0 0\nf 1 1 -2", "line 2: vertex -2 does not exist: there are 1 so far");
        check("v 0 0 0\nf 1 1 0", "line 2: vertex 0 does not exist: there are 1 so far");
        check("v 0 0 0\nf 1 1 99999999999", "line 2: vertex 99999999999 does not exist: there are 1 so far");
        check("v 0 0 0\nf 1/1 1 1", "line 2: texture coordinate 1 does not exist: there are 0 so far");
        check("v 0 0 0\nf 1 1", "line 2: a face has at least 3 corners, not 2");
        check("v 0 0 0\nf /1 1 1", "line 2: a corner of a face has no vertex");
        check("v 0 0 0\nf 1 1 1", "no face of the file has an area");
        check("", "the file has no faces");
    }
}
