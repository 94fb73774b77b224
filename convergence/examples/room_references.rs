//! Renders what `tests/rooms.rs` compares with: `room_references FOLDER [ROOM]`, where the folder is `tests/rooms`.

use std::path::PathBuf;
use std::process::ExitCode;

use nephroid_convergence::ROOMS;

/// Seeds that no test uses.
const SEEDS: std::ops::Range<u64> = 1000..1016;

fn main() -> ExitCode {
    let mut words = std::env::args_os().skip(1);
    let Some(folder) = words.next().map(PathBuf::from) else { return ExitCode::from(2) };
    let only = words.next();
    for room in ROOMS.iter().filter(|room| only.as_ref().is_none_or(|only| only == room.name)) {
        let text = room.reference(SEEDS).to_text();
        if std::fs::write(folder.join(room.name).with_extension("txt"), text).is_err() {
            return ExitCode::from(4);
        }
    }
    ExitCode::SUCCESS
}
