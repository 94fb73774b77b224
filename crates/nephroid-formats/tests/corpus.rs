//! What fuzzing has found worth keeping: of each reader the fewest inputs that reach as much of it as all others together did.
//! Each must end as the fuzz target asks, which is no panic and no broken promise.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use flate2::read::GzDecoder;
use nephroid_formats::ies::read_ies;
use nephroid_formats::image::read_texture;
use nephroid_formats::mesh::{MeshOptions, read_obj, read_ply, read_serialized};
use nephroid_formats::vfs::MemoryFiles;
use nephroid_formats::volume::read_vol;
use nephroid_formats::{gltf, mitsuba, pbrt};

#[path = "../fuzz/mesh.rs"]
mod mesh;
#[path = "../fuzz/scene_file.rs"]
mod scene_file;

const OPTIONS: MeshOptions = MeshOptions { face_normals: false, flip_tex_coords: true };

/// Calls a function for each input that is kept for a target.
fn each(target: &str, check: impl Fn(&[u8])) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(format!("{target}.tar.gz"));
    let mut archive = tar::Archive::new(GzDecoder::new(File::open(path).expect("there is a corpus")));
    let mut count = 0;
    for entry in archive.entries().expect("an archive") {
        let mut entry = entry.expect("an archive");
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).expect("an archive");
        if entry.header().entry_type().is_file() {
            check(&bytes);
            count += 1;
        }
    }
    assert!(count > 20, "{target}: {count}");
}

/// The files that scenes of the corpus may name.
fn files() -> MemoryFiles {
    MemoryFiles::default()
        .with("m.obj", *include_bytes!("../fuzz/seeds/obj/quad.obj"))
        .with("m.ply", *include_bytes!("../fuzz/seeds/ply/ascii.ply"))
        .with("m.serialized", *include_bytes!("../fuzz/seeds/serialized/single.serialized"))
        .with("i.png", *include_bytes!("../fuzz/seeds/image/two_pixels.png"))
        .with("v.vol", *include_bytes!("../fuzz/seeds/vol/floats.vol"))
        .with("l.ies", *include_bytes!("../fuzz/seeds/ies/quarter.ies"))
        .with("b.bin", (0..=255).collect::<Vec<u8>>())
        .with("s.spd", "400 0.1\n500 0.5\n700 0.2\n")
        .with("p.xml", "<scene version=\"3.0.0\"><bsdf type=\"diffuse\" id=\"p\"/></scene>")
        .with("p.pbrt", "Material \"diffuse\" Shape \"sphere\"")
}

#[test]
fn scenes_of_mitsuba() {
    each("scene", |bytes| {
        let files = files().with("s.xml", bytes);
        scene_file::check(|options| mitsuba::read_scene(Path::new("s.xml"), &files, options));
    });
}

#[test]
fn scenes_of_pbrt() {
    each("pbrt", |bytes| {
        let files = files().with("s.pbrt", bytes);
        scene_file::check(|options| pbrt::read_scene(Path::new("s.pbrt"), &files, options));
    });
}

#[test]
fn models() {
    each("gltf", |bytes| {
        let files = files().with("s.gltf", bytes);
        scene_file::check(|options| gltf::read_scene(Path::new("s.gltf"), &files, options));
    });
}

#[test]
fn meshes() {
    each("obj", |bytes| mesh::check(read_obj(bytes, OPTIONS)));
    each("ply", |bytes| mesh::check(read_ply(bytes, OPTIONS)));
    each("serialized", |bytes| {
        for shape_index in [0, 1] {
            mesh::check(read_serialized(bytes, shape_index, OPTIONS));
        }
    });
}

#[test]
fn pictures_volumes_and_light_profiles() {
    each("image", |bytes| {
        if let Ok(file) = read_texture(bytes, false) {
            let count = u64::from(file.image.width) * u64::from(file.image.height);
            assert_eq!(file.image.pixels.iter().count() as u64, count);
        }
    });
    each("vol", |bytes| {
        if let Ok(file) = read_vol(bytes) {
            assert!(!file.size.contains(&0));
        }
    });
    each("ies", |bytes| {
        if let Ok(profile) = read_ies(&String::from_utf8_lossy(bytes)) {
            assert!(profile.peak_candela > 0.0 && profile.peak_candela.is_finite());
        }
    });
}
