//! `nephroid resume`: on with a render that was interrupted, to its planned end or beyond.

use std::path::Path;

use nephroid_formats::image::check_writable;

use crate::args::RenderArgs;
use crate::exit::{Exit, Failure};
use crate::films;
use crate::render;
use crate::session_args::ResumeArgs;

/// Goes on with what a film file keeps.
pub fn run(args: &ResumeArgs) -> Result<Exit, Failure> {
    let name = args.file.display();
    let begun = films::read_to_go_on(&args.file)?;
    check_writable(&args.file).map_err(|e| Failure::File(e.to_string()))?;
    let flags = begun.job.args().map_err(|error| {
        Failure::File(format!("{name}: does not say how to go on; it is of another version: {error}"))
    })?;
    let outputs = if args.outputs.is_empty() {
        // What is gone on with is kept in its file, be that a checkpoint or an output of the render.
        let of_job = begun.job.outputs.iter().map(|output| begun.job.named_from_here(output));
        of_job.filter(|output| !is_same(output, &args.file)).collect()
    } else {
        args.outputs.clone()
    };
    render::go(&of_this_run(flags, args), &outputs, Some((begun, &args.limits.into())))
}

/// The flags of the job, where those of this run do not take their place.
fn of_this_run(mut flags: RenderArgs, args: &ResumeArgs) -> RenderArgs {
    flags.session.checkpoint = Some(args.file.clone());
    (flags.threads, flags.quiet, flags.json) = (args.threads, args.quiet, args.json);
    flags.watch = args.watch.clone();
    flags.denoise.denoise = args.denoise.denoise || (flags.denoise.denoise && !args.no_denoise);
    flags.denoise.oidn_library = args.denoise.oidn_library.clone().or(flags.denoise.oidn_library);
    flags
}

/// Whether two names are of one file.
fn is_same(one: &Path, other: &Path) -> bool {
    one == other || one.canonicalize().is_ok_and(|one| other.canonicalize().is_ok_and(|other| one == other))
}
