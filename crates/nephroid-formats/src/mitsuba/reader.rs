//! The state while a document becomes a scene, and what all its parts need.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use nephroid::handle::{Arena, Handle};
use nephroid::light::Light;
use nephroid::material::Material;
use nephroid::medium::{Media, Medium};
use nephroid::shape::{Group, Instance, Mesh, Shape};
use nephroid::texture::{Pixmap, Texture, Textures};

use super::document::Element;
use super::names::{OBJECT_TAGS, PROPERTY_TAGS};
use super::properties::Plugin;
use super::value::Ids;
use super::volume::StoredGrid;
use crate::diagnostic::{Diagnostic, Location};
use crate::log::{Log, shortened};
use crate::open::read_named;
use crate::scene_file::Origins;
use crate::vfs::Files;

/// Materials in materials, or textures in textures, through references too.
const MAX_NESTING: usize = 50;

/// What became of an element that may be referred to more than once.
#[derive(Clone, Copy)]
pub(super) enum Outcome<T> {
    /// It is being read: meeting it again means that it contains itself.
    Open,
    /// It was read before.
    Done(Handle<T>),
    /// It was tried before, and the log says what is wrong.
    Failed,
}

/// How a mesh file was read: its path, `face_normals`, `flip_tex_coords` and which of its meshes.
pub(super) type MeshKey = (PathBuf, bool, bool, u32);

/// A scene in the making.
pub(super) struct Reader<'t> {
    pub(super) ids: &'t Ids<'t>,
    pub(super) log: &'t Log,
    pub(super) files: &'t dyn Files,
    pub(super) folders: &'t [PathBuf],
    pub(super) lenient: bool,
    pub(super) textures: Textures,
    pub(super) materials: Arena<Material>,
    pub(super) meshes: Arena<Mesh>,
    pub(super) shapes: Vec<Shape>,
    pub(super) groups: Arena<Group>,
    pub(super) instances: Vec<Instance>,
    /// Where the shapes of groups stand; they count after those of the scene.
    pub(super) shapes_of_groups: Vec<Location>,
    pub(super) lights: Vec<Light>,
    pub(super) media: Media,
    pub(super) origins: Origins,
    pub(super) texture_of: BTreeMap<usize, Outcome<Texture>>,
    pub(super) material_of: BTreeMap<usize, Outcome<Material>>,
    pub(super) group_of: BTreeMap<usize, Outcome<Group>>,
    /// Groups that others show, by number.
    pub(super) nested_groups: BTreeSet<usize>,
    pub(super) medium_of: BTreeMap<usize, Outcome<Medium>>,
    pub(super) image_of: BTreeMap<(PathBuf, bool), Handle<Pixmap>>,
    pub(super) mesh_of: BTreeMap<MeshKey, Handle<Mesh>>,
    pub(super) grid_of: BTreeMap<PathBuf, StoredGrid>,
    /// The material of shapes without one, and of lamps without one.
    pub(super) default_materials: [Option<Handle<Material>>; 2],
    /// The ids of emitters that shapes refer to.
    pub(super) lamps_shown: BTreeSet<&'t str>,
    nesting: usize,
}

impl<'t> Reader<'t> {
    pub(super) fn new(
        ids: &'t Ids<'t>,
        log: &'t Log,
        files: &'t dyn Files,
        folders: &'t [PathBuf],
        lenient: bool,
        origins: Origins,
    ) -> Self {
        Self {
            ids,
            log,
            files,
            folders,
            lenient,
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
            texture_of: BTreeMap::new(),
            material_of: BTreeMap::new(),
            group_of: BTreeMap::new(),
            nested_groups: BTreeSet::new(),
            medium_of: BTreeMap::new(),
            image_of: BTreeMap::new(),
            mesh_of: BTreeMap::new(),
            grid_of: BTreeMap::new(),
            default_materials: [None; 2],
            lamps_shown: BTreeSet::new(),
            nesting: 0,
        }
    }

    pub(super) fn plugin(&self, element: &'t Element) -> Plugin<'t> {
        Plugin::new(element, self.ids, self.lenient, self.log)
    }

    /// The bytes of a file that the scene names, and the path it was found at.
    pub(super) fn read_file(&self, name: &str, at: &Location) -> Option<(PathBuf, Vec<u8>)> {
        read_named(self.files, self.folders, name, at, self.log)
    }

    /// Says that something that the format has is not built yet, so that it is left out: an error
    /// unless the caller is lenient.
    pub(super) fn left_out(&self, at: &Location, what: &str) {
        self.log.left_out(at, what, self.lenient);
    }

    /// Says that a plugin's type is not one of the format.
    ///
    /// `known` are lists of those that are, first those that can be rendered.
    pub(super) fn unknown_kind(&self, plugin: &Plugin, known: &[&[&'static str]]) {
        if plugin.element.attribute("type").is_none() {
            return;
        }
        let text = format!("unknown {} \"{}\"", plugin.element.tag, shortened(plugin.kind));
        let all = known.iter().flat_map(|list| list.iter().copied());
        let mut message = Diagnostic::error(plugin.location(), text).did_you_mean(plugin.kind, all);
        if message.hint.is_none() {
            message = message.hint(format!("known are {}", known[0].join(", ")));
        }
        self.log.push(message);
    }

    /// Does `work` one level deeper, unless that is too deep.
    pub(super) fn nested<T>(
        &mut self,
        at: &Location,
        work: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        if self.nesting >= MAX_NESTING {
            self.log.error(at, format!("references are nested more than {MAX_NESTING} deep"));
            return None;
        }
        self.nesting += 1;
        let out = work(self);
        self.nesting -= 1;
        out
    }

    /// Reads every element of the scene but sensors and integrators.
    pub(super) fn content(&mut self, elements: &'t [Element]) {
        for element in elements {
            match element.tag.as_str() {
                "sensor" | "integrator" => {}
                "shape" => self.shape(element),
                "bsdf" => {
                    self.material(element);
                }
                "emitter" => self.emitter(element),
                "texture" => {
                    self.texture(element);
                }
                "medium" => {
                    self.medium(element);
                }
                // A property at this level belongs to nothing; a plugin waits for references to it.
                tag if PROPERTY_TAGS.contains(&tag) => {
                    self.log.error(&element.location, format!("<{tag}> has no place in <scene>"));
                }
                tag if OBJECT_TAGS.contains(&tag) => {}
                tag => {
                    let message = format!("unknown element <{}>", shortened(tag));
                    let known = OBJECT_TAGS.iter().chain(&["include", "default", "path", "alias"]).copied();
                    self.log.push(Diagnostic::error(&element.location, message).did_you_mean(tag, known));
                }
            }
        }
    }
}
