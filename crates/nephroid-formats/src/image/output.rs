use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::{ImageError, ImageProblem};

/// Tells whether a file could be written at `path` now, by making and removing a temporary file
/// beside it. Nothing that exists is touched.
pub fn check_writable(path: &Path) -> Result<(), ImageError> {
    named(path, || Target::of(path)?.temporary_file().map(drop))
}

/// Writes a file whole or not at all: into a temporary file in the same folder, which then takes
/// the place of `path`. A link is followed, and permissions of a file that is replaced are kept.
pub fn write_atomically(
    path: &Path,
    contents: impl FnOnce() -> Result<Vec<u8>, ImageProblem>,
) -> Result<(), ImageError> {
    named(path, || {
        let target = Target::of(path)?;
        let bytes = contents()?;
        target.replace(|file| file.write_all(&bytes))
    })
}

/// [`write_atomically`] for contents that are not in memory: `fill` writes them.
pub fn stream_atomically(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> Result<(), ImageError> {
    named(path, || {
        Target::of(path)?.replace(|file| {
            let mut buffer = BufWriter::with_capacity(1 << 17, file.as_file());
            fill(&mut buffer)?;
            buffer.flush()
        })
    })
}

fn named<T>(path: &Path, f: impl FnOnce() -> Result<T, ImageProblem>) -> Result<T, ImageError> {
    f().map_err(|problem| ImageError { path: path.to_owned(), problem })
}

/// Where a file is to be written.
struct Target {
    file: PathBuf,
    folder: PathBuf,
}

impl Target {
    fn of(path: &Path) -> Result<Self, ImageProblem> {
        let file = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if let Ok(metadata) = fs::metadata(&file) {
            if !metadata.is_file() {
                return Err(ImageProblem::NotAFile);
            }
            if metadata.permissions().readonly() {
                return Err(ImageProblem::ReadOnly);
            }
        }
        let folder = match (file.file_name(), file.parent()) {
            (None, _) | (_, None) => return Err(ImageProblem::NotAFile),
            (_, Some(folder)) if folder.as_os_str().is_empty() => PathBuf::from("."),
            (_, Some(folder)) => folder.to_owned(),
        };
        if !folder.is_dir() {
            return Err(ImageProblem::NoFolder { folder });
        }
        Ok(Self { file, folder })
    }

    fn replace(&self, fill: impl FnOnce(&mut NamedTempFile) -> io::Result<()>) -> Result<(), ImageProblem> {
        let mut file = self.temporary_file()?;
        if let Ok(metadata) = fs::metadata(&self.file) {
            file.as_file().set_permissions(metadata.permissions()).map_err(ImageProblem::Write)?;
        }
        fill(&mut file).map_err(ImageProblem::Write)?;
        file.as_file().sync_all().map_err(ImageProblem::Write)?;
        file.persist(&self.file).map_err(|e| ImageProblem::Write(e.error))?;
        self.keep_name();
        Ok(())
    }

    /// Has the folder's new entry outlive a loss of power, where folders can be opened. The file is in its place
    /// already, so where this fails nothing is to be told.
    fn keep_name(&self) {
        #[cfg(unix)]
        if let Ok(folder) = File::open(&self.folder) {
            let _ = folder.sync_all();
        }
    }

    fn temporary_file(&self) -> Result<NamedTempFile, ImageProblem> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".nephroid-");
        // Temporary files are private unless told otherwise; this one becomes an ordinary one.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        builder.tempfile_in(&self.folder).map_err(ImageProblem::Write)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let names = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        names.collect()
    }

    #[test]
    fn files_are_written_and_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        check_writable(&path).unwrap();
        assert!(names(folder.path()).is_empty());
        write_atomically(&path, || Ok(vec![1])).unwrap();
        check_writable(&path).unwrap();
        write_atomically(&path, || Ok(vec![2, 3])).unwrap();
        assert_eq!(fs::read(&path).unwrap(), [2, 3]);
        assert_eq!(names(folder.path()), ["a.bin"]);
    }

    #[test]
    fn a_failure_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        fs::write(&path, [1]).unwrap();
        write_atomically(&path, || Err(ImageProblem::NoPixels)).unwrap_err();
        assert_eq!(fs::read(&path).unwrap(), [1]);
        assert_eq!(names(folder.path()), ["a.bin"]);
    }

    #[test]
    fn impossible_places_are_told_beforehand() {
        let folder = tempfile::tempdir().unwrap();
        let problem = |path: &Path| {
            let error = check_writable(path).unwrap_err();
            assert_eq!(error.path, path);
            error.problem
        };
        assert!(matches!(problem(folder.path()), ImageProblem::NotAFile));
        let nowhere = folder.path().join("missing").join("a.exr");
        assert!(matches!(problem(&nowhere), ImageProblem::NoFolder { .. }));
        let protected = folder.path().join("a.exr");
        fs::write(&protected, []).unwrap();
        let mut permissions = fs::metadata(&protected).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&protected, permissions).unwrap();
        assert!(matches!(problem(&protected), ImageProblem::ReadOnly));
        assert!(matches!(problem(Path::new("")), ImageProblem::NotAFile));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_files_are_ordinary() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("a"), folder.path().join("b"));
        write_atomically(&path, || Ok(vec![1])).unwrap();
        let plain = folder.path().join("c");
        fs::write(&plain, []).unwrap();
        let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&plain));
        symlink(&path, &link).unwrap();
        write_atomically(&link, || Ok(vec![2])).unwrap();
        assert_eq!(fs::read(&path).unwrap(), [2]);
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }
}
