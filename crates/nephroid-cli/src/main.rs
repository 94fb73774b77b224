//! The command `nephroid`: reads scenes, renders them and writes pictures.

mod args;
mod builtin;
mod checkpoint;
mod compare;
mod console;
mod convert;
mod denoise;
mod exit;
mod fault;
mod films;
mod identity;
mod info;
mod info_media;
mod inspect;
mod inspect_json;
mod inspect_text;
mod job;
mod lab_args;
mod layers;
mod load;
mod loading;
mod media_flags;
mod merge;
mod method;
mod noise;
mod numbers;
mod output;
mod parameters;
mod photons;
mod plan;
mod plan_json;
mod preview;
mod progress;
mod quality;
mod render;
mod rendering;
mod report;
mod resume;
mod scenes;
mod session_args;
mod study;
mod study_watch;
mod tev;
mod tonemap;
mod values;
mod view;

use std::process::ExitCode;

use crate::args::Command;
use crate::exit::{Exit, Failure};

fn main() -> ExitCode {
    let command = args::parse();
    fault::guard(move || match run(&command) {
        Ok(exit) => exit,
        Err(failure) => failure.report(),
    })
    .into()
}

fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::Render(args) => render::run(args),
        Command::Resume(args) => resume::run(args),
        Command::Merge(args) => merge::run(args),
        Command::Scenes(args) => scenes::run(args),
        Command::Tonemap(args) => tonemap::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Convert(args) => convert::run(args),
        Command::Info(args) => info::run(args),
        Command::Photons(args) => photons::run(args),
        Command::Inspect(args) => inspect::run(args),
        Command::Study(args) => study::run(args),
    }
}
