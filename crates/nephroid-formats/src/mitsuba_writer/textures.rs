//! Textures and images.

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::math::{Affine2, DAffine3, DMat3, DVec3, Vec2};
use nephroid::texture::{Bitmap, BitmapFilter, Image, Pixmap, Texture, Wrap};

use super::Writer;
use super::image::{self, Encoded};
use crate::image::ImageError;

/// Pixels along the sides of an image that stands for textures without images.
const BAKED_SIDE: u32 = 256;

/// What values of a property mean something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Range {
    /// From 0 to 1, as materials take them; Mitsuba refuses others.
    Unit,
    /// All.
    Any,
}

/// The file of an image.
#[derive(Clone, Debug)]
pub(super) struct ImageName {
    pub(super) name: String,
    pub(super) raw: bool,
}

impl Writer<'_, '_> {
    /// Every image as a file, and every texture that is not one colour.
    pub(super) fn textures(&mut self) -> Result<(), ImageError> {
        let scene = self.scene;
        for (number, picture) in scene.textures.images.iter().enumerate() {
            let name = self.image_file(&format!("image-{number}"), picture)?;
            self.images.push(name);
        }
        for (handle, texture) in scene.textures.list.iter_handles() {
            let id = texture_id(handle);
            match texture {
                Texture::Constant(_) => {}
                Texture::Bitmap(bitmap) => {
                    let image = self.images[bitmap.image.index()].clone();
                    self.bitmap(&id, &image, bitmap);
                }
                Texture::Checkerboard(board) => {
                    self.xml.plugin("texture", "checkerboard", &id);
                    self.paint("color0", board.color0, Range::Unit);
                    self.paint("color1", board.color1, Range::Unit);
                    self.uv_map(&board.to_uv);
                    self.xml.close();
                }
                Texture::VertexColor => {
                    self.xml.plugin("texture", "mesh_attribute", &id);
                    self.xml.string("name", "vertex_color");
                    self.xml.close();
                }
                Texture::Scale { .. } | Texture::Mix { .. } | Texture::Channel { .. } => {
                    self.baked(&id, handle)?;
                }
            }
        }
        Ok(())
    }

    fn image_file(&mut self, name: &str, image: &Pixmap) -> Result<ImageName, ImageError> {
        let encoded = image::encode(image)
            .map_err(|problem| ImageError { path: format!("{}/{name}", self.folder).into(), problem })?;
        let Encoded { ending, raw, bytes } = encoded;
        Ok(ImageName { name: self.store(&format!("{name}.{ending}"), bytes)?, raw })
    }

    fn bitmap(&mut self, id: &str, image: &ImageName, bitmap: &Bitmap) {
        self.xml.plugin("texture", "bitmap", id);
        self.xml.string("filename", &image.name);
        if image.raw {
            self.xml.boolean("raw", true);
        }
        if bitmap.filter == BitmapFilter::Nearest {
            self.xml.string("filter_type", "nearest");
        }
        match bitmap.wrap {
            Wrap::Repeat => {}
            Wrap::Mirror => self.xml.string("wrap_mode", "mirror"),
            Wrap::Clamp => self.xml.string("wrap_mode", "clamp"),
            Wrap::Black => {
                self.warn(format!("{id}: an image that ends in black goes on with its edge in Mitsuba"));
                self.xml.string("wrap_mode", "clamp");
            }
        }
        self.uv_map(&bitmap.to_uv);
        self.xml.close();
    }

    /// A texture that Mitsuba lacks, as an image of it: the same to the bit if all in it lies over the pixels of one
    /// image.
    fn baked(&mut self, id: &str, texture: Handle<Texture>) -> Result<(), ImageError> {
        let textures = &self.scene.textures;
        let mut bitmaps: Vec<&Bitmap> = Vec::new();
        let mut exact = true;
        let mut open = vec![texture];
        while let Some(handle) = open.pop() {
            match &textures.list[handle] {
                Texture::Bitmap(bitmap) => bitmaps.push(bitmap),
                Texture::Checkerboard(_) | Texture::VertexColor => exact = false,
                _ => {}
            }
            open.extend(textures.list[handle].children());
        }
        let frame = bitmaps.first().map(|first| (first.to_uv, first.wrap, first.filter));
        exact &= bitmaps.iter().all(|b| Some((b.to_uv, b.wrap, b.filter)) == frame);
        let size = |b: &&Bitmap| (textures.images[b.image].width, textures.images[b.image].height);
        let sizes: Vec<(u32, u32)> = bitmaps.iter().map(size).collect();
        exact &= sizes.windows(2).all(|pair| pair[0] == pair[1]);
        let (to_uv, wrap, filter) = frame.unwrap_or_default();
        let side = |of: fn(&(u32, u32)) -> u32| sizes.iter().map(of).max().unwrap_or(BAKED_SIDE);
        let (width, height) = (side(|size| size.0), side(|size| size.1));
        let from_frame = to_uv.inverse();
        let mut pixels = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let middle = Vec2::new((x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
                pixels.push(textures.eval(texture, from_frame.transform_point2(middle)));
            }
        }
        if !exact {
            self.warn(format!(
                "{id}: an image of {width} by {height} pixels stands for a texture of several"
            ));
        }
        let image = self.image_file(id, &Image { width, height, pixels }.into())?;
        // Only its frame counts.
        let any = self.scene.textures.images.iter_handles().next().map(|(handle, _)| handle);
        match any {
            Some(any) => self.bitmap(id, &image, &Bitmap { image: any, filter, wrap, to_uv }),
            None => {
                self.xml.plugin("texture", "bitmap", id);
                self.xml.string("filename", &image.name);
                self.xml.close();
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

    /// The mean of a texture's channels.
    pub(super) fn mean(&self, texture: Handle<Texture>) -> f32 {
        unit(self.scene.textures.mean(texture)).mean()
    }

    fn uv_map(&mut self, map: &Affine2) {
        if *map == Affine2::IDENTITY {
            return;
        }
        let flat = |v: Vec2| DVec3::new(v.x.into(), v.y.into(), 0.0);
        let linear = DMat3::from_cols(flat(map.matrix2.x_axis), flat(map.matrix2.y_axis), DVec3::Z);
        self.xml.matrix("to_uv", &DAffine3::from_mat3_translation(linear, flat(map.translation)));
    }
}

pub(super) fn texture_id(texture: Handle<Texture>) -> String {
    format!("texture-{}", texture.index())
}

/// Renders bring values of materials into the range themselves.
fn unit(value: Rgb) -> Rgb {
    value.map(|v| if v > 0.0 { v.min(1.0) } else { 0.0 })
}
