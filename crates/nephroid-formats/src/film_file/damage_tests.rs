//! Files that are no films, or no longer.

use std::fs;

use nephroid::film::{AovFilm, Film};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::frame::FrameWriter;
use super::tests::{AOVS, bytes_of, film_of, pass};
use super::*;

/// A film of a few pixels.
fn small() -> FilmFile {
    let (mut film, mut aovs) = (Film::new(3, 2), AovFilm::new(3, 2, &AOVS));
    pass(&mut film, Some(&mut aovs), 1);
    let header = FilmHeader {
        covered: Covered::from_range(0..4),
        identity: vec![("scene".to_owned(), "1f".to_owned())],
        ..FilmHeader::default()
    };
    FilmFile { header: header.describing(&film, Some(&aovs)), film, aovs: Some(aovs) }
}

fn message(bytes: &[u8]) -> String {
    read_film_bytes(bytes).expect_err("an error").to_string()
}

#[test]
fn every_change_of_a_byte_is_found() {
    let bytes = bytes_of(&small());
    for at in 0..bytes.len() {
        for change in [1, 0x80, 0xff, 0x20] {
            let mut damaged = bytes.clone();
            damaged[at] ^= change;
            assert!(read_film_bytes(&damaged).is_err(), "byte {at} ^ {change}");
        }
    }
}

#[test]
fn every_cut_is_found() {
    let bytes = bytes_of(&small());
    for length in 0..bytes.len() {
        let message = message(&bytes[..length]);
        let cut = format!("is cut off: it ends after {length} bytes, before it is complete; ");
        assert!(message.starts_with(&cut) || length == 0, "{length}: {message}");
    }
}

#[test]
fn pieces_that_changed_places_are_found() {
    let file = film_of(&[0], false);
    let bytes = bytes_of(&file);
    let length_at = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let first = 12 + 8 + length_at(12);
    let second = first + 8 + length_at(first);
    let third = second + 8 + length_at(second);
    let swapped = [&bytes[..first], &bytes[second..third], &bytes[first..second], &bytes[third..]].concat();
    assert_eq!(
        message(&swapped),
        "is damaged: the picture's pixels 0 to 1023 are not as they were written; copy the file again, \
         or render again"
    );
}

#[test]
fn damage_is_said_where_it_is() {
    let bytes = bytes_of(&film_of(&[0], true));
    let place = |at: usize| {
        let mut damaged = bytes.clone();
        damaged[at] ^= 4;
        message(&damaged)
    };
    let again = "are not as they were written; copy the file again, or render again";
    assert_eq!(place(40), format!("is damaged: the bytes of its header {again}"));
    let values = format!("is damaged: the further values of pixels 2048 to 2172 {again}");
    assert_eq!(place(bytes.len() - 20), values);
    assert_eq!(place(bytes.len() - 1), format!("is damaged: the last bytes {again}"));
    assert_eq!(message(&[&bytes[..], &[0, 1]].concat()), "is damaged: 2 bytes follow its end");
}

#[test]
fn other_files_are_told_by_what_they_look_like() {
    for (bytes, found) in [
        (&b"\x76\x2f\x31\x01rest"[..], "an OpenEXR image"),
        (b"\x89PNG\r\n\x1a\n", "a PNG image"),
        (b"BM....", "a BMP image"),
        (b"<scene version=\"3.0.0\"/>", "an XML file, perhaps a scene"),
        (b"", "an empty file"),
        (b"hello", "of no format that is known here"),
    ] {
        assert_eq!(message(bytes), format!("is {found}, not a film file"));
    }
}

#[test]
fn errors_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.film");
    let name = path.display();
    for error in [read_film(&path).unwrap_err(), read_header(&path).unwrap_err()] {
        assert!(error.to_string().starts_with(&format!("{name}: cannot be read: ")), "{error}");
    }
    fs::write(&path, b"hello").unwrap();
    let error = read_header(&path).unwrap_err().to_string();
    assert_eq!(error, format!("{name}: is of no format that is known here, not a film file"));
    assert!(read_film(folder.path()).unwrap_err().to_string().ends_with(": is not a file"));
}

/// A file with this header and no blocks.
fn with_header(header: &str) -> Vec<u8> {
    let mut bytes = [&MAGIC[..], &VERSION.to_le_bytes()].concat();
    let mut frames = FrameWriter::new(&mut bytes);
    frames.write(header.as_bytes()).unwrap();
    frames.end().unwrap();
    bytes
}

#[test]
fn headers_that_make_no_sense_are_refused() {
    let good = small().header.to_json();
    let changed = |name: &str, value: Value| {
        let mut header = good.clone();
        header[name] = value;
        message(&with_header(&header.to_string()))
    };
    for (name, value, reason) in [
        ("width", json!(-1), "in its header, `width` is not a number"),
        ("height", json!(1.5), "in its header, `height` is not a number"),
        ("covered", json!([[4, 2]]), "in its header, `covered` is not ranges in order"),
        ("covered", json!([[0, 4], [3, 5]]), "in its header, `covered` is not ranges in order"),
        ("identity", json!([["a"]]), "in its header, `identity` is not pairs of words"),
        ("samples_per_pass", json!(0), "in its header, `samples_per_pass` is not a number from 1 on"),
    ] {
        assert_eq!(changed(name, value), format!("makes no sense: {reason}"));
    }
    assert_eq!(
        changed("width", json!(70_000)),
        "is of 70000×2 pixels; from 1 to 65536 on a side and 268435456 in all are possible"
    );
    assert!(changed("height", json!(0)).starts_with("is of 3×0 pixels"));
    assert_eq!(
        changed("aovs", json!(["direct", "colour"])),
        "has the values `colour`, which this program does not know: use the one that wrote it"
    );
    assert_eq!(
        changed("aovs", json!(["normal", "direct"])),
        "makes no sense: in its header, `aovs` are not in order"
    );
    // Far more pixels than there are bytes: found before any memory is asked for.
    assert!(changed("width", json!(65_536)).starts_with("is damaged: the picture's pixels"));
    let mut missing = good.clone();
    missing.as_object_mut().unwrap().remove("job");
    assert_eq!(
        message(&with_header(&missing.to_string())),
        "makes no sense: in its header, `job` is missing"
    );
    assert!(message(&with_header("[1, 2")).starts_with("makes no sense: in its header, "));
    assert!(message(&with_header(&format!("{{\"job\":{}", "[".repeat(100_000)))).contains("recursion limit"));
}

#[test]
fn units_that_no_film_has_are_refused() {
    let file = small();
    let bytes = bytes_of(&file);
    let mut header = file.header.to_json();
    header["unit"] = json!(500);
    let mut changed = [&MAGIC[..], &VERSION.to_le_bytes()].concat();
    let mut frames = FrameWriter::new(&mut changed);
    frames.write(header.to_string().as_bytes()).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    changed.extend(&bytes[20 + length..]);
    assert_eq!(message(&changed), "makes no sense: in its header, `unit` is none that a film can have");
}

#[test]
fn other_versions_are_refused() {
    let mut bytes = bytes_of(&small());
    bytes[8] = 4;
    assert_eq!(
        message(&bytes),
        "has version 4 of the format, but this program reads up to 3: use the program that wrote it, or a \
         newer one"
    );
    bytes[8] = 2;
    assert_eq!(
        message(&bytes),
        "has version 2 of the format, but this program reads from 3 on: use the program that wrote it, or \
         render again"
    );
}

#[test]
fn blocks_that_make_no_sense_are_refused() {
    let mut bytes = [&MAGIC[..], &VERSION.to_le_bytes()].concat();
    let mut frames = FrameWriter::new(&mut bytes);
    let header = FilmHeader { aovs: Vec::new(), ..small().header };
    frames.write(header.to_json().to_string().as_bytes()).unwrap();
    frames.write(&[13; 200]).unwrap();
    frames.end().unwrap();
    assert_eq!(message(&bytes), "makes no sense: the picture's pixels 0 to 5 cannot be understood");
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 5000,
        rng_seed: proptest::test_runner::RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn random_damage_is_found(
        from in 0.0..1.0,
        to in 0.0..1.0,
        length in 0usize..40,
        inserted in prop::collection::vec(any::<u8>(), 0..40),
        copied: bool,
    ) {
        let bytes = bytes_of(&small());
        let place = |at: f64| (at * bytes.len() as f64) as usize;
        let start = place(from);
        let end = (start + length).min(bytes.len());
        let new = if copied {
            bytes[place(to)..(place(to) + inserted.len()).min(bytes.len())].to_vec()
        } else {
            inserted
        };
        let mut damaged = bytes.clone();
        damaged.splice(start..end, new);
        let read = read_film_bytes(&damaged);
        prop_assert_eq!(read.is_ok(), damaged == bytes);
        prop_assert!(read.err().is_none_or(|error| !error.to_string().is_empty()));
    }
}
