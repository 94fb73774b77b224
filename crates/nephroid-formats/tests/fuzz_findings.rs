//! What the fuzz targets start from must be readable, or they would only ever fuzz the first error. Inputs that they
//! find, once the reader is mended, are to be added here.

use std::path::Path;

use nephroid_formats::Options;
use nephroid_formats::ies::read_ies;
use nephroid_formats::image::read_texture;
use nephroid_formats::mesh::{MeshOptions, read_obj, read_ply, read_serialized};
use nephroid_formats::mitsuba::read_scene_str;
use nephroid_formats::vfs::MemoryFiles;
use nephroid_formats::volume::read_vol;

/// Names and contents of the seeds of a target.
fn seeds(target: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds").join(target);
    let read = |entry: std::io::Result<std::fs::DirEntry>| {
        let path = entry.expect("the folder can be read").path();
        (path.display().to_string(), std::fs::read(path).expect("a seed can be read"))
    };
    std::fs::read_dir(folder).expect("there are seeds").map(read).collect()
}

#[test]
fn seeds_of_meshes_can_be_read() {
    for (name, bytes) in seeds("obj") {
        read_obj(&bytes, MeshOptions::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    for (name, bytes) in seeds("ply") {
        read_ply(&bytes, MeshOptions::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    for (name, bytes) in seeds("serialized") {
        read_serialized(&bytes, 0, MeshOptions::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

#[test]
fn seeds_of_pictures_and_light_profiles_can_be_read() {
    for (name, bytes) in seeds("image") {
        read_texture(&bytes, false).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    for (name, bytes) in seeds("ies") {
        let text = String::from_utf8(bytes).expect("a seed is a text");
        read_ies(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

#[test]
fn seeds_of_volumes_can_be_read() {
    for (name, bytes) in seeds("vol") {
        read_vol(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

#[test]
fn seeds_of_scenes_can_be_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds");
    let file = |path: &str| std::fs::read(folder.join(path)).unwrap();
    let files = MemoryFiles::default()
        .with("m.obj", file("obj/quad.obj"))
        .with("m.ply", file("ply/ascii.ply"))
        .with("m.serialized", file("serialized/single.serialized"))
        .with("i.png", file("image/two_pixels.png"))
        .with("v.vol", file("vol/floats.vol"))
        .with("l.ies", file("ies/quarter.ies"))
        .with("s.spd", "400 0.1\n500 0.5\n700 0.2\n")
        .with("p.xml", "<scene version=\"3.0.0\"><bsdf type=\"diffuse\" id=\"p\"/></scene>");
    let options = Options { defines: Vec::new(), lenient: true };
    for (name, bytes) in seeds("scene") {
        let text = String::from_utf8(bytes).unwrap();
        let read = read_scene_str("s.xml", &text, &files, &options);
        let scene = read.unwrap_or_else(|errors| panic!("{name}: {errors}")).scene;
        nephroid::world::World::new(scene).unwrap_or_else(|errors| panic!("{name}: {errors}"));
    }
}

#[test]
fn seeds_of_models_can_be_read() {
    let pixels = std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds/image/two_pixels.png"));
    let files = MemoryFiles::default().with("i.png", pixels.expect("a seed can be read"));
    for (name, bytes) in seeds("gltf") {
        let files = files.clone().with("s.gltf", bytes);
        let read = nephroid_formats::gltf::read_scene(Path::new("s.gltf"), &files, &Options::default());
        let scene = read.unwrap_or_else(|errors| panic!("{name}: {errors}")).scene;
        nephroid::world::World::new(scene).unwrap_or_else(|errors| panic!("{name}: {errors}"));
    }
}
