//! Faults of the program itself.

use std::backtrace::{Backtrace, BacktraceStatus};
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::sync::{Arc, Mutex, PoisonError};

use crate::console;
use crate::exit::Exit;

/// Runs the command; a panic in it becomes a short message and [`Exit::Fault`].
///
/// The hook only takes notes, because some panics are caught on the way: decoders of images may
/// panic on damaged files, which is reported as the fault of the file.
pub fn guard(command: impl FnOnce() -> Exit) -> Exit {
    let last = Arc::new(Mutex::new(String::new()));
    let notes = Arc::clone(&last);
    panic::set_hook(Box::new(move |info| {
        *notes.lock().unwrap_or_else(PoisonError::into_inner) = describe(info);
    }));
    panic::catch_unwind(AssertUnwindSafe(command)).unwrap_or_else(|_| {
        let what = last.lock().unwrap_or_else(PoisonError::into_inner);
        console::error(&format!("nephroid {} is at fault itself: {what}", env!("CARGO_PKG_VERSION")));
        console::say("Please report this, with the command line and the scene.");
        Exit::Fault
    })
}

fn describe(info: &PanicHookInfo<'_>) -> String {
    let payload = info.payload();
    let message = payload
        .downcast_ref::<&str>()
        .map(|s| (*s).to_owned())
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no reason is known".to_owned());
    let place = info.location().map(|l| format!(" ({}:{})", l.file(), l.line())).unwrap_or_default();
    let backtrace = Backtrace::capture();
    match backtrace.status() {
        BacktraceStatus::Captured => format!("{message}{place}\n{backtrace}"),
        _ => format!("{message}{place}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_ends_with_its_own_code() {
        assert_eq!(guard(|| Exit::Done), Exit::Done);
        assert_eq!(guard(|| panic!("on purpose")), Exit::Fault);
        // The hook is the process's: other tests want the usual one.
        drop(panic::take_hook());
    }
}
