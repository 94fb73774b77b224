//! Scenes of pbrt that must be refused, and the messages a user sees. Where a message changes on purpose,
//! change it here.

use nephroid_formats::Options;
use nephroid_formats::pbrt::{read_scene, read_scene_str};
use nephroid_formats::vfs::MemoryFiles;

/// Files that broken scenes refer to; most are broken themselves.
fn files() -> MemoryFiles {
    MemoryFiles::default()
        .with("cycle.pbrt", "Include \"cycle.pbrt\"")
        .with("there.pbrt", "Include \"back.pbrt\"")
        .with("back.pbrt", "Include \"there.pbrt\"")
        .with("open.pbrt", "AttributeBegin")
        .with("wrong.pbrt", "\nShape \"spere\"")
        .with("latin1.pbrt", b"# \xe9")
        .with("packed.pbrt.gz", "no gzip")
        .with("empty.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n")
        .with("noply.ply", "PK")
        .with("spectrum.spd", "400 1\n300 2\n")
        .with("text.png", "not a picture")
}

/// All messages about a scene, one a line; nothing if it can be read.
fn messages(text: &str, options: &Options) -> String {
    match read_scene_str("s.pbrt", text, &files(), options) {
        Ok(_) => String::new(),
        Err(diagnostics) => diagnostics.to_string(),
    }
}

/// The messages about a scene with a camera, whose world starts in the second line.
#[track_caller]
fn check(world: &str, expected: &str) {
    check_whole(&format!("Camera \"perspective\" WorldBegin\n{world}"), expected);
}

#[track_caller]
fn check_whole(text: &str, expected: &str) {
    assert_eq!(messages(text, &Options::default()), expected, "\n{text}");
}

#[test]
fn texts_that_are_no_scene() {
    check_whole(
        "",
        "s.pbrt:1:1: error: the scene has no WorldBegin; it stands between the camera and the shapes",
    );
    check_whole(
        "WorldBegin",
        "s.pbrt:1:1: error: the scene has no Camera; write Camera \"perspective\" before WorldBegin",
    );
    check_whole(
        "<scene version=\"3.0.0\"/>",
        "s.pbrt:1:1: error: unknown directive \"<scene\"\n\
         s.pbrt:1:1: error: the scene has no WorldBegin; it stands between the camera and the shapes",
    );
    check(
        "Shpe \"sphere\" \"float radius\" 1",
        "s.pbrt:2:1: error: unknown directive \"Shpe\"; did you mean \"Shape\"?",
    );
    check("\"Shape\"", "s.pbrt:2:2: error: expected a directive, found \"Shape\"");
    check(
        "Shape \"sphere",
        "s.pbrt:2:7: error: the string has no end; close it with \"\ns.pbrt:2:1: error: Shape must be followed by a string in quotes",
    );
    check("Shape", "s.pbrt:2:1: error: Shape must be followed by a string in quotes");
    let missing = read_scene("x.pbrt".as_ref(), &files(), &Options::default()).expect_err("no such file");
    assert_eq!(missing.to_string(), "error: cannot read \"x.pbrt\": no such file");
    let latin1 = read_scene("latin1.pbrt".as_ref(), &files(), &Options::default()).expect_err("not UTF-8");
    assert_eq!(
        latin1.to_string(),
        "latin1.pbrt:1:1: error: \"latin1.pbrt\" is not UTF-8: line 1 holds an invalid byte"
    );
    let packed = read_scene("packed.pbrt.gz".as_ref(), &files(), &Options::default()).expect_err("no gzip");
    assert!(packed.to_string().contains("cannot unpack \"packed.pbrt.gz\""), "{packed}");
}

#[test]
fn parameters_that_are_none() {
    check(
        "Shape \"sphere\" \"radius\" 1",
        "s.pbrt:2:17: error: \"radius\" is no parameter; write \"type name\", as in \"float radius\"",
    );
    check(
        "Shape \"sphere\" \"flaot radius\" 1",
        "s.pbrt:2:17: error: unknown type of parameter \"flaot\"; did you mean \"float\"?",
    );
    check("Shape \"sphere\" \"float radius\"", "s.pbrt:2:17: error: \"float radius\" has no value");
    check("Shape \"sphere\" \"float radius\" []", "s.pbrt:2:17: error: \"float radius\" has no value");
    check(
        "Shape \"sphere\" \"float radius\" [1 \nShape \"disk\"",
        "s.pbrt:2:31: error: the list has no end; close it with ]",
    );
    check("Shape \"sphere\" \"float radius\" [[1]]", "s.pbrt:2:32: error: a list in a list");
    check(
        "Shape \"sphere\" \"float radius\" 1 \"float radius\" 2",
        "s.pbrt:2:34: error: \"radius\" is given twice",
    );
    check(
        "Shape \"sphere\" \"float radius\" [1 2]",
        "s.pbrt:2:31: error: \"radius\" takes one number, not 2",
    );
    check(
        "Shape \"sphere\" \"float radius\" nan",
        "s.pbrt:2:31: error: \"nan\" is not a finite number of single precision",
    );
    check(
        "Shape \"sphere\" \"float radius\" NaN",
        "s.pbrt:2:31: error: \"NaN\" is not a finite number of single precision",
    );
    check(
        "Shape \"sphere\" \"float radius\" 1e39",
        "s.pbrt:2:31: error: \"1e39\" is not a finite number of single precision",
    );
    check(
        "Shape \"sphere\" \"float radius\" 1,5",
        "s.pbrt:2:31: error: \"1,5\" is not a number: the decimal sign is a point",
    );
    check(
        "Shape \"sphere\" \"float radius\" \"1\"",
        "s.pbrt:2:32: error: \"radius\" is a float, and \"1\" a string",
    );
    check("Shape \"sphere\" \"float radius\" 0", "s.pbrt:2:31: error: \"radius\" must be above zero, not 0");
    check(
        "Shape \"sphere\" \"string radius\" \"1\"",
        "s.pbrt:2:17: error: \"radius\" must be a float or integer, not a string",
    );
    check(
        "Shape \"sphere\" \"float raduis\" 1",
        "s.pbrt:2:17: error: the shape \"sphere\" has no parameter \"raduis\"; did you mean \"radius\"?",
    );
    check(
        "Shape \"loopsubdiv\" \"integer levels\" 1.5",
        "s.pbrt:2:37: error: \"1.5\" is not a whole number of 32 bits\ns.pbrt:2:8: error: \"loopsubdiv\" lacks \"point3 P\"",
    );
    check(
        "Shape \"plymesh\" \"string filename\" a.ply",
        "s.pbrt:2:35: error: \"filename\" is a string, which stands between quotes\ns.pbrt:2:8: error: shape \"plymesh\" lacks a filename",
    );
    check(
        "AreaLightSource \"diffuse\" \"bool twosided\" maybe",
        "s.pbrt:2:43: error: \"maybe\" is neither true nor false",
    );
}

#[test]
fn transforms() {
    check("Translate 1 2", "s.pbrt:2:1: error: Translate takes 3 numbers, not 2");
    check("Scale 1 2 x", "s.pbrt:2:11: error: \"x\" is not a number");
    check_whole(
        "Scale 1 0 1 Camera \"perspective\" WorldBegin",
        "s.pbrt:1:1: error: Scale flattens space or overflows; no scale may be zero",
    );
    check("Rotate 10 0 0 0", "s.pbrt:2:1: error: the axis of the rotation has no length");
    check(
        "LookAt 0 0 0 0 0 0 0 1 0",
        "s.pbrt:2:1: error: LookAt: the eye and what it looks at are the same point",
    );
    check("LookAt 0 0 0 0 1 0 0 1 0", "s.pbrt:2:1: error: LookAt: up is parallel to the line of sight");
    check(
        "Transform [1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1]",
        "s.pbrt:2:1: error: the matrix does not keep parallel lines so; every fourth number must be 0, the last one 1",
    );
    check("Transform [1 2 3]", "s.pbrt:2:1: error: Transform takes 16 numbers, not 3");
    check(
        "CoordSysTransform \"wrold\"",
        "s.pbrt:2:20: error: no coordinate system is called \"wrold\"; did you mean \"world\"?",
    );
}

#[test]
fn the_graphics_state() {
    check("AttributeEnd", "s.pbrt:2:1: error: AttributeEnd without AttributeBegin");
    check("AttributeBegin", "s.pbrt:2:1: error: AttributeBegin without AttributeEnd");
    check(
        "ObjectBegin \"o\" Shape \"disk\"\nAttributeEnd\nObjectEnd ObjectInstance \"o\"",
        "s.pbrt:3:1: error: AttributeEnd where ObjectBegin is open; it begins at s.pbrt:2:14",
    );
    check(
        "Attribute \"shpe\" \"float radius\" 1",
        "s.pbrt:2:12: error: nothing has attributes of a \"shpe\"; did you mean \"shape\"?",
    );
    check(
        "ColorSpace \"rec202\"",
        "s.pbrt:2:13: error: unknown colour space \"rec202\"; did you mean \"rec2020\"?",
    );
    check("WorldBegin", "s.pbrt:2:1: error: the world has begun already");
    check("Film \"rgb\"", "s.pbrt:2:7: error: Film belongs before WorldBegin");
    check_whole(
        "Camera \"perspective\"\nShape \"sphere\"\nWorldBegin",
        "s.pbrt:2:1: error: Shape belongs behind WorldBegin",
    );
    check(
        "ObjectBegin \"o\" ObjectBegin \"p\" ObjectEnd Shape \"disk\" ObjectEnd ObjectInstance \"o\"",
        "s.pbrt:2:30: error: an object in an object; the outer one begins at s.pbrt:2:14",
    );
    check(
        "ObjectInstance \"o\"",
        "s.pbrt:2:17: error: no object is called \"o\"; ObjectBegin must stand before its use",
    );
}

#[test]
fn files_that_are_included() {
    check("Include \"missing.pbrt\"", "s.pbrt:2:10: error: cannot read \"missing.pbrt\": no such file in .");
    check("Include \"cycle.pbrt\"", "cycle.pbrt:1:10: error: \"cycle.pbrt\" includes itself");
    check("Include \"there.pbrt\"", "back.pbrt:1:10: error: \"there.pbrt\" includes itself");
    check("Include \"s.pbrt\"", "s.pbrt:2:10: error: cannot read \"s.pbrt\": no such file in .");
    check(
        "Include \"wrong.pbrt\"",
        "wrong.pbrt:2:8: error: unknown shape \"spere\"; did you mean \"sphere\"?",
    );
    check("Import \"open.pbrt\"", "open.pbrt:1:1: error: AttributeBegin without AttributeEnd");
    check("Include \"\"", "s.pbrt:2:10: error: cannot read \"\": the name is empty");
}

#[test]
fn camera_and_film() {
    let whole = |head: &str, expected: &str| check_whole(&format!("{head}\nWorldBegin"), expected);
    whole(
        "Camera \"perspectiv\"",
        "s.pbrt:1:9: error: unknown camera \"perspectiv\"; did you mean \"perspective\"?",
    );
    whole("Camera \"realistic\"", "s.pbrt:1:9: error: camera \"realistic\" cannot be rendered yet");
    whole(
        "Camera \"perspective\" \"float fov\" 180",
        "s.pbrt:1:34: error: \"fov\" must be between 0 and 180 degrees, not 180",
    );
    whole(
        "Camera \"perspective\" \"float screenwindow\" [1 -1 -1 1]",
        "s.pbrt:1:43: error: the window is empty: it is left, right, lower and upper",
    );
    whole(
        "Film \"rgb\" \"integer xresolution\" 0\nCamera \"perspective\"",
        "s.pbrt:1:34: error: \"xresolution\" must be a whole number between 1 and 65536, not 0",
    );
    whole(
        "Film \"rgb\" \"float cropwindow\" [1 1 0 1]\nCamera \"perspective\"",
        "s.pbrt:1:31: error: nothing is left of the picture",
    );
    whole(
        "PixelFilter \"bax\"\nCamera \"perspective\"",
        "s.pbrt:1:14: error: unknown filter \"bax\"; did you mean \"box\"?",
    );
    whole(
        "Sampler \"sobel\"\nCamera \"perspective\"",
        "s.pbrt:1:10: error: unknown sampler \"sobel\"; did you mean \"sobol\"?",
    );
    whole(
        "Integrator \"volpth\"\nCamera \"perspective\"",
        "s.pbrt:1:13: error: unknown integrator \"volpth\"; did you mean \"volpath\"?",
    );
}

#[test]
fn meshes() {
    let mesh = |rest: &str| format!("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] {rest}");
    check("Shape \"trianglemesh\"", "s.pbrt:2:8: error: \"trianglemesh\" lacks \"point3 P\"");
    check(&mesh("\"integer indices\" [0 1]"), "s.pbrt:2:71: error: 2 indices are no faces of 3 corners each");
    check(&mesh("\"integer indices\" [0 1 3]"), "s.pbrt:2:71: error: vertex 3 does not exist: there are 3");
    check(
        &mesh("\"integer indices\" [0 1 -2]"),
        "s.pbrt:2:71: error: vertex -2 does not exist: the first is 0",
    );
    check(&mesh("\"normal N\" [0 0 1]"), "s.pbrt:2:64: error: 1 of \"N\" for 3 of \"P\"");
    check(&mesh("\"point2 uv\" [0 0 1]"), "s.pbrt:2:65: error: \"uv\": 3 numbers are no point2s of 2 each");
    check(
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1]",
        "s.pbrt:2:33: error: \"P\": 4 numbers are no point3s of 3 each\ns.pbrt:2:8: error: \"trianglemesh\" lacks \"point3 P\"",
    );
    check(
        "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]",
        "s.pbrt:2:8: error: \"bilinearmesh\" lacks \"integer indices\"",
    );
    check(
        "Shape \"plymesh\" \"string filename\" \"noply.ply\"",
        "s.pbrt:2:36: error: noply.ply: not a PLY header: Line 1: Expected magic number 'ply'. String: 'PK'",
    );
    check(
        "Shape \"plymesh\" \"string filename\" \"empty.ply\"",
        "s.pbrt:2:36: error: empty.ply: the file has no faces",
    );
    check(
        "Shape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2] \"integer levels\" 12",
        "s.pbrt:2:8: error: 12 levels make more than 4194304 triangles",
    );
    check("Shape \"sphere\" \"float zmin\" 1", "s.pbrt:2:8: error: nothing is left of the sphere");
    check(
        "Shape \"curve\"",
        "s.pbrt:2:8: error: shape \"curve\" cannot be rendered yet; --lenient leaves it out",
    );
}

#[test]
fn materials_textures_and_colours() {
    check(
        "Material \"difuse\"",
        "s.pbrt:2:11: error: unknown material \"difuse\"; did you mean \"diffuse\"?",
    );
    check(
        "MakeNamedMaterial \"m\"",
        "s.pbrt:2:20: error: the material has no type; write \"string type\" and its name",
    );
    check(
        "NamedMaterial \"m\"",
        "s.pbrt:2:16: error: no material is called \"m\"; MakeNamedMaterial must stand before its use",
    );
    check(
        "Material \"diffuse\" \"rgb reflectance\" [1 2]",
        "s.pbrt:2:38: error: \"reflectance\": 2 numbers are no rgbs of 3 each",
    );
    check(
        "Material \"diffuse\" \"rgb reflectance\" [-1 0 0]",
        "s.pbrt:2:38: error: no channel of a colour can be negative, as -1 is",
    );
    check(
        "Material \"diffuse\" \"texture reflectance\" \"t\"",
        "s.pbrt:2:43: error: no texture is called \"t\"; Texture must stand before its use",
    );
    check(
        "Material \"dielectric\" \"spectrum eta\" \"glass-BK8\"",
        "s.pbrt:2:39: error: no spectrum is called \"glass-BK8\"; did you mean \"glass-BK7\"?",
    );
    check(
        "Material \"dielectric\" \"spectrum eta\" \"spectrum.spd\"",
        "s.pbrt:2:39: error: \"spectrum.spd\": wavelength 300 stands after 400; they must increase",
    );
    check("Material \"dielectric\" \"float eta\" 0", "s.pbrt:2:35: error: \"eta\" must be above zero, not 0");
    check("Material \"mix\"", "s.pbrt:2:11: error: \"mix\" needs \"string materials\", two names");
    check(
        "Texture \"t\" \"spectrums\" \"constant\"",
        "s.pbrt:2:14: error: a texture is of \"float\" or \"spectrum\", not of \"spectrums\"",
    );
    check(
        "Texture \"t\" \"float\" \"imagemp\"",
        "s.pbrt:2:22: error: unknown texture \"imagemp\"; did you mean \"imagemap\"?",
    );
    check(
        "Texture \"t\" \"float\" \"imagemap\"",
        "s.pbrt:2:22: error: texture \"imagemap\" lacks a filename",
    );
    check(
        "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"text.png\"",
        "s.pbrt:2:51: error: \"text.png\" is of no format that is known here; images can be OpenEXR, PNG, JPEG, Radiance HDR, TGA, BMP or PFM files",
    );
    check(
        "Texture \"t\" \"float\" \"constant\"\nTexture \"t\" \"float\" \"constant\"",
        "s.pbrt:3:10: error: the texture \"t\" is there already",
    );
}

#[test]
fn lights_and_media() {
    check("LightSource \"pint\"", "s.pbrt:2:14: error: unknown light \"pint\"; did you mean \"point\"?");
    check(
        "LightSource \"point\" \"spectrum I\" [400 1 500]",
        "s.pbrt:2:34: error: 3 numbers are no pairs of a wavelength and a value",
    );
    check(
        "LightSource \"point\" \"blackbody I\" 0",
        "s.pbrt:2:35: error: a black body has a temperature above zero, not 0",
    );
    check(
        "LightSource \"distant\" \"point3 from\" [0 0 1]",
        "s.pbrt:2:14: error: \"from\" and \"to\" are the same point",
    );
    check(
        "LightSource \"spot\" \"float coneangle\" 90",
        "s.pbrt:2:38: error: \"coneangle\" must be between 0 and 90 degrees, not 90",
    );
    check("LightSource \"projection\"", "s.pbrt:2:14: error: light \"projection\" lacks a filename");
    check(
        "AreaLightSource \"diffus\"",
        "s.pbrt:2:18: error: unknown light \"diffus\"; did you mean \"diffuse\"?",
    );
    check(
        "MakeNamedMedium \"m\" \"string type\" \"homogenous\"",
        "s.pbrt:2:36: error: unknown medium \"homogenous\"; did you mean \"homogeneous\"?",
    );
    check(
        "MakeNamedMedium \"m\" \"string type\" \"nanovdb\"",
        "s.pbrt:2:36: error: medium \"nanovdb\" cannot be rendered yet; --lenient leaves it out",
    );
    check(
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string preset\" \"Coke\"",
        "s.pbrt:2:66: error: the coefficients of \"Coke\" are not known here; write \"sigma_a\" and \"sigma_s\", absorption and scattering per length",
    );
    check(
        "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" [1 2] \"integer nx\" 3",
        "s.pbrt:2:65: error: 2 of \"density\" for 3×1×1 = 3 cells",
    );
    check(
        "MediumInterface \"fog\" \"\"",
        "s.pbrt:2:18: error: no medium is called \"fog\"; MakeNamedMedium must stand before its use",
    );
}

#[test]
fn all_mistakes_are_told_at_once() {
    check(
        "Material \"difuse\"\nShape \"sphere\" \"float radius\" -1\nLightSource \"infinit\"\nAttributeEnd",
        "s.pbrt:2:11: error: unknown material \"difuse\"; did you mean \"diffuse\"?\n\
         s.pbrt:3:31: error: \"radius\" must be above zero, not -1\n\
         s.pbrt:4:14: error: unknown light \"infinit\"; did you mean \"infinite\"?\n\
         s.pbrt:5:1: error: AttributeEnd without AttributeBegin",
    );
}

#[test]
fn textures_of_textures_end() {
    let mut world = "Texture \"t0\" \"float\" \"constant\"".to_owned();
    for i in 1..60 {
        let before = i - 1;
        world += &format!(
            "\nTexture \"t{i}\" \"float\" \"checkerboard\" \"texture tex1\" \"t{before}\" \"texture tex2\" \"t{before}\""
        );
    }
    let found = messages(&format!("Camera \"perspective\" WorldBegin\n{world}"), &Options::default());
    assert!(found.contains("the texture consists of more than 1000 others"), "{found}");
}
