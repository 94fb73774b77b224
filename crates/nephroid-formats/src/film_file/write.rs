use std::io::{self, Write};
use std::path::Path;

use nephroid::film::{AovFilm, Film, PixelTotal};

use super::columns::pack;
use super::frame::FrameWriter;
use super::header::check_size;
use super::{BLOCK, FilmFileError, FilmFileProblem, FilmHeader, MAGIC, VERSION};
use crate::image::stream_atomically;

/// Writes a film file whole or not at all: into a temporary file in the same folder, which then takes the place of
/// `path`. Size, unit, iterations, counts and further values are the film's, whatever the header says of them.
pub fn write_film(
    path: &Path,
    header: &FilmHeader,
    film: &Film,
    aovs: Option<&AovFilm>,
) -> Result<(), FilmFileError> {
    let size = check_size(film.width(), film.height());
    size.map_err(|problem| FilmFileError { path: path.to_owned(), problem })?;
    let written = stream_atomically(path, |to| encode_film(to, header, film, aovs));
    written
        .map_err(|e| FilmFileError { path: e.path, problem: FilmFileProblem::Write { problem: e.problem } })
}

/// Writes the bytes of a film file.
///
/// # Errors
/// Those of the writer, and one if the picture is larger than what can be read, or none, or if the further values are
/// of a picture of another size or unit.
pub fn encode_film(
    mut to: impl Write,
    header: &FilmHeader,
    film: &Film,
    aovs: Option<&AovFilm>,
) -> io::Result<()> {
    check_size(film.width(), film.height()).map_err(io::Error::other)?;
    // With no values there are no blocks of them.
    let aovs = aovs.filter(|aovs| !aovs.aovs().is_empty());
    let described = |aovs: &AovFilm| (aovs.width(), aovs.height(), aovs.unit());
    if aovs.is_some_and(|aovs| described(aovs) != (film.width(), film.height(), film.unit())) {
        return Err(io::Error::other("the further values are not those of this picture"));
    }
    to.write_all(MAGIC)?;
    to.write_all(&VERSION.to_le_bytes())?;
    let mut frames = FrameWriter::new(to);
    frames.write(header.describing(film, aovs).to_json().to_string().as_bytes())?;
    let mut block = Vec::new();
    for totals in film.pixels().chunks(BLOCK) {
        pack_picture(totals, &mut block);
        frames.write(&block)?;
    }
    if let Some(aovs) = aovs {
        let columns = aovs.sums_per_pixel();
        for sums in aovs.sums().chunks(BLOCK * columns) {
            start_block(&mut block, columns);
            for column in 0..columns {
                block[column] = pack(sums.iter().skip(column).step_by(columns).copied(), &mut block);
            }
            frames.write(&block)?;
        }
    }
    frames.end()
}

fn pack_picture(totals: &[PixelTotal], block: &mut Vec<u8>) {
    start_block(block, 9);
    for channel in 0..3 {
        block[channel] = pack(totals.iter().map(|t| t.radiance[channel]), block);
    }
    // Of 96 bits without a sign the first is taken as one, so that a saturated sum is −1 and takes one byte.
    let signed = |square: u128| ((square << 32) as i128) >> 32;
    block[3] = pack(totals.iter().map(|t| signed(t.luminance_sq)), block);
    block[4] = pack(totals.iter().map(|t| i128::from(t.weight)), block);
    block[5] = pack(totals.iter().map(|t| i128::from(t.samples.cast_signed())), block);
    block[6] = pack(totals.iter().map(|t| t.blur), block);
    block[7] = pack(totals.iter().map(|t| signed(t.blur_sq)), block);
    block[8] = pack(totals.iter().map(|t| t.mark), block);
}

/// An empty block that has room for the widths of its columns.
fn start_block(block: &mut Vec<u8>, columns: usize) {
    block.clear();
    block.resize(columns, 0);
}
