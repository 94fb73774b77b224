//! Images, read once for each use that is made of their values.

use std::path::{Path, PathBuf};

use nephroid::color::Rgb;
use nephroid::handle::Handle;
use nephroid::texture::{Pixels, Pixmap};

use super::parameters::Parameters;
use super::reader::Reader;
use crate::diagnostic::Location;
use crate::image::read_texture;

/// What is done to the values of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Change {
    /// Taken as they are, not decoded from sRGB.
    pub(super) raw: bool,
    /// Multiplied.
    pub(super) scale: f32,
    /// Taken from one after that.
    pub(super) invert: bool,
    /// Made one number: opacity where the image has it, as pbrt does, else the mean of the channels.
    pub(super) grey: bool,
    /// The root taken, which makes a roughness the width of a distribution.
    pub(super) root: bool,
}

impl Change {
    /// Nothing but decoding.
    pub(super) fn decoded(raw: bool) -> Self {
        Self { raw, scale: 1.0, invert: false, grey: false, root: false }
    }

    /// An image with that done.
    pub(super) fn applied(&self, image: &Pixmap) -> Pixmap {
        let as_it_is = Self { grey: false, ..*self } == Self::decoded(self.raw);
        let is_grey = image.alpha.is_none() && matches!(image.pixels, Pixels::Grey(..));
        if as_it_is && (is_grey || !self.grey) {
            return image.clone();
        }
        let of = |(index, pixel): (usize, Rgb)| match &image.alpha {
            Some(plane) if self.grey => self.of(Rgb::splat(plane.value(index))),
            _ => self.of(pixel),
        };
        let pixels = Pixels::Linear(image.pixels.iter().enumerate().map(of).collect());
        let alpha = if self.grey { None } else { image.alpha.clone() };
        Pixmap { width: image.width, height: image.height, pixels, alpha }
    }

    fn of(&self, pixel: Rgb) -> Rgb {
        let mut value = pixel * self.scale;
        if self.grey {
            value = Rgb::splat((value.r + value.g + value.b) / 3.0);
        }
        if self.invert {
            value = value.map(|v| (1.0 - v).max(0.0));
        }
        if self.root { value.map(|v| v.max(0.0).sqrt()) } else { value }
    }
}

/// A file and what was done to it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ImageKey {
    path: PathBuf,
    raw: bool,
    scale: u32,
    flags: [bool; 3],
}

/// Whether an image of that name holds values as an sRGB screen takes them.
pub(super) fn is_encoded(name: &str) -> bool {
    let extension = Path::new(name).extension().and_then(|e| e.to_str()).unwrap_or_default();
    ["png", "jpg", "jpeg", "tga", "bmp", "gif"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

impl Reader<'_> {
    /// The image that `filename` names.
    pub(super) fn named_image(&mut self, parameters: &Parameters, change: Change) -> Option<Handle<Pixmap>> {
        let Some((name, at)) = parameters.text("filename") else {
            if !parameters.has("filename") {
                let message = format!("{} \"{}\" lacks a filename", parameters.noun, parameters.kind);
                self.log.error(&parameters.at, message);
            }
            return None;
        };
        let (path, bytes) = self.read_file(name, at)?;
        let flags = [change.invert, change.grey, change.root];
        let key = ImageKey { path: path.clone(), raw: change.raw, scale: change.scale.to_bits(), flags };
        if let Some(handle) = self.image_of.get(&key) {
            return Some(*handle);
        }
        let mut image = self.decoded(&path, &bytes, change.raw, at)?;
        if change != Change::decoded(change.raw) {
            image = change.applied(&image);
        }
        let handle = self.store_image(image, at);
        self.image_of.insert(key, handle);
        Some(handle)
    }

    pub(super) fn store_image(&mut self, image: Pixmap, at: &Location) -> Handle<Pixmap> {
        self.origins.images.push(at.clone());
        self.textures.images.push(image)
    }

    /// The pixels of a file.
    pub(super) fn decoded(&self, path: &Path, bytes: &[u8], raw: bool, at: &Location) -> Option<Pixmap> {
        match read_texture(bytes, raw) {
            Ok(file) => {
                if file.non_finite > 0 {
                    let (path, n) = (path.display(), file.non_finite);
                    self.log.warn(at, format!("{path}: {n} pixels are not finite and become black"));
                }
                Some(file.image)
            }
            Err(problem) => {
                self.log.error(at, format!("\"{}\" {problem}", path.display()));
                None
            }
        }
    }
}
