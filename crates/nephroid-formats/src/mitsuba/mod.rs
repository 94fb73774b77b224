//! Scenes in the XML format of Mitsuba 2 and 3, and the older one of 0.4 to 0.6.
//!
//! A text becomes a tree with its includes and parameters filled in, then each element is read
//! into a [`Scene`]. All mistakes are reported at once, with file, line and column. Names that no
//! version of the format has are errors; what the format has but cannot be rendered yet is replaced
//! by its nearest kin with a warning, or refused where nothing is near (see [`Options::lenient`]).

mod boundary;
mod daylight;
mod dispersion;
mod document;
mod emitter;
mod group;
mod integrator;
mod ior;
mod layered;
mod legacy;
mod material;
mod medium;
mod names;
mod parameters;
mod principled;
mod properties;
mod reader;
mod roughness;
mod sensor;
mod shape;
mod spectrum;
mod texture;
mod transform;
mod value;
mod volume;

use std::path::Path;

use nephroid::scene::Scene;

use self::document::{Document, Element};
use self::reader::Reader;
use self::sensor::no_sensor;
use self::value::Ids;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::fit::Fitted;
use crate::log::Log;
use crate::scene_file::{Options, Origins, SceneFile, read_whole};
use crate::vfs::Files;

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
    let file = document::load(path, bytes, files, &options.defines, &log)
        .and_then(|document| interpret(&document, files, options, &log));
    SceneFile::read(file, log)
}

fn interpret(document: &Document, files: &dyn Files, options: &Options, log: &Log) -> Option<SceneFile> {
    let ids = collect_ids(document, log);
    let origins = Origins::at(document.root.clone());
    let mut reader = Reader::new(&ids, log, files, &document.folders, options.lenient, origins);
    let integrator = reader.integrator(&document.elements);
    let sensor = reader.sensor(&document.elements);
    reader.content(&document.elements);
    reader.warn_of_unused_groups();
    reader.warn_of_unused_lamps(&document.elements);
    let sensor = sensor?;
    let Reader { textures, materials, meshes, shapes, groups, instances, lights, media, mut origins, .. } =
        reader;
    origins.shapes.extend(reader.shapes_of_groups);
    let (camera, film) = (sensor.camera, sensor.film);
    let scene = Scene { camera, film, textures, materials, meshes, shapes, groups, instances, lights, media };
    let sample_count = sensor.sample_count;
    let fitted = Fitted::default();
    let mut file = SceneFile { scene, integrator, sample_count, warnings: Vec::new(), origins, fitted };
    file.fit(Fitted { camera: sensor.is_missing, sky: false });
    if sensor.is_missing && !file.fitted.camera {
        // Nothing has an end, so that nothing can be seen whole.
        log.push(no_sensor(&document.root));
    }
    Some(file)
}

/// Every `id` of the scene and the other names that aliases give them.
fn collect_ids<'t>(document: &'t Document, log: &Log) -> Ids<'t> {
    let mut ids = Ids::new();
    for element in &document.elements {
        collect_ids_of(element, &mut ids, log);
    }
    for (existing, new, at) in &document.aliases {
        match ids.get(existing.as_str()).copied() {
            Some(element) => {
                if ids.insert(new, element).is_some() {
                    log.error(at, format!("the id \"{new}\" is taken"));
                }
            }
            None => {
                let message = format!("nothing has the id \"{existing}\"");
                log.push(Diagnostic::error(at, message).did_you_mean(existing, ids.keys().copied()));
            }
        }
    }
    ids
}

fn collect_ids_of<'t>(element: &'t Element, ids: &mut Ids<'t>, log: &Log) {
    if let Some(id) = element.attribute("id").filter(|_| element.tag != "ref")
        && let Some(first) = ids.insert(&id.value, element)
    {
        let message = format!("the id \"{}\" is taken", id.value);
        let other = first.attribute("id").map_or(&first.location, |a| &a.location);
        log.push(Diagnostic::error(&id.location, message).hint(format!("it is first given at {other}")));
    }
    for child in &element.children {
        collect_ids_of(child, ids, log);
    }
}
