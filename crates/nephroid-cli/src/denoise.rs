//! Denoising of pictures where they are written, by a library that the user has installed.

use std::env;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use nephroid::color::Rgb;
use nephroid::film::Aov;
use nephroid_denoise::{Denoiser, LoadError, Search, python_prefixes};
use serde_json::{Value, json};

use crate::exit::Failure;
use crate::layers;
use crate::output::{Kind, Output, Picture};

/// Names the library where `--oidn-library` does not.
const VARIABLE: &str = "NEPHROID_OIDN_LIBRARY";

/// The layer that keeps the picture as it was rendered.
pub const NOISY: &str = "noisy";

/// What the denoiser is told of each pixel.
pub const GUIDES: [Aov; 2] = [Aov::Albedo, Aov::Normal];

/// A note where they were not kept.
pub const NO_GUIDES: &str =
    "albedo and normals are not in the film: without them, what is fine may be denoised away";

/// Whether to denoise, and by what.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Denoising")]
pub struct DenoiseArgs {
    /// Denoise the pictures by Intel Open Image Denoise 2, which has to be installed (pip install pyoidn). An .exr keeps
    /// the picture as it was in its layer "noisy", with the layers albedo and normal
    #[arg(long)]
    pub denoise: bool,
    /// Its library, or the folder of it [default: NEPHROID_OIDN_LIBRARY, else where the system and pip have it]
    #[arg(long, value_name = "FILE")]
    pub oidn_library: Option<PathBuf>,
}

/// By what a picture was denoised.
#[derive(Clone, Debug)]
pub struct Denoised {
    /// The library.
    pub library: PathBuf,
    /// Its version.
    pub version: String,
    /// How long it took.
    pub took: Duration,
}

impl Denoised {
    /// A few words.
    pub fn text(&self) -> String {
        let (library, seconds) = (self.library.display(), self.took.as_secs_f64());
        format!("by Open Image Denoise {}, {library}, in {seconds:.2} s", self.version)
    }

    /// One object.
    pub fn json(&self) -> Value {
        json!({
            "library": self.library.display().to_string(),
            "version": self.version,
            "seconds": self.took.as_secs_f64(),
        })
    }
}

/// The denoiser that is asked for, if there is a picture for it among the outputs: what cannot be denoised is told before
/// anything is rendered.
pub fn prepare(
    args: &DenoiseArgs,
    outputs: &[Output],
    threads: Option<u16>,
) -> Result<Option<Denoiser>, Failure> {
    if !args.denoise || outputs.iter().all(|output| output.kind == Kind::Film) {
        return Ok(None);
    }
    let variable = || env::var_os(VARIABLE).filter(|value| !value.is_empty()).map(PathBuf::from);
    let library = args.oidn_library.clone().or_else(variable);
    let search = Search { library, python_prefixes: python_prefixes(&|name| env::var_os(name)), threads };
    search.run().map(Some).map_err(|error| Failure::File(explain(&error)))
}

fn explain(error: &LoadError) -> String {
    let way = match error {
        LoadError::NotFound { .. } => {
            ". Get it by `pip install pyoidn`, or from https://www.openimagedenoise.org, and if it is in no usual place, \
             name its library with --oidn-library or in NEPHROID_OIDN_LIBRARY"
        }
        _ => "",
    };
    format!("--denoise: {error}{way}")
}

/// [Applies](apply) a denoiser if there is one. Gives what it did, or why it could not.
pub fn try_to(denoiser: Option<&Denoiser>, picture: &mut Picture) -> (Option<Denoised>, Option<String>) {
    match denoiser.map(|denoiser| apply(denoiser, picture)) {
        None => (None, None),
        Some(Ok(denoised)) => (Some(denoised), None),
        Some(Err(trouble)) => (None, Some(trouble)),
    }
}

/// Puts the denoised picture in the place of what was rendered, which it keeps beside. If that fails, the picture is as it was.
fn apply(denoiser: &Denoiser, picture: &mut Picture) -> Result<Denoised, String> {
    let begun = Instant::now();
    let image = &picture.image;
    let color: Vec<f32> = image.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
    let [albedo, normal] = GUIDES.map(|aov| layers::values(&picture.layers, aov));
    let noisy = nephroid_denoise::Picture {
        width: image.width,
        height: image.height,
        color: &color,
        albedo: albedo.as_deref(),
        normal: normal.as_deref(),
    };
    let found = denoiser.denoise(&noisy).map_err(|error| {
        format!("--denoise: the pictures are as they were rendered, for they cannot be denoised: {error}")
    })?;
    let mut denoised = image.clone();
    for (pixel, numbers) in denoised.pixels.iter_mut().zip(found.chunks_exact(3)) {
        *pixel = Rgb::new(numbers[0], numbers[1], numbers[2]);
    }
    picture.noisy = Some(std::mem::replace(&mut picture.image, denoised));
    Ok(Denoised { library: denoiser.file().to_owned(), version: denoiser.version(), took: begun.elapsed() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_lacks_the_library_is_told_how_to_get_it() {
        let text = explain(&LoadError::NotFound { refused: Vec::new() });
        assert!(
            text.starts_with("--denoise: Open Image Denoise 2 is not found. Get it by `pip install pyoidn`")
        );
        let refused = vec![LoadError::NoFile("a".into())];
        let text = explain(&LoadError::NotFound { refused });
        assert!(text.contains("is not found (a: there is no such library). Get it"), "{text}");
        assert_eq!(explain(&LoadError::NoFile("a".into())), "--denoise: a: there is no such library");
    }
}
