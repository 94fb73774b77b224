//! Finished sections in the folder, so that a study that was stopped goes on where it was.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::body::Body;
use crate::format;
use crate::study::Trouble;

/// All that a section depends on: what is kept under another key is made anew.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Key {
    /// What computes: a version, or a fingerprint of it.
    pub program: String,
    /// Whether small pictures would do.
    pub quick: bool,
    /// Of the random numbers.
    pub seed: u64,
}

/// A section that was run to its end.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Finished {
    /// What it was made with.
    pub key: Key,
    /// Of the section.
    pub id: String,
    /// How long it took, in seconds.
    pub seconds: f64,
    /// What it found.
    pub body: Body,
}

impl Finished {
    /// How long it took, as people read it.
    pub fn seconds_text(&self) -> String {
        format::number(self.seconds)
    }
}

/// The folder in which sections are kept.
pub struct Keeper {
    folder: PathBuf,
    key: Key,
}

impl Keeper {
    /// Makes the folder `sections` where there is none.
    pub fn new(folder: &Path, key: Key) -> Result<Self, Trouble> {
        let folder = folder.join("sections");
        fs::create_dir_all(&folder).map_err(|error| Trouble::file(&folder, error))?;
        Ok(Self { folder, key })
    }

    /// What was kept of a section; none if there is none of this key, or it is damaged.
    pub fn load(&self, id: &str) -> Option<Finished> {
        let text = fs::read_to_string(self.folder.join(format!("{id}.json"))).ok()?;
        let mut finished: Finished = serde_json::from_str(&text).ok()?;
        if finished.key != self.key || finished.id != id {
            return None;
        }
        for picture in finished.body.pictures_mut() {
            let own = picture.file.starts_with(id) && !picture.file.contains(['/', '\\']);
            picture.png = own.then(|| fs::read(self.folder.join(&picture.file)).ok()).flatten()?;
        }
        Some(finished)
    }

    /// Keeps a section: first its pictures, and what names them last, each of them whole or not at all.
    pub fn save(&self, id: &str, seconds: f64, mut body: Body) -> Result<Finished, Trouble> {
        for (number, picture) in body.pictures_mut().enumerate() {
            picture.file = format!("{id}-{}.png", number + 1);
            write_whole(&self.folder.join(&picture.file), &picture.png)?;
        }
        let finished = Finished { key: self.key.clone(), id: id.to_owned(), seconds, body };
        let path = self.folder.join(format!("{id}.json"));
        let text = serde_json::to_string_pretty(&finished).map_err(|error| Trouble::file(&path, error))?;
        write_whole(&path, text.as_bytes())?;
        Ok(finished)
    }
}

/// Writes a file that appears whole or not at all.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Trouble> {
    let write = || -> std::io::Result<()> {
        let folder = path.parent().unwrap_or(Path::new("."));
        let mut file = tempfile::Builder::new().prefix(".nephroid-").tempfile_in(folder)?;
        file.write_all(bytes)?;
        file.persist(path)?;
        Ok(())
    };
    write().map_err(|error| Trouble::file(path, error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Number;
    use crate::picture::{Look, Picture};
    use nephroid::color::Rgb;
    use nephroid::texture::Image;

    #[test]
    fn what_is_kept_comes_back_unless_something_changed() {
        let folder = tempfile::tempdir().unwrap();
        let key = Key { program: "1".to_owned(), quick: true, seed: 3 };
        let keeper = Keeper::new(folder.path(), key.clone()).unwrap();
        let mut body = Body::new();
        body.say("words");
        let image = Image::filled(2, 2, Rgb::WHITE);
        body.picture(Picture::new(&image, &Look::exposed(0.0), "alt", "caption").unwrap());
        body.numbers(vec![Number::within("n", 0.1 + 0.2, "W", [0.0, f64::MAX], "why")]);
        assert!(keeper.load("fig-1").is_none());
        let saved = keeper.save("fig-1", 1.5, body).unwrap();
        assert_eq!(keeper.load("fig-1"), Some(saved));
        for other in [Key { seed: 4, ..key.clone() }, Key { quick: false, ..key.clone() }] {
            assert!(Keeper::new(folder.path(), other).unwrap().load("fig-1").is_none());
        }
        fs::remove_file(folder.path().join("sections/fig-1-1.png")).unwrap();
        assert!(keeper.load("fig-1").is_none());
    }
}
