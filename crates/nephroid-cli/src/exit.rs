//! How the command ends: the exit code says whose fault it was.

use std::process::ExitCode;

use nephroid_formats::diagnostic::Diagnostics;

use crate::console;

/// The exit codes. A usage error that `clap` finds ends with 2, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All was done.
    Done = 0,
    /// The command line makes no sense.
    Usage = 2,
    /// The scene cannot be rendered.
    Scene = 3,
    /// A file cannot be read or written.
    File = 4,
    /// A number of the study lies outside of its band.
    Band = 5,
    /// The program is wrong.
    Fault = 70,
    /// Stopped by Ctrl-C.
    Stopped = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Why the command could not do what it was told.
#[derive(Debug)]
pub enum Failure {
    /// The command line makes no sense.
    Usage(String),
    /// The scene cannot be rendered.
    Scene(Diagnostics),
    /// A file cannot be read or written.
    File(String),
    /// A study did not find what it should.
    Study(String),
}

impl Failure {
    /// All that could not be written, if there is any.
    pub fn of_files(trouble: Vec<String>) -> Option<Self> {
        (!trouble.is_empty()).then(|| Self::File(trouble.join("\nerror: ")))
    }

    /// Tells the user, and gives the code to end with.
    pub fn report(&self) -> Exit {
        match self {
            Self::Usage(message) => {
                console::error(message);
                Exit::Usage
            }
            Self::Scene(diagnostics) => {
                for diagnostic in &diagnostics.0 {
                    console::diagnostic(diagnostic);
                }
                Exit::Scene
            }
            Self::File(message) => {
                console::error(message);
                Exit::File
            }
            Self::Study(message) => {
                console::error(message);
                Exit::Band
            }
        }
    }
}
