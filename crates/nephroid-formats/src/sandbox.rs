//! Files of one folder and of none besides, for scenes of people who are not trusted.

use std::io;
use std::path::{Component, Path, PathBuf};

use thiserror::Error;

use crate::vfs::{DiskFiles, Files, normalized};

/// The file system as far as it lies in a folder. Whatever a name leads to, by `..`, from the root or through
/// links, it is read in that folder or not at all.
///
/// A scene alone cannot get around it. Who can write into the folder while it is read could exchange a file for a
/// link between the check and the reading.
#[derive(Clone, Debug)]
pub struct SandboxFiles {
    /// Without links.
    folder: PathBuf,
}

/// Why [`SandboxFiles`] do not read a file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("it is outside of the sandbox, the folder \"{}\"", folder.display())]
pub struct OutsideSandbox {
    /// What may be read.
    pub folder: PathBuf,
}

impl OutsideSandbox {
    /// Whether that is what an error says.
    pub fn is(error: &io::Error) -> bool {
        error.get_ref().and_then(|inner| inner.downcast_ref::<Self>()).is_some()
    }
}

impl SandboxFiles {
    /// The files in a folder that exists, and in the folders in it.
    ///
    /// # Errors
    ///
    /// That it cannot be found, or is not a folder.
    pub fn new(folder: &Path) -> io::Result<Self> {
        // The parent of a bare name is the current folder.
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let folder = folder.canonicalize()?;
        if !folder.is_dir() {
            return Err(io::Error::new(io::ErrorKind::NotADirectory, "is not a folder"));
        }
        Ok(Self { folder })
    }

    fn refused(&self) -> io::Error {
        io::Error::new(io::ErrorKind::PermissionDenied, OutsideSandbox { folder: self.folder.clone() })
    }

    /// Whether a file that does not exist would be in the folder. Outside it is refused all the same, lest scenes
    /// find out what there is.
    fn would_be_inside(&self, path: &Path) -> bool {
        let Ok(absolute) = std::path::absolute(path) else { return false };
        let mut folder = absolute.as_path();
        while let Some(parent) = folder.parent() {
            if let Ok(real) = parent.canonicalize() {
                let rest = absolute.strip_prefix(parent).unwrap_or(Path::new(""));
                let whole = normalized(&real.join(rest));
                let climbs = whole.components().any(|part| part == Component::ParentDir);
                return !climbs && whole.starts_with(&self.folder);
            }
            folder = parent;
        }
        false
    }
}

impl Files for SandboxFiles {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        match path.canonicalize() {
            Ok(real) if real.starts_with(&self.folder) => DiskFiles.read(&real),
            Ok(_) => Err(self.refused()),
            Err(error) if self.would_be_inside(path) => Err(error),
            Err(_) => Err(self.refused()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// A folder `in` with a file `a`, and a file `secret` beside it.
    fn place() -> (tempfile::TempDir, SandboxFiles) {
        let place = tempfile::tempdir().unwrap();
        fs::create_dir_all(place.path().join("in/deep")).unwrap();
        fs::write(place.path().join("in/a"), "a").unwrap();
        fs::write(place.path().join("secret"), "s").unwrap();
        let files = SandboxFiles::new(&place.path().join("in")).unwrap();
        (place, files)
    }

    #[test]
    fn what_is_inside_is_read_and_what_is_outside_is_not() {
        let (place, files) = place();
        let read = |name: &str| files.read(&place.path().join(name));
        for inside in ["in/a", "in/./deep/../a", "in/../in/a"] {
            assert_eq!(read(inside).unwrap(), b"a", "{inside}");
        }
        for outside in ["secret", "in/../secret", "in/deep/../../secret", "/etc/passwd", "in/..", ""] {
            assert!(OutsideSandbox::is(&read(outside).unwrap_err()), "{outside}");
        }
        let message = read("secret").unwrap_err().to_string();
        let folder = place.path().join("in").canonicalize().unwrap();
        assert_eq!(message, format!("it is outside of the sandbox, the folder \"{}\"", folder.display()));
    }

    #[test]
    fn what_is_missing_is_told_inside_only() {
        let (place, files) = place();
        let read = |name: &str| files.read(&place.path().join(name)).unwrap_err();
        for inside in ["in/b", "in/none/b", "in/none/../b", "none/../in/b"] {
            assert_eq!(read(inside).kind(), io::ErrorKind::NotFound, "{inside}");
        }
        for outside in ["b", "none/b", "in/none/../../b", "/no/such/place"] {
            assert!(OutsideSandbox::is(&read(outside)), "{outside}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_are_what_they_lead_to() {
        use std::os::unix::fs::symlink;
        let (place, files) = place();
        let at = |name: &str| place.path().join(name);
        symlink("../secret", at("in/out")).unwrap();
        symlink(place.path(), at("in/up")).unwrap();
        symlink("deep/../a", at("in/again")).unwrap();
        symlink("in", at("door")).unwrap();
        symlink("../nothing", at("in/dangling")).unwrap();
        for inside in ["in/again", "door/a", "in/up/in/a"] {
            assert_eq!(files.read(&at(inside)).unwrap(), b"a", "{inside}");
        }
        for outside in ["in/out", "in/up/secret", "door/up/secret"] {
            assert!(OutsideSandbox::is(&files.read(&at(outside)).unwrap_err()), "{outside}");
        }
        // A link to nothing tells nothing.
        assert!(files.read(&at("in/dangling")).is_err());
        // A folder may be named by a link.
        let door = SandboxFiles::new(&at("door")).unwrap();
        assert_eq!(door.read(&at("in/a")).unwrap(), b"a");
        assert!(SandboxFiles::new(&at("secret")).is_err() && SandboxFiles::new(&at("none")).is_err());
    }
}
