//! Where the library may be.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use crate::{Denoiser, LoadError};

/// What the library's file is called, the version that is needed first.
const NAMES: &[&str] = if cfg!(target_os = "windows") {
    &["OpenImageDenoise.dll"]
} else if cfg!(target_os = "macos") {
    &["libOpenImageDenoise.2.dylib", "libOpenImageDenoise.dylib"]
} else {
    &["libOpenImageDenoise.so.2", "libOpenImageDenoise.so"]
};

/// Where Python's package `pyoidn` has it, in `site-packages`.
const PACKAGE: &str = if cfg!(target_os = "windows") { "pyoidn/oidn/bin" } else { "pyoidn/oidn/lib" };

/// Where to look for the library, and how to use it.
#[derive(Clone, Debug, Default)]
pub struct Search {
    /// The library's file, or a folder with it in it or in its `lib` or `bin`: nothing else is tried then.
    pub library: Option<PathBuf>,
    /// Folders that Python may be installed in, such as `/usr/local`: those above each `bin`. Tried after what the
    /// system's linker finds.
    pub python_prefixes: Vec<PathBuf>,
    /// Threads it may use; else it takes one for each core.
    pub threads: Option<u16>,
}

impl Search {
    /// Loads the first library that works.
    pub fn run(&self) -> Result<Denoiser, LoadError> {
        if let Some(library) = &self.library {
            return Denoiser::load(&named(library)?, self.threads);
        }
        let mut refused = Vec::new();
        // Of a name without a folder the system does not tell what is not there from what does not work.
        for name in NAMES {
            match Denoiser::load(Path::new(name), self.threads) {
                Ok(denoiser) => return Ok(denoiser),
                Err(LoadError::NotLoaded { .. }) => {}
                Err(other) => refused.push(other),
            }
        }
        for file in self.python_prefixes.iter().flat_map(|prefix| of_python(prefix)) {
            match Denoiser::load(&file, self.threads) {
                Ok(denoiser) => return Ok(denoiser),
                Err(other) => refused.push(other),
            }
        }
        Err(LoadError::NotFound { refused })
    }
}

/// Folders that Python may be installed in, as far as variables of the environment tell, for
/// [`Search::python_prefixes`]. `variable` gives their values.
pub fn python_prefixes(variable: &dyn Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    let folder = |name: &str| variable(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let below = |folder: Option<PathBuf>, name: &str| folder.map(|folder| folder.join(name));
    let mut prefixes: Vec<PathBuf> = ["VIRTUAL_ENV", "CONDA_PREFIX"].into_iter().filter_map(folder).collect();
    let path = variable("PATH").unwrap_or_default();
    prefixes.extend(env::split_paths(&path).filter_map(|bin| bin.parent().map(Path::to_owned)));
    prefixes.extend(below(folder("HOME"), ".local"));
    // Where each version of Python has a folder of its own.
    let families = [
        below(folder("PYENV_ROOT").or_else(|| below(folder("HOME"), ".pyenv")), "versions"),
        below(folder("HOME"), "Library/Python"),
        below(folder("APPDATA"), "Python"),
        below(folder("LOCALAPPDATA"), "Programs/Python"),
    ];
    for family in families.into_iter().flatten() {
        let mut versions: Vec<PathBuf> =
            family.read_dir().into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path())).collect();
        versions.sort();
        prefixes.extend(versions.into_iter().rev());
    }
    let mut known = Vec::new();
    prefixes.retain(|prefix| {
        let is_new = prefix.is_absolute() && !known.contains(prefix);
        known.push(prefix.clone());
        is_new
    });
    prefixes
}

/// The file that was named, or that is in the folder that was.
fn named(path: &Path) -> Result<PathBuf, LoadError> {
    // Of a name without a folder the system would not look in the current one.
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let inside = ["", "lib", "bin"].iter().flat_map(|folder| in_folder(&path.join(folder)));
    match path.is_dir() {
        true => inside.into_iter().next().ok_or(LoadError::NoFile(path)),
        false if path.exists() => Ok(path),
        false => Err(LoadError::NoFile(path)),
    }
}

/// The library's file in a folder.
fn in_folder(folder: &Path) -> Option<PathBuf> {
    NAMES.iter().map(|name| folder.join(name)).find(|file| file.is_file())
}

/// Files of the packages of each Python that is installed below a prefix, the latest version of Python first.
fn of_python(prefix: &Path) -> Vec<PathBuf> {
    // Of all systems: on Windows they are not below a folder with the version's name.
    let mut libraries = vec![prefix.join("Lib")];
    for folder in ["lib", "lib64", "local/lib"] {
        let mut versions: Vec<PathBuf> = fs::read_dir(prefix.join(folder))
            .into_iter()
            .flatten()
            .filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|path| path.file_name().is_some_and(|n| n.to_string_lossy().starts_with("python")))
            .collect();
        // 3.9 comes before 3.12, and both behind what has no number.
        versions.sort_by_key(|path| {
            let name = path.to_string_lossy();
            std::cmp::Reverse(name.rsplit('.').next().and_then(|minor| minor.parse::<u32>().ok()))
        });
        libraries.extend(versions);
    }
    let packages =
        libraries.iter().flat_map(|folder| ["site-packages", "dist-packages"].map(|n| folder.join(n)));
    packages.filter_map(|packages| in_folder(&packages.join(PACKAGE))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn install(prefix: &Path, below: &str) -> PathBuf {
        let folder = prefix.join(below).join(PACKAGE);
        fs::create_dir_all(&folder).unwrap();
        let file = folder.join(NAMES[0]);
        fs::write(&file, "no library").unwrap();
        file
    }

    #[test]
    fn packages_of_python_are_found_the_latest_first() {
        let prefix = tempfile::tempdir().unwrap();
        assert_eq!(of_python(prefix.path()), [""; 0].map(PathBuf::from));
        let old = install(prefix.path(), "lib/python3.9/site-packages");
        let new = install(prefix.path(), "lib/python3.12/site-packages");
        let system = install(prefix.path(), "lib/python3/dist-packages");
        fs::create_dir_all(prefix.path().join("lib/python3.13/site-packages")).unwrap();
        assert_eq!(of_python(prefix.path()), [new, old, system]);
    }

    #[test]
    fn a_folder_may_stand_for_its_file() {
        let folder = tempfile::tempdir().unwrap();
        assert!(matches!(named(folder.path()), Err(LoadError::NoFile(_))));
        assert!(matches!(named(&folder.path().join("none")), Err(LoadError::NoFile(_))));
        fs::create_dir(folder.path().join("lib")).unwrap();
        let file = folder.path().join("lib").join(NAMES[0]);
        fs::write(&file, "no library").unwrap();
        assert_eq!(named(folder.path()).unwrap(), file);
        assert_eq!(named(&file).unwrap(), file);
    }

    #[cfg(unix)]
    #[test]
    fn pythons_are_where_the_environment_says() {
        let home = tempfile::tempdir().unwrap();
        let path = |name: &str| home.path().join(name);
        for version in ["3.9", "3.12"] {
            fs::create_dir_all(path(".pyenv/versions").join(version)).unwrap();
        }
        let variable = |name: &str| match name {
            "PATH" => Some("/usr/local/bin:/usr/bin:/usr/sbin::relative/bin".into()),
            "VIRTUAL_ENV" => Some("/venv".into()),
            "CONDA_PREFIX" => Some("".into()),
            "HOME" => Some(home.path().into()),
            _ => None,
        };
        let expected = ["/venv".into(), "/usr/local".into(), "/usr".into(), path(".local")];
        let pyenv = [path(".pyenv/versions/3.9"), path(".pyenv/versions/3.12")];
        assert_eq!(python_prefixes(&variable), [&expected[..], &pyenv].concat());
        assert_eq!(python_prefixes(&|_| None), [""; 0].map(PathBuf::from));
    }
}
