//! Scenes in the format of pbrt-v4, and much of what older files say.
//!
//! Directives are obeyed one after the other, as pbrt does it: they change the graphics state, and what they
//! describe goes into a [`Scene`]. All mistakes are reported at once, with file, line and column. Names
//! that no version of the format has are errors; what the format has but cannot be rendered yet is replaced by
//! its nearest kin with a warning, or refused where nothing is near (see [`Options::lenient`]).

mod area_light;
mod attributes;
mod camera;
mod color;
mod color_space;
mod combine;
mod directives;
mod image;
mod image_light;
mod include;
mod integrator;
mod light;
mod material;
mod material_old;
mod medium;
mod medium_presets;
mod mesh;
mod named;
mod names;
mod object;
mod parameter;
mod parameters;
mod patches;
mod quadric;
mod reader;
mod roughness;
mod shape;
mod state;
mod texture;
mod token;
mod transform;

use std::path::Path;

use nephroid::film::FilmSettings;
use nephroid::scene::Scene;

use self::reader::Reader;
use crate::diagnostic::{Diagnostics, Location, Source};
use crate::fit::Fitted;
use crate::log::Log;
use crate::open::decode;
use crate::scene_file::{Options, Origins, SceneFile, read_whole};
use crate::vfs::Files;

/// Files that are included one in the other.
const MAX_DEPTH: usize = 16;
/// Files that are included in all.
const MAX_FILES: usize = 1000;

/// Reads a scene and all files it refers to.
///
/// # Errors
///
/// All that is wrong with the scene, and the warnings with it.
pub fn read_scene(path: &Path, files: &dyn Files, options: &Options) -> Result<SceneFile, Diagnostics> {
    read_bytes(path, read_whole(path, files)?, files, options)
}

/// Reads a scene from a text. `name` is what messages call it; the folder in it, if any, is where
/// the files that the scene refers to are looked for.
///
/// # Errors
///
/// All that is wrong with the scene, and the warnings with it.
pub fn read_scene_str(
    name: &str,
    text: &str,
    files: &dyn Files,
    options: &Options,
) -> Result<SceneFile, Diagnostics> {
    read_bytes(Path::new(name), text.as_bytes().to_vec(), files, options)
}

fn read_bytes(
    path: &Path,
    bytes: Vec<u8>,
    files: &dyn Files,
    options: &Options,
) -> Result<SceneFile, Diagnostics> {
    let log = Log::default();
    let file = interpret(path, bytes, files, options, &log);
    SceneFile::read(file, log)
}

fn interpret(
    path: &Path,
    bytes: Vec<u8>,
    files: &dyn Files,
    options: &Options,
    log: &Log,
) -> Option<SceneFile> {
    let name = path.display().to_string();
    let bytes = include::inflated(path, bytes, &Location::new(&Source::new(&name, ""), 0..0), log)?;
    let source = decode(&name, bytes, None, log)?;
    let origins = Origins::at(Location::new(&source, 0..0));
    let mut reader = Reader::new(log, files, options, origins);
    reader.whole(path, source);
    let camera = reader.camera?;
    let Reader { textures, materials, meshes, shapes, groups, instances, lights, media, mut origins, .. } =
        reader;
    origins.shapes.extend(reader.shapes_of_groups);
    let film = FilmSettings { filter: reader.filter, ..reader.film };
    let scene = Scene { camera, film, textures, materials, meshes, shapes, groups, instances, lights, media };
    let (integrator, sample_count) = (reader.integrator, reader.sample_count);
    Some(SceneFile {
        scene,
        integrator,
        sample_count,
        warnings: Vec::new(),
        origins,
        fitted: Fitted::default(),
    })
}
