//! Meshes at the places where nodes show them.

use std::collections::BTreeMap;

use nephroid::math::{DAffine3, Transform};
use nephroid::medium::Boundary;
use nephroid::shape::{Geometry, Group, Instance, Shape};

use super::item::Item;
use super::node::Placed;
use super::reader::Reader;

/// Triangles that a group must save before it is worth the detour of rays through it.
const WORTH_A_GROUP: usize = 4096;

/// A mesh that a node shows at a place.
struct Use<'d> {
    node: Item<'d>,
    name: String,
    to_world: Transform,
}

impl<'d> Reader<'d> {
    /// All that nodes show: as shapes of the scene, or in groups where that saves memory.
    pub(super) fn shown(&mut self, nodes: &[Placed<'d>]) {
        let mut uses: BTreeMap<usize, Vec<Use<'d>>> = BTreeMap::new();
        for placed in nodes {
            let Some((mesh, _)) = placed.node.refers("mesh", "meshes") else { continue };
            if placed.node.has("skin") {
                self.once(placed.node, "skins are not read: what they move is shown where its nodes put it");
            }
            uses.entry(mesh).or_default().extend(self.uses(placed));
        }
        for (index, uses) in uses {
            if let Some(mesh) = self.root.nth("meshes", index).filter(|_| !uses.is_empty()) {
                self.show(mesh, index, &uses);
            }
        }
    }

    /// The places at which a node shows its mesh.
    fn uses(&mut self, placed: &Placed<'d>) -> Vec<Use<'d>> {
        let node = placed.node;
        let copies = match node.extension("EXT_mesh_gpu_instancing") {
            Some(extension) => self.buffers.copies(extension).unwrap_or_default(),
            None => vec![DAffine3::IDENTITY],
        };
        let all = copies.len();
        let uses: Vec<Use<'d>> = copies
            .into_iter()
            .map(|copy| Transform(placed.to_world * copy))
            .filter(Transform::is_invertible)
            .map(|to_world| Use { node, name: node.called("node", placed.index), to_world })
            .collect();
        if uses.len() < all {
            node.warn("a scale of zero, of the node or of those that it hangs on, hides it");
        }
        uses
    }

    /// Puts one mesh at its places.
    fn show(&mut self, mesh: Item<'d>, index: usize, uses: &[Use<'d>]) {
        if mesh.has("weights") {
            self.once(mesh, "morph targets are not read: meshes are shown without them");
        }
        let parts = self.parts(mesh, index);
        let (lamps, others): (Vec<_>, Vec<_>) =
            parts.into_iter().partition(|(_, shape)| shape.emission.is_some());
        let triangles: usize = others.iter().map(|(_, shape)| self.triangles_of(shape)).sum();
        if (uses.len() - 1).saturating_mul(triangles) < WORTH_A_GROUP {
            self.copy(uses, &lamps);
            self.copy(uses, &others);
            return;
        }
        // What gives light cannot be in a group.
        self.copy(uses, &lamps);
        let (places, shapes): (Vec<Item<'d>>, Vec<Shape>) = others.into_iter().unzip();
        self.shapes_of_groups.extend(places.iter().map(Item::at));
        self.origins.groups.push(mesh.at());
        let group = self.groups.push(Group { name: mesh.called("mesh", index), shapes });
        for one in uses {
            self.origins.instances.push(one.node.at());
            self.instances.push(Instance { name: one.name.clone(), group, to_world: one.to_world });
        }
    }

    fn triangles_of(&self, shape: &Shape) -> usize {
        match shape.geometry {
            Geometry::Mesh(mesh) => self.meshes[mesh].triangles.len(),
            _ => 0,
        }
    }

    fn copy(&mut self, uses: &[Use<'d>], parts: &[(Item<'d>, Shape)]) {
        for one in uses {
            for (_, shape) in parts {
                self.origins.shapes.push(one.node.at());
                self.shapes.push(Shape { name: one.name.clone(), to_world: one.to_world, ..shape.clone() });
            }
        }
    }

    /// The primitives of a mesh in its own space.
    fn parts(&mut self, mesh: Item<'d>, index: usize) -> Vec<(Item<'d>, Shape)> {
        let primitives = mesh.list("primitives");
        if primitives.is_empty() {
            mesh.error("the mesh has no \"primitives\"");
        }
        primitives.into_iter().filter_map(|part| Some((part, self.shape(mesh, index, part)?))).collect()
    }

    fn shape(&mut self, mesh: Item<'d>, index: usize, part: Item<'d>) -> Option<Shape> {
        if !part.list("targets").is_empty() {
            self.once(mesh, "morph targets are not read: meshes are shown without them");
        }
        if !part.has("attributes") {
            part.error("the primitive has no \"attributes\"");
            return None;
        }
        let material = match part.has("material") {
            true => Some(self.material_of(part)?),
            false => None,
        };
        let with_colors = part.object("attributes").is_some_and(|attributes| attributes.has("COLOR_0"));
        let look = self.look(part, material, with_colors)?;
        let geometry = self.mesh(part, look.uv_set, with_colors)?;
        Some(Shape {
            emission: look.emission,
            boundary: Boundary { interior: look.inside, ..Boundary::default() },
            ..Shape::new(mesh.called("mesh", index), Geometry::Mesh(geometry), look.material)
        })
    }

    /// The material of a primitive: of its variants the first is shown.
    fn material_of(&mut self, part: Item<'d>) -> Option<(usize, Item<'d>)> {
        if part.extension("KHR_materials_variants").is_some() {
            let names: Vec<&str> = self
                .root
                .extension("KHR_materials_variants")
                .map(|extension| extension.list("variants"))
                .unwrap_or_default()
                .iter()
                .filter_map(|variant| variant.get("name")?.as_text())
                .collect();
            let message = format!(
                "of the variants {} the material that parts have without one is shown",
                names.join(", ")
            );
            self.once(part, &message);
        }
        part.refers("material", "materials")
    }
}
