use crate::film::Crop;
use crate::math::Vec2;
use crate::sampling::{Key, Stream};

/// Cells along each side of the picture, in each of which a pixel is tried.
const CELLS: u32 = 22;

/// The cells of a picture.
pub(crate) struct Grid {
    window: Crop,
    columns: u32,
    rows: u32,
}

impl Grid {
    pub fn new(window: Crop) -> Self {
        Self { window, columns: CELLS.min(window.width), rows: CELLS.min(window.height) }
    }

    pub fn count(&self) -> usize {
        (self.columns * self.rows) as usize
    }

    pub fn pixels(&self) -> f64 {
        f64::from(self.window.width) * f64::from(self.window.height)
    }

    /// A pixel of a cell.
    pub fn pixel(&self, cell: u32) -> (u32, u32) {
        let hash = Key::new(u64::from(cell), 0, Stream::Pilot).hash();
        let within = |number: u32, cells: u32, size: u32, hash: u64| {
            let (first, end) = (number * size / cells, (number + 1) * size / cells);
            first + (hash % u64::from((end - first).max(1))) as u32
        };
        let (column, row) = (cell % self.columns, cell / self.columns);
        (
            self.window.x + within(column, self.columns, self.window.width, hash),
            self.window.y + within(row, self.rows, self.window.height, hash >> 32),
        )
    }

    /// The cell of a place on the film.
    pub fn cell(&self, film_position: Vec2) -> usize {
        let along = |position: f32, start: u32, cells: u32, size: u32| {
            let number = (f64::from(position) - f64::from(start)) * f64::from(cells) / f64::from(size);
            (number.max(0.0) as u32).min(cells - 1)
        };
        let column = along(film_position.x, self.window.x, self.columns, self.window.width);
        let row = along(film_position.y, self.window.y, self.rows, self.window.height);
        (row * self.columns + column) as usize
    }
}
