//! `nephroid scenes`: the built-in scenes.

use std::path::Path;

use nephroid_formats::diagnostic::closest;

use crate::args::ScenesArgs;
use crate::builtin::{self, SCENES};
use crate::console;
use crate::exit::{Exit, Failure};

/// Lists the built-in scenes, or prints the file of one.
pub fn run(args: &ScenesArgs) -> Result<Exit, Failure> {
    match &args.name {
        Some(name) => match builtin::find(name) {
            Some(scene) => {
                if let Some(folder) = &args.files {
                    write_files(scene, folder)?;
                }
                console::result(scene.text)?;
            }
            None => return Err(Failure::Usage(unknown(name))),
        },
        None => {
            let width = SCENES.iter().map(|s| s.name.len()).max().unwrap_or(0);
            let line = |s: &builtin::BuiltinScene| format!("{:width$}  {}\n", s.name, s.description());
            console::result(&SCENES.iter().map(line).collect::<String>())?;
        }
    }
    Ok(Exit::Done)
}

/// Writes what a scene reads beside its own file, under the names that it uses.
fn write_files(scene: &builtin::BuiltinScene, folder: &Path) -> Result<(), Failure> {
    for (name, bytes) in scene.files {
        let path = folder.join(name);
        let told = |error| Failure::File(format!("{}: cannot be written: {error}", path.display()));
        std::fs::write(&path, bytes).map_err(told)?;
    }
    Ok(())
}

/// The message for a name that no built-in scene has.
pub fn unknown(name: &str) -> String {
    let message = format!("there is no built-in scene \"{name}\"");
    match closest(name, SCENES.iter().map(|s| s.name)) {
        Some(near) => format!("{message}; did you mean \"{near}\"?"),
        None => format!("{message}; `nephroid scenes` lists them"),
    }
}
