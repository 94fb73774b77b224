//! `nephroid tonemap`: a picture for a display from one of radiances.

use nephroid_formats::image::{check_writable, write_png};

use crate::args::TonemapArgs;
use crate::exit::{Exit, Failure};
use crate::output::{Kind, Output, read};

/// Develops one file into another.
pub fn run(args: &TonemapArgs) -> Result<Exit, Failure> {
    let output = Output::of_kind(&args.output, Kind::Png)?;
    check_writable(&output.path).map_err(|e| Failure::File(e.to_string()))?;
    let picture = args.operator.apply(&read(&args.image)?, args.exposure);
    write_png(&output.path, &picture).map_err(|e| Failure::File(e.to_string()))?;
    Ok(Exit::Done)
}
