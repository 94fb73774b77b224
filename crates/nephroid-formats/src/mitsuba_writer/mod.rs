//! Scenes as files of Mitsuba 3: the XML, and beside it meshes as PLY, images as PNG or OpenEXR and grids as VOL.
//!
//! What Mitsuba lacks is written as what comes nearest to it, or left out, with a warning; all else is read again as
//! it was, but for names.

mod camera;
mod image;
mod lights;
mod materials;
mod media;
mod ply;
mod rough;
mod shapes;
mod textures;
mod vol;
mod xml;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use nephroid::scene::Scene;

use self::xml::Xml;
use crate::image::{ImageError, ImageProblem, write_atomically};
use crate::scene_file::SceneFile;

/// A scene that was written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WrittenScene {
    /// What the files are called that stand beside it, in order.
    pub files: Vec<String>,
    /// What is not as it was.
    pub warnings: Vec<String>,
}

/// Where the files of a scene go: a name and the bytes.
pub type Sink<'a> = dyn FnMut(&str, Vec<u8>) -> Result<(), ImageError> + 'a;

/// The folder for what stands beside a scene file: `room_files` for `room.xml`.
pub fn folder_of_files(path: &Path) -> String {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    format!("{}_files", plain_name(&stem))
}

/// Writes a scene to `path`, and what it needs into the [folder](folder_of_files) beside it, which is made if there is
/// something to put into it. Files that exist are replaced, each whole or not at all.
///
/// # Errors
///
/// The first file that cannot be written.
pub fn write_mitsuba(path: &Path, file: &SceneFile) -> Result<WrittenScene, ImageError> {
    crate::image::check_writable(path)?;
    let beside = path.parent().unwrap_or(Path::new(""));
    let folder = folder_of_files(path);
    let mut sink = |name: &str, bytes: Vec<u8>| {
        let place = beside.join(&folder);
        std::fs::create_dir_all(&place)
            .map_err(|error| ImageError { path: place, problem: ImageProblem::Write(error) })?;
        write_atomically(&beside.join(name), || Ok(bytes))
    };
    let (text, written) = encode_mitsuba(file, &folder, &mut sink)?;
    write_atomically(path, || Ok(text.into_bytes()))?;
    Ok(written)
}

/// The XML of a scene. Whatever stands beside it goes into `sink`, under names that begin with `folder`.
///
/// # Errors
///
/// What the sink gives back, or an image that cannot be written.
pub fn encode_mitsuba(
    file: &SceneFile,
    folder: &str,
    sink: &mut Sink,
) -> Result<(String, WrittenScene), ImageError> {
    let mut writer = Writer {
        scene: &file.scene,
        xml: Xml::default(),
        folder,
        sink,
        written: WrittenScene::default(),
        ids: BTreeSet::new(),
        media: Vec::new(),
        images: Vec::new(),
        meshes: BTreeMap::new(),
        groups: Vec::new(),
    };
    writer.xml.open("scene", &[("version", "3.0.0")]);
    writer.integrator(&file.integrator);
    writer.media()?;
    writer.sensor(file.sample_count);
    writer.textures()?;
    writer.materials();
    writer.shapes()?;
    writer.lights();
    Ok((writer.xml.finish(), writer.written))
}

/// A scene on its way to a text.
struct Writer<'a, 's> {
    scene: &'a Scene,
    xml: Xml,
    folder: &'a str,
    sink: &'a mut Sink<'s>,
    written: WrittenScene,
    /// Those that are given.
    ids: BTreeSet<String>,
    /// The id of each medium.
    media: Vec<String>,
    /// The file of each image.
    images: Vec<textures::ImageName>,
    /// The file of each mesh that was written.
    meshes: BTreeMap<usize, String>,
    /// The id of each group.
    groups: Vec<String>,
}

impl Writer<'_, '_> {
    fn warn(&mut self, message: impl Into<String>) {
        let message = message.into();
        if !self.written.warnings.contains(&message) {
            self.written.warnings.push(message);
        }
    }

    /// Puts a file beside the scene and gives its name.
    fn store(&mut self, name: &str, bytes: Vec<u8>) -> Result<String, ImageError> {
        let name = format!("{}/{name}", self.folder);
        (self.sink)(&name, bytes)?;
        self.written.files.push(name.clone());
        Ok(name)
    }

    /// An id that no other part has, as near to a name as can be.
    fn id(&mut self, name: &str) -> String {
        let name = plain_name(name);
        let mut id = name.clone();
        let mut number = 2;
        while !self.ids.insert(id.clone()) {
            id = format!("{name}-{number}");
            number += 1;
        }
        id
    }
}

/// A name of letters, digits, `-` and `_`: points and dollar signs mean something in Mitsuba.
fn plain_name(name: &str) -> String {
    let plain: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect();
    if plain.is_empty() { "scene".to_owned() } else { plain }
}
