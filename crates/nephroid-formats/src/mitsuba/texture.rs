//! Colours and textures.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::math::{Affine2, Transform, Vec2};
use nephroid::texture::{Bitmap, BitmapFilter, Checkerboard, Pixmap, Texture, Wrap};

use super::document::Element;
use super::names::{TEXTURES, TEXTURES_LATER};
use super::properties::Plugin;
use super::reader::{Outcome, Reader};
use super::value::Value;
use crate::diagnostic::{Diagnostic, Location};
use crate::image::read_texture;
use crate::log::shortened;
use crate::spectra::{Role, Spectrum};

/// A colour, or a texture that was read.
enum Paint {
    Flat(Rgb),
    Varied(Handle<Texture>),
}

impl<'t> Reader<'t> {
    /// A property that may be a texture.
    pub(super) fn texture_property(
        &mut self,
        plugin: &Plugin<'t>,
        name: &'static str,
        default: f32,
        role: Role,
    ) -> Handle<Texture> {
        match self.paint(plugin, name, default, role) {
            Paint::Flat(color) => {
                let at = plugin.property(name).map_or(plugin.location(), |p| &p.location);
                self.store_texture(at, Texture::Constant(color))
            }
            Paint::Varied(texture) => texture,
        }
    }

    /// A texture of the scene, and where it stands in the file.
    pub(super) fn store_texture(&mut self, at: &Location, texture: Texture) -> Handle<Texture> {
        self.origins.textures.push(at.clone());
        self.textures.push(texture)
    }

    /// A property that must be one colour.
    pub(super) fn color_property(
        &mut self,
        plugin: &Plugin<'t>,
        name: &'static str,
        default: f32,
        role: Role,
    ) -> Rgb {
        match self.paint(plugin, name, default, role) {
            Paint::Flat(color) => color,
            Paint::Varied(texture) => {
                if let (Some(property), false) =
                    (plugin.property(name), matches!(self.textures.list[texture], Texture::Constant(_)))
                {
                    self.log
                        .error(&property.location, format!("\"{name}\" must be one colour, not a texture"));
                }
                self.textures.mean(texture)
            }
        }
    }

    fn paint(&mut self, plugin: &Plugin<'t>, name: &'static str, default: f32, role: Role) -> Paint {
        let Some(property) = plugin.property(name) else { return Paint::Flat(Rgb::splat(default)) };
        let flat = match &property.value {
            Value::Float(v) => Rgb::splat(*v as f32),
            Value::Integer(v) => Rgb::splat(*v as f32),
            Value::Color(channels) => Rgb::from(channels.map(|v| v as f32)),
            Value::Spectrum(spectrum) => self.spectrum_color(spectrum, role, &property.location),
            Value::SpectrumFile(file) => match self.spectrum_file(file, &property.location) {
                Some(spectrum) => self.spectrum_color(&spectrum, role, &property.location),
                None => Rgb::splat(default),
            },
            Value::Object(element) if element.tag == "spectrum" => self.spectrum_plugin(element, role),
            Value::Object(element) if element.tag == "texture" => {
                return match self.texture(element) {
                    Some(texture) => Paint::Varied(texture),
                    None => Paint::Flat(Rgb::splat(default)),
                };
            }
            _ => {
                plugin.wrong_type(property, "a colour or texture");
                Rgb::splat(default)
            }
        };
        Paint::Flat(flat)
    }

    pub(super) fn spectrum_color(&self, spectrum: &Spectrum, role: Role, at: &Location) -> Rgb {
        let rgb = spectrum.to_rgb(role);
        if !rgb.is_finite() {
            self.log.error(at, "the colour of the spectrum is not finite");
            return Rgb::BLACK;
        }
        rgb
    }

    fn spectrum_file(&self, file: &str, at: &Location) -> Option<Spectrum> {
        let (_, bytes) = self.read_file(file, at)?;
        match Spectrum::parse_file(&String::from_utf8_lossy(&bytes)) {
            Ok(spectrum) => Some(spectrum),
            Err(message) => {
                self.log.error(at, format!("\"{}\": {message}", shortened(file)));
                None
            }
        }
    }

    /// A `<texture>`, read once however often it is referred to. `None` if the log says why.
    pub(super) fn texture(&mut self, element: &'t Element) -> Option<Handle<Texture>> {
        match self.texture_of.get(&element.number) {
            Some(Outcome::Done(handle)) => return Some(*handle),
            Some(Outcome::Failed) => return None,
            Some(Outcome::Open) => {
                self.log.error(&element.location, "the texture refers to itself");
                return None;
            }
            None => {}
        }
        self.texture_of.insert(element.number, Outcome::Open);
        let texture = self.nested(&element.location, |reader| reader.new_texture(element));
        let handle = texture.map(|texture| self.store_texture(&element.location, texture));
        self.texture_of.insert(element.number, handle.map_or(Outcome::Failed, Outcome::Done));
        handle
    }

    fn new_texture(&mut self, element: &'t Element) -> Option<Texture> {
        let plugin = self.plugin(element);
        let texture = match plugin.kind {
            "bitmap" | "ldrtexture" => self.bitmap(&plugin)?,
            "checkerboard" => {
                let color0 = self.texture_property(&plugin, "color0", 0.4, Role::Reflectance);
                let color1 = self.texture_property(&plugin, "color1", 0.2, Role::Reflectance);
                let to_uv = flat_transform(&plugin.transform("to_uv"));
                Texture::Checkerboard(Checkerboard { color0, color1, to_uv })
            }
            "mesh_attribute" => self.mesh_attribute(&plugin),
            "vertexcolors" => Texture::VertexColor,
            "scale" => self.scaled(&plugin)?,
            // Numbers that are no colour may come as a vector.
            "rawconstant" if plugin.is_vector("value") => {
                Texture::Constant(plugin.vector("value").map_or(Rgb::WHITE, |v| Rgb::from(v.to_array())))
            }
            "rawconstant" | "uniform" => {
                Texture::Constant(self.color_property(&plugin, "value", 1.0, Role::Index))
            }
            "srgb" => Texture::Constant(self.color_property(&plugin, "color", 1.0, Role::Index)),
            kind if TEXTURES_LATER.contains(&kind) => {
                let message =
                    format!("texture \"{kind}\" cannot be rendered yet; it becomes plain grey (0.5)");
                self.log.warn(plugin.location(), message);
                plugin.finish_approximated();
                return Some(Texture::Constant(Rgb::splat(0.5)));
            }
            _ => {
                self.unknown_kind(&plugin, &[TEXTURES, TEXTURES_LATER]);
                return None;
            }
        };
        plugin.finish();
        Some(texture)
    }

    fn bitmap(&mut self, plugin: &Plugin<'t>) -> Option<Texture> {
        let raw = plugin.boolean("raw", false) || self.is_linear(plugin);
        let filters = [
            ("bilinear", BitmapFilter::Bilinear),
            ("nearest", BitmapFilter::Nearest),
            // Those of older versions, which differ far away only.
            ("trilinear", BitmapFilter::Bilinear),
            ("ewa", BitmapFilter::Bilinear),
        ];
        let filter = plugin.choice("filter_type", BitmapFilter::Bilinear, &filters);
        let wrap = self.wrap(plugin);
        let to_uv = flat_transform(&plugin.transform("to_uv"));
        plugin.ignore(&["accel", "format", "cache", "max_anisotropy"]);
        let image = self.image_property(plugin, raw)?;
        let bitmap = Texture::Bitmap(Bitmap { image, filter, wrap, to_uv });
        let Some((name, at)) = plugin.text("channel") else { return Some(bitmap) };
        let channels = [("r", 0), ("g", 1), ("b", 2), ("a", 3), ("x", 0), ("y", 1), ("z", 2)];
        match channels.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)) {
            Some((_, channel)) => {
                let of = self.store_texture(plugin.location(), bitmap);
                Some(Texture::Channel { of, channel: *channel })
            }
            None => {
                let message = format!("unknown channel \"{}\"", shortened(name));
                self.log.push(Diagnostic::error(at, message).hint("one of r, g, b, a"));
                None
            }
        }
    }

    /// Whether an old `gamma` says that the numbers of the file are to be taken as they are.
    fn is_linear(&self, plugin: &Plugin<'t>) -> bool {
        let Some(gamma) = plugin.optional_float("gamma") else { return false };
        // Nothing but one and the curve of sRGB can be had; the latter is close to 2.2, and -1 asks for it.
        if let Some(property) =
            plugin.property("gamma").filter(|_| gamma > 0.0 && gamma != 1.0 && gamma != 2.2)
        {
            self.log.warn(&property.location, format!("the curve of sRGB stands for a gamma of {gamma}"));
        }
        gamma == 1.0
    }

    fn wrap(&self, plugin: &Plugin<'t>) -> Wrap {
        let wraps = [
            ("repeat", Wrap::Repeat),
            ("mirror", Wrap::Mirror),
            ("clamp", Wrap::Clamp),
            ("zero", Wrap::Black),
            ("black", Wrap::Black),
        ];
        let mut wrap = plugin.choice("wrap_mode", Wrap::Repeat, &wraps);
        let [u, v] = ["wrap_mode_u", "wrap_mode_v"].map(|name| {
            let given = plugin.has(name).then(|| plugin.choice(name, wrap, &wraps));
            given.inspect(|_| plugin.ignore(&[name]))
        });
        if let Some(u) = u {
            wrap = u;
        }
        if let (Some(property), Some(v)) = (plugin.property("wrap_mode_v"), v)
            && v != wrap
        {
            let message = "an image is continued alike in both directions: this one does not count";
            self.log.warn(&property.location, message);
        }
        wrap
    }

    /// An attribute of vertices: colours alone are kept.
    fn mesh_attribute(&mut self, plugin: &Plugin<'t>) -> Texture {
        let name = plugin.text("name");
        let scale = plugin.float("scale", 1.0);
        let color = match name {
            Some(("vertex_color", _)) => Texture::VertexColor,
            Some((name, at)) => {
                let message = format!(
                    "only \"vertex_color\" is read of meshes; \"{}\" is plain grey (0.5)",
                    shortened(name)
                );
                self.log.warn(at, message);
                Texture::Constant(Rgb::splat(0.5))
            }
            None => {
                self.log.error(plugin.location(), "\"mesh_attribute\" lacks its \"name\"");
                Texture::Constant(Rgb::splat(0.5))
            }
        };
        if scale == 1.0 {
            return color;
        }
        let a = self.store_texture(plugin.location(), color);
        let b = self.store_texture(plugin.location(), Texture::Constant(Rgb::splat(scale)));
        Texture::Scale { a, b }
    }

    /// A texture times a number or a colour.
    fn scaled(&mut self, plugin: &Plugin<'t>) -> Option<Texture> {
        let nested = plugin.objects("texture");
        let [(_, element)] = nested[..] else {
            let message = format!("\"scale\" takes one texture, not {}", nested.len());
            self.log.error(plugin.location(), message);
            return None;
        };
        let b = self.color_property(plugin, "scale", 1.0, Role::Index);
        let a = self.texture(element)?;
        let b = self.store_texture(plugin.location(), Texture::Constant(b));
        Some(Texture::Scale { a, b })
    }

    /// The image that a plugin's `filename` names, read once for each way of decoding.
    pub(super) fn image_property(&mut self, plugin: &Plugin<'t>, raw: bool) -> Option<Handle<Pixmap>> {
        let Some((name, at)) = plugin.text("filename") else {
            if !plugin.has("filename") {
                let message = format!("{} \"{}\" lacks a filename", plugin.element.tag, plugin.kind);
                self.log.error(plugin.location(), message);
            }
            return None;
        };
        let (path, bytes) = self.read_file(name, at)?;
        if let Some(handle) = self.image_of.get(&(path.clone(), raw)) {
            return Some(*handle);
        }
        match read_texture(&bytes, raw) {
            Ok(file) => {
                if file.non_finite > 0 {
                    let message = format!(
                        "{}: {} pixels are not finite and become black",
                        path.display(),
                        file.non_finite
                    );
                    self.log.warn(at, message);
                }
                self.origins.images.push(at.clone());
                let handle = self.textures.images.push(file.image);
                self.image_of.insert((path, raw), handle);
                Some(handle)
            }
            Err(problem) => {
                self.log.error(at, format!("\"{}\" {problem}", path.display()));
                None
            }
        }
    }
}

/// The part of a transform that concerns `u` and `v`.
fn flat_transform(transform: &Transform) -> Affine2 {
    let (m, t) = (transform.0.matrix3, transform.0.translation);
    let flat = |v: nephroid::math::DVec3| Vec2::new(v.x as f32, v.y as f32);
    let (x, y, offset) = (flat(m.x_axis), flat(m.y_axis), flat(t));
    let mut out = Affine2::IDENTITY;
    out.matrix2.x_axis = x;
    out.matrix2.y_axis = y;
    out.translation = offset;
    out
}
