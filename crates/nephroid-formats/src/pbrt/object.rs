//! `ObjectBegin`, `ObjectEnd` and `ObjectInstance`.

use nephroid::shape::{Group, Instance};

use super::reader::{OpenObject, Reader};
use super::state::Scope;
use crate::diagnostic::{Diagnostic, Location};
use crate::log::shortened;

impl Reader<'_> {
    pub(super) fn object_begin(&mut self, name: String, at: &Location) {
        self.begin(Scope::Object, at);
        if let Some(open) = &self.object {
            let message = Diagnostic::error(at, "an object in an object");
            self.log.push(message.hint(format!("the outer one begins at {}", open.at)));
            return;
        }
        if self.objects.contains_key(&name) {
            self.log.error(at, format!("the object \"{}\" is there already", shortened(&name)));
        }
        let (shapes, places) = (Vec::new(), Vec::new());
        self.object = Some(OpenObject { name, at: at.clone(), shapes, places, failed: false });
    }

    pub(super) fn object_end(&mut self, at: &Location) {
        if !self.end(Scope::Object, at) || self.saved.iter().any(|saved| saved.scope == Scope::Object) {
            return;
        }
        let Some(mut object) = self.object.take() else { return };
        if object.shapes.is_empty() {
            // What is wrong with its shapes has been told.
            if !object.failed {
                let message = format!("the object \"{}\" has no shape", shortened(&object.name));
                self.log.warn(&object.at, message);
            }
            self.objects.insert(object.name, None);
            return;
        }
        self.shapes_of_groups.append(&mut object.places);
        self.origins.groups.push(object.at);
        let group = self.groups.push(Group { name: object.name.clone(), shapes: object.shapes });
        self.objects.insert(object.name, Some(group));
    }

    pub(super) fn object_instance(&mut self, name: &str, at: &Location) {
        if let Some(open) = &self.object {
            let message = Diagnostic::error(at, "an object cannot show another");
            self.log.push(message.hint(format!("the outer one begins at {}", open.at)));
            return;
        }
        let Some(known) = self.objects.get(name) else {
            let message = format!("no object is called \"{}\"", shortened(name));
            let known = self.objects.keys().map(String::as_str);
            let mut message = Diagnostic::error(at, message).did_you_mean(name, known);
            if message.hint.is_none() {
                message = message.hint("ObjectBegin must stand before its use");
            }
            self.log.push(message);
            return;
        };
        let Some(group) = known.filter(|_| !self.state.is_hidden) else { return };
        let to_world = self.state.ctm;
        if !to_world.is_invertible() {
            self.log.error(at, "the place of the object flattens space or overflows");
            return;
        }
        self.origins.instances.push(at.clone());
        let name = format!("{} at line {}", shortened(name), at.line());
        self.instances.push(Instance { name, group, to_world });
    }

    /// Says which objects are not to be seen.
    pub(super) fn warn_of_unused_objects(&self) {
        for ((handle, group), at) in self.groups.iter_handles().zip(&self.origins.groups) {
            if !self.instances.iter().any(|instance| instance.group == handle) {
                self.log.warn(at, format!("nothing shows the object \"{}\"", shortened(&group.name)));
            }
        }
    }
}
