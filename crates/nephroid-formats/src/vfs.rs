//! Where the bytes of files come from: the disk, or memory in tests and for built-in scenes.

use std::collections::BTreeMap;
use std::io;
use std::path::{Component, Path, PathBuf};

/// A place to read files from.
pub trait Files {
    /// All bytes of a file. `NotFound` means that another folder may be tried.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct DiskFiles;

impl Files for DiskFiles {
    /// Refuses what is not a regular file: a device or a pipe may never end.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let metadata = std::fs::metadata(path)?;
        if metadata.is_dir() {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "is a folder"));
        }
        if !metadata.is_file() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "is not a regular file"));
        }
        std::fs::read(path)
    }
}

/// Files that exist only in memory.
#[derive(Clone, Debug, Default)]
pub struct MemoryFiles {
    files: BTreeMap<PathBuf, Vec<u8>>,
}

impl MemoryFiles {
    /// Adds a file.
    #[must_use]
    pub fn with(mut self, path: impl AsRef<Path>, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.insert(normalized(path.as_ref()), bytes.into());
        self
    }
}

impl Files for MemoryFiles {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.files
            .get(&normalized(path))
            .cloned()
            .ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, "no such file"))
    }
}

/// A path without `.`, and without `..` where a folder's name stands before it. It looks at the
/// text alone, so a link to a folder may make it another file than the system would open.
pub fn normalized(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(out.components().next_back(), Some(Component::Normal(_))) => {
                out.pop();
            }
            other => out.push(other),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_lead_to_the_same_file() {
        let files = MemoryFiles::default().with("a/b.obj", "x");
        assert_eq!(files.read(Path::new("./c/../a/./b.obj")).unwrap(), b"x");
        assert_eq!(files.read(Path::new("b.obj")).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert_eq!(normalized(Path::new("../../a")), Path::new("../../a"));
    }

    #[test]
    fn a_folder_is_not_a_file() {
        assert!(DiskFiles.read(Path::new(".")).is_err());
    }
}
