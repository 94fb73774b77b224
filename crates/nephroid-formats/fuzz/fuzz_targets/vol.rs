//! Any bytes as a volume: an error, or a grid that holds together.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nephroid::medium::GridValues;
use nephroid_formats::volume::read_vol;

fuzz_target!(|bytes: &[u8]| match read_vol(bytes) {
    Ok(file) => {
        let is_good = |v: f32| v.is_finite() && v >= 0.0;
        let cells: u64 = file.size.iter().map(|side| u64::from(*side)).product();
        let found = match &file.values {
            GridValues::Grey(values) => {
                assert!(values.iter().all(|v| is_good(*v)));
                values.len()
            }
            GridValues::Rgb(values) => {
                assert!(values.iter().all(|v| v.to_array().into_iter().all(is_good)));
                values.len()
            }
        };
        assert_eq!(found as u64, cells);
        if let Ok(to_bounds) = file.to_bounds() {
            assert!(to_bounds.is_invertible());
        }
    }
    Err(error) => assert!(!error.to_string().is_empty()),
});
