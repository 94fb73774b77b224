//! Films to bytes and back.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use nephroid::film::{Aov, AovFilm, AovSample, AovSum, Convergence, Film, FilmCounts, PixelSum, PixelTotal};
use serde_json::json;

use super::*;

/// Numbers that only look random.
pub fn numbers(seed: u64) -> impl FnMut() -> u64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 17) ^ (state << 29)
    }
}

/// A pass of mixed sizes and signs, with some pixels that are left out and some that are cut.
pub fn pass(film: &mut Film, aovs: Option<&mut AovFilm>, seed: u64) {
    let mut next = numbers(seed);
    let mut unit = move || (next() % (1 << 24)) as f32 / (1u32 << 24) as f32;
    let pixels = film.pixels().len();
    let mut sums = vec![(PixelSum::default(), AovSum::default()); pixels];
    for (picture, values) in &mut sums {
        let light = [unit(), unit(), unit()].map(|v| v * 10f32.powi((unit() * 12.0) as i32 - 6));
        let weight = if unit() < 0.2 { -1.25 } else { 1.25 };
        picture.add(light.into(), weight);
        picture.add_blur(light[0] - light[1], weight);
        if unit() < 0.02 {
            picture.radiance[1] = if unit() < 0.5 { f64::NAN } else { -1e300 };
        }
        let mut sample = AovSample::default();
        (sample.hit, sample.look_ups) = (unit() < 0.7, 2);
        sample.add(Aov::Direct, &light);
        sample.add(Aov::Normal, &[unit() - 0.5, unit(), -unit()]);
        sample.add(Aov::Radius, &[unit()]);
        values.add(&sample, weight);
    }
    film.add_iteration(&sums.iter().map(|(picture, _)| *picture).collect::<Vec<_>>());
    if let Some(aovs) = aovs {
        aovs.add_iteration(sums.iter().map(|(_, values)| values));
    }
}

pub const AOVS: [Aov; 3] = [Aov::Direct, Aov::Normal, Aov::Radius];

/// Four samples a pass; these passes of one seed.
pub fn film_of(passes: &[u64], with_aovs: bool) -> FilmFile {
    let mut film = Film::with_unit(53, 41, -3);
    let mut aovs = with_aovs.then(|| AovFilm::with_unit(53, 41, -3, &AOVS));
    let mut covered = Covered::new();
    for &number in passes {
        pass(&mut film, aovs.as_mut(), number);
        covered = covered.join(&Covered::from_range(4 * number..4 * number + 4)).unwrap();
    }
    // Of each pass the same, so that they add up in any order.
    let mut convergence = Convergence::default();
    for _ in passes {
        convergence.merge(&Convergence::from_numbers([3, 0, 1 << 60, 2, 7 << 30, 0, 0, 16, 5]));
    }
    let pair = |what: &str, value: &str| (what.to_owned(), value.to_owned());
    let header = FilmHeader {
        convergence,
        covered,
        samples_per_pass: 4,
        identity: vec![pair("scene", "00ff00ff00ff00ff"), pair("seed", "7")],
        job: json!({"spp": 16, "radius": 0.1f32, "first": passes.first(), "path": "a\nb\"ü"}),
        ..FilmHeader::default()
    };
    FilmFile { header: header.describing(&film, aovs.as_ref()), film, aovs }
}

pub fn bytes_of(file: &FilmFile) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_film(&mut bytes, &file.header, &file.film, file.aovs.as_ref()).unwrap();
    bytes
}

pub fn write(folder: &Path, name: &str, file: &FilmFile) -> std::path::PathBuf {
    let path = folder.join(name);
    write_film(&path, &file.header, &file.film, file.aovs.as_ref()).unwrap();
    path
}

/// Names of what is in a folder.
fn names(folder: &Path) -> Vec<String> {
    fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn films_come_back_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    for with_aovs in [false, true] {
        let file = film_of(&[0, 1, 5], with_aovs);
        let counts = file.film.counts();
        assert!(counts.saturated > 0 && counts.non_finite > 0);
        let path = write(folder.path(), "a.film", &file);
        assert_eq!(read_film(&path).unwrap(), file);
        assert_eq!(read_header(&path).unwrap(), file.header);
        assert_eq!(names(folder.path()), ["a.film"]);
        assert_eq!(fs::read(&path).unwrap(), bytes_of(&file));
    }
}

#[test]
fn extreme_sums_come_back_and_take_96_bytes_a_pixel() {
    let signs = |negative: bool| if negative { -(1i128 << 95) } else { (1 << 95) - 1 };
    let total = |i: usize| PixelTotal {
        radiance: [2, 3, 5].map(|n| signs(i.is_multiple_of(n))),
        luminance_sq: [0, 1 << 95, (1 << 95) - 1, (1 << 96) - 1][i % 4],
        weight: [i64::MIN, i64::MAX, 0, -1][i % 4],
        samples: [0, u32::MAX, 1 << 31, 1][i % 4],
        blur: signs(i.is_multiple_of(7)),
        mark: signs(i.is_multiple_of(11)),
        blur_sq: [(1 << 96) - 1, 0, 1 << 95, (1 << 95) - 1][i % 4],
    };
    let pixels: Vec<_> = (0..64 * 64).map(total).collect();
    let counts = FilmCounts { saturated: u64::MAX, non_finite: u64::MAX };
    let film = Film::from_parts((64, 64), 160, u64::MAX, counts, pixels).unwrap();
    let mut aovs = AovFilm::with_unit(64, 64, 160, &Aov::ALL);
    let sums: Vec<i128> = (0..aovs.sums().len()).map(|i| [i128::MIN, i128::MAX, 0, -1][i % 4]).collect();
    aovs.add_sums(0, &sums);
    let header = FilmHeader { covered: Covered::from_range(0..u64::MAX), ..FilmHeader::default() };
    let plain = FilmFile { header: header.describing(&film, None), film, aovs: None };
    let bytes = bytes_of(&plain);
    let read = read_film_bytes(&bytes).unwrap();
    let marks = |file: &FilmFile| file.film.pixels().iter().map(|pixel| pixel.mark).collect::<Vec<_>>();
    assert_eq!(read, plain);
    assert_eq!(marks(&read), marks(&plain));
    // What comes on top: the header, and 17 bytes for each of four blocks.
    assert!(bytes.len() <= 96 * 64 * 64 + 512, "{}", bytes.len());
    let full = FilmFile {
        header: plain.header.describing(&plain.film, Some(&aovs)),
        film: plain.film,
        aovs: Some(aovs),
    };
    assert_eq!(read_film_bytes(&bytes_of(&full)).unwrap(), full);
}

#[test]
fn a_film_of_no_values_is_none() {
    let file = film_of(&[0], false);
    let empty = AovFilm::with_unit(53, 41, -3, &[]);
    let mut bytes = Vec::new();
    encode_film(&mut bytes, &file.header, &file.film, Some(&empty)).unwrap();
    assert_eq!(read_film_bytes(&bytes).unwrap(), file);
}

#[test]
fn sizes_that_are_not_read_are_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.film");
    for (width, height) in [(65_537, 1), (1, 65_537), (0, 3), (3, 0)] {
        let film = Film::new(width, height);
        let expected = format!(
            "is of {width}×{height} pixels; from 1 to 65536 on a side and 268435456 in all are possible"
        );
        let error = write_film(&path, &FilmHeader::default(), &film, None).unwrap_err();
        assert_eq!(error.to_string(), format!("{}: {expected}", path.display()));
        assert!(names(folder.path()).is_empty());
        let mut bytes = Vec::new();
        let error = encode_film(&mut bytes, &FilmHeader::default(), &film, None).unwrap_err();
        assert_eq!((error.to_string(), bytes.len()), (expected, 0));
    }
    let film = Film::new(65_536, 1);
    write_film(&path, &FilmHeader::default(), &film, None).unwrap();
    assert_eq!(read_film(&path).unwrap().film, film);
}

#[test]
fn the_header_says_what_the_film_is() {
    let mut file = film_of(&[0], true);
    let good = file.header.clone();
    file.header = FilmHeader { width: 1, unit: 9, aovs: Vec::new(), iterations: 77, ..good.clone() };
    assert_eq!(read_film_bytes(&bytes_of(&file)).unwrap().header, good);
}

#[test]
fn a_failing_write_leaves_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let file = film_of(&[0, 1], false);
    let path = write(folder.path(), "a.film", &file);
    let whole = fs::read(&path).unwrap();
    let film = film_of(&[3], false);
    let needed = bytes_of(&film).len();
    for room in [0, 5, 100, needed / 2, needed - 1] {
        let mut left = room;
        let error = crate::image::stream_atomically(&path, |to| {
            let full = || io::Error::from(io::ErrorKind::StorageFull);
            encode_film(Limited { to, left: &mut left, full: &full }, &film.header, &film.film, None)
        })
        .unwrap_err();
        let error =
            FilmFileError { path: error.path, problem: FilmFileProblem::Write { problem: error.problem } };
        let expected = "a.film: cannot be written: no storage space; free some space, or write elsewhere";
        assert!(error.to_string().ends_with(expected), "{error}");
        assert_eq!(fs::read(&path).unwrap(), whole);
        assert_eq!(names(folder.path()), ["a.film"]);
    }
}

/// A disk with room for so many bytes.
struct Limited<'l, W> {
    to: W,
    left: &'l mut usize,
    full: &'l dyn Fn() -> io::Error,
}

impl<W: Write> Write for Limited<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let fits = bytes.len().min(*self.left);
        if fits == 0 && !bytes.is_empty() {
            return Err((self.full)());
        }
        *self.left -= fits;
        self.to.write(&bytes[..fits])
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told() {
    let file = film_of(&[0], false);
    let device = File::options().write(true).open("/dev/full").unwrap();
    let error = encode_film(device, &file.header, &file.film, None).unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::StorageFull);
}

#[test]
fn places_where_no_file_can_be_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let file = film_of(&[0], false);
    let message = |path: &Path| write_film(path, &file.header, &file.film, None).unwrap_err().to_string();
    let under_a_file = write(folder.path(), "a.film", &file).join("b.film");
    let expected =
        format!("cannot be written: there is no folder {}", folder.path().join("a.film").display());
    assert_eq!(message(&under_a_file), format!("{}: {expected}", under_a_file.display()));
    assert_eq!(message(folder.path()), format!("{}: is not a file", folder.path().display()));
    assert_eq!(names(folder.path()), ["a.film"]);
}

#[cfg(unix)]
#[test]
fn folders_in_which_no_file_may_be_made_are_told() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o555)).unwrap();
    // Nothing is forbidden to root.
    if File::create(folder.path().join("probe")).is_ok() {
        return;
    }
    let file = film_of(&[0], false);
    let path = folder.path().join("a.film");
    let error = write_film(&path, &file.header, &file.film, None).unwrap_err().to_string();
    assert!(error.ends_with("; write to a folder in which files may be made"), "{error}");
    assert!(names(folder.path()).is_empty());
}
