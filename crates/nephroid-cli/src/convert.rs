//! `nephroid convert`: a scene as a file of Mitsuba 3.

use std::path::Path;

use nephroid_formats::mitsuba_writer::{folder_of_files, write_mitsuba};

use crate::args::ConvertArgs;
use crate::console;
use crate::exit::{Exit, Failure};
use crate::load;

/// Reads the scene and writes it anew.
pub fn run(args: &ConvertArgs) -> Result<Exit, Failure> {
    let out = &args.output;
    if !out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("xml")) {
        return Err(Failure::Usage(format!(
            "{}: scenes are written as .xml files of Mitsuba 3 only",
            out.display()
        )));
    }
    let file = load::load(&args.scene, &args.reading, false)?;
    for warning in &file.warnings {
        console::diagnostic(warning);
    }
    let folder = out.parent().unwrap_or(Path::new("")).join(folder_of_files(out));
    let taken = [out.as_path(), &folder].into_iter().find(|path| path.symlink_metadata().is_ok());
    if let (Some(taken), false) = (taken, args.overwrite) {
        return Err(Failure::File(format!("{}: exists; --overwrite writes over it", taken.display())));
    }
    let written = write_mitsuba(out, &file).map_err(|error| Failure::File(error.to_string()))?;
    for warning in &written.warnings {
        console::say(&format!("warning: {warning}"));
    }
    let replaced = if taken.is_some() { ", in place of what was there" } else { "" };
    let beside = match written.files.len() {
        0 => String::new(),
        1 => format!(" and a file in {}", folder.display()),
        n => format!(" and {n} files in {}", folder.display()),
    };
    console::say(&format!("wrote {}{beside}{replaced}", out.display()));
    Ok(Exit::Done)
}
