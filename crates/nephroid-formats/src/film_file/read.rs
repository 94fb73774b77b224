use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use nephroid::film::{AovFilm, Film, PixelTotal};

use super::columns::{Column, unpack};
use super::frame::{Frames, PREFIX};
use super::{BLOCK, FilmFile, FilmFileError, FilmFileProblem, FilmHeader, MAGIC, Section, VERSION};

/// Bytes before the first piece.
const START: usize = MAGIC.len() + 4;

/// Largest bytes of a radiance's channels, of the squares, the weight and the number of estimates of a pixel, of what blur
/// does to it, of the squares of that and of its mark.
const PICTURE_WIDTHS: [u8; 9] = [12, 12, 12, 12, 8, 4, 12, 12, 12];

/// Largest bytes of a sum of a further value.
const VALUE_WIDTH: u8 = 16;

/// Reads a film file.
pub fn read_film(path: &Path) -> Result<FilmFile, FilmFileError> {
    named(path, || {
        let mut bytes = Vec::new();
        read_bytes(path, &mut bytes)?;
        read_film_bytes(&bytes)
    })
}

/// [`read_film`] of the contents of a file.
pub fn read_film_bytes(bytes: &[u8]) -> Result<FilmFile, FilmFileProblem> {
    let (header, sums) = Sums::checked(bytes)?;
    let mut film = Film::with_unit(header.width, header.height, header.unit);
    if film.unit() != header.unit {
        return Err(FilmFileProblem::Header("`unit` is none that a film can have".to_owned()));
    }
    let aovs = header.known_aovs()?;
    let mut aovs =
        (!aovs.is_empty()).then(|| AovFilm::with_unit(header.width, header.height, header.unit, &aovs));
    sums.add_to(&mut film, aovs.as_mut())?;
    film.count(header.iterations, header.counts);
    Ok(FilmFile { header, film, aovs })
}

/// Reads what a film file says about itself, and nothing else of it: whether the rest is whole is not looked at.
pub fn read_header(path: &Path) -> Result<FilmHeader, FilmFileError> {
    named(path, || {
        let file = open(path)?;
        let mut bytes = Vec::new();
        let mut read = |length: u64| (&file).take(length).read_to_end(&mut bytes).map(|_| bytes.clone());
        let start = read((START + PREFIX) as u64).map_err(FilmFileProblem::Read)?;
        let length = start.get(START..START + 4).and_then(|four| four.try_into().ok());
        // Read as far as there is a file, so that nothing is allocated on the word of four bytes.
        let whole = match length.filter(|_| start.starts_with(MAGIC)) {
            Some(length) => read(u64::from(u32::from_le_bytes(length))).map_err(FilmFileProblem::Read)?,
            None => start,
        };
        Ok(read_start(&whole)?.0)
    })
}

pub(super) fn named<T>(
    path: &Path,
    f: impl FnOnce() -> Result<T, FilmFileProblem>,
) -> Result<T, FilmFileError> {
    f().map_err(|problem| FilmFileError { path: path.to_owned(), problem })
}

/// The contents of a file, in a buffer that is used again.
pub(super) fn read_bytes(path: &Path, bytes: &mut Vec<u8>) -> Result<(), FilmFileProblem> {
    let mut file = open(path)?;
    bytes.clear();
    file.read_to_end(bytes).map(|_| ()).map_err(FilmFileProblem::Read)
}

fn open(path: &Path) -> Result<File, FilmFileProblem> {
    let metadata = fs::metadata(path).map_err(FilmFileProblem::Read)?;
    if !metadata.is_file() {
        return Err(FilmFileProblem::NotAFile);
    }
    File::open(path).map_err(FilmFileProblem::Read)
}

/// The header, and the pieces behind it.
fn read_start(bytes: &[u8]) -> Result<(FilmHeader, Frames<'_>), FilmFileProblem> {
    let Some(rest) = bytes.strip_prefix(MAGIC) else {
        let is_cut_off = MAGIC.starts_with(bytes) && !bytes.is_empty();
        return Err(if is_cut_off { cut_off(bytes) } else { FilmFileProblem::not_a_film(bytes) });
    };
    let version = rest.first_chunk().map(|four| u32::from_le_bytes(*four));
    match version {
        None => return Err(cut_off(bytes)),
        Some(VERSION) => {}
        Some(0) => return Err(FilmFileProblem::Damaged { section: Section::Header }),
        Some(version @ ..VERSION) => return Err(FilmFileProblem::TooOld { version }),
        Some(version) => return Err(FilmFileProblem::TooNew { version }),
    }
    let mut frames = Frames::new(bytes, START);
    let header = FilmHeader::from_json(frames.next(Section::Header, true)?)?;
    Ok((header, frames))
}

fn cut_off(bytes: &[u8]) -> FilmFileProblem {
    FilmFileProblem::CutOff { at: bytes.len() as u64 }
}

/// The sums of a file whose checksums are right.
pub(super) struct Sums<'b> {
    frames: Frames<'b>,
    pixels: usize,
    /// Columns of the further values.
    columns: usize,
}

impl<'b> Sums<'b> {
    /// Looks through a whole file without keeping anything: what comes back can be [added](Self::add_to).
    pub fn checked(bytes: &'b [u8]) -> Result<(FilmHeader, Self), FilmFileProblem> {
        let (header, frames) = read_start(bytes)?;
        let aovs = header.known_aovs()?;
        let columns = if aovs.is_empty() { 0 } else { AovFilm::new(0, 0, &aovs).sums_per_pixel() };
        let pixels = header.width as usize * header.height as usize;
        // Each number takes a byte at least, so that memory is within a multiple of the file's length.
        if pixels.saturating_mul(PICTURE_WIDTHS.len() + columns) > frames.rest() {
            return Err(frames.too_short(Section::Picture { first: 0, last: pixels - 1 }));
        }
        let sums = Self { frames, pixels, columns };
        let mut frames = sums.frames.clone();
        for (section, rows) in sums.sections() {
            let block = frames.next(section, true)?;
            if sums.unpack(section, block, rows).is_none() {
                return Err(FilmFileProblem::Nonsense { section });
            }
        }
        frames.end()?;
        Ok((header, sums))
    }

    /// The blocks in the order of the file, with the number of their pixels.
    fn sections(&self) -> impl Iterator<Item = (Section, usize)> + use<> {
        let pixels = self.pixels;
        let block = move |first: usize| (first, (first + BLOCK).min(pixels) - 1);
        let picture = (0..pixels).step_by(BLOCK).map(block);
        let with_values = if self.columns == 0 { 0 } else { pixels };
        let values = (0..with_values).step_by(BLOCK).map(block);
        picture
            .map(|(first, last)| (Section::Picture { first, last }, last + 1 - first))
            .chain(values.map(|(first, last)| (Section::Values { first, last }, last + 1 - first)))
    }

    fn unpack(&self, section: Section, block: &'b [u8], rows: usize) -> Option<Vec<Column<'b>>> {
        match section {
            Section::Values { .. } => unpack(block, rows, &vec![VALUE_WIDTH; self.columns]),
            _ => unpack(block, rows, &PICTURE_WIDTHS),
        }
    }

    /// Adds them to films of their size, unit and values.
    pub fn add_to(&self, film: &mut Film, mut aovs: Option<&mut AovFilm>) -> Result<(), FilmFileProblem> {
        let mut frames = self.frames.clone();
        let (mut totals, mut values) = (Vec::with_capacity(BLOCK), Vec::new());
        for (section, rows) in self.sections() {
            let block = frames.next(section, false)?;
            let nonsense = FilmFileProblem::Nonsense { section };
            let columns = self.unpack(section, block, rows).ok_or(nonsense)?;
            match (section, aovs.as_deref_mut()) {
                (Section::Picture { first, .. }, _) => {
                    totals.clear();
                    totals.extend((0..rows).map(|row| pixel_total(&columns, row)));
                    film.add_pixels(first, &totals);
                }
                (Section::Values { first, .. }, Some(aovs)) => {
                    values.clear();
                    values.extend((0..rows).flat_map(|row| columns.iter().map(move |c| c.get(row))));
                    aovs.add_sums(first, &values);
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// A pixel of a block of the picture, whose columns have no more bytes than such sums.
#[inline]
fn pixel_total(columns: &[Column<'_>], row: usize) -> PixelTotal {
    PixelTotal {
        radiance: [columns[0].get(row), columns[1].get(row), columns[2].get(row)],
        // Without the copies of its first bit.
        luminance_sq: columns[3].get(row).cast_unsigned() & (u128::MAX >> 32),
        weight: columns[4].get(row) as i64,
        samples: (columns[5].get(row) as i32).cast_unsigned(),
        blur: columns[6].get(row),
        blur_sq: columns[7].get(row).cast_unsigned() & (u128::MAX >> 32),
        mark: columns[8].get(row),
    }
}
