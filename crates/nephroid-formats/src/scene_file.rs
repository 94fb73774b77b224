//! What every reader of scenes gives: the scene, how its file wants it rendered, and where its parts stand.

use std::path::Path;

use nephroid::scene::Scene;

use crate::diagnostic::{Diagnostic, Diagnostics, Location};
use crate::fit::Fitted;
use crate::integrator_request::IntegratorRequest;
use crate::log::Log;
use crate::vfs::Files;

/// How to read a scene.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Values for the scene's `$parameters`, before its own defaults.
    pub defines: Vec<(String, String)>,
    /// Leave out shapes, lights and media that cannot be rendered yet, and properties that nobody knows, with a warning each;
    /// else they are errors.
    pub lenient: bool,
}

/// A scene as its file describes it.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFile {
    /// What is to be seen.
    pub scene: Scene,
    /// How to render it.
    pub integrator: IntegratorRequest,
    /// Samples in a pixel, if the file says.
    pub sample_count: Option<u32>,
    /// What may not be as intended.
    pub warnings: Vec<Diagnostic>,
    /// Where the parts of the scene stand in the file.
    pub origins: Origins,
    /// What it was given beyond its file.
    pub fitted: Fitted,
}

/// Where the parts of a scene stand in its file, by their index in the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Origins {
    /// The scene as a whole.
    pub scene: Location,
    /// The camera and its film.
    pub camera: Location,
    /// Each of [`Scene::shapes`], then each shape of [`Scene::groups`].
    pub shapes: Vec<Location>,
    /// Each of [`Scene::groups`].
    pub groups: Vec<Location>,
    /// Each of [`Scene::instances`].
    pub instances: Vec<Location>,
    /// Each of [`Scene::lights`].
    pub lights: Vec<Location>,
    /// Each of [`Textures::list`](nephroid::texture::Textures::list): a texture, or the property that is a
    /// colour.
    pub textures: Vec<Location>,
    /// Each of [`Textures::images`](nephroid::texture::Textures::images): where its file is first named.
    pub images: Vec<Location>,
    /// Each of [`Scene::materials`]. A default material has the place of the first shape it is for.
    pub materials: Vec<Location>,
    /// Each of [`Media::list`](nephroid::medium::Media::list).
    pub media: Vec<Location>,
    /// Each of [`Media::grids`](nephroid::medium::Media::grids): where its file is first named.
    pub grids: Vec<Location>,
}

impl SceneFile {
    /// What reading gives: the scene with its warnings, or all messages if it is none or any of them is an error.
    pub(crate) fn read(file: Option<Self>, log: Log) -> Result<Self, Diagnostics> {
        let has_errors = log.has_errors();
        let warnings = log.into_list();
        match file {
            Some(file) if !has_errors => Ok(Self { warnings, ..file }),
            _ => Err(Diagnostics(warnings)),
        }
    }
}

/// The bytes of a scene's own file.
pub(crate) fn read_whole(path: &Path, files: &dyn Files) -> Result<Vec<u8>, Diagnostics> {
    files.read(path).map_err(|error| {
        let message = format!("cannot read \"{}\": {error}", path.display());
        Diagnostics(vec![Diagnostic::global_error(message)])
    })
}

impl Origins {
    /// Those of a scene with nothing in it yet.
    pub fn at(scene: Location) -> Self {
        Self {
            camera: scene.clone(),
            scene,
            shapes: Vec::new(),
            groups: Vec::new(),
            instances: Vec::new(),
            lights: Vec::new(),
            textures: Vec::new(),
            images: Vec::new(),
            materials: Vec::new(),
            media: Vec::new(),
            grids: Vec::new(),
        }
    }
}
