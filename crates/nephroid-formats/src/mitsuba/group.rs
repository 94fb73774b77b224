//! `<shape type="shapegroup">` and `<shape type="instance">`.

use nephroid::handle::Handle;
use nephroid::shape::{Group, Instance};

use super::document::Element;
use super::reader::{Outcome, Reader};
use crate::log::shortened;

impl<'t> Reader<'t> {
    /// A shapegroup, read once however many instances it has. `None` if the log says why.
    pub(super) fn group(&mut self, element: &'t Element) -> Option<Handle<Group>> {
        match self.group_of.get(&element.number) {
            Some(Outcome::Done(handle)) => return Some(*handle),
            Some(Outcome::Open | Outcome::Failed) => return None,
            None => {}
        }
        let handle = self.new_group(element);
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
        let mut failed = false;
        for (_, child) in children {
            let child = self.plugin(child);
            if matches!(child.kind, "shapegroup" | "instance") {
                let message =
                    format!("a shapegroup cannot hold another, nor an instance: \"{}\"", child.kind);
                self.log.error(child.location(), message);
                failed = true;
                continue;
            }
            let Some(shape) = self.surface(&child) else {
                failed = true;
                continue;
            };
            if shape.emission.is_some() {
                let message = "a shape of a shapegroup cannot emit light; put the lamp beside the instances";
                self.log.error(child.location(), message);
                failed = true;
            }
            shapes.push(shape);
            places.push(child.location().clone());
        }
        // With --lenient a shape can be left out, and then the group is what is left.
        if shapes.is_empty() || (failed && !self.lenient) {
            return None;
        }
        self.shapes_of_groups.append(&mut places);
        self.origins.groups.push(plugin.location().clone());
        Some(self.groups.push(Group { name: plugin.name(), shapes }))
    }

    /// Reads an instance into the scene; what is wrong goes to the log.
    pub(super) fn instance(&mut self, element: &'t Element) {
        let plugin = self.plugin(element);
        let to_world = plugin.transform("to_world");
        plugin.ignore(&["silhouette_sampling_weight"]);
        let shown = plugin.only_object("shape");
        plugin.finish();
        let Some(shown) = shown else {
            self.log.error(plugin.location(), "the instance lacks a shapegroup; write <ref id=\"…\"/>");
            return;
        };
        let kind = shown.value_of("type").unwrap_or_default();
        if kind != "shapegroup" {
            let message = format!("an instance shows a shapegroup, not \"{}\"", shortened(kind));
            self.log.error(plugin.location(), message);
            return;
        }
        let Some(group) = self.group(shown) else { return };
        self.origins.instances.push(plugin.location().clone());
        self.instances.push(Instance { name: plugin.name(), group, to_world });
    }

    /// Says which groups are not to be seen.
    pub(super) fn warn_of_unused_groups(&self) {
        for ((handle, group), at) in self.groups.iter_handles().zip(&self.origins.groups) {
            if !self.instances.iter().any(|instance| instance.group == handle) {
                let name = shortened(&group.name);
                self.log.warn(at, format!("no instance shows the shapegroup \"{name}\""));
            }
        }
    }
}
