//! `<shape type="shapegroup">` and `<shape type="instance">`.

use nephroid::handle::Handle;
use nephroid::math::Transform;
use nephroid::shape::{Group, Instance, Shape};

use super::document::Element;
use super::properties::Plugin;
use super::reader::{Outcome, Reader};
use crate::log::shortened;

/// Shapes that instances in a group may make of others.
const MAX_COPIES: usize = 100_000;

impl<'t> Reader<'t> {
    /// A shapegroup, read once however many instances it has. `None` if the log says why.
    pub(super) fn group(&mut self, element: &'t Element) -> Option<Handle<Group>> {
        match self.group_of.get(&element.number) {
            Some(Outcome::Done(handle)) => return Some(*handle),
            Some(Outcome::Open) => {
                self.log.error(&element.location, "the shapegroup shows itself");
                return None;
            }
            Some(Outcome::Failed) => return None,
            None => {}
        }
        self.group_of.insert(element.number, Outcome::Open);
        let handle = self.nested(&element.location, |reader| reader.new_group(element));
        self.group_of.insert(element.number, handle.map_or(Outcome::Failed, Outcome::Done));
        handle
    }

    fn new_group(&mut self, element: &'t Element) -> Option<Handle<Group>> {
        let plugin = self.plugin(element);
        let children = plugin.objects("shape");
        plugin.finish();
        if children.is_empty() {
            self.log.error(plugin.location(), "the shapegroup has no shape");
            return None;
        }
        let (mut shapes, mut places) = (Vec::new(), Vec::new());
        for (_, child) in children {
            let child = self.plugin(child);
            if child.kind == "shapegroup" {
                let message = "a shapegroup cannot hold another, but an instance of one";
                self.log.error(child.location(), message);
                continue;
            }
            if child.kind == "instance" {
                if let Some(more) = self.shapes_of_instance(&child, shapes.len()) {
                    places.resize(places.len() + more.len(), child.location().clone());
                    shapes.extend(more);
                }
                continue;
            }
            let Some(shape) = self.surface(&child) else { continue };
            if shape.emission.is_some() {
                let message = "a shape of a shapegroup cannot emit light; put the lamp beside the instances";
                self.log.error(child.location(), message);
            }
            shapes.push(shape);
            places.push(child.location().clone());
        }
        // What failed has its message, and is either an error, which ends the reading, or left out of the group.
        if shapes.is_empty() {
            if !self.log.has_errors() {
                let message = "nothing is left of the shapegroup: its instances show nothing";
                self.log.warn(plugin.location(), message);
            }
            return None;
        }
        self.shapes_of_groups.append(&mut places);
        self.origins.groups.push(plugin.location().clone());
        Some(self.groups.push(Group { name: plugin.name(), shapes }))
    }

    /// What an instance in a group shows, in the space of that group: instances are of the scene alone, so its shapes
    /// are copied. `before` counts those that the group has already.
    fn shapes_of_instance(&mut self, plugin: &Plugin<'t>, before: usize) -> Option<Vec<Shape>> {
        let (group, to_world) = self.shown(plugin)?;
        self.nested_groups.insert(group.index());
        let group = &self.groups[group];
        let count = before + group.shapes.len();
        if count > MAX_COPIES {
            let message = format!("instances in groups make more than {MAX_COPIES} shapes of one");
            self.log.error(plugin.location(), message);
            return None;
        }
        let placed = |shape: &Shape| Shape { to_world: shape.to_world.then(to_world), ..shape.clone() };
        Some(group.shapes.iter().map(placed).collect())
    }

    /// The group that an instance shows, and where.
    fn shown(&mut self, plugin: &Plugin<'t>) -> Option<(Handle<Group>, Transform)> {
        let to_world = plugin.transform("to_world");
        plugin.ignore(&["silhouette_sampling_weight"]);
        let shown = plugin.only_object("shape");
        plugin.finish();
        let Some(shown) = shown else {
            self.log.error(plugin.location(), "the instance lacks a shapegroup; write <ref id=\"…\"/>");
            return None;
        };
        let kind = shown.value_of("type").unwrap_or_default();
        if kind != "shapegroup" {
            let message = format!("an instance shows a shapegroup, not \"{}\"", shortened(kind));
            self.log.error(plugin.location(), message);
            return None;
        }
        Some((self.group(shown)?, to_world))
    }

    /// Reads an instance into the scene; what is wrong goes to the log.
    pub(super) fn instance(&mut self, element: &'t Element) {
        let plugin = self.plugin(element);
        let Some((group, to_world)) = self.shown(&plugin) else { return };
        self.origins.instances.push(plugin.location().clone());
        self.instances.push(Instance { name: plugin.name(), group, to_world });
    }

    /// Says which groups are not to be seen.
    pub(super) fn warn_of_unused_groups(&self) {
        for ((handle, group), at) in self.groups.iter_handles().zip(&self.origins.groups) {
            let is_shown = self.instances.iter().any(|instance| instance.group == handle);
            if !is_shown && !self.nested_groups.contains(&handle.index()) {
                let name = shortened(&group.name);
                self.log.warn(at, format!("no instance shows the shapegroup \"{name}\""));
            }
        }
    }
}
