use std::cell::RefCell;
use std::path::Path;

use crate::diagnostic::{Diagnostic, Location, Severity};
use crate::mesh::{MeshError, MeshFile};

/// Nobody reads more messages than this.
const MAX_MESSAGES: usize = 500;

/// Collects messages while a scene is read, so that one reading shows all mistakes.
#[derive(Default)]
pub(crate) struct Log {
    list: RefCell<Vec<Diagnostic>>,
}

impl Log {
    pub(crate) fn push(&self, diagnostic: Diagnostic) {
        let mut list = self.list.borrow_mut();
        // What is wrong with a value once is not worth saying twice, as it would be of an undefined
        // parameter that is no number either. Several things can be wrong with an element.
        let is_value = |l: &Location| !l.text().starts_with('<');
        let known = |d: &Diagnostic| is_error(d) && d.location == diagnostic.location;
        if diagnostic.location.as_ref().is_some_and(is_value) && list.iter().any(known) {
            return;
        }
        if list.len() < MAX_MESSAGES && !list.contains(&diagnostic) {
            list.push(diagnostic);
        } else if diagnostic.severity == Severity::Error && !list.iter().any(is_error) {
            // A scene must not pass because its warnings have filled the list.
            list.push(diagnostic);
        }
    }

    pub(crate) fn error(&self, at: &Location, message: impl Into<String>) {
        self.push(Diagnostic::error(at, message));
    }

    pub(crate) fn warn(&self, at: &Location, message: impl Into<String>) {
        self.push(Diagnostic::warning(at, message));
    }

    /// Says that something that a format has is not built yet, so that it is left out: an error unless the caller is
    /// lenient.
    pub(crate) fn left_out(&self, at: &Location, what: &str, lenient: bool) {
        if lenient {
            self.warn(at, format!("{what} cannot be rendered yet and is left out"));
        } else {
            let message = Diagnostic::error(at, format!("{what} cannot be rendered yet"));
            self.push(message.hint("--lenient leaves it out"));
        }
    }

    /// Says what is wrong with a mesh that was read from a file. One without any area is only left out.
    pub(crate) fn mesh(
        &self,
        at: &Location,
        path: &Path,
        read: Result<MeshFile, MeshError>,
    ) -> Option<MeshFile> {
        match read {
            Ok(file) => {
                self.degenerate(at, &path.display().to_string(), file.degenerate);
                Some(file)
            }
            Err(error) => {
                let line = error.line.map(|line| format!(":{line}")).unwrap_or_default();
                let message = format!("{}{line}: {}", path.display(), error.message);
                if error.is_flat {
                    self.warn(at, format!("{message}, and it is left out"));
                } else {
                    self.error(at, message);
                }
                None
            }
        }
    }

    /// Says how many triangles of a mesh are left out, if any.
    pub(crate) fn degenerate(&self, at: &Location, name: &str, count: usize) {
        if count > 0 {
            let triangles = if count == 1 { "triangle" } else { "triangles" };
            self.warn(at, format!("{name}: left out {count} {triangles} without area"));
        }
    }

    pub(crate) fn has_errors(&self) -> bool {
        self.list.borrow().iter().any(is_error)
    }

    pub(crate) fn into_list(self) -> Vec<Diagnostic> {
        self.list.into_inner()
    }
}

fn is_error(diagnostic: &Diagnostic) -> bool {
    diagnostic.severity == Severity::Error
}

/// At most 40 characters of a text, for messages.
pub(crate) fn shortened(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_string(),
    }
}
