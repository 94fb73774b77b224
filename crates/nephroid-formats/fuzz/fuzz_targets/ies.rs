//! Any bytes as a light's profile: an error, or a table of intensities.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nephroid_formats::ies::read_ies;

fuzz_target!(|bytes: &[u8]| match read_ies(&String::from_utf8_lossy(bytes)) {
    Ok(profile) => {
        assert!(profile.peak_candela > 0.0 && profile.peak_candela.is_finite());
        let table = profile.table;
        assert_eq!(table.pixels.len(), table.width as usize * table.height as usize);
        assert!(table.pixels.iter().all(|p| p.to_array().into_iter().all(|v| (0.0..=1.0).contains(&v))));
    }
    Err(error) => assert!(!error.to_string().is_empty()),
});
