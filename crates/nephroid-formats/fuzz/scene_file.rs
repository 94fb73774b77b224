//! What is asked of every scene that a reader lets through, and of the messages where it does not.

use nephroid::world::World;
use nephroid_formats::diagnostic::Diagnostics;
use nephroid_formats::{Options, Origins, SceneFile};

/// Panics where a scene breaks a promise of its reader, or a message cannot be shown. `read` reads the same bytes each time.
pub fn check(read: impl Fn(&Options) -> Result<SceneFile, Diagnostics>) {
    for lenient in [false, true] {
        match read(&Options { lenient, ..Options::default() }) {
            Ok(file) => return check_scene(file),
            Err(diagnostics) => {
                assert!(!diagnostics.0.is_empty());
                assert!(!diagnostics.to_string().is_empty());
                // Drawing one takes longer than reading a scene, and one is like the other.
                assert!(diagnostics.0.iter().take(2).all(|d| !d.render(true).is_empty()));
            }
        }
    }
}

fn check_scene(SceneFile { scene, origins, warnings, .. }: SceneFile) {
    assert!(warnings.iter().take(2).all(|w| !w.render(false).is_empty()));
    let Origins { shapes, groups, instances, lights, textures, images, materials, media, grids, .. } =
        origins;
    assert_eq!(shapes.len(), scene.all_shapes().count());
    assert_eq!(groups.len(), scene.groups.len());
    assert_eq!(instances.len(), scene.instances.len());
    assert_eq!(lights.len(), scene.lights.len());
    assert_eq!(textures.len(), scene.textures.list.len());
    assert_eq!(images.len(), scene.textures.images.len());
    assert_eq!(materials.len(), scene.materials.len());
    assert_eq!(media.len(), scene.media.list.len());
    assert_eq!(grids.len(), scene.media.grids.len());
    if let Err(errors) = World::new(scene) {
        assert!(errors.0.iter().all(|error| !error.message.is_empty()));
    }
}
