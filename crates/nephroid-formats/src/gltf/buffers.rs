//! Buffers and the views of them, read when they are first needed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::item::Item;
use super::uri::{self, Target};
use crate::log::shortened;
use crate::vfs::Files;

/// The bytes that a document refers to.
pub(super) struct Buffers<'d> {
    files: &'d dyn Files,
    folder: PathBuf,
    binary: Option<Rc<[u8]>>,
    loaded: BTreeMap<usize, Option<Rc<[u8]>>>,
}

/// A part of a buffer.
#[derive(Clone)]
pub(super) struct View {
    buffer: Rc<[u8]>,
    start: usize,
    end: usize,
    /// Bytes from one element to the next, if that is more than it takes.
    pub(super) stride: Option<usize>,
}

impl View {
    pub(super) fn bytes(&self) -> &[u8] {
        &self.buffer[self.start..self.end]
    }
}

impl<'d> Buffers<'d> {
    /// `binary` is the buffer in the file itself, and `path` the file.
    pub(super) fn new(files: &'d dyn Files, path: &Path, binary: Option<Vec<u8>>) -> Self {
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        Self { files, folder, binary: binary.map(Rc::from), loaded: BTreeMap::new() }
    }

    /// The view that a member of `item` refers to. `None` if the log says why.
    pub(super) fn view(&mut self, item: Item<'d>, name: &str) -> Option<View> {
        let (_, view) = item.refers(name, "bufferViews")?;
        for packed in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
            if view.extension(packed).is_some() {
                view.error(format!("the view is compressed ({packed}), which is not read"));
                return None;
            }
        }
        let Some((index, buffer)) = view.refers("buffer", "buffers") else {
            if !view.has("buffer") {
                view.error("the view names no buffer");
            }
            return None;
        };
        let bytes = self.buffer(index, buffer)?;
        let start = view.whole("byteOffset").unwrap_or(0);
        let Some(length) = view.whole("byteLength") else {
            if !view.has("byteLength") {
                view.error("the view has no \"byteLength\"");
            }
            return None;
        };
        let Some(end) = start.checked_add(length).filter(|end| *end <= bytes.len()) else {
            view.error(format!(
                "the view of {length} bytes from byte {start} reaches beyond its buffer of {}",
                bytes.len()
            ));
            return None;
        };
        let stride = view.whole("byteStride").filter(|stride| *stride > 0);
        Some(View { buffer: bytes, start, end, stride })
    }

    fn buffer(&mut self, index: usize, buffer: Item<'d>) -> Option<Rc<[u8]>> {
        if let Some(known) = self.loaded.get(&index) {
            return known.clone();
        }
        let bytes = self.load(index, buffer);
        self.loaded.insert(index, bytes.clone());
        bytes
    }

    fn load(&self, index: usize, buffer: Item<'d>) -> Option<Rc<[u8]>> {
        let bytes: Rc<[u8]> = match (buffer.get("uri"), &self.binary) {
            (None, Some(binary)) if index == 0 => Rc::clone(binary),
            (None, _) => {
                buffer.error("the buffer has no \"uri\", and is not in the file itself");
                return None;
            }
            (Some(uri), _) => self.read(uri)?.into(),
        };
        // A buffer may be padded, and then is longer than it says.
        match buffer.whole("byteLength") {
            Some(length) if length > bytes.len() => {
                buffer.error(format!("the buffer has {} bytes and should have {length}", bytes.len()));
                None
            }
            _ => Some(bytes),
        }
    }

    /// The bytes of a `uri`. `None` if the log says why.
    pub(super) fn read(&self, uri: Item<'d>) -> Option<Vec<u8>> {
        let Some(text) = uri.as_text() else {
            uri.error("\"uri\" must be a text");
            return None;
        };
        let name = match uri::resolve(text) {
            Ok(Target::Data(bytes)) => return Some(bytes),
            Ok(Target::File(name)) => name,
            Err(problem) => {
                uri.error(format!("the uri \"{}\" {problem}", shortened(text)));
                return None;
            }
        };
        if name.is_empty() || name.contains('\0') {
            uri.error("the uri names no file");
            return None;
        }
        match self.read_file(&name, text) {
            Ok(bytes) => Some(bytes),
            Err(error) => {
                uri.error(format!("cannot read \"{}\": {error}", shortened(&name)));
                None
            }
        }
    }

    /// Files by their name, with slashes for backslashes, and, where a name was not meant to be decoded, as it is written.
    fn read_file(&self, name: &str, written: &str) -> std::io::Result<Vec<u8>> {
        let first = self.files.read(&self.folder.join(name));
        match first {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                [name.replace('\\', "/").as_str(), written]
                    .into_iter()
                    .filter(|other| *other != name)
                    .find_map(|other| self.files.read(&self.folder.join(other)).ok())
                    .ok_or(error)
            }
            other => other,
        }
    }
}
