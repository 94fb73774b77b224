//! Finding a scene's files and turning them into text.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::diagnostic::{Location, Source};
use crate::log::{Log, shortened};
use crate::sandbox::OutsideSandbox;
use crate::vfs::Files;

/// Bytes of text in one scene.
pub(crate) const MAX_BYTES: usize = 256 << 20;

/// The path and bytes of a file named in a scene: an absolute one, or the first in the folders that may be
/// read.
pub(crate) fn find(
    files: &dyn Files,
    folders: &[PathBuf],
    name: &str,
) -> std::io::Result<(PathBuf, Vec<u8>)> {
    use std::io::{Error, ErrorKind};
    if name.is_empty() {
        return Err(Error::new(ErrorKind::InvalidInput, "the name is empty"));
    }
    if name.contains('\0') {
        return Err(Error::new(ErrorKind::InvalidInput, "the name holds a zero byte"));
    }
    let mut refused = None;
    for folder in folders {
        // Scenes made on Windows write backslashes.
        for spelling in [name.to_string(), name.replace('\\', "/")] {
            let path = folder.join(spelling);
            match files.read(&path) {
                Ok(bytes) => return Ok((path, bytes)),
                Err(error) if error.kind() == ErrorKind::NotFound => {}
                // It may stand in a folder that is not refused.
                Err(error) if OutsideSandbox::is(&error) => refused = Some(error),
                Err(error) => return Err(error),
            }
        }
    }
    if let Some(error) = refused {
        return Err(error);
    }
    let first = folders.first().map_or(Path::new(""), PathBuf::as_path);
    let first = if first.as_os_str().is_empty() { Path::new(".") } else { first };
    let more = match folders.len() {
        0 | 1 => String::new(),
        n => format!(" and {} more", n - 1),
    };
    Err(Error::new(ErrorKind::NotFound, format!("no such file in {}{more}", first.display())))
}

/// The same, and to the log why there is none.
pub(crate) fn read_named(
    files: &dyn Files,
    folders: &[PathBuf],
    name: &str,
    at: &Location,
    log: &Log,
) -> Option<(PathBuf, Vec<u8>)> {
    find(files, folders, name)
        .map_err(|error| log.error(at, format!("cannot read \"{}\": {error}", shortened(name))))
        .ok()
}

/// The text of a file, without a byte order mark.
pub(crate) fn decode(
    name: &str,
    bytes: Vec<u8>,
    included_at: Option<&Location>,
    log: &Log,
) -> Option<Arc<Source>> {
    let fail = |message: &str| {
        let at = match included_at {
            Some(at) => at.clone(),
            None => Location::new(&Source::new(name, ""), 0..0),
        };
        log.error(&at, message);
        None
    };
    if bytes.len() > MAX_BYTES {
        return fail(&format!("\"{name}\" is larger than {} MiB", MAX_BYTES >> 20));
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return fail(&format!("\"{name}\" is UTF-16; save it as UTF-8"));
    }
    match String::from_utf8(bytes) {
        Ok(text) => {
            let text = text.strip_prefix('\u{feff}').map(str::to_string).unwrap_or(text);
            Some(Source::new(name, text))
        }
        Err(error) => {
            let place = error.utf8_error().valid_up_to();
            let line = 1 + error.as_bytes()[..place].iter().filter(|b| **b == b'\n').count();
            fail(&format!("\"{name}\" is not UTF-8: line {line} holds an invalid byte"))
        }
    }
}
