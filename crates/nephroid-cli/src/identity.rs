//! What a film is of: everything that changes its pixels, so that only parts of one render are added up.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use nephroid::film::FilmSettings;
use nephroid::session::{RenderPlan, RenderSettings};
use nephroid_formats::vfs::Files;
use serde_json::Value;

use crate::args::SceneArgs;
use crate::layers::LayerPlan;
use crate::method;
use crate::plan_json;

/// Names with values, in the order in which they are told.
pub type Identity = Vec<(String, String)>;

/// Files that take a fingerprint of each that they hand out.
pub struct RecordingFiles<'a> {
    files: &'a dyn Files,
    seen: Mutex<BTreeMap<PathBuf, String>>,
}

impl<'a> RecordingFiles<'a> {
    /// Hands out these files.
    pub fn new(files: &'a dyn Files) -> Self {
        Self { files, seen: Mutex::default() }
    }

    /// Fingerprints of what was read: of `scene`, if it was, and of the others, by the names they have from its folder, so
    /// that a folder with all in it may be moved.
    pub fn fingerprints(self, scene: &Path) -> Identity {
        let mut seen = self.seen.into_inner().unwrap_or_else(PoisonError::into_inner);
        let main = seen.remove(scene).map(|hash| ("scene".to_owned(), hash));
        // One of them may be named from the root, and the other from the current folder.
        let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let folder = absolute(scene).parent().map(Path::to_owned).unwrap_or_default();
        let name = |path: PathBuf| absolute(&path).strip_prefix(&folder).map_or(path, Path::to_owned);
        let others = seen.into_iter().map(|(path, hash)| (format!("file {}", name(path).display()), hash));
        main.into_iter().chain(others).collect()
    }
}

impl Files for RecordingFiles<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let bytes = self.files.read(path)?;
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        seen.insert(path.to_owned(), fingerprint(&bytes));
        Ok(bytes)
    }
}

/// The BLAKE3 hash of bytes.
pub fn fingerprint(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// The identity of a render, without [its plan](with_plan). `files` are the fingerprints of the scene and of all it reads.
pub fn of_render(
    files: &Identity,
    reading: &SceneArgs,
    film: &FilmSettings,
    settings: &RenderSettings,
    clamp: Option<f32>,
    layers: &[LayerPlan],
) -> Identity {
    let mut out: Identity = Vec::new();
    // Nobody sees that an empty list is one.
    let mut add = |name: &str, value: String| {
        let value = if value.is_empty() { "none".to_owned() } else { value };
        out.push((name.to_owned(), value));
    };
    add("renderer", format!("nephroid {}", env!("CARGO_PKG_VERSION")));
    // Pictures are the same bits whatever instructions a machine has.
    add("instructions", "portable".to_owned());
    for (name, hash) in files {
        add(name, hash.clone());
    }
    let defines: BTreeMap<&str, &str> =
        reading.defines.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
    for (name, value) in defines {
        add(&format!("-D {name}"), value.to_owned());
    }
    add("--lenient", reading.lenient.to_string());
    for (name, value) in reading.view.identity() {
        add(name, value);
    }
    add("resolution", format!("{}x{}", film.width, film.height));
    if let Some(crop) = film.crop {
        add("crop", format!("{}x{} at {},{}", crop.width, crop.height, crop.x, crop.y));
    }
    if let Value::Object(method) = method::describe(&settings.method) {
        for (name, value) in method {
            // Of parameters of another integrator it need not be told that they differ.
            let parameter = || format!("integrator {}", name.replace('_', " "));
            let name = if name == "name" { "integrator".to_owned() } else { parameter() };
            add(&name, plain(&value));
        }
    }
    // A progressive render plans them itself.
    if !settings.method.is_progressive() {
        add("samples per pass", settings.samples_per_pixel.to_string());
    }
    add("seed", settings.seed.to_string());
    if let Some(clamp) = clamp {
        add("--clamp", clamp.to_string());
    }
    let mut aovs: Vec<_> = layers.iter().map(|layer| layer.aov).collect();
    aovs.sort_unstable();
    aovs.dedup();
    add("layers", aovs.iter().map(|aov| aov.name()).collect::<Vec<_>>().join(","));
    out
}

/// The identity with what the render decided before its first pass.
pub fn with_plan(mut identity: Identity, plan: &RenderPlan) -> Identity {
    identity.extend(plan_json::entries(plan));
    identity
}

/// The identity but for what a render decides itself: that follows from the rest.
pub fn without_plan(identity: &[(String, String)]) -> Identity {
    identity.iter().filter(|(name, _)| !name.starts_with(plan_json::ENTRIES)).cloned().collect()
}

fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid_formats::vfs::MemoryFiles;

    #[test]
    fn what_is_read_leaves_a_fingerprint() {
        let files = MemoryFiles::default().with("a/s.xml", "scene").with("a/m.ply", "mesh");
        let files = files.with("b.png", "image");
        let recording = RecordingFiles::new(&files);
        for path in ["a/s.xml", "a/m.ply", "a/m.ply", "b.png"] {
            recording.read(Path::new(path)).unwrap();
        }
        assert!(recording.read(Path::new("none")).is_err());
        let seen = recording.fingerprints(Path::new("a/s.xml"));
        let expected = [("scene", "scene"), ("file m.ply", "mesh"), ("file b.png", "image")];
        let expected = expected.map(|(name, text)| (name.to_owned(), fingerprint(text.as_bytes())));
        assert_eq!(seen, expected);
        assert_ne!(fingerprint(b"mesh"), fingerprint(b"mesi"));
    }

    #[test]
    fn names_are_those_in_the_folder_however_it_is_named() {
        let mesh = std::path::absolute("a/m.ply").unwrap();
        let files = MemoryFiles::default().with("a/s.xml", "scene").with(&mesh, "mesh");
        let recording = RecordingFiles::new(&files);
        recording.read(&mesh).unwrap();
        let seen = recording.fingerprints(Path::new("a/s.xml"));
        assert_eq!(seen, [("file m.ply".to_owned(), fingerprint(b"mesh"))]);
    }
}
