//! Denoised pictures, by the library that the command `nephroid` would find.

use std::env;
use std::path::PathBuf;

use nephroid::color::Rgb;
use nephroid::film::Aov;
use nephroid::session::Session;
use nephroid::texture::Image;
use nephroid_denoise::{Denoiser, Picture, Search, python_prefixes};

/// What the denoiser is told of each pixel, which sessions are asked to keep.
pub const GUIDES: [Aov; 2] = [Aov::Albedo, Aov::Normal];

/// The denoiser, or why there is none.
pub fn find() -> Result<Denoiser, String> {
    let library = env::var_os("NEPHROID_OIDN_LIBRARY").filter(|value| !value.is_empty()).map(PathBuf::from);
    let search =
        Search { library, python_prefixes: python_prefixes(&|name| env::var_os(name)), threads: Some(1) };
    search.run().map_err(|error| error.to_string())
}

/// The picture so far of a session that keeps [`GUIDES`], denoised.
pub fn denoised(denoiser: &Denoiser, session: &Session<'_>) -> Result<Image, String> {
    let mut image = session.film().develop();
    let color: Vec<f32> = image.pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
    let [albedo, normal] = GUIDES.map(|aov| {
        let channels = session.aovs()?.develop(aov)?.channels;
        Some((0..image.pixels.len()).flat_map(|i| channels.iter().map(move |c| c[i])).collect::<Vec<f32>>())
    });
    let picture = Picture {
        width: image.width,
        height: image.height,
        color: &color,
        albedo: albedo.as_deref(),
        normal: normal.as_deref(),
    };
    let found = denoiser.denoise(&picture).map_err(|error| error.to_string())?;
    for (pixel, numbers) in image.pixels.iter_mut().zip(found.chunks_exact(3)) {
        *pixel = Rgb::new(numbers[0], numbers[1], numbers[2]);
    }
    Ok(image)
}
