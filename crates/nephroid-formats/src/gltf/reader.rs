//! The state while a document becomes a scene, and what all its parts need.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use nephroid::handle::{Arena, Handle};
use nephroid::light::Light;
use nephroid::material::Material;
use nephroid::medium::Media;
use nephroid::shape::{Group, Instance, Mesh, Shape};
use nephroid::texture::{Pixmap, Texture, Textures};

use super::buffers::Buffers;
use super::image::Purpose;
use super::item::Item;
use super::material::Look;
use super::primitive::Ingredients;
use crate::diagnostic::Location;
use crate::scene_file::Origins;
use crate::vfs::Files;

/// A scene in the making.
pub(super) struct Reader<'d> {
    pub(super) root: Item<'d>,
    pub(super) buffers: Buffers<'d>,
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
    pub(super) triangle_count: usize,
    pub(super) mesh_of: BTreeMap<Ingredients, Option<Handle<Mesh>>>,
    pub(super) image_of: BTreeMap<(usize, Purpose), Option<Handle<Pixmap>>>,
    pub(super) constant_of: BTreeMap<[u32; 3], Handle<Texture>>,
    pub(super) look_of: BTreeMap<(Option<usize>, bool), Look>,
    /// What was said once, for all places where it is true.
    told: BTreeSet<String>,
}

impl<'d> Reader<'d> {
    pub(super) fn new(
        root: Item<'d>,
        files: &'d dyn Files,
        path: &Path,
        binary: Option<Vec<u8>>,
        lenient: bool,
    ) -> Self {
        Self {
            root,
            buffers: Buffers::new(files, path, binary),
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
            origins: Origins::at(root.at()),
            triangle_count: 0,
            mesh_of: BTreeMap::new(),
            image_of: BTreeMap::new(),
            constant_of: BTreeMap::new(),
            look_of: BTreeMap::new(),
            told: BTreeSet::new(),
        }
    }

    /// A warning that is given at the first place only.
    pub(super) fn once(&mut self, item: Item<'d>, message: &str) {
        if self.told.insert(message.to_owned()) {
            item.warn(message);
        }
    }

    /// Stores a texture that `at` asks for.
    pub(super) fn store_texture(&mut self, at: Item<'d>, texture: Texture) -> Handle<Texture> {
        self.origins.textures.push(at.at());
        self.textures.push(texture)
    }

    /// Stores a material that `at` asks for.
    pub(super) fn store_material(&mut self, at: Item<'d>, material: Material) -> Handle<Material> {
        self.origins.materials.push(at.at());
        self.materials.push(material)
    }
}
