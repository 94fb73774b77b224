//! `KHR_lights_punctual`.

use std::f64::consts::FRAC_PI_2;

use nephroid::color::Rgb;
use nephroid::light::{Light, LightKind};
use nephroid::math::Vec3;

use super::item::Item;
use super::node::{Placed, looking};
use super::reader::Reader;

/// Lumens to the watt at 555 nm (the definition of the candela): what 1 lm is divided by to be radiant power. Blender
/// writes and reads lights so, too.
const LUMENS_PER_WATT: f64 = 683.0;

impl<'d> Reader<'d> {
    /// The lights that nodes hold.
    pub(super) fn lights(&mut self, nodes: &[Placed<'d>]) {
        let known: Vec<Item<'d>> = self
            .root
            .extension("KHR_lights_punctual")
            .map(|extension| extension.list("lights"))
            .unwrap_or_default();
        let mut brightest = 0.0f64;
        for placed in nodes {
            let Some(extension) = placed.node.extension("KHR_lights_punctual") else { continue };
            let Some(index) = extension.whole("light") else {
                extension.error("the node names no \"light\"");
                continue;
            };
            let Some(light) = known.get(index) else {
                extension.error(format!("\"light\" is {index}, and there are {}", known.len()));
                continue;
            };
            if let Some(kind) = kind(*light, placed) {
                brightest = brightest.max(light.number("intensity").unwrap_or(1.0));
                self.origins.lights.push(light.at());
                let name = light.called("light", index);
                self.lights.push(Light { name, kind, medium: None });
            }
        }
        // Many models are made for viewers that show a candela per square metre as white.
        if !self.lights.is_empty() && brightest < LUMENS_PER_WATT {
            let message = format!(
                "the lights are weak, for candela and lux are divided by {LUMENS_PER_WATT} lumens to the watt: \
                 --exposure 9.4 shows them as viewers do"
            );
            self.once(self.root, &message);
        }
    }
}

/// `None` if the log says why. `range` is where others may stop to compute a light, and means nothing here.
fn kind(light: Item, placed: &Placed) -> Option<LightKind> {
    let color = light.vector::<3>("color").unwrap_or([1.0; 3]);
    let intensity = light.number("intensity").unwrap_or(1.0);
    if intensity < 0.0 || color.iter().any(|channel| *channel < 0.0) {
        light.error("the light's \"intensity\" or \"color\" is negative");
        return None;
    }
    let scaled = Rgb::from(color.map(|channel| (channel * intensity / LUMENS_PER_WATT) as f32));
    let position = placed.to_world.translation.as_vec3();
    let Some(to_world) = looking(&placed.to_world) else {
        if light.text("type") == Some("point") {
            return Some(LightKind::Point { position, intensity: scaled });
        }
        placed.node.error("the light shines nowhere: a node has a scale of zero");
        return None;
    };
    match light.text("type") {
        Some("point") => Some(LightKind::Point { position, intensity: scaled }),
        Some("directional") => {
            Some(LightKind::Directional { direction: to_world.vector(Vec3::Z), irradiance: scaled })
        }
        Some("spot") => {
            let cone = light.object("spot");
            let angle = |name: &str, default: f64| {
                cone.map_or(default, |cone| cone.number_within(name, default, 0.0, FRAC_PI_2))
            };
            let outer = angle("outerConeAngle", std::f64::consts::FRAC_PI_4);
            let inner = angle("innerConeAngle", 0.0);
            if inner >= outer {
                light.error("the inner cone of a spot must be within the outer one");
                return None;
            }
            Some(LightKind::Spot {
                to_world,
                intensity: scaled,
                // A cone of a right angle is half of space, of which ours keep short.
                cutoff_deg: outer.to_degrees().min(89.9) as f32,
                beam_width_deg: inner.to_degrees().min(89.9) as f32,
                texture: None,
            })
        }
        _ => {
            light.error("the \"type\" of a light is \"point\", \"spot\" or \"directional\"");
            None
        }
    }
}
