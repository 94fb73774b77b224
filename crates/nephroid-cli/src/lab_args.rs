//! The flags of the commands that look into a render.

use std::path::PathBuf;

use clap::Args;
use nephroid::integrator::MapName;
use nephroid::laboratory::PhotonColor;
use nephroid_formats::diagnostic::closest;

use crate::args::{SceneArgs, resolution};
use crate::method::Integrator;
use crate::parameters::PhotonFlags;

/// `nephroid photons`.
#[derive(Args, Debug)]
pub struct PhotonsArgs {
    /// A scene file, or the name of a built-in scene
    pub scene: PathBuf,
    /// A file to write, .png (a picture of them), .ply or .csv (each of them); may be repeated
    /// [default: SCENE-photons.png in the current folder]
    #[arg(short, long = "output", value_name = "FILE")]
    pub outputs: Vec<PathBuf>,
    /// What colours tell in the picture: map, bounce, light, power
    #[arg(long, value_name = "WHAT", default_value = "map", value_parser = color)]
    pub color: PhotonColor,
    /// Maps whose photons to take: global, caustic, afterglow, haze, volume, volume-caustic
    #[arg(long, value_name = "MAP,…", value_delimiter = ',', default_value = "global,caustic", value_parser = map)]
    pub maps: Vec<MapName>,
    /// Diameter of a photon in the picture, in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub size: u32,
    /// Draw photons that surfaces hide, too
    #[arg(long)]
    pub through_walls: bool,
    /// Which pass of a render they are of, from 0
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub iteration: u64,
    #[command(flatten)]
    pub run: RunArgs,
}

/// `nephroid inspect`.
#[derive(Args, Debug)]
pub struct InspectArgs {
    /// A scene file, or the name of a built-in scene
    pub scene: PathBuf,
    /// Column and row in the picture, from 0 at its upper left corner
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    pub pixel: (u32, u32),
    /// Tell of one sample only, and of each of its gather rays; from 0, counted through all passes
    #[arg(long, value_name = "N")]
    pub sample: Option<usize>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// photonmapper, ppm, auto (of photon maps), path (surfaces only), volpath, or scene for the one the scene asks for
    #[arg(long, value_name = "NAME", value_parser = Integrator::parse)]
    pub integrator: Option<Integrator>,
    /// Camera samples of each pixel, in all, as of the render
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    pub spp: Option<u32>,
    /// Passes, as of the render
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub passes: Option<u64>,
    #[command(flatten)]
    pub run: RunArgs,
}

/// What both have in common with `nephroid render`.
#[derive(Args, Debug)]
pub struct RunArgs {
    #[command(flatten)]
    pub reading: SceneArgs,
    /// Size of the picture
    #[arg(long, value_name = "WxH", value_parser = resolution)]
    pub resolution: Option<(u32, u32)>,
    /// Everything random follows from it
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Threads to work with [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// No progress and notes
    #[arg(long)]
    pub quiet: bool,
    #[command(flatten)]
    pub photons: PhotonFlags,
}

fn color(name: &str) -> Result<PhotonColor, String> {
    let colors = [
        ("map", PhotonColor::Map),
        ("bounce", PhotonColor::Bounce),
        ("light", PhotonColor::Light),
        ("power", PhotonColor::Power),
    ];
    let found = colors.iter().find(|(known, _)| *known == name).map(|(_, color)| *color);
    found.ok_or_else(|| unknown(name, "it must be", &colors.map(|(name, _)| name)))
}

fn map(name: &str) -> Result<MapName, String> {
    let found = MapName::ALL.into_iter().find(|map| map.name() == name);
    found.ok_or_else(|| unknown(name, "there is no such map: it must be", &MapName::ALL.map(MapName::name)))
}

/// A message for a name that is none of those known.
pub fn unknown(name: &str, message: &str, known: &[&str]) -> String {
    match closest(name, known.iter().copied()) {
        Some(near) => format!("{message} one of {}; did you mean \"{near}\"?", known.join(", ")),
        None => format!("{message} one of {}", known.join(", ")),
    }
}

fn pixel(text: &str) -> Result<(u32, u32), String> {
    let pixel =
        text.split_once(',').and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    pixel.ok_or_else(|| "write X,Y, the column and row of a pixel, as in 120,64".to_owned())
}
