//! Any bytes as a model in glTF, as text or as one file: messages that can be shown, or a scene that `World::new` takes or
//! refuses. The files that a model can name are in memory.
#![no_main]

use std::path::Path;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use nephroid_formats::gltf::read_scene;
use nephroid_formats::vfs::MemoryFiles;

#[path = "../panics.rs"]
mod panics;
#[path = "../scene_file.rs"]
mod scene_file;

static FILES: LazyLock<MemoryFiles> = LazyLock::new(|| {
    MemoryFiles::default()
        .with("i.png", *include_bytes!("../seeds/image/two_pixels.png"))
        .with("b.bin", (0..=255).collect::<Vec<u8>>())
});

fuzz_target!(init: panics::forgive_decoders(), |bytes: &[u8]| {
    let files = FILES.clone().with("s.gltf", bytes);
    scene_file::check(|options| read_scene(Path::new("s.gltf"), &files, options));
});
