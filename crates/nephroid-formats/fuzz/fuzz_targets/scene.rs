//! Any bytes as a scene file: messages that can be shown, or a scene that `World::new` takes or refuses.
//!
//! The files that a scene can name are in memory: a mesh of each kind, a picture, a volume, a spectrum, a light profile, an
//! included file, and the scene itself.
#![no_main]

use std::path::Path;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use nephroid_formats::mitsuba::read_scene;
use nephroid_formats::vfs::MemoryFiles;

#[path = "../scene_file.rs"]
mod scene_file;

static FILES: LazyLock<MemoryFiles> = LazyLock::new(|| {
    MemoryFiles::default()
        .with("m.obj", *include_bytes!("../seeds/obj/quad.obj"))
        .with("m.ply", *include_bytes!("../seeds/ply/ascii.ply"))
        .with("m.serialized", *include_bytes!("../seeds/serialized/single.serialized"))
        .with("i.png", *include_bytes!("../seeds/image/two_pixels.png"))
        .with("v.vol", *include_bytes!("../seeds/vol/floats.vol"))
        .with("l.ies", *include_bytes!("../seeds/ies/quarter.ies"))
        .with("s.spd", "400 0.1\n500 0.5\n700 0.2\n")
        .with("p.xml", "<scene version=\"3.0.0\"><bsdf type=\"diffuse\" id=\"p\"/></scene>")
});

fuzz_target!(|bytes: &[u8]| {
    let files = FILES.clone().with("s.xml", bytes);
    scene_file::check(|options| read_scene(Path::new("s.xml"), &files, options));
});
