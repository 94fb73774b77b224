//! Meshes that must be refused, and the messages a user sees.

use nephroid_formats::mesh::{MeshOptions, read_obj, read_ply};

/// Flips nothing and makes smooth normals.
const PLAIN: MeshOptions = MeshOptions { face_normals: false, flip_tex_coords: false };

/// Three corners of a triangle, for faces to refer to; four lines.
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[track_caller]
fn obj(bytes: impl AsRef<[u8]>, expected: &str) {
    let bytes = bytes.as_ref();
    let error = read_obj(bytes, PLAIN).expect_err("it must be refused").to_string();
    assert_eq!(error, expected, "\n{}", String::from_utf8_lossy(bytes));
}

/// An OBJ file of [`OBJ`] and more.
#[track_caller]
fn obj_with(more: &str, expected: &str) {
    obj(format!("{OBJ}{more}"), expected);
}

#[track_caller]
fn ply(bytes: impl AsRef<[u8]>, expected: &str) {
    let bytes = bytes.as_ref();
    let error = read_ply(bytes, PLAIN).expect_err("it must be refused").to_string();
    assert_eq!(error, expected, "\n{}", String::from_utf8_lossy(bytes));
}

/// The header of three vertices, and of faces with indices of the types given.
fn header(encoding: &str, faces: u64, list: &str) -> String {
    format!(
        "ply\nformat {encoding} 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list {list} vertex_indices\nend_header\n"
    )
}

const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// A text of the triangle whose one face is `face`.
fn text(face: &str) -> String {
    header("ascii", 1, "uchar int") + "0 0 0\n1 0 0\n0 1 0\n" + face + "\n"
}

/// A binary file of the corners and then of any bytes.
fn binary(corners: [[f32; 3]; 3], list: &str, rest: &[u8]) -> Vec<u8> {
    let mut out = header("binary_little_endian", 1, list).into_bytes();
    out.extend(corners.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
    out.extend(rest);
    out
}

/// A triangle with one coordinate replaced.
fn with_corner(value: f32) -> Vec<u8> {
    binary([CORNERS[0], [1.0, value, 0.0], CORNERS[2]], "uchar uchar", &[3, 0, 1, 2])
}

#[test]
fn obj_numbers() {
    obj("v 0 0 nan\n", "line 1: \"nan\" is not a finite number");
    obj("v 0 NaN 0\n", "line 1: \"NaN\" is not a finite number");
    obj("v inf 0 0\n", "line 1: \"inf\" is not a finite number");
    obj("v -infinity 0 0\n", "line 1: \"-infinity\" is not a finite number");
    obj("v 0 1e39 0\n", "line 1: \"1e39\" is not a finite number");
    obj("v 0 -1e999 0\n", "line 1: \"-1e999\" is not a finite number");
    obj("v 0,5 0 0\n", "line 1: \"0,5\" is not a finite number");
    obj("v 0x10 0 0\n", "line 1: \"0x10\" is not a finite number");
    obj("v 1.0.0 0 0\n", "line 1: \"1.0.0\" is not a finite number");
    obj("v a b c\n", "line 1: \"a\" is not a finite number");
    obj("v\n", "line 1: expected 3 numbers, found 0");
    obj("v 1\n", "line 1: expected 3 numbers, found 1");
    obj("v 1 2 # 3\n", "line 1: expected 3 numbers, found 2");
    obj("vt\n", "line 1: expected 2 numbers, found 0");
    obj("vt nan\n", "line 1: \"nan\" is not a finite number");
    obj("vn 0 0 inf\n", "line 1: \"inf\" is not a finite number");
    obj("vn 0 1\n", "line 1: expected 3 numbers, found 2");
    obj(
        format!("v 0 0 {}\n", "9".repeat(100_000)),
        "line 1: \"9999999999999999999999999999999999999999\" is not a finite number",
    );
    obj(b"v 0 0 \xff\xfe\n", "line 1: \"��\" is not a finite number");
    obj("v 0 0 \u{ff11}\n", "line 1: \"１\" is not a finite number");
    obj("v 0 0 0\0\n", "line 1: \"0\0\" is not a finite number");
}

#[test]
fn obj_indices() {
    obj_with("f 1 2 0\n", "line 4: vertex 0 does not exist: there are 3 so far");
    obj_with("f 1 2 4\n", "line 4: vertex 4 does not exist: there are 3 so far");
    obj_with("f 1 2 -4\n", "line 4: vertex -4 does not exist: there are 3 so far");
    obj_with("f 1 2 4294967297\n", "line 4: vertex 4294967297 does not exist: there are 3 so far");
    obj_with(
        "f 1 2 9223372036854775807\n",
        "line 4: vertex 9223372036854775807 does not exist: there are 3 so far",
    );
    obj_with(
        "f 1 2 -9223372036854775808\n",
        "line 4: vertex -9223372036854775808 does not exist: there are 3 so far",
    );
    obj_with("f 1 2 9223372036854775808\n", "line 4: \"9223372036854775808\" is not an index");
    obj_with("f 1 2 1.5\n", "line 4: \"1.5\" is not an index");
    obj_with("f 1 2 x\n", "line 4: \"x\" is not an index");
    obj_with("f 1/1 2/1 3/1\n", "line 4: texture coordinate 1 does not exist: there are 0 so far");
    obj_with("vt 0 0\nf 1/1 2/2 3/1\n", "line 5: texture coordinate 2 does not exist: there are 1 so far");
    obj_with("f 1//1 2//1 3//1\n", "line 4: normal 1 does not exist: there are 0 so far");
    obj_with("vn 0 0 1\nf 1//-2 2//1 3//1\n", "line 5: normal -2 does not exist: there are 1 so far");
    obj_with("vt 0 0\nvn 0 0 1\nf 1/1/1/1 2 3\n", "line 6: \"1/1/1/1\" is not a corner of a face");
    obj_with("f //1 2 3\n", "line 4: a corner of a face has no vertex");
    obj_with("f 1, 2, 3\n", "line 4: \"1,\" is not an index");
    obj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", "line 1: vertex 1 does not exist: there are 0 so far");
    obj(
        format!("{}f 1 2 4\r\n", OBJ.replace('\n', "\r\n")),
        "line 4: vertex 4 does not exist: there are 3 so far",
    );
}

#[test]
fn obj_faces() {
    obj("", "the file has no faces");
    obj("\u{feff}", "the file has no faces");
    obj("# only a comment", "the file has no faces");
    obj(OBJ, "the file has no faces");
    obj_with("f\n", "line 4: a face has at least 3 corners, not 0");
    obj_with("f 1\n", "line 4: a face has at least 3 corners, not 1");
    obj_with("f 1 2\n", "line 4: a face has at least 3 corners, not 2");
    obj_with("f 1 1 1\n", "no face of the file has an area");
    obj_with("f 1 2 2\nf 3 3 1\n", "no face of the file has an area");
    obj("v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n", "no face of the file has an area");
    obj("v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n", "no face of the file has an area");
    obj(b"\xff\xfev\x00 \x000\x00", "the file has no faces");
    obj(OBJ.replace('\n', "\r"), "line 1: \"v\" is not a finite number");
}

#[test]
fn ply_headers() {
    ply("", "not a PLY header: Unexpected end of file while reading magic number.");
    ply("PLY\n", "not a PLY header: Line 1: Expected magic number 'ply'. String: 'PLY '");
    ply(
        "ply",
        "not a PLY header: Line 2: Unexpected end of file while reading header (missing 'end_header').",
    );
    ply("ply\nend_header\n", "not a PLY header: No format line found.");
    ply(
        "ply\nformat ascii 1.0\n",
        "not a PLY header: Line 3: Unexpected end of file while reading header (missing 'end_header').",
    );
    ply("ply\nformat ascii 1.0\nend_header\n", "the vertices have no x, y and z");
    ply(
        "ply\nformat ebcdic 1.0\nend_header\n",
        "not a PLY header: Line 2: Couldn't parse line. String: 'format ebcdic 1.0 '",
    );
    ply(
        "ply\nformat ascii 1.0\nformat binary_big_endian 1.0\nend_header\n",
        "not a PLY header: Line 3: Found contradicting format definition: Encoding: BinaryBigEndian, Version: Some(Version { major: 1, minor: 0 }) previous definition: Encoding: Ascii, Version: Some(Version { major: 1, minor: 0",
    );
    ply(
        "ply\nformat ascii 1.0\nelement vertex\nend_header\n",
        "not a PLY header: Line 3: Couldn't parse line. String: 'element vertex '",
    );
    ply(
        "ply\nformat ascii 1.0\nelement vertex -1\nend_header\n",
        "not a PLY header: Line 3: Couldn't parse line. String: 'element vertex -1 '",
    );
    ply(
        "ply\nformat ascii 1.0\nelement vertex 99999999999999999999999\nend_header\n",
        "not a PLY header: Line 3: Invalid element String: 'element vertex 99999999999999999999999 '",
    );
    ply("ply\nformat ascii 1.0\nelement vertex 3\nend_header\n", "the element \"vertex\" has no properties");
    ply(
        "ply\nformat ascii 1.0\nproperty float x\nend_header\n",
        "not a PLY header: Line 3: Property 'PropertyDef { name: \"x\", data_type: Scalar(Float) }' found without preceding element. String: 'property float x '",
    );
    ply(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n",
        "not a PLY header: Line 4: Couldn't parse line. String: 'property quad x '",
    );
    ply(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar x\nend_header\n",
        "not a PLY header: Line 4: Couldn't parse line. String: 'property list uchar x '",
    );
    ply(
        b"ply\nformat ascii 1.0\ncomment \xe9\nend_header\n",
        "not a PLY header: stream did not contain valid UTF-8",
    );
    ply(
        "\u{feff}ply\nformat ascii 1.0\nend_header\n",
        "not a PLY header: Line 1: Expected magic number 'ply'. String: '\u{feff}ply '",
    );
    ply(text("3 0 1 2").replace("float z", "float depth"), "the vertices have no x, y and z");
    ply(text("3 0 1 2").replace("vertex 3", "point 3"), "the vertices have no x, y and z");
    ply(text("3 0 1 2").replace("element face", "element facet"), "the file has no faces");
    ply(text("3 0 1 2").replace("vertex_indices", "corners"), "face 0 has 0 corners instead of at least 3");
    ply(
        text("3 0 1 2")
            .replace("float x", "list uchar float x")
            .replace("0 0 0\n1 0 0\n0 1 0", "1 0 0 0\n1 1 0 0\n1 0 1 0"),
        "vertex 0 holds a number that is not finite",
    );
}

#[test]
fn ply_sizes() {
    ply(
        text("3 0 1 2").replace("vertex 3", "vertex 4000000000"),
        "the header promises at least 24000000002 bytes, but 26 follow it",
    );
    ply(
        text("3 0 1 2").replace("face 1", "face 4000000000"),
        "the header promises at least 8000000018 bytes, but 26 follow it",
    );
    ply(
        text("3 0 1 2").replace("face 1", "face 18446744073709551615"),
        "the header promises at least 18446744073709551615 bytes, but 26 follow it",
    );
    ply(
        header("binary_little_endian", 4_000_000_000, "uchar int"),
        "the header promises at least 4000000036 bytes, but 0 follow it",
    );
    ply(
        header("binary_big_endian", u64::MAX, "uchar int"),
        "the header promises at least 18446744073709551615 bytes, but 0 follow it",
    );
    // A list that says that it is long: 2³¹, 2³² − 1, less than nothing, and a little too long.
    ply(binary(CORNERS, "uint int", &[0, 0, 0, 0x80, 1, 2, 3, 4]), "face 0 is cut off");
    ply(binary(CORNERS, "uint double", &[0xff, 0xff, 0xff, 0xff]), "face 0 is cut off");
    ply(binary(CORNERS, "int int", &[0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0]), "face 0 has a list of length -1");
    ply(binary(CORNERS, "char int", &[0x80, 0, 0, 0, 0]), "face 0 has a list of length -128");
    ply(binary(CORNERS, "uchar uchar", &[4, 0, 1, 2]), "face 0 is cut off");
    ply(
        text("2147483648 0 1 2").replace("uchar int", "uint int"),
        "line 13: broken face: Line 13: Couldn't read element line. String: '2147483648 0 1 2 '",
    );
    ply(
        text("-1 0 1 2").replace("uchar int", "int int"),
        "line 13: broken face: Line 13: Couldn't read element line. String: '-1 0 1 2 '",
    );
    ply(text("256 0 1 2"), "line 13: broken face: Line 13: Couldn't read element line. String: '256 0 1 2 '");
    // Cut off in the vertices, before the faces, in an index.
    let whole = binary(CORNERS, "uchar int", &[3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    let body = whole.len() - 49;
    ply(&whole[..body + 5], "the header promises at least 37 bytes, but 5 follow it");
    ply(&whole[..body + 36], "the header promises at least 37 bytes, but 36 follow it");
    ply(&whole[..whole.len() - 1], "face 0 is cut off");
    // Fewer and more rows than the header says.
    ply(text("3 0 1 2").replace("vertex 3", "vertex 2"), "face 0 has 0 corners instead of at least 3");
    ply(
        text("3 0 1 2").replace("vertex 3", "vertex 4"),
        "line 14: broken face: Line 14: Unexpected end of file while reading element 'face' (expected 1, got 0).",
    );
    ply(
        text("3 0 1 2").replace("face 1", "face 2"),
        "line 14: broken face: Line 14: Unexpected end of file while reading element 'face' (expected 2, got 1).",
    );
    ply(text(""), "line 13: broken face: Line 13: Couldn't read element line. String: ' '");
}

#[test]
fn ply_numbers() {
    ply(with_corner(f32::NAN), "vertex 1 holds a number that is not finite");
    ply(with_corner(f32::INFINITY), "vertex 1 holds a number that is not finite");
    ply(with_corner(f32::NEG_INFINITY), "vertex 1 holds a number that is not finite");
    ply(
        text("3 0 1 2").replace("1 0 0", "1 nan 0"),
        "line 11: broken vertex: Line 11: Couldn't read element line. String: '1 nan 0 '",
    );
    ply(text("3 0 1 2").replace("1 0 0", "1 1e39 0"), "vertex 1 holds a number that is not finite");
    ply(
        text("3 0 1 2").replace("1 0 0", "1 0,5 0"),
        "line 11: broken vertex: Line 11: Couldn't read element line. String: '1 0,5 0 '",
    );
    ply(
        text("3 0 1 2").replace("1 0 0", "1 0"),
        "line 11: broken vertex: Line 11: Couldn't read element line. String: '1 0 '",
    );
    ply(
        text("3 0 1 2").replace("1 0 0", "1 x 0").replace('\n', "\r\n"),
        "line 11: broken vertex: Line 11: Couldn't read element line. String: '1 x 0 '",
    );
    ply(
        text("3 0 1 2").replace("float y", "double y").replace("1 0 0", "1 1e200 0"),
        "vertex 1 holds a number that is not finite",
    );
    ply(
        text("3 0 1 2").replace("float y", "uchar y").replace("1 0 0", "1 256 0"),
        "line 11: broken vertex: Line 11: Couldn't read element line. String: '1 256 0 '",
    );
}

#[test]
fn ply_faces() {
    ply(text("3 0 1 3"), "face 0: vertex 3 does not exist: there are 3");
    ply(text("3 0 1 -1"), "face 0: vertex -1 does not exist: there are 3");
    ply(
        text("3 0 1 4294967296"),
        "line 13: broken face: Line 13: Couldn't read element line. String: '3 0 1 4294967296 '",
    );
    ply(text("3 0 1 1.5"), "line 13: broken face: Line 13: Couldn't read element line. String: '3 0 1 1.5 '");
    ply(text("3 0 1"), "line 13: broken face: Line 13: Couldn't read element line. String: '3 0 1 '");
    ply(text("0"), "face 0 has 0 corners instead of at least 3");
    ply(text("2 0 1"), "face 0 has 2 corners instead of at least 3");
    ply(text("3 1 1 1"), "no face of the file has an area");
    ply(text("3 0 1 2").replace("uchar int", "uchar float"), "face 0 has 0 corners instead of at least 3");
    ply(header("ascii", 0, "uchar int") + "0 0 0\n1 0 0\n0 1 0\n", "the file has no faces");
    ply(
        binary(CORNERS, "uchar uint", &[3, 0, 0, 0, 0, 1, 0, 0, 0, 0xff, 0xff, 0xff, 0xff]),
        "face 0: vertex 4294967295 does not exist: there are 3",
    );
    ply(
        binary(CORNERS, "uchar int", &[3, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0x80]),
        "face 0: vertex -2147483648 does not exist: there are 3",
    );
    // The bytes of a big-endian file read as little-endian ones: index 1 becomes 2²⁴.
    ply(
        binary(CORNERS, "uchar int", &[3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2]),
        "face 0: vertex 16777216 does not exist: there are 3",
    );
}
