//! Images, from files, data or buffers.

use nephroid::handle::Handle;
use nephroid::texture::{Decoding, Pixels, Pixmap};

use super::item::Item;
use super::reader::Reader;
use crate::image::{ImageFormat, read_texture};

/// What an image is wanted for: each is stored once for each purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Purpose {
    /// Colours, decoded by the curve of sRGB, and opacities.
    Color,
    /// Numbers.
    Raw,
    /// 1 where the opacity is at least a number, of which these are the bits, else 0.
    Cutoff(u32),
}

impl<'d> Reader<'d> {
    /// The image that a texture shows. `None` if there is none to be had, and the log says why.
    pub(super) fn image(&mut self, texture: Item<'d>, purpose: Purpose) -> Option<Handle<Pixmap>> {
        let Some((index, image)) = texture.refers("source", "images") else {
            if !texture.has("source") {
                self.without_source(texture);
            }
            return None;
        };
        if let Some(known) = self.image_of.get(&(index, purpose)) {
            return *known;
        }
        let pixmap = match purpose {
            Purpose::Cutoff(bits) => self.cut_out(texture, f32::from_bits(bits)),
            Purpose::Color => self.read_image(image, false),
            Purpose::Raw => self.read_image(image, true),
        };
        let handle = pixmap.map(|pixmap| {
            self.origins.images.push(image.at());
            self.textures.images.push(pixmap)
        });
        self.image_of.insert((index, purpose), handle);
        handle
    }

    /// A texture whose image is in a format that only extensions know, or that has none.
    fn without_source(&self, texture: Item<'d>) {
        let mut kinds =
            ["KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds"].into_iter();
        match kinds.find(|kind| texture.extension(kind).is_some()) {
            Some(kind) => self.cannot_read(
                texture,
                format!("the image of the texture is there by {kind} only, which is not read"),
                "export the model again with PNG or JPEG textures",
            ),
            None => texture.warn("the texture has no image, and is white"),
        }
    }

    /// An image that cannot be read is an error; the lenient have white in its place.
    fn cannot_read(&self, at: Item<'d>, message: String, hint: &str) {
        if self.lenient {
            at.warn(format!("{message}; it is white"));
        } else {
            at.error_with_hint(message, hint);
        }
    }

    fn read_image(&mut self, image: Item<'d>, raw: bool) -> Option<Pixmap> {
        let bytes = match image.get("uri") {
            Some(uri) => self.buffers.read(uri)?,
            None if image.has("bufferView") => self.buffers.view(image, "bufferView")?.bytes().to_vec(),
            None => {
                image.error("the image has neither a \"uri\" nor a \"bufferView\"");
                return None;
            }
        };
        if ImageFormat::of(&bytes).is_none() {
            let message = format!("the image {}", crate::image::ImageProblem::unknown_format(&bytes));
            self.cannot_read(
                image,
                message,
                "export the model again with PNG or JPEG textures, or try --lenient",
            );
            return None;
        }
        match read_texture(&bytes, raw) {
            Ok(file) => {
                if file.non_finite > 0 {
                    image.warn(format!("{} pixels are not finite and become black", file.non_finite));
                }
                Some(file.image)
            }
            Err(problem) => {
                image.error(format!("the image {problem}"));
                None
            }
        }
    }

    /// Where an image is at least so opaque.
    fn cut_out(&mut self, texture: Item<'d>, least: f32) -> Option<Pixmap> {
        let image = self.image(texture, Purpose::Color)?;
        let image = &self.textures.images[image];
        let there = |i: u32| image.opacity(i % image.width, i / image.width) >= least;
        let bytes = (0..image.width * image.height).map(|i| if there(i) { 255 } else { 0 }).collect();
        let pixels = Pixels::Grey(bytes, Decoding::linear());
        Some(Pixmap { width: image.width, height: image.height, pixels, alpha: None })
    }
}
