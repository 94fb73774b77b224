//! Keeping a render in a file while it runs.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Unless asked for more often, a checkpoint is written at least so far apart …
const LEAST: Duration = Duration::from_secs(5);

/// … and so many times as far apart as the last one took to write: a hundredth of the time.
const SHARE: u32 = 100;

/// The checkpoints of a render.
pub struct Checkpoint {
    path: PathBuf,
    every: Option<Duration>,
    /// When the last one was written, or tried to be, and how long that took.
    last: Instant,
    took: Duration,
    /// The sample before which the last one ends.
    kept: Option<u64>,
    /// Why the last one could not be written.
    trouble: Option<String>,
    /// How long writing took in all.
    pub spent: Duration,
    /// How many were written.
    pub written: u64,
}

impl Checkpoint {
    /// Of a render that begins now, or goes on at the sample that the file `kept`.
    pub fn new(path: &Path, every: Option<f64>, kept: Option<u64>) -> Self {
        Self {
            path: path.to_owned(),
            every: every.map(Duration::from_secs_f64),
            last: Instant::now(),
            took: Duration::ZERO,
            kept,
            trouble: None,
            spent: Duration::ZERO,
            written: 0,
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it is time for the next one.
    pub fn is_due(&self) -> bool {
        self.last.elapsed() >= self.interval()
    }

    fn interval(&self) -> Duration {
        self.every.unwrap_or_else(|| LEAST.max(self.took * SHARE))
    }

    /// Keeps what is rendered up to a sample, unless that is kept already. If that fails for the first time, or for
    /// another reason than before, it is to be told.
    pub fn keep(&mut self, sample: u64, write: impl FnOnce(&Path) -> Result<(), String>) -> Option<String> {
        if self.kept == Some(sample) && self.trouble.is_none() {
            return None;
        }
        let begun = Instant::now();
        let result = write(&self.path);
        (self.last, self.took) = (Instant::now(), begun.elapsed());
        self.spent += self.took;
        let before = std::mem::replace(&mut self.trouble, result.err());
        if self.trouble.is_none() {
            (self.kept, self.written) = (Some(sample), self.written + 1);
        }
        self.trouble.clone().filter(|_| before.is_none())
    }

    /// Why the last one could not be written.
    pub fn trouble(&self) -> Option<&str> {
        self.trouble.as_deref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn full(_: &Path) -> Result<(), String> {
        Err("no space left on device".to_owned())
    }

    #[test]
    fn a_full_disk_is_told_once_and_tried_again() {
        let mut checkpoint = Checkpoint::new(Path::new("a.film"), None, None);
        assert_eq!(checkpoint.keep(4, full).as_deref(), Some("no space left on device"));
        assert_eq!(checkpoint.keep(8, full), None);
        assert!(checkpoint.trouble().is_some());
        let mut written = 0;
        let mut write = |checkpoint: &mut Checkpoint| {
            checkpoint.keep(8, |_| {
                written += 1;
                Ok(())
            })
        };
        assert_eq!(write(&mut checkpoint), None);
        assert_eq!(checkpoint.trouble(), None);
        // It is there, so it is not written again.
        assert_eq!(write(&mut checkpoint), None);
        assert_eq!((written, checkpoint.written), (1, 1));
        assert!(checkpoint.keep(12, full).is_some());
    }

    #[test]
    fn writing_takes_a_hundredth_of_the_time() {
        let mut checkpoint = Checkpoint::new(Path::new("a.film"), None, None);
        assert_eq!(checkpoint.interval(), LEAST);
        checkpoint.took = Duration::from_secs(2);
        assert_eq!(checkpoint.interval(), Duration::from_secs(200));
        checkpoint.every = Some(Duration::from_millis(1));
        assert_eq!(checkpoint.interval(), Duration::from_millis(1));
    }

    #[test]
    fn what_was_resumed_is_not_written_again() {
        let mut checkpoint = Checkpoint::new(Path::new("a.film"), None, Some(8));
        assert_eq!(checkpoint.keep(8, full), None);
        assert_eq!(checkpoint.trouble(), None);
    }
}
