//! Which media lie around shapes, lights and the sensor.

use nephroid::handle::Handle;
use nephroid::medium::{Boundary, Medium};

use super::properties::Plugin;
use super::reader::Reader;
use super::value::Value;
use crate::diagnostic::Diagnostic;

impl<'t> Reader<'t> {
    /// The media on both sides of a shape, and which of overlapping shapes it gives way to.
    pub(super) fn boundary(&mut self, shape: &Plugin<'t>) -> Boundary {
        let [interior, exterior] = ["interior", "exterior"].map(|name| self.named_medium(shape, name));
        for (property, _) in shape.objects("medium") {
            if !matches!(property.name, "interior" | "exterior") {
                let message = match property.name {
                    "" => "the shape's medium has no name".to_owned(),
                    name => format!("a shape has no medium \"{name}\""),
                };
                let message = Diagnostic::error(&property.location, message);
                self.log.push(message.hint("name=\"interior\" is behind its surface, \"exterior\" in front"));
            }
        }
        let priority = shape.integer_within("priority", 0, 0..=u32::MAX);
        let priority = shape.has("priority").then_some(priority);
        Boundary { interior, exterior, light: None, priority }
    }

    fn named_medium(&mut self, shape: &Plugin<'t>, name: &'static str) -> Option<Handle<Medium>> {
        let property = shape.property(name)?;
        match property.value {
            Value::Object(element) if element.tag == "medium" => self.medium(element),
            _ => {
                shape.wrong_type(property, "a medium");
                None
            }
        }
    }

    /// The medium around a light or a sensor.
    pub(super) fn surroundings(&mut self, plugin: &Plugin<'t>) -> Option<Handle<Medium>> {
        for (property, _) in plugin.objects("medium") {
            if !matches!(property.name, "" | "medium") {
                let tag = &plugin.element.tag;
                let message = format!("{} {tag} has no medium \"{}\"", article(tag), property.name);
                let message = Diagnostic::error(&property.location, message);
                self.log.push(message.hint("the medium around it has no name, or name=\"medium\""));
                return None;
            }
        }
        plugin.only_object("medium").and_then(|element| self.medium(element))
    }
}

fn article(noun: &str) -> &'static str {
    if noun.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" }
}
