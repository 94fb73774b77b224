//! `AreaLightSource`: shapes that shine.

use std::cell::Cell;
use std::f64::consts::PI;
use std::rc::Rc;

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::math::{Affine2, Vec2};
use nephroid::texture::{Bitmap, BitmapFilter, Pixmap, Texture, Wrap};

use super::image::{Change, is_encoded};
use super::light::luminance;
use super::parameters::Parameters;
use super::reader::Reader;
use crate::diagnostic::Location;

/// What the shapes that follow shine with.
#[derive(Debug)]
pub(super) struct AreaLight {
    at: Location,
    look: Look,
    /// Power of the whole shape in lumens per 683, if that is given.
    power: Option<f64>,
    /// That of a shape of area 1/π.
    of_one: f64,
    /// The texture that was made of it.
    texture: Cell<Option<Handle<Texture>>>,
}

#[derive(Debug)]
enum Look {
    Even(Rgb),
    Image(Handle<Pixmap>, f32),
}

impl Reader<'_> {
    pub(super) fn set_area_light(&mut self, parameters: &Parameters) {
        self.state.area_light = None;
        if parameters.kind != "diffuse" {
            if parameters.kind == "area" {
                self.log.warn(&parameters.at, "\"area\" is of older files: \"diffuse\"");
            } else {
                self.unknown_kind(parameters, &[&["diffuse"]]);
                return;
            }
        }
        if parameters.boolean("twosided", false) {
            let message = "\"twosided\" cannot be had yet: it shines on the side of the normal";
            self.log.warn(&parameters.at, message);
        }
        let power = parameters.optional_float("power").filter(|power| *power > 0.0);
        let look = if parameters.has("filename") {
            if let Some(radiance) = parameters.any("L") {
                self.log.error(&radiance.location, "give either \"L\" or \"filename\"");
            }
            let raw = parameters.text("filename").is_none_or(|(name, _)| !is_encoded(name));
            let scale = parameters.not_negative("scale", 1.0) as f32 * self.exposure;
            self.named_image(parameters, Change::decoded(raw)).map(|image| Look::Image(image, scale))
        } else {
            Some(Look::Even(self.strength(parameters, "L", "power", 0.0)))
        };
        parameters.ignore(&["samples", "nsamples"]);
        parameters.finish();
        let Some(look) = look else { return };
        let of_one = match &look {
            Look::Even(_) => 1.0,
            Look::Image(image, _) => f64::from(luminance(self.textures.images[*image].mean())),
        };
        let (at, texture) = (parameters.at.clone(), Cell::new(None));
        self.state.area_light = Some(Rc::new(AreaLight { at, look, power, of_one, texture }));
    }

    /// The radiance of a shape of an area.
    pub(super) fn radiance(&mut self, light: &AreaLight, area: impl FnOnce(&Self) -> f64) -> Handle<Texture> {
        if let Some(texture) = light.texture.get() {
            return texture;
        }
        let factor = match light.power {
            Some(power) => power / (light.of_one * PI * area(self)),
            None => 1.0,
        };
        let factor = if factor.is_finite() { factor as f32 } else { 1.0 };
        let texture = match &light.look {
            Look::Even(radiance) => Texture::Constant(*radiance * factor),
            Look::Image(image, scale) => {
                let mut copy = *image;
                if *scale * factor != 1.0 {
                    let change = Change { scale: *scale * factor, ..Change::decoded(true) };
                    let image = change.applied(&self.textures.images[*image]);
                    copy = self.store_image(image, &light.at);
                }
                // The first row is at v = 1.
                let mut to_uv = Affine2::from_scale(Vec2::new(1.0, -1.0));
                to_uv.translation = Vec2::Y;
                Texture::Bitmap(Bitmap {
                    image: copy,
                    filter: BitmapFilter::Bilinear,
                    wrap: Wrap::Clamp,
                    to_uv,
                })
            }
        };
        let texture = self.store_texture(&light.at, texture);
        if light.power.is_none() {
            light.texture.set(Some(texture));
        }
        texture
    }
}
