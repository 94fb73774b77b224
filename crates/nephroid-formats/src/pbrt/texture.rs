//! `Texture`, and parameters that may be textures.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::math::{Affine2, Vec2};
use nephroid::texture::{Bitmap, BitmapFilter, Checkerboard, Texture, Wrap};

use super::image::{Change, is_encoded};
use super::names::{TEXTURES, TEXTURES_LATER};
use super::parameter::{Kind, Parameter, Values};
use super::parameters::Parameters;
use super::reader::Reader;
use crate::diagnostic::{Diagnostic, Location};
use crate::log::shortened;
use crate::spectra::Role;

impl Reader<'_> {
    /// `Texture "name" "values" "kind"`
    pub(super) fn texture(
        &mut self,
        (name, name_at): (String, &Location),
        (values, values_at): (&str, &Location),
        parameters: &Parameters,
    ) {
        let is_color = match values {
            "spectrum" | "color" => true,
            "float" => false,
            _ => {
                let message =
                    format!("a texture is of \"float\" or \"spectrum\", not of \"{}\"", shortened(values));
                self.log.error(values_at, message);
                return;
            }
        };
        let handle = self.new_texture(parameters, is_color);
        if self.named_textures.insert((is_color, name.clone()), handle).is_some() {
            self.log.error(name_at, format!("the texture \"{}\" is there already", shortened(&name)));
        }
    }

    fn new_texture(&mut self, parameters: &Parameters, is_color: bool) -> Option<Handle<Texture>> {
        let role = if is_color { Role::Reflectance } else { Role::Number };
        let factor = if is_color { Role::Index } else { Role::Number };
        let texture = match parameters.kind.as_str() {
            "constant" => {
                let value = self.texture_or_color(parameters, "value", Rgb::WHITE, role);
                parameters.finish();
                return value;
            }
            "scale" => {
                let a = self.texture_or_color(parameters, "tex", Rgb::WHITE, role);
                let b = self.texture_or_color(parameters, "scale", Rgb::WHITE, factor);
                // The names of older files.
                let c = self.texture_or_color(parameters, "tex1", Rgb::WHITE, role);
                let d = self.texture_or_color(parameters, "tex2", Rgb::WHITE, role);
                parameters.finish();
                let own = self.product(a?, b?, &parameters.at);
                let old = self.product(c?, d?, &parameters.at);
                return Some(self.product(own, old, &parameters.at));
            }
            "mix" => {
                let a = self.texture_or_color(parameters, "tex1", Rgb::BLACK, role);
                let b = self.texture_or_color(parameters, "tex2", Rgb::WHITE, role);
                let weight = self.texture_or_color(parameters, "amount", Rgb::splat(0.5), Role::Index);
                parameters.finish();
                return Some(self.mixture(weight?, a?, b?, &parameters.at));
            }
            "imagemap" => {
                let texture = self.image_map(parameters, is_color);
                parameters.finish();
                texture?
            }
            "checkerboard" => {
                let first = self.texture_or_color(parameters, "tex1", Rgb::WHITE, role);
                let second = self.texture_or_color(parameters, "tex2", Rgb::BLACK, role);
                if parameters.integer("dimension", 2, 2..=3) == 3 {
                    let message = "a checkerboard in space cannot be had yet: it is one of u and v";
                    self.log.warn(&parameters.at, message);
                }
                let [scale, delta] = self.uv_mapping(parameters);
                parameters.ignore(&["aamode"]);
                parameters.finish();
                // There the squares are one unit wide, here half a unit.
                let mut to_uv = Affine2::from_scale(scale * 0.5);
                to_uv.translation = delta * 0.5;
                Texture::Checkerboard(Checkerboard { color0: first?, color1: second?, to_uv })
            }
            kind if TEXTURES_LATER.contains(&kind) => self.mean_of_other(parameters, role),
            _ => {
                self.unknown_kind(parameters, &[TEXTURES, TEXTURES_LATER]);
                return None;
            }
        };
        Some(self.store_texture(&parameters.at, texture))
    }

    /// The mean of a texture that cannot be rendered yet.
    fn mean_of_other(&mut self, parameters: &Parameters, role: Role) -> Texture {
        let pair = match parameters.kind.as_str() {
            "dots" => Some(["inside", "outside"]),
            "directionmix" => Some(["tex1", "tex2"]),
            "bilerp" => Some(["v00", "v11"]),
            _ => None,
        };
        let mean = match pair {
            Some(names) => {
                let [a, b] = names.map(|name| {
                    let default =
                        Rgb::splat(if matches!(name, "inside" | "tex2" | "v11") { 1.0 } else { 0.0 });
                    let texture = self.texture_or_color(parameters, name, default, role);
                    texture.map_or(default, |texture| self.textures.mean(texture))
                });
                (a + b) * 0.5
            }
            None => Rgb::splat(0.5),
        };
        let kind = &parameters.kind;
        let message =
            format!("texture \"{kind}\" cannot be rendered yet; it becomes one colour, about its mean");
        self.log.warn(&parameters.at, message);
        parameters.finish_approximated();
        Texture::Constant(mean)
    }

    fn image_map(&mut self, parameters: &Parameters, is_color: bool) -> Option<Texture> {
        let filters = [
            ("bilinear", BitmapFilter::Bilinear),
            ("point", BitmapFilter::Nearest),
            ("trilinear", BitmapFilter::Bilinear),
            ("ewa", BitmapFilter::Bilinear),
            ("EWA", BitmapFilter::Bilinear),
        ];
        // What is finer than a pixel, many samples make smooth.
        let filter = parameters.choice("filter", BitmapFilter::Bilinear, &filters);
        let wrap = self.wrap(parameters);
        let [scale, delta] = self.uv_mapping(parameters);
        // Heights may go down.
        let factor = match is_color {
            true => parameters.not_negative("scale", 1.0),
            false => parameters.float("scale", 1.0),
        } as f32;
        let invert = parameters.boolean("invert", false);
        let raw = self.is_raw(parameters);
        parameters.ignore(&["maxanisotropy", "trilinear"]);
        let change = Change { raw, scale: factor, invert, grey: !is_color, root: false };
        let image = self.named_image(parameters, change)?;
        // There the last row is at v = 0, here the first.
        let mut to_uv = Affine2::from_scale(scale * Vec2::new(1.0, -1.0));
        to_uv.translation = Vec2::new(delta.x, 1.0 - delta.y);
        Some(Texture::Bitmap(Bitmap { image, filter, wrap, to_uv }))
    }

    /// Whether the values of an image are taken as they are.
    fn is_raw(&self, parameters: &Parameters) -> bool {
        let by_name = parameters.text("filename").is_none_or(|(name, _)| !is_encoded(name));
        if parameters.has("gamma") {
            // Of older files; whether to decode was a bool.
            let found = parameters.any("gamma");
            return found.is_some_and(|p| p.values == Values::Bools(vec![false])) || by_name;
        }
        let Some((text, at)) = parameters.text("encoding") else { return by_name };
        match text.split_whitespace().collect::<Vec<_>>().as_slice() {
            ["sRGB" | "srgb"] => false,
            ["linear"] => true,
            ["gamma", value] if value.parse().is_ok_and(|v: f64| v == 1.0) => true,
            ["gamma", value] if value.parse().is_ok_and(|v: f64| v > 0.0) => {
                self.log.warn(at, format!("\"{}\" is taken for sRGB", shortened(text)));
                false
            }
            _ => {
                let message = format!("unknown encoding \"{}\"", shortened(text));
                self.log.push(
                    Diagnostic::error(at, message).hint("it can be sRGB, linear or gamma and a number"),
                );
                by_name
            }
        }
    }

    fn wrap(&self, parameters: &Parameters) -> Wrap {
        let wraps = [
            ("repeat", Some(Wrap::Repeat)),
            ("clamp", Some(Wrap::Clamp)),
            ("black", Some(Wrap::Black)),
            ("octahedralsphere", None),
        ];
        parameters.choice("wrap", Some(Wrap::Repeat), &wraps).unwrap_or_else(|| {
            let message = "an image of a sphere cannot be had yet: its edge goes on";
            self.log.warn(&parameters.at, message);
            Wrap::Clamp
        })
    }

    /// The scale and shift of u and v.
    fn uv_mapping(&self, parameters: &Parameters) -> [Vec2; 2] {
        let mappings = [("uv", true), ("spherical", false), ("cylindrical", false), ("planar", false)];
        if !parameters.choice("mapping", true, &mappings) {
            let message = "only the mapping \"uv\" can be had yet, and stands for the others";
            self.log.warn(&parameters.at, message);
            parameters.ignore(&["v1", "v2"]);
        }
        let pair = |u, v, default| {
            Vec2::new(parameters.float(u, default) as f32, parameters.float(v, default) as f32)
        };
        [pair("uscale", "vscale", 1.0), pair("udelta", "vdelta", 0.0)]
    }

    /// A parameter that is a texture, a colour or a number; `None` if the log says what is wrong.
    pub(super) fn texture_or_color(
        &mut self,
        parameters: &Parameters,
        name: &'static str,
        default: Rgb,
        role: Role,
    ) -> Option<Handle<Texture>> {
        match parameters.any(name) {
            None => Some(self.store_texture(&parameters.at, Texture::Constant(default))),
            Some(found) if found.kind == Kind::Texture => self.referred(found, role),
            Some(found) => {
                let color = self.color_of(parameters, found, role)?;
                Some(self.store_texture(&found.value_at, Texture::Constant(color)))
            }
        }
    }

    /// The texture that a parameter names: first one of its own kind of values.
    fn referred(&self, found: &Parameter, role: Role) -> Option<Handle<Texture>> {
        let Values::Texts(texts) = &found.values else { return None };
        let [name] = texts.as_slice() else {
            self.log.error(&found.value_at, format!("\"{}\" takes one texture", found.name));
            return None;
        };
        let of_colors = role == Role::Reflectance;
        for is_color in [of_colors, !of_colors] {
            if let Some(known) = self.named_textures.get(&(is_color, name.clone())) {
                return *known;
            }
        }
        let message = format!("no texture is called \"{}\"", shortened(name));
        let known = self.named_textures.keys().map(|(_, name)| name.as_str());
        let mut message = Diagnostic::error(&found.value_at, message).did_you_mean(name, known);
        if message.hint.is_none() {
            message = message.hint("Texture must stand before its use");
        }
        self.log.push(message);
        None
    }
}
