use std::cell::RefCell;

use crate::diagnostic::{Diagnostic, Location, Severity};

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
