//! Stanford PLY.

use std::io::Cursor;

use nephroid::color::{Rgb, srgb};
use nephroid::math::{Vec2, Vec3};
use nephroid::shape::Mesh;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

use super::gzip::unpacked;
use super::obj::replace_missing_normals;
use super::ply_binary::{Body, Use, size_of_scalar};
use super::{MeshError, MeshFile, MeshOptions, without_degenerate};

/// Reads a PLY file, as text or binary of either byte order and perhaps packed by gzip, as one mesh: polygons as fans of
/// triangles, elements other than `vertex` and `face` ignored. Without normals in the file the mesh gets smooth ones,
/// unless `face_normals` says otherwise. Colours of vertices that are whole numbers are decoded from sRGB, others are
/// linear.
///
/// # Errors
///
/// A header that promises more than the file holds, a number that is not finite, an index that leads
/// nowhere, no face with an area.
pub fn read_ply(bytes: &[u8], options: MeshOptions) -> Result<MeshFile, MeshError> {
    let bytes = &*unpacked(bytes)?;
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = Parser::<Vertex>::new()
        .read_header(&mut reader)
        .map_err(|error| MeshError::new(format!("not a PLY header: {}", one_line(&error.to_string()))))?;
    let body = (bytes.len() as u64).saturating_sub(reader.get_ref().position());
    check_size(&header, body)?;
    let mut made = Making::new(&header, options)?;
    if header.encoding == Encoding::Ascii {
        for (name, element) in &header.elements {
            match name.as_str() {
                "vertex" => {
                    let vertices = elements::<Vertex>(&mut reader, element, &header)?;
                    vertices.iter().try_for_each(|vertex| made.vertex(&vertex.0))?;
                }
                "face" => {
                    let faces = elements::<Face>(&mut reader, element, &header)?;
                    faces.iter().try_for_each(|face| made.face(&face.0))?;
                }
                _ => drop(elements::<Ignored>(&mut reader, element, &header)?),
            }
        }
    } else {
        let mut body = Body::new(&bytes[bytes.len() - body as usize..], header.encoding);
        for (name, element) in &header.elements {
            match name.as_str() {
                "vertex" => {
                    let wanted = |name: &str| place_of(name).map_or(Use::None, Use::Number);
                    body.elements(element, wanted, |numbers, _| made.vertex(numbers))?;
                }
                "face" => {
                    let wanted = |name: &str| if is_corners(name) { Use::List } else { Use::None };
                    body.elements::<0>(element, wanted, |_, corners| made.face(corners))?;
                }
                _ => body.elements::<0>(element, |_| Use::None, |_, _| Ok(()))?,
            }
        }
    }
    made.finish()
}

/// What a file can say of a vertex: position, normal, texture coordinates and colour.
const NUMBERS: usize = 11;

/// The place of a property among them.
fn place_of(name: &str) -> Option<usize> {
    Some(match name {
        "x" => 0,
        "y" => 1,
        "z" => 2,
        "nx" => 3,
        "ny" => 4,
        "nz" => 5,
        "u" | "s" | "texture_u" => 6,
        "v" | "t" | "texture_v" => 7,
        "r" | "red" => 8,
        "g" | "green" => 9,
        "b" | "blue" => 10,
        _ => return None,
    })
}

fn is_corners(name: &str) -> bool {
    name == "vertex_index" || name == "vertex_indices"
}

/// A mesh as its elements come. Faces may come before the vertices.
struct Making {
    mesh: Mesh,
    options: MeshOptions,
    has_normals: bool,
    has_uvs: bool,
    /// What colours are multiplied by and whether they are encoded, if there are any.
    colors: Option<(f64, bool)>,
    vertices: usize,
    faces: usize,
}

impl Making {
    fn new(header: &Header, options: MeshOptions) -> Result<Self, MeshError> {
        let vertex = header.elements.get("vertex");
        let has = |names: &[&str]| {
            vertex.is_some_and(|e| names.iter().all(|name| e.properties.contains_key(*name)))
        };
        if !has(&["x", "y", "z"]) {
            return Err(MeshError::new("the vertices have no x, y and z"));
        }
        let has_normals = has(&["nx", "ny", "nz"]) && !options.face_normals;
        let has_uvs = has(&["u", "v"]) || has(&["s", "t"]) || has(&["texture_u", "texture_v"]);
        let colors = [["red", "green", "blue"], ["r", "g", "b"]].into_iter().find(|names| has(names));
        let colors = colors.map(|names| {
            match vertex.and_then(|e| e.properties.get(names[0])).map(|property| &property.data_type) {
                Some(PropertyType::Scalar(ScalarType::UChar)) => (1.0 / 255.0, true),
                Some(PropertyType::Scalar(ScalarType::UShort)) => (1.0 / 65_535.0, true),
                _ => (1.0, false),
            }
        });
        let count = |name: &str| header.elements.get(name).map_or(0, |e| e.count);
        let (vertices, faces) = (count("vertex"), count("face"));
        let of_all = |wanted: bool| if wanted { vertices } else { 0 };
        // `check_size` knows that the file is as long.
        let mesh = Mesh {
            positions: Vec::with_capacity(vertices),
            normals: Vec::with_capacity(of_all(has_normals)),
            uvs: Vec::with_capacity(of_all(has_uvs)),
            colors: Vec::with_capacity(of_all(colors.is_some())),
            triangles: Vec::with_capacity(faces),
        };
        Ok(Self { mesh, options, has_normals, has_uvs, colors, vertices, faces: 0 })
    }

    fn vertex(&mut self, numbers: &[f64; NUMBERS]) -> Result<(), MeshError> {
        let mesh = &mut self.mesh;
        if !numbers.iter().all(|v| (*v as f32).is_finite()) {
            let index = mesh.positions.len();
            return Err(MeshError::new(format!("vertex {index} holds a number that is not finite")));
        }
        let [x, y, z, nx, ny, nz, u, v, ..] = numbers.map(|v| v as f32);
        mesh.positions.push(Vec3::new(x, y, z));
        if self.has_normals {
            mesh.normals.push(Vec3::new(nx, ny, nz).try_normalize().unwrap_or(Vec3::ZERO));
        }
        if self.has_uvs {
            mesh.uvs.push(Vec2::new(u, if self.options.flip_tex_coords { 1.0 - v } else { v }));
        }
        if let Some((scale, encoded)) = self.colors {
            let value = |v: f64| (v * scale) as f32;
            let color = Rgb::from([numbers[8], numbers[9], numbers[10]].map(value));
            mesh.colors.push(if encoded { color.map(srgb::decode) } else { color });
        }
        Ok(())
    }

    fn face(&mut self, corners: &[i64]) -> Result<(), MeshError> {
        let (number, vertices) = (self.faces, self.vertices);
        self.faces += 1;
        let index = |i: i64| match u32::try_from(i) {
            Ok(index) if (index as usize) < vertices => Ok(index),
            _ => {
                let message = format!("face {number}: vertex {i} does not exist: there are {vertices}");
                Err(MeshError::new(message))
            }
        };
        for &corner in corners {
            index(corner)?;
        }
        if corners.len() < 3 {
            let message = format!("face {number} has {} corners instead of at least 3", corners.len());
            return Err(MeshError::new(message));
        }
        for pair in corners[1..].windows(2) {
            self.mesh.triangles.push([index(corners[0])?, index(pair[0])?, index(pair[1])?]);
        }
        Ok(())
    }

    fn finish(self) -> Result<MeshFile, MeshError> {
        let Self { mut mesh, options, has_normals, .. } = self;
        if has_normals {
            replace_missing_normals(&mut mesh);
        } else if !options.face_normals {
            mesh.compute_normals();
        }
        mesh.triangles.shrink_to_fit();
        without_degenerate(mesh, has_normals)
    }
}

fn elements<E: PropertyAccess>(
    reader: &mut Reader<Cursor<&[u8]>>,
    element: &ElementDef,
    header: &Header,
) -> Result<Vec<E>, MeshError> {
    Parser::<E>::new().read_payload_for_element(reader, element, header).map_err(|error| {
        let line = error.line();
        let message = format!("broken {}: {}", element.name, one_line(&error.to_string()));
        MeshError { line, message, is_flat: false }
    })
}

/// Compares what the header promises with the bytes that follow it, before anything is reserved.
fn check_size(header: &Header, body: u64) -> Result<(), MeshError> {
    let ascii = header.encoding == Encoding::Ascii;
    let mut needed: u64 = 0;
    for (name, element) in &header.elements {
        if element.properties.is_empty() && element.count > 0 {
            return Err(MeshError::new(format!("the element \"{name}\" has no properties")));
        }
        let least: u64 = element
            .properties
            .iter()
            .map(|(_, property)| match &property.data_type {
                // A digit and a blank.
                _ if ascii => 2,
                PropertyType::Scalar(kind) | PropertyType::List(kind, _) => size_of_scalar(kind),
            })
            .sum();
        needed = needed.saturating_add(least.saturating_mul(element.count as u64));
    }
    // The last line of a text may lack its end.
    if needed > body.saturating_add(u64::from(ascii)) {
        let message = format!("the header promises at least {needed} bytes, but {body} follow it");
        return Err(MeshError::new(message));
    }
    Ok(())
}

fn one_line(text: &str) -> String {
    // What follows is the parser's own state.
    let text = text.split("Error:").next().unwrap_or_default();
    text.split_whitespace().collect::<Vec<_>>().join(" ").chars().take(200).collect()
}

/// The numbers of a vertex.
struct Vertex([f64; NUMBERS]);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self([0.0; NUMBERS])
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(place) = place_of(name) else { return PropertyAccessResult::Ignored };
        self.0[place] = match property {
            Property::Char(v) => f64::from(v),
            Property::UChar(v) => f64::from(v),
            Property::Short(v) => f64::from(v),
            Property::UShort(v) => f64::from(v),
            Property::Int(v) => f64::from(v),
            Property::UInt(v) => f64::from(v),
            Property::Float(v) => f64::from(v),
            Property::Double(v) => v,
            _ => f64::NAN,
        };
        PropertyAccessResult::Set
    }
}

/// Indices of vertices.
struct Face(Vec<i64>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !is_corners(name) {
            return PropertyAccessResult::Ignored;
        }
        self.0 = match property {
            Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUInt(list) => list.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}

/// An element that does not matter.
struct Ignored;

impl PropertyAccess for Ignored {
    fn new() -> Self {
        Self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: MeshOptions = MeshOptions { face_normals: false, flip_tex_coords: false };

    fn header(encoding: &str) -> String {
        format!(
            "ply\nformat {encoding} 1.0\ncomment a quad\nelement vertex 4\nproperty float x\nproperty float y\n\
             property double z\nproperty uchar quality\nproperty float s\nproperty float t\nelement face 1\n\
             property list uchar int vertex_indices\nend_header\n"
        )
    }

    const CORNERS: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

    fn binary(big: bool) -> Vec<u8> {
        let mut out = header(if big { "binary_big_endian" } else { "binary_little_endian" }).into_bytes();
        let float = |v: f32| if big { v.to_be_bytes() } else { v.to_le_bytes() };
        for [x, y] in CORNERS {
            out.extend(float(x));
            out.extend(float(y));
            out.extend([0; 8]);
            out.push(200);
            out.extend(float(x));
            out.extend(float(0.25));
        }
        out.push(4);
        for i in 0..4i32 {
            out.extend(if big { i.to_be_bytes() } else { i.to_le_bytes() });
        }
        out
    }

    fn text() -> String {
        let rows: String = CORNERS.iter().map(|[x, y]| format!("{x} {y} 0 200 {x} 0.25\n")).collect();
        format!("{}{rows}4 0 1 2 3\n", header("ascii"))
    }

    #[test]
    fn all_encodings_give_the_same_mesh() {
        let mesh = read_ply(text().as_bytes(), PLAIN).unwrap().mesh;
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.positions[2], Vec3::new(1.0, 1.0, 0.0));
        assert_eq!(mesh.uvs[1], Vec2::new(1.0, 0.25));
        assert_eq!(mesh.normals, [Vec3::Z; 4]);
        assert_eq!(read_ply(&binary(true), PLAIN).unwrap().mesh, mesh);
        assert_eq!(read_ply(&binary(false), PLAIN).unwrap().mesh, mesh);
        assert_eq!(read_ply(text().replace('\n', "\r\n").as_bytes(), PLAIN).unwrap().mesh, mesh);
        assert_eq!(read_ply(text().trim_end().as_bytes(), PLAIN).unwrap().mesh, mesh);
    }

    #[test]
    fn packed_files_are_unpacked() {
        use std::io::Write;
        let plain = read_ply(&binary(false), PLAIN).expect("a sound file");
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(&binary(false)).expect("memory takes all");
        let packed = encoder.finish().expect("memory takes all");
        assert_eq!(read_ply(&packed, PLAIN).expect("the same"), plain);
        assert!(read_ply(&packed[..packed.len() - 9], PLAIN).is_err());
    }

    #[test]
    fn colours_of_vertices_are_read() {
        let file = |kind: &str, colors: [&str; 3]| {
            let properties: String =
                ["x", "y", "z"].iter().map(|name| format!("property float {name}\n")).collect();
            let of_colors: String = ["red", "green", "blue", "alpha"]
                .iter()
                .map(|name| format!("property {kind} {name}\n"))
                .collect();
            let [a, b, c] = colors;
            format!(
                "ply\nformat ascii 1.0\nelement vertex 3\n{properties}{of_colors}element face 1\n\
                 property list uchar int vertex_index\nend_header\n0 0 0 {a}\n1 0 0 {b}\n0 1 0 {c}\n3 0 1 2\n"
            )
        };
        let colors = |text: String| read_ply(text.as_bytes(), PLAIN).expect("a sound file").mesh.colors;
        let bytes = colors(file("uchar", ["0 255 128 9", "0 0 0 0", "255 255 255 255"]));
        assert_eq!(bytes[0], Rgb::new(0.0, 1.0, srgb::decode((128.0f64 / 255.0) as f32)));
        assert_eq!(bytes[2], Rgb::WHITE);
        let floats = colors(file("float", ["0.1 0.2 3 1", "0 0 0 1", "0 0 0 1"]));
        assert_eq!(floats[0], Rgb::new(0.1, 0.2, 3.0));
        assert!(read_ply(text().as_bytes(), PLAIN).expect("a sound file").mesh.colors.is_empty());
    }

    #[test]
    fn options_count() {
        let flat = MeshOptions { face_normals: true, flip_tex_coords: true };
        let mesh = read_ply(text().as_bytes(), flat).unwrap().mesh;
        assert_eq!((mesh.uvs[1], mesh.normals.len()), (Vec2::new(1.0, 0.75), 0));
    }

    #[test]
    fn headers_that_promise_too_much() {
        let huge = text().replace("vertex 4", "vertex 2147483647");
        let error = read_ply(huge.as_bytes(), PLAIN).unwrap_err().to_string();
        assert_eq!(error, "the header promises at least 25769803766 bytes, but 78 follow it");
        assert!(read_ply(&binary(true)[..250], PLAIN).is_err());
        let cut = binary(false);
        assert!(read_ply(&cut[..cut.len() - 3], PLAIN).is_err());
        let mut long_list = binary(false);
        let place = long_list.len() - 17;
        long_list[place] = 255;
        assert!(read_ply(&long_list, PLAIN).is_err());
    }

    #[test]
    fn broken_contents() {
        let check = |text: String, expected: &str| {
            let error = read_ply(text.as_bytes(), PLAIN).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        };
        check(text().replace("4 0 1 2 3", "4 0 1 2 4"), "face 0: vertex 4 does not exist: there are 4");
        check(text().replace("4 0 1 2 3", "4 0 1 2 -1"), "face 0: vertex -1 does not exist");
        check(text().replace("4 0 1 2 3", "2 0 1"), "face 0 has 2 corners instead of at least 3");
        check(text().replace("1 1 0 200", "1 nan 0 200"), "line 16: broken vertex");
        check(text().replace("1 1 0 200", "1 1 1e99 200"), "vertex 2 holds a number that is not finite");
        check(text().replace("face 1", "face 0"), "the file has no faces");
        check(text().replace("float x", "float q"), "the vertices have no x, y and z");
        check("solid".into(), "not a PLY header");
        check(String::new(), "not a PLY header");
    }
}
