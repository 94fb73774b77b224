//! Textures and images.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::math::{Affine2, DAffine3, DMat3, DVec3};
use nephroid::texture::{BitmapFilter, Texture, Wrap};

use super::{Writer, image};
use crate::image::ImageError;

/// What values of a property mean something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Range {
    /// From 0 to 1, as materials take them; Mitsuba refuses others.
    Unit,
    /// All.
    Any,
}

impl Writer<'_, '_> {
    /// Every image as a file, and every texture that is not one colour.
    pub(super) fn textures(&mut self) -> Result<(), ImageError> {
        let scene = self.scene;
        for (number, picture) in scene.textures.images.iter().enumerate() {
            let (ending, bytes) = image::encode(picture).map_err(|problem| ImageError {
                path: format!("{}/image-{number}", self.folder).into(),
                problem,
            })?;
            let name = self.store(&format!("image-{number}.{ending}"), bytes)?;
            self.images.push(name);
        }
        for (handle, texture) in scene.textures.list.iter_handles() {
            let id = texture_id(handle);
            match texture {
                Texture::Constant(_) => {}
                Texture::Bitmap(bitmap) => {
                    self.xml.plugin("texture", "bitmap", &id);
                    self.xml.string("filename", &self.images[bitmap.image.index()]);
                    if bitmap.filter == BitmapFilter::Nearest {
                        self.xml.string("filter_type", "nearest");
                    }
                    match bitmap.wrap {
                        Wrap::Repeat => {}
                        Wrap::Mirror => self.xml.string("wrap_mode", "mirror"),
                        Wrap::Clamp => self.xml.string("wrap_mode", "clamp"),
                    }
                    self.to_uv(&bitmap.to_uv);
                    self.xml.close();
                }
                Texture::Checkerboard(board) => {
                    self.xml.plugin("texture", "checkerboard", &id);
                    self.paint("color0", board.color0, Range::Unit);
                    self.paint("color1", board.color1, Range::Unit);
                    self.to_uv(&board.to_uv);
                    self.xml.close();
                }
            }
        }
        Ok(())
    }

    /// A property that is a colour or a texture.
    pub(super) fn paint(&mut self, name: &str, texture: Handle<Texture>, range: Range) {
        match (&self.scene.textures.list[texture], range) {
            (Texture::Constant(value), Range::Unit) => self.xml.rgb(name, unit(*value)),
            (Texture::Constant(value), Range::Any) => self.xml.rgb(name, *value),
            _ => self.xml.reference(name, &texture_id(texture)),
        }
    }

    /// A property that is a number or a texture.
    pub(super) fn scalar(&mut self, name: &str, texture: Handle<Texture>) {
        match &self.scene.textures.list[texture] {
            Texture::Constant(value) if value.r == value.g && value.g == value.b => {
                self.xml.float(name, unit(*value).r);
            }
            _ => self.paint(name, texture, Range::Unit),
        }
    }

    /// The one colour of a texture, if it has one.
    pub(super) fn constant(&self, texture: Handle<Texture>) -> Option<Rgb> {
        match &self.scene.textures.list[texture] {
            Texture::Constant(value) => Some(unit(*value)),
            _ => None,
        }
    }

    fn to_uv(&mut self, map: &Affine2) {
        if *map == Affine2::IDENTITY {
            return;
        }
        let flat = |v: nephroid::math::Vec2| DVec3::new(v.x.into(), v.y.into(), 0.0);
        let linear = DMat3::from_cols(flat(map.matrix2.x_axis), flat(map.matrix2.y_axis), DVec3::Z);
        self.xml.matrix("to_uv", &DAffine3::from_mat3_translation(linear, flat(map.translation)));
    }
}

fn texture_id(texture: Handle<Texture>) -> String {
    format!("texture-{}", texture.index())
}

/// Renders bring values of materials into the range themselves.
fn unit(value: Rgb) -> Rgb {
    value.map(|v| if v > 0.0 { v.min(1.0) } else { 0.0 })
}
