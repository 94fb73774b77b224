//! Showing a picture while it is rendered: in a file, and in a viewer.

use std::time::{Duration, Instant};

use nephroid::texture::Image;
use nephroid_formats::image::{check_writable, write_png};

use crate::args::DisplayArgs;
use crate::exit::Failure;
use crate::output::{Kind, Output};
use crate::session_args::WatchArgs;
use crate::tev::Viewer;

/// A preview takes at most this share of the time, however often it is asked for.
const SHARE: u32 = 10;

/// A viewer gets the picture at most so often.
const VIEWER_INTERVAL: Duration = Duration::from_secs(1);

/// Something to be done every so often, where it takes little of the time.
struct Turn {
    every: Duration,
    last: Option<Instant>,
    took: Duration,
}

impl Turn {
    fn new(every: Duration) -> Self {
        Self { every, last: None, took: Duration::ZERO }
    }

    fn is_due(&self) -> bool {
        self.last.is_none_or(|last| last.elapsed() >= self.every.max(self.took * SHARE))
    }

    fn take<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let begun = Instant::now();
        let result = work();
        (self.last, self.took) = (Some(Instant::now()), begun.elapsed());
        result
    }
}

/// Where a picture is shown.
pub struct Previews<'a> {
    display: &'a DisplayArgs,
    file: Option<(Output, Turn)>,
    /// Whether it was told that the file cannot be written.
    told: bool,
    viewer: Option<(Viewer, Turn)>,
}

impl<'a> Previews<'a> {
    /// As the flags say; the file could be written now.
    pub fn new(args: &WatchArgs, name: &str, display: &'a DisplayArgs) -> Result<Self, Failure> {
        let file = match &args.preview {
            None => None,
            Some(path) => {
                let output = Output::of_kind(path, Kind::Png)?;
                check_writable(path).map_err(|e| Failure::File(e.to_string()))?;
                Some((output, Turn::new(Duration::from_secs_f64(args.preview_every))))
            }
        };
        let viewer =
            args.tev.as_ref().map(|address| (Viewer::new(address, name), Turn::new(VIEWER_INTERVAL)));
        Ok(Self { display, file, told: false, viewer })
    }

    /// Shows the picture where it is time to, or everywhere if it is the `last`. What goes wrong is told once: a file is
    /// tried again when it is time, and a viewer is not.
    pub fn show(&mut self, last: bool, picture: impl FnOnce() -> Image) -> Vec<String> {
        let is_due = |turn: &Turn| last || turn.is_due();
        let file = self.file.as_ref().is_some_and(|(_, turn)| is_due(turn));
        let viewer = self.viewer.as_ref().is_some_and(|(_, turn)| is_due(turn));
        if !file && !viewer {
            return Vec::new();
        }
        let image = picture();
        let mut trouble = Vec::new();
        if file && let Some((output, turn)) = &mut self.file {
            let shown = || self.display.tonemap.apply(&image, self.display.exposure);
            if let Err(error) = turn.take(|| write_png(&output.path, &shown()))
                && !std::mem::replace(&mut self.told, true)
            {
                trouble.push(format!("no preview for now: {error}"));
            }
        }
        if viewer
            && let Some((viewer, turn)) = &mut self.viewer
            && let Err(error) = turn.take(|| viewer.show(&image))
        {
            trouble.push(format!("no more pictures for tev: {error}"));
            self.viewer = None;
        }
        trouble
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_takes_long_is_done_seldom() {
        let mut turn = Turn::new(Duration::ZERO);
        assert!(turn.is_due());
        turn.take(|| std::thread::sleep(Duration::from_millis(20)));
        assert!(!turn.is_due());
        turn.took = Duration::ZERO;
        assert!(turn.is_due());
        turn.every = Duration::from_secs(1000);
        assert!(!turn.is_due());
    }
}
