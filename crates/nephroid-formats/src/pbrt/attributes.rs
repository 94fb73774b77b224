//! The graphics state: what is saved and brought back, and what is said of all that follows.

use std::rc::Rc;

use super::color_space::COLOR_SPACES;
use super::parameter::Parameter;
use super::reader::Reader;
use super::state::{Saved, Scope};
use crate::diagnostic::{Diagnostic, Location};
use crate::log::shortened;
use nephroid::math::Transform;

/// What `Attribute` can speak of.
const TARGETS: [&str; 5] = ["shape", "light", "material", "medium", "texture"];

/// States that are saved at a time.
const MAX_SAVED: usize = 10_000;

impl Reader<'_> {
    pub(super) fn world_begin(&mut self, at: &Location) {
        if self.in_world {
            self.log.error(at, "the world has begun already");
            return;
        }
        self.in_world = true;
        self.state.ctm = Transform::IDENTITY;
        self.coordinate_systems.insert("world".into(), (Transform::IDENTITY, false));
        if self.camera.is_none() && !self.given.contains_key("Camera") {
            let message = Diagnostic::error(at, "the scene has no Camera");
            self.log.push(message.hint("write Camera \"perspective\" before WorldBegin"));
        }
    }

    /// Whether the world has begun; else a message.
    pub(super) fn must_be_in_world(&self, directive: &str, at: &Location) -> bool {
        if !self.in_world {
            self.log.error(at, format!("{directive} belongs behind WorldBegin"));
        }
        self.in_world
    }

    pub(super) fn begin(&mut self, scope: Scope, at: &Location) {
        if self.saved.len() >= MAX_SAVED {
            self.log.error(at, format!("attributes are nested more than {MAX_SAVED} deep"));
            return;
        }
        self.saved.push(Saved { scope, at: at.clone(), state: self.state.clone() });
    }

    /// Brings back the state that was saved last, if it was saved for this.
    pub(super) fn end(&mut self, scope: Scope, at: &Location) -> bool {
        match self.saved.last() {
            Some(saved) if saved.scope == scope => {
                if let Some(saved) = self.saved.pop() {
                    self.state = saved.state;
                }
                true
            }
            Some(saved) => {
                let message = format!("{} where {} is open", scope.end(), saved.scope.begin());
                self.log.push(Diagnostic::error(at, message).hint(format!("it begins at {}", saved.at)));
                false
            }
            None => {
                self.log.error(at, format!("{} without {}", scope.end(), scope.begin()));
                false
            }
        }
    }

    /// Ends what nobody else does.
    pub(super) fn never_ended(&mut self) {
        if let Some(saved) = self.saved.pop() {
            let message = format!("{} without {}", saved.scope.begin(), saved.scope.end());
            self.log.error(&saved.at, message);
            self.state = saved.state;
        }
    }

    /// The end of the scene.
    pub(super) fn close(&mut self, start: &Location) {
        while !self.saved.is_empty() {
            self.never_ended();
        }
        if !self.in_world {
            let message = Diagnostic::error(start, "the scene has no WorldBegin");
            self.log.push(message.hint("it stands between the camera and the shapes"));
        }
        self.warn_of_unused_objects();
    }

    /// `Attribute`: parameters for all that follows.
    pub(super) fn attribute(&mut self, target: &str, at: &Location, list: Vec<Parameter>) {
        let defaults = &mut self.state.defaults;
        let defaults = match target {
            "shape" => &mut defaults.shape,
            "light" => &mut defaults.light,
            "material" => &mut defaults.material,
            "medium" => &mut defaults.medium,
            "texture" => &mut defaults.texture,
            _ => {
                let message = format!("nothing has attributes of a \"{}\"", shortened(target));
                let message = Diagnostic::error(at, message).did_you_mean(target, TARGETS);
                self.log.push(message);
                return;
            }
        };
        for parameter in list {
            defaults.retain(|p| p.name != parameter.name);
            defaults.push(Rc::new(Parameter { is_default: true, ..parameter }));
        }
    }

    pub(super) fn set_color_space(&mut self, name: &str, at: &Location) {
        match COLOR_SPACES.iter().find(|(known, _)| *known == name) {
            Some((_, space)) => self.state.color_space = *space,
            None => {
                let message = format!("unknown colour space \"{}\"", shortened(name));
                let known = COLOR_SPACES.iter().map(|(name, _)| *name);
                self.log.push(Diagnostic::error(at, message).did_you_mean(name, known));
            }
        }
    }
}
