//! Any bytes as a film file: an error, or a film that comes back when it is written again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nephroid_formats::film_file::{encode_film, read_film_bytes};

fuzz_target!(|bytes: &[u8]| match read_film_bytes(bytes) {
    Ok(file) => {
        let mut again = Vec::new();
        encode_film(&mut again, &file.header, &file.film, file.aovs.as_ref()).expect("a vector takes all");
        assert_eq!(read_film_bytes(&again).expect("a good film"), file);
    }
    Err(error) => assert!(!error.to_string().is_empty()),
});
