//! Films added up from files.

use std::fs;
use std::path::{Path, PathBuf};

use super::tests::{bytes_of, film_of, numbers, write};
use super::*;

fn merged(paths: &[PathBuf]) -> Result<FilmFile, FilmFileError> {
    let mut merger = FilmMerger::new(&paths[0])?;
    paths[1..].iter().try_for_each(|path| merger.add(path))?;
    Ok(merger.finish())
}

#[test]
fn any_split_in_any_order_gives_the_whole_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    for with_aovs in [false, true] {
        let whole = film_of(&[0, 1, 2, 3, 4, 5], with_aovs);
        for seed in 1..8 {
            let mut next = numbers(seed);
            // Each pass goes into one of three films; those that are left empty are films, too.
            let mut split: [Vec<u64>; 3] = Default::default();
            (0..6).for_each(|number| split[next() as usize % 3].push(number));
            let named = split.iter().enumerate();
            let mut paths: Vec<PathBuf> = named
                .map(|(i, passes)| write(folder.path(), &format!("{i}.film"), &film_of(passes, with_aovs)))
                .collect();
            (0..3).for_each(|i| paths.swap(i, next() as usize % 3));
            let sum = merged(&paths).unwrap();
            assert_eq!(sum, whole, "{split:?}");
            assert_eq!(bytes_of(&sum), bytes_of(&whole));
        }
    }
}

#[test]
fn films_with_gaps_are_added_up() {
    let folder = tempfile::tempdir().unwrap();
    let paths =
        [&[4, 6][..], &[1]].map(|p| write(folder.path(), &format!("{}.film", p[0]), &film_of(p, false)));
    let header = merged(&paths).unwrap().header;
    assert_eq!(header.covered.gaps(), [0..4, 8..16, 20..24]);
    assert_eq!((header.covered.total(), header.iterations), (12, 3));
    assert_eq!(header.job["first"], 1);
}

/// A good film in a.film, one like it with a change in b.film, and what is said of the latter.
fn refusal(folder: &Path, change: impl FnOnce(&mut FilmFile)) -> String {
    let a = write(folder, "a.film", &film_of(&[0, 1, 2], false));
    let mut file = film_of(&[3], false);
    change(&mut file);
    let b = write(folder, "b.film", &file);
    let mut merger = FilmMerger::new(&a).unwrap();
    let error = merger.add(&b).unwrap_err().to_string();
    assert_eq!(merger.finish(), film_of(&[0, 1, 2], false), "the sums are what they were");
    error.replace(&format!("{}/", folder.display()), "")
}

#[test]
fn films_of_other_renders_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let other = "b.film: does not belong together with a.film:";
    let said = refusal(folder.path(), |b| b.header.identity[1].1 = "8".to_owned());
    assert_eq!(said, format!("{other} seed: 7 and 8"));
    let said = refusal(folder.path(), |b| {
        b.header.identity[0].1 = "11ff00ff00ff00ff".to_owned();
        b.header.identity[1].0 = "plan".to_owned();
    });
    assert_eq!(
        said,
        format!("{other} scene: 00ff00ff00ff… and 11ff00ff00ff…; only in a.film: seed; only in b.film: plan")
    );
    let said = refusal(folder.path(), |b| b.header.samples_per_pass = 8);
    assert_eq!(said, format!("{other} samples of a pass: 4 and 8"));
    let said = refusal(folder.path(), |b| *b = film_of(&[3], true));
    assert_eq!(said, format!("{other} values beside the picture: none and direct,normal,radius"));
    let said = refusal(folder.path(), |b| b.film = Film::with_unit(41, 53, 2));
    assert_eq!(said, format!("{other} pixels: 53×41 and 41×53; unit of radiance: 2^-3 and 2^2"));
}

#[test]
fn films_with_the_same_samples_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let twice = "what is in both would count twice; leave one of them out";
    let said = refusal(folder.path(), |b| *b = film_of(&[2, 3], false));
    assert_eq!(said, format!("b.film: has pass 2 in common with a.film: {twice}"));
    let said = refusal(folder.path(), |b| *b = film_of(&[1, 2, 9], false));
    assert_eq!(said, format!("b.film: has passes 1 to 2 in common with a.film: {twice}"));
    // The file that it overlaps with is named, and not just the first.
    let (a, c) = (folder.path().join("a.film"), folder.path().join("c.film"));
    let b = write(folder.path(), "b.film", &film_of(&[5], false));
    fs::copy(&b, &c).unwrap();
    let error = merged(&[a, b.clone(), c]).unwrap_err().to_string();
    assert!(error.contains(&format!("has pass 5 in common with {}: ", b.display())), "{error}");
}

#[test]
fn damaged_films_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let a = write(folder.path(), "a.film", &film_of(&[0], false));
    let b = write(folder.path(), "b.film", &film_of(&[1], false));
    let mut bytes = fs::read(&b).unwrap();
    let last = bytes.len() - 30;
    bytes[last] ^= 1;
    fs::write(&b, bytes).unwrap();
    let mut merger = FilmMerger::new(&a).unwrap();
    let error = merger.add(&b).unwrap_err().to_string();
    assert!(error.contains("b.film: is damaged: the picture's pixels 2048 to 2172 "), "{error}");
    assert_eq!(merger.header(), &film_of(&[0], false).header);
    assert_eq!(merger.finish(), film_of(&[0], false));
}
