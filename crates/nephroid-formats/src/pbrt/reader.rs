//! The scene in the making, and what all its parts need.

use std::collections::BTreeMap;
use std::path::PathBuf;

use nephroid::camera::Camera;
use nephroid::film::{FilmSettings, Filter};
use nephroid::handle::{Arena, Handle};
use nephroid::light::Light;
use nephroid::material::Material;
use nephroid::math::Transform;
use nephroid::medium::{Media, Medium};
use nephroid::shape::{Group, Instance, Mesh, Shape};
use nephroid::texture::{Pixmap, Texture, Textures};

use super::color_space::ColorSpace;
use super::image::ImageKey;
use super::parameter::Parameter;
use super::parameters::Parameters;
use super::state::{Saved, State};
use crate::diagnostic::{Diagnostic, Location};
use crate::integrator_request::IntegratorRequest;
use crate::log::{Log, shortened};
use crate::open::read_named;
use crate::scene_file::{Options, Origins};
use crate::vfs::Files;

/// Everything that has been read so far.
pub(super) struct Reader<'t> {
    pub(super) log: &'t Log,
    pub(super) files: &'t dyn Files,
    pub(super) lenient: bool,
    /// Where files are looked for: beside the scene, then beside the file that is being read.
    pub(super) folders: Vec<PathBuf>,
    /// The files that are being read, to tell one that includes itself.
    pub(super) open: Vec<PathBuf>,
    pub(super) bytes_left: usize,
    pub(super) files_left: usize,

    pub(super) in_world: bool,
    pub(super) state: State,
    pub(super) saved: Vec<Saved>,
    /// With whether a scale of zero hides what is in them.
    pub(super) coordinate_systems: BTreeMap<String, (Transform, bool)>,
    /// Whether a message has said that something is hidden.
    pub(super) told_of_hidden: bool,

    pub(super) camera: Option<Camera>,
    pub(super) film: FilmSettings,
    pub(super) filter: Filter,
    /// What the sensor multiplies radiance by.
    pub(super) exposure: f32,
    /// Things of which there is one, by their directive.
    pub(super) given: BTreeMap<&'static str, Location>,
    pub(super) integrator: IntegratorRequest,
    pub(super) sample_count: Option<u32>,

    pub(super) textures: Textures,
    pub(super) materials: Arena<Material>,
    pub(super) meshes: Arena<Mesh>,
    pub(super) shapes: Vec<Shape>,
    pub(super) groups: Arena<Group>,
    pub(super) instances: Vec<Instance>,
    pub(super) shapes_of_groups: Vec<Location>,
    pub(super) lights: Vec<Light>,
    pub(super) media: Media,
    pub(super) origins: Origins,

    /// Textures by whether they are of colours, and their name; `None` if what is wrong has been told.
    pub(super) named_textures: BTreeMap<(bool, String), Option<Handle<Texture>>>,
    pub(super) named_materials: BTreeMap<String, Option<Handle<Material>>>,
    pub(super) named_media: BTreeMap<String, Option<Handle<Medium>>>,
    pub(super) objects: BTreeMap<String, Option<Handle<Group>>>,
    /// The object that is being described: its name and its shapes.
    pub(super) object: Option<OpenObject>,
    /// How many textures each consists of.
    pub(super) texture_sizes: Vec<u32>,
    /// How many materials each consists of.
    pub(super) material_sizes: Vec<u32>,
    pub(super) default_material: Option<Handle<Material>>,
    pub(super) masked: BTreeMap<(usize, usize), Handle<Material>>,
    pub(super) image_of: BTreeMap<ImageKey, Handle<Pixmap>>,
    pub(super) mesh_of: BTreeMap<PathBuf, Handle<Mesh>>,
}

/// An object between `ObjectBegin` and `ObjectEnd`.
pub(super) struct OpenObject {
    pub(super) name: String,
    pub(super) at: Location,
    pub(super) shapes: Vec<Shape>,
    pub(super) places: Vec<Location>,
    pub(super) failed: bool,
}

impl<'t> Reader<'t> {
    pub(super) fn new(log: &'t Log, files: &'t dyn Files, options: &Options, origins: Origins) -> Self {
        Self {
            log,
            files,
            lenient: options.lenient,
            folders: Vec::new(),
            open: Vec::new(),
            bytes_left: crate::open::MAX_BYTES,
            files_left: super::MAX_FILES,
            in_world: false,
            state: State::default(),
            saved: Vec::new(),
            coordinate_systems: BTreeMap::new(),
            told_of_hidden: false,
            camera: None,
            film: FilmSettings { width: 1280, height: 720, crop: None, filter: Filter::Box },
            filter: Filter::Gaussian { std_dev: 0.5 },
            exposure: 1.0,
            given: BTreeMap::new(),
            integrator: IntegratorRequest::default(),
            sample_count: None,
            textures: Textures::default(),
            materials: Arena::default(),
            meshes: Arena::default(),
            shapes: Vec::new(),
            groups: Arena::default(),
            instances: Vec::new(),
            shapes_of_groups: Vec::new(),
            lights: Vec::new(),
            media: Media::default(),
            origins,
            named_textures: BTreeMap::new(),
            named_materials: BTreeMap::new(),
            named_media: BTreeMap::new(),
            objects: BTreeMap::new(),
            object: None,
            texture_sizes: Vec::new(),
            material_sizes: Vec::new(),
            default_material: None,
            masked: BTreeMap::new(),
            image_of: BTreeMap::new(),
            mesh_of: BTreeMap::new(),
        }
    }

    /// Parameters without defaults of the graphics state.
    pub(super) fn plain(
        &self,
        noun: &'static str,
        kind: String,
        at: Location,
        list: Vec<Parameter>,
    ) -> Parameters<'t> {
        Parameters::new(noun, kind, at, list, &[], self.log)
    }

    pub(super) fn color_space(&self) -> ColorSpace {
        self.state.color_space
    }

    /// The bytes of a file that the scene names, and the path it was found at.
    pub(super) fn read_file(&self, name: &str, at: &Location) -> Option<(PathBuf, Vec<u8>)> {
        read_named(self.files, &self.folders, name, at, self.log)
    }

    /// Says that something that the format has is not built yet, so that it is left out: an error unless the
    /// caller is lenient.
    pub(super) fn left_out(&self, at: &Location, what: &str) {
        self.log.left_out(at, what, self.lenient);
    }

    /// Says that a type is not one of the format. `known` are lists of those that are, first those that can be
    /// rendered.
    pub(super) fn unknown_kind(&self, parameters: &Parameters, known: &[&[&'static str]]) {
        let text = format!("unknown {} \"{}\"", parameters.noun, shortened(&parameters.kind));
        let all = known.iter().flat_map(|list| list.iter().copied());
        let mut message = Diagnostic::error(&parameters.at, text).did_you_mean(&parameters.kind, all);
        if message.hint.is_none() {
            message = message.hint(format!("known are {}", known[0].join(", ")));
        }
        self.log.push(message);
    }
}
