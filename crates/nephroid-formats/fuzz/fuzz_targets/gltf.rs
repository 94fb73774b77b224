//! Any bytes as a model in glTF, as text or as one file: messages that can be shown, or a scene that `World::new` takes or
//! refuses. The files that a model can name are in memory.
#![no_main]

use std::path::Path;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use nephroid::world::World;
use nephroid_formats::Options;
use nephroid_formats::gltf::read_scene;
use nephroid_formats::vfs::MemoryFiles;

static FILES: LazyLock<MemoryFiles> = LazyLock::new(|| {
    MemoryFiles::default()
        .with("i.png", *include_bytes!("../seeds/two_pixels.png"))
        .with("b.bin", (0..=255).collect::<Vec<u8>>())
});

fuzz_target!(|bytes: &[u8]| {
    let files = FILES.clone().with("s.gltf", bytes);
    for lenient in [false, true] {
        match read_scene(Path::new("s.gltf"), &files, &Options { defines: Vec::new(), lenient }) {
            Ok(file) => {
                assert!(file.warnings.iter().take(2).all(|w| !w.render(false).is_empty()));
                assert_eq!(file.origins.shapes.len(), file.scene.all_shapes().count());
                assert_eq!(file.origins.lights.len(), file.scene.lights.len());
                assert_eq!(file.origins.materials.len(), file.scene.materials.len());
                assert_eq!(file.origins.textures.len(), file.scene.textures.list.len());
                assert_eq!(file.origins.images.len(), file.scene.textures.images.len());
                assert_eq!(file.origins.media.len(), file.scene.media.list.len());
                if let Err(errors) = World::new(file.scene) {
                    assert!(errors.0.iter().all(|error| !error.message.is_empty()));
                }
                return;
            }
            Err(diagnostics) => {
                assert!(!diagnostics.0.is_empty());
                assert!(diagnostics.0.iter().take(2).all(|d| !d.render(true).is_empty()));
            }
        }
    }
});
