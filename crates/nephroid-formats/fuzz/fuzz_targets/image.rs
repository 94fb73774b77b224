//! Any bytes as a picture: an error, or finite pixels, as many as its sides say.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nephroid_formats::image::{MAX_PIXELS, read_texture};

#[path = "../panics.rs"]
mod panics;

fuzz_target!(init: panics::forgive_decoders(), |bytes: &[u8]| {
    for raw in [false, true] {
        match read_texture(bytes, raw) {
            Ok(file) => {
                let image = file.image;
                let count = u64::from(image.width) * u64::from(image.height);
                assert!(count > 0 && count <= MAX_PIXELS);
                assert_eq!(image.pixels.iter().count() as u64, count);
                assert!(image.pixels.iter().all(|pixel| pixel.is_finite()));
            }
            Err(problem) => assert!(!problem.to_string().is_empty()),
        }
    }
});
