//! Grids as `.vol` files.

use nephroid::medium::{Grid, GridValues};

/// A grid in a file of 32-bit floats that fills [0, 1]³; its values are multiplied by a factor.
pub(super) fn encode(grid: &Grid, factor: f32) -> Vec<u8> {
    let values: Vec<f32> = match &grid.values {
        GridValues::Grey(values) => values.clone(),
        GridValues::Rgb(values) => values.iter().flat_map(|v| v.to_array()).collect(),
    };
    let channels = if matches!(grid.values, GridValues::Grey(_)) { 1 } else { 3 };
    let [x, y, z] = grid.size;
    let mut out = b"VOL\x03".to_vec();
    out.extend([1, x, y, z, channels].iter().flat_map(|v| v.to_le_bytes()));
    out.extend([0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().flat_map(|v| v.to_le_bytes()));
    out.extend(values.iter().flat_map(|v| (v * factor).to_le_bytes()));
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::read_vol;
    use nephroid::color::Rgb;

    #[test]
    fn grids_come_back() {
        let grey = GridValues::Grey((0..24).map(|i| i as f32 * 0.1).collect());
        let rgb = GridValues::Rgb((0..24).map(|i| Rgb::new(i as f32, 0.5, 1e-9)).collect());
        for values in [grey, rgb] {
            let grid = Grid { name: String::new(), size: [2, 3, 4], values };
            let file = read_vol(&encode(&grid, 1.0)).unwrap();
            assert_eq!((file.size, &file.values), (grid.size, &grid.values));
            assert!(file.to_bounds().is_ok());
            let twice = read_vol(&encode(&grid, 2.0)).unwrap();
            assert_eq!(twice.values.get(23), grid.values.get(23) * 2.0);
        }
    }
}
