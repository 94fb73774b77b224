//! Shows which file of a scene is read, and how far its trees are.

use std::io;
use std::path::Path;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use nephroid::observer::{Observer, Phase};
use nephroid_formats::vfs::Files;

/// Watches a scene that is read, or its world that is made.
pub struct Loading {
    bar: ProgressBar,
}

/// How often the display moves, so that a long file is seen to be read.
const TICK: Duration = Duration::from_millis(200);

const READING: &str = "reading  {spinner} {elapsed}  {msg}";
const TREES: &str = "trees    [{bar:30}] {percent:>3} %  {elapsed}";

impl Loading {
    /// Shown where somebody sees it.
    pub fn new(visible: bool) -> Self {
        let target = if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target).with_style(style(READING));
        if visible {
            bar.enable_steady_tick(TICK);
        }
        Self { bar }
    }
}

impl Drop for Loading {
    /// Whatever became of the scene, the display goes.
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Observer for Loading {
    fn begin(&self, _: Phase, work: u64) {
        self.bar.set_style(style(TREES));
        self.bar.set_length(work.max(1));
        self.bar.set_position(0);
    }

    fn advance(&self, _: Phase, done: u64) {
        self.bar.set_position(done);
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("=> ")
}

/// Files that are told of as they are read.
pub struct ToldFiles<'a> {
    files: &'a dyn Files,
    loading: &'a Loading,
}

impl<'a> ToldFiles<'a> {
    /// Hands out these files.
    pub fn new(files: &'a dyn Files, loading: &'a Loading) -> Self {
        Self { files, loading }
    }
}

impl Files for ToldFiles<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.loading.bar.set_message(path.display().to_string());
        self.files.read(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nephroid_formats::vfs::MemoryFiles;

    #[test]
    fn what_is_read_and_built_is_told() {
        let files = MemoryFiles::default().with("a/m.ply", "mesh");
        let loading = Loading::new(false);
        assert_eq!(ToldFiles::new(&files, &loading).read(Path::new("a/m.ply")).unwrap(), b"mesh");
        assert_eq!(loading.bar.message(), "a/m.ply");
        loading.begin(Phase::Trees, 10);
        loading.advance(Phase::Trees, 7);
        assert_eq!((loading.bar.length(), loading.bar.position()), (Some(10), 7));
    }
}
