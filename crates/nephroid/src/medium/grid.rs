use std::ops::Range;

use crate::color::Rgb;
use crate::math::Vec3;

/// Values on a regular grid that fills [0, 1]³, each in the middle of its cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// What messages call it.
    pub name: String,
    /// Cells along x, y and z.
    pub size: [u32; 3],
    /// One for each cell; x runs fastest, then y.
    pub values: GridValues,
}

/// One number or three in a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum GridValues {
    /// The same for all channels.
    Grey(Vec<f32>),
    /// One for each channel.
    Rgb(Vec<Rgb>),
}

impl GridValues {
    /// How many cells have one.
    pub fn len(&self) -> usize {
        match self {
            Self::Grey(values) => values.len(),
            Self::Rgb(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of a cell by its number.
    pub fn get(&self, index: usize) -> Rgb {
        match self {
            Self::Grey(values) => Rgb::splat(values[index]),
            Self::Rgb(values) => values[index],
        }
    }

    /// All in order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Rgb> {
        (0..self.len()).map(|i| self.get(i))
    }

    /// The largest channel of some cells by their numbers, and at least 0.
    pub(crate) fn max_channel(&self, cells: Range<usize>) -> f32 {
        match self {
            Self::Grey(values) => values[cells].iter().copied().fold(0.0, f32::max),
            Self::Rgb(values) => values[cells].iter().map(|v| v.max_channel()).fold(0.0, f32::max),
        }
    }

    /// Each multiplied by a factor.
    pub(crate) fn scaled(&self, factor: f32) -> Self {
        match self {
            Self::Grey(values) => Self::Grey(values.iter().map(|v| v * factor).collect()),
            Self::Rgb(values) => Self::Rgb(values.iter().map(|v| *v * factor).collect()),
        }
    }
}

impl Grid {
    /// The value at a point of [0, 1]³, linear along each axis between the middles of cells; outside of
    /// these as at the nearest point between them. The grid must have as many values as its size says.
    #[inline]
    pub fn eval(&self, p: Vec3) -> Rgb {
        let [x, y, z] = self.size;
        self.eval_in_cells(p * Vec3::new(x as f32, y as f32, z as f32))
    }

    /// The same for a point in units of cells.
    #[inline]
    pub(crate) fn eval_in_cells(&self, p: Vec3) -> Rgb {
        let x = Between::new(p.x, self.size[0]);
        let y = Between::new(p.y, self.size[1]);
        let z = Between::new(p.z, self.size[2]);
        let row = |y: usize, z: usize| (z * self.size[1] as usize + y) * self.size[0] as usize;
        let rows = [row(y.low, z.low), row(y.high, z.low), row(y.low, z.high), row(y.high, z.high)];
        match &self.values {
            GridValues::Grey(values) => {
                let [a, b, c, d] = rows.map(|row| x.mix(values[row + x.low], values[row + x.high]));
                Rgb::splat(z.mix(y.mix(a, b), y.mix(c, d)))
            }
            GridValues::Rgb(values) => {
                let mix = |t: &Between, a: Rgb, b: Rgb| a.zip(b, |a, b| t.mix(a, b));
                let [a, b, c, d] = rows.map(|row| mix(&x, values[row + x.low], values[row + x.high]));
                mix(&z, mix(&y, a, b), mix(&y, c, d))
            }
        }
    }
}

/// The middles of cells that a coordinate lies between.
struct Between {
    low: usize,
    high: usize,
    part: f32,
}

impl Between {
    #[inline]
    fn new(x: f32, cells: u32) -> Self {
        let last = (cells - 1) as usize;
        let x = (x - 0.5).max(0.0).min(last as f32);
        let low = x as usize;
        Self { low, high: (low + 1).min(last), part: x - low as f32 }
    }

    /// Never below the smaller or above the larger by more than rounding, and exact where they are equal.
    #[inline]
    fn mix(&self, a: f32, b: f32) -> f32 {
        a + (b - a) * self.part
    }
}

#[cfg(test)]
mod tests {
    use nephroid_testkit::Pcg32;

    use super::*;

    /// A function that is linear along each axis.
    fn trilinear(p: Vec3) -> Rgb {
        Rgb::new(1.0 + p.x + 2.0 * p.y * p.z, 3.0 - p.y + p.x * p.y * p.z, 0.5 + p.z * p.x)
    }

    #[test]
    fn a_trilinear_function_comes_back_and_the_border_goes_on() {
        let size = [3, 4, 5];
        let middle = |i: u32, n: u32| (i as f32 + 0.5) / n as f32;
        let mut values = Vec::new();
        for z in 0..5 {
            for y in 0..4 {
                for x in 0..3 {
                    values.push(trilinear(Vec3::new(middle(x, 3), middle(y, 4), middle(z, 5))));
                }
            }
        }
        let grey = GridValues::Grey(values.iter().map(|v| v.g).collect());
        let grid = Grid { name: String::new(), size, values: GridValues::Rgb(values) };
        let grey = Grid { values: grey, ..grid.clone() };
        let mut rng = Pcg32::new(1);
        for _ in 0..1000 {
            let p = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 3.0 - 1.0;
            let (low, high) = (Vec3::new(0.5 / 3.0, 0.125, 0.1), Vec3::new(2.5 / 3.0, 0.875, 0.9));
            let (found, expected) = (grid.eval(p), trilinear(p.clamp(low, high)));
            let error = (found - expected).map(f32::abs).max_channel();
            assert!(error < 2e-6, "{p}: {found:?}, not {expected:?}");
            assert_eq!(grey.eval(p), Rgb::splat(found.g));
        }
    }

    #[test]
    fn one_cell_is_the_same_everywhere() {
        let grid = Grid { name: String::new(), size: [1; 3], values: GridValues::Grey(vec![0.3]) };
        for p in [Vec3::ZERO, Vec3::ONE, Vec3::splat(0.5), Vec3::splat(f32::INFINITY), -Vec3::ONE] {
            assert_eq!(grid.eval(p), Rgb::splat(0.3));
        }
    }
}
