//! Film files of 1920×1080 pixels: bytes a pixel, and CPU seconds to write, read and add one up.
//!
//! The film has what a render of 64 samples a pixel leaves: sums of 16 steps, noise in all low bits. Files lie in the
//! system's folder for temporary ones and so in the page cache.

use std::env;
use std::fs;

use nephroid::color::Rgb;
use nephroid::film::{Film, PixelSum};
use nephroid_bench::{cpu_time, rounds};
use nephroid_formats::film_file::{Covered, FilmHeader, FilmMerger, read_film, write_film};

const SIZE: (u32, u32) = (1920, 1080);
const STEPS: u64 = 16;
const ROUNDS: usize = 5;

fn main() {
    let folder = env::temp_dir().join(format!("nephroid-film-files-{}", std::process::id()));
    fs::create_dir(&folder).expect("a folder");
    let paths = [0, 1].map(|i| folder.join(format!("{i}.film")));
    for (i, path) in (0..).zip(&paths) {
        let covered = Covered::from_range(4 * STEPS * i..4 * STEPS * (i + 1));
        let header = FilmHeader { covered, samples_per_pass: 4, ..FilmHeader::default() };
        write_film(path, &header, &film(i), None).expect("a film is written");
    }
    let pixels = u64::from(SIZE.0) * u64::from(SIZE.1);
    let bytes = fs::metadata(&paths[0]).expect("a film").len();
    println!("bytes a pixel            {:>7.2}", bytes as f64 / pixels as f64);

    let sums = film(0);
    let header = FilmHeader { samples_per_pass: 4, ..FilmHeader::default() };
    let written = folder.join("written.film");
    let times = rounds(
        ROUNDS,
        &mut [&mut || write_film(&written, &header, &sums, None).expect("a film is written"), &mut || {
            drop(read_film(&paths[0]).expect("a film is read"))
        }],
    );
    let mut merging = Vec::new();
    for _ in 0..ROUNDS {
        let mut merger = FilmMerger::new(&paths[0]).expect("a film is read");
        merging.push(cpu_time(|| merger.add(&paths[1]).expect("films that belong together")).as_secs_f64());
    }
    merging.sort_unstable_by(f64::total_cmp);
    println!("CPU seconds to write     {:>7.3}", times[0]);
    println!("CPU seconds to read      {:>7.3}", times[1]);
    println!("CPU seconds to add one   {:>7.3}", merging[ROUNDS / 2]);
    fs::remove_dir_all(&folder).expect("the folder is there");
}

fn film(seed: u64) -> Film {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1u64 << 24) as f32
    };
    let mut film = Film::new(SIZE.0, SIZE.1);
    for _ in 0..STEPS {
        let mut pixel = |_| {
            let mut sum = PixelSum::default();
            (0..4).for_each(|_| sum.add(Rgb::new(next(), next(), next()), 1.1));
            sum
        };
        let sums: Vec<PixelSum> = (0..SIZE.0 * SIZE.1).map(&mut pixel).collect();
        film.add_iteration(&sums);
    }
    film
}
