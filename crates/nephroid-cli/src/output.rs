//! Pictures in files: what kind a name asks for, and writing them.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use nephroid::texture::Image;
use nephroid_formats::image::{Layer, LayerData, check_writable, read_image, write_exr, write_png};

use crate::args::DisplayArgs;
use crate::denoise::NOISY;
use crate::exit::Failure;
use crate::layers::{DevelopedLayer, ERROR, with_layers};

/// What a picture can be written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// OpenEXR: radiance.
    Exr,
    /// PNG: made for a display.
    Png,
    /// The exact sums.
    Film,
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
            Some("film") => Kind::Film,
            _ => {
                return Err(usage(
                    path,
                    "the name of a picture ends in .exr or .png, that of a film in .film",
                ));
            }
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
            (false, Kind::Film) => Err(usage(path, "this file is a .film")),
        }
    }

    fn write(
        &self,
        picture: &Picture,
        display: &DisplayArgs,
        film: &dyn Fn(&Path) -> Result<(), String>,
    ) -> Result<(), String> {
        match self.kind {
            Kind::Exr => {
                let rgb = |name, image| Layer { name, data: LayerData::Rgb(image) };
                let noisy = picture.noisy.as_ref().map(|noisy| rgb(NOISY, noisy));
                let (width, height) = (picture.image.width, picture.image.height);
                let error = picture
                    .error
                    .as_ref()
                    .map(|values| Layer { name: ERROR, data: LayerData::Grey { width, height, values } });
                let first = [rgb("", &picture.image)].into_iter().chain(noisy).chain(error).collect();
                with_layers(first, &picture.layers, |all| write_exr(&self.path, all))
                    .map_err(|e| e.to_string())
            }
            Kind::Png => {
                let shown = display.tonemap.apply(&picture.image, display.exposure);
                write_png(&self.path, &shown).map_err(|e| e.to_string())
            }
            Kind::Film => film(&self.path),
        }
    }
}

fn usage(path: &Path, message: &str) -> Failure {
    Failure::Usage(format!("{}: {message}", path.display()))
}

/// What is written where no output is named: `NAME.exr` and `NAME.png`.
pub fn default_names(name: &OsStr) -> Vec<PathBuf> {
    let with = |suffix| {
        let mut file = name.to_owned();
        file.push(suffix);
        PathBuf::from(file)
    };
    [".exr", ".png"].map(with).to_vec()
}

/// The files of these names; each could be written now.
pub fn outputs(named: &[PathBuf]) -> Result<Vec<Output>, Failure> {
    let outputs = named.iter().map(|path| Output::new(path)).collect::<Result<Vec<_>, _>>()?;
    all_differ(named.iter().map(|path| (path.as_path(), "-o")))?;
    for output in &outputs {
        check_writable(&output.path).map_err(|e| Failure::File(e.to_string()))?;
    }
    Ok(outputs)
}

/// Files to write, each with the flag that asks for it, are not one under two names.
pub fn all_differ<'a>(files: impl IntoIterator<Item = (&'a Path, &'a str)>) -> Result<(), Failure> {
    let mut seen: Vec<(PathBuf, &str)> = Vec::new();
    for (path, flag) in files {
        let place = place(path);
        if let Some((_, other)) = seen.iter().find(|(other, _)| *other == place) {
            let flags = if *other == flag { String::new() } else { format!(", with {other} and {flag}") };
            return Err(usage(path, &format!("is to be written twice{flags}")));
        }
        seen.push((place, flag));
    }
    Ok(())
}

/// The one name of a file that may not be there yet, in a folder that is.
fn place(path: &Path) -> PathBuf {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match (parent.canonicalize(), path.file_name()) {
        (Ok(parent), Some(name)) => parent.join(name),
        _ => path.to_owned(),
    }
}

/// A picture with its further layers.
pub struct Picture {
    /// Radiance, denoised if that was asked for.
    pub image: Image,
    /// What it was before.
    pub noisy: Option<Image>,
    /// The relative error that each pixel of that is expected to have.
    pub error: Option<Vec<f32>>,
    /// What is written where layers fit.
    pub layers: Vec<DevelopedLayer>,
}

/// Writes a picture to each file; `film` writes the sums it is made of. One that cannot be written keeps no other from being:
/// gives those that were, and why the others were not.
pub fn write_all(
    mut outputs: Vec<Output>,
    picture: &Picture,
    display: &DisplayArgs,
    film: &dyn Fn(&Path) -> Result<(), String>,
) -> (Vec<Output>, Vec<String>) {
    let mut trouble = Vec::new();
    outputs
        .retain(|output| output.write(picture, display, film).map_err(|error| trouble.push(error)).is_ok());
    (outputs, trouble)
}

/// Reads a picture.
pub fn read(path: &Path) -> Result<Image, Failure> {
    read_image(path).map(|file| file.image).map_err(|e| Failure::File(e.to_string()))
}
