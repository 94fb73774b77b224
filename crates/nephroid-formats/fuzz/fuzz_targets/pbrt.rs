//! Any bytes as a scene of pbrt: messages that can be shown, or a scene that `World::new` takes or refuses.
//!
//! The files that a scene can name are in memory: a mesh, a picture, a spectrum, an included file, and the scene itself.
#![no_main]

use std::path::Path;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use nephroid_formats::pbrt::read_scene;
use nephroid_formats::vfs::MemoryFiles;

#[path = "../scene_file.rs"]
mod scene_file;

static FILES: LazyLock<MemoryFiles> = LazyLock::new(|| {
    MemoryFiles::default()
        .with("m.ply", *include_bytes!("../seeds/ply/ascii.ply"))
        .with("i.png", *include_bytes!("../seeds/image/two_pixels.png"))
        .with("s.spd", "400 0.1\n500 0.5\n700 0.2\n")
        .with("p.pbrt", "Material \"diffuse\" Shape \"sphere\"")
});

fuzz_target!(|bytes: &[u8]| {
    let files = FILES.clone().with("s.pbrt", bytes);
    scene_file::check(|options| read_scene(Path::new("s.pbrt"), &files, options));
});
