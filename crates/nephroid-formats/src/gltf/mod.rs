//! Models and scenes in glTF 2.0, as text (`.gltf`) or in one file (`.glb`).
//!
//! The container gives a text and a buffer, the text a tree that knows where everything stands in it, the tree of nodes
//! places; then meshes, materials, lights and the camera of what is shown are read into a [`Scene`]. All mistakes are
//! reported at once, with file, line and column. `docs/gltf.md` says what is read.

mod accessor;
mod buffers;
mod camera;
mod container;
mod extensions;
mod image;
mod item;
mod json;
mod light;
mod material;
mod mesh;
mod node;
mod primitive;
mod reader;
mod surface;
mod texture;
mod uri;

use std::path::Path;

use nephroid::camera::Camera;
use nephroid::math::Transform;
use nephroid::scene::Scene;

use self::item::{Document, Item};
use self::reader::Reader;
use crate::diagnostic::{Diagnostic, Diagnostics, Location, Source};
use crate::fit::{self, Fitted};
use crate::integrator_request::IntegratorRequest;
use crate::log::Log;
use crate::scene_file::{Options, SceneFile, read_whole};
use crate::vfs::Files;

/// Reads a model and all files it refers to. One without a camera or without a light is given them (see [`fit`]).
///
/// # Errors
///
/// All that is wrong with the model, and the warnings with it.
pub fn read_scene(path: &Path, files: &dyn Files, options: &Options) -> Result<SceneFile, Diagnostics> {
    read_bytes(path, read_whole(path, files)?, files, options)
}

/// [`read_scene`] of bytes in memory. `path` is what messages call them; the folder in it, if any, is where the files that
/// the model refers to are looked for.
///
/// # Errors
///
/// All that is wrong with the model, and the warnings with it.
pub fn read_bytes(
    path: &Path,
    bytes: Vec<u8>,
    files: &dyn Files,
    options: &Options,
) -> Result<SceneFile, Diagnostics> {
    let name = path.display().to_string();
    let fails = |diagnostic: Diagnostic| Err(Diagnostics(vec![diagnostic]));
    let container = match container::open(bytes) {
        Ok(container) => container,
        Err(problem) => return fails(Diagnostic::global_error(format!("{name}: {problem}"))),
    };
    let source = Source::new(name, container.json);
    let root = match json::parse(source.text()) {
        Ok(root) => root,
        Err(error) => {
            let at = Location::new(&source, error.byte..error.byte + 1);
            return fails(Diagnostic::error(&at, format!("this is not JSON: {}", error.message)));
        }
    };
    let log = Log::default();
    let document = Document { source: &source, root: &root, log: &log };
    let reader = Reader::new(document.item(), files, path, container.binary, options.lenient);
    let file = is_version_2(document.item()).then(|| interpret(reader)).flatten();
    SceneFile::read(file, log)
}

fn is_version_2(root: Item) -> bool {
    let Some(asset) = root.object("asset") else {
        root.error_with_hint("the document has no \"asset\"", "only glTF 2.0 is read, and this may be none");
        return false;
    };
    let version = asset.text("minVersion").or_else(|| asset.text("version")).unwrap_or_default();
    let is_read = version.split('.').next() == Some("2");
    if !is_read {
        asset.error(format!("the document is of version \"{version}\", and only 2.0 is read"));
    }
    is_read
}

fn interpret(mut reader: Reader) -> Option<SceneFile> {
    let root = reader.root;
    extensions::check(root, reader.lenient);
    if root.log().has_errors() {
        return None;
    }
    let nodes = node::placed(root);
    if !root.list("animations").is_empty() {
        reader.once(root, "animations are not read: everything is shown as its nodes have it");
    }
    let view = reader.camera(&nodes);
    reader.lights(&nodes);
    reader.shown(&nodes);
    if root.log().has_errors() {
        return None;
    }
    if reader.shapes.is_empty() && reader.instances.is_empty() {
        root.error("the document shows no triangles");
        return None;
    }
    let has_camera = view.is_some();
    let (camera, film) = view.unwrap_or_else(|| {
        let projection = fit::perspective(45.0);
        (Camera { to_world: Transform::IDENTITY, projection, medium: None }, fit::film())
    });
    let Reader { textures, materials, meshes, shapes, groups, instances, lights, media, mut origins, .. } =
        reader;
    origins.shapes.extend(reader.shapes_of_groups);
    let scene = Scene { camera, film, textures, materials, meshes, shapes, groups, instances, lights, media };
    // A model whose lamps are parts of it is no scene that they light, unless someone took a view of it.
    let sky = fit::is_dark(&scene) || (!has_camera && scene.lights.is_empty());
    let integrator = IntegratorRequest::default();
    let fitted = Fitted::default();
    let mut file = SceneFile { scene, integrator, sample_count: None, warnings: Vec::new(), origins, fitted };
    file.fit(Fitted { camera: !has_camera, sky });
    Some(file)
}
