//! `.vol` files that can be read, and those that must be refused.

use nephroid::color::Rgb;
use nephroid::math::Vec3;
use nephroid::medium::GridValues;
use nephroid_formats::volume::{VolumeError, read_vol};

/// A file with a header of these numbers.
fn vol(encoding: i32, size: [i32; 3], channels: i32, bounds: [f32; 6], values: &[u8]) -> Vec<u8> {
    let mut out = b"VOL\x03".to_vec();
    for number in [encoding, size[0], size[1], size[2], channels] {
        out.extend(number.to_le_bytes());
    }
    out.extend(bounds.iter().flat_map(|v| v.to_le_bytes()));
    out.extend(values);
    out
}

const UNIT: [f32; 6] = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// The message about a file.
fn message(bytes: &[u8]) -> String {
    read_vol(bytes).expect_err("it must be refused").to_string()
}

#[test]
fn values_stand_in_the_order_of_the_file() {
    let values = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
    let bounds = [-1.0, 2.0, 0.0, 3.0, 2.5, 8.0];
    let file = read_vol(&vol(1, [3, 2, 1], 1, bounds, &floats(&values))).expect("it can be read");
    assert_eq!((file.size, &file.values), ([3, 2, 1], &GridValues::Grey(values.to_vec())));
    let to_bounds = file.to_bounds().expect("a box");
    assert_eq!(to_bounds.point(Vec3::ZERO), Vec3::new(-1.0, 2.0, 0.0));
    assert_eq!(to_bounds.point(Vec3::ONE), Vec3::new(3.0, 2.5, 8.0));
    assert_eq!(to_bounds.point(Vec3::new(0.25, 0.5, 0.75)), Vec3::new(0.0, 2.25, 6.0));
    let file = read_vol(&vol(1, [1, 1, 2], 3, UNIT, &floats(&values))).expect("it can be read");
    let colours = vec![Rgb::new(0.0, 1.0, 2.0), Rgb::new(3.0, 4.0, 5.0)];
    assert_eq!((file.size, file.values), ([1, 1, 2], GridValues::Rgb(colours)));
}

#[test]
fn half_floats_and_bytes() {
    let halves: Vec<u8> = [0x3c00u16, 0x3800].iter().flat_map(|v| v.to_le_bytes()).collect();
    let file = read_vol(&vol(2, [2, 1, 1], 1, UNIT, &halves)).expect("it can be read");
    assert_eq!(file.values, GridValues::Grey(vec![1.0, 0.5]));
    let file = read_vol(&vol(3, [1, 3, 1], 1, UNIT, &[0, 51, 255])).expect("it can be read");
    assert_eq!(file.values, GridValues::Grey(vec![0.0, 0.2, 1.0]));
}

#[test]
fn what_is_no_volume() {
    let good = vol(1, [1, 1, 1], 1, UNIT, &floats(&[1.0]));
    assert_eq!(message(b""), "not a volume: it does not begin with \"VOL\"");
    assert_eq!(message(b"PK\x03\x04"), "not a volume: it does not begin with \"VOL\"");
    assert_eq!(message(&good[..47]), "a volume has 48 bytes before its values, but the file ends after 47");
    let mut other = good.clone();
    other[3] = 4;
    assert_eq!(message(&other), "a volume of version 4; version 3 can be read");
    assert_eq!(
        message(&vol(4, [1, 1, 1], 1, UNIT, &[])),
        "values of encoding 4; 1 (floats), 2 (half floats) and 3 (bytes) can be read"
    );
    for channels in [0, 2, 6, -1] {
        let text = message(&vol(1, [1, 1, 1], channels, UNIT, &floats(&[1.0; 6])));
        assert_eq!(text, format!("{channels} values in each cell; 1 or 3 can be read"));
    }
    for size in [[0, 1, 1], [1, -2, 1], [1, 1, i32::MIN]] {
        let text = message(&vol(1, size, 1, UNIT, &floats(&[1.0])));
        let [x, y, z] = size;
        assert_eq!(text, format!("a grid of {x} × {y} × {z} cells; each side needs at least one"));
    }
}

#[test]
fn sizes_that_do_not_fit_the_file() {
    assert_eq!(
        message(&vol(1, [2, 2, 2], 1, UNIT, &floats(&[1.0; 7]))),
        "the header promises 32 bytes of values, but 28 follow it"
    );
    // No number of 64 bits holds the product, and no machine the values.
    assert_eq!(
        message(&vol(1, [i32::MAX; 3], 3, UNIT, &[])),
        "the header promises 118842243605375809804239372276 bytes of values, but 0 follow it"
    );
    // The product is 2³², nothing in 32 bits.
    assert_eq!(
        message(&vol(3, [65_536, 65_536, 1], 1, UNIT, &[])),
        "the header promises 4294967296 bytes of values, but 0 follow it"
    );
    assert_eq!(
        message(&vol(1, [1, 1, 1], 1, UNIT, &[0; 9])),
        "5 bytes too many: the file goes on behind the last value"
    );
}

#[test]
fn values_that_are_none() {
    let of = |values: &[f32]| read_vol(&vol(1, [4, 1, 1], 1, UNIT, &floats(values)));
    assert_eq!(
        of(&[1.0, -0.5, f32::INFINITY, f32::NAN]),
        Err(VolumeError::Values { count: 2, first: 2, value: f32::INFINITY })
    );
    let below_zero = of(&[1.0, -0.5, -1e-45, 2.0]).expect("they are numbers");
    assert_eq!((below_zero.values, below_zero.negative), (GridValues::Grey(vec![1.0, 0.0, 0.0, 2.0]), 2));
    assert_eq!(
        of(&[1.0, 2.0, 3.0, f32::NEG_INFINITY]).expect_err("infinite").to_string(),
        "1 of the values are not finite, the first of them number 3: -inf (counted from 0)"
    );
    assert!(of(&[0.0, -0.0, f32::MIN_POSITIVE, f32::MAX]).is_ok());
    let half_nan = 0x7e00u16.to_le_bytes();
    assert!(matches!(
        read_vol(&vol(2, [1, 1, 1], 1, UNIT, &half_nan)),
        Err(VolumeError::Values { count: 1, first: 0, .. })
    ));
}

#[test]
fn boxes_that_hold_nothing() {
    for (bounds, text) in [
        ([1.0, 0.0, 0.0, 0.0, 1.0, 1.0], "[1, 0, 0] to [0, 1, 1]"),
        ([0.0, 0.0, 2.0, 1.0, 1.0, 2.0], "[0, 0, 2] to [1, 1, 2]"),
        ([0.0, f32::NAN, 0.0, 1.0, 1.0, 1.0], "[0, NaN, 0] to [1, 1, 1]"),
        ([0.0, 0.0, 0.0, 1.0, f32::INFINITY, 1.0], "[0, 0, 0] to [1, inf, 1]"),
    ] {
        // It matters only where the box is asked for.
        let file = read_vol(&vol(3, [1, 1, 1], 1, bounds, &[9])).expect("the values can be read");
        let error = file.to_bounds().expect_err("no box");
        assert_eq!(error.to_string(), format!("its box goes from {text}; each coordinate must grow"));
    }
}
