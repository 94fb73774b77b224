//! Scenes that must be refused, and the messages a user sees. Where a message changes on purpose,
//! change it here.

use nephroid_formats::Options;
use nephroid_formats::mitsuba::read_scene_str;
use nephroid_formats::vfs::MemoryFiles;

/// Files that broken scenes refer to; most are broken themselves.
fn files() -> MemoryFiles {
    MemoryFiles::default()
        .with("cycle.xml", r#"<scene version="3.0.0"><include filename="cycle.xml"/></scene>"#)
        .with("old.xml", r#"<scene version="9.0.0"/>"#)
        .with("broken.xml", r#"<scene version="3.0.0">
<shape>"#)
        .with("latin1.xml", b"<scene version=\x223.0.0\x22>\x0a<!-- \xe9 --></scene>")
        .with("index.obj", "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 4\r\n")
        .with("negative.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n")
        .with("nan.obj", "v 0 0 nan\n")
        .with("empty.obj", "# nothing\n")
        .with("locale.obj", "v 0,5 0 0\n")
        .with("short.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n")
        .with("giant.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 2147483648\nproperty float x\nproperty float y\nproperty float z\nend_header\nabc")
        .with("noply.ply", "PK")
        .with("spectrum.spd", "400 1\n300 2\n")
        .with("text.png", "not a picture")
        .with("giant.png", b"\x89PNG\x0d\x0a\x1a\x0a\x00\x00\x00\x0dIHDR\x00\x0fB@\x00\x0fB@\x08\x02\x00\x00\x00\xd3\x0f\xaf*")
}

/// All messages about a scene, one a line; nothing if it can be read.
fn messages(text: &str, options: &Options) -> String {
    match read_scene_str("s.xml", text, &files(), options) {
        Ok(_) => String::new(),
        Err(diagnostics) => diagnostics.to_string(),
    }
}

/// The messages about a scene with a camera, whose other content starts in the second line.
#[track_caller]
fn check(content: &str, expected: &str) {
    let camera = r#"<sensor type="perspective"/>"#;
    check_whole(&format!("<scene version=\"3.0.0\">{camera}\n{content}</scene>"), expected);
}

#[track_caller]
fn check_whole(text: &str, expected: &str) {
    assert_eq!(messages(text, &Options::default()), expected, "\n{text}");
}

#[test]
fn texts_that_are_no_scene() {
    check_whole("", "s.xml:1:1: error: not well-formed XML: the document does not have a root node");
    check_whole(
        r#"<scene version="3.0.0""#,
        "s.xml:1:1: error: not well-formed XML: the document does not have a root node",
    );
    check_whole(
        r#"<scene version="3.0.0"><shape></scene>"#,
        "s.xml:1:31: error: not well-formed XML: expected 'shape' tag, not 'scene'",
    );
    check_whole(
        r#"<!DOCTYPE s [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]>
<scene version="3.0.0">&b;</scene>"#,
        "s.xml:1:1: error: document types and entities are not supported; remove <!DOCTYPE …>",
    );
    check_whole(
        r#"<!DOCTYPE s SYSTEM "file:///etc/passwd">
<scene version="3.0.0"/>"#,
        "s.xml:1:1: error: document types and entities are not supported; remove <!DOCTYPE …>",
    );
    check_whole(
        r#"<scene version="3.0.0">&b;</scene>"#,
        "s.xml:1:24: error: not well-formed XML: unknown entity reference 'b'",
    );
    check_whole(r#"<shape type="sphere"/>"#, "s.xml:1:1: error: expected <scene>, found <shape>");
    check_whole(
        "<scene/>",
        r#"s.xml:1:1: error: <scene> lacks the attribute "version"; write <scene version="3.0.0">"#,
    );
    check_whole(
        r#"<scene version="9.1"/>"#,
        r#"s.xml:1:17: error: unknown scene version "9.1"; versions 0.4 to 0.6, 2 and 3 can be read"#,
    );
    check_whole(
        r#"<scene version="new"/>"#,
        r#"s.xml:1:17: error: "new" is not a scene version; write <scene version="3.0.0">"#,
    );
    check_whole(
        r#"<scene version="3.0.0" unit="m"/>"#,
        r#"s.xml:1:30: error: <scene> has no attribute "unit"
s.xml:1:1: error: the scene has no <sensor>; add <sensor type="perspective"> with a <film>"#,
    );
    check_whole(
        r#"<scene version="3.0.0"/>"#,
        r#"s.xml:1:1: error: the scene has no <sensor>; add <sensor type="perspective"> with a <film>"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><shape type="plane"/></scene>"#,
        r#"s.xml:1:1: error: the scene has no <sensor>; add <sensor type="perspective"> with a <film>"#,
    );
    check(r#"<shape type="sphere">stray words</shape>"#, r#"s.xml:2:22: error: unexpected text "stray""#);
    check(r#"<shpae type="sphere"/>"#, r#"s.xml:2:1: error: unknown element <shpae>; did you mean "shape"?"#);
    check(r#"<float name="x" value="1"/>"#, "s.xml:2:1: error: <float> has no place in <scene>");
}

#[test]
fn broken_includes() {
    check(r#"<include filename="cycle.xml"/>"#, r#"cycle.xml:1:43: error: "cycle.xml" includes itself"#);
    check(
        r#"<include filename="missing.xml"/>"#,
        r#"s.xml:2:20: error: cannot read "missing.xml": no such file in ."#,
    );
    check("<include/>", r#"s.xml:2:1: error: <include> lacks the attribute "filename""#);
    check(
        r#"<include filename="old.xml"/>"#,
        r#"old.xml:1:17: error: unknown scene version "9.0.0"; versions 0.4 to 0.6, 2 and 3 can be read"#,
    );
    check(
        r#"<include filename="broken.xml"/>"#,
        "broken.xml:1:1: error: not well-formed XML: the root node was opened but never closed",
    );
    check(
        r#"<include filename="latin1.xml"/>"#,
        r#"s.xml:2:20: error: "latin1.xml" is not UTF-8: line 2 holds an invalid byte"#,
    );
    check(
        r#"<shape type="sphere"><include filename="old.xml"/></shape>"#,
        "s.xml:2:22: error: <include> may only stand directly in <scene>",
    );
}

#[test]
fn broken_parameters() {
    check(
        r#"<default name="radius" value="1"/>
<shape type="sphere"><float name="radius" value="$raduis"/></shape>"#,
        r#"s.xml:3:50: error: undefined parameter "$raduis"; did you mean "radius"?"#,
    );
    check(
        r#"<default name="a" value="$b"/><default name="b" value="$a"/>
<shape type="$a"/>"#,
        r#"s.xml:3:14: error: parameters in "$a" refer to each other without end"#,
    );
    check(r#"<default name="a"/>"#, r#"s.xml:2:1: error: <default> lacks the attribute "value""#);
}

#[test]
fn unknown_names() {
    check(
        r#"<shape type="spehre"/>"#,
        r#"s.xml:2:14: error: unknown shape "spehre"; did you mean "sphere"?"#,
    );
    check("<shape/>", r#"s.xml:2:1: error: <shape> lacks the attribute "type""#);
    check(
        r#"<shape type="sphere"><float name="raduis" value="2"/></shape>"#,
        r#"s.xml:2:35: error: <shape type="sphere"> has no property "raduis"; did you mean "radius"?"#,
    );
    check(
        r#"<shape type="sphere"><float name="radius" vlaue="2"/></shape>"#,
        r#"s.xml:2:50: error: <float> has no attribute "vlaue"; did you mean "value"?
s.xml:2:22: error: <float> lacks the attribute "value""#,
    );
    check(
        r#"<shape type="sphere" colour="red"/>"#,
        r#"s.xml:2:30: error: <shape> has no attribute "colour""#,
    );
    check(
        r#"<shape type="sphere"><float name="nothing_like_it" value="2"/></shape>"#,
        r#"s.xml:2:35: error: <shape type="sphere"> has no property "nothing_like_it"; it has center, radius, to_world, flip_normals, silhouette_sampling_weight, interior, exterior, priority"#,
    );
    check(
        r#"<shape type="sphere"><float name="radius" value="1"/><float name="radius" value="2"/></shape>"#,
        r#"s.xml:2:54: error: "radius" is given twice"#,
    );
    check(r#"<bsdf type="difuse"/>"#, r#"s.xml:2:13: error: unknown bsdf "difuse"; did you mean "diffuse"?"#);
    check(r#"<emitter type="pont"/>"#, r#"s.xml:2:16: error: unknown emitter "pont"; did you mean "point"?"#);
    check(
        r#"<bsdf type="diffuse"><texture name="reflectance" type="bitmpa"/></bsdf>"#,
        r#"s.xml:2:56: error: unknown texture "bitmpa"; did you mean "bitmap"?"#,
    );
    check(
        r#"<shape type="sphere"><srgb name="radius" value="1"/></shape>"#,
        r#"s.xml:2:22: error: unknown element <srgb>; did you mean "rgb"?"#,
    );
    check(
        r#"<bsdf type="dielectric"><string name="int_ior" value="watr"/></bsdf>"#,
        r#"s.xml:2:55: error: nothing with a known index of refraction is called "watr"; did you mean "water"?"#,
    );
    check(
        r#"<bsdf type="conductor"><string name="material" value="Aw"/></bsdf>"#,
        r#"s.xml:2:55: error: unknown metal "Aw"; did you mean "Ag"?"#,
    );
    check(
        r#"<bsdf type="mask"><float name="opacity" value="0.3"/></bsdf>"#,
        r#"s.xml:2:13: error: "mask" takes one material, not 0"#,
    );
    check(
        r#"<bsdf type="mask"><bsdf type="diffuse"/><bsdf type="diffuse"/></bsdf>"#,
        r#"s.xml:2:13: error: "mask" takes one material, not 2"#,
    );
    check(
        r#"<bsdf type="mask"><string name="opacity" value="half"/><bsdf type="diffuse"/></bsdf>"#,
        r#"s.xml:2:49: error: "opacity" must be a colour or texture, not a string"#,
    );
    check(
        r#"<bsdf type="twosided"><bsdf type="mask"><bsdf type="diffuse"/></bsdf></bsdf>"#,
        r#"s.xml:2:23: error: "twosided" takes no material that light passes through; put the "twosided" into the "mask""#,
    );
    check(
        r#"<bsdf type="diffuse"><texture type="checkerboard"/></bsdf>"#,
        r#"s.xml:2:22: error: <texture> has no place in <bsdf type="diffuse">"#,
    );
    check(
        r#"<bsdf type="diffuse"><texture name="reflectance" type="bitmap"><string name="filename" value="text.png"/><string name="wrap_mode" value="repaet"/></texture></bsdf>"#,
        r#"s.xml:2:138: error: unknown wrap_mode "repaet"; one of repeat, mirror, clamp, zero, black
s.xml:2:95: error: "text.png" is of no format that is known here; images can be OpenEXR, PNG, JPEG, Radiance HDR, TGA, BMP or PFM files"#,
    );
}

#[test]
fn broken_references() {
    check(
        r#"<bsdf type="diffuse" id="a"/>
<bsdf type="diffuse" id="a"/>"#,
        r#"s.xml:3:26: error: the id "a" is taken; it is first given at s.xml:2:26"#,
    );
    check(
        r#"<bsdf type="diffuse" id="white"/>
<shape type="sphere"><ref id="whit"/></shape>"#,
        r#"s.xml:3:31: error: nothing has the id "whit"; did you mean "white"?"#,
    );
    check(r#"<shape type="sphere"><ref/></shape>"#, r#"s.xml:2:22: error: <ref> lacks the attribute "id""#);
    check(
        r#"<bsdf type="twosided" id="a"><ref id="a"/></bsdf>"#,
        "s.xml:2:1: error: the material refers to itself",
    );
    check(
        r#"<bsdf type="mask" id="a"><ref id="b"/></bsdf>
<bsdf type="mask" id="b"><ref id="a"/></bsdf>"#,
        "s.xml:2:1: error: the material refers to itself",
    );
    check(
        r#"<bsdf type="bumpmap" id="a"><texture type="checkerboard"/><ref id="b"/></bsdf>
<bsdf type="mask" id="b"><ref id="a"/></bsdf>"#,
        "s.xml:2:1: error: the material refers to itself",
    );
    check(
        r#"<texture type="checkerboard" id="t"><ref name="color0" id="t"/></texture>"#,
        "s.xml:2:1: error: the texture refers to itself",
    );
    check(
        r#"<bsdf type="diffuse" id="a"/><alias id="b" as="c"/>"#,
        r#"s.xml:2:48: error: nothing has the id "b""#,
    );
    check(
        r#"<bsdf type="diffuse" id="a"/><bsdf type="null" id="b"/><alias id="a" as="b"/>"#,
        r#"s.xml:2:74: error: the id "b" is taken"#,
    );
    check(r#"<bsdf type="twosided"/>"#, r#"s.xml:2:13: error: "twosided" takes one or two materials, not 0"#);
    check(
        r#"<bsdf type="twosided"><bsdf type="dielectric"/></bsdf>"#,
        r#"s.xml:2:23: error: "twosided" takes no material that light passes through"#,
    );
    check(
        r#"<bsdf type="diffuse" id="a"/><bsdf type="diffuse"><ref name="reflectance" id="a"/></bsdf>"#,
        r#"s.xml:2:79: error: "reflectance" must be a colour or texture, not a plugin"#,
    );
    check(
        r#"<shape type="sphere"><bsdf type="diffuse"/><bsdf type="null"/></shape>"#,
        "s.xml:2:44: error: <shape> takes one <bsdf>",
    );
}

#[test]
fn broken_values() {
    check(
        r#"<shape type="sphere"><float name="radius" value="nan"/></shape>"#,
        r#"s.xml:2:50: error: "nan" is not a finite number of single precision"#,
    );
    check(
        r#"<shape type="sphere"><float name="radius" value="1,5"/></shape>"#,
        r#"s.xml:2:50: error: "1,5" is not a number: the decimal sign is a point"#,
    );
    check(
        r#"<shape type="sphere"><float name="radius" value="1e60"/></shape>"#,
        r#"s.xml:2:50: error: "1e60" is not a finite number of single precision"#,
    );
    check(
        r#"<shape type="sphere"><float name="radius" value=""/></shape>"#,
        "s.xml:2:50: error: expected a number, found nothing",
    );
    check(
        r#"<shape type="sphere"><float name="radius" value="0"/></shape>"#,
        r#"s.xml:2:50: error: "radius" must be above zero, not 0"#,
    );
    check(
        r#"<shape type="sphere"><float name="radius" value="-1"/></shape>"#,
        r#"s.xml:2:50: error: "radius" must be above zero, not -1"#,
    );
    check(
        r#"<shape type="cylinder"><float name="radius" value="0"/></shape>"#,
        r#"s.xml:2:52: error: "radius" must be above zero, not 0"#,
    );
    check(
        r#"<shape type="cylinder"><point name="p1" x="0" y="0" z="0"/></shape>"#,
        r#"s.xml:2:14: error: the ends "p0" and "p1" of the cylinder are the same point"#,
    );
    check(
        r#"<shape type="sphere"><string name="radius" value="1"/></shape>"#,
        r#"s.xml:2:51: error: "radius" must be a float, not a string"#,
    );
    check(
        r#"<shape type="sphere"><point name="center" x="1" y="2"/></shape>"#,
        r#"s.xml:2:22: error: <point> lacks the attribute "z""#,
    );
    check(
        r#"<shape type="sphere"><point name="center" value="1 2"/></shape>"#,
        "s.xml:2:50: error: expected one or three numbers, found 2",
    );
    check(
        r#"<shape type="rectangle"><boolean name="flip_normals" value="yes"/></shape>"#,
        r#"s.xml:2:61: error: "yes" is neither true nor false"#,
    );
    check(
        r#"<bsdf type="diffuse"><rgb name="reflectance" value="1 2"/></bsdf>"#,
        "s.xml:2:53: error: a colour has one or three numbers, not 2",
    );
    check(
        r##"<bsdf type="diffuse"><rgb name="reflectance" value="#12345g"/></bsdf>"##,
        r##"s.xml:2:53: error: "#12345g" is not a colour of the form #rrggbb"##,
    );
    check(
        r#"<bsdf type="diffuse"><spectrum name="reflectance" value="0.1, 0.2, 0.3"/></bsdf>"#,
        r#"s.xml:2:58: error: three numbers are not a spectrum; write <rgb … value="0.1, 0.2, 0.3"/>"#,
    );
    check(
        r#"<bsdf type="diffuse"><spectrum name="reflectance" value="500:1, 400:2"/></bsdf>"#,
        "s.xml:2:58: error: wavelength 400 stands after 500; they must increase",
    );
    check(
        r#"<bsdf type="diffuse"><spectrum name="reflectance" filename="spectrum.spd"/></bsdf>"#,
        r#"s.xml:2:61: error: "spectrum.spd": wavelength 300 stands after 400; they must increase"#,
    );
    check(
        r#"<bsdf type="diffuse"><spectrum name="reflectance"/></bsdf>"#,
        r#"s.xml:2:22: error: <spectrum> needs either "value" or "filename""#,
    );
    check(
        r#"<bsdf type="dielectric"><float name="int_ior" value="0"/></bsdf>"#,
        r#"s.xml:2:54: error: "int_ior" must be above zero, not 0"#,
    );
}

#[test]
fn broken_transforms() {
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><scale x="0"/></transform></shape>"#,
        "s.xml:3:1: error: the transform flattens space or overflows; no scale may be zero",
    );
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><rotate angle="3"/></transform></shape>"#,
        r#"s.xml:3:28: error: the axis of the rotation has no length; add y="1""#,
    );
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><rotate y="1"/></transform></shape>"#,
        r#"s.xml:3:28: error: <rotate> lacks the attribute "angle""#,
    );
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><lookat origin="1 1 1" target="1 1 1" up="0 1 0"/></transform></shape>"#,
        "s.xml:3:28: error: lookat: origin and target are the same point",
    );
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><lookat origin="0 0 0" target="0 2 0" up="0 1 0"/></transform></shape>"#,
        r#"s.xml:3:28: error: lookat: "up" is parallel to the line of sight"#,
    );
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><lookAt origin="0 0 0" target="0 2 0"/></transform></shape>"#,
        r#"s.xml:3:28: error: <lookAt> is not a step of a transform; did you mean "lookat"?"#,
    );
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><matrix value="1 0 0 1"/></transform></shape>"#,
        "s.xml:3:43: error: a matrix has 9 or 16 numbers, not 4",
    );
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0"/></transform></shape>"#,
        "s.xml:3:43: error: the last row of the matrix must be 0 0 0 1",
    );
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><scale value="1 2"/></transform></shape>"#,
        "s.xml:3:42: error: expected one or three numbers, found 2",
    );
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><scale value="1" x="1"/></transform></shape>"#,
        r#"s.xml:3:28: error: <scale> has both "value" and "x", "y" or "z""#,
    );
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><translate x="inf"/></transform></shape>"#,
        r#"s.xml:3:42: error: "inf" is not a finite number of single precision"#,
    );
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><scale value="1e38"/><scale value="1e38"/><scale value="1e38"/></transform></shape>"#,
        "s.xml:3:1: error: the transform flattens space or overflows; no scale may be zero",
    );
    check(
        r#"<shape type="rectangle">
<transform name="to_world"><scale angle="1"/></transform></shape>"#,
        r#"s.xml:3:42: error: <scale> has no attribute "angle""#,
    );
}

#[test]
fn broken_files() {
    check(r#"<shape type="obj"/>"#, r#"s.xml:2:14: error: shape "obj" lacks a filename"#);
    check(
        r#"<shape type="obj"><string name="filename" value="missing.obj"/></shape>"#,
        r#"s.xml:2:50: error: cannot read "missing.obj": no such file in ."#,
    );
    check(
        r#"<shape type="obj"><string name="filename" value="index.obj"/></shape>"#,
        "s.xml:2:50: error: index.obj:4: vertex 4 does not exist: there are 3 so far",
    );
    check(
        r#"<shape type="obj"><string name="filename" value="negative.obj"/></shape>"#,
        "s.xml:2:50: error: negative.obj:4: vertex -4 does not exist: there are 3 so far",
    );
    check(
        r#"<shape type="obj"><string name="filename" value="nan.obj"/></shape>"#,
        r#"s.xml:2:50: error: nan.obj:1: "nan" is not a finite number"#,
    );
    check(
        r#"<shape type="obj"><string name="filename" value="empty.obj"/></shape>"#,
        "s.xml:2:50: error: empty.obj: the file has no faces",
    );
    check(
        r#"<shape type="obj"><string name="filename" value="locale.obj"/></shape>"#,
        r#"s.xml:2:50: error: locale.obj:1: "0,5" is not a finite number"#,
    );
    check(
        r#"<shape type="ply"><string name="filename" value="short.ply"/></shape>"#,
        "s.xml:2:50: error: short.ply: the header promises at least 20 bytes, but 12 follow it",
    );
    check(
        r#"<shape type="ply"><string name="filename" value="giant.ply"/></shape>"#,
        "s.xml:2:50: error: giant.ply: the header promises at least 25769803776 bytes, but 3 follow it",
    );
    check(
        r#"<shape type="ply"><string name="filename" value="noply.ply"/></shape>"#,
        "s.xml:2:50: error: noply.ply: not a PLY header: Line 1: Expected magic number 'ply'. String: 'PK'",
    );
    check(
        r#"<emitter type="envmap"><string name="filename" value="text.png"/></emitter>"#,
        r#"s.xml:2:55: error: "text.png" is of no format that is known here; images can be OpenEXR, PNG, JPEG, Radiance HDR, TGA, BMP or PFM files"#,
    );
    check(
        r#"<emitter type="envmap"><string name="filename" value="giant.png"/></emitter>"#,
        r#"s.xml:2:55: error: "giant.png" is cut off or damaged: as a PNG file, unexpected end of file"#,
    );
    check(
        r#"<emitter type="envmap"><string name="filename" value="missing.exr"/></emitter>"#,
        r#"s.xml:2:55: error: cannot read "missing.exr": no such file in ."#,
    );
}

#[test]
fn broken_sensors_and_films() {
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<film type="hdrfilm"><integer name="width" value="65537"/></film></sensor></scene>"#,
        r#"s.xml:2:51: error: "width" must be from 1 to 65536, not 65537"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<film type="hdrfilm"><integer name="height" value="0"/></film></sensor></scene>"#,
        r#"s.xml:2:52: error: "height" must be from 1 to 65536, not 0"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<film type="hdrfilm"><integer name="height" value="-5"/></film></sensor></scene>"#,
        r#"s.xml:2:52: error: "height" must be from 1 to 65536, not -5"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<film type="hdrfilm"><float name="height" value="5"/></film></sensor></scene>"#,
        r#"s.xml:2:50: error: "height" must be an integer, not a float"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<film type="hdrfilm"><integer name="crop_width" value="0"/></film></sensor></scene>"#,
        r#"s.xml:2:56: error: "crop_width" must be from 1 to 65536, not 0"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<film type="hdrfilm"><integer name="crop_offset_x" value="700"/></film></sensor></scene>"#,
        "s.xml:2:13: error: the crop window (700, 0) + 768×576 leaves the 768×576 picture",
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<film type="hdfilm"/></sensor></scene>"#,
        r#"s.xml:2:13: error: unknown film "hdfilm"; did you mean "hdrfilm"?"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<film type="hdrfilm"><rfilter type="bocks"/></film></sensor></scene>"#,
        r#"s.xml:2:37: error: unknown rfilter "bocks"; known are box, tent, gaussian, mitchell"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<film type="hdrfilm"><rfilter type="tent"><float name="radius" value="0"/></rfilter></film></sensor></scene>"#,
        r#"s.xml:2:71: error: "radius" must be above zero, not 0"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<sampler type="independent"><integer name="sample_count" value="0"/></sampler></sensor></scene>"#,
        r#"s.xml:2:65: error: "sample_count" must be at least 1, not 0"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<sampler type="indepedent"/></sensor></scene>"#,
        r#"s.xml:2:16: error: unknown sampler "indepedent"; did you mean "independent"?"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<film type="hdrfilm"/><film type="hdrfilm"/></sensor></scene>"#,
        "s.xml:2:23: error: <sensor> takes one <film>",
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<float name="fov" value="180"/></sensor></scene>"#,
        r#"s.xml:2:26: error: "fov" must be between 0 and 180 degrees, not 180"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<float name="fov" value="0"/></sensor></scene>"#,
        r#"s.xml:2:26: error: "fov" must be between 0 and 180 degrees, not 0"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<float name="fov" value="9"/><string name="focal_length" value="50mm"/></sensor></scene>"#,
        r#"s.xml:2:65: error: give either "fov" or "focal_length""#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<string name="focal_length" value="long"/></sensor></scene>"#,
        r#"s.xml:2:36: error: "long" is not a focal length; write millimetres, as in "50mm""#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<string name="fov_axis" value="z"/></sensor></scene>"#,
        r#"s.xml:2:32: error: unknown fov_axis "z"; one of x, y, diagonal, smaller, larger"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="perspective">
<float name="fieldofview" value="40"/></sensor></scene>"#,
        r#"s.xml:2:14: error: <sensor type="perspective"> has no property "fieldofview"; it has fov_axis, focal_length, fov, principal_point_offset_x, principal_point_offset_y, to_world, near_clip, far_clip, focus_distance, shutter_open, shutter_close, srf"#,
    );
    check_whole(
        r#"<scene version="3.0.0">
<sensor type="perspektive"/></scene>"#,
        r#"s.xml:2:15: error: unknown sensor "perspektive"; did you mean "perspective"?"#,
    );
    check_whole(
        r#"<scene version="3.0.0">
<sensor type="thinlens"/></scene>"#,
        r#"s.xml:2:15: error: a "thinlens" needs an "aperture_radius"; write <float name="aperture_radius" value="…"/>, the radius of the lens in units of the scene; 0 makes all sharp"#,
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="thinlens">
<float name="aperture_radius" value="-1"/><float name="focus_distance" value="0"/></sensor></scene>"#,
        "s.xml:2:79: error: \"focus_distance\" must be above zero, not 0
s.xml:2:38: error: \"aperture_radius\" must be zero or more, not -1",
    );
    check_whole(
        r#"<scene version="3.0.0"><sensor type="spherical"/>
</scene>"#,
        r#"s.xml:1:38: error: sensor "spherical" cannot be rendered yet"#,
    );
}

#[test]
fn broken_lights() {
    check(
        r#"<emitter type="area"/>"#,
        r#"s.xml:2:16: error: an "area" emitter belongs inside a shape; move it into the <shape> that shines"#,
    );
    check(
        r#"<shape type="sphere"><emitter type="point"/></shape>"#,
        r#"s.xml:2:37: error: a shape's emitter must be "area", not "point""#,
    );
    check(
        r#"<emitter type="directional"><vector name="direction" x="0" y="0" z="0"/></emitter>"#,
        "s.xml:2:16: error: the direction has no length",
    );
    check(
        r#"<emitter type="point"><point name="position" value="1"/><transform name="to_world"/></emitter>"#,
        r#"s.xml:2:16: error: give either "position" or "to_world""#,
    );
    check(
        r#"<emitter type="spot"><float name="cutoff_angle" value="10"/><float name="beam_width" value="20"/></emitter>"#,
        "s.xml:2:16: error: a spot's angles must be 0 ≤ beam_width ≤ cutoff_angle < 180, not 20 and 10",
    );
    check(r#"<emitter type="envmap"/>"#, r#"s.xml:2:16: error: emitter "envmap" lacks a filename"#);
    check(
        r#"<emitter type="point"><texture name="intensity" type="checkerboard"/></emitter>"#,
        r#"s.xml:2:23: error: "intensity" must be one colour, not a texture"#,
    );
    check(
        r#"<integrator type="path"/>
<integrator type="path"/>"#,
        "s.xml:3:1: error: the scene has two integrators",
    );
}

#[test]
fn files_of_another_kind() {
    let camera = r#"<sensor type="perspective"/>"#;
    let found = |content: &str| {
        messages(&format!("<scene version=\"3.0.0\">{camera}\n{content}</scene>"), &Options::default())
    };
    let mesh = found(
        r#"<shape type="serialized"><string name="filename" value="noply.ply"/><integer name="shape_index" value="1"/></shape>"#,
    );
    assert!(mesh.starts_with("s.xml:2:57: error: noply.ply: "), "{mesh}");
    let lamp = found(r#"<emitter type="ies"><string name="filename" value="text.png"/></emitter>"#);
    assert_eq!(lamp, "s.xml:2:52: error: text.png: no IES file: it has no line \"TILT=\"");
    assert_eq!(found(r#"<emitter type="ies"/>"#), "s.xml:2:16: error: emitter \"ies\" lacks a filename");
}

#[test]
fn spectra_by_type() {
    let complaint = |spectrum: &str, expected: &str| {
        let start = r#"<emitter type="constant"><spectrum name="radiance" "#;
        check(&format!("{start}{spectrum}</spectrum></emitter>"), expected);
    };
    complaint(r#"type="blackbody">"#, r#"s.xml:2:58: error: a black body needs a "temperature", in kelvin"#);
    complaint(
        r#"type="blackbody"><float name="temperature" value="-1"/>"#,
        r#"s.xml:2:102: error: "temperature" must be above zero, not -1"#,
    );
    complaint(
        r#"type="regular"><string name="values" value="1 2"/>"#,
        r#"s.xml:2:58: error: spectrum "regular" needs "wavelength_min", in nm"#,
    );
    complaint(
        r#"type="regular"><string name="range" value="1 2 3"/><string name="values" value="1 2"/>"#,
        r#"s.xml:2:58: error: "range" has two wavelengths"#,
    );
    complaint(
        r#"type="regular"><string name="range" value="700 400"/><string name="values" value="1 2"/>"#,
        r#"s.xml:2:58: error: wavelength 400 stands after 700; they must increase"#,
    );
    complaint(
        r#"type="irregular"><string name="wavelengths" value="400 500 600"/><string name="values" value="1 2"/>"#,
        r#"s.xml:2:58: error: 3 wavelengths have 2 values"#,
    );
    complaint(
        r#"type="irregular"><string name="wavelengths" value="400 five"/><string name="values" value="1 2"/>"#,
        r#"s.xml:2:103: error: "five" is not a number"#,
    );
    complaint(
        r#"type="blakbody">"#,
        r#"s.xml:2:58: error: unknown spectrum "blakbody"; did you mean "blackbody"?"#,
    );
}

#[test]
fn what_cannot_be_rendered_yet() {
    check(
        r#"<shape type="hair"/>"#,
        r#"s.xml:2:14: error: shape "hair" cannot be rendered yet; --lenient leaves it out"#,
    );
    check(
        r#"<emitter type="timed_sunsky"/>"#,
        r#"s.xml:2:16: error: emitter "timed_sunsky" cannot be rendered yet; --lenient leaves it out"#,
    );
}

fn define(name: &str, value: &str) -> Options {
    Options { defines: vec![(name.into(), value.into())], lenient: false }
}

#[test]
fn definitions_that_the_scene_does_not_know() {
    let text =
        r#"<scene version="3.0.0"><default name="spp" value="4"/><sensor type="perspective"/></scene>"#;
    assert_eq!(messages(text, &define("spp", "8")), "");
    assert_eq!(
        messages(text, &define("sp", "8")),
        r#"s.xml:1:1: error: the scene has no parameter "sp"; did you mean "spp"?"#
    );
    assert_eq!(
        messages(text, &define("width", "8")),
        r#"s.xml:1:1: error: the scene has no parameter "width"; it has spp"#
    );
    let text = r#"<scene version="3.0.0"><sensor type="$camera"/></scene>"#;
    assert_eq!(messages(text, &define("camera", "perspective")), "");
}

#[test]
fn mistakes_are_reported_together() {
    check(
        "<shape type=\"spere\"/>\n<shape type=\"sphere\"><float name=\"radius\" value=\"x\"/><ref id=\"no\"/></shape>\n\
         <bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"a\"/></bsdf>",
        "s.xml:2:14: error: unknown shape \"spere\"; did you mean \"sphere\"?\n\
         s.xml:3:50: error: \"x\" is not a number\n\
         s.xml:3:63: error: nothing has the id \"no\"\n\
         s.xml:4:53: error: \"a\" is not a number",
    );
}

#[test]
fn deep_nesting_is_refused_without_deep_recursion() {
    let deep = |n: usize| format!("{}{}", "<bsdf type=\"mask\">".repeat(n), "</bsdf>".repeat(n));
    let text = messages(&format!("<scene version=\"3.0.0\">{}</scene>", deep(51)), &Options::default());
    assert!(text.starts_with("s.xml:1:924: error: elements are nested more than 50 deep\n"), "{text}");
    let text = messages(&format!("<scene version=\"3.0.0\">{}</scene>", deep(100_000)), &Options::default());
    assert!(text.contains("elements are nested more than 50 deep"), "{text}");
    assert!(!messages(&"<scene>".repeat(1_000_000), &Options::default()).is_empty());
}

#[test]
fn long_chains_of_references_are_refused() {
    let link = |i: usize| format!("<bsdf type=\"mask\" id=\"m{i}\"><ref id=\"m{}\"/></bsdf>\n", i + 1);
    let chain: String = (0..10_000).map(link).collect();
    let text = format!(
        "<scene version=\"3.0.0\"><sensor type=\"perspective\"/>{chain}<bsdf type=\"null\" id=\"m10000\"/></scene>"
    );
    let text = messages(&text, &Options::default());
    assert!(text.contains("references are nested more than 50 deep"), "{text}");
}

#[test]
fn includes_that_multiply_are_refused() {
    let mut files = MemoryFiles::default();
    for i in 0..14 {
        let include = format!("<include filename=\"{}.xml\"/>", i + 1).repeat(4);
        files = files.with(format!("{i}.xml"), format!("<scene version=\"3.0.0\">{include}</scene>"));
    }
    files = files.with("14.xml", "<scene version=\"3.0.0\"/>");
    let top = "<scene version=\"3.0.0\"><include filename=\"0.xml\"/></scene>";
    let text = read_scene_str("s.xml", top, &files, &Options::default()).unwrap_err().to_string();
    assert!(text.contains("too many included files"), "{text}");
}

#[test]
fn what_is_not_there_or_not_text() {
    let read = |files: &MemoryFiles| {
        nephroid_formats::mitsuba::read_scene("a/s.xml".as_ref(), files, &Options::default())
            .unwrap_err()
            .to_string()
    };
    assert_eq!(read(&MemoryFiles::default()), "error: cannot read \"a/s.xml\": no such file");
    let latin1 = MemoryFiles::default().with("a/s.xml", *b"<scene>\n\n\xe9");
    assert_eq!(read(&latin1), "a/s.xml:1:1: error: \"a/s.xml\" is not UTF-8: line 3 holds an invalid byte");
    let utf16 = MemoryFiles::default().with("a/s.xml", *b"\xff\xfe<\0");
    assert_eq!(read(&utf16), "a/s.xml:1:1: error: \"a/s.xml\" is UTF-16; save it as UTF-8");
}

#[test]
fn groups_and_instances() {
    check(r#"<shape type="shapegroup" id="g"/>"#, "s.xml:2:14: error: the shapegroup has no shape");
    check(
        r#"<shape type="shapegroup" id="g"><shape type="sphere"><emitter type="area"/></shape></shape>
<shape type="instance"><ref id="g"/></shape>"#,
        "s.xml:2:46: error: a shape of a shapegroup cannot emit light; put the lamp beside the instances",
    );
    check(
        r#"<shape type="shapegroup" id="a"><shape type="cube"/></shape>
<shape type="shapegroup" id="b">
<shape type="instance"><ref id="a"/></shape><ref id="b"/></shape>
<shape type="instance"><ref id="b"/></shape>"#,
        "s.xml:3:14: error: a shapegroup cannot hold another, but an instance of one",
    );
    check(
        r#"<shape type="shapegroup" id="a"><shape type="instance"><ref id="b"/></shape></shape>
<shape type="shapegroup" id="b"><shape type="instance"><ref id="a"/></shape></shape>"#,
        "s.xml:2:1: error: the shapegroup shows itself",
    );
    // Each of thirty groups shows the one before twice.
    let twice = |i: usize| {
        let one = format!("<shape type=\"instance\"><ref id=\"g{}\"/></shape>", i - 1);
        format!("<shape type=\"shapegroup\" id=\"g{i}\">{one}{one}</shape>")
    };
    let groups: String = (1..30).map(twice).collect();
    let text = format!("<shape type=\"shapegroup\" id=\"g0\"><shape type=\"cube\"/></shape>{groups}");
    let camera = r#"<sensor type="perspective"/>"#;
    let found = messages(&format!("<scene version=\"3.0.0\">{camera}{text}</scene>"), &Options::default());
    assert!(found.contains("instances in groups make more than 100000 shapes of one"), "{found}");
    check(
        r#"<shape type="instance"/>"#,
        r#"s.xml:2:14: error: the instance lacks a shapegroup; write <ref id="…"/>"#,
    );
    check(
        r#"<shape type="sphere" id="ball"/>
<shape type="instance"><ref id="ball"/></shape>"#,
        r#"s.xml:3:14: error: an instance shows a shapegroup, not "sphere""#,
    );
    check(
        r#"<shape type="shapegroup" id="g"><shape type="cube"/></shape>
<shape type="instance"><ref id="g"/><bsdf type="null"/></shape>"#,
        r#"s.xml:3:37: error: <bsdf> has no place in <shape type="instance">"#,
    );
}
