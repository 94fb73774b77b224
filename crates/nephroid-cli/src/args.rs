//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use nephroid::film::{ImageError, ToneMap};

use crate::denoise::DenoiseArgs;
use crate::lab_args::{InspectArgs, PhotonsArgs};
use crate::layers::{self, LayerFlag};
use crate::method::Integrator;
use crate::parameters::PhotonFlags;
use crate::session_args::{MergeArgs, ResumeArgs, SessionArgs, WatchArgs};
use crate::view::ViewArgs;

/// Photon mapping: renders scenes in the XML of Mitsuba 3, models in glTF 2.0, and meshes (OBJ, PLY).
///
/// Without arguments, renders the built-in scene "cornell" to nephroid.exr and nephroid.png.
#[derive(Debug, Parser)]
#[command(name = "nephroid", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene
    Render(Box<RenderArgs>),
    /// Go on with a render that was interrupted, or add passes to one
    Resume(ResumeArgs),
    /// Put parts of a render together that were rendered apart
    Merge(MergeArgs),
    /// List the built-in scenes, or print the file of one
    Scenes(ScenesArgs),
    /// Make a picture for a display from a file of radiances
    Tonemap(TonemapArgs),
    /// Measure how far a picture is from its reference
    Compare(CompareArgs),
    /// Write a scene as a file of Mitsuba 3
    Convert(ConvertArgs),
    /// Tell what a scene contains
    Info(InfoArgs),
    /// Draw the photons of a scene, or write each of them to a table or a cloud of points
    Photons(Box<PhotonsArgs>),
    /// Tell what the estimate of a pixel saw: surfaces, photon maps, and what they brought
    Inspect(Box<InspectArgs>),
    /// Run the experiments of a report on photon mapping anew, and write a web page of what they show
    Study(StudyArgs),
}

/// Reads the command line; on a mistake in it, or when asked for help, the process ends here.
pub fn parse() -> Command {
    let given: Vec<_> = std::env::args_os().collect();
    let bare = given.len() <= 1;
    let cli = if bare { Cli::parse_from(["nephroid", "render"]) } else { Cli::parse_from(given) };
    cli.command
}

/// The flags of a `render` that were given to another process; `arguments` begin with that word.
pub fn of_render(arguments: &[String]) -> Result<RenderArgs, String> {
    let given = std::iter::once("nephroid").chain(arguments.iter().map(String::as_str));
    match Cli::try_parse_from(given) {
        Ok(Cli { command: Command::Render(args) }) => Ok(*args),
        Ok(_) => Err("it is not of a render".to_owned()),
        Err(error) => Err(error.to_string().lines().next().unwrap_or_default().to_owned()),
    }
}

/// How a scene is read.
#[derive(Args, Debug)]
pub struct SceneArgs {
    /// Set a $parameter of the scene
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = define)]
    pub defines: Vec<(String, String)>,
    /// Leave out what cannot be rendered yet and properties that nobody knows, with a warning each
    #[arg(long)]
    pub lenient: bool,
    #[command(flatten)]
    pub view: ViewArgs,
    /// Read no file outside of this folder, wherever links lead [default: the scene's own folder]
    #[arg(long, value_name = "FOLDER", num_args = 0..=1, require_equals = true)]
    pub sandbox: Option<Option<PathBuf>>,
}

/// `nephroid render`.
#[derive(Args, Debug)]
pub struct RenderArgs {
    /// A scene file, or the name of a built-in scene [default: cornell]
    pub scene: Option<PathBuf>,
    /// A file to write: .exr (radiance), .png (for a display) or .film (exact sums, to go on with or to merge); may
    /// be repeated [default: SCENE.exr and SCENE.png in the current folder]
    #[arg(short, long = "output", value_name = "FILE")]
    pub outputs: Vec<PathBuf>,
    #[command(flatten)]
    pub reading: SceneArgs,
    /// auto (whatever trials find best), photonmapper, ppm (progressive), vcm (paths from both ends), path (surfaces only),
    /// volpath, ptracer (light tracing), or scene for the one the scene asks for [default: the scene's if it is one of the
    /// first four, else auto, or photonmapper where flags ask for photon maps]
    #[arg(long, value_name = "NAME", value_parser = Integrator::parse)]
    pub integrator: Option<Integrator>,
    /// Size of the picture
    #[arg(long, value_name = "WxH", value_parser = resolution)]
    pub resolution: Option<(u32, u32)>,
    /// Everything random follows from it
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Threads to work with [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// No progress, notes and statistics
    #[arg(long)]
    pub quiet: bool,
    /// Print one JSON object about the render to the standard output
    #[arg(long)]
    pub json: bool,
    /// Further layers of .exr files: direct, global, caustic, emitted, medium, albedo, normal, depth,
    /// position, geo_normal, uv, radius, count, error
    #[arg(long = "aov", value_name = "NAME,…", value_delimiter = ',', value_parser = layers::parse)]
    pub aovs: Vec<LayerFlag>,
    /// Cut camera samples down whose largest channel is more than so many W/(m²·sr): takes light away, and says how much
    #[arg(long, value_name = "RADIANCE", value_parser = clamp)]
    pub clamp: Option<f32>,
    #[command(flatten)]
    pub limits: LimitArgs,
    #[command(flatten)]
    pub session: SessionArgs,
    #[command(flatten)]
    pub watch: WatchArgs,
    #[command(flatten)]
    pub display: DisplayArgs,
    #[command(flatten)]
    pub denoise: DenoiseArgs,
    #[command(flatten)]
    pub photons: PhotonFlags,
}

/// When a render is done: at the first of these that is reached.
#[derive(Args, Clone, Copy, Debug, Default)]
#[command(next_help_heading = "When to stop (the first that is reached; else the scene's sample_count)")]
pub struct LimitArgs {
    /// Camera samples of each pixel, in all; ppm and vcm, and auto with them, take whole passes
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    pub spp: Option<u32>,
    /// Passes: photons, and the scene's sample_count of camera samples (with --spp, its share); ppm, vcm and auto decide
    /// how many themselves
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub passes: Option<u64>,
    /// Seconds, from the start of rendering
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time: Option<f64>,
    /// Until the upper end of the 90 % interval of the error that it states is at or below this, as 5% or 5; not with
    /// photonmapper, which cannot tell it
    #[arg(long, value_name = "PERCENT", value_parser = percentage)]
    pub target_error: Option<f64>,
}

/// How a PNG is made from radiance.
#[derive(Args, Debug)]
#[command(next_help_heading = "PNG")]
pub struct DisplayArgs {
    /// Tone mapping: clamp[:VALUE], equalize, equalize-report, equalize-clamp[:VALUE], gamma[:GAMMA],
    /// clamp-gamma[:VALUE[,GAMMA]], reinhard[:KEY[,WHITE]], linear, srgb
    #[arg(long, value_name = "OPERATOR", default_value = "srgb", value_parser = ToneMap::parse)]
    pub tonemap: ToneMap,
    /// Brighten by so many stops first
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true, value_parser = stops)]
    pub exposure: f32,
}

/// `nephroid scenes`.
#[derive(Args, Debug)]
pub struct ScenesArgs {
    /// Print the file of this scene
    pub name: Option<String>,
    /// Write the files that this scene reads into a folder: its grids
    #[arg(long, value_name = "FOLDER", requires = "name")]
    pub files: Option<PathBuf>,
}

/// `nephroid tonemap`.
#[derive(Args, Debug)]
pub struct TonemapArgs {
    /// Radiances: OpenEXR or Radiance HDR
    #[arg(value_name = "IMAGE")]
    pub image: PathBuf,
    /// The picture to write, .png
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// clamp[:VALUE], equalize, equalize-report, equalize-clamp[:VALUE], gamma[:GAMMA],
    /// clamp-gamma[:VALUE[,GAMMA]], reinhard[:KEY[,WHITE]], linear, srgb
    #[arg(long, value_name = "OPERATOR", default_value = "srgb", value_parser = ToneMap::parse)]
    pub operator: ToneMap,
    /// Brighten by so many stops first
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true, value_parser = stops)]
    pub exposure: f32,
}

/// `nephroid compare`.
#[derive(Args, Debug)]
pub struct CompareArgs {
    /// The picture
    #[arg(value_name = "IMAGE")]
    pub image: PathBuf,
    /// What it should be
    #[arg(value_name = "REFERENCE")]
    pub reference: PathBuf,
    /// Draw the difference, .png: red where the picture is brighter, blue where it is darker
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Added to the squared reference that relMSE divides by
    #[arg(long, value_name = "EPSILON", default_value_t = ImageError::EPSILON, value_parser = epsilon)]
    pub epsilon: f64,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `nephroid convert`.
#[derive(Args, Debug)]
pub struct ConvertArgs {
    /// A scene file, or the name of a built-in scene
    pub scene: PathBuf,
    /// The file to write, .xml; what it needs goes into the folder OUT_files beside it
    #[arg(value_name = "OUT")]
    pub output: PathBuf,
    #[command(flatten)]
    pub reading: SceneArgs,
    /// Write over files that exist
    #[arg(long)]
    pub overwrite: bool,
}

/// `nephroid info`.
#[derive(Args, Debug)]
pub struct InfoArgs {
    /// A scene file, or the name of a built-in scene
    pub scene: PathBuf,
    #[command(flatten)]
    pub reading: SceneArgs,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// `nephroid study`.
#[derive(Args, Debug)]
pub struct StudyArgs {
    /// The folder for the page, index.html; sections that are finished are kept in it, and a study that was stopped goes
    /// on with them
    #[arg(short = 'o', long = "output", value_name = "FOLDER", default_value = "nephroid-study")]
    pub folder: PathBuf,
    /// Sections to run, as fig-2-6,question-1-3 [default: all]
    #[arg(long, value_name = "ID,…", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Small pictures and large errors: a test that all of it still holds
    #[arg(long)]
    pub quick: bool,
    /// Everything random follows from it
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Threads to work with [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// No progress and no summary
    #[arg(long)]
    pub quiet: bool,
    /// Print one JSON object with every number, its band and whether it holds
    #[arg(long)]
    pub json: bool,
}

fn define(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value.to_owned())),
        _ => Err("write NAME=VALUE".to_owned()),
    }
}

/// A size in pixels.
pub fn resolution(text: &str) -> Result<(u32, u32), String> {
    let size = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    let (width, height) = size.ok_or("write WIDTHxHEIGHT in pixels, as in 640x480")?;
    let sides = 1..=65_536u32;
    if sides.contains(&width) && sides.contains(&height) {
        Ok((width, height))
    } else {
        Err("each side must be between 1 and 65536".to_owned())
    }
}

/// A length of time.
pub fn seconds(text: &str) -> Result<f64, String> {
    number(text, "write a number of seconds above zero", |s| s > 0.0 && s < 1e9)
}

/// A part of one, in per cent.
pub fn percentage(text: &str) -> Result<f64, String> {
    let digits = text.strip_suffix('%').unwrap_or(text).trim_end();
    number(digits, "write a percentage above zero, as in 5%", |p| p > 0.0 && p.is_finite()).map(|p| p / 100.0)
}

fn clamp(text: &str) -> Result<f32, String> {
    number(text, "write a radiance above zero", |v| v > 0.0 && v < 1e30).map(|v| v as f32)
}

fn epsilon(text: &str) -> Result<f64, String> {
    number(text, "write a number that is not negative", |e| e >= 0.0 && e.is_finite())
}

fn stops(text: &str) -> Result<f32, String> {
    number(text, "write a number between -64 and 64", |s| s.abs() <= 64.0).map(|s| s as f32)
}

fn number(text: &str, expected: &str, accept: impl Fn(f64) -> bool) -> Result<f64, String> {
    text.parse().ok().filter(|&v| accept(v)).ok_or_else(|| expected.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn flags_of_another_process_are_read_as_ours() {
        let words = |text: &str| -> Vec<String> { text.split(' ').map(str::to_owned).collect() };
        let args = of_render(&words("render cornell --photons 77 -o a.film --pass-range 2..3")).unwrap();
        assert!(args.photons.has("photons") && args.session.pass_range.is_some());
        assert_eq!(args.outputs, [PathBuf::from("a.film")]);
        assert!(of_render(&words("scenes")).is_err());
    }

    #[test]
    fn percentages_have_a_sign_or_none() {
        for (text, part) in [("5%", 0.05), ("5", 0.05), ("12.5 %", 0.125), ("0.1", 0.001), ("250%", 2.5)] {
            assert_eq!(percentage(text), Ok(part), "{text}");
        }
        for bad in ["", "%", "0", "0%", "-5%", "5%%", "5 percent", "nan", "inf%", "5,5"] {
            assert_eq!(percentage(bad), Err("write a percentage above zero, as in 5%".to_owned()), "{bad}");
        }
    }

    #[test]
    fn the_help_lists_every_tone_map() {
        let long = ToneMap::USAGE.join(", ");
        let mut cli = Cli::command();
        for name in ["render", "tonemap"] {
            let help = cli.find_subcommand_mut(name).unwrap().render_long_help().to_string();
            let help: String = help.split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(help.contains(&long), "{help}");
        }
    }
}
