//! How surfaces scatter.

use nephroid::handle::Handle;
use nephroid::material::Material;
use nephroid::medium::Medium;

use super::item::Item;
use super::reader::Reader;

/// A material before normal maps, masks and the like.
pub(super) struct Surface {
    pub(super) handle: Handle<Material>,
    /// Whether light goes through.
    pub(super) transmits: bool,
    pub(super) medium: Option<Handle<Medium>>,
}

impl<'d> Reader<'d> {
    /// How a material scatters.
    pub(super) fn surface(&mut self, material: Item<'d>, with_colors: bool) -> Surface {
        let reflectance = self.base_color(material, with_colors);
        let handle = self.store_material(material, Material::Diffuse { reflectance });
        Surface { handle, transmits: false, medium: None }
    }
}
