//! Any bytes as a scene of pbrt: messages that can be shown, or a scene that `World::new` takes or refuses.
//!
//! The files that a scene can name are in memory: a mesh, a picture, a spectrum, an included file, and the scene itself.
#![no_main]

use std::path::Path;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use nephroid::world::World;
use nephroid_formats::Options;
use nephroid_formats::pbrt::read_scene;
use nephroid_formats::vfs::MemoryFiles;

static FILES: LazyLock<MemoryFiles> = LazyLock::new(|| {
    MemoryFiles::default()
        .with("m.ply", *include_bytes!("../seeds/ply/ascii.ply"))
        .with("i.png", *include_bytes!("../seeds/two_pixels.png"))
        .with("s.spd", "400 0.1\n500 0.5\n700 0.2\n")
        .with("p.pbrt", "Material \"diffuse\" Shape \"sphere\"")
});

fuzz_target!(|bytes: &[u8]| {
    let files = FILES.clone().with("s.pbrt", bytes);
    for lenient in [false, true] {
        match read_scene(Path::new("s.pbrt"), &files, &Options { defines: Vec::new(), lenient }) {
            Ok(file) => {
                assert!(file.warnings.iter().take(2).all(|w| !w.render(false).is_empty()));
                let scene = &file.scene;
                let grouped = scene.groups.iter().map(|group| group.shapes.len()).sum::<usize>();
                assert_eq!(file.origins.shapes.len(), scene.shapes.len() + grouped);
                assert_eq!(file.origins.groups.len(), scene.groups.len());
                assert_eq!(file.origins.instances.len(), scene.instances.len());
                assert_eq!(file.origins.lights.len(), scene.lights.len());
                assert_eq!(file.origins.materials.len(), scene.materials.len());
                assert_eq!(file.origins.textures.len(), scene.textures.list.len());
                assert_eq!(file.origins.images.len(), scene.textures.images.len());
                assert_eq!(file.origins.media.len(), scene.media.list.len());
                assert_eq!(file.origins.grids.len(), scene.media.grids.len());
                if let Err(errors) = World::new(file.scene) {
                    assert!(errors.0.iter().all(|error| !error.message.is_empty()));
                }
                return;
            }
            Err(diagnostics) => {
                assert!(!diagnostics.0.is_empty());
                assert!(!diagnostics.to_string().is_empty());
                // Drawing one takes longer than reading a scene, and one is like the other.
                assert!(diagnostics.0.iter().take(2).all(|d| !d.render(true).is_empty()));
            }
        }
    }
});
