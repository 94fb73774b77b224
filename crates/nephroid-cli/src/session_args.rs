//! The flags of renders that are interrupted, shared out and put together again, and watched.

use std::path::PathBuf;

use clap::Args;

use crate::args::{DisplayArgs, LimitArgs, percentage, seconds};
use crate::denoise::DenoiseArgs;

/// Passes A, …, B−1 of a render, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PassRange {
    /// The first of them.
    pub begin: u64,
    /// The first that is not among them.
    pub end: u64,
}

/// No pass has this number or a greater one in `--pass-range`.
const LAST_PASS: u64 = 1 << 32;

/// Where a render is kept to go on with.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Sessions")]
pub struct SessionArgs {
    /// Render the passes A, …, B−1 only, counted from 0 to at most 2^32, of what the other flags describe; for -o FILE.film
    #[arg(long, value_name = "A..B", value_parser = pass_range)]
    pub pass_range: Option<PassRange>,
    /// Keep the render in this file while it runs; `nephroid resume` goes on with it
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Write it every so often [default: 5, and at least a hundred times what writing takes]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, requires = "checkpoint")]
    pub checkpoint_every: Option<f64>,
}

/// Where a picture is shown while it is rendered.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Watching")]
pub struct WatchArgs {
    /// Write the picture so far to this .png while it is rendered
    #[arg(long, value_name = "FILE")]
    pub preview: Option<PathBuf>,
    /// Write it every so often, where that takes less than a tenth of the time
    #[arg(long, value_name = "SECONDS", default_value_t = 2.0, value_parser = seconds, requires = "preview")]
    pub preview_every: f64,
    /// Show the picture so far in the viewer tev [default: 127.0.0.1:14158]
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, default_missing_value = "127.0.0.1:14158",
          value_parser = address)]
    pub tev: Option<String>,
}

/// `nephroid resume`.
#[derive(Args, Debug)]
pub struct ResumeArgs {
    /// The film file of a render: a checkpoint, or what was written with -o FILE.film. What is rendered is kept in it
    pub file: PathBuf,
    /// A file to write: .exr, .png or .film; may be repeated [default: those of the render]
    #[arg(short, long = "output", value_name = "FILE")]
    pub outputs: Vec<PathBuf>,
    /// Threads to work with [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// No progress, notes and statistics
    #[arg(long)]
    pub quiet: bool,
    /// Print one JSON object about the render to the standard output
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub limits: FurtherArgs,
    #[command(flatten)]
    pub watch: WatchArgs,
    #[command(flatten)]
    pub denoise: DenoiseArgs,
    /// Write the pictures as they are rendered, even if the render was to denoise them
    #[arg(long, conflicts_with = "denoise", help_heading = "Denoising")]
    pub no_denoise: bool,
}

/// Another end than the one planned.
#[derive(Args, Clone, Copy, Debug, Default)]
#[command(next_help_heading = "When to stop, instead of where the render was to")]
pub struct FurtherArgs {
    /// Camera samples of each pixel in all, from the beginning of the render
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    pub spp: Option<u32>,
    /// Passes in all, from the beginning of the render
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub passes: Option<u64>,
    /// Seconds from now; where the render was finished, beyond its end
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub time: Option<f64>,
    /// The error of the picture that it states itself; where the render was finished, beyond its end
    #[arg(long, value_name = "PERCENT", value_parser = percentage)]
    pub target_error: Option<f64>,
}

impl From<FurtherArgs> for LimitArgs {
    fn from(FurtherArgs { spp, passes, time, target_error }: FurtherArgs) -> Self {
        Self { spp, passes, time, target_error }
    }
}

/// `nephroid merge`.
#[derive(Args, Debug)]
pub struct MergeArgs {
    /// Film files of parts of one render
    #[arg(value_name = "FILM", required = true)]
    pub parts: Vec<PathBuf>,
    /// A file to write: .exr or .png for a picture, .film for the sum of the parts; may be repeated
    #[arg(short, long = "output", value_name = "FILE", required = true)]
    pub outputs: Vec<PathBuf>,
    /// Write nothing, and end with code 4, where passes are missing
    #[arg(long)]
    pub complete: bool,
    /// No notes
    #[arg(long)]
    pub quiet: bool,
    /// Print one JSON object about the film to the standard output
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub display: DisplayArgs,
    #[command(flatten)]
    pub denoise: DenoiseArgs,
}

fn pass_range(text: &str) -> Result<PassRange, String> {
    let expected = "write A..B for the passes A, …, B−1, counted from 0";
    let (begin, end) = text.split_once("..").ok_or(expected)?;
    let number = |text: &str| {
        let digits = text.bytes().all(|byte| byte.is_ascii_digit());
        if digits { text.parse::<u64>().ok() } else { None }
    };
    let (Some(begin), Some(end)) = (number(begin), number(end)) else { return Err(expected.to_owned()) };
    if end > LAST_PASS {
        return Err(format!("passes are counted up to {LAST_PASS}"));
    }
    if begin < end { Ok(PassRange { begin, end }) } else { Err(format!("there are no passes: {expected}")) }
}

/// A name is looked up when it is called: whether it is known changes from hour to hour and with the machine.
fn address(text: &str) -> Result<String, String> {
    match text.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok() => Ok(text.to_owned()),
        _ => Err("write HOST:PORT, as in 127.0.0.1:14158".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_passes() {
        assert_eq!(pass_range("0..1"), Ok(PassRange { begin: 0, end: 1 }));
        assert_eq!(pass_range("7..12"), Ok(PassRange { begin: 7, end: 12 }));
        assert!(pass_range("0..4294967296").is_ok());
        for bad in ["", "..", "3", "3..", "..3", "3..3", "4..3", "-1..3", "+1..2", "0..=3", "0..4294967297"] {
            assert!(pass_range(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn viewers_have_an_address_and_a_port() {
        for good in ["127.0.0.1:14158", "[::1]:14158", "no-such-name.invalid:1"] {
            assert_eq!(address(good).as_deref(), Ok(good));
        }
        for bad in ["127.0.0.1", "scene.xml", ":", ":14158", "localhost:", "127.0.0.1:x"] {
            assert!(address(bad).is_err(), "{bad}");
        }
    }
}
