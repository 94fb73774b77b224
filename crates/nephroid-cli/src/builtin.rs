//! Scenes that are part of the program.

use std::io;
use std::path::Path;

use nephroid_formats::vfs::{Files, normalized};

/// A scene that can be rendered by its name from any folder.
#[derive(Clone, Copy, Debug)]
pub struct BuiltinScene {
    /// Its name.
    pub name: &'static str,
    /// Its file.
    pub text: &'static str,
    /// The files that stand beside it: their names and their bytes.
    pub files: &'static [(&'static str, &'static [u8])],
}

/// What is rendered if no scene is named.
pub const DEFAULT: &str = "cornell";

macro_rules! scene {
    ($name:literal $(, $file:literal)*) => {
        BuiltinScene {
            name: $name,
            text: include_str!(concat!("../../../scenes/", $name, ".xml")),
            files: &[$(($file, include_bytes!(concat!("../../../scenes/", $file)))),*],
        }
    };
}

/// Every built-in scene, in the order in which they are listed.
pub const SCENES: &[BuiltinScene] = &[
    scene!("cornell"),
    scene!("nephroid"),
    scene!("fog"),
    scene!("fog-forward"),
    scene!("fog-backward"),
    scene!("smoke", "smoke.vol"),
    scene!("balls-area"),
    scene!("balls-point"),
    scene!("shell"),
    scene!("pool", "pool.ply"),
    scene!("shaft"),
    scene!("room"),
    scene!("keyhole"),
    scene!("bulb"),
    scene!("window"),
    scene!("prism", "prism.ply"),
    scene!("report-2-2a"),
    scene!("report-2-2b"),
    scene!("report-2-3"),
    scene!("report-2-4a"),
    scene!("report-2-4b"),
    scene!("report-2-5a"),
    scene!("report-2-5b"),
    scene!("report-2-6"),
    scene!("report-2-7"),
    scene!("report-2-8"),
    scene!("report-2-9"),
    scene!("report-2-10"),
    scene!("report-2-11"),
    scene!("report-2-12"),
    scene!("report-2-13"),
    scene!("report-2-14"),
    scene!("report-3-6"),
    scene!("report-3-7"),
    scene!("report-3-8"),
    scene!("report-3-9"),
    scene!("report-3-12"),
];

/// The scene of that name.
pub fn find(name: &str) -> Option<&'static BuiltinScene> {
    SCENES.iter().find(|scene| scene.name == name)
}

impl BuiltinScene {
    /// What it shows: the first comment of its file, `<!-- name: what it shows -->`.
    pub fn description(&self) -> &'static str {
        let comment = self.text.split_once("<!--").and_then(|(_, rest)| rest.split_once("-->"));
        let comment = comment.map_or("", |(comment, _)| comment.trim());
        comment.strip_prefix(self.name).and_then(|rest| rest.strip_prefix(':')).map_or("", str::trim)
    }
}

/// What a built-in scene may read.
pub struct BuiltinFiles<'a> {
    /// Whose own files come first.
    pub scene: &'a BuiltinScene,
    /// Where others are: a parameter may name one.
    pub disk: &'a dyn Files,
}

impl Files for BuiltinFiles<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let path = normalized(path);
        match self.scene.files.iter().find(|(name, _)| path == Path::new(name)) {
            Some((_, bytes)) => Ok(bytes.to_vec()),
            None => self.disk.read(&path),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::Path;

    #[test]
    fn the_list_is_the_folder() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let files: BTreeSet<String> = files
            .filter(|path| path.extension().is_some_and(|e| e == "xml"))
            .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
            .collect();
        let list: BTreeSet<String> = SCENES.iter().map(|scene| scene.name.to_owned()).collect();
        assert_eq!(list, files);
        assert_eq!(list.len(), SCENES.len());
        assert!(find(DEFAULT).is_some());
    }

    #[test]
    fn every_scene_says_in_one_line_what_it_shows() {
        for scene in SCENES {
            let description = scene.description();
            assert!(description.len() > 10 && !description.contains('\n'), "{}: {description:?}", scene.name);
        }
    }
}
