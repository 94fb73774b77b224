//! What is printed: results on the standard output, all else on the standard error.

use std::io::{self, IsTerminal, Write};

use nephroid_formats::diagnostic::Diagnostic;

use crate::exit::Failure;

/// Prints a result. A reader that has gone, as in `nephroid scenes | head -1`, is no failure.
pub fn result(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::File(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a line for the user.
pub fn say(line: &str) {
    // There is nobody left to tell if this fails.
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Prints an error.
pub fn error(message: &str) {
    say(&format!("error: {message}"));
}

/// Prints a message about a scene, with the lines it is about.
pub fn diagnostic(diagnostic: &Diagnostic) {
    say(diagnostic.render(has_colour()).trim_end());
}

/// Whether the standard error shows colours; see <https://no-color.org>.
pub fn has_colour() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Messages that do not end the command. Each is printed at once, and kept for `--json`.
#[derive(Debug, Default)]
pub struct Messages {
    quiet: bool,
    /// Every message so far, a line each.
    pub list: Vec<String>,
}

impl Messages {
    /// Without notes if `quiet`.
    pub fn new(quiet: bool) -> Self {
        Self { quiet, list: Vec::new() }
    }

    /// A warning about a scene.
    pub fn diagnostic(&mut self, warning: &Diagnostic) {
        diagnostic(warning);
        self.list.push(warning.to_string());
    }

    /// A warning.
    pub fn warning(&mut self, message: &str) {
        let line = format!("warning: {message}");
        say(&line);
        self.list.push(line);
    }

    /// Errors that are told at the end.
    pub fn errors(&mut self, messages: &[String]) {
        self.list.extend(messages.iter().map(|message| format!("error: {message}")));
    }

    /// Something worth knowing.
    pub fn note(&mut self, message: &str) {
        let line = format!("note: {message}");
        if !self.quiet {
            say(&line);
        }
        self.list.push(line);
    }
}
