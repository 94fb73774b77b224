//! Pictures in files: what kind a name asks for, and writing them.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use nephroid::film::ToneMap;
use nephroid::texture::Image;
use nephroid_formats::image::{
    ImageError, Layer, LayerData, check_writable, read_image, write_exr, write_png,
};

use crate::exit::Failure;
use crate::layers::{DevelopedLayer, with_layers};

/// What a picture can be written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// OpenEXR: radiance.
    Exr,
    /// PNG: made for a display.
    Png,
}

/// A file to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// Where.
    pub path: PathBuf,
    /// As what.
    pub kind: Kind,
}

impl Output {
    /// The kind is the suffix of the name.
    pub fn new(path: &Path) -> Result<Self, Failure> {
        let suffix = path.extension().and_then(OsStr::to_str).map(str::to_lowercase);
        let kind = match suffix.as_deref() {
            Some("exr") => Kind::Exr,
            Some("png") => Kind::Png,
            Some("film") => {
                let message = "film files, which keep a render to go on with, cannot be written yet";
                return Err(usage(path, message));
            }
            _ => return Err(usage(path, "the name of a picture ends in .exr or .png")),
        };
        Ok(Self { path: path.to_owned(), kind })
    }

    /// A file that must be of one kind.
    pub fn of_kind(path: &Path, kind: Kind) -> Result<Self, Failure> {
        let output = Self::new(path)?;
        match (output.kind == kind, kind) {
            (true, _) => Ok(output),
            (false, Kind::Png) => Err(usage(path, "this picture is a .png")),
            (false, Kind::Exr) => Err(usage(path, "this picture is an .exr")),
        }
    }

    fn write(
        &self,
        image: &Image,
        layers: &[DevelopedLayer],
        tone_map: &ToneMap,
        exposure: f32,
    ) -> Result<(), ImageError> {
        match self.kind {
            Kind::Exr => {
                let picture = Layer { name: "", data: LayerData::Rgb(image) };
                with_layers(picture, layers, |all| write_exr(&self.path, all))
            }
            Kind::Png => write_png(&self.path, &tone_map.apply(image, exposure)),
        }
    }
}

fn usage(path: &Path, message: &str) -> Failure {
    Failure::Usage(format!("{}: {message}", path.display()))
}

/// The files that `-o` names, or `NAME.exr` and `NAME.png` in the current folder; each could be
/// written now.
pub fn outputs(named: &[PathBuf], name: &OsStr) -> Result<Vec<Output>, Failure> {
    let default = [".exr", ".png"].map(|suffix| {
        let mut file = name.to_owned();
        file.push(suffix);
        PathBuf::from(file)
    });
    let named = if named.is_empty() { &default } else { named };
    let outputs = named.iter().map(|path| Output::new(path)).collect::<Result<Vec<_>, _>>()?;
    for (i, output) in outputs.iter().enumerate() {
        if outputs[..i].contains(output) {
            return Err(usage(&output.path, "is to be written twice"));
        }
        check_writable(&output.path).map_err(|e| Failure::File(e.to_string()))?;
    }
    Ok(outputs)
}

/// Writes a picture to each file, with its further layers where they fit. One that cannot be written keeps no other from being.
pub fn write_all(
    outputs: &[Output],
    image: &Image,
    layers: &[DevelopedLayer],
    tone_map: &ToneMap,
    exposure: f32,
) -> Result<(), Failure> {
    let write = |o: &Output| o.write(image, layers, tone_map, exposure).err().map(|e| e.to_string());
    let errors: Vec<String> = outputs.iter().filter_map(write).collect();
    if errors.is_empty() { Ok(()) } else { Err(Failure::File(errors.join("\nerror: "))) }
}

/// Reads a picture.
pub fn read(path: &Path) -> Result<Image, Failure> {
    read_image(path).map(|file| file.image).map_err(|e| Failure::File(e.to_string()))
}
