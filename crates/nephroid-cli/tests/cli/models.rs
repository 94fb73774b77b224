//! Models in glTF and meshes alone, and the camera and the sky that flags give to scenes.

use crate::support::{Dir, SCENE};

/// A triangle whose corners are in the text: nine floats in base64.
const MODEL: &str = r#"{
    "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
    "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
    "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
    "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
    "buffers": [{ "byteLength": 36, "uri": "a.bin" }]
}"#;

fn with_model() -> Dir {
    let dir = Dir::new();
    let corners: Vec<u8> =
        [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    std::fs::write(dir.path("a.gltf"), MODEL).unwrap();
    std::fs::write(dir.path("a.bin"), corners).unwrap();
    std::fs::write(dir.path("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    dir
}

/// A sky of one colour.
fn write_sky(dir: &Dir, value: f32) {
    let sky = nephroid::texture::Image::filled(4, 3, nephroid::color::Rgb::splat(value));
    std::fs::write(dir.path("sky.png"), nephroid_formats::image::encode_png(&sky).unwrap()).unwrap();
}

#[test]
fn models_get_a_camera_and_a_sky_and_say_so() {
    let dir = with_model();
    for model in ["a.gltf", "a.obj"] {
        let run = dir.render(model, &["-o", "x.png"]).ends_with(0);
        run.says("no camera and no light").says("--camera and --envmap give others");
    }
    write_sky(&dir, 1.0);
    let view = ["-o", "x.png", "--camera", "-1,0,3;0,0,0"];
    dir.render("a.gltf", &view).ends_with(0).says("no light").does_not_say("no camera");
    let sky = ["-o", "x.png", "--envmap", "sky.png"];
    dir.render("a.gltf", &sky).ends_with(0).says("no camera").does_not_say("no light");
    let both = [&view[..], &sky[2..]].concat();
    dir.render("a.gltf", &both).ends_with(0).does_not_say("the file has no");
}

#[test]
fn bad_models_views_and_skies_are_told() {
    let dir = with_model();
    std::fs::write(dir.path("b.gltf"), MODEL.replace("a.bin", "gone.bin")).unwrap();
    dir.render("b.gltf", &["-o", "x.png"]).ends_with(3).says("cannot read \"gone.bin\"").says("b.gltf:6:");
    dir.render("a.gltf", &["-o", "x.png", "--envmap", "gone.exr"]).ends_with(4).says("gone.exr");
    dir.render("a.gltf", &["-o", "x.png", "--camera", "0,0,0;0,0,0"]).ends_with(2).says("must differ");
}

#[test]
fn views_and_skies_are_of_a_render() {
    let dir = Dir::with_scene("", "");
    write_sky(&dir, 0.5);
    let args = ["--passes", "2", "--camera", "1,0,3;0,0,0", "--envmap", "sky.png"];
    let render = |more: &[&str]| dir.run(&[&["render", "a.xml"], &args[..], more].concat()).ends_with(0);
    render(&["--checkpoint", "c.film", "-o", "x.exr"]);
    render(&["-o", "whole.film", "-o", "whole.exr"]);
    let identity = dir.sums("c.film").3;
    for name in ["--camera", "--envmap", "file sky.png"] {
        assert!(identity.iter().any(|(known, _)| known == name), "{name} is not in {identity:?}");
    }
    // It goes on from another folder, and not with another sky.
    let resume = |passes: &str| {
        std::fs::create_dir_all(dir.path("sub")).unwrap();
        let mut command = dir.command(&["resume", "../c.film", "--passes", passes, "-o", "kept.exr"]);
        crate::support::Run::of(command.current_dir(dir.path("sub")).output().unwrap())
    };
    resume("3").ends_with(0);
    write_sky(&dir, 0.7);
    resume("4").ends_with(4).says("sky.png");
    assert!(SCENE.contains("point"), "its own light stays beside the sky");
}
