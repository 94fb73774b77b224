//! Pieces of a file, each with its length and its checksum.
//!
//! A CRC-32 finds every change of a single byte, and of any bits within four bytes, for certain. Each covers the number
//! of its piece as well, so that pieces cannot change places.

use std::io::{self, Write};

use super::{FilmFileProblem, Section};

/// What the file ends with.
pub const END: &[u8; 8] = b"FILM END";

/// Bytes before a piece: its length and its checksum.
pub const PREFIX: usize = 8;

fn checksum(number: u32, length: u32, bytes: &[u8]) -> u32 {
    let mut crc = crc32fast::Hasher::new();
    crc.update(&number.to_le_bytes());
    crc.update(&length.to_le_bytes());
    crc.update(bytes);
    crc.finalize()
}

/// Writes pieces.
pub struct FrameWriter<W> {
    to: W,
    number: u32,
}

impl<W: Write> FrameWriter<W> {
    /// The next piece is the first.
    pub fn new(to: W) -> Self {
        Self { to, number: 0 }
    }

    /// Writes a piece.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let length = u32::try_from(bytes.len()).map_err(|_| io::Error::other("too much for one piece"))?;
        self.to.write_all(&length.to_le_bytes())?;
        self.to.write_all(&checksum(self.number, length, bytes).to_le_bytes())?;
        self.to.write_all(bytes)?;
        self.number += 1;
        Ok(())
    }

    /// Writes the mark of the end.
    pub fn end(mut self) -> io::Result<()> {
        self.to.write_all(END)
    }
}

/// Reads pieces.
#[derive(Clone)]
pub struct Frames<'b> {
    bytes: &'b [u8],
    at: usize,
    number: u32,
}

impl<'b> Frames<'b> {
    /// The first piece begins at byte `at`.
    pub fn new(bytes: &'b [u8], at: usize) -> Self {
        Self { bytes, at, number: 0 }
    }

    /// Bytes that were not read.
    pub fn rest(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The next piece. Only if `check` is set is its checksum looked at.
    pub fn next(&mut self, section: Section, check: bool) -> Result<&'b [u8], FilmFileProblem> {
        let too_short = || self.too_short(section);
        let [length, checksum_bytes] = [self.at, self.at + 4].map(|at| self.bytes.get(at..at + 4));
        let number_of = |bytes: Option<&[u8]>| {
            let four: Option<[u8; 4]> = bytes.and_then(|bytes| bytes.try_into().ok());
            four.map(u32::from_le_bytes)
        };
        let length_and_checksum = number_of(length).zip(number_of(checksum_bytes));
        let (length, expected) = length_and_checksum.ok_or_else(too_short)?;
        let start = self.at + PREFIX;
        let end = start.checked_add(length as usize).ok_or_else(too_short)?;
        let bytes = self.bytes.get(start..end).ok_or_else(too_short)?;
        // A fuzzer does not guess checksums, and would never come past them.
        if check && !cfg!(fuzzing) && checksum(self.number, length, bytes) != expected {
            return Err(FilmFileProblem::Damaged { section });
        }
        self.at = end;
        self.number += 1;
        Ok(bytes)
    }

    /// Checks that the file ends here.
    pub fn end(&self) -> Result<(), FilmFileProblem> {
        let rest = &self.bytes[self.at..];
        match rest.strip_prefix(END) {
            Some([]) => Ok(()),
            Some(more) => Err(FilmFileProblem::Trailing { bytes: more.len() }),
            None if END.starts_with(rest) => Err(self.cut_off()),
            None => Err(FilmFileProblem::Damaged { section: Section::End }),
        }
    }

    /// The file ends within a piece: because it was cut off, or because it says so wrongly.
    pub fn too_short(&self, section: Section) -> FilmFileProblem {
        if self.bytes.ends_with(END) { FilmFileProblem::Damaged { section } } else { self.cut_off() }
    }

    fn cut_off(&self) -> FilmFileProblem {
        FilmFileProblem::CutOff { at: self.bytes.len() as u64 }
    }
}
