//! The files of a scene: the first, and those that it includes.

use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use super::reader::Reader;
use super::{MAX_DEPTH, MAX_FILES};
use crate::diagnostic::{Diagnostic, Location, Source};
use crate::log::{Log, shortened};
use crate::open::{MAX_BYTES, decode};
use crate::vfs::normalized;

/// The bytes of a file, unpacked if it is called `.gz`.
pub(super) fn inflated(path: &Path, bytes: Vec<u8>, at: &Location, log: &Log) -> Option<Vec<u8>> {
    if path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("gz")) {
        return Some(bytes);
    }
    let fail = |reason: String| {
        log.error(at, format!("cannot unpack \"{}\": {reason}", path.display()));
        None
    };
    let mut out = Vec::new();
    // Some hundred bytes can stand for as many megabytes.
    match flate2::read::MultiGzDecoder::new(bytes.as_slice()).take(MAX_BYTES as u64 + 1).read_to_end(&mut out)
    {
        Ok(_) if out.len() > MAX_BYTES => fail(format!("it is larger than {} MiB", MAX_BYTES >> 20)),
        Ok(_) => Some(out),
        Err(error) => fail(error.to_string()),
    }
}

impl Reader<'_> {
    /// Reads the scene from its first file.
    pub(super) fn whole(&mut self, path: &Path, source: Arc<Source>) {
        self.folders = vec![folder_of(path)];
        self.open.push(normalized(path));
        self.bytes_left = self.bytes_left.saturating_sub(source.text().len());
        let start = Location::new(&source, 0..0);
        self.obey(source);
        self.close(&start);
    }

    /// Reads a file in the place of the directive that names it.
    pub(super) fn include(&mut self, name: &str, at: &Location) {
        if self.open.len() >= MAX_DEPTH {
            self.log.error(at, format!("files are included more than {MAX_DEPTH} deep"));
            return;
        }
        if self.files_left == 0 {
            self.log.error(at, format!("more than {MAX_FILES} files are included"));
            return;
        }
        self.files_left -= 1;
        let Some((path, bytes)) = self.read_file(name, at) else { return };
        let path = normalized(&path);
        if self.open.contains(&path) {
            let message = format!("\"{}\" includes itself", shortened(name));
            self.log.push(Diagnostic::error(at, message));
            return;
        }
        let Some(bytes) = inflated(&path, bytes, at, self.log) else { return };
        if bytes.len() > self.bytes_left {
            self.log.error(at, format!("the files of the scene are larger than {} MiB", MAX_BYTES >> 20));
            return;
        }
        self.bytes_left -= bytes.len();
        let Some(source) = decode(&path.display().to_string(), bytes, Some(at), self.log) else { return };
        let folders = self.folders.clone();
        let own = folder_of(&path);
        self.folders.truncate(1);
        if self.folders[0] != own {
            self.folders.push(own);
        }
        self.open.push(path);
        self.obey(source);
        self.open.pop();
        self.folders = folders;
    }
}

fn folder_of(path: &Path) -> std::path::PathBuf {
    path.parent().map(Path::to_path_buf).unwrap_or_default()
}
